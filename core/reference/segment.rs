//! The integral of one ray segment by adaptive quadrature (docs/optics.md, section 6).
//!
//! The segment is cut at every place where a widget changes its character ([`Term::features`]); each stretch
//! between two cuts is halved, front first, until the estimated errors of its optical depth and of its colour
//! are below the tolerance. Symbols: t ∈ [0, 1] along the segment, u ∈ [0, 1] along a stretch, T the optical
//! depth in front of a point.

use super::along::Along;
use super::quadrature::{NODES, RULE, estimated_error};
use super::term::Term;
use crate::optics::{Contribution, Overlap};
use crate::transfer::{OpticalModel, TransferFunction, Widget};
use crate::{Error, Result};

/// Behind this optical depth no colour is looked for: e^(−60) is 1e-26.
const DEPTH_OF_NO_LIGHT: f64 = 60.0;

/// A stretch over which more optical depth piles up is halved before its colour is believed.
const DEPTH_AT_ONCE: f64 = 3.0;

/// Halving ends here; what is left is shorter than the rounding of the stretch's ends.
const SHORTEST: f64 = 1e-16;

/// A stretch that needs more halvings is an error: what is known of its widgets does not describe it.
const HALVINGS_AT_MOST: u32 = 100_000;

/// Rounding of a sample, as a share of the segment's mean: near a zero of a profile no relative error is small.
const NOISE: f64 = 1e-13;

/// When a piece counts as done: estimated error ≤ relative × its value + absolute. Its share of the segment's
/// length times the segment's optical depth counts as value, too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Of the stretch's own optical depth and colour.
    pub relative: f64,
    /// Of optical depth and colour.
    pub absolute: f64,
}

impl Tolerance {
    /// For one segment that is judged by relative error however small it is.
    pub const SEGMENT: Tolerance = Tolerance { relative: 1e-11, absolute: 1e-300 };
    /// For pictures: ten thousand segments in a pixel leave 1e-11.
    pub const PICTURE: Tolerance = Tolerance { relative: 1e-11, absolute: 1e-15 };
}

/// A transfer function made ready for integration.
pub struct Integrand {
    terms: Vec<Term>,
    model: OpticalModel,
    unit_distance: f64,
    tolerance: Tolerance,
    /// For the mix of several widgets: each by itself; else empty.
    alone: Vec<Integrand>,
}

/// What one stretch looks like; buffers that are kept from segment to segment.
#[derive(Default)]
pub struct Workspace {
    /// Coordinates of all terms along the segment, then along the stretch.
    along: Vec<Along>,
    stretch: Vec<Along>,
    /// Of each term: where its coordinates end.
    ends: Vec<usize>,
    /// The regions' half planes, all terms'.
    sides: Vec<Along>,
    cuts: Vec<f64>,
    point: Vec<f64>,
    /// Of each term on this stretch: not there, absorbing, absorbing and glowing.
    state: Vec<State>,
    pending: Vec<[f64; 2]>,
    /// A first estimate of the segment's optical depth; what colour it could give at most.
    depth: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Absent,
    Absorbs,
    Glows,
}

/// Sums over the nodes of the rule.
#[derive(Default)]
struct Sums {
    depth: [f64; 2],
    color: [[f64; 3]; 2],
    /// The largest colour of any widget at any node.
    brightest: [f64; 3],
}

