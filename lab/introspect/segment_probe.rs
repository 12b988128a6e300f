//! Integrators apart from any picture: what they make of single segments of a scene.

use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_cpu::{Cells, cull, integrator};
use voltet_optics::integrators::SegmentIntegrator;
use voltet_optics::scene::Scene;
use voltet_optics::shading::Shading;

/// The cells of a scene that the native engine draws, which decide what an integrator's tables hold.
pub struct SegmentProbe<'a> {
    scene: &'a Scene,
    cells: Cells,
}

impl<'a> SegmentProbe<'a> {
    /// Culls. Errors: a grid without extent, a camera out of range, a stopped run.
    pub fn new(scene: &'a Scene, progress: &dyn Progress) -> Result<Self> {
        let cells = cull(&scene.volume, &scene.transfer_function, &scene.camera, progress)?;
        Ok(SegmentProbe { scene, cells })
    }

    /// The integrator of a shading, as the native engine makes it for this scene. Errors: it cannot serve the scene.
    pub fn integrator(&self, shading: &Shading) -> Result<Box<dyn SegmentIntegrator>> {
        integrator(&self.cells, &self.scene.transfer_function, shading)
    }
}
