//! Scenes from a node's inputs, and the stages on the native engine, with their notes.

use super::diagnostics::{self, note, note_bands, note_whole};
use super::engines::draw_on;
use super::shading::{order, shading};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_cpu::{self as engine, Cells, Projection};
use voltet_graph::{Revision, RunContext, TransferFunctionSpec, diagonal};
use voltet_optics::engine::{EngineInfo, RenderStats, Stage};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Ordering, Shading};
use voltet_simd::LaneSet;

/// The scene at the inputs `volume`, `transfer_function` and `camera`.
pub fn scene(call: &mut RunContext) -> Result<Scene> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    let camera = *call.camera("camera")?;
    let shading = shading(call.parameters)?;
    let transfer_function = for_data(call, &look, &volume, call.revision("volume")?)?;
    note_bands(call, &volume, &transfer_function)?;
    let order = order(call.parameters)?;
    Ok(Scene { volume, transfer_function, camera, shading, order })
}

/// Cells that were culled, and for which transfer function: no other one may be drawn from them.
#[derive(Debug)]
pub struct Culled {
    /// The cells that are left.
    pub cells: Cells,
    /// Transfer function that they were culled for.
    pub transfer_function: Arc<TransferFunction>,
}

/// Projected cells, and for which transfer function.
#[derive(Debug)]
pub struct Projected {
    /// The projection.
    pub projection: Projection,
    /// Transfer function that the cells were culled and projected for.
    pub transfer_function: Arc<TransferFunction>,
}

/// The diagonal of the data with one revision, kept between runs.
struct Diagonal(f64);

/// The transfer function for the data: its unit distance is known from here on. `revision`: that of the data.
pub fn for_data(
    call: &RunContext,
    look: &TransferFunctionSpec,
    volume: &Volume,
    revision: Revision,
) -> Result<Arc<TransferFunction>> {
    let diagonal = match look.auto_unit_distance {
        true => call.keep(revision, || Ok(Diagonal(diagonal(&volume.grid.points))))?.0,
        false => 0.0,
    };
    Ok(Arc::new(look.for_diagonal(diagonal)))
}

/// Culls the volume that came by the input of that name, and counts what was culled.
pub fn cull(
    call: &mut RunContext,
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
) -> Result<Cells> {
    let (exhaustive, each) = (call.exhaustive(), call.demand.kept_cells);
    let known = call.keep(call.revision("volume")?, || engine::VolumeCache::new(volume))?;
    let cells = call.stage(Stage::Cull.name(), |progress| match exhaustive {
        // That is what is asked for, and leaves nothing out.
        _ if each => known.cull_exact(transfer_function, camera, progress),
        true => known.all(transfer_function, camera),
        false => known.cull(transfer_function, camera, progress),
    })?;
    call.notes.counts.insert("cells_total", volume.grid.tetrahedra.len() as u64);
    let mut counts = RenderStats::default();
    cells.count(&mut counts);
    cells.note(&mut call.notes);
    note(call, &counts);
    Ok(cells)
}

/// Gives the cells their order; the exact one is carried out pixel by pixel, by [`composite`].
pub fn sort(call: &mut RunContext, cells: &Cells, camera: &Camera, ordering: Ordering) -> Result<Cells> {
    let sorted = call.stage(Stage::Sort.name(), |_| engine::sort(cells, camera, ordering))?;
    sorted.note_order(&mut call.notes);
    Ok(sorted)
}

/// Projects the cells for one camera; `gradient`: for light or silhouettes.
pub fn project(
    call: &mut RunContext,
    cells: &Cells,
    transfer_function: &TransferFunction,
    camera: &Camera,
    gradient: bool,
) -> Result<Projection> {
    // For comparison everything that there is goes along.
    let gradient = gradient || (call.exhaustive() && cells.volume.gradient.is_some());
    let project =
        |progress: &dyn Progress| engine::project(cells, transfer_function, camera, gradient, progress);
    let projection = call.stage(Stage::Project.name(), project)?;
    let mut counts = RenderStats::default();
    projection.count(&mut counts);
    note(call, &counts);
    Ok(projection)
}

/// Integrates and composites on the engine.
pub fn composite(
    call: &mut RunContext,
    projection: &Projection,
    transfer_function: &Arc<TransferFunction>,
    shading: &Shading,
) -> Result<Picture> {
    let ready =
        call.stage(Stage::SetUp.name(), |_| engine::prepare(projection, transfer_function, shading))?;
    let (picture, composited) = call.stage(Stage::Composite.name(), |progress| ready.composite(progress))?;
    let mut counts = RenderStats::default();
    composited.count(&mut counts);
    composited.note(&mut call.notes);
    note(call, &counts);
    let scene = scene_of(projection, transfer_function, shading);
    note_whole(call, &scene, &counts)?;
    // Of all stages: what the former ones left out may be the reason.
    projection.cells().count(&mut counts);
    projection.count(&mut counts);
    call.notes.warnings.extend(diagnostics::warnings(&scene, &counts, &picture));
    let threads = rayon::current_num_threads();
    call.notes.adapter = Some(format!("{}, {threads} threads", LaneSet::detect()?.name()));
    Ok(picture)
}

/// Draws every projected cell by the engine that is registered for the integrator.
pub fn composite_registered(
    call: &mut RunContext,
    engine: &'static EngineInfo,
    projection: &Projection,
    transfer_function: &Arc<TransferFunction>,
    shading: &Shading,
) -> Result<Picture> {
    draw_on(call, &scene_of(projection, transfer_function, shading), "projection", engine, false)
}

/// The scene that the stages drew so far.
fn scene_of(projection: &Projection, transfer_function: &Arc<TransferFunction>, shading: &Shading) -> Scene {
    let cells = projection.cells();
    Scene {
        volume: cells.volume.clone(),
        transfer_function: transfer_function.clone(),
        camera: *projection.camera(),
        shading: *shading,
        order: cells.ordering.requested(),
    }
}