impl Integrand {
    /// Errors: a widget without its region or fields, an optical model's number out of range.
    pub fn new(transfer_function: &TransferFunction, overlap: Overlap, tolerance: Tolerance) -> Result<Self> {
        let unit_distance = transfer_function.unit_distance;
        if !(unit_distance > 0.0 && unit_distance.is_finite()) {
            return Err(Error::usage("unit_distance is out of range")
                .found(unit_distance)
                .accepted("world units above 0"));
        }
        if let OpticalModel::ConstantEmitter { cutoff } = transfer_function.model
            && !(0.0..1.0).contains(&cutoff)
        {
            return Err(Error::usage("cutoff is out of range").found(cutoff).accepted("0 or more, below 1"));
        }
        let fields = transfer_function.fields();
        let of = |widgets: &[Widget]| -> Result<Integrand> {
            let terms = widgets.iter().map(|w| Term::new(w, unit_distance, &fields));
            let (terms, model) = (terms.collect::<Result<_>>()?, transfer_function.model);
            Ok(Integrand { terms, model, unit_distance, tolerance, alone: Vec::new() })
        };
        let all = of(&transfer_function.widgets)?;
        let alone = match overlap {
            Overlap::Mix => transfer_function.widgets.chunks(1).map(of).collect::<Result<_>>()?,
            Overlap::Exact => Vec::new(),
        };
        Ok(Integrand { alone, ..all })
    }

    /// The pair (C, A) and T of a segment of the given length, world units; `front` and `back` are
    /// [s, g, fields …], the fields in the order of [`TransferFunction::fields`].
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
        if length <= 0.0 || length.is_nan() {
            return Ok(sum);
        }
        self.lay_out(front, back, work)?;
        let cuts = std::mem::take(&mut work.cuts);
        let stretches = || cuts.windows(2).filter(|pair| pair[1] > pair[0]);
        // A segment of one stretch finds its scale by itself.
        work.depth = 0.0;
        for pair in stretches().filter(|_| cuts.len() > 2) {
            if self.enter(pair[0], pair[1], work) {
                let part = self.sample(length * (pair[1] - pair[0]), 0.0, 1.0, false, work);
                work.depth += part.depth[0];
            }
        }
        for pair in stretches() {
            if self.enter(pair[0], pair[1], work) {
                self.stretch(length, pair[1] - pair[0], work, &mut sum)?;
            }
        }
        work.cuts = cuts;
        sum.opacity = -(-sum.optical_depth).exp_m1();
        Ok(sum)
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

    /// Coordinates along the segment, and the cuts: 0, every feature in rising order, 1.
    fn lay_out(&self, front: &[f64], back: &[f64], work: &mut Workspace) -> Result<()> {
        work.along.clear();
        work.ends.clear();
        work.sides.clear();
        work.cuts.clear();
        work.cuts.extend([0.0, 1.0]);
        let cutoff = match self.model {
            OpticalModel::ConstantEmitter { cutoff } if cutoff > 0.0 => Some(cutoff),
            _ => None,
        };
        for term in &self.terms {
            let start = work.along.len();
            term.coordinates(front, back, &mut work.along);
            term.features(&work.along[start..], cutoff, &mut work.cuts)?;
            work.ends.push(work.along.len());
            for side in &term.sides {
                let side = side.along(front, back);
                side.level(0.0, &mut work.cuts);
                work.sides.push(side);
            }
        }
        work.cuts.sort_unstable_by(f64::total_cmp);
        work.cuts.dedup();
        Ok(())
    }

    /// Looks at the part of the segment from t = a to t = b; false where no widget is.
    fn enter(&self, a: f64, b: f64, work: &mut Workspace) -> bool {
        work.stretch.clear();
        work.stretch.extend(work.along.iter().map(|x| x.part(a, b)));
        work.state.clear();
        let (mut first, mut side) = (0, 0);
        for (term, &end) in self.terms.iter().zip(&work.ends) {
            let sides = &work.sides[side..side + term.sides.len()];
            side += sides.len();
            // Between two cuts nothing is crossed, so the middle speaks for the whole stretch.
            let inside = sides.iter().all(|x| x.at(0.5 * (a + b)) >= 0.0);
            term.localise(&mut work.stretch[first..end]);
            work.point.clear();
            work.point.extend(work.stretch[first..end].iter().map(|x| x.at(0.5)));
            work.state.push(match self.model {
                _ if !inside => State::Absent,
                OpticalModel::ConstantEmitter { cutoff } if term.share_of_peak(&work.point) <= cutoff => {
                    State::Absorbs
                }
                _ => State::Glows,
            });
            first = end;
        }
        work.state.iter().any(|s| *s != State::Absent)
    }

