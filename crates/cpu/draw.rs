//! The stages end to end: project, composite, and the one-call form.

use crate::attribute::{Attribute, attributes_of, gradient_attributes};
use crate::cast::Limits;
use crate::cells::{Casting, Cells, Counts};
use crate::integrator::in_lanes_alone;
use crate::memory::drawing_bytes_of;
use crate::ready::Ready;
use crate::sample::Sample;
use crate::shade::light::Surface;
use crate::shade::shader::{Scene, Shader};
use rayon::prelude::*;
use voltet_core::camera::Camera;
use voltet_core::grid::extent::longest_edge_squared;
use voltet_core::picture::Picture;
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::integrators::{self, Extent, SegmentIntegrator};
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};

/// Cells prepared for the compositor: one projection for each sample of a pixel. Of more cells than are projected at once
/// ([`Cells::most_at_once`]) it holds which part of the picture each touches; the compositor projects them part by part.
#[derive(Debug)]
pub struct Projection {
    pub(crate) cells: Cells,
    pub(crate) camera: Camera,
    /// Of the first samples of a pixel, at least one; further ones are made when they are composited.
    pub(crate) samples: Vec<Sample>,
    /// See [`densest`].
    pub(crate) densest: f64,
    pub(crate) limits: Limits,
}

impl Projection {
    /// The volume's cells that were projected, and their order.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Cells that cover a pixel centre (of the first sample). `None` where none is projected, since rays go from cell to cell.
    pub fn cells_projected(&self) -> Option<u64> {
        self.samples.first().map_or(Some(0), Sample::cell_count)
    }

    /// Projects the cells for one more sample of every pixel. `attributes`: at least those that the first was projected with.
    pub(crate) fn sample(
        &self,
        offset: [f64; 2],
        attributes: &[Attribute<'_>],
        progress: &dyn Progress,
    ) -> Result<Sample> {
        let count = self.samples.first().map_or(attributes.len(), |first| first.attribute_count);
        let limits = (self.densest, self.limits);
        Sample::new(&self.cells, &self.camera, offset, &attributes[..count], limits, progress)
    }
}

/// Projects the kept cells onto the screen and sorts them into tiles of 16 × 16 pixels.
///
/// The transfer function says which quantities the segments need: what it does not look at is not projected.
/// `gradient`: whether light or silhouettes will look at ∇s ([`needs_gradient`]).
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
    let (kept, points) = (cells.kept.len() as u64, cells.volume.grid.points.len() as u64);
    // Each sample of a pixel has a projection of its own.
    let held = (cells.most_at_once / cells.kept.len().max(1)).clamp(1, offsets.len());
    let bytes = |faces: Option<u64>| {
        let fields = attributes.len() as u64;
        let bytes = drawing_bytes_of(kept, points, fields, camera.size, cells.most_at_once, faces);
        bytes.saturating_mul(held as u64)
    };
    // Where there is no room for faces, cells are projected.
    let there_is_room = || match progress.memory_left() {
        None => true,
        Some(left) => cells.faces.as_ref().is_some_and(|faces| bytes(Some(faces.bytes_to_find())) <= left),
    };
    let casting = if there_is_room() { cells.casting } else { Casting::Never };
    let cells = &Cells { casting, ..cells.clone() };
    if casting == Casting::Never {
        refuse_beyond_memory(progress, || format!("drawing {kept} cells"), bytes(None))?;
    }
    let densest = densest(transfer_function, cells.length).max(cells.densest_least);
    let limits = Limits::of(transfer_function, densest);
    let mut samples = Vec::with_capacity(held);
    for (k, &offset) in offsets.iter().take(held).enumerate() {
        progress.report("project", k as f64 / held as f64);
        samples.push(Sample::new(cells, camera, offset, &attributes, (densest, limits), progress)?);
    }
    Ok(Projection { cells: cells.clone(), camera: *camera, samples, densest, limits })
}

