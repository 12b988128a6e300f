//! voltet-reference: adaptive quadrature of ray segments in 64 bits, slow and simple, sharing no formula with the engines or with
//! `optics`, so that the engines can be compared with it.
//!
//! The meaning of a picture stands in the book's page on optics, which this crate follows as directly as it can. [`draw`] makes a picture,
//! [`tracer`] traces single rays, and [`integrate`] integrates single segments. The integrator of a scene is ignored: it is always
//! quadrature, to 1e-11 of each segment.

#![allow(missing_docs, reason = "unpublished: names say what fields and short functions are")]

mod curved_axes;
mod features;
mod linear_on_segment;
mod part;
mod renderer;
mod segment;
mod term;

pub use curved_axes::CurvedQuadrature;
pub use renderer::{ENGINE, Reference, draw, draw_further, tracer};
pub use segment::{Integrand, PICTURE_TOLERANCE, SEGMENT_TOLERANCE, Workspace};

use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_graph::Registry;
use voltet_optics::integrators::{INTEGRATOR, Integrator, variant};
use voltet_optics::trace::CellCrossing;
use voltet_optics::{Contribution, Segment, WidgetBlend};

pub const REFERENCE: Integrator = Integrator::with_settings(&renderer::ReferenceKind, []);

/// Adds the integrator `reference` to a registry.
///
/// # Errors
///
/// - A name that is taken.
pub fn register(registry: &mut Registry) -> Result<()> {
    registry.add_variant(INTEGRATOR, variant(REFERENCE.kind())?)
}

/// Integral of one segment, to a relative 1e-11 of each of its stretches.
pub fn integrate(
    segment: &Segment,
    transfer_function: &TransferFunction,
    overlap: WidgetBlend,
) -> Result<Contribution> {
    let integrand = Integrand::new(transfer_function, overlap, SEGMENT_TOLERANCE)?;
    let values = |ends: [f64; 2], fields: &[f64]| [&ends, fields].concat();
    let front = values(segment.front, segment.fields_front);
    let back = values(segment.back, segment.fields_back);
    integrand.integrate(segment.length, &front, &back, &mut Workspace::default())
}

/// Optical depth of each widget by itself in the cells of a ray. Errors: what cannot be integrated.
pub fn widget_depths(transfer_function: &TransferFunction, cells: &[CellCrossing]) -> Result<Vec<Vec<f64>>> {
    if transfer_function.has_curved_axes() {
        return curved_axes::widget_depths(transfer_function, cells);
    }
    let alone = Integrand::new(transfer_function, WidgetBlend::Mix, PICTURE_TOLERANCE)?;
    let mut work = Workspace::default();
    let depths = |cell: &CellCrossing| {
        let depths = alone.widget_depths(cell.length, &cell.front, &cell.back, &mut work);
        depths.map_err(|error| error.at_item(format!("cell {}", cell.cell)))
    };
    cells.iter().map(depths).collect()
}
