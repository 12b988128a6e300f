//! Triangular Gaussians: exp(−((s − s₀)/(σ g))²), 0 where g ≤ 0, along a straight path.
//!
//! Symbols: δ = s − s₀ and γ = σ g, both linear in t; x = δ/γ, monotone in t. Source: Kniss et al. 2003,
//! section 3.2. There is no elementary integral; Kniss's own (section 5.2.1, g replaced by its mean) errs by
//! up to 0.16 of the mean profile. Here the path is cut where x passes the levels between which 12 points
//! resolve e^(−x²), and where γ has halved or doubled; each panel then errs by under 1e-14.
//!
//! Over several fields the profile is exp(−|q|²/m²), q = K (v − v₀) and m linear in t. The point q/m then moves along a
//! straight line, whatever m does (a projective map takes lines to lines). With e the unit vector along that line and h
//! its distance from 0, |q|²/m² = h² + ((q·e)/m)²: the same as above with δ = q·e and γ = m, times e^(−h²). e is the
//! direction of q_b m_f − q_f m_b, formed as (q_b − q_f) m_f − q_f (m_b − m_f); an error of e by η moves the other end by
//! η |x_b − x_f|, so h is taken at the end with the smaller |x|. Over one field e = ±1 and h = 0.

use crate::clip::ClippedSpan;
use crate::quadrature::{GAUSS_12, mean};
use crate::track::{Track, mean_transmittance_along};

/// A triangular Gaussian along one segment, as a [`Track`] where `peak` is ρ₀ D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangularPath {
    /// δ at front and back.
    offset: [f64; 2],
    /// γ at front and back.
    width: [f64; 2],
    peak: f64,
    /// h²; `peak` holds e^(−h²).
    offset_squared: f64,
    /// Smallest x² on the path: what is e^42 times fainter is negligible.
    min_square: f64,
}

/// |x| between whose values e^(−x²) is resolved; beyond the last, x² grows by [`SQUARE_STEP`].
const LEVELS: [f64; 4] = [0.0, 0.8, 1.9, 2.9];
const SQUARE_STEP: f64 = 6.0;
/// e^(−42) = 6e-19.
const REACH: f64 = 42.0;

impl TriangularPath {
    /// From s − s₀ and σ g at both ends.
    pub fn new(offset: [f64; 2], width: [f64; 2], peak: f64) -> Self {
        let square = |i: usize| {
            let x = offset[i] / width[i];
            if width[i] > 0.0 { x * x } else { f64::INFINITY }
        };
        // γ where δ is 0: what lies behind the foot is not seen.
        let width_there = (offset[0] * width[1] - offset[1] * width[0]) / (offset[0] - offset[1]);
        let crosses = offset[0] * offset[1] <= 0.0 && (width_there > 0.0 || width_there.is_nan());
        let min_square = if crosses { 0.0 } else { square(0).min(square(1)) };
        TriangularPath { offset, width, peak, offset_squared: 0.0, min_square }
    }

    /// Over fields, from q_f, q_b and q_b − q_f, the last formed from raw differences, and m at both ends.
    pub fn over_fields<const N: usize>(
        front: [f64; N],
        back: [f64; N],
        along: [f64; N],
        magnitude: [f64; 2],
        peak: f64,
    ) -> Self {
        let dot = |p: &[f64; N], q: &[f64; N]| p.iter().zip(q).map(|(x, y)| x * y).sum::<f64>();
        let rise = magnitude[1] - magnitude[0];
        let turn: [f64; N] = std::array::from_fn(|i| along[i] * magnitude[0] - front[i] * rise);
        // A point that stays where it is moves in any direction, so in that of its own.
        let unit = unit_vector(&turn).or_else(|| unit_vector(&front)).or_else(|| unit_vector(&back));
        let unit = unit.unwrap_or([0.0; N]);
        let offset = [dot(&front, &unit), dot(&back, &unit)];
        let [from_front, from_back] = [0, 1].map(|end| (offset[end] * magnitude[1 - end]).abs());
        let end = match (magnitude[0] > 0.0, magnitude[1] > 0.0) {
            (true, true) => usize::from(from_back < from_front),
            (front, _) => usize::from(!front),
        };
        let (q, m) = (if end == 0 { &front } else { &back }, magnitude[end]);
        let across = q.iter().zip(&unit).map(|(q, e)| (q - offset[end] * e) / m);
        let offset_squared = if m > 0.0 { across.map(|h| h * h).sum() } else { 0.0 };
        let path = TriangularPath::new(offset, magnitude, peak * (-offset_squared).exp());
        TriangularPath { offset_squared, ..path }
    }

