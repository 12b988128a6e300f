//! The integral of one ray segment by adaptive quadrature (docs/src/explanation/optics.md, section 6).
//!
//! Symbols: u ∈ [0, 1] along a stretch, ρ the extinction, T the optical depth in front of a point, A = 1 − e^(−T), κ what
//! glows (Σ c_i ρ_i, or the constant-emitter's).
//!
//! **Stretches.** The segment is cut at every place where a widget begins, ends, breaks or leaves a width of its centre
//! (`features`), so ρ and κ are smooth on each stretch, and every widget is monotone or a parabola there. A stretch has a
//! coordinate of its own: what begins at its front is resolved down to u = 1e-300, wherever that lies in the cell.
//!
//! **Pieces.** A stretch is halved, front first, until each piece holds at most [`DEPTH_AT_ONCE`] and the estimated
//! errors are small. So pieces grade geometrically towards the front where ρ is huge (1e30 of depth: a hundred halvings),
//! and the walk takes steps of about equal dA/A, whatever ρ is. On a piece C = ∫ κ e^(−T) is integrated by the 15-point
//! rule with T by the running integral of the same points.
//!
//! **Errors.** With ε = [`RELATIVE`], S a first estimate of the segment's depth (at most twice of it, as at
//! least half of a monotone part is above its middle's value), l a piece's share of the length and T' its depth:
//!
//! - depth, while light is left: ε (T' + l min(S, 1)). An error δ of T moves C by δ C at most, so this is 3 ε C in all.
//! - depth behind that: ε (T' + l S), 3 ε T in all. It moves A by T e^(−T) of that.
//! - colour: ε (C' + C T'/60) for each channel: 2 ε C in all, as pieces with light hold 60 of depth. And 1e-17 of the
//!   piece's brightest channel, which is below the rounding of the sum.
//!
//! **The end of light.** Behind a depth T the rest of the segment gives no more than e^(−T) times the brightest colour
//! (times D/U and summed over widgets for the constant-emitter), since ∫ ρ e^(−T) ≤ 1. Where that is under e^(−60) of
//! the colour found so far, no more is looked for.
//!
//! **What it cannot do** is an error: a piece that does not converge, features nearer to each other than places are
//! known where light is left, a depth beyond 64 bits.
//!
//! The quadrature rule: 15 Kronrod points with the 7 Gauss points among them.
//!
//! Besides its value a rule gives the running integral at its own nodes (the integral of the polynomial through
//! the 15 values), which is how the optical depth in front of a node is found. Nodes and weights: Laurie,
//! "Calculation of Gauss-Kronrod quadrature rules", 1997, as tabulated in QUADPACK (Piessens et al. 1983); the
//! error estimate is QUADPACK's.

use crate::linear_on_segment::Wide;
use crate::part::{Interval, Layout, Part};
use crate::term::Term;
use std::sync::LazyLock;
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::{Contribution, WidgetBlend};

/// Share of the colour below which the remaining light is neglected: e^(−60).
const DARK: f64 = 8.7e-27;

/// Depth of the pieces that hold light: −ln [`DARK`].
const DEPTH_OF_LIGHT: f64 = 60.0;

/// A stretch over which more optical depth piles up is halved before its colour is believed.
const DEPTH_AT_ONCE: f64 = 3.0;

/// Halving ends where a piece is this share of its distance from the stretch's front: a few roundings of u.
const SHORTEST: f64 = 1e-15;

/// A stretch that needs more halvings is an error: what is known of its widgets does not describe it.
const MAX_HALVINGS: u32 = 100_000;

/// Channels that are darker than the brightest one by this share are below the rounding of a sum.
const ROUNDING: f64 = 1e-17;

/// Profiles under this share of the peak have no full digits any more.
const UNDERFLOW: f64 = 1e-305;

/// Depth in a blurred stretch that can be noticed.
const NOTICED: f64 = 1e-11;

