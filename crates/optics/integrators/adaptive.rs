//! Closed forms, subdivided until the error of (C, A) is under a tolerance; Song et al. 2009, section 7, name it as
//! future work.
//!
//! A is a closed form whatever overlaps, and so is C of a widget alone in most cases: nothing is subdivided there.
//! Where widgets overlap, only their order is unknown. Symbols: piece, a part of the segment with depths Tᵢ of its
//! widgets, T = Σ Tᵢ, A = 1 − e^(−T); Eᵢ = ∫ ρᵢ e^(−T), so that C = Σ cᵢ Eᵢ and Σ Eᵢ = A.
//!
//! **Mix.** Kniss's mix takes Mᵢ = A Tᵢ/T for Eᵢ. Whatever the order, a widget is seen no better than in front of all
//! others and no worse than behind them: e^(−(T − Tᵢ)) (1 − e^(−Tᵢ)) ≤ Eᵢ ≤ 1 − e^(−Tᵢ). With x = E − M within
//! [−d, u] of those bounds and Σ x = 0, each channel's error is Σ (cᵢ − c̄) xᵢ for any c̄, at most
//! Σ (cᵢ − c̄)⁺ uᵢ + (c̄ − cᵢ)⁺ dᵢ. That is a bound, not an estimate, and falls with the square of the piece.
//! For the constant-emitter Eᵢ = ∫ e^(−T) over the lit length ℓᵢ lies between ℓᵢ e^(−T) and ℓᵢ.
//!
//! **Panel.** Where pieces short enough for the mix are dearer, a stretch between two breaks of all widgets (module
//! `overlap`), of depth 2 at most, takes Gauss–Legendre quadrature of as few points as the tolerance allows; the
//! error of each rule is a constant, measured over all widgets (`RULES`), times the light at stake.
//!
//! The tolerance is spent from front to back in proportion to the light that a piece gives of what is left, so its
//! sum over the segment is kept. Where it is under the rounding of C (a bright constant-emitter on a long segment),
//! 12 points are taken, which leave 1e-12 of C.

#[cfg(test)]
mod tests;

use super::integrator::{Extent, Integrator, IntegratorKind, SegmentIntegrator, can_serve};
use crate::kinds::TrackColor;
use crate::overlap::{self, Glow, Member, Panel, Quadrature, add, blur, blurred, ordered, present_at};
use crate::quadrature::{GAUSS_4, GAUSS_5, GAUSS_8, GAUSS_12, Node, UP_TO_4, UP_TO_5, UP_TO_8};
use crate::special::{mean_transmittance, opacity};
use crate::track::{Track, limit_panel};
use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};
use voltet_core::transfer::{TransferFunction, Widget};

const TOLERANCE_PARAMETER: Parameter = Parameter {
    name: TOLERANCE,
    parameter_type: ParameterType::Number(Range { above_min: true, ..Range::within(0.0, 1.0) }),
    unit: "",
    default: DefaultValue::Number(1e-3),
    help: "largest error of colour and opacity of a ray segment",
};

const TOLERANCE: &str = "tolerance";

/// Closed forms, subdivided to a tolerance.
#[derive(Debug, Clone)]
pub struct Adaptive {
    prepared: CompiledTransferFunction,
    quadrature: Subdivided,
}

impl Adaptive {
    /// Serves every transfer function. `tolerance` > 0: the largest error of each channel of C and of A.
    pub fn new(transfer_function: &TransferFunction, tolerance: f64) -> Result<Self> {
        can_serve(&Integrator::adaptive(tolerance), transfer_function)?;
        let varying = transfer_function.widgets.iter().filter(|widget| widget.has_colors_of_its_own());
        let varying = varying.map(Widget::max_emission).fold(0.0, f64::max);
        let prepared = CompiledTransferFunction::new(transfer_function)?;
        Ok(Adaptive { prepared, quadrature: Subdivided { tolerance, varying } })
    }
}

impl Integrator {
    /// Closed forms, subdivided until the error of (C, A) is under the tolerance, which is above 0.
    pub const fn adaptive(tolerance: f64) -> Integrator {
        Integrator::with_settings(&AdaptiveKind, [tolerance])
    }

    /// Largest error that `adaptive` allows; `None` for the other kinds.
    pub fn tolerance(&self) -> Option<f64> {
        self.setting(TOLERANCE).filter(|_| self.is_kind_of(&Integrator::adaptive(1.0)))
    }
}

pub(super) struct AdaptiveKind;

