//! The native engine, as the shared scenes ask for it.

use crate::compare::NamedScene;
use voltet_core::Result;
use voltet_core::optics::integrators;
use voltet_core::picture::Picture;
use voltet_core::progress::Silent;
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_engine as engine;

/// What a dozen 32-bit segments leave of a depth that is known.
pub const ROUNDING: f64 = 1e-6;

/// What is left where rays graze the grid's surface: crossings keep their digits.
pub const GRAZING: f64 = crate::compare::ORDINARY;

/// Whether the engine has the integrator for a look.
pub fn serves(integrator: &Integrator, look: &TransferFunction) -> bool {
    integrators::can_serve(integrator, look).is_ok()
}

/// The picture; always there.
pub fn picture(scene: &NamedScene, shading: &Shading) -> Option<Picture> {
    let draw = || -> Result<Picture> {
        let cells = engine::cull(&scene.volume, &scene.look, &scene.camera, &Silent)?;
        Ok(engine::draw(&cells, &scene.look, &scene.camera, shading, &Silent)?.0)
    };
    Some(draw().unwrap_or_else(|e| panic!("{}: {e}", scene.name)))
}
