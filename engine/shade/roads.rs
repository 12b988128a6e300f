//! The roads of a batch, one after the other; each kernel is compiled once a lane set.

use crate::fragments::batch::Batch;
use crate::shade::later::Later;
use crate::shade::shaded::Shaded;
use crate::shade::shader::Shader;
use voltet_lanes::{Kernel, LaneSet, Lanes, dispatch};

/// Integrates the first `count` fragments of a batch: in lanes, and in 64 bits what they leave over.
pub(crate) fn integrate(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut Shaded) {
    quick(shader, lanes, batch, count, out);
    finish(shader, lanes, batch, out, None);
}

/// The quick forms of the first `count` fragments of a batch.
pub(crate) fn quick(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut Shaded) {
    dispatch(lanes, Shade { shader, batch, count, out });
}

/// What quick forms leave over; some of it may wait for its colour where `later` is given.
pub(crate) fn finish(
    shader: &Shader,
    lanes: LaneSet,
    batch: &Batch,
    out: &mut Shaded,
    later: Option<&mut Later>,
) {
    for number in 0..out.in_order.len() {
        if !out.in_order[number].is_empty() {
            dispatch(lanes, Step { shader, number, batch, out });
        }
    }
    if later.is_none() {
        let Shaded { rest, dense, .. } = &mut *out;
        rest.append(dense);
    }
    if !out.rest.is_empty() {
        dispatch(lanes, Walk::<false> { shader, batch, out });
        if let Some(later) = later {
            later.keep(batch, out);
        }
        shader.finish(batch, out);
    }
}

/// Dense fragments that quick forms left over, once it is known that they are seen.
pub(crate) fn dense(shader: &Shader, lanes: LaneSet, batch: &Batch, out: &mut Shaded) {
    dispatch(lanes, Walk::<true> { shader, batch, out });
    shader.finish(batch, out);
}

struct Shade<'a> {
    shader: &'a Shader,
    batch: &'a Batch,
    count: usize,
    out: &'a mut Shaded,
}

impl Kernel for Shade<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.shade::<L>(self.batch, self.count, self.out);
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
