//! Integrators that sample or look up, for studies: each a file with its kind, its 64-bit form, its kernel in vector lanes and its shader
//! text. Kernels take the same batches, the same reach of widgets and the same 32 bits as the closed forms, so that their times compare
//! methods.
//!
//! | integrator | method |
//! | --- | --- |
//! | [`Segments`] | N pieces of linear colour and extinction, by the partial pre-integration table |
//! | [`Riemann`] | N point samples, each with its own absorption |
//! | [`PreIntegrated`] | a table over (s_f, s_b, D), or the same as two-dimensional tiles |
//! | [`VertexSampled`] | classified at the grid's points, linear between them |
//! | [`Tabulated`] | Gaussians' integrals from tables |

#![allow(missing_docs, reason = "unpublished: names say what fields and short functions are")]
#![expect(
    clippy::needless_range_loop,
    reason = "adapters of iterators are functions where a build inlines little"
)]

mod pre_integrated;
mod ramp;
mod riemann;
mod segments;
mod settings;
mod square;
mod tabulated;
mod vertex_sampled;

pub use pre_integrated::{
    PreIntegrated, from_cylinder, pre_integrated, pre_integrated_cylindrical, to_cylinder,
};
pub use ramp::{Material, Ramp, last_tile};
pub use riemann::{Riemann, riemann};
pub use segments::{PartialTable, Segments, segments};
pub use settings::{
    DEFAULT_OVERSAMPLING, DEFAULT_PIECES, DEFAULT_PLANES, DEFAULT_SIDE, MAX_OVERSAMPLING, MAX_PARTIAL_SIDE,
    MAX_PLANES, MAX_TABLE_SIDE, WGSL_PIECES,
};
pub use tabulated::{GaussianTables, LIT_REACH, MAX_P, REACH, Tabulated, tabulated};
pub use vertex_sampled::{CLASSIFIED, ClassifiedPoints, VERTEX_SAMPLED, VertexSampled, classified};

use voltet_core::Result;
use voltet_graph::Registry;
use voltet_optics::integrators::{INTEGRATOR, IntegratorKind, variant};

/// All kinds, in the order in which studies list them.
pub static KINDS: [&dyn IntegratorKind; 6] = [
    &segments::SegmentsKind,
    &riemann::RiemannKind,
    &pre_integrated::TABLE,
    &pre_integrated::TILES,
    &vertex_sampled::VertexSampledKind,
    &tabulated::TabulatedKind,
];

/// Adds all kinds to a registry.
///
/// Errors: names that are taken.
pub fn register(registry: &mut Registry) -> Result<()> {
    KINDS.into_iter().try_for_each(|kind| registry.add_variant(INTEGRATOR, variant(kind)?))
}