    /// Adds the stretch that was entered, a share of a segment of the given length.
    fn stretch(&self, length: f64, share: f64, work: &mut Workspace, sum: &mut Contribution) -> Result<()> {
        let mut halvings = 0;
        work.pending.clear();
        work.pending.push([0.0, 1.0]);
        while let Some([low, high]) = work.pending.pop() {
            let seen = sum.optical_depth < DEPTH_OF_NO_LIGHT;
            let share = share * (high - low);
            let piece = length * share;
            let sums = self.sample(piece, low, high, seen, work);
            let [depth, depth_gauss] = sums.depth;
            if work.depth == 0.0 {
                work.depth = depth;
            }
            let Tolerance { relative, absolute } = self.tolerance;
            let close = |k: f64, g: f64, more: f64| {
                estimated_error(k, g, k.abs()) <= relative * k.abs() + more + absolute
            };
            let done = close(depth, depth_gauss, relative * work.depth * share)
                && (!seen
                    || depth <= DEPTH_AT_ONCE
                        && (0..3).all(|c| {
                            let most = NOISE * work.depth * share * sums.brightest[c];
                            close(sums.color[0][c], sums.color[1][c], most)
                        }));
            if !done && high - low > SHORTEST {
                halvings += 1;
                if halvings > HALVINGS_AT_MOST {
                    return Err(Error::run("a segment's integral did not converge")
                        .found(format!("{halvings} halvings of one stretch")));
                }
                let middle = 0.5 * (low + high);
                work.pending.extend([[middle, high], [low, middle]]);
                continue;
            }
            if seen {
                let light = (-sum.optical_depth).exp();
                for (total, part) in sum.color.iter_mut().zip(sums.color[0]) {
                    *total += light * part;
                }
            }
            sum.optical_depth += depth;
        }
        Ok(())
    }

    /// Kronrod and Gauss values of optical depth and colour over u from `low` to `high`; the colour as seen
    /// from the front of the piece.
    fn sample(&self, piece: f64, low: f64, high: f64, seen: bool, work: &mut Workspace) -> Sums {
        let rule = &*RULE;
        let mut sums = Sums::default();
        let mut density = [0.0; NODES];
        let mut glow = [[0.0; 3]; NODES];
        let mut first = 0;
        for (k, (term, &end)) in self.terms.iter().zip(&work.ends).enumerate() {
            let state = work.state[k];
            let coordinates = &work.stretch[first..end];
            first = end;
            if state == State::Absent {
                continue;
            }
            for node in 0..NODES {
                let u = low + (high - low) * rule.nodes[node];
                work.point.clear();
                work.point.extend(coordinates.iter().map(|x| x.at(u)));
                let (extinction, color) = term.sample(&work.point);
                density[node] += extinction;
                let brightness = match self.model {
                    OpticalModel::DensityEmitter => extinction,
                    OpticalModel::ConstantEmitter { .. } if state == State::Glows => 1.0 / self.unit_distance,
                    OpticalModel::ConstantEmitter { .. } => 0.0,
                };
                for c in 0..3 {
                    glow[node][c] += color[c] * brightness;
                    sums.brightest[c] = sums.brightest[c].max(color[c]);
                }
            }
        }
        for (node, density) in density.iter().enumerate() {
            sums.depth[0] += rule.kronrod[node] * density * piece;
            sums.depth[1] += rule.gauss[node] * density * piece;
        }
        if !seen || sums.depth[0] > DEPTH_AT_ONCE {
            return sums;
        }
        for (node, glow) in glow.iter().enumerate() {
            let row = &rule.running[node];
            let in_front: f64 = row.iter().zip(&density).map(|(m, d)| m * d).sum::<f64>() * piece;
            let light = (-in_front).exp() * piece;
            for (c, glow) in glow.iter().enumerate() {
                sums.color[0][c] += rule.kronrod[node] * glow * light;
                sums.color[1][c] += rule.gauss[node] * glow * light;
            }
        }
        sums
    }
}
