//! Gaussian widgets: exp(−|K (v − v₀)|²) along a straight path.
//!
//! Symbols: q = K (v − v₀); d = |q_b − q_f|; e the unit vector along the path; a = q_f·e and b = q_b·e the
//! ends along it; h the distance of the path from the centre, |q|² = x² + h² with x from a to b.
//! Sources: Kniss et al. 2003, Eq. 11 and 12 (K of Eq. 12); Song et al. 2009, section 4.2. Ends are formed
//! from the differences v − v₀, each from its own raw numbers, and b never as a + d, which loses the digits
//! of a centre near the back.

use crate::clip::ClippedSpan;
use crate::special::{HALF_SQRT_PI, gaussian_mean};
use crate::track::{POINTS, Track, mean_transmittance_along};

/// A path relative to the centre, measured in widths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianPath {
    /// a, ≤ b.
    pub front: f64,
    /// b.
    pub back: f64,
    /// d.
    length: f64,
    /// h².
    pub offset_squared: f64,
}

impl GaussianPath {
    /// From q_f, q_b and q_b − q_f, the last formed from the raw difference v_b − v_f.
    #[inline]
    pub fn new<const N: usize>(front: [f64; N], back: [f64; N], along: [f64; N]) -> Self {
        let dot = |p: &[f64; N], q: &[f64; N]| p.iter().zip(q).map(|(x, y)| x * y).sum::<f64>();
        let length = dot(&along, &along).sqrt();
        if length == 0.0 {
            return GaussianPath { front: 0.0, back: 0.0, length: 0.0, offset_squared: dot(&front, &front) };
        }
        let unit = along.map(|x| x / length);
        let (a, b) = (dot(&front, &unit), dot(&back, &unit));
        // h from the end nearer to the foot of the perpendicular; |q|² − a² would cancel.
        let (near, x) = if a.abs() <= b.abs() { (&front, a) } else { (&back, b) };
        let offset_squared = near.iter().zip(&unit).map(|(q, e)| (q - x * e) * (q - x * e)).sum();
        GaussianPath { front: a, back: b, length, offset_squared }
    }

    /// T over the stretch for the peak rate `peak` = ρ₀ D.
    #[inline]
    pub fn optical_depth(&self, peak: f64, stretch: &ClippedSpan) -> f64 {
        let (a, b) = (stretch.at_start(self.front, self.back), stretch.at_end(self.front, self.back));
        let (mean, exponent) = gaussian_mean(a, b, self.length * stretch.length);
        peak * stretch.length * mean * (-self.offset_squared - exponent).exp()
    }

    /// The track over the whole path with the peak rate `peak` = ρ₀ D.
    pub fn track(&self, peak: f64) -> GaussianTrack {
        GaussianTrack { path: *self, peak: peak * (-self.offset_squared).exp() }
    }

    /// Interval in which the profile exceeds e^(−`level`): the half-width √(level − h²) of that window, if there is one.
    fn window(&self, level: f64) -> Option<f64> {
        let room = level - self.offset_squared;
        (room > 0.0).then(|| room.sqrt())
    }

    /// The t of the window's ends, for a level as in [`GaussianPath::glow`].
    pub fn window_ends(&self, level: f64) -> Option<[f64; 2]> {
        let half = self.window(level)?;
        if self.length == 0.0 {
            return Some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        Some([(-half - self.front) / self.length, (half - self.front) / self.length])
    }

    /// ∫ e^(−T) dt over the part of the stretch where the profile exceeds e^(−`level`); T counts from the
    /// start of the stretch, also through what lies before that part. Times c D/U it is the constant-emitter
    /// colour (Song section 4.2), computed in widths from the window's ends, so that a window of a millionth
    /// of the segment keeps its digits.
    pub fn glow(&self, peak: f64, stretch: &ClippedSpan, level: f64) -> f64 {
        let Some(half) = self.window(level) else { return 0.0 };
        let (a, b) = (stretch.at_start(self.front, self.back), stretch.at_end(self.front, self.back));
        let length = self.length * stretch.length;
        let peak = peak * (-self.offset_squared).exp();
        if a >= b {
            // One point in working precision.
            return if a.abs() < half { self.lit(a, b, length, stretch.length, peak) } else { 0.0 };
        }
        let (start, end) = (a.max(-half), b.min(half));
        if start >= end {
            return 0.0;
        }
        let before = if start > a {
            let width = start - a;
            let (mean, exponent) = gaussian_mean(a, start, width);
            peak * stretch.length * (width / length) * mean * (-exponent).exp()
        } else {
            0.0
        };
        let width = if start == a && end == b { length } else { end - start };
        (-before).exp() * self.lit(start, end, width, stretch.length * (width / length).min(1.0), peak)
    }

    /// ∫ e^(−T) over a lit piece from x = `start` to `end`, the share `share` of the segment.
    fn lit(&self, start: f64, end: f64, width: f64, share: f64, peak: f64) -> f64 {
        let path = GaussianPath { front: start, back: end, length: width, offset_squared: 0.0 };
        share * mean_transmittance_along(&GaussianTrack { path, peak: peak * share })
    }
}

/// A Gaussian as a [`Track`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianTrack {
    path: GaussianPath,
    /// ρ₀ D e^(−h²).
    peak: f64,
}

