//! The referee as one of the program's engines: what `integrator = "reference"` asks for.

use super::draw;
use crate::engine::{
    Engine, EngineInfo, PreparedVolume, RenderOptions, RenderOutput, SegmentEvaluator, Stage, StageTiming,
};
use crate::scene::Scene;
use crate::shading::Integrator;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// The referee. It draws every scene by quadrature, whatever the integrator, and offers itself for that of its name.
pub const ENGINE: EngineInfo = EngineInfo {
    name: "reference",
    summary: "64-bit adaptive quadrature, slow",
    taken: None,
    unavailable_reason: None,
    on_device: false,
    compositing: &[],
    can_serve: |_, shading| match shading.integrator == Integrator::REFERENCE {
        true => Ok(()),
        false => Err(Error::usage("the 64-bit reference has one integrator")
            .got(shading.integrator.name())
            .expected(Integrator::REFERENCE.name())),
    },
    adapters: Vec::new,
    open: |_, _| Ok(Arc::new(Referee)),
    open_each: |_| Ok(vec![Arc::new(Referee)]),
};

#[derive(Debug, Clone, Copy)]
struct Referee;

impl Engine for Referee {
    fn adapter(&self) -> String {
        format!("64 bits, {} threads", rayon::current_num_threads())
    }

    fn reason(&self) -> Option<&str> {
        Some("the integrator is the 64-bit reference")
    }

    /// It integrates whole rays only.
    fn forms(&self) -> Option<Box<dyn SegmentEvaluator>> {
        None
    }

    fn prepare(&self, _volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>> {
        Ok(Arc::new(Referee))
    }
}

impl PreparedVolume for Referee {
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
