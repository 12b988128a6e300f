//! Piecewise-linear widgets along a segment, for the ordered integral. Twin of `optics::kinds::piecewise_linear`; alone on a
//! segment such a widget is cut into pieces of linear extinction instead (module `linear`).
//!
//! s counts from the first control point, formed in 64 bits before rounding.

use super::quadrature::POINTS;
use super::track::{LaneTrack, PASSED, at_nodes};
use crate::{Float, Lanes, Mask};
use voltet_core::transfer::ControlPoint;

/// Control points made ready for lanes.
#[derive(Debug, Clone, PartialEq)]
pub struct LanePoints {
    points: Vec<LanePoint>,
    /// The s at which the extinction bends or passes the threshold of glowing.
    levels: Vec<f32>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct LanePoint {
    s: f32,
    /// 1/(s − s of the point before); 0 for a step.
    inverse: f32,
    extinction: f32,
    color: [f32; 3],
}

impl LanePoints {
    /// From at least one control point; `cutoff` for the constant-emitter.
    pub fn new(points: &[ControlPoint], cutoff: Option<f64>) -> Self {
        let origin = points[0].s;
        let threshold =
            cutoff.map(|cutoff| cutoff * points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak)));
        let mut levels: Vec<f32> = points.iter().map(|p| (p.s - origin) as f32).collect();
        for pair in points.windows(2) {
            let Some(threshold) = threshold else { break };
            let share = (threshold - pair[0].extinction) / (pair[1].extinction - pair[0].extinction);
            if share > 0.0 && share < 1.0 {
                levels.push(((pair[0].s - origin) + share * (pair[1].s - pair[0].s)) as f32);
            }
        }
        let ready = |i: usize| {
            let span = if i > 0 { points[i].s - points[i - 1].s } else { 0.0 };
            LanePoint {
                s: (points[i].s - origin) as f32,
                inverse: if span > 0.0 { (1.0 / span) as f32 } else { 0.0 },
                extinction: points[i].extinction as f32,
                color: points[i].color.map(|c| c as f32),
            }
        };
        LanePoints { points: (0..points.len()).map(ready).collect(), levels }
    }

    /// Calls `f` with each further point and its share at s: what was before it is blended with it by that share.
    #[inline(always)]
    fn blend<L: Lanes>(&self, s: L::F, mut f: impl FnMut(&LanePoint, L::F)) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        for pair in self.points.windows(2) {
            let from = splat(pair[0].s);
            let share = ((s - from) * splat(pair[1].inverse)).max(zero).min(one);
            let step = if pair[1].inverse == 0.0 { L::F::select(from.le(s), one, zero) } else { share };
            f(&pair[1], step);
        }
    }

    /// Extinction at s.
    #[inline(always)]
    pub fn extinction<L: Lanes>(&self, s: L::F) -> L::F {
        let mut sum = L::F::splat(self.points[0].extinction);
        self.blend::<L>(
            s,
            inlined!(|point: &LanePoint, share: L::F| sum =
                share.mul_add(L::F::splat(point.extinction) - sum, sum)),
        );
        sum
    }

    /// Colour at s.
    #[inline(always)]
    pub fn color<L: Lanes>(&self, s: L::F) -> [L::F; 3] {
        let mut sum: [L::F; 3] = array!(|c| L::F::splat(self.points[0].color[c]));
        self.blend::<L>(
            s,
            inlined!(|point: &LanePoint, share: L::F| {
                for (sum, c) in sum.iter_mut().zip(point.color) {
                    *sum = share.mul_add(L::F::splat(c) - *sum, *sum);
                }
            }),
        );
        sum
    }
}

/// A piecewise-linear widget as a [`LaneTrack`].
#[derive(Clone, Copy)]
pub struct LanePiecewiseTrack<'a, L: Lanes> {
    /// Its control points.
    pub points: &'a LanePoints,
    /// s − s of the first control point at the front.
    pub front: L::F,
    /// Value at the back.
    pub back: L::F,
    /// D/U.
    pub scale: L::F,
}

impl<L: Lanes> LaneTrack<L> for LanePiecewiseTrack<'_, L> {
    #[inline(always)]
    fn rates(&self, t: L::F, dt: L::F) -> [L::F; POINTS] {
        let s = at_nodes::<L>(self.front, self.back, t, dt);
        array!(|i| self.scale * self.points.extinction::<L>(s[i]))
    }

    #[inline(always)]
    fn next_break(&self, t: L::F) -> L::F {
        let splat = L::F::splat;
        let span = self.back - self.front;
        let inverse = L::F::select(span.abs().lt(splat(f32::MIN_POSITIVE)), splat(0.0), splat(1.0) / span);
        let (past, mut next) = (t + splat(PASSED), splat(2.0));
        for level in &self.points.levels {
            let at = (splat(*level) - self.front) * inverse;
            next = L::F::select(past.lt(at).and(at.lt(next)), at, next);
        }
        next
    }
}
