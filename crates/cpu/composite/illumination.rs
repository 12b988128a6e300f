//! Silhouettes and light, applied to shaded segments.

use crate::composite::frame::FrameContext;
use crate::fragments::batch::Batch;
use crate::shade::light::Rays;
use crate::shade::shaded_batch::ShadedBatch;
use crate::shade::shader::integrate;
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::{Float, Kernel, Lanes, dispatch};

/// Shades the first `count` segments of a batch: integrates them, and applies silhouettes and light.
pub(crate) fn shade(
    frame: &FrameContext<'_>,
    batch: &Batch,
    count: usize,
    rays: &Rays,
    shaded: &mut ShadedBatch,
) {
    integrate(frame.shader, frame.lanes, batch, count, shaded);
    illuminate(frame, batch, count, rays, shaded);
}

/// Applies silhouettes and light to shaded segments, where the scene has any.
pub(crate) fn illuminate(
    frame: &FrameContext<'_>,
    batch: &Batch,
    count: usize,
    rays: &Rays,
    shaded: &mut ShadedBatch,
) {
    if frame.shader.surface.is_some() {
        dispatch(frame.lanes, Illuminate { frame, batch, count, rays, shaded });
    }
}

struct Illuminate<'a> {
    frame: &'a FrameContext<'a>,
    batch: &'a Batch,
    count: usize,
    rays: &'a Rays,
    shaded: &'a mut ShadedBatch,
}

impl Kernel for Illuminate<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Illuminate { frame, batch, count, rays, shaded } = self;
        let Some(surface) = &frame.shader.surface else { return };
        for at in (0..count).step_by(L::WIDTH) {
            let (opacity, color) = surface.factors::<L>(batch, at, rays);
            if frame.shader.one_color.is_some() {
                let value = one_minus_exp::<L>(L::F::load(&shaded.depth[at..])) * opacity;
                value.store(&mut shaded.depth[at..]);
            } else {
                for (column, factor) in shaded.rgba.iter_mut().zip([color, color, color, opacity]) {
                    (L::F::load(&column[at..]) * factor).store(&mut column[at..]);
                }
            }
        }
    }
}
