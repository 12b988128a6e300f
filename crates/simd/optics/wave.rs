//! Triangle and sine waves: mean of the profile over a segment, any number of bands. Twin of `optics::kinds::wave`.
//!
//! Phases come split into the nearest foot and the distance from it, reduced in 64 bits where |φ| is large: the
//! reduction, not the formula, is what 32 bits cannot do.

use super::elementary::polynomial;
use crate::{Float, Lanes, Mask};
use voltet_core::transfer::Wave;

/// A wave made ready for lanes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneBell {
    sine: bool,
    full: bool,
    inverse_width: f32,
    /// Half-width of what the band width leaves.
    reach: f32,
    /// Area of half a band.
    half: f32,
}

/// A phase by its nearest foot (an integer below 2²⁴) and the signed distance from it, in [−½, ½].
#[derive(Clone, Copy)]
pub struct LanePhase<L: Lanes> {
    /// ⌊φ + ½⌋.
    pub nearest: L::F,
    /// φ − nearest.
    pub offset: L::F,
}

/// A place on a flank: distances from its foot and from its peak.
#[derive(Clone, Copy)]
struct FlankPosition<L: Lanes> {
    foot: L::F,
    peak: L::F,
}

impl LaneBell {
    /// A triangle wave.
    pub fn triangle(wave: &Wave) -> Self {
        let reach = 0.5 * wave.band_width;
        LaneBell::new(wave, false, reach, 0.5 * reach)
    }

    /// A sine wave.
    pub fn sine(wave: &Wave) -> Self {
        use voltet_optics::kinds::wave::{sine_half_area, sine_half_width};
        let reach = sine_half_width(wave.band_width);
        LaneBell::new(wave, true, reach, sine_half_area(wave.band_width, reach))
    }

    fn new(wave: &Wave, sine: bool, reach: f64, half: f64) -> Self {
        LaneBell {
            sine,
            full: wave.band_width == 1.0,
            inverse_width: (1.0 / wave.band_width) as f32,
            reach: reach as f32,
            half: half as f32,
        }
    }

    /// True if it is a sine wave.
    pub(super) fn is_sine(&self) -> bool {
        self.sine
    }

    /// Half-width of a band, in phase.
    pub(super) fn reach(&self) -> f32 {
        self.reach
    }

    #[inline(always)]
    fn mean_on_flank<L: Lanes>(&self, low: FlankPosition<L>, high: FlankPosition<L>) -> L::F {
        let splat = L::F::splat;
        let zero = splat(0.0);
        match (self.sine, self.full) {
            (false, true) => low.foot + high.foot,
            (false, false) => {
                let reach = splat(self.reach);
                ((reach - low.peak) + (reach - high.peak)).max(zero) * splat(self.inverse_width)
            }
            (true, true) => {
                let half = (high.foot - low.foot) * splat(0.5);
                sin_pi::<L>((low.foot + high.foot) * splat(0.5)) * (splat(1.0) - one_minus_sinc::<L>(half))
            }
            (true, false) => {
                let sine = sin_pi::<L>((low.peak + high.peak) * splat(0.25));
                let missing = one_minus_sinc::<L>((low.peak - high.peak) * splat(0.5));
                let away = (splat(2.0) * sine * sine).mul_add(splat(1.0) - missing, missing);
                (splat(1.0) - away * splat(self.inverse_width)).max(zero)
            }
        }
    }

    #[inline(always)]
    fn distance<L: Lanes>(&self, low: FlankPosition<L>, high: FlankPosition<L>) -> L::F {
        if self.full { high.foot - low.foot } else { low.peak - high.peak }
    }

    /// Area between two places of one flank, `low` the nearer to the foot.
    #[inline(always)]
    fn flank<L: Lanes>(&self, low: FlankPosition<L>, high: FlankPosition<L>) -> L::F {
        let reach = L::F::splat(self.reach);
        let outside = reach.le(high.peak);
        let clamped = low.peak.min(reach);
        let low = FlankPosition { foot: low.foot, peak: clamped };
        let area = self.distance(low, high) * self.mean_on_flank(low, high);
        L::F::select(outside, L::F::splat(0.0), area)
    }

