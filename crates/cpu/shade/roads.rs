//! The roads of a batch, one after the other; each kernel is compiled once a lane set.

use crate::fragments::batch::{Batch, MAX_LANES};
use crate::integrator::{SegmentBatch, SegmentResults};
use crate::shade::kinds::LaneWidget;
use crate::shade::shaded::Shaded;
use crate::shade::shader::{First, Shader};
use voltet_simd::{Kernel, LaneSet, Lanes, dispatch};

/// Integrates the first `count` fragments of a batch: in lanes, and in 64 bits what they leave over.
pub(crate) fn integrate(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut Shaded) {
    quick(shader, lanes, batch, count, out);
    finish(shader, lanes, batch, out);
}

/// The quick forms of the first `count` fragments of a batch.
pub(crate) fn quick(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut Shaded) {
    out.clear();
    let part = Part { widgets: &shader.widgets, one_color: shader.one_color.is_some(), batch, count };
    match shader.first() {
        First::Method(method) => method.run(lanes, SegmentBatch(part), &mut SegmentResults(out)),
        First::Alone(points) => serve(lanes, points, part, out),
        First::OneColor(form) => serve(lanes, &form, part, out),
        First::Several(form) => serve(lanes, &form, part, out),
        First::Nothing => leave(part, out),
    }
}

/// Leaves all of a part over.
fn leave(Part { batch, count, .. }: Part<'_>, out: &mut Shaded) {
    // Fragments of no length are summed, too.
    out.depth[..count.next_multiple_of(MAX_LANES)].fill(0.0);
    out.rest.extend((0..count).filter(|&k| 0.0 < batch.length[k]));
    out.evaluation_count += out.rest.len() as u64;
}

/// The first `count` fragments of a batch.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a> {
    pub widgets: &'a [LaneWidget],
    /// Their depths alone are wanted.
    pub one_color: bool,
    pub batch: &'a Batch,
    pub count: usize,
}

/// What serves fragments first. Each is a kernel of its own, since what a compiler takes for a function grows with the square of its
/// size.
pub(super) trait Form {
    /// Mark it `#[inline(always)]`.
    fn shade<L: Lanes>(&self, part: Part<'_>, out: &mut Shaded);
}

/// Serves a part by a form.
pub(super) fn serve<F: Form>(lanes: LaneSet, form: &F, part: Part<'_>, out: &mut Shaded) {
    dispatch(lanes, By { form, part, out });
}

struct By<'a, F> {
    form: &'a F,
    part: Part<'a>,
    out: &'a mut Shaded,
}

impl<F: Form> Kernel for By<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.form.shade::<L>(self.part, self.out);
    }
}

/// What quick forms leave over: by steps and panels, by those that serve dense segments, too, and in 64 bits.
pub(crate) fn finish(shader: &Shader, lanes: LaneSet, batch: &Batch, out: &mut Shaded) {
    out.why.clear();
    for number in 0..out.in_order.len() {
        if !out.in_order[number].is_empty() {
            dispatch(lanes, Step { shader, number, batch, out });
        }
    }
    if !out.deep.is_empty() {
        dispatch(lanes, Deep { shader, batch, out });
    }
    if !out.rest.is_empty() {
        dispatch(lanes, Walk::<false> { shader, batch, out });
        if shader.has_dense_steps() {
            out.set_dense_apart();
        }
    }
    if !out.dense.is_empty() {
        dispatch(lanes, Walk::<true> { shader, batch, out });
    }
    if !out.rest.is_empty() {
        shader.finish(batch, out);
    }
}

struct Step<'a> {
    shader: &'a Shader,
    number: usize,
    batch: &'a Batch,
    out: &'a mut Shaded,
}

impl Kernel for Step<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.stepped::<L>(self.number, self.batch, self.out);
    }
}

struct Deep<'a> {
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut Shaded,
}

impl Kernel for Deep<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.deep::<L>(self.batch, self.out);
    }
}

struct Walk<'a, const DENSE: bool> {
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut Shaded,
}

impl<const DENSE: bool> Kernel for Walk<'_, DENSE> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.walk::<L, DENSE>(self.batch, self.out);
    }
}
