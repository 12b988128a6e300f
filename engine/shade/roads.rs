//! The roads of a batch, one after the other; each kernel is compiled once a lane set.

use crate::fragments::batch::Batch;
use crate::shade::quick::{Alone, OneColor, Several};
use crate::shade::shaded::Shaded;
use crate::shade::shader::{First, Shader};
use voltet_lanes::{Kernel, LaneSet, Lanes, dispatch};

/// Integrates the first `count` fragments of a batch: in lanes, and in 64 bits what they leave over.
pub(crate) fn integrate(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut Shaded) {
    quick(shader, lanes, batch, count, out);
    finish(shader, lanes, batch, out);
}

/// The quick forms of the first `count` fragments of a batch.
pub(crate) fn quick(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut Shaded) {
    out.clear();
    match shader.first() {
        First::Method(method) => {
            method.shade(lanes, &shader.widgets, shader.one_color.is_some(), batch, count, out)
        }
        First::Alone(points) => dispatch(lanes, Alone { points, batch, count, out }),
        First::OneColor => dispatch(lanes, OneColor { shader, batch, count, out }),
        First::Several => dispatch(lanes, Several { shader, batch, count, out }),
        First::Nothing => shader.leave(batch, count, out),
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