impl IntegratorKind for AdaptiveKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "adaptive",
            summary: "closed forms, subdivided until the error is under the tolerance",
            parameters: &[TOLERANCE_PARAMETER],
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        match integrator.setting(TOLERANCE) {
            Some(tolerance) if tolerance > 0.0 && tolerance.is_finite() => Ok(()),
            other => Err(integrator.out_of_range(TOLERANCE, other.unwrap_or(0.0), "a number above 0")),
        }
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Adaptive::new(transfer_function, integrator.setting(TOLERANCE).unwrap_or(0.0))?))
    }
}

impl SegmentIntegrator for Adaptive {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.prepared.integrate_by(segment, WidgetBlend::Exact, &self.quadrature)
    }
}

/// The quadrature to a tolerance.
#[derive(Debug, Clone)]
struct Subdivided {
    tolerance: f64,
    /// The largest channel of the widgets whose colour varies.
    varying: f64,
}

impl Quadrature for Subdivided {
    const ALONE: bool = true;

    fn color(&self, members: &[Member], glow: Glow) -> [f64; 3] {
        if members.len() > MAX_MEMBERS {
            return ordered(members, glow);
        }
        March::new(members, glow, self).run()
    }
}

/// The way from front to back.
struct March<'a> {
    members: &'a [Member<'a>],
    glow: Glow,
    /// The largest channel of any colour, times D/U for the constant-emitter.
    brightest: f64,
    /// True if some colour is not determined by its values at two points.
    only_panels: bool,
    t: f64,
    rest: f64,
    /// T in front of t.
    front: f64,
    /// T behind t.
    behind: f64,
    /// Rest of the tolerance.
    left: f64,
    color: [f64; 3],
}