/// Stopping criterion of a piece: estimated error ≤ this × its value + an absolute tolerance, and the rule of the module's head.
const RELATIVE: f64 = 1e-11;

/// Absolute tolerance for one segment that is judged by relative error however small it is.
pub const SEGMENT_TOLERANCE: f64 = 1e-300;

/// Absolute tolerance for pictures: ten thousand segments in a pixel leave 1e-11.
pub const PICTURE_TOLERANCE: f64 = 1e-15;

pub struct Integrand {
    terms: Vec<Term>,
    model: OpticalModel,
    unit_distance: f64,
    /// Absolute tolerance.
    tolerance: f64,
    /// The densest that all widgets together can be, 1/L.
    densest: f64,
    /// For the mix of several widgets: each by itself; else empty.
    alone: Vec<Integrand>,
}

#[derive(Default)]
pub struct Workspace {
    layout: Layout,
    /// Ends of the pieces that are still to be looked at, the foremost last.
    pending: Vec<[f64; 2]>,
}

struct Whole {
    length: f64,
    /// A first estimate of its optical depth.
    depth: f64,
    /// Upper bound of its colour.
    brightest: f64,
}

/// Sums over the nodes of the rule: by its Kronrod and by its Gauss weights.
#[derive(Default)]
struct Sums {
    depth: [f64; 2],
    color: [[f64; 2]; 3],
}

