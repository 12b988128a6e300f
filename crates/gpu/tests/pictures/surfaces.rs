//! Surfaces, clips and logarithmic axes on a device.

use crate::drawing::device;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_gpu::Renderer;
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_testing::pictures::{curved_axes, surfaces};

/// `work`: of a tile in one dispatch, in place of the device's own.
fn draw(scene: &Scene, work: Option<u32>) -> Option<Picture> {
    let renderer = Renderer::new(device()?, &scene.volume).expect("fits");
    let renderer = match work {
        Some(work) => renderer.with_budget_of(work),
        None => renderer,
    };
    // Where tiles do not serve they draw none the less.
    let options = RenderOptions { compositing: Some(Compositor::Raster), ..RenderOptions::default() };
    let drawn = voltet_gpu::draw(&renderer, scene, &options, &NoProgress).expect("draws");
    Some(drawn.picture)
}

macro_rules! tests {
    ($($from:ident::$name:ident),*) => {
        $(#[test]
        fn $name() {
            $from::$name(&|scene| draw(scene, None));
        })*
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

/// Tiles that stop within their lists go on with what is behind, surfaces among it.
#[test]
fn tiles_that_go_on() {
    surfaces::deep_pixels(&|scene| draw(scene, Some(256)));
    surfaces::surfaces_in_faces_of_cells(&|scene| draw(scene, Some(64)));
}
