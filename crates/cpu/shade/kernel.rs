//! Kernels over batches, each compiled once a lane set.

use crate::fragments::batch::{Batch, meant};
use crate::shade::kinds::LaneWidget;
use crate::shade::segment_lanes::SegmentLanes;
use crate::shade::shaded_batch::{MIX_PRODUCT, ShadedBatch};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, dispatch};

/// The first `count` segments of a batch.
#[derive(Clone, Copy)]
pub(crate) struct BatchRange<'a> {
    pub widgets: &'a [LaneWidget],
    /// True if only optical depths are computed.
    pub one_color: bool,
    pub batch: &'a Batch,
    pub count: usize,
}

/// Kernel that integrates all segments first. Each is compiled by itself, since the time to compile a function grows with the square of
/// its size.
pub(super) trait ShadingKernel {
    /// Integrates a range of a batch. Mark it `#[inline(always)]`.
    fn shade<L: Lanes>(&self, range: BatchRange<'_>, out: &mut ShadedBatch);
}

/// Integrates a range of a batch by a kernel.
pub(super) fn run_kernel<K: ShadingKernel>(
    lanes: LaneSet,
    kernel: &K,
    range: BatchRange<'_>,
    out: &mut ShadedBatch,
) {
    dispatch(lanes, RangeRun { kernel, range, out });
}

struct RangeRun<'a, K> {
    kernel: &'a K,
    range: BatchRange<'a>,
    out: &'a mut ShadedBatch,
}

impl<K: ShadingKernel> Kernel for RangeRun<'_, K> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.kernel.shade::<L>(self.range, self.out);
    }
}

/// Appends the indices of some lanes (bits) of the vector at `at`.
#[inline(always)]
pub(crate) fn push(list: &mut Vec<usize>, mut lanes: u32, at: usize) {
    while lanes != 0 {
        list.push(at + lanes.trailing_zeros() as usize);
        lanes &= lanes - 1;
    }
}

/// Lanes (bits) of the first `count` segments on which widgets overlap.
#[inline(always)]
pub(crate) fn overlaps<L: Lanes>(product: L::F, segments: &SegmentLanes<L>, count: usize) -> u32 {
    meant::<L>(L::F::splat(MIX_PRODUCT).lt(product).and(segments.crossing), count)
}