    /// Mean of the profile between two phases, in either order. Relative error some ε (1 + condition).
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, front: LanePhase<L>, back: LanePhase<L>) -> L::F {
        let splat = L::F::splat;
        let (zero, half, one) = (splat(0.0), splat(0.5), splat(1.0));
        // From the lower to the higher phase.
        let swapped = back
            .nearest
            .lt(front.nearest)
            .or(back.nearest.le(front.nearest).and(back.offset.lt(front.offset)));
        let pick = |a: L::F, b: L::F| (L::F::select(swapped, b, a), L::F::select(swapped, a, b));
        let (from_nearest, to_nearest) = pick(front.nearest, back.nearest);
        let (from_offset, to_offset) = pick(front.offset, back.offset);
        let from_rising = zero.le(from_offset);
        let to_rising = zero.le(to_offset);
        let spot = |offset: L::F| FlankPosition::<L> { foot: offset.abs(), peak: half - offset.abs() };
        let (from, to) = (spot(from_offset), spot(to_offset));
        let band = |nearest: L::F, rising| L::F::select(rising, nearest, nearest - one);
        let bands = band(to_nearest, to_rising) - band(from_nearest, from_rising);
        let foot = FlankPosition::<L> { foot: zero, peak: half };
        let peak = FlankPosition::<L> { foot: half, peak: zero };
        let select = |mask, a: FlankPosition<L>, b: FlankPosition<L>| FlankPosition::<L> {
            foot: L::F::select(mask, a.foot, b.foot),
            peak: L::F::select(mask, a.peak, b.peak),
        };

        let same_band = bands.lt(half);
        let same_flank = same_band.and(from_rising.and(to_rising).or(from_rising.not().and(to_rising.not())));
        // One flank: the mean itself, so that a flat segment is no 0/0.
        let (low, high) = (select(from_rising, from, to), select(from_rising, to, from));
        let reach = splat(self.reach);
        let bright = self.mean_on_flank(low, high);
        let clipped = self.flank(low, high) / self.distance(low, high).max(splat(f32::MIN_POSITIVE));
        let inside = low.peak.le(reach);
        let on_one = L::F::select(inside, bright, L::F::select(reach.le(high.peak), zero, clipped));
        if same_flank.not().bits() == 0 {
            return on_one;
        }
        // Otherwise areas: from each end to the nearest peak or foot on the way, and whole half-bands.
        let from_low = select(from_rising, from, foot);
        let from_high = select(from_rising, peak, from);
        let to_low = select(to_rising, foot, to);
        let to_high = select(to_rising, to, peak);
        let ends = self.flank(from_low, from_high) + self.flank(to_low, to_high);
        let end_length = self.distance(from_low, from_high) + self.distance(to_low, to_high);
        // Half-bands between: those behind a rising start and before a falling end.
        let count = |mask| L::F::select(mask, one, zero);
        let halves = L::F::select(
            same_band,
            zero,
            (bands - one) * splat(2.0) + count(from_rising) + count(to_rising.not()),
        );
        let area = halves.mul_add(splat(self.half), ends);
        let length = halves.mul_add(half, end_length);
        L::F::select(same_flank, on_one, area / length.max(splat(f32::MIN_POSITIVE)))
    }

    /// The profile at a distance of `foot` from the nearest foot, in [0, ½].
    #[inline(always)]
    pub fn value<L: Lanes>(&self, foot: L::F) -> L::F {
        let spot = FlankPosition::<L> { foot, peak: L::F::splat(0.5) - foot };
        self.mean_on_flank(spot, spot).max(L::F::splat(0.0))
    }
}

/// sin πx for 0 ≤ x ≤ ½, within 2 ulp: Taylor polynomial of degree 13 (7e-10 at ½).
#[inline(always)]
fn sin_pi<L: Lanes>(x: L::F) -> L::F {
    let y = x * L::F::splat(std::f32::consts::PI);
    let series = polynomial::<L, 7>(
        -(y * y),
        [
            1.0,
            1.0 / 6.0,
            1.0 / 120.0,
            1.0 / 5040.0,
            1.0 / 362_880.0,
            1.0 / 39_916_800.0,
            1.0 / 6_227_020_800.0,
        ],
    );
    y * series
}

/// 1 − sin(πx)/(πx) for 0 ≤ x ≤ ¼, within 2 ulp.
#[inline(always)]
fn one_minus_sinc<L: Lanes>(x: L::F) -> L::F {
    let y = x * L::F::splat(std::f32::consts::PI);
    let y2 = y * y;
    y2 * polynomial::<L, 4>(-y2, [1.0 / 6.0, 1.0 / 120.0, 1.0 / 5040.0, 1.0 / 362_880.0])
}
