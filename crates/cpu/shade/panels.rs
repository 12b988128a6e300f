//! Panels: segments that the closed forms do not integrate, gathered into full vectors and integrated
//! panel by panel in their true order ([`voltet_simd::optics::overlap`]): deep linear pieces, overlaps,
//! triangular Gaussians and Gaussians over further fields, the constant-emitter.
//!
//! Opacity comes from the widgets' closed forms, not from panels. Segments that 32 bits cannot integrate are queued again, for
//! 64 bits.

use crate::fragments::batch::{Batch, MAX_LANES};
use crate::shade::kinds::{KernelTier, LaneWidget, OrderRequirement, nothing};
use crate::shade::region::ValueRange;
use crate::shade::segment_lanes::{FieldLanes, SegmentGather, SegmentLanes};
use crate::shade::shaded_batch::{FallbackReason, MIX_PRODUCT, ShadedBatch};
use voltet_core::transfer::TransferFunction;
use voltet_simd::limits::{MAX_DENSE_RATE, MAX_RATE, MIN_WALKED_LENGTH};
use voltet_simd::optics::dense::dense;
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::optics::overlap::ordered;
use voltet_simd::{Float, Lanes, Mask, array, inlined, mask_of};

pub(crate) struct PanelQuadrature {
    /// Cutoff of the constant-emitter.
    cutoff: Option<f64>,
    /// D/U per scene length.
    scale: f32,
    one_color: bool,
    /// True if overlaps are counted here: the closed forms count those that pass through them.
    counts: bool,
    /// Pairwise product of depths from which on the order of widgets counts.
    ordered_from: f32,
}

impl PanelQuadrature {
    /// Panels for widgets; the reason where one of them has none.
    pub fn new(
        transfer_function: &TransferFunction,
        widgets: &[LaneWidget],
        length: f64,
        one_color: bool,
        counts: bool,
        ordered_from: f32,
    ) -> Result<PanelQuadrature, FallbackReason> {
        if widgets.is_empty() || widgets.iter().any(|widget| widget.traits().tier == KernelTier::Bits64) {
            return Err(FallbackReason::NoLanes);
        }
        let cutoff = transfer_function.model.cutoff();
        let scale = (length / transfer_function.unit_distance) as f32;
        // A scale beyond 32 bits, or so small that its products leave them.
        if scale.is_finite() && scale > MIN_WALKED_LENGTH {
            Ok(PanelQuadrature { cutoff, scale, one_color, counts, ordered_from })
        } else {
            Err(FallbackReason::Lengths)
        }
    }

    /// Integrates the segments `which` of a batch; those that fall back are queued, each with the reason. `thick`: in panels for
    /// optically thick segments, which cost more.
    #[inline(always)]
    pub fn integrate_all<L: Lanes>(
        &self,
        thick: bool,
        widgets: &[LaneWidget],
        batch: &Batch,
        which: &[usize],
        out: &mut ShadedBatch,
    ) {
        let columns = batch.scalar_count;
        let mut gather = SegmentGather::new(columns);
        for group in which.chunks(L::WIDTH) {
            gather.take(batch, group);
            let segments = gather.segments::<L>();
            let fields = gather.fields::<L>();
            let (results, left, overlapping) =
                self.integrate::<L>(thick, widgets, &segments, &fields, &mut out.evaluation_count);
            let unsure = left.iter().fold(0, |all, (lanes, _)| all | lanes);
            let mut rows = [[0f32; MAX_LANES]; 5];
            for (row, value) in rows.iter_mut().zip(results) {
                value.store(row);
            }
            for (lane, &k) in group.iter().enumerate() {
                if self.counts {
                    out.overlap_count += u64::from(overlapping & !unsure) >> lane & 1;
                }
                if unsure >> lane & 1 != 0 {
                    let first = left.iter().find(|(lanes, _)| lanes >> lane & 1 != 0);
                    out.fallback_queue.push(k);
                    out.reasons.extend(first.map(|(_, why)| *why));
                    // What is too dense for panels has its depth in closed form.
                    out.rgba[3][k] = rows[3][lane];
                    continue;
                }
                out.depth[k] = rows[4][lane];
                for (column, row) in out.rgba.iter_mut().zip(&rows) {
                    column[k] = row[lane];
                }
            }
        }
    }

