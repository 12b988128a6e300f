//! Piecewise-linear widgets: colour and extinction linear between control points in s, constant beyond them.
//!
//! Symbols: s_f, s_b the scalar at the segment's ends; sᵢ the control points; on each piece the extinction,
//! the colour and s are linear in t, so a piece is a stretch of linear extinction (module `linear`).
//! Sources: Roettger & Ertl 2002, section 2; Moreland 2004, Eq. 50 to 52, with absolute values of Δs. The
//! share of a piece comes from the control points, not from a difference of two t, and a flat segment is one
//! piece of weight 1.

use crate::clip::ClippedSpan;
use crate::linear::{emission_weights, front_back};
use crate::special::OPAQUE_DEPTH;
use crate::track::Track;
use voltet_core::transfer::ControlPoint;

/// A piecewise-linear widget along one segment.
#[derive(Debug, Clone, Copy)]
pub struct PiecewisePath<'a> {
    points: &'a [ControlPoint],
    front: f64,
    back: f64,
}

/// One piece: a stretch of linear extinction and colour.
pub struct LinearPiece {
    /// Its length as a share of the segment.
    pub share: f64,
    /// Extinction at its front and back.
    pub extinction: [f64; 2],
    /// Colour at its front and back.
    pub color: [[f64; 3]; 2],
}

/// The part of a piece whose extinction exceeds a threshold.
pub struct Lit {
    /// Its length as a share of the piece.
    pub length: f64,
    /// ∫ extinction over the share of the piece in front of it.
    pub depth_before: f64,
    /// Extinction at its ends.
    pub extinction: [f64; 2],
    /// Colour at its ends.
    pub color: [[f64; 3]; 2],
}

impl LinearPiece {
    /// Part of the piece that glows; of length 0 where nothing does. The crossing of the threshold is taken from
    /// the end that is nearer to it.
    pub fn lit(&self, threshold: f64) -> Lit {
        let [e0, e1] = self.extinction;
        let rise = e1 - e0;
        let (x0, x1, length) = match (e0 > threshold, e1 > threshold) {
            (true, true) => (0.0, 1.0, 1.0),
            (false, false) => (0.0, 0.0, 0.0),
            (true, false) => {
                let x = (threshold - e0) / rise;
                (0.0, x, x)
            }
            (false, true) => ((threshold - e0) / rise, 1.0, (e1 - threshold) / rise),
        };
        let color = |x: f64| -> [f64; 3] {
            std::array::from_fn(|i| self.color[0][i] * (1.0 - x) + self.color[1][i] * x)
        };
        Lit {
            length,
            depth_before: x0 * 0.5 * (e0 + threshold),
            extinction: [if x0 > 0.0 { threshold } else { e0 }, if x1 < 1.0 { threshold } else { e1 }],
            color: [color(x0), color(x1)],
        }
    }
}

impl<'a> PiecewisePath<'a> {
    /// `points` in rising s, at least one.
    pub fn new(points: &'a [ControlPoint], front: f64, back: f64) -> Self {
        PiecewisePath { points, front, back }
    }

    /// Number of control points at or below s at t and t' (= 1 − t): the number of the interval that holds it. By the
    /// difference from each, so that an offset of all numbers costs no digits.
    #[inline]
    fn interval(&self, t: f64, rest: f64) -> usize {
        self.points.partition_point(|point| 0.0 <= self.offset_from(point, t, rest))
    }

    /// s at t and t' (= 1 − t) minus the control point's: each difference from the raw numbers.
    #[inline]
    fn offset(&self, point: usize, t: f64, rest: f64) -> f64 {
        self.offset_from(&self.points[point], t, rest)
    }

    #[inline]
    fn offset_from(&self, point: &ControlPoint, t: f64, rest: f64) -> f64 {
        (self.front - point.s) * rest + (self.back - point.s) * t
    }

