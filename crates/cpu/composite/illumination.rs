//! Silhouettes and light, applied to shaded segments.

use crate::composite::frame::FrameContext;
use crate::fragments::batch::Batch;
use crate::shade::light::Rays;
use crate::shade::shaded_batch::ShadedBatch;
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::{Float, Kernel, Lanes};

/// Applies silhouettes and light to shaded segments.
pub(crate) struct Illuminate<'a> {
    pub frame: &'a FrameContext<'a>,
    pub batch: &'a Batch,
    pub count: usize,
    pub rays: &'a Rays,
    pub shaded: &'a mut ShadedBatch,
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
