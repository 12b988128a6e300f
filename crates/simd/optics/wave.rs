//! Triangle and sine waves: mean of the profile over a segment, any number of bands. Twin of `optics::kinds::wave`.
//!
//! Phases come split into the nearest foot and the distance from it, reduced in 64 bits where |φ| is large: the
//! reduction, not the formula, is what 32 bits cannot do.

use super::elementary::polynomial;
use super::smooth::DensityShape;
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

    /// Depth and shape between two phases, for a rate of `peak` = ρ₀ D at the peaks. It jumps where a triangle has a
    /// corner, a sine a foot, or the band width an end.
    ///
    /// Values at the front, the middle and the back give c₁ = ½ (ρ_b − ρ_f) and c₂ = (ρ_f + ρ_b − 2 ρ_m)/3; a = c₁/ρ̄ and b = c₂/ρ̄ with
    /// the exact mean ρ̄, for [`super::smooth`]. On a side of a triangle that is exact, with b = 0. On a sine that turns by 2 ω on the
    /// segment c₁ holds ω − ω³/6 where the Legendre coefficient is ω − ω³/10: 1 + ω²/15 of it.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, front: LanePhase<L>, back: LanePhase<L>, peak: L::F) -> DensityShape<L> {
        let splat = L::F::splat;
        let (zero, half, one) = (splat(0.0), splat(0.5), splat(1.0));
        let (front_rises, back_rises) = (zero.le(front.offset), zero.le(back.offset));
        let band = |rises, nearest: L::F| L::F::select(rises, nearest, nearest - one);
        let from_peak = |rises, offset: L::F| L::F::select(rises, offset - half, offset + half);
        let across = (band(back_rises, back.nearest) - band(front_rises, front.nearest)).abs();
        let (start, end) = (from_peak(front_rises, front.offset), from_peak(back_rises, back.offset));
        let reach = splat(self.reach);
        let mut smooth = across.lt(half).and(start.abs().le(reach)).and(end.abs().le(reach));
        let mut turn = zero;
        if self.sine {
            turn = (end - start) * splat(std::f32::consts::FRAC_PI_2);
        } else {
            smooth = smooth.and(zero.le(start * end));
        }
        let mean = self.mean::<L>(front, back);
        let (first, last) = (self.value::<L>(front.offset.abs()), self.value::<L>(back.offset.abs()));
        let middle = self.value::<L>(half - ((start + end) * half).abs());
        let inverse = one / mean.max(splat(f32::MIN_POSITIVE));
        let turn_squared = turn * turn;
        let tilt = (last - first) * half * turn_squared.mul_add(splat(1.0 / 15.0), one) * inverse;
        let bend = (first + last - middle - middle) * splat(1.0 / 3.0) * inverse;
        DensityShape {
            depth: mean * peak,
            tilt,
            bend,
            // A thin band bends by more than a sine does.
            change_squared: turn_squared.max(tilt * tilt).max(bend.abs() * splat(3.0)),
            extent_squared: turn_squared,
        }
        .cut(smooth.not())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::smooth::tests::{lane, uniform};
    use crate::optics::smooth::{Sums, Term};
    use crate::portable::Portable as P;
    use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
    use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};

    type F = <P as Lanes>::F;

    #[test]
    fn a_wave_and_a_uniform_widget_keep_their_order() {
        let splat = |x: f64| F::splat(x as f32);
        let (mut served, mut worst) = (0, 0.0);
        for i in 0..20_000 {
            let round = |x: f64| f64::from(x as f32);
            let front = round(3.0 * uniform(i, 1));
            let back = round(front + (uniform(i, 2) - 0.5) * 10f64.powf(-1.5 * uniform(i, 3)));
            let sine = i % 2 == 0;
            let band_width = if i % 3 == 0 { 1.0 } else { 0.2 + 0.8 * uniform(i, 4) };
            let wave = Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period: 1.0, band_width };
            let bell = if sine { LaneBell::sine(&wave) } else { LaneBell::triangle(&wave) };
            let extinctions = [5, 6].map(|j| 10f64.powf(0.3 - 4.0 * uniform(i, j)));
            let phase = |x: f64| LanePhase::<P> { nearest: splat(x.round()), offset: splat(x - x.round()) };
            let shape = bell.shape::<P>(phase(front), phase(back), splat(extinctions[0]));
            let (depth, even) = (lane(shape.depth), extinctions[1]);
            let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            let (mut sums, mut terms) = (Sums::<P>::none(), [Term::none(); 2]);
            let shapes = [shape, DensityShape::even(splat(even))];
            for ((shape, color), term) in shapes.iter().zip(colors).zip(&mut terms) {
                sums.add(shape, color.map(|c: f64| c as f32), term);
            }
            if lane(F::select(sums.is_smooth(&terms), splat(1.0), splat(0.0))) == 0.0 || depth == 0.0 {
                continue;
            }
            served += 1;
            let profile = if sine { Profile::SineWave(wave) } else { Profile::TriangleWave(wave) };
            let region = Some(Region::rectangle([-10.0, 10.0], [-1.0, 1.0]));
            let widgets = vec![
                Widget { profile, color: colors[0], extinction: extinctions[0], region: None },
                Widget { profile: Profile::Uniform, color: colors[1], extinction: even, region },
            ];
            let model = OpticalModel::DensityEmitter;
            let function = TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
            let segment = Segment {
                length: 1.0,
                front: [front, 0.0],
                back: [back, 0.0],
                fields_front: &[],
                fields_back: &[],
            };
            let prepared = CompiledTransferFunction::new(&function).expect("a valid transfer function");
            let truth = prepared.integrate(&segment, WidgetBlend::Exact).color;
            let all = splat(0.0).le(splat(1.0));
            for (found, exact) in sums.ordered(&terms, all).into_iter().zip(truth).take(2) {
                let found = lane(found);
                // What the series leave out where they hold, and the roundings of phase (near a foot) and depth.
                let bound = 3e-7 + 16.0 * f64::from(f32::EPSILON) * exact;
                let ratio = (found - exact).abs() / bound;
                assert!(ratio <= 1.0, "case {i}: {found} for {exact}, {ratio:.2} of the bound");
                worst = f64::max(worst, ratio);
            }
        }
        println!("{served} served, worst {worst:.2} of the bound");
        assert!(served > 3_000, "{served} served");
    }
}