impl<'a> March<'a> {
    fn new(members: &'a [Member<'a>], glow: Glow, settings: &Subdivided) -> Self {
        let scale = if let Glow::Constant(scale) = glow { scale * members.len() as f64 } else { 1.0 };
        let one = |m: &Member| m.color.into_iter().fold(0.0, f64::max);
        let channel = |m: &Member| if m.has_one_color() { one(m) } else { settings.varying };
        let brightest = members.iter().map(channel).fold(0.0, f64::max);
        March {
            members,
            glow,
            brightest: brightest * scale,
            only_panels: members.iter().any(|m| m.track.color() == TrackColor::Curved),
            t: 0.0,
            rest: 1.0,
            front: 0.0,
            behind: members.iter().map(|m| depth_within(m, 0.0, 1.0)).sum(),
            left: settings.tolerance,
            color: [0.0; 3],
        }
    }

    fn run(mut self) -> [f64; 3] {
        // How far the mix is thought to reach, and whether that is far enough to try.
        let (mut step, mut worth, mut again) = (1.0_f64, true, false);
        while self.rest > 0.0 {
            let seen = (-self.front).exp();
            // What absorbs may stand behind what glows: all of the rest may be seen.
            let at_stake = match self.glow {
                Glow::Density => seen * self.brightest * opacity(self.behind),
                Glow::Constant(_) => seen * self.brightest * self.rest,
            };
            if at_stake <= 1e-3 * self.left {
                break;
            }
            if at_stake <= 4.0 * self.left && !again {
                (step, worth) = (self.rest, true);
            }
            let length = step.min(self.rest).min(self.mixable());
            let mut shorter = 0.0;
            again = false;
            if worth && !self.only_panels && blurred(self.t, length).is_none() {
                let mixed = mix(self.members, self.glow, self.t, length);
                let (error, allowed) = (seen * mixed.error, self.allowed(length, mixed.depth));
                if error <= allowed {
                    self.accept(length, seen, error, &mixed);
                    step = length * (0.7 * allowed / error).clamp(1.0, 8.0);
                    continue;
                }
                shorter = length * (0.7 * allowed / error).min(0.5);
            }
            let (length, depth) = self.panel_length();
            if length <= 0.0 {
                // The next break is within rounding of t: step over it.
                self.t = self.next_break().max(self.t.next_up());
                self.rest = 1.0 - self.t;
                continue;
            }
            if let Some(length) = blurred(self.t, length) {
                self.blur(length.min(self.rest));
                continue;
            }
            let allowed = self.allowed(length, depth);
            let stake = seen * self.brightest * self.panel_stake(length, depth);
            let rule = RULES.iter().find(|(_, share)| stake * share <= allowed);
            let (points, error) =
                rule.map_or((GAUSS_12.len(), 0.0), |(points, share)| (*points, stake * share));
            step = shorter;
            again = shorter * points as f64 > length;
            if !again {
                // A mix costs about what a point does.
                worth = shorter * points as f64 > 0.25 * length;
                let color = panel(self.members, self.glow, self.t, length, points);
                self.accept(length, seen, error, &Estimate { color, error, depth });
            }
        }
        self.color
    }

    /// Takes a stretch whose places are not told apart.
    fn blur(&mut self, dt: f64) {
        let mut color = [0.0; 3];
        let depth =
            blur(&mut color, self.members, self.glow, &Panel { t: self.t, dt, seen: 1.0, middle: self.t });
        self.accept(dt, (-self.front).exp(), 0.0, &Estimate { color, error: 0.0, depth });
    }

    fn accept(&mut self, length: f64, seen: f64, error: f64, piece: &Estimate) {
        for (sum, c) in self.color.iter_mut().zip(piece.color) {
            *sum += seen * c;
        }
        self.left = (self.left - error).max(0.0);
        self.front += piece.depth;
        self.behind = (self.behind - piece.depth).max(0.0);
        self.t += length;
        self.rest = if length >= self.rest { 0.0 } else { 1.0 - self.t };
    }

    /// Light of brightness 1 from a stretch of that length and depth.
    fn light(&self, length: f64, depth: f64) -> f64 {
        match self.glow {
            Glow::Density => opacity(depth),
            Glow::Constant(_) => length * mean_transmittance(depth),
        }
    }

    /// The error that a piece may have: its part of the light that is left.
    fn allowed(&self, length: f64, depth: f64) -> f64 {
        if length >= self.rest {
            return self.left;
        }
        let share = self.light(length, depth) / self.light(self.rest, self.behind.max(depth));
        // No light: nothing can be wrong with it.
        if share < 1.0 { self.left * share } else { self.left }
    }

    /// End of the mix at most: a colour that varies, or an emission of many windows, is determined up to its next break.
    fn mixable(&self) -> f64 {
        let limited =
            |m: &&Member| !m.has_one_color() || (self.glow != Glow::Density && m.track.glows_in_parts());
        self.members
            .iter()
            .filter(limited)
            .map(|m| m.next_break(self.t) - self.t)
            .fold(f64::INFINITY, f64::min)
    }

    fn next_break(&self) -> f64 {
        self.members.iter().map(|m| m.next_break(self.t)).fold(f64::INFINITY, f64::min)
    }

    /// Length and depth of the panel from t on.
    fn panel_length(&self) -> (f64, f64) {
        let next = self.next_break();
        let whole = if next < 1.0 { (next - self.t).min(self.rest) } else { self.rest };
        let middle = self.t + 0.5 * whole;
        let total =
            |f: &dyn Fn(&Member) -> f64| self.members.iter().filter(present_at(middle)).map(f).sum::<f64>();
        limit_panel(self.t, whole, total(&|m| m.track.rate(self.t)), |dt| {
            total(&|m| m.track.depth(self.t, dt))
        })
    }

    /// Scale of the error of a panel, for brightness 1. The breaks do not resolve what is fainter than
    /// e^(−42) of a widget's peak.
    fn panel_stake(&self, length: f64, depth: f64) -> f64 {
        const UNRESOLVED: f64 = 1e-12;
        match self.glow {
            Glow::Density => depth.max(UNRESOLVED),
            Glow::Constant(_) => length * opacity(depth.max(UNRESOLVED)),
        }
    }
}

/// Largest number of widgets that are subdivided together; more of them take the ordered integral to working precision.
const MAX_MEMBERS: usize = 16;

/// Contribution of a piece, and a bound of the error of its channels.
struct Estimate {
    color: [f64; 3],
    error: f64,
    depth: f64,
}

/// The mix of the piece [t, t + length].
fn mix(members: &[Member], glow: Glow, t: f64, length: f64) -> Estimate {
    let end = t + length;
    let mut depths = [0.0; MAX_MEMBERS];
    let mut depth = 0.0;
    for (slot, member) in depths.iter_mut().zip(members) {
        *slot = depth_within(member, t, length);
        depth += *slot;
    }
    let mut sum = MixBounds::default();
    match glow {
        Glow::Density => {
            let dimmed = mean_transmittance(depth);
            for (member, &own) in members.iter().zip(&depths) {
                let most = opacity(own);
                let share = dimmed * own;
                let least = (own - depth).exp() * most;
                sum.add(&ends(member, t, end), share, (most - share).max(0.0), (share - least).max(0.0));
            }
        }
        Glow::Constant(scale) => {
            let through = (-depth).exp();
            for member in members {
                let lit = scale * lit_length(member, t, end);
                if lit > 0.0 {
                    let slack = 0.5 * lit * opacity(depth);
                    sum.add(&ends(member, t, end), 0.5 * lit * (1.0 + through), slack, slack);
                }
            }
        }
    }
    Estimate { color: sum.color(), error: sum.error(glow == Glow::Density), depth }
}

