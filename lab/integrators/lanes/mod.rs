//! Kernels in vector lanes: the same batches, the same reach of widgets and the same 32 bits as the closed forms, so that their times
//! compare methods.
//!
//! | file | content |
//! | --- | --- |
//! | `riemann` | `riemann` |
//! | `segments` | `segments` |
//! | `pre_integrated` | `pre-integrated`, `pre-integrated-cylindrical` |
//! | `tabulated` | `tabulated` |
//! | `vertex_sampled` | `vertex-sampled` |
//! | `partial_table`, `gaussian_table`, `slices`, `square` | tables in lanes |

#![expect(
    clippy::needless_range_loop,
    reason = "adapters of iterators are functions where a build inlines little"
)]

mod gaussian_table;
mod partial_table;
mod pre_integrated;
mod riemann;
mod segments;
mod slices;
mod square;
mod tabulated;
mod vertex_sampled;

use crate::settings::{OVERSAMPLING, PIECES, PLANES, SIDE, count};
use crate::{GaussianTables, PartialTable};
use partial_table::LanePartialTable;
use pre_integrated::Table;
use riemann::Riemann;
use segments::Pieces;
use tabulated::Tabulated;
use vertex_sampled::VertexSampled;
use voltet_core::Result;
use voltet_cpu::integrator::{
    FallbackReason, LaneIntegrator, LaneIntegratorKind, LaneKernel, LaneScene, WidgetSampler,
};
use voltet_optics::integrators::{Integrator, SegmentIntegrator};

/// A kernel, or the reason why there is none.
type Prepared = std::result::Result<Box<dyn LaneIntegrator>, FallbackReason>;

/// A kernel as the engine takes it.
fn boxed(kernel: impl LaneKernel + 'static) -> Box<dyn LaneIntegrator> {
    Box::new(kernel)
}

/// Kernels of `riemann`.
pub(crate) struct RiemannLanes;

impl LaneIntegratorKind for RiemannLanes {
    fn prepare(&self, integrator: &Integrator, scene: &LaneScene<'_>) -> Result<Prepared> {
        let count = count(integrator, PIECES);
        Ok(WidgetSampler::new(count, false, scene).map(|sampler| match count {
            1 => boxed(Riemann::<1>(sampler)),
            2 => boxed(Riemann::<2>(sampler)),
            _ => boxed(Riemann::<0>(sampler)),
        }))
    }
}

/// The table of the integrator in 64 bits.
fn shared_table<'a, T: 'static>(scene: &LaneScene<'a>) -> std::result::Result<&'a T, FallbackReason> {
    let table = scene.exact.and_then(SegmentIntegrator::table);
    table.and_then(|table| table.downcast_ref()).ok_or(FallbackReason::Integrator)
}

/// Kernels of `segments`.
pub(crate) struct SegmentsLanes;

impl LaneIntegratorKind for SegmentsLanes {
    fn prepare(&self, integrator: &Integrator, scene: &LaneScene<'_>) -> Result<Prepared> {
        let table = shared_table::<PartialTable>(scene).map(LanePartialTable::new);
        Ok(table.and_then(|table| {
            let ends = WidgetSampler::new(count(integrator, PIECES), true, scene)?;
            Ok(boxed(Pieces { ends, table }))
        }))
    }
}

/// Kernels of `pre-integrated`.
pub(crate) struct PreIntegratedLanes;

impl LaneIntegratorKind for PreIntegratedLanes {
    fn prepare(&self, integrator: &Integrator, scene: &LaneScene<'_>) -> Result<Prepared> {
        let (side, oversampling) = (count(integrator, SIDE), count(integrator, OVERSAMPLING));
        Ok(Ok(boxed(Table::new(side, oversampling, integrator.count(PLANES), scene)?)))
    }

    fn integrates_all(&self) -> bool {
        true
    }
}

/// Kernels of `tabulated`.
pub(crate) struct TabulatedLanes;

impl LaneIntegratorKind for TabulatedLanes {
    fn prepare(&self, _: &Integrator, scene: &LaneScene<'_>) -> Result<Prepared> {
        let tables = shared_table::<GaussianTables>(scene);
        Ok(tables.and_then(|tables| Tabulated::new(tables, scene)).map(boxed))
    }
}

/// Kernels of `vertex-sampled`.
pub(crate) struct VertexSampledLanes;

impl LaneIntegratorKind for VertexSampledLanes {
    fn prepare(&self, _: &Integrator, scene: &LaneScene<'_>) -> Result<Prepared> {
        Ok(VertexSampled::new(scene).map(boxed))
    }
}