impl Integrand {
    /// Errors: those of [`TransferFunction::check`].
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend, tolerance: f64) -> Result<Self> {
        transfer_function.check()?;
        let &TransferFunction { model, unit_distance, ref widgets, .. } = transfer_function;
        let fields = transfer_function.fields();
        let of = |widgets: &[Widget]| {
            let terms: Vec<Term> = widgets.iter().map(|w| Term::new(w, unit_distance, &fields)).collect();
            let densest = terms.iter().map(|term| term.densest).sum();
            Integrand { terms, model, unit_distance, tolerance, densest, alone: Vec::new() }
        };
        let alone = match overlap {
            WidgetBlend::Mix => widgets.chunks(1).map(of).collect(),
            WidgetBlend::Exact => Vec::new(),
        };
        Ok(Integrand { alone, ..of(widgets) })
    }

    /// The pair (C, A) and T of a segment of the given length, world units; `front` and `back` are
    /// [s, g, fields …], the fields in the order of [`TransferFunction::fields`].
    ///
    /// Errors: what the quadrature cannot resolve, and numbers beyond 64 bits.
    pub fn integrate(
        &self,
        length: f64,
        front: &[f64],
        back: &[f64],
        work: &mut Workspace,
    ) -> Result<Contribution> {
        if !self.alone.is_empty() {
            return self.mix(length, front, back, work);
        }
        let mut sum = Contribution::default();
        if length <= 0.0 {
            return Ok(sum);
        }
        let Workspace { layout, pending } = work;
        let cutoff = self.model.cutoff();
        layout.lay_out(&self.terms, front, back, cutoff)?;
        let middle = |stretch: &Interval| -> f64 {
            let extinction = |part: &Part| {
                let mut value = [0.0];
                part.extinction(&self.terms[part.term as usize], layout.numbers(), &[0.5], &mut value);
                value[0]
            };
            layout.parts(stretch).iter().map(extinction).sum()
        };
        let whole = Whole {
            length,
            depth: layout.stretches.iter().map(|stretch| middle(stretch) * stretch.share * length).sum(),
            brightest: self.brightest(length),
        };
        let mut depth = Wide::ZERO;
        for stretch in &layout.stretches {
            self.walk(&whole, layout, stretch, pending, &mut depth, &mut sum.color)?;
        }
        sum.optical_depth = depth.value();
        sum.opacity = -(-sum.optical_depth).exp_m1();
        Ok(sum)
    }

    /// Optical depth of each widget by itself, for [`WidgetBlend::Mix`]. Errors: those of [`Integrand::integrate`].
    pub fn widget_depths(
        &self,
        length: f64,
        front: &[f64],
        back: &[f64],
        work: &mut Workspace,
    ) -> Result<Vec<f64>> {
        let depth = |one: &Integrand| Ok(one.integrate(length, front, back, work)?.optical_depth);
        self.alone.iter().map(depth).collect()
    }

    /// Upper bound of a colour channel of a segment of this length (world units).
    pub fn brightest(&self, length: f64) -> f64 {
        let each = self.terms.iter().map(|term| term.brightest);
        match self.model {
            OpticalModel::DensityEmitter => each.fold(0.0, f64::max),
            OpticalModel::ConstantEmitter { .. } => each.sum::<f64>() * length / self.unit_distance,
        }
    }

    /// The widgets' own lights, dimmed by what all of them absorb on the mean (Kniss et al. 2003, Eq. 15).
    fn mix(&self, length: f64, front: &[f64], back: &[f64], work: &mut Workspace) -> Result<Contribution> {
        let parts = self.alone.iter().map(|one| one.integrate(length, front, back, work));
        let parts = parts.collect::<Result<Vec<Contribution>>>()?;
        let optical_depth = parts.iter().map(|part| part.optical_depth).sum();
        let through = |depth: f64| if depth > 0.0 { -(-depth).exp_m1() / depth } else { 1.0 };
        let dimmed = |part: &Contribution| through(optical_depth) / through(part.optical_depth);
        let color = std::array::from_fn(|c| parts.iter().map(|part| dimmed(part) * part.color[c]).sum());
        Ok(Contribution { optical_depth, color, opacity: -(-optical_depth).exp_m1() })
    }

    /// Adds one stretch, piece by piece from its front.
    fn walk(
        &self,
        whole: &Whole,
        layout: &Layout,
        stretch: &Interval,
        pending: &mut Vec<[f64; 2]>,
        in_front: &mut Wide,
        found: &mut [f64; 3],
    ) -> Result<()> {
        let absolute = self.tolerance;
        let mut halvings = 0;
        pending.clear();
        pending.push([0.0, 1.0]);
        while let Some([low, high]) = pending.pop() {
            let share = stretch.share * (high - low);
            let light = (-in_front.value()).exp();
            let seen = light * whole.brightest > DARK * found.iter().copied().fold(0.0, f64::max);
            let sums = self.sample(layout, stretch, [low, high], share * whole.length, seen);
            let [depth, depth_gauss] = sums.depth;
            if !depth.is_finite() {
                return Err(cannot("a segment's optical depth is no number of 64 bits", stretch, *in_front)
                    .got(depth)
                    .expected("finite values, extinctions and lengths"));
            }
            if stretch.blurred && depth * light > NOTICED {
                return Err(cannot(
                    "two features of a transfer function are too near to each other",
                    stretch,
                    *in_front,
                )
                .got(format!("{share:.3e} of the segment, with an optical depth of {depth:.3e}"))
                .expected("features in one place, or further apart than 1e-19 of a segment"));
            }
            let underflow = UNDERFLOW * self.densest * share * whole.length;
            let noise = underflow + absolute;
            let scale = if seen { whole.depth.min(1.0) } else { whole.depth };
            let deep = RELATIVE * (depth + scale * share) + noise;
            let lit = || {
                let most = sums.color.iter().map(|c| c[0]).fold(0.0, f64::max);
                depth <= DEPTH_AT_ONCE
                    && sums.color.iter().zip(*found).all(|(&[color, gauss], before)| {
                        let before = before / light * depth / DEPTH_OF_LIGHT;
                        let dimmest = ROUNDING * most + underflow * whole.brightest + absolute;
                        let allowed = RELATIVE * (color + before) + dimmest;
                        estimated_error(color, gauss, color) <= allowed
                    })
            };
            if !(estimated_error(depth, depth_gauss, depth) <= deep && (!seen || lit())) {
                halvings += 1;
                if halvings > MAX_HALVINGS || high - low < SHORTEST * high {
                    return Err(cannot("the reference did not converge on a segment", stretch, *in_front)
                        .got(format!("{halvings} halvings, the last piece {share:.3e} of the segment"))
                        .expected(
                            "widgets that are smooth between their edges, centres and control points",
                        ));
                }
                let middle = 0.5 * (low + high);
                pending.extend([[middle, high], [low, middle]]);
                continue;
            }
            if seen {
                for (total, part) in found.iter_mut().zip(sums.color) {
                    *total += light * part[0];
                }
            }
            *in_front = *in_front + Wide::from(depth);
        }
        Ok(())
    }

    /// Kronrod and Gauss values of optical depth and colour over u from `low` to `high`, a piece of the given length; the
    /// colour as seen from the front of the piece.
    fn sample(
        &self,
        layout: &Layout,
        stretch: &Interval,
        [low, high]: [f64; 2],
        length: f64,
        seen: bool,
    ) -> Sums {
        let rule = &*RULE;
        let places = rule.nodes.map(|node| low + (high - low) * node);
        let mut density = [0.0; NODES];
        let mut glow = [[0.0; NODES]; 3];
        for part in layout.parts(stretch) {
            let term = &self.terms[part.term as usize];
            let mut extinction = [0.0; NODES];
            part.extinction(term, layout.numbers(), &places, &mut extinction);
            density.iter_mut().zip(&extinction).for_each(|(sum, x)| *sum += x);
            if !seen {
                continue;
            }
            let brightness = match self.model {
                OpticalModel::DensityEmitter => extinction,
                OpticalModel::ConstantEmitter { .. } if part.glows => [1.0 / self.unit_distance; NODES],
                OpticalModel::ConstantEmitter { .. } => continue,
            };
            for (node, brightness) in brightness.iter().enumerate() {
                let color = if part.has_colors() {
                    part.color(term, layout.numbers(), places[node])
                } else {
                    term.color
                };
                (0..3).for_each(|c| glow[c][node] += color[c] * brightness);
            }
        }
        let over = |weights: &[f64; NODES], values: &[f64; NODES]| -> f64 {
            weights.iter().zip(values).map(|(w, x)| w * x).sum::<f64>() * length
        };
        let depth = [over(&rule.kronrod, &density), over(&rule.gauss, &density)];
        let mut sums = Sums { depth, ..Sums::default() };
        if !seen || depth[0] > DEPTH_AT_ONCE {
            return sums;
        }
        let light: [f64; NODES] = std::array::from_fn(|k| (-over(&rule.running[k], &density)).exp());
        for (sum, mut glow) in sums.color.iter_mut().zip(glow) {
            glow.iter_mut().zip(&light).for_each(|(glow, light)| *glow *= light);
            *sum = [over(&rule.kronrod, &glow), over(&rule.gauss, &glow)];
        }
        sums
    }
}

