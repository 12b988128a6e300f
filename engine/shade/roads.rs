//! The three roads of a batch, one after the other; each kernel is compiled once a lane set.

use crate::fragments::batch::Batch;
use crate::shade::later::Later;
use crate::shade::shaded::Shaded;
use crate::shade::shader::Shader;
use voltet_lanes::{Kernel, LaneSet, Lanes, dispatch};

/// Integrates the first `count` fragments of a batch: in lanes, and in 64 bits what they leave over, of which some may wait for
/// their colour where `later` is given.
pub(crate) fn integrate(
    shader: &Shader,
    lanes: LaneSet,
    batch: &Batch,
    count: usize,
    out: &mut Shaded,
    later: Option<&mut Later>,
) {
    dispatch(lanes, Shade { shader, batch, count, out });
    if !out.rest.is_empty() {
        dispatch(lanes, Walk { shader, batch, out });
        if let Some(later) = later {
            later.keep(batch, out);
        }
        shader.finish(batch, out);
    }
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

struct Walk<'a> {
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut Shaded,
}

impl Kernel for Walk<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.shader.walk::<L>(self.batch, self.out);
    }
}
