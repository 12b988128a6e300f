//! The shape of a wave's density on a segment within one band, for [`super::smooth`].
//!
//! Values at the front, the middle and the back give c₁ = ½ (ρ_b − ρ_f) and c₂ = (ρ_f + ρ_b − 2 ρ_m)/3; a = c₁/ρ̄ and
//! b = c₂/ρ̄ with the exact mean ρ̄. On a side of a triangle that is exact, with b = 0. On a sine that turns by 2 ω on the
//! segment c₁ holds ω − ω³/6 where the Legendre coefficient is ω − ω³/10: 1 + ω²/15 of it.

use super::smooth::DensityShape;
use super::wave::{LaneBell, LanePhase};
use crate::{Float, Lanes, Mask};

impl LaneBell {
    /// Depth and shape between two phases, for a rate of `peak` = ρ₀ D at the peaks. It jumps where a triangle has a
    /// corner, a sine a foot, or the band width an end.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, front: LanePhase<L>, back: LanePhase<L>, peak: L::F) -> DensityShape<L> {
        let splat = L::F::splat;
        let (zero, half, one) = (splat(0.0), splat(0.5), splat(1.0));
        let (front_rises, back_rises) = (zero.le(front.offset), zero.le(back.offset));
        let band = |rises, nearest: L::F| L::F::select(rises, nearest, nearest - one);
        let from_peak = |rises, offset: L::F| L::F::select(rises, offset - half, offset + half);
        let across = (band(back_rises, back.nearest) - band(front_rises, front.nearest)).abs();
        let (start, end) = (from_peak(front_rises, front.offset), from_peak(back_rises, back.offset));
        let reach = splat(self.reach());
        let mut smooth = across.lt(half).and(start.abs().le(reach)).and(end.abs().le(reach));
        let mut turn = zero;
        if self.is_sine() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FourLanes as P;
    use crate::optics::smooth::tests::{lane, uniform};
    use crate::optics::sums::{Sums, Term};
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
            let function = TransferFunction { model, unit_distance: 1.0, widgets };
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