/// The largest optical depth, or colour, that all widgets together give over a scene length of so many world units.
pub(crate) fn densest(transfer_function: &TransferFunction, length: f64) -> f64 {
    let most = |widget: &Widget| match transfer_function.model {
        OpticalModel::DensityEmitter => widget.peak() * widget.brightest().max(1.0),
        OpticalModel::ConstantEmitter { .. } => widget.peak().max(widget.brightest()),
    };
    transfer_function.widgets.iter().map(most).sum::<f64>() / transfer_function.unit_distance * length
}

/// Gives the cells the order in which the compositor shall take a pixel's segments. The exact order is carried out
/// at each pixel; [`Order::Centroid`] sorts the cells here ([`voltet_core::visibility::centroid_order`]), and their
/// segments are composited as they come.
pub fn sort(cells: &Cells, camera: &Camera, order: VisibilityOrder) -> Result<Cells> {
    let mut sorted = Cells { order, ..cells.clone() };
    if order == VisibilityOrder::Centroid {
        let grid = &cells.volume.grid;
        let kept =
            voltet_core::visibility::centroid_order(&grid.points, &grid.tetrahedra, &cells.kept, camera)?;
        sorted.kept = std::sync::Arc::new(kept);
    }
    Ok(sorted)
}

/// Makes ready what [`Ready::composite`] draws with.
///
/// Errors: an optical model, widget or integrator that the engine cannot serve, named with what can.
pub fn prepare<'a>(
    projection: &'a Projection,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> Result<Ready<'a>> {
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
    integrators::can_serve(&shading.integrator, transfer_function)?;
    let touched = cells.touched(transfer_function);
    let extent = extent(cells, &shading.integrator);
    // Lanes leave over no segment of a table over lengths: it is filled once, by them.
    let by_lanes = in_lanes_alone(&shading.integrator);
    let exact = if by_lanes { None } else { Some(integrator(cells, &touched, shading)?) };
    let whole = cells.no_leave_out;
    let scene = Scene {
        attributes: &attributes,
        length: cells.length,
        ordered: whole,
        leave_out: !whole,
        extent,
        lanes: cells.lanes,
    };
    let shader = Shader::new(&touched, shading, exact, scene, surface)?;
    let table_bytes = shader.table_bytes() as u64;
    Ok(Ready { projection, attributes, shader, table_bytes })
}

/// Integrates and composites every pixel's segments: [`prepare`] and [`Ready::composite`].
///
/// Errors: an optical model, widget or integrator that the engine cannot serve, named with what can.
pub fn composite(
    projection: &Projection,
    transfer_function: &TransferFunction,
    shading: &Shading,
    progress: &dyn Progress,
) -> Result<(Picture, Counts)> {
    prepare(projection, transfer_function, shading)?.composite(progress)
}

/// Whether light or silhouettes look at ∇s. A silhouette of exponent 0 changes nothing.
pub fn needs_gradient(shading: &Shading) -> bool {
    Surface::new(shading, 0).is_some()
}

/// Draws the kept cells: [`project`] and [`composite`].
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

/// The integrator in 64 bits, as [`prepare`] makes it ready: what draws the segments that lanes do not.
///
/// Errors: an integrator that cannot serve the transfer function; one with a number out of range; an integrator that
/// prepares scenes, where this one is not prepared.
pub fn integrator(
    cells: &Cells,
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
    let extent = extent(cells, &shading.integrator);
    integrators::new(&shading.integrator, shading.overlap, transfer_function, &extent)
}

/// What the segments span, as far as the integrator has tables to fill: no segment inside a cell is longer than its
/// longest edge.
fn extent(cells: &Cells, integrator: &Integrator) -> Extent {
    let whole = Extent { scalar: cells.ranges[0], longest: cells.length };
    if !integrator.has_table_of_lengths() || cells.kept.is_empty() {
        return whole;
    }
    let grid = &cells.volume.grid;
    let longest = |&cell: &u32| longest_edge_squared(grid.corners(cell as usize));
    let longest = cells.kept.par_iter().map(longest).reduce(|| 0.0, f64::max).sqrt();
    Extent { longest, ..whole }
}
