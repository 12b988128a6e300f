//! The integrators of one segment behind one trait (docs/optics.md, section 10).
//!
//! | integrator | what it does |
//! | --- | --- |
//! | [`Analytic`] | closed forms; overlaps in order or mixed |
//! | [`Adaptive`] | closed forms, subdivided until the error is under a tolerance |
//! | [`Segments`] | N pieces of linear colour and extinction, by the partial pre-integration table |
//! | [`Riemann`] | N point samples, each with its own absorption |
//! | [`PreIntegrated`] | a table over (s_f, s_b, D) |
//! | [`PreIntegratedCylindrical`] | the same table as two-dimensional tiles |
//! | [`Clipped`] | a piecewise-linear function cut at its control points |
//! | [`VertexSampled`] | classified at the grid's points, linear between them |
//! | [`Tabulated`] | Gaussians' integrals from tables |

mod adaptive;
mod analytic;
mod choice;
mod clipped;
mod gaussian_tables;
mod partial_table;
mod pre_integrated;
mod pre_integrated_cylindrical;
mod reference;
mod riemann;
mod segment_integrator;
mod segments;
mod slice;
mod tabulated;
#[cfg(test)]
mod tests;
mod vertex_sampled;

pub use adaptive::Adaptive;
pub use analytic::Analytic;
pub use choice::{
    Integrator, Numbers, OVERSAMPLING_MOST, PARTIAL_SIDE_MOST, PLANES_MOST, STANDARD_OVERSAMPLING,
    STANDARD_PIECES, STANDARD_PLANES, STANDARD_SIDE, TABLE_SIDE_MOST, can_serve,
};
pub use clipped::Clipped;
pub use gaussian_tables::{GaussianTables, LIT_REACH, P_MOST, REACH};
pub use partial_table::PartialTable;
pub use pre_integrated::PreIntegrated;
pub use pre_integrated_cylindrical::{PreIntegratedCylindrical, from_cylinder, last_tile};
pub use reference::{ReferenceConstructor, register_reference};
pub use riemann::Riemann;
pub use segment_integrator::{Extent, SegmentIntegrator};
pub use segments::Segments;
pub use slice::{Material, Ramp};
pub use tabulated::Tabulated;
pub use vertex_sampled::{AtPoints, CLASSIFIED, VertexSampled, classified, is_classified};

use super::WidgetBlend;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// The integrator, made ready. `overlap` says what `Analytic` and `Reference` do where widgets overlap; the
/// others take widgets together in their order.
///
/// Errors: [`can_serve`]'s, and a transfer function with a number out of range.
pub fn new(
    integrator: &Integrator,
    overlap: WidgetBlend,
    transfer_function: &TransferFunction,
    extent: &Extent,
) -> Result<Box<dyn SegmentIntegrator>> {
    can_serve(integrator, transfer_function)?;
    Ok(match *integrator {
        Integrator::Analytic => Box::new(Analytic::new(transfer_function, overlap)?),
        Integrator::Adaptive { tolerance } => Box::new(Adaptive::new(transfer_function, tolerance)?),
        Integrator::Segments { count, table_size } => {
            Box::new(Segments::new(transfer_function, count, table_size)?)
        }
        Integrator::Riemann { count } => Box::new(Riemann::new(transfer_function, count)?),
        Integrator::PreIntegrated { table_size, oversampling } => {
            Box::new(PreIntegrated::new(transfer_function, table_size, oversampling, extent)?)
        }
        Integrator::PreIntegratedCylindrical { table_size, oversampling, planes } => Box::new(
            PreIntegratedCylindrical::new(transfer_function, table_size, oversampling, planes, extent)?,
        ),
        Integrator::Clipped => Box::new(Clipped::new(transfer_function)?),
        Integrator::VertexSampled => Box::new(VertexSampled::new(transfer_function)?),
        Integrator::Tabulated { table_size } => Box::new(Tabulated::new(transfer_function, table_size)?),
        Integrator::Reference => reference::reference(transfer_function, overlap)?,
    })
}