/// Depth of a widget over a piece, as far as it lies in the widget's region.
fn depth_within(member: &Member, t: f64, length: f64) -> f64 {
    let end = t + length;
    if member.range[0] <= t && end <= member.range[1] {
        return member.track.depth_over(t, length);
    }
    let (start, end) = (t.max(member.range[0]), end.min(member.range[1]));
    if start < end { member.track.depth_over(start, end - start) } else { 0.0 }
}

/// The length over which a widget glows between t and `end`.
fn lit_length(member: &Member, t: f64, end: f64) -> f64 {
    let start = t.max(member.range[0]).max(member.window[0]);
    let end = end.min(member.range[1]).min(member.window[1]);
    let lit = start < end && member.track.rate(0.5 * (start + end)) > member.threshold * member.unit_rate;
    if lit { end - start } else { 0.0 }
}

/// Colours at both ends of a piece, between which a widget's colour is linear.
fn ends(member: &Member, t: f64, end: f64) -> [[f64; 3]; 2] {
    if member.has_one_color() { [member.color; 2] } else { [member.color_at(t), member.color_at(end)] }
}

/// Sums of a mix: per channel the light, and what it takes to bound the error.
#[derive(Default)]
struct MixBounds {
    parts: [MixedWidget; MAX_MEMBERS],
    count: usize,
}

/// A widget of a mix: its colour, its light, and by how much that can be too small and too large.
#[derive(Default, Clone, Copy)]
struct MixedWidget {
    middle: [f64; 3],
    /// Half the range of each channel.
    half: [f64; 3],
    light: f64,
    above: f64,
    below: f64,
}

impl MixBounds {
    /// A widget with its light, and by how much that can be too small and too large.
    fn add(&mut self, ends: &[[f64; 3]; 2], light: f64, above: f64, below: f64) {
        let middle = std::array::from_fn(|i| 0.5 * (ends[0][i] + ends[1][i]));
        let half = std::array::from_fn(|i| 0.5 * (ends[0][i] - ends[1][i]).abs());
        self.parts[self.count] = MixedWidget { middle, half, light, above, below };
        self.count += 1;
    }

    fn parts(&self) -> &[MixedWidget] {
        &self.parts[..self.count]
    }

    fn color(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.parts().iter().map(|p| p.light * p.middle[i]).sum())
    }

    /// The largest channel's error; `kept`: the sum of all light is known.
    fn error(&self, kept: bool) -> f64 {
        let whole: f64 = self.parts().iter().map(|p| p.light).sum();
        let color = self.color();
        let channel = |i: usize| {
            let mean = if kept && whole > 0.0 { color[i] / whole } else { 0.0 };
            let (mut up, mut down, mut varies) = (0.0, 0.0, 0.0);
            for p in self.parts() {
                let (more, less) = ((p.middle[i] - mean).max(0.0), (mean - p.middle[i]).max(0.0));
                up += more * p.above + less * p.below;
                down += more * p.below + less * p.above;
                varies += p.half[i] * (p.light + p.above);
            }
            f64::max(up, down) + varies
        };
        (0..3).map(channel).fold(0.0, f64::max)
    }
}

/// Points and the error of quadrature by so many, as a share of the depth (density-emitter) or of length times
/// opacity (constant-emitter) of a panel: five times the largest found on the panels of 2·10⁵ random segments through
/// one to three random widgets. A test repeats a part of them.
const RULES: [(usize, f64); 3] = [(4, 4e-2), (5, 7e-3), (8, 2e-5)];

/// Light of one panel, without what stands in front of it.
fn panel(members: &[Member], glow: Glow, t: f64, length: f64, points: usize) -> [f64; 3] {
    match points {
        4 => gauss(&GAUSS_4, &UP_TO_4, members, glow, t, length),
        5 => gauss(&GAUSS_5, &UP_TO_5, members, glow, t, length),
        8 => gauss(&GAUSS_8, &UP_TO_8, members, glow, t, length),
        _ => {
            let mut color = [0.0; 3];
            overlap::panel(
                &mut color,
                members,
                glow,
                &Panel { t, dt: length, seen: 1.0, middle: t + 0.5 * length },
            );
            color
        }
    }
}

