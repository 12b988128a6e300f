//! Transfer function classified at the grid's points, linear between them. Twin of `VertexSampled`, of a
//! scene that is classified.

use crate::CLASSIFIED;
use voltet_cpu::integrator::{FallbackReason, LaneKernel, LaneScene, SegmentBatch, SegmentResults};
use voltet_simd::optics::linear::{DEEPEST, front_back};
use voltet_simd::{Float, Lanes, Mask, array};

/// Indices of κ by channel and of ρ among a batch's values.
pub(super) struct VertexSampled {
    places: [usize; 4],
    /// Per scene length: offset + scale × stored.
    offsets: [f32; 4],
    scales: [f32; 4],
}

impl VertexSampled {
    /// Errors: a scene that is not classified, or in numbers beyond 32 bits.
    pub fn new(scene: &LaneScene<'_>) -> Result<VertexSampled, FallbackReason> {
        let mut made = VertexSampled { places: [0; 4], offsets: [0.0; 4], scales: [0.0; 4] };
        for (k, name) in CLASSIFIED.into_iter().enumerate() {
            let axis = scene.field(name).ok_or(FallbackReason::Integrator)?;
            made.places[k] = axis.place;
            made.offsets[k] = (axis.offset * scene.length()) as f32;
            made.scales[k] = (axis.scale * scene.length()) as f32;
        }
        let held = made.offsets.iter().chain(&made.scales).all(|x| x.is_finite());
        if held { Ok(made) } else { Err(FallbackReason::Lengths) }
    }
}

impl LaneKernel for VertexSampled {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let splat = L::F::splat;
        let (zero, half) = (splat(0.0), splat(0.5));
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let length = batch.segments::<L>(at).length();
            let crossing = zero.lt(length);
            let length = L::F::select(crossing, length, zero);
            // Interpolation may leave less than nothing; what is no number stays none.
            let ends: [[L::F; 2]; 4] = array(
                #[inline(always)]
                |k| {
                    let [front, back] = batch.ends::<L>(self.places[k], at);
                    let (scale, offset) = (splat(self.scales[k]), splat(self.offsets[k]));
                    [front, back].map(
                        #[inline(always)]
                        |stored| zero.max(stored.mul_add(scale, offset)) * length,
                    )
                },
            );
            let (front, back) = (ends.map(|[front, _]| front), ends.map(|[_, back]| back));
            let depth = half.mul_add(front[3], half * back[3]);
            results.put_depth::<L>(at, depth);
            let mut unsure = depth.le(splat(0.5 * DEEPEST)).not().bits();
            // At a cutoff of 0 glows what does not absorb.
            let mut whole = depth;
            for k in 0..3 {
                whole = whole + (front[k] + back[k]);
            }
            let there = zero.lt(whole).bits();
            if !batch.depth_only() {
                let color = if there == 0 {
                    [zero; 3]
                } else {
                    let (near, far) = front_back::<L>(front[3], back[3]);
                    array(
                        #[inline(always)]
                        |c| near.mul_add(front[c], far * back[c]),
                    )
                };
                let whole = depth + (color[0] + (color[1] + color[2]));
                unsure |= whole.le(splat(f32::MAX)).not().bits();
                results.put::<L>(at, color, depth);
            }
            let within = batch.within::<L>(crossing, at);
            results.fall_back(at, unsure & within);
            results.count_evaluations(u64::from((there & within & !unsure).count_ones()));
        }
    }
}