/// An error that says where on the segment it is.
fn cannot(what: &str, stretch: &Interval, in_front: Wide) -> Error {
    let Interval { begin, share, .. } = stretch;
    let depth = in_front.value();
    Error::run(format!(
        "{what} (from {begin} of its length on, over {share:.3e} of it, behind a depth of {depth:.3e})"
    ))
}

pub(crate) const NODES: usize = 15;

/// Kronrod abscissae from the middle outward; each but the first stands for ± itself.
const ABSCISSAE: [f64; 8] = [
    0.0,
    0.207_784_955_007_898_47,
    0.405_845_151_377_397_2,
    0.586_087_235_467_691_1,
    0.741_531_185_599_394_4,
    0.864_864_423_359_769_1,
    0.949_107_912_342_758_5,
    0.991_455_371_120_812_6,
];

/// Kronrod weights, in the order of [`ABSCISSAE`].
const KRONROD: [f64; 8] = [
    0.209_482_141_084_727_82,
    0.204_432_940_075_298_9,
    0.190_350_578_064_785_4,
    0.169_004_726_639_267_9,
    0.140_653_259_715_525_92,
    0.104_790_010_322_250_19,
    0.063_092_092_629_978_56,
    0.022_935_322_010_529_224,
];

/// Gauss weights of every second abscissa, from the middle outward.
const GAUSS: [f64; 4] =
    [0.417_959_183_673_469_4, 0.381_830_050_505_118_9, 0.279_705_391_489_276_64, 0.129_484_966_168_869_7];