fn gauss<const N: usize>(
    nodes: &[Node; N],
    up_to: &[[f64; N]; N],
    members: &[Member],
    glow: Glow,
    t: f64,
    length: f64,
) -> [f64; 3] {
    let middle = t + 0.5 * length;
    let mut rates = [[0.0; N]; MAX_MEMBERS];
    let mut total = [0.0; N];
    for (rates, member) in rates.iter_mut().zip(members.iter().filter(present_at(middle))) {
        for (k, &(x, _)) in nodes.iter().enumerate() {
            rates[k] = member.track.rate(t + length * x);
            total[k] += rates[k];
        }
    }
    // Depths from the rates themselves: with so few points a closed form adds nothing.
    let depth = up_to.map(|row| length * row.iter().zip(total).map(|(a, rate)| a * rate).sum::<f64>());
    let seen: [f64; N] = std::array::from_fn(|k| length * nodes[k].1 * (-depth[k]).exp());
    let mut color = [0.0; 3];
    for (rates, member) in rates.iter().zip(members.iter().filter(present_at(middle))) {
        let lit = glow == Glow::Density || member.track.rate(middle) > member.threshold * member.unit_rate;
        if !lit {
            continue;
        }
        let mut one = 0.0;
        for (k, &(x, _)) in nodes.iter().enumerate() {
            let light = match glow {
                Glow::Density => seen[k] * rates[k],
                Glow::Constant(scale) => seen[k] * scale,
            };
            if member.has_one_color() {
                one += light;
            } else {
                add(&mut color, light, member.color_at(t + length * x));
            }
        }
        add(&mut color, one, member.color);
    }
    color
}

#[cfg(test)]
mod rule_tests {
    use super::*;
    use crate::tests::segment;
    use proptest::strategy::{Strategy, ValueTree};
    use proptest::test_runner::TestRunner;
    use voltet_testing::random::transfer_function;

    /// The largest error of each rule, as a share of what is at stake, over the panels of random segments.
    #[test]
    fn rules_err_by_less_than_their_constants() {
        let mut worst = [0.0_f64; 3];
        let mut runner = TestRunner::deterministic();
        let strategy = (transfer_function(), segment(), 0.05..1.0_f64);
        for _ in 0..10_000 {
            let (transfer_function, segment, shrink) =
                strategy.new_tree(&mut runner).expect("a case").current();
            let adaptive = Adaptive::new(&transfer_function, 1e-3).expect("valid");
            let seen = Observer { varying: adaptive.quadrature.varying, shrink, worst: worst.into() };
            adaptive.prepared.integrate_by(&segment, WidgetBlend::Exact, &seen);
            worst = seen.worst.get();
        }
        println!("{worst:?}");
        for (found, (points, constant)) in worst.iter().zip(RULES) {
            assert!(5.0 * found <= constant, "{points} points: {found}");
        }
    }

    struct Observer {
        varying: f64,
        shrink: f64,
        worst: std::cell::Cell<[f64; 3]>,
    }

    impl Quadrature for Observer {
        const ALONE: bool = true;

        fn color(&self, members: &[Member], glow: Glow) -> [f64; 3] {
            let mut march = March::new(members, glow, &Subdivided { tolerance: 1.0, varying: self.varying });
            for _ in 0..1000 {
                let (mut length, mut depth) = march.panel_length();
                if length <= 0.0 || march.rest <= 0.0 {
                    break;
                }
                // Panels also begin between breaks.
                length *= self.shrink;
                let middle = march.t + 0.5 * length;
                let t = march.t;
                depth = depth
                    .min(members.iter().filter(present_at(middle)).map(|m| m.track.depth(t, length)).sum());
                let exact = panel(members, glow, t, length, 12);
                let stake = march.brightest * march.panel_stake(length, depth);
                let mut worst = self.worst.get();
                for (worst, (points, _)) in worst.iter_mut().zip(RULES) {
                    let found = panel(members, glow, t, length, points);
                    for (a, b) in found.iter().zip(exact) {
                        // Below, rounding.
                        let error = (a - b).abs() - 1e-12 * b;
                        *worst = worst.max(error / stake);
                    }
                }
                self.worst.set(worst);
                march.accept(length, 0.0, 0.0, &Estimate { color: [0.0; 3], error: 0.0, depth: 0.0 });
            }
            [0.0; 3]
        }
    }
}