    /// Control points at the ends of an interval, and the share of the upper one at t; beyond all of them the last one twice.
    #[inline]
    fn ends(&self, interval: usize, t: f64, rest: f64) -> (&'a ControlPoint, &'a ControlPoint, f64) {
        if interval == 0 || interval == self.points.len() {
            let point = &self.points[interval.saturating_sub(1)];
            return (point, point, 0.0);
        }
        let (low, high) = (&self.points[interval - 1], &self.points[interval]);
        (low, high, (self.offset(interval - 1, t, rest) / (high.s - low.s)).clamp(0.0, 1.0))
    }

    fn extinction_in(&self, interval: usize, t: f64, rest: f64) -> f64 {
        let (low, high, x) = self.ends(interval, t, rest);
        low.extinction * (1.0 - x) + high.extinction * x
    }

    fn color_in(&self, interval: usize, t: f64, rest: f64) -> [f64; 3] {
        let (low, high, x) = self.ends(interval, t, rest);
        std::array::from_fn(|i| low.color[i] * (1.0 - x) + high.color[i] * x)
    }

    /// Calls `f` for each piece from front to back until it returns false.
    pub fn pieces(&self, stretch: &ClippedSpan, mut f: impl FnMut(&LinearPiece) -> bool) {
        let at = |point: usize| (self.points[point].extinction, self.points[point].color);
        let start = (stretch.start, stretch.start_to_back);
        let end = (stretch.end, stretch.end_to_back);
        let mut interval = self.interval(start.0, start.1);
        let last = self.interval(end.0, end.1);
        let mut front =
            (self.extinction_in(interval, start.0, start.1), self.color_in(interval, start.0, start.1));
        if interval == last {
            let back = (self.extinction_in(last, end.0, end.1), self.color_in(last, end.0, end.1));
            f(&LinearPiece {
                share: stretch.length,
                extinction: [front.0, back.0],
                color: [front.1, back.1],
            });
            return;
        }
        let rising = last > interval;
        let span = (self.back - self.front).abs();
        // Length in s from the start, then from each control point passed, to the next one.
        let boundary = |interval: usize| if rising { interval } else { interval - 1 };
        let mut length = self.offset(boundary(interval), start.0, start.1).abs();
        while interval != last {
            let point = boundary(interval);
            let back = at(point);
            let share = length / span;
            if share > 0.0
                && !f(&LinearPiece { share, extinction: [front.0, back.0], color: [front.1, back.1] })
            {
                return;
            }
            front = back;
            interval = if rising { interval + 1 } else { interval - 1 };
            length = if interval == last {
                self.offset(point, end.0, end.1).abs()
            } else {
                (self.points[boundary(interval)].s - self.points[point].s).abs()
            };
        }
        if length > 0.0 {
            let back = (self.extinction_in(last, end.0, end.1), self.color_in(last, end.0, end.1));
            f(&LinearPiece { share: length / span, extinction: [front.0, back.0], color: [front.1, back.1] });
        }
    }

    /// ∫ extinction dt over the stretch.
    pub fn integral(&self, stretch: &ClippedSpan) -> f64 {
        let mut sum = 0.0;
        self.pieces(stretch, |piece| {
            sum += piece.share * 0.5 * (piece.extinction[0] + piece.extinction[1]);
            true
        });
        sum
    }

    /// ∫ c ρ e^(−T) over the stretch: the density-emitter colour. `scale` = D/U turns extinctions into rates.
    pub fn emission(&self, scale: f64, stretch: &ClippedSpan) -> [f64; 3] {
        let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
        self.pieces(stretch, |piece| {
            let [a, b] = piece.extinction.map(|e| e * scale * piece.share);
            let seen = (-depth).exp();
            let (front, back) = emission_weights(a, b);
            for (i, c) in color.iter_mut().enumerate() {
                *c += seen * (front * piece.color[0][i] + back * piece.color[1][i]);
            }
            depth += 0.5 * (a + b);
            depth < OPAQUE_DEPTH
        });
        color
    }