    /// Colour, opacity and optical depth, the lanes (bits) for the 64-bit path by their reasons, and those where widgets
    /// overlap.
    #[inline(always)]
    fn integrate<L: Lanes>(
        &self,
        thick: bool,
        widgets: &[LaneWidget],
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
        evaluations: &mut u64,
    ) -> ([L::F; 5], [(u32, FallbackReason); 4], u32) {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let (mut total, mut product, mut narrow) = (zero, zero, 0);
        let mut densest = zero;
        let mut color = [zero; 3];
        let (mut varies, mut delicate) = (0, 0);
        let spread = ValueRange::new(segments);
        for widget in widgets {
            let meets = widget.meets::<L>(&spread);
            if !meets.any() {
                continue;
            }
            let (depth, no) =
                L::call(inlined!(|()| widget.any_depth::<L>(&segments.only(meets), fields)), ());
            let depth = L::F::select(meets, depth, zero);
            narrow |= no & meets.bits();
            product = depth.mul_add(total, product);
            total = total + depth;
            let dense = splat(widget.peak(self.scale)) * segments.length;
            densest = densest + L::F::select(meets, dense, zero);
            for (sum, c) in color.iter_mut().zip(widget.color) {
                *sum = depth.mul_add(splat(c), *sum);
            }
            match widget.traits().order {
                OrderRequirement::Panels => {}
                OrderRequirement::Always => varies |= zero.lt(depth).bits(),
                OrderRequirement::Bits64 => delicate |= zero.lt(depth).bits(),
            }
        }
        // A depth that is not a number, or has left 32 bits.
        let overflow = total.le(splat(f32::MAX)).not().bits();
        let left = |delicate: u32, dense: u32| {
            [
                (narrow, FallbackReason::Narrow),
                (overflow, FallbackReason::Overflow),
                (delicate, FallbackReason::Delicate),
                (dense, FallbackReason::Dense),
            ]
        };
        let overlapping = splat(MIX_PRODUCT).lt(product).bits() & segments.crossing.bits();
        let opacity = one_minus_exp::<L>(total);
        if self.one_color {
            return ([zero, zero, zero, opacity, total], left(0, 0), overlapping);
        }
        let share = L::F::select(zero.lt(total), opacity / total, zero);
        let mut color: [L::F; 3] = array!(|i| color[i] * share);
        let crossing = segments.crossing.bits();
        let in_order = match self.cutoff {
            Some(_) => crossing,
            None => crossing & (splat(self.ordered_from).lt(product).bits() | varies),
        };
        let delicate = in_order & delicate;
        let max = if thick { MAX_DENSE_RATE } else { MAX_RATE };
        let mut too_dense = in_order & splat(max).lt(densest).bits();
        if in_order & !(narrow | overflow | delicate | too_dense) != 0 {
            let scale = segments.length * splat(self.scale);
            let mut members = Vec::with_capacity(widgets.len());
            for widget in widgets {
                let meets = widget.meets::<L>(&spread);
                if meets.any() {
                    let mut member =
                        L::call(inlined!(|()| widget.member::<L>(segments, fields, scale, self.cutoff)), ());
                    let nowhere = nothing::<L>().range;
                    for (end, nowhere) in member.range.iter_mut().zip(nowhere) {
                        *end = L::F::select(meets, *end, nowhere);
                    }
                    members.push(member);
                }
            }
            let walked = if thick {
                let (color, light, unsure) = L::call(inlined!(|()| dense::<L>(&members)), ());
                too_dense |= in_order & unsure.bits();
                // All light together is known in closed form.
                let exact = opacity / light.max(splat(f32::MIN_POSITIVE));
                array!(|i| color[i] * exact)
            } else {
                let glow = self.cutoff.map(|_| scale);
                let (color, points) = L::call(inlined!(|()| ordered::<L>(&members, glow)), ());
                *evaluations += points;
                color
            };
            let keep = mask_of::<L>(in_order);
            color = array!(|i| L::F::select(keep, walked[i], color[i]));
        }
        ([color[0], color[1], color[2], opacity, total], left(delicate, too_dense), overlapping)
    }
}
