//! Pictures of grids that are drawn part by part, as [`voltet_optics::depth_image`] puts them together.

use crate::drawing::Tested;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::whole_cells;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::VolumeExtent;
use voltet_cpu::ENGINE;
use voltet_optics::depth_image::VolumetricDepthImage;
use voltet_optics::engine::{AdapterRequest, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, within};
use voltet_testing::pictures::surfaces;

/// The engine, of a grid in parts.
pub struct ByParts;

/// Number of parts; the last one has no cells where cells are dealt out in blocks.
const PARTS: usize = 4;

/// Difference of pictures of other partitions: rounding of some hundred layers.
const SAME: f64 = 1e-5;

/// The same where rays graze long cells at an angle of 0.002: what a part's points are rounded by on the screen depends on its extent.
const GRAZING: (&str, f64) = ("cyclic above", 3e-4);

impl Engine for ByParts {
    fn picture(&self, named: &NamedScene, shading: &Shading) -> Option<Picture> {
        let scene = Scene::new(
            named.volume.clone(),
            Arc::new(named.look.clone()),
            named.camera,
            *shading,
            VisibilityOrder::Exact,
        );
        let bound = if named.name == GRAZING.0 { GRAZING.1 } else { SAME };
        Some(in_parts(&scene, bound))
    }

    fn serves(&self, integrator: &Integrator, look: &TransferFunction) -> bool {
        Tested.serves(integrator, look)
    }

    fn rounding(&self) -> f64 {
        Tested.rounding()
    }

    fn grazing(&self) -> f64 {
        Tested.grazing()
    }
}

/// The picture of cells in blocks, which is that of cells dealt out at random.
fn in_parts(scene: &Scene, bound: f64) -> Picture {
    let count = scene.volume.grid.tetrahedra.len();
    let by_block = |cell: usize| cell * (PARTS - 1) / count;
    let at_random =
        |cell: usize| ((cell as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as usize % PARTS;
    let [blocks, dealt] = [draw(scene, by_block), draw(scene, at_random)].map(|drawn| drawn.expect("draws"));
    // Tables extend to the largest values of the cells that are drawn with them.
    if !scene.shading.integrator.has_table() {
        within("cells dealt out", &dealt, &blocks, bound);
    }
    blocks
}

fn draw(scene: &Scene, part_of: impl Fn(usize) -> usize + Sync) -> Result<Picture> {
    let engine = ENGINE.open(&AdapterRequest::default())?;
    let source = scene.ray_event_source()?;
    let offsets = scene.camera.sample_offsets();
    let events =
        source.iter().flat_map(|source| offsets.iter().map(|offset| source.events(*offset, &NoProgress)));
    let events = events.collect::<Result<Vec<_>>>()?;
    let size = scene.camera.size.map(|n| n as usize);
    let whole = VolumeExtent::from_volume(&scene.volume);
    let mut all = VolumetricDepthImage::empty(size, offsets.len());
    for part in 0..PARTS {
        let cells = whole_cells(&scene.volume.grid, |cell| part_of(cell) == part, &NoProgress)?;
        if cells.tetrahedra.is_empty() {
            continue;
        }
        let scene = Scene { volume: Arc::new(scene.volume.subset(&cells)), ..scene.clone() };
        let manner = RenderOptions { part: true, ..RenderOptions::default() };
        let drawn = engine.prepare_part(&scene.volume, &whole)?.draw(&scene, &manner, &NoProgress)?;
        all = all.merged(&drawn.depth_image.expect("was asked for"), &events)?;
    }
    Ok(all.picture(&events))
}

voltet_testing::picture_tests!(crate::parts::ByParts);

macro_rules! surfaces {
    ($($name:ident),*) => {
        $(#[test]
        fn $name() {
            surfaces::$name(&|scene| Some(in_parts(scene, SAME)));
        })*
    };
}

surfaces!(fifty_surfaces, tubes_and_spheres, surfaces_in_faces_of_cells, surfaces_without_cells, clips);