    /// Profile between t₀ and t₁ of a stretch, its own t from 0 to 1.
    fn part(&self, stretch: &ClippedSpan) -> Self {
        let ends = |v: [f64; 2]| [stretch.at_start(v[0], v[1]), stretch.at_end(v[0], v[1])];
        let path = TriangularPath::new(ends(self.offset), ends(self.width), self.peak * stretch.length);
        TriangularPath { offset_squared: self.offset_squared, ..path }
    }

    /// T over the stretch.
    pub fn optical_depth(&self, stretch: &ClippedSpan) -> f64 {
        if *stretch == ClippedSpan::WHOLE { self.depth(0.0, 1.0) } else { self.part(stretch).depth(0.0, 1.0) }
    }

    /// ∫ e^(−T) dt over the part of the stretch where the profile exceeds e^(−`level`).
    pub fn glow(&self, stretch: &ClippedSpan, level: f64) -> f64 {
        let path = self.part(stretch);
        let (start, end) = match path.window_ends(level) {
            Some([start, end]) => (start.max(0.0), end.min(1.0)),
            None => return 0.0,
        };
        if start >= end {
            return 0.0;
        }
        let before = if start > 0.0 { path.depth(0.0, start) } else { 0.0 };
        let lit = ClippedSpan {
            start,
            start_to_back: 1.0 - start,
            end,
            end_to_back: 1.0 - end,
            length: end - start,
        };
        stretch.length * lit.length * (-before).exp() * mean_transmittance_along(&path.part(&lit))
    }

    /// The t between which the profile exceeds e^(−`level`), not clamped to the path.
    pub fn window_ends(&self, level: f64) -> Option<[f64; 2]> {
        let level = level - self.offset_squared;
        if level <= self.min_square {
            return None;
        }
        let x = level.sqrt();
        let (mut start, mut end) = (f64::NEG_INFINITY, f64::INFINITY);
        // Inside: δ < x γ, −δ < x γ and γ > 0, each linear in t.
        let edges = [
            [x * self.width[0] - self.offset[0], x * self.width[1] - self.offset[1]],
            [x * self.width[0] + self.offset[0], x * self.width[1] + self.offset[1]],
            self.width,
        ];
        for [front, back] in edges {
            if front.is_nan() || back.is_nan() || front.is_infinite() || back.is_infinite() {
                continue;
            }
            if front <= 0.0 && back <= 0.0 {
                return None;
            }
            let cross = front / (front - back);
            if front < 0.0 {
                start = start.max(cross);
            } else if back < 0.0 {
                end = end.min(cross);
            }
        }
        (start < end).then_some([start, end])
    }

    #[inline]
    fn at(&self, t: f64) -> (f64, f64) {
        let rest = 1.0 - t;
        (self.offset[0] * rest + self.offset[1] * t, self.width[0] * rest + self.width[1] * t)
    }

    /// t at which δ = x γ.
    fn at_level(&self, x: f64) -> f64 {
        let front = x * self.width[0] - self.offset[0];
        front / (front - (x * self.width[1] - self.offset[1]))
    }

    /// The next level of |x| as it grows or shrinks, `None` where nothing is left to resolve.
    /// Levels within `margin` of x count as passed.
    fn next_level(&self, x: f64, margin: f64, growing: bool) -> Option<f64> {
        let past = if growing { x + margin } else { x - margin };
        let far = (self.min_square + REACH).sqrt();
        if growing {
            if past >= far {
                None
            } else if past < LEVELS[3] {
                LEVELS.iter().copied().find(|&level| level > past)
            } else {
                Some((x * x + SQUARE_STEP).sqrt().min(far))
            }
        } else if past > far {
            Some(far)
        } else if past > LEVELS[3] {
            Some((x * x - SQUARE_STEP).max(0.0).sqrt().max(LEVELS[3]))
        } else {
            LEVELS.iter().rev().copied().find(|&level| level < past)
        }
    }
}

/// v/|v|; `None` where v is 0 or not finite.
fn unit_vector<const N: usize>(v: &[f64; N]) -> Option<[f64; N]> {
    let largest = v.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return None;
    }
    // Scaled first, so that no square leaves the range.
    let length = v.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt();
    Some(v.map(|x| x / largest / length))
}

impl Track for TriangularPath {
    #[inline]
    fn rate(&self, t: f64) -> f64 {
        let (offset, width) = self.at(t);
        let x = offset / width;
        if width > 0.0 { self.peak * (-x * x).exp() } else { 0.0 }
    }

    /// Panel by panel, so that any span is resolved.
    fn depth(&self, t: f64, dt: f64) -> f64 {
        let (mut start, mut rest, mut sum) = (t, dt, 0.0);
        while rest > 0.0 {
            let next = self.next_break(start);
            let length = if next < start + rest { next - start } else { rest };
            sum += length * mean(&GAUSS_12, |u| self.rate(start + length * u));
            start += length;
            rest = if length == rest { 0.0 } else { dt - (start - t) };
        }
        sum
    }

