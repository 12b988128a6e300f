//! The stages end to end: project, composite, and the one-call form.

use crate::attribute::{attributes_of, gradient_attributes, on_axes};
use crate::cast::RayCastPolicy;
use crate::cells::Cells;
use crate::composite::lane_axes::LaneAxes;
use crate::counts::Counts;
use crate::frame_renderer::FrameRenderer;
use crate::memory::drawing_bytes_of;
use crate::projection::{Projection, SubpixelView};
use crate::selection::{CellSelection, Traversal};
use crate::shade::ShaderContext;
use crate::shade::integrator::in_lanes_alone;
use crate::shade::light::Surface;
use crate::shade::shader::Shader;
use rayon::prelude::*;
use voltet_core::camera::Camera;
use voltet_core::error::Remedy;
use voltet_core::grid::extent::longest_edge_squared;
use voltet_core::picture::Picture;
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result, counted};
use voltet_optics::integrators::{self, Extent, SegmentIntegrator};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Ordering, Shading};

/// Projects the selected cells to the screen and bins them by tiles of 16 × 16 pixels.
///
/// Segments carry the quantities that the transfer function reads; others are not projected. `gradient`: true if light or silhouettes will
/// read ∇s ([`needs_gradient`]).
///
/// Errors: a camera out of range, a picture larger than 32,768 pixels a side, more cells than 32 bits count.
pub fn project(
    cells: &Cells,
    transfer_function: &TransferFunction,
    camera: &Camera,
    gradient: bool,
    progress: &dyn Progress,
) -> Result<Projection> {
    camera.check_picture()?;
    let mut attributes = attributes_of(cells, transfer_function)?;
    if gradient {
        attributes.extend(gradient_attributes(cells)?);
    }
    let offsets = camera.sample_offsets();
    let (count, points) = (cells.ids.len() as u64, cells.volume.grid.points.len() as u64);
    // Each sample of a pixel has a projection of its own.
    let resident = (cells.max_resident_cells / cells.ids.len().max(1)).clamp(1, offsets.len());
    let bytes = |faces: Option<u64>| {
        let fields = attributes.len() as u64;
        let bytes = drawing_bytes_of(count, points, fields, camera.size, cells.max_resident_cells, faces);
        bytes.saturating_mul(resident as u64)
    };
    // Where there is no memory for faces, cells are projected.
    let fits = || match progress.memory_left() {
        None => true,
        Some(left) => cells.faces.as_ref().is_some_and(|faces| bytes(Some(faces.missing_bytes())) <= left),
    };
    let mut cells = cells.clone();
    if !fits() {
        cells.traversal = Traversal::Project;
    }
    if cells.traversal == Traversal::Project {
        refuse_beyond_memory(progress, || format!("drawing {}", counted(count, "cell")), bytes(None))
            .map_err(|error| error.with_remedy(Remedy::FewerPixels))?;
    }
    let max_optical_depth = max_optical_depth(transfer_function, cells.length).max(cells.optical_depth_floor);
    let policy = RayCastPolicy::new(transfer_function, max_optical_depth);
    let mut samples = Vec::with_capacity(resident);
    for (k, &offset) in offsets.iter().take(resident).enumerate() {
        progress.report("project", k as f64 / resident as f64);
        let bounds = (max_optical_depth, policy);
        samples.push(SubpixelView::new(&cells, camera, offset, &attributes, bounds, progress)?);
    }
    Ok(Projection { cells, camera: *camera, samples, max_optical_depth, policy })
}

/// Upper bound of the optical depth, or colour, that all widgets together give over a scene length (world units).
pub(crate) fn max_optical_depth(transfer_function: &TransferFunction, length: f64) -> f64 {
    let max = |widget: &Widget| match transfer_function.model {
        OpticalModel::DensityEmitter => widget.peak() * widget.max_emission().max(1.0),
        OpticalModel::ConstantEmitter { .. } => widget.peak().max(widget.max_emission()),
    };
    transfer_function.widgets.iter().map(max).sum::<f64>() / transfer_function.unit_distance * length
}

/// Sets the order in which the compositor takes a pixel's segments. The exact order is carried out at each pixel;
/// [`Ordering::CellCentroid`] sorts the cells here ([`voltet_core::visibility::centroid_order`]), and their
/// segments are composited as they come.
pub fn sort(cells: &Cells, camera: &Camera, ordering: Ordering) -> Result<Cells> {
    let mut sorted = cells.clone();
    sorted.ordering = ordering;
    if ordering == Ordering::CellCentroid {
        let grid = &cells.volume.grid;
        let ids =
            voltet_core::visibility::centroid_order(&grid.points, &grid.tetrahedra, &cells.ids, camera)?;
        sorted.ids = std::sync::Arc::new(ids);
    }
    Ok(sorted)
}

/// Compiles the shader and the integrator that [`FrameRenderer::composite`] draws with.
///
/// Errors: an optical model, widget or integrator that the engine does not support, named with those that it does.
pub fn prepare<'a>(
    projection: &'a Projection,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> Result<FrameRenderer<'a>> {
    prepare_in_order(projection, transfer_function, shading, projection.cells.exhaustive)
}

