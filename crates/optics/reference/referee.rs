//! The referee as one of the program's engines: what `integrator = "reference"` asks for.

use super::draw;
use crate::engine::{Declaration, Drawn, Engine, Forms, Manner, Prepared, Stage, Timed};
use crate::scene::Scene;
use crate::shading::Integrator;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// The referee. It draws every scene by quadrature, whatever the integrator, and offers itself for that of its name.
pub const ENGINE: Declaration = Declaration {
    name: "reference",
    summary: "64-bit adaptive quadrature, slow",
    taken: None,
    absent: None,
    on_device: false,
    compositing: &[],
    can_serve: |_, shading| match shading.integrator {
        Integrator::Reference => Ok(()),
        other => Err(Error::usage("the 64-bit reference has one integrator")
            .found(other.name())
            .accepted(Integrator::Reference.name())),
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
    fn forms(&self) -> Option<Box<dyn Forms>> {
        None
    }

    fn prepare(&self, _volume: &Arc<Volume>) -> Result<Arc<dyn Prepared>> {
        Ok(Arc::new(Referee))
    }
}

impl Prepared for Referee {
    fn draw(&self, scene: &Scene, _manner: &Manner, progress: &dyn Progress) -> Result<Drawn> {
        let start = Instant::now();
        let picture = draw(scene, progress)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Drawn::new(picture, vec![Timed { stage: Stage::Composite, pass: Some("reference"), seconds }]))
    }
}
