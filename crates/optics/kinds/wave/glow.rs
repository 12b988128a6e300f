//! Waves of the constant-emitter: the light of the windows about the peaks where the profile exceeds the
//! cutoff. Whole bands are alike, so any number of them is a geometric series.

use super::spot::FlankPosition;
use super::{Bell, Place, WavePath, WaveShape, triangle};
use crate::clip::ClippedSpan;
use crate::track::{Track, mean_transmittance_along};

/// A part of one band, by signed distances from its peak.
#[derive(Clone, Copy)]
struct BandPart {
    from: f64,
    to: f64,
}

impl Bell {
    /// Half-width of the window in which the profile exceeds `cutoff`.
    pub fn lit_half_width(&self, cutoff: f64) -> f64 {
        let width = self.band_width * (1.0 - cutoff);
        match self.form {
            WaveShape::Triangle => 0.5 * width,
            WaveShape::Sine => 2.0 * (0.5 * width).sqrt().asin() / std::f64::consts::PI,
        }
    }

    /// Area between two signed distances from one peak, `from` ≤ `to`.
    fn part_area(&self, part: BandPart) -> f64 {
        let (p, q) = (part.from.abs(), part.to.abs());
        if part.from * part.to >= 0.0 {
            self.flank(FlankPosition::from_peak(p.max(q)), FlankPosition::from_peak(p.min(q)))
        } else {
            let half = |u| self.flank(FlankPosition::from_peak(u), FlankPosition::PEAK);
            half(p) + half(q)
        }
    }

    /// Mean of e^(−T) along a lit part; `peak` is the depth along it at profile 1.
    fn lit(&self, part: BandPart, peak: f64) -> f64 {
        match self.form {
            WaveShape::Triangle => {
                triangle::lit(|u| self.value(FlankPosition::from_peak(u.abs())), part.from, part.to, peak)
            }
            WaveShape::Sine => lit_sine(self, part.from, part.to, peak),
        }
    }

    /// ∫ e^(−T) dφ over the lit piece of a part, with T from the part's start; `rate` = dT/dφ at profile 1.
    fn part_light(&self, part: BandPart, window: f64, rate: f64) -> f64 {
        let lit = BandPart { from: part.from.max(-window), to: part.to.min(window) };
        if lit.from >= lit.to {
            return 0.0;
        }
        let before = rate * self.part_area(BandPart { from: part.from, to: lit.from });
        let length = lit.to - lit.from;
        (-before).exp() * length * self.lit(lit, rate * length)
    }
}

impl Place {
    /// Signed distance from the band's peak.
    fn signed(self) -> f64 {
        if self.rising { -self.spot.peak } else { self.spot.peak }
    }
}

impl WavePath {
    /// ∫ e^(−T) dt over the parts of the stretch where the profile exceeds `cutoff`; T counts from the start
    /// of the stretch. Times c D/U it is the constant-emitter colour.
    pub fn glow(&self, peak: f64, stretch: &ClippedSpan, cutoff: f64) -> f64 {
        let bell = &self.bell;
        let (a, b) = (stretch.at_start(self.front, self.back), stretch.at_end(self.front, self.back));
        // The bell is even: a falling phase is a rising one of the opposite sign.
        let (a, b) = if a <= b { (a, b) } else { (-a, -b) };
        let (from, to) = (Place::new(a), Place::new(b));
        let window = bell.lit_half_width(cutoff);
        let peak = peak * stretch.length;
        if from.band == to.band {
            let whole = BandPart { from: from.signed(), to: to.signed() };
            if -window < whole.from && whole.to < window {
                return stretch.length * bell.lit(whole, peak);
            }
        }
        let (_, length) = bell.area(from, to);
        if length <= 0.0 {
            return 0.0;
        }
        let rate = peak / length;
        let light = if from.band == to.band {
            bell.part_light(BandPart { from: from.signed(), to: to.signed() }, window, rate)
        } else {
            let first = BandPart { from: from.signed(), to: 0.5 };
            let last = BandPart { from: -0.5, to: to.signed() };
            let band = BandPart { from: -0.5, to: 0.5 };
            let bands = to.band - from.band - 1.0;
            let (first_depth, band_depth) = (rate * bell.part_area(first), rate * 2.0 * bell.half);
            // Σ e^(−i τ) over the whole bands, and what they leave of the light behind them.
            let series = if bands == 0.0 {
                0.0
            } else if band_depth > 0.0 {
                (-bands * band_depth).exp_m1() / (-band_depth).exp_m1()
            } else {
                bands
            };
            let middle = if series > 0.0 { series * bell.part_light(band, window, rate) } else { 0.0 };
            let behind = (-bands * band_depth).exp() * bell.part_light(last, window, rate);
            bell.part_light(first, window, rate) + (-first_depth).exp() * (middle + behind)
        };
        stretch.length * (light / length)
    }
}

/// Mean of e^(−T) along a piece of a sine wave within the reach of one peak; arguments as in the triangle's.
fn lit_sine(bell: &Bell, from: f64, to: f64, peak: f64) -> f64 {
    mean_transmittance_along(&Arc { bell, from, to, peak })
}

/// Part of one band, from `from` to `to`, signed distances from its peak.
struct Arc<'a> {
    bell: &'a Bell,
    from: f64,
    to: f64,
    peak: f64,
}

impl Arc<'_> {
    fn place(&self, t: f64) -> f64 {
        self.from * (1.0 - t) + self.to * t
    }
}

impl Track for Arc<'_> {
    fn rate(&self, t: f64) -> f64 {
        self.peak * self.bell.value(FlankPosition::from_peak(self.place(t).abs()))
    }

    fn depth(&self, t: f64, dt: f64) -> f64 {
        let (a, b) = (self.place(t), self.place(t + dt));
        let (p, q) = (a.abs(), b.abs());
        let mean = if a * b >= 0.0 {
            self.bell.mean_on_flank(FlankPosition::from_peak(p.max(q)), FlankPosition::from_peak(p.min(q)))
        } else {
            let half = |u| self.bell.flank(FlankPosition::from_peak(u), FlankPosition::PEAK);
            (half(p) + half(q)) / (p + q)
        };
        self.peak * dt * mean.max(0.0)
    }

    fn next_break(&self, t: f64) -> f64 {
        if self.place(t) < -1e-15 && self.to > 0.0 {
            return t - self.place(t) / (self.to - self.from);
        }
        f64::INFINITY
    }
}