/// [`prepare`] for a scene of the projection's volume, surfaces and clips included.
pub fn prepare_scene<'a>(projection: &'a Projection, scene: &Scene) -> Result<FrameRenderer<'a>> {
    let Scene { transfer_function, shading, .. } = scene;
    let ordered = projection.cells.exhaustive || scene.has_events();
    prepare_in_order(projection, transfer_function, shading, ordered)
}

/// `ordered`: makes the order also where the widgets need none.
pub(crate) fn prepare_in_order<'a>(
    projection: &'a Projection,
    transfer_function: &TransferFunction,
    shading: &Shading,
    ordered: bool,
) -> Result<FrameRenderer<'a>> {
    let cells = &projection.cells;
    let attributes = attributes_of(cells, transfer_function)?;
    let surface = Surface::new(shading, attributes.len());
    let projected = |count: usize| projection.samples.iter().all(|sample| sample.attribute_count == count);
    let with_gradient = attributes.len() + 3;
    if !projected(with_gradient) && surface.is_some() {
        return Err(Error::usage(
            "the cells were projected without the gradient, which light and silhouettes need",
        )
        .expected("a projection for a shading that asks for them"));
    }
    if !projected(attributes.len()) && !projected(with_gradient) {
        return Err(Error::usage("the cells were projected for another transfer function")
            .expected("the transfer function that the cull stage of the same pipeline has"));
    }
    shading.check(transfer_function)?;
    integrators::can_serve(&shading.integrator, transfer_function)?;
    let active = cells.active_widgets(transfer_function);
    let extent = extent(cells, transfer_function, &shading.integrator);
    // Lanes leave over no segment of a table over lengths: it is filled once, by them.
    let by_lanes = in_lanes_alone(&shading.integrator);
    let exact = if by_lanes { None } else { Some(integrator(cells, &active, shading)?) };
    // Also of widgets that no cell touches: what has no position on an axis that one of them reads is not drawn.
    let shaded = on_axes(&attributes, transfer_function);
    let scene = ShaderContext {
        attributes: &shaded,
        length: cells.length,
        ordered,
        leave_out: !cells.exhaustive,
        extent,
        lanes: cells.lanes,
    };
    let shader = Shader::new(&active, shading, exact, scene, surface)?;
    let table_bytes = shader.table_bytes() as u64;
    let axes = LaneAxes::new(transfer_function, &attributes, &shaded);
    Ok(FrameRenderer { projection, attributes, shader, axes, table_bytes })
}

/// Integrates and composites every pixel's segments: [`prepare`] and [`FrameRenderer::composite`].
///
/// Errors: an optical model, widget or integrator that the engine does not support, named with those that it does.
pub fn composite(
    projection: &Projection,
    transfer_function: &TransferFunction,
    shading: &Shading,
    progress: &dyn Progress,
) -> Result<(Picture, Counts)> {
    prepare(projection, transfer_function, shading)?.composite(progress)
}

/// True if light or silhouettes read ∇s. A silhouette of exponent 0 changes nothing.
pub fn needs_gradient(shading: &Shading) -> bool {
    Surface::new(shading, 0).is_some()
}

/// Draws the selected cells: [`project`] and [`composite`].
pub fn draw(
    cells: &Cells,
    transfer_function: &TransferFunction,
    camera: &Camera,
    shading: &Shading,
    progress: &dyn Progress,
) -> Result<(Picture, Counts)> {
    let projection = project(cells, transfer_function, camera, needs_gradient(shading), progress)?;
    composite(&projection, transfer_function, shading, progress)
}

/// The integrator in 64 bits, which [`prepare`] compiles for the segments that lanes do not integrate.
///
/// Errors: an integrator that does not support the transfer function; one with a number out of range; an integrator that
/// prepares scenes, where this one is not prepared.
pub fn integrator(
    cells: &CellSelection,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> Result<Box<dyn SegmentIntegrator>> {
    let kind = shading.integrator.kind();
    if kind.scene_preparation().is_some_and(|scene| !scene.is_prepared(transfer_function)) {
        let name = shading.integrator.name();
        let what =
            format!("the integrator '{name}' draws scenes as a whole, since it reads the grid's points");
        return Err(Error::usage(what)
            .got("stages or segments of a scene by themselves")
            .expected("a node of type renderer, or another integrator"));
    }
    let extent = extent(cells, transfer_function, &shading.integrator);
    integrators::new(&shading.integrator, shading.overlap, transfer_function, &extent)
}

/// Extent of the segments, for the integrator's tables: no segment inside a cell is longer than its
/// longest edge.
fn extent(cells: &CellSelection, transfer_function: &TransferFunction, integrator: &Integrator) -> Extent {
    let scalar = transfer_function.axes_read()[0].positions(cells.ranges[0]);
    let full = Extent { scalar, longest: cells.length };
    if !integrator.has_table_of_lengths() || cells.ids.is_empty() {
        return full;
    }
    let grid = &cells.volume.grid;
    let longest = |&cell: &u32| longest_edge_squared(grid.corners(cell as usize));
    let longest = cells.ids.par_iter().map(longest).reduce(|| 0.0, f64::max).sqrt();
    Extent { longest, ..full }
}
