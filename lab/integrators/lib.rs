//! Integrators that sample or look up, for studies.
//!
//! | integrator | method |
//! | --- | --- |
//! | [`Segments`] | N pieces of linear colour and extinction, by the partial pre-integration table |
//! | [`Riemann`] | N point samples, each with its own absorption |
//! | [`PreIntegrated`] | a table over (s_f, s_b, D) |
//! | [`PreIntegratedCylindrical`] | the same table as two-dimensional tiles |
//! | [`VertexSampled`] | classified at the grid's points, linear between them |
//! | [`Tabulated`] | Gaussians' integrals from tables |

mod gaussian_tables;
mod kinds;
mod lanes;
mod partial_table;
mod pre_integrated;
mod pre_integrated_cylindrical;
mod riemann;
mod segments;
mod settings;
mod shader;
mod slice;
mod tabulated;
#[cfg(test)]
#[path = "tests_64/mod.rs"]
mod tests;
mod vertex_sampled;

pub use gaussian_tables::{GaussianTables, LIT_REACH, MAX_P, REACH};
pub use kinds::{
    KINDS, VERTEX_SAMPLED, pre_integrated, pre_integrated_cylindrical, riemann, segments, tabulated,
};
pub use partial_table::PartialTable;
pub use pre_integrated::PreIntegrated;
pub use pre_integrated_cylindrical::{PreIntegratedCylindrical, from_cylinder, last_tile};
pub use riemann::Riemann;
pub use segments::Segments;
pub use settings::{
    DEFAULT_OVERSAMPLING, DEFAULT_PIECES, DEFAULT_PLANES, DEFAULT_SIDE, MAX_OVERSAMPLING, MAX_PARTIAL_SIDE,
    MAX_PLANES, MAX_TABLE_SIDE,
};
pub use shader::PIECES;
pub use slice::{Material, Ramp};
pub use tabulated::Tabulated;
pub use vertex_sampled::{CLASSIFIED, ClassifiedPoints, VertexSampled, classified, is_classified};

use voltet_core::Result;
use voltet_graph::Registry;
use voltet_optics::integrators::{INTEGRATOR, variant};

/// Adds all kinds to a registry.
///
/// Errors: names that are taken.
pub fn register(registry: &mut Registry) -> Result<()> {
    KINDS.into_iter().try_for_each(|kind| registry.add_variant(INTEGRATOR, variant(kind)?))
}
