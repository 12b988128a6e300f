//! Kernels of a batch, one after the other: closed forms, then slower kernels for the segments that those do not integrate.

use crate::fragments::batch::{Batch, MAX_LANES};
use crate::shade::integrator::{SegmentBatch, SegmentResults};
use crate::shade::kernel::{BatchRange, run_kernel};
use crate::shade::shaded_batch::ShadedBatch;
use crate::shade::shader::{FirstKernel, Shader};
use voltet_simd::{Kernel, LaneSet, Lanes, dispatch};

/// Integrates the first `count` segments of a batch: in lanes, and in 64 bits those that lanes do not integrate.
pub(crate) fn integrate(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut ShadedBatch) {
    integrate_first(shader, lanes, batch, count, out);
    finish(shader, lanes, batch, out);
}

/// Integrates the first `count` segments of a batch by the kernel that comes first; others are queued.
pub(crate) fn integrate_first(
    shader: &Shader,
    lanes: LaneSet,
    batch: &Batch,
    count: usize,
    out: &mut ShadedBatch,
) {
    out.clear();
    let range = BatchRange { widgets: &shader.widgets, one_color: shader.one_color.is_some(), batch, count };
    match shader.first() {
        FirstKernel::Integrator(integrator) => {
            integrator.run(lanes, SegmentBatch(range), &mut SegmentResults(out));
        }
        FirstKernel::SinglePiecewise(linear) => run_kernel(lanes, linear, range, out),
        FirstKernel::OneColor(kernel) => run_kernel(lanes, &kernel, range, out),
        FirstKernel::Several(kernel) => run_kernel(lanes, &kernel, range, out),
        FirstKernel::None => queue_all(range, out),
    }
}

/// Queues all segments of a range for slower kernels.
fn queue_all(BatchRange { batch, count, .. }: BatchRange<'_>, out: &mut ShadedBatch) {
    // Fragments of no length are summed, too.
    out.depth[..count.next_multiple_of(MAX_LANES)].fill(0.0);
    out.fallback_queue.extend((0..count).filter(|&k| 0.0 < batch.length[k]));
    out.evaluation_count += out.fallback_queue.len() as u64;
}

/// Integrates queued segments: by fixed quadrature and panels, by panels for optically thick segments, and in 64 bits.
pub(crate) fn finish(shader: &Shader, lanes: LaneSet, batch: &Batch, out: &mut ShadedBatch) {
    out.reasons.clear();
    for number in 0..out.quadrature_queues.len() {
        if !out.quadrature_queues[number].is_empty() {
            dispatch(lanes, FixedQuadrature { shader, number, batch, out });
        }
    }
    if !out.thick_pieces.is_empty() {
        dispatch(lanes, ThickPieces { shader, batch, out });
    }
    if !out.fallback_queue.is_empty() {
        dispatch(lanes, PanelKernel::<false> { shader, batch, out });
        if shader.has_thick_panels() {
            out.move_optically_thick();
        }
    }
    if !out.optically_thick.is_empty() {
        dispatch(lanes, PanelKernel::<true> { shader, batch, out });
    }
    if !out.fallback_queue.is_empty() {
        shader.finish(batch, out);
    }
}

struct FixedQuadrature<'a> {
    shader: &'a Shader,
    number: usize,
    batch: &'a Batch,
    out: &'a mut ShadedBatch,
}

impl Kernel for FixedQuadrature<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.integrate_fixed::<L>(self.number, self.batch, self.out);
    }
}

struct ThickPieces<'a> {
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut ShadedBatch,
}

impl Kernel for ThickPieces<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.integrate_thick_pieces::<L>(self.batch, self.out);
    }
}

struct PanelKernel<'a, const THICK: bool> {
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut ShadedBatch,
}

impl<const THICK: bool> Kernel for PanelKernel<'_, THICK> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.integrate_panels::<L, THICK>(self.batch, self.out);
    }
}