/// Length over which 12 points resolve e^(−x²) and its integral to 1e-15 from x on: over 1.6 about the centre, and where
/// x² changes by 5 further out. ∞ beyond 7.6, where e^(−x²) is under 1e-25.
#[inline]
pub fn resolved_from(x: f64) -> f64 {
    const WIDTH: f64 = 1.6;
    const SQUARE: f64 = 5.0;
    const FAR: f64 = 7.6;
    if x >= FAR {
        f64::INFINITY
    } else if x >= 0.0 {
        (x + WIDTH).min((x * x + SQUARE).sqrt())
    } else if x < -FAR {
        -FAR
    } else if x * x > SQUARE {
        (x + WIDTH).min(-(x * x - SQUARE).sqrt())
    } else {
        x + WIDTH
    }
}

/// Below this ρ₀ D/d the rounding of erf (1e-16) stands for less than 1e-15 of depth.
const DIRECT_DEPTH: f64 = 4.0;

impl GaussianTrack {
    #[inline]
    fn x(&self, t: f64) -> f64 {
        self.path.front * (1.0 - t) + self.path.back * t
    }
}

impl Track for GaussianTrack {
    #[inline]
    fn rate(&self, t: f64) -> f64 {
        let x = self.x(t);
        self.peak * (-x * x).exp()
    }

    #[inline]
    fn depth(&self, t: f64, dt: f64) -> f64 {
        let (mean, exponent) = gaussian_mean(self.x(t), self.x(t + dt), self.path.length * dt);
        self.peak * dt * mean * (-exponent).exp()
    }

    fn next_break(&self, t: f64) -> f64 {
        let x = self.x(t);
        let next = resolved_from(x);
        if next == f64::INFINITY { next } else { t + (next - x) / self.path.length }
    }

    fn depths(&self, t: f64, dt: f64) -> [f64; POINTS] {
        let scale = HALF_SQRT_PI * self.peak / self.path.length;
        let nodes = crate::quadrature::GAUSS_12;
        if scale < DIRECT_DEPTH {
            let (front, back) = (self.x(t), self.x(t + dt));
            let start = libm::erf(front);
            nodes.map(|(x, _)| scale * (libm::erf(front * (1.0 - x) + back * x) - start).max(0.0))
        } else {
            nodes.map(|(x, _)| self.depth(t, dt * x))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel of 12 points as long as [`resolved_from`] allows, wherever it begins, against the mean in closed form. What they
    /// leave is under rounding: that of x enters e^(−x²) 2 x² times, so some 1e-14.
    #[test]
    fn a_panel_resolves_what_it_spans() {
        for k in -75..76 {
            let from = 0.1 * f64::from(k);
            let to = resolved_from(from);
            assert!(to > from + 0.1, "from {from} to {to}");
            let (mean, exponent) = gaussian_mean(from, to, to - from);
            let found = crate::quadrature::mean(&crate::quadrature::GAUSS_12, |u| {
                let x = from + (to - from) * u;
                (exponent - x * x).exp()
            });
            assert!((found / mean - 1.0).abs() < 1e-13, "from {from} to {to}: {found} for {mean}");
        }
        assert_eq!((resolved_from(-9.0), resolved_from(7.7)), (-7.6, f64::INFINITY));
    }

    /// Far from the centre, where erf is all but 1 and the depths themselves have no rounding to speak of.
    #[test]
    fn depths_within_a_panel_are_right_to_1e_15() {
        for scale in [0.4, 3.9, 4.1, 39.0] {
            for k in 0..40 {
                let (front, length) = (2.5 + 0.02 * f64::from(k), 0.8);
                let path = GaussianPath::new([front], [front + length], [length]);
                let track = GaussianTrack { path, peak: scale * length / HALF_SQRT_PI };
                let nodes = crate::quadrature::GAUSS_12;
                for ((x, _), found) in nodes.iter().zip(track.depths(0.0, 1.0)) {
                    let exact = track.depth(0.0, *x);
                    assert!(
                        (found - exact).abs() < 1e-15,
                        "{found:e} for {exact:e} at {front}, scale {scale}"
                    );
                }
            }
        }
    }
}
