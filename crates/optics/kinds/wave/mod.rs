//! Waves along a straight path: any number of bands in one segment.
//!
//! Symbols: φ the phase, one band a unit of it, feet at the integers, peaks half-way; u the distance from the
//! nearest peak and z = ½ − u that from the nearest foot, both in [0, ½]; w the band width, u_e the half-width
//! of what it leaves. Sources: Song et al. 2009, sections 4.3 and 4.4; docs/src/explanation/optics.md, section 5.
//!
//! All areas are sums of positive parts: what is left of the band in front, whole bands, what is begun of the
//! band at the back. Near a foot the distance from the foot is the measure, near a peak the distance from the
//! peak, so that nothing cancels but what the data itself cancels.

mod glow;
mod sine;
mod spot;
mod triangle;

pub use sine::{half_area as sine_half_area, half_width as sine_half_width};

use crate::clip::ClippedSpan;
use crate::track::Track;
use spot::FlankPosition;
use voltet_core::transfer::Wave;

/// The two profiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WaveShape {
    Triangle,
    Sine,
}

/// A wave with the constants of its bands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bell {
    form: WaveShape,
    /// w.
    band_width: f64,
    /// u_e.
    reach: f64,
    /// Area of half a band.
    half: f64,
    /// φ per unit of (s, g).
    step: [f64; 2],
    origin: [f64; 2],
}

/// A phase, split into its band and the place within it.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// ⌊φ⌋.
    band: f64,
    spot: FlankPosition,
    /// Before the peak.
    rising: bool,
}

impl Place {
    #[inline]
    fn new(phase: f64) -> Place {
        let nearest = phase.round();
        let offset = phase - nearest;
        let spot = FlankPosition { foot: offset.abs(), peak: 0.5 - offset.abs() };
        if offset >= 0.0 {
            Place { band: nearest, spot, rising: true }
        } else {
            Place { band: nearest - 1.0, spot, rising: false }
        }
    }
}

impl Bell {
    /// A triangle wave.
    pub fn triangle(wave: &Wave) -> Bell {
        let reach = 0.5 * wave.band_width;
        Bell { form: WaveShape::Triangle, reach, half: 0.5 * reach, ..Bell::from_wave(wave) }
    }

    /// A sine wave.
    pub fn sine(wave: &Wave) -> Bell {
        let w = wave.band_width;
        let reach = sine::half_width(w);
        Bell { form: WaveShape::Sine, reach, half: sine::half_area(w, reach), ..Bell::from_wave(wave) }
    }

    fn from_wave(wave: &Wave) -> Bell {
        Bell {
            form: WaveShape::Triangle,
            band_width: wave.band_width,
            reach: 0.0,
            half: 0.0,
            step: wave.step(),
            origin: wave.origin,
        }
    }

    /// φ at (s, g).
    #[inline]
    fn phase(&self, v: [f64; 2]) -> f64 {
        (v[0] - self.origin[0]) * self.step[0] + (v[1] - self.origin[1]) * self.step[1]
    }

    /// The profile.
    #[inline]
    fn value(&self, spot: FlankPosition) -> f64 {
        self.mean_on_flank(spot, spot).max(0.0)
    }

    /// Mean of the profile between two places of one flank, neither beyond the reach.
    #[inline]
    fn mean_on_flank(&self, low: FlankPosition, high: FlankPosition) -> f64 {
        match self.form {
            WaveShape::Triangle => triangle::mean(self.band_width, low, high),
            WaveShape::Sine => sine::mean(self.band_width, low, high),
        }
    }

    /// Distance between two places of one flank, `low` the nearer to the foot.
    #[inline]
    fn distance(&self, low: FlankPosition, high: FlankPosition) -> f64 {
        if self.band_width == 1.0 { high.foot - low.foot } else { low.peak - high.peak }
    }

    /// Area between two places of one flank, `low` the nearer to the foot.
    #[inline]
    fn flank(&self, low: FlankPosition, high: FlankPosition) -> f64 {
        if high.peak >= self.reach {
            return 0.0;
        }
        let low = if low.peak > self.reach { FlankPosition::from_peak(self.reach) } else { low };
        self.distance(low, high) * self.mean_on_flank(low, high).max(0.0)
    }

