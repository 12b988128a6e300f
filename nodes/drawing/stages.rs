//! The stages on the native engine, with their notes.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::graph::{Call, Look, Revision, diagonal};
use voltet_core::lanes::LaneSet;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::reference;
use voltet_core::shading::{Order, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_engine::{self as engine, Cells, Projection};

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
    let cells = call.stage("cull", |progress| engine::cull(volume, transfer_function, camera, progress))?;
    let counts = &mut call.notes.counts;
    counts.insert("cells_total", volume.grid.tetrahedra.len() as u64);
    counts.insert("cells_culled", cells.culled_by_transfer_function + cells.culled_by_frustum);
    if cells.culled_by_transfer_function > 0 {
        let what = format!("{} cells", cells.culled_by_transfer_function);
        call.notes.leave_out(what, "no widget touches their values");
    }
    if cells.culled_by_frustum > 0 {
        call.notes.leave_out(format!("{} cells", cells.culled_by_frustum), "they are outside the view");
    }
    for &widget in &cells.untouched {
        call.notes.leave_out(format!("widget {}", widget + 1), "no visible cell touches it");
    }
    Ok(cells)
}

/// Gives the cells their order; the exact one is carried out pixel by pixel, by [`composite`].
pub fn sort(call: &mut Call, cells: &Cells, camera: &Camera, order: Order) -> Result<Cells> {
    call.stage("sort", |_| engine::sort(cells, camera, order))
}

/// Projects the cells for one camera; `gradient`: for light or silhouettes.
pub fn project(
    call: &mut Call,
    cells: &Cells,
    transfer_function: &TransferFunction,
    camera: &Camera,
    gradient: bool,
) -> Result<Projection> {
    let project =
        |progress: &dyn Progress| engine::project(cells, transfer_function, camera, gradient, progress);
    let projection = call.stage("project", project)?;
    call.notes.counts.insert("cells_projected", projection.cells_projected());
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
    let noted = &mut call.notes.counts;
    noted.insert("segments", counts.segments);
    noted.insert("segments_exact", counts.segments_exact);
    noted.insert("segments_overlapping", counts.segments_overlapping);
    noted.insert("tiles_deep", counts.tiles_deep);
    noted.insert("pixels_disordered", counts.pixels_disordered);
    if counts.pixels_disordered > 0 {
        let what =
            format!("{} pixels were composited in an order that is not exact", counts.pixels_disordered);
        call.notes.warnings.push(what);
    }
    let threads = rayon::current_num_threads();
    call.notes.adapter = Some(format!("{}, {threads} threads", LaneSet::detect().name()));
    Ok(picture)
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
