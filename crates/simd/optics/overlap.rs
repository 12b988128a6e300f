//! Several widgets on one segment: the ordered integral ∫ Σ cᵢ ρᵢ e^(−T) dl. Twin of `optics::overlap`.
//!
//! As there, a panel ends at the breaks of every widget and holds a depth of at most 2.5; e^(−T) within it comes from
//! the rates at its 8 points (module `track`). The optical depth of the whole segment, and so its opacity, is the sum
//! of the widgets' closed forms, not of panels.

use super::gaussian::LaneGaussianTrack;
use super::piecewise_linear::LanePiecewiseTrack;
use super::quadrature::{PANEL, POINTS};
use super::table::LaneTableTrack;
use super::track::{LaneTrack, PASSED, Walk, at_nodes};
use crate::{Float, Lanes, Mask};

/// Panels before a walk is given up; only waves of thousands of bands need as many.
const MAX_PANELS: usize = 1 << 14;

/// A widget's rate along the segment. Waves and triangular Gaussians have none: 64 bits put them in order.
#[derive(Clone, Copy)]
pub enum AnyLaneTrack<'a, L: Lanes> {
    /// Constant rate.
    Uniform(L::F),
    /// A Gaussian.
    Gaussian(LaneGaussianTrack<L>),
    /// Linear between control points.
    Piecewise(LanePiecewiseTrack<'a, L>),
    /// An image.
    Table(LaneTableTrack<'a, L>),
}

impl<L: Lanes> LaneTrack<L> for AnyLaneTrack<'_, L> {
    #[inline(always)]
    fn rates(&self, t: L::F, dt: L::F) -> [L::F; POINTS] {
        match self {
            AnyLaneTrack::Uniform(rate) => [*rate; POINTS],
            AnyLaneTrack::Gaussian(track) => track.rates(t, dt),
            AnyLaneTrack::Piecewise(track) => track.rates(t, dt),
            AnyLaneTrack::Table(track) => track.rates(t, dt),
        }
    }

    #[inline(always)]
    fn next_break(&self, t: L::F) -> L::F {
        match self {
            AnyLaneTrack::Uniform(_) => L::F::splat(2.0),
            AnyLaneTrack::Gaussian(track) => track.next_break(t),
            AnyLaneTrack::Piecewise(track) => track.next_break(t),
            AnyLaneTrack::Table(track) => track.next_break(t),
        }
    }
}

/// A widget that takes part in the ordered integral.
#[derive(Clone, Copy)]
pub struct LaneMember<'a, L: Lanes> {
    /// Its rate, defined over the whole segment.
    pub track: AnyLaneTrack<'a, L>,
    /// The part of the segment inside its region, [t₀, t₁]; t₁ ≤ t₀ where there is none.
    pub range: [L::F; 2],
    /// The part where it glows (constant-emitter); [0, 1] for control points, which break there themselves.
    pub window: [L::F; 2],
    /// Its colour; control points hold their own.
    pub color: [f32; 3],
    /// Profile, or extinction of control points, above which it glows.
    pub threshold: f32,
    /// The rate at which the profile, or the extinction of control points, is 1.
    pub unit_rate: L::F,
}

impl<L: Lanes> LaneMember<'_, L> {
    #[inline(always)]
    fn next_break(&self, t: L::F) -> L::F {
        let past = t + L::F::splat(PASSED);
        let [start, end] = self.range;
        let mut next = self.track.next_break(t);
        for at in [self.window[0], self.window[1], end] {
            next = L::F::select(past.lt(at).and(at.lt(next)), at, next);
        }
        // Before its range only the start matters, after it nothing.
        next = L::F::select(past.lt(start), start, next);
        L::F::select(end.le(past).or(end.le(start)), L::F::splat(2.0), next)
    }

    #[inline(always)]
    fn holds(range: &[L::F; 2], t: L::F) -> L::M {
        range[0].le(t).and(t.le(range[1])).and(range[0].lt(range[1]))
    }
}

/// C of the whole segment. `glow`: D/U for the constant-emitter, none for the
/// density-emitter. Relative error some 1e-5 (1 + condition). Also the points of all lanes' panels.
#[inline(always)]
pub fn ordered<L: Lanes>(members: &[LaneMember<L>], glow: Option<L::F>) -> ([L::F; 3], u64) {
    let splat = L::F::splat;
    let (zero, half) = (splat(0.0), splat(0.5));
    let mut color = [zero; 3];
    let mut walk = Walk::<L>::start();
    let mut rates = vec![[zero; POINTS]; members.len()];
    let mut points = 0;
    for _ in 0..MAX_PANELS {
        let open = walk.open().bits();
        if open == 0 {
            break;
        }
        points += u64::from(open.count_ones()) * POINTS as u64;
        let mut next = splat(1.0);
        for member in members {
            next = next.min(member.next_break(walk.t));
        }
        let (t, dt) = (walk.t, walk.panel(next));
        let middle = half.mul_add(dt, t);
        let mut total = [zero; POINTS];
        for (member, rates) in members.iter().zip(&mut rates) {
            let present = LaneMember::<L>::holds(&member.range, middle);
            *rates = member.track.rates(t, dt);
            for (rate, sum) in rates.iter_mut().zip(&mut total) {
                *rate = L::F::select(present, *rate, zero);
                *sum = *sum + *rate;
            }
        }
        let seen = walk.take(next, dt, &total);
        for (member, rates) in members.iter().zip(&rates) {
            let mut strength = seen;
            match glow {
                None => {
                    for (strength, rate) in strength.iter_mut().zip(rates) {
                        *strength = *strength * *rate;
                    }
                }
                Some(scale) => {
                    // Between breaks the profile is monotone or far above the cutoff: its middle tells.
                    let at_middle = half * (rates[POINTS / 2 - 1] + rates[POINTS / 2]);
                    let present = LaneMember::<L>::holds(&member.range, middle);
                    let lit = (splat(member.threshold) * member.unit_rate).lt(at_middle).and(present);
                    let lit = lit.and(LaneMember::<L>::holds(&member.window, middle));
                    for strength in &mut strength {
                        *strength = L::F::select(lit, *strength * scale, zero);
                    }
                }
            }
            if let AnyLaneTrack::Piecewise(track) = &member.track {
                let s = at_nodes::<L>(track.front, track.back, t, dt);
                for (strength, s) in strength.iter().zip(s) {
                    for (sum, c) in color.iter_mut().zip(track.points.color::<L>(s)) {
                        *sum = strength.mul_add(c, *sum);
                    }
                }
            } else if let AnyLaneTrack::Table(track) = &member.track {
                for (i, strength) in strength.iter().enumerate() {
                    let texel = track.texel(dt.mul_add(splat(PANEL[i].0), t));
                    for (sum, c) in color.iter_mut().zip(texel) {
                        *sum = strength.mul_add(c, *sum);
                    }
                }
            } else {
                let mut all = strength[0];
                for strength in &strength[1..] {
                    all = all + *strength;
                }
                for (sum, c) in color.iter_mut().zip(member.color) {
                    *sum = all.mul_add(splat(c), *sum);
                }
            }
        }
    }
    (color, points)
}
