//! Reference renderer, and its engine.

use crate::segment::{Integrand, Tolerance};
use std::sync::Arc;
use std::time::Instant;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_optics::engine::{
    Engine, EngineInfo, PreparedVolume, RenderOptions, RenderOutput, Stage, StageTiming,
};
use voltet_optics::scene::Scene;
use voltet_optics::trace::{Tiles, Tracer};

/// Name of the engine and of its integrator.
pub(crate) const NAME: &str = "reference";

/// Reference renderer. It draws every scene by quadrature, whatever the integrator, and serves that of its name.
pub const ENGINE: EngineInfo = EngineInfo {
    name: NAME,
    summary: "64-bit adaptive quadrature, slow",
    taken: None,
    unavailable_reason: None,
    on_device: false,
    compositing: &[],
    can_serve: |_, shading| match shading.integrator.name() == NAME {
        true => Ok(()),
        false => Err(Error::usage("the 64-bit reference has one integrator")
            .got(shading.integrator.name())
            .expected(NAME)),
    },
    adapters: Vec::new,
    open: |_, _| Ok(Arc::new(ReferenceRenderer)),
};

#[derive(Debug, Clone, Copy)]
struct ReferenceRenderer;

impl Engine for ReferenceRenderer {
    fn adapter(&self) -> String {
        format!("64 bits, {} threads", rayon::current_num_threads())
    }

    fn reason(&self) -> Option<&str> {
        Some("the integrator is the 64-bit reference")
    }

    fn prepare(&self, _volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>> {
        Ok(Arc::new(ReferenceRenderer))
    }
}

impl PreparedVolume for ReferenceRenderer {
    fn draw(&self, scene: &Scene, _manner: &RenderOptions, progress: &dyn Progress) -> Result<RenderOutput> {
        let start = Instant::now();
        let picture = draw(scene, progress)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(RenderOutput::new(
            picture,
            vec![StageTiming { stage: Stage::Composite, pass: Some("reference"), seconds }],
        ))
    }
}

/// Ray tracer of a scene. Errors: arrays that are missing, numbers out of range.
pub fn tracer(scene: &Scene) -> Result<Tracer<'_>> {
    let integrand = Integrand::new(&scene.transfer_function, scene.shading.overlap, Tolerance::PICTURE)?;
    Tracer::new(scene, Box::new(integrand))
}

/// Draws the scene in 64 bits. Errors: arrays that are missing, numbers out of range, a stopped run.
pub fn draw(scene: &Scene, progress: &dyn Progress) -> Result<Picture> {
    tracer(scene)?.draw(progress)
}

/// Like [`draw`], from the tiles that are there already; where it ends early, `tiles` holds those that are drawn.
pub fn draw_further(scene: &Scene, tiles: &mut Tiles, progress: &dyn Progress) -> Result<Picture> {
    tracer(scene)?.draw_further(tiles, progress)
}
