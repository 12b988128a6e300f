//! Surfaces and clips, by rays that go from cell to cell and by projected cells.

use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_cpu::{self as engine, Traversal};
use voltet_optics::scene::Scene;
use voltet_testing::pictures::surfaces;

fn draw(scene: &Scene, traversal: Traversal) -> Picture {
    let Scene { volume, transfer_function, camera, shading, .. } = scene;
    let draw = || -> Result<Picture> {
        let mut cells = engine::cull(volume, transfer_function, camera, &NoProgress)?;
        cells.traversal = traversal;
        let cells = engine::sort(&cells, camera, scene.ordering(false))?;
        let gradient = engine::needs_gradient(shading);
        let projection = engine::project(&cells, transfer_function, camera, gradient, &NoProgress)?;
        Ok(engine::prepare_scene(&projection, scene)?.composite_scene(scene, None, &NoProgress)?.0)
    };
    draw().expect("draws")
}

macro_rules! tests {
    (mod $module:ident, $traversal:expr, $($name:ident),*) => {
        mod $module {
            $(#[test]
            fn $name() {
                super::surfaces::$name(&|scene| Some(super::draw(scene, $traversal)));
            })*
        }
    };
    ($($name:ident),*) => {
        tests!(mod by_rays, super::Traversal::RayCast, $($name),*);
        tests!(mod by_cells, super::Traversal::Project, $($name),*);
    };
}

tests!(
    fifty_surfaces,
    tubes_and_spheres,
    surfaces_in_faces_of_cells,
    surfaces_without_cells,
    clips,
    deep_pixels
);
