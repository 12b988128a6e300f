//! Waves along a straight path: any number of bands in one segment.
//!
//! Symbols: φ the phase, one band a unit of it, feet at the integers, peaks half-way; u the distance from the
//! nearest peak and z = ½ − u that from the nearest foot, both in [0, ½]; w the band width, u_e the half-width
//! of what it leaves. Sources: Song et al. 2009, sections 4.3 and 4.4; docs/src/explanation/optics.md, section 5.
//!
//! All areas are sums of positive parts: what is left of the band in front, whole bands, what is begun of the
//! band at the back. Near a foot the distance from the foot is the measure, near a peak the distance from the
//! peak, so that nothing cancels but what the data itself cancels.

use crate::clip::ClippedSpan;
use crate::linear::psi;
use crate::special::{one_minus_sinc, sinc};
use crate::track::{Track, mean_transmittance_along};
use std::f64::consts::{FRAC_PI_2, PI};
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
        Bell::new(wave, WaveShape::Triangle, reach, 0.5 * reach)
    }

    /// A sine wave.
    pub fn sine(wave: &Wave) -> Bell {
        let reach = sine_half_width(wave.band_width);
        Bell::new(wave, WaveShape::Sine, reach, sine_half_area(wave.band_width, reach))
    }

    fn new(wave: &Wave, form: WaveShape, reach: f64, half: f64) -> Bell {
        Bell { form, band_width: wave.band_width, reach, half, step: wave.step(), origin: wave.origin }
    }

    /// φ at (s, g).
    #[inline]
    fn phase(&self, v: [f64; 2]) -> f64 {
        (v[0] - self.origin[0]) * self.step[0] + (v[1] - self.origin[1]) * self.step[1]
    }

    #[inline]
    fn value(&self, spot: FlankPosition) -> f64 {
        self.mean_on_flank(spot, spot).max(0.0)
    }

    /// Mean of the profile between two places of one flank, neither beyond the reach.
    #[inline]
    fn mean_on_flank(&self, low: FlankPosition, high: FlankPosition) -> f64 {
        match self.form {
            WaveShape::Triangle => triangle_mean(self.band_width, low, high),
            WaveShape::Sine => sine_mean(self.band_width, low, high),
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

/// A place on a flank, measured from both of its ends: each is exact where it is small.
#[derive(Debug, Clone, Copy)]
struct FlankPosition {
    /// z, distance from the nearest foot.
    pub foot: f64,
    /// u, distance from the nearest peak.
    pub peak: f64,
}

impl FlankPosition {
    pub const FOOT: FlankPosition = FlankPosition { foot: 0.0, peak: 0.5 };
    pub const PEAK: FlankPosition = FlankPosition { foot: 0.5, peak: 0.0 };

    #[inline]
    pub fn from_peak(distance: f64) -> FlankPosition {
        FlankPosition { foot: 0.5 - distance, peak: distance }
    }
}

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
            WaveShape::Sine => 2.0 * (0.5 * width).sqrt().asin() / PI,
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
                triangle_lit(|u| self.value(FlankPosition::from_peak(u.abs())), part.from, part.to, peak)
            }
            WaveShape::Sine => {
                let BandPart { from, to } = part;
                mean_transmittance_along(&Arc { bell: self, from, to, peak })
            }
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

/// Mean of the triangle wave max(0, 1 − 2u/w) between two places of one flank (Song et al. 2009, section 4.3): linear, so the
/// value at the middle.
#[inline]
fn triangle_mean(band_width: f64, low: FlankPosition, high: FlankPosition) -> f64 {
    if band_width == 1.0 {
        return low.foot + high.foot;
    }
    let reach = 0.5 * band_width;
    ((reach - low.peak) + (reach - high.peak)) / band_width
}

/// Mean of e^(−T) along a piece of a triangle wave within one band from a place at signed distance `from` of the peak to one at
/// `to`, where the depth per piece at profile 1 is `peak`: at most two stretches of linear extinction.
///
/// Song section 4.3 gives the rising and the falling flank apart, with exponentials that overflow; both are
/// cases of linear extinction (module `linear`).
fn triangle_lit(value: impl Fn(f64) -> f64, from: f64, to: f64, peak: f64) -> f64 {
    let (a, b) = (value(from), value(to));
    if from * to >= 0.0 {
        return psi(peak * a, peak * b);
    }
    let length = from.abs() + to.abs();
    let (first, second) = (from.abs() / length, to.abs() / length);
    let before = peak * first * 0.5 * (a + 1.0);
    first * psi(peak * first * a, peak * first)
        + (-before).exp() * second * psi(peak * second, peak * second * b)
}

/// u_e of the sine wave max(0, 1 − (1 − cos πu)/w) (Song et al. 2009, section 4.4): 2 asin √(w/2)/π; the form acos(1 − w)/π loses half of the digits of a narrow band.
pub fn sine_half_width(band_width: f64) -> f64 {
    if band_width == 1.0 { 0.5 } else { 2.0 * (0.5 * band_width).sqrt().asin() / PI }
}

/// ∫₀^u_e: u − (u − sin(πu)/π)/w.
pub fn sine_half_area(band_width: f64, reach: f64) -> f64 {
    if band_width == 1.0 { 1.0 / PI } else { reach - reach * one_minus_sinc(PI * reach) / band_width }
}

/// Mean of the sine wave between two places of one flank.
///
/// Of sin πz over [z₁, z₂]: sin(π z̄) sinc(Δ/2) (docs/src/explanation/optics.md, section 9). With a band width,
/// 1 − (1 − cos(π ū) sinc(Δ/2))/w with the inner difference written as 2 sin²(π ū/2) sinc + (1 − sinc).
#[inline]
fn sine_mean(band_width: f64, low: FlankPosition, high: FlankPosition) -> f64 {
    if band_width == 1.0 {
        return (FRAC_PI_2 * (low.foot + high.foot)).sin() * sinc(0.5 * (high.foot - low.foot));
    }
    let sine = (0.5 * FRAC_PI_2 * (low.peak + high.peak)).sin();
    let missing = one_minus_sinc(FRAC_PI_2 * (low.peak - high.peak));
    1.0 - (2.0 * sine * sine * (1.0 - missing) + missing) / band_width
}