    /// ∫ c e^(−T) dt where the extinction exceeds `threshold`: times D/U the constant-emitter colour.
    pub fn glow(&self, scale: f64, stretch: &ClippedSpan, threshold: f64) -> [f64; 3] {
        let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
        self.pieces(stretch, |piece| {
            let lit = piece.lit(threshold);
            let rate = scale * piece.share;
            if lit.length > 0.0 {
                let seen = (-depth - rate * lit.depth_before).exp();
                let [a, b] = lit.extinction.map(|e| e * rate * lit.length);
                let (front, back) = front_back(a, b);
                for (i, c) in color.iter_mut().enumerate() {
                    *c +=
                        seen * piece.share * lit.length * (front * lit.color[0][i] + back * lit.color[1][i]);
                }
            }
            depth += 0.5 * rate * (piece.extinction[0] + piece.extinction[1]);
            depth < OPAQUE_DEPTH
        });
        color
    }

    /// Colour at t.
    pub fn color(&self, t: f64) -> [f64; 3] {
        let rest = 1.0 - t;
        self.color_in(self.interval(t, rest), t, rest)
    }

    /// Extinction at t.
    pub fn extinction(&self, t: f64) -> f64 {
        let rest = 1.0 - t;
        self.extinction_in(self.interval(t, rest), t, rest)
    }

    /// The next t' > t at which the extinction passes a control point or the threshold of glowing.
    pub fn next_break(&self, t: f64, threshold: Option<f64>) -> f64 {
        let span = self.back - self.front;
        if span == 0.0 {
            return f64::INFINITY;
        }
        let past = t + 1e-15;
        let mut interval = self.interval(t, 1.0 - t);
        loop {
            let point = if span > 0.0 { interval } else { interval.wrapping_sub(1) };
            if point >= self.points.len() {
                return f64::INFINITY;
            }
            let next = (self.points[point].s - self.front) / span;
            if let Some(threshold) = threshold.filter(|_| interval > 0 && interval < self.points.len()) {
                let (low, high) = (&self.points[interval - 1], &self.points[interval]);
                let share = (threshold - low.extinction) / (high.extinction - low.extinction);
                if share > 0.0 && share < 1.0 {
                    let cross = ((low.s - self.front) + share * (high.s - low.s)) / span;
                    if cross > past && cross < next {
                        return cross;
                    }
                }
            }
            if next > past {
                return next;
            }
            interval = if span > 0.0 { interval + 1 } else { interval - 1 };
        }
    }
}

/// A piecewise-linear widget as a [`Track`].
#[derive(Debug, Clone, Copy)]
pub struct PiecewiseTrack<'a> {
    /// The path.
    pub path: PiecewisePath<'a>,
    /// D/U.
    pub scale: f64,
    /// Extinction above which the widget glows (constant-emitter).
    pub threshold: Option<f64>,
}

impl PiecewiseTrack<'_> {
    /// Depth over [t, t + dt], which may pass control points.
    pub fn depth_over(&self, t: f64, dt: f64) -> f64 {
        let end = t + dt;
        let stretch =
            ClippedSpan { start: t, start_to_back: 1.0 - t, end, end_to_back: 1.0 - end, length: dt };
        self.scale * self.path.integral(&stretch)
    }
}

impl Track for PiecewiseTrack<'_> {
    fn rate(&self, t: f64) -> f64 {
        self.scale * self.path.extinction(t)
    }

    fn depth(&self, t: f64, dt: f64) -> f64 {
        // Breaks keep a panel within one piece. Its interval is that of the middle: at the ends, where two control
        // points with one scalar make a step, rounding would tell which side is meant.
        let path = &self.path;
        let (middle, end) = (t + 0.5 * dt, t + dt);
        let interval = path.interval(middle, 1.0 - middle);
        let sum = path.extinction_in(interval, t, 1.0 - t) + path.extinction_in(interval, end, 1.0 - end);
        0.5 * dt * self.scale * sum
    }

    fn next_break(&self, t: f64) -> f64 {
        self.path.next_break(t, self.threshold)
    }
}