/// The rule on [0, 1].
pub(crate) struct Rule {
    pub(crate) nodes: [f64; NODES],
    pub(crate) kronrod: [f64; NODES],
    /// Weights of the 7 Gauss nodes, 0 at the others.
    pub(crate) gauss: [f64; NODES],
    /// `running[j][k]`: integral from 0 to node j of the polynomial that is 1 at node k and 0 at the others.
    pub(crate) running: [[f64; NODES]; NODES],
}

/// The rule, made once.
pub(crate) static RULE: LazyLock<Rule> = LazyLock::new(Rule::new);

impl Rule {
    fn new() -> Self {
        let mut nodes = [0.0; NODES];
        let mut kronrod = [0.0; NODES];
        let mut gauss = [0.0; NODES];
        for (k, &x) in ABSCISSAE.iter().enumerate() {
            for (place, signed) in [(7 - k, -x), (7 + k, x)] {
                nodes[place] = 0.5 + 0.5 * signed;
                kronrod[place] = 0.5 * KRONROD[k];
                gauss[place] = if k % 2 == 0 { 0.5 * GAUSS[k / 2] } else { 0.0 };
            }
        }
        // The rule itself is exact for the polynomials of degree 14 that are to be integrated.
        let mut running = [[0.0; NODES]; NODES];
        for (j, row) in running.iter_mut().enumerate() {
            for (k, entry) in row.iter_mut().enumerate() {
                let value = |x: f64| -> f64 {
                    (0..NODES).filter(|&m| m != k).map(|m| (x - nodes[m]) / (nodes[k] - nodes[m])).product()
                };
                *entry = (0..NODES).map(|i| kronrod[i] * nodes[j] * value(nodes[i] * nodes[j])).sum();
            }
        }
        Rule { nodes, kronrod, gauss, running }
    }
}

/// QUADPACK's estimate of the error of the Kronrod value, from both values and the integral of |f|.
pub(crate) fn estimated_error(kronrod: f64, gauss: f64, magnitude: f64) -> f64 {
    if magnitude <= 0.0 {
        return 0.0;
    }
    let share = 200.0 * (kronrod - gauss).abs() / magnitude;
    magnitude * (share * share.sqrt()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 15 Kronrod points are exact to degree 22 (and by symmetry 23), 7 Gauss points to 13. Rounding of 15
    /// terms of size below 1: 1e-15.
    #[test]
    fn rule_integrates_powers() {
        let integral = |weights: &[f64], n: i32| -> f64 {
            weights.iter().zip(&RULE.nodes).map(|(w, x)| w * x.powi(n)).sum()
        };
        for n in 0..=22 {
            assert!((integral(&RULE.kronrod, n) - 1.0 / f64::from(n + 1)).abs() < 1e-15, "degree {n}");
        }
        for n in 0..=13 {
            assert!((integral(&RULE.gauss, n) - 1.0 / f64::from(n + 1)).abs() < 1e-15, "degree {n}");
        }
        assert!((integral(&RULE.gauss, 14) - 1.0 / 15.0).abs() > 1e-12);
    }

    /// The running integral of xⁿ is xⁿ⁺¹/(n + 1), exactly up to degree 14; the matrix's entries stay below 1.
    #[test]
    fn running_integral_of_powers() {
        for n in 0..=14 {
            for (j, &x) in RULE.nodes.iter().enumerate() {
                let sum: f64 = RULE.running[j].iter().zip(&RULE.nodes).map(|(m, y)| m * y.powi(n)).sum();
                assert!((sum - x.powi(n + 1) / f64::from(n + 1)).abs() < 1e-14, "degree {n} at {x}");
            }
        }
    }
}