    fn next_break(&self, t: f64) -> f64 {
        let (offset, width) = self.at(t);
        let twist = (self.offset[1] - self.offset[0]) * self.width[0]
            - self.offset[0] * (self.width[1] - self.width[0]);
        let mut next = f64::INFINITY;
        let mut take = |candidate: f64| {
            if candidate > t + 2.0 * f64::EPSILON && candidate < next {
                next = candidate;
            }
        };
        if twist != 0.0 {
            // A width that the rounding of t could have made is the foot's.
            let foot = 8.0 * f64::EPSILON * (self.width[1] - self.width[0]).abs();
            let x = if width > foot { offset / width } else { f64::INFINITY.copysign(offset) };
            // What the rounding of t stands for in x.
            let margin = if x.is_finite() {
                1e-12 * x.abs() + 8.0 * f64::EPSILON * (twist / (width * width)).abs()
            } else {
                0.0
            };
            // x grows with t where the twist is positive; at the centre |x| grows either way.
            let centre = x.abs() <= margin;
            let growing = centre || (x > 0.0) == (twist > 0.0);
            let sign = if centre { twist.signum() } else { x.signum() };
            match self.next_level(x.abs(), margin, growing) {
                Some(level) => {
                    take(self.at_level(sign * level));
                    let slope = self.width[1] - self.width[0];
                    if width > 0.0 && x * x < self.min_square + REACH {
                        // γ doubled or halved.
                        take(t + if slope > 0.0 { width / slope } else { -0.5 * width / slope });
                    }
                }
                None => take(f64::INFINITY),
            }
        }
        // The foot of the widget, for widths of both signs.
        if self.width[0] * self.width[1] < 0.0 {
            take(self.width[0] / (self.width[0] - self.width[1]));
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// δ is 0 before the foot, where nothing is seen; behind it |x| falls to 9, so that all is e^(−81) of the peak, but
    /// resolved.
    #[test]
    fn a_centre_behind_the_foot_hides_nothing() {
        let path = TriangularPath::new([-1.0, 9.0], [-1.0, 1.0], 1.0);
        let found = path.optical_depth(&ClippedSpan::WHOLE);
        const COUNT: usize = 200_000;
        let at = |k: usize| path.rate(0.5 + 0.5 * (k as f64 + 0.5) / COUNT as f64);
        let exact = (0..COUNT).map(at).sum::<f64>() / (2 * COUNT) as f64;
        // The midpoint rule's: x² falls by 144 for each t at the back, so a 24th of the square of 144 steps, 5.4e-9.
        assert!((found / exact - 1.0).abs() < 1e-8, "{found:e} for {exact:e}");
    }

    /// Panels between the levels of x against a thousand of equal length: 20 of them, each right to 1e-14 of what it holds, and
    /// the rounding of x.
    #[test]
    fn panels_resolve_what_they_span() {
        let share = |i: i32, step: f64| (f64::from(i) * step).fract();
        for i in 0..300 {
            let offset = [4.0 * share(i, 0.618) - 2.0, 4.0 * share(i, 0.755) - 2.0];
            let width = [0.3 + share(i, 0.57), 0.3 + share(i, 0.41)];
            let path = TriangularPath::new(offset, width, 1.0);
            const COUNT: usize = 1000;
            let part = |k: usize| mean(&GAUSS_12, |u| path.rate((k as f64 + u) / COUNT as f64));
            let exact = (0..COUNT).map(part).sum::<f64>() / COUNT as f64;
            let found = path.optical_depth(&ClippedSpan::WHOLE);
            assert!((found / exact - 1.0).abs() < 2e-13, "{offset:?} {width:?}: {found:e} for {exact:e}");
        }
    }

    /// Panels ended by x alone, and profiles that lie between two levels.
    #[test]
    fn levels_of_x_resolve_the_profile_where_the_width_stays() {
        for k in 0..140 {
            for extent in [0.3, 1.1, 2.0, 4.0] {
                let from = 0.05 * f64::from(k);
                let path = TriangularPath::new([from, from + extent], [1.0; 2], 1.0);
                const COUNT: usize = 200;
                let part = |k: usize| mean(&GAUSS_12, |u| path.rate((k as f64 + u) / COUNT as f64));
                let exact = (0..COUNT).map(part).sum::<f64>() / COUNT as f64;
                let found = path.optical_depth(&ClippedSpan::WHOLE);
                assert!((found / exact - 1.0).abs() < 2e-13, "{from} over {extent}: {found:e} for {exact:e}");
            }
        }
    }
}
