//! The stages on the native engine, with their notes.

use super::Scene;
use super::needs::needs_order;
use super::order::leave_out_order;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::graph::{Call, Look, Revision, Saving, diagonal};
use voltet_core::optics::integrators::PartialTable;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::reference;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::volume::Volume;
use voltet_engine::{self as engine, Cells, Projection};
use voltet_lanes::LaneSet;

/// The diagonal of the data with one revision, kept between runs.
struct Diagonal(f64);

/// The transfer function for the data: its unit distance is known from here on. `revision`: that of the data.
pub fn for_data(
    call: &Call,
    look: &Look,
    volume: &Volume,
    revision: Revision,
) -> Result<Arc<TransferFunction>> {
    let diagonal = match look.auto_unit_distance {
        true => call.keep(revision, || Ok(Diagonal(diagonal(&volume.grid.points))))?.0,
        false => 0.0,
    };
    Ok(Arc::new(look.for_diagonal(diagonal)))
}

/// Culls, and counts what was culled.
pub fn cull(
    call: &mut Call,
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
) -> Result<Cells> {
    let thorough = call.thorough;
    let cells = call.stage("cull", |progress| match thorough {
        true => engine::keep_all(volume, transfer_function, camera),
        false => engine::cull(volume, transfer_function, camera, progress),
    })?;
    let counts = &mut call.notes.counts;
    counts.insert("cells_total", volume.grid.tetrahedra.len() as u64);
    counts.insert("cells_culled", cells.culled_by_transfer_function + cells.culled_by_frustum);
    let by_function = cells.culled_by_transfer_function;
    leave_out_cells(call, by_function, "that show nothing", "no widget touches their values");
    leave_out_cells(call, cells.culled_by_frustum, "out of view", "they lie outside the view");
    for &widget in &cells.untouched {
        call.notes.leave_out(format!("widget {}", widget + 1), "no visible cell touches it", None);
    }
    Ok(cells)
}

pub(super) fn leave_out_cells(call: &mut Call, count: u64, which: &str, why: &str) {
    if count > 0 {
        call.notes.leave_out(format!("cells {which}"), why, Some(Saving::Cells(count)));
    }
}

/// Gives the cells their order; the exact one is carried out pixel by pixel, by [`composite`].
pub fn sort(call: &mut Call, cells: &Cells, camera: &Camera, order: Order) -> Result<Cells> {
    let sorted = call.stage("sort", |_| engine::sort(cells, camera, order))?;
    if order == Order::Centroid {
        call.notes.counts.insert("cells_sorted", sorted.kept.len() as u64);
    }
    Ok(sorted)
}

/// Projects the cells for one camera; `gradient`: for light or silhouettes.
pub fn project(
    call: &mut Call,
    cells: &Cells,
    transfer_function: &TransferFunction,
    camera: &Camera,
    gradient: bool,
) -> Result<Projection> {
    // For comparison everything that there is goes along.
    let gradient = gradient || (call.thorough && cells.volume.gradient.is_some());
    let project =
        |progress: &dyn Progress| engine::project(cells, transfer_function, camera, gradient, progress);
    let projection = call.stage("project", project)?;
    let projected = projection.cells_projected();
    call.notes.counts.insert("cells_projected", projected);
    let missed = (cells.kept.len() as u64).saturating_sub(projected);
    leave_out_cells(call, missed, "under a pixel's reach", "they cover no pixel centre");
    Ok(projection)
}

/// Integrates and composites on the engine.
pub fn composite(
    call: &mut Call,
    projection: &Projection,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> Result<Picture> {
    let composite =
        |progress: &dyn Progress| engine::composite(projection, transfer_function, shading, progress);
    let (picture, counts) = call.stage("composite", composite)?;
    let density = transfer_function.model == OpticalModel::DensityEmitter;
    let mut tables_built = u64::from(counts.table_bytes > 0);
    if counts.table_bytes == 0 && call.thorough {
        let side = call.parameters.integer("table_size")? as usize;
        let table = call.stage("table", |_| Ok(PartialTable::new(density, side)))?;
        tables_built += u64::from(std::hint::black_box(table).bytes() > 0);
    }
    if !call.thorough && projection.cells().order == Order::Auto && !needs_order(transfer_function, shading) {
        leave_out_order(&mut call.notes, Some(counts.segments));
    }
    let noted = &mut call.notes.counts;
    noted.insert("tiles_sorted", counts.tiles_sorted);
    noted.insert("tables_built", tables_built);
    noted.insert("segments", counts.segments);
    noted.insert("segments_exact", counts.segments_exact);
    noted.insert("segments_overlapping", counts.segments_overlapping);
    noted.insert("tiles_deep", counts.tiles_deep);
    noted.insert("pixels_disordered", counts.pixels_disordered);
    note_tiles_stopped(call, counts.tiles_stopped, counts.cells_hidden);
    if counts.pixels_disordered > 0 {
        let what =
            format!("{} pixels were composited in an order that is not exact", counts.pixels_disordered);
        call.notes.warnings.push(what);
    }
    let threads = rayon::current_num_threads();
    call.notes.adapter = Some(format!("{}, {threads} threads", LaneSet::detect().name()));
    Ok(picture)
}

/// Notes tiles that were opaque before their cells were through. `cells`: those that they did not look at, once a tile.
pub(super) fn note_tiles_stopped(call: &mut Call, tiles: u64, cells: u64) {
    call.notes.counts.insert("tiles_stopped", tiles);
    if tiles > 0 {
        let what = format!("cells of {tiles} tiles that stopped early");
        call.notes.leave_out(what, "every pixel of the tile is opaque", Some(Saving::Cells(cells)));
    }
}

/// Every stage on the native engine, or the referee where the integrator is the reference.
pub fn all(call: &mut Call, scene: &Scene) -> Result<Picture> {
    let Scene { volume, transfer_function, camera, shading, order } = scene;
    if shading.integrator == Integrator::Reference {
        return referee(call, volume, transfer_function, camera, shading, *order);
    }
    let cells = cull(call, volume, transfer_function, camera)?;
    let cells = sort(call, &cells, camera, *order)?;
    let gradient = engine::needs_gradient(shading);
    let projection = project(call, &cells, transfer_function, camera, gradient)?;
    composite(call, &projection, transfer_function, shading)
}

/// Draws every cell by the 64-bit referee.
pub fn referee(
    call: &mut Call,
    volume: &Volume,
    transfer_function: &TransferFunction,
    camera: &Camera,
    shading: &Shading,
    order: Order,
) -> Result<Picture> {
    call.notes.counts.insert("cells_total", volume.grid.tetrahedra.len() as u64);
    call.stage("reference", |progress| {
        reference::draw(volume, transfer_function, camera, shading, order, progress)
    })
}
