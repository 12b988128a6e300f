//! Surfaces, clips and logarithmic axes, by rays that go from cell to cell and by projected cells.

use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_cpu::{self as engine, Traversal};
use voltet_optics::scene::Scene;
use voltet_testing::pictures::{curved_axes, surfaces};

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
    (mod $module:ident, $traversal:expr, $($from:ident::$name:ident),*) => {
        mod $module {
            $(#[test]
            fn $name() {
                super::$from::$name(&|scene| Some(super::draw(scene, $traversal)));
            })*
        }
    };
    ($($from:ident::$name:ident),*) => {
        tests!(mod by_rays, super::Traversal::RayCast, $($from::$name),*);
        tests!(mod by_cells, super::Traversal::Project, $($from::$name),*);
    };
}

tests!(
    surfaces::fifty_surfaces,
    surfaces::tubes_and_spheres,
    surfaces::surfaces_in_faces_of_cells,
    surfaces::surfaces_without_cells,
    surfaces::clips,
    surfaces::deep_pixels,
    curved_axes::fields_over_decades,
    curved_axes::decades_lit_and_cut
);
