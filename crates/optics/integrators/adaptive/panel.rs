//! One panel by Gauss–Legendre quadrature of few points (see the head of module `adaptive`).

use super::mix::MAX_MEMBERS;
use crate::overlap::{self, Glow, Member, Panel};
use crate::quadrature::{GAUSS_4, GAUSS_5, GAUSS_8, Node, UP_TO_4, UP_TO_5, UP_TO_8};
use crate::track::Track;

/// Points and the error of quadrature by so many, as a share of the depth (density-emitter) or of length times
/// opacity (constant-emitter) of a panel: five times the largest found on the panels of 2·10⁵ random segments through
/// one to three random widgets. A test repeats a part of them.
pub const RULES: [(usize, f64); 3] = [(4, 4e-2), (5, 7e-3), (8, 2e-5)];

/// True if a widget's region holds the place t.
pub fn present_at(t: f64) -> impl Fn(&&Member) -> bool {
    move |m| m.range[0] <= t && t <= m.range[1]
}

/// Light of one panel, without what stands in front of it.
pub fn panel(members: &[Member], glow: Glow, t: f64, length: f64, points: usize) -> [f64; 3] {
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

fn add(sum: &mut [f64; 3], light: f64, color: [f64; 3]) {
    for (sum, c) in sum.iter_mut().zip(color) {
        *sum += light * c;
    }
}

#[cfg(test)]
mod tests {
    use super::super::mix::Estimate;
    use super::super::{Adaptive, March, Subdivided};
    use super::*;
    use crate::WidgetBlend;
    use crate::arbitrary::{segment, transfer_function};
    use crate::overlap::Quadrature;
    use proptest::strategy::{Strategy, ValueTree};
    use proptest::test_runner::TestRunner;

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
            let seen = Observer { varying: adaptive.varying, shrink, worst: worst.into() };
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
