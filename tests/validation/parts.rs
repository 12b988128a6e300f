//! Pictures of grids that are drawn part by part, as [`voltet_optics::depth_image`] puts them together.

use crate::drawing::Tested;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::whole_cells;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_cpu::ENGINE;
use voltet_optics::depth_image::VolumetricDepthImage;
use voltet_optics::engine::{AdapterRequest, PreparedPart, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::scene_parts::{PartTally, SceneChoices, SceneExtent};
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, within};
use voltet_testing::pictures::surfaces;

/// The engine, of a grid in parts.
pub struct ByParts;

/// Number of parts; the last one has no cells where cells are dealt out in blocks.
const PARTS: usize = 4;

/// Difference of any channel from the picture of the whole grid: rounding of sums of some hundred layers.
const SAME: f64 = 1e-6;

impl Engine for ByParts {
    fn picture(&self, named: &NamedScene, shading: &Shading) -> Option<Picture> {
        let scene = Scene::new(
            named.volume.clone(),
            Arc::new(named.look.clone()),
            named.camera,
            *shading,
            VisibilityOrder::Exact,
        );
        Some(in_parts(&scene))
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

/// The picture of cells in blocks, which is that of cells dealt out at random, and that of the whole grid.
fn in_parts(scene: &Scene) -> Picture {
    let count = scene.volume.grid.tetrahedra.len();
    let by_block = |cell: usize| cell * (PARTS - 1) / count;
    let at_random =
        |cell: usize| ((cell as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as usize % PARTS;
    let [blocks, dealt] = [draw(scene, by_block), draw(scene, at_random)].map(|drawn| drawn.expect("draws"));
    // Tables over lengths extend to the longest of the cells that are drawn with them.
    if !scene.shading.integrator.has_table_of_lengths() {
        let whole = drawn_whole(scene).expect("draws");
        within("cells in blocks", &blocks, &whole, SAME);
        within("cells dealt out", &dealt, &whole, SAME);
    }
    blocks
}

fn drawn_whole(scene: &Scene) -> Result<Picture> {
    let volume = ENGINE.open(&AdapterRequest::default())?.prepare(&scene.volume)?;
    Ok(volume.draw(scene, &RenderOptions::default(), &NoProgress)?.picture)
}

fn draw(scene: &Scene, part_of: impl Fn(usize) -> usize + Sync) -> Result<Picture> {
    let engine = ENGINE.open(&AdapterRequest::default())?;
    let source = scene.ray_event_source()?;
    let offsets = scene.camera.sample_offsets();
    let events =
        source.iter().flat_map(|source| offsets.iter().map(|offset| source.events(*offset, &NoProgress)));
    let events = events.collect::<Result<Vec<_>>>()?;
    let size = scene.camera.size.map(|n| n as usize);
    let mut parts = Vec::new();
    for part in 0..PARTS {
        let cells = whole_cells(&scene.volume.grid, |cell| part_of(cell) == part, &NoProgress)?;
        if !cells.tetrahedra.is_empty() {
            parts.push(Scene { volume: Arc::new(scene.volume.subset(&cells)), ..scene.clone() });
        }
    }
    let fields = scene.transfer_function.fields();
    let extents = parts.iter().map(|part| SceneExtent::of_part(&part.volume, &fields, &scene.camera));
    let extents = extents.collect::<Result<Vec<_>>>()?;
    let whole = extents.into_iter().reduce(|whole, own| whole.joined(&own)).expect("a part has cells");
    let prepared = parts.iter().map(|part| Ok((part, engine.prepare_part(&part.volume, &whole)?)));
    let prepared = prepared.collect::<Result<Vec<_>>>()?;
    let select = |part: &(&Scene, Arc<dyn PreparedPart>), choices: &SceneChoices| {
        part.1.clone().select(part.0, choices, &RenderOptions::default(), &NoProgress)
    };
    let draw_by = |choices: &SceneChoices| -> Result<(Picture, PartTally)> {
        let mut all = VolumetricDepthImage::empty(size, offsets.len());
        let mut tally = PartTally::default();
        for part in &prepared {
            let selected = select(part, choices)?;
            tally.add(selected.tally(false));
            let image = selected.draw(&NoProgress)?.part.expect("a depth image");
            all = all.merged(&image, &events)?;
        }
        Ok((all.picture(&events), tally))
    };
    // As parts that are read one after the other are drawn.
    let mut choices = SceneChoices::default();
    let picture = loop {
        let (picture, mut tally) = draw_by(&choices)?;
        tally.count_boundary();
        let decided = engine.choices(&whole, &scene.transfer_function, &tally)?;
        if choices.serves(&decided, tally.methods) {
            break picture;
        }
        choices = decided;
    };
    // As parts that are at hand are.
    let decide = |finds_boundary: bool| -> Result<(PartTally, SceneChoices)> {
        let mut tally = PartTally::default();
        for part in &prepared {
            tally.add(select(part, &SceneChoices::default())?.tally(finds_boundary));
        }
        tally.count_boundary();
        let decided = engine.choices(&whole, &scene.transfer_function, &tally)?;
        Ok((tally, decided))
    };
    let (tally, mut decided) = decide(false)?;
    if tally.lacks_boundary && decided.casts_rays == Some(true) {
        decided = decide(true)?.1;
    }
    let (tallied, _) = draw_by(&decided)?;
    within("tallied first", &tallied, &picture, SAME);
    Ok(picture)
}

voltet_testing::picture_tests!(crate::parts::ByParts);

macro_rules! surfaces {
    ($($name:ident),*) => {
        $(#[test]
        fn $name() {
            surfaces::$name(&|scene| Some(in_parts(scene)));
        })*
    };
}

surfaces!(fifty_surfaces, tubes_and_spheres, surfaces_in_faces_of_cells, surfaces_without_cells, clips);
