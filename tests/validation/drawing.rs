//! The native engine, as the shared scenes ask for it.

use voltet_core::Result;
use voltet_core::optics::integrators;
use voltet_core::picture::Picture;
use voltet_core::progress::Silent;
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_engine as engine;
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY};

/// The engine.
pub struct Tested;

impl Engine for Tested {
    fn picture(&self, scene: &NamedScene, shading: &Shading) -> Option<Picture> {
        Some(picture(scene, shading))
    }

    fn serves(&self, integrator: &Integrator, look: &TransferFunction) -> bool {
        integrators::can_serve(integrator, look).is_ok()
    }

    fn rounding(&self) -> f64 {
        1e-6
    }

    /// Crossings keep their digits.
    fn grazing(&self) -> f64 {
        ORDINARY
    }
}

/// The picture.
pub fn picture(scene: &NamedScene, shading: &Shading) -> Picture {
    let draw = || -> Result<Picture> {
        let cells = engine::cull(&scene.volume, &scene.look, &scene.camera, &Silent)?;
        Ok(engine::draw(&cells, &scene.look, &scene.camera, shading, &Silent)?.0)
    };
    draw().unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}