    /// (area, length) of the path from one phase up to another.
    fn area(&self, from: Place, to: Place) -> (f64, f64) {
        if from.band == to.band {
            if from.rising == to.rising {
                let (low, high) = if from.rising { (from.spot, to.spot) } else { (to.spot, from.spot) };
                return (self.flank(low, high), self.distance(low, high));
            }
            let area = self.flank(from.spot, FlankPosition::PEAK) + self.flank(to.spot, FlankPosition::PEAK);
            return (area, from.spot.peak + to.spot.peak);
        }
        let (front, front_length) = if from.rising {
            (self.flank(from.spot, FlankPosition::PEAK) + self.half, from.spot.peak + 0.5)
        } else {
            (self.flank(FlankPosition::FOOT, from.spot), from.spot.foot)
        };
        let (back, back_length) = if to.rising {
            (self.flank(FlankPosition::FOOT, to.spot), to.spot.foot)
        } else {
            (self.half + self.flank(to.spot, FlankPosition::PEAK), 0.5 + to.spot.peak)
        };
        let bands = to.band - from.band - 1.0;
        (front + bands * 2.0 * self.half + back, front_length + bands + back_length)
    }

    /// Mean of the profile over [φ_a, φ_b], in either order.
    fn mean(&self, a: f64, b: f64) -> f64 {
        let (from, to) = (Place::new(a.min(b)), Place::new(a.max(b)));
        let one_flank = from.band == to.band && from.rising == to.rising;
        if one_flank && from.spot.peak <= self.reach && to.spot.peak <= self.reach {
            let (low, high) = if from.rising { (from.spot, to.spot) } else { (to.spot, from.spot) };
            return self.mean_on_flank(low, high).max(0.0);
        }
        let (area, length) = self.area(from, to);
        if length > 0.0 { area / length } else { self.value(from.spot) }
    }

    /// The path between two points of the (s, g) plane.
    pub fn path(&self, front: [f64; 2], back: [f64; 2]) -> WavePath {
        WavePath { bell: *self, front: self.phase(front), back: self.phase(back) }
    }
}

/// A wave along one segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavePath {
    bell: Bell,
    /// φ_f.
    front: f64,
    /// φ_b.
    back: f64,
}

impl WavePath {
    /// ∫ profile dt over the stretch.
    pub fn integral(&self, stretch: &ClippedSpan) -> f64 {
        let (a, b) = (stretch.at_start(self.front, self.back), stretch.at_end(self.front, self.back));
        stretch.length * self.bell.mean(a, b)
    }

    /// The track over the whole path; it breaks at feet, peaks and where the profile passes `cutoff`.
    pub fn track(&self, peak: f64, cutoff: Option<f64>) -> WaveTrack {
        let lit = cutoff.map_or(self.bell.reach, |cutoff| self.bell.lit_half_width(cutoff));
        // Counted from the band next to the front: a phase far from the origin has fewer digits for its band.
        let nearest = self.front.round();
        WaveTrack {
            path: WavePath { bell: self.bell, front: self.front - nearest, back: self.back - nearest },
            peak,
            breaks: [0.5 - self.bell.reach, 0.5 - lit, 0.5, 0.5 + lit, 0.5 + self.bell.reach],
        }
    }
}

/// A wave as a [`Track`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveTrack {
    path: WavePath,
    peak: f64,
    /// Places of the breaks in a band, rising; the foot at 0 is another.
    breaks: [f64; 5],
}

impl WaveTrack {
    #[inline]
    fn phase(&self, t: f64) -> f64 {
        self.path.front * (1.0 - t) + self.path.back * t
    }
}

impl Track for WaveTrack {
    fn rate(&self, t: f64) -> f64 {
        self.peak * self.path.bell.value(Place::new(self.phase(t)).spot)
    }

    fn depth(&self, t: f64, dt: f64) -> f64 {
        self.peak * dt * self.path.bell.mean(self.phase(t), self.phase(t + dt))
    }

    fn next_break(&self, t: f64) -> f64 {
        let span = self.path.back - self.path.front;
        if span == 0.0 {
            return f64::INFINITY;
        }
        // The bell is even, so a falling phase is a rising one of the opposite sign.
        let phase = self.phase(t) * span.signum();
        let past = phase + 4.0 * f64::EPSILON * (1.0 + phase.abs());
        let band = past.floor();
        let next = self.breaks.iter().map(|b| band + b).find(|&b| b > past).unwrap_or(band + 1.0);
        t + (next - phase) / span.abs()
    }
}
