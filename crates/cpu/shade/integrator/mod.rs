//! Integrators in vector lanes from outside: the traits that a kernel implements, and the segments that it integrates.

mod sampler;
mod scene;

pub use crate::shade::kernel::SegmentBatch;
pub use crate::shade::kinds::{LaneWidget, RegionPath};
pub use crate::shade::region::ValueRange;
pub use crate::shade::segment_lanes::{FieldLanes, SegmentLanes};
pub use crate::shade::shaded_batch::FallbackReason;
pub use crate::tolerances::NEGLIGIBLE_DEPTH;
pub use sampler::{SIDE_BY_SIDE, SampledSegments, Samples, WidgetSampler};
pub use scene::{FieldAxis, LaneScene, SegmentResults};

use voltet_core::Result;
use voltet_optics::integrators::Integrator;
use voltet_simd::{Kernel, LaneSet, Lanes, dispatch};

/// The extension by which a kind of integrators has kernels
/// ([`voltet_optics::integrators::IntegratorKind::extensions`]).
pub struct LaneExtension(pub &'static dyn LaneIntegratorKind);

/// A kind of integrators with kernels in lanes. Without one, the engine integrates every segment in 64 bits.
pub trait LaneIntegratorKind: Send + Sync {
    /// The kernel for a scene, or the reason why 64 bits integrate all its segments.
    ///
    /// Errors: data that the integrator cannot draw.
    fn prepare(
        &self,
        integrator: &Integrator,
        scene: &LaneScene<'_>,
    ) -> Result<std::result::Result<Box<dyn LaneIntegrator>, FallbackReason>>;

    /// True if the kernels leave no segment to 64 bits, so that nothing is prepared for those.
    fn integrates_all(&self) -> bool {
        false
    }
}

/// True if kernels integrate every segment, so that nothing is prepared for 64 bits.
pub(crate) fn in_lanes_alone(integrator: &Integrator) -> bool {
    integrator.extension::<LaneExtension>().is_some_and(|LaneExtension(kind)| kind.integrates_all())
}

/// A kernel: one generic function over lanes. Every kernel is a [`LaneIntegrator`].
pub trait LaneKernel: Send + Sync {
    /// Integrates the segments of a batch. Mark the implementation `#[inline(always)]`.
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>);

    /// Bytes of the tables that the kernel made.
    fn table_bytes(&self) -> usize {
        0
    }
}

/// A kernel for every lane set, compiled in the crate that defines it.
pub trait LaneIntegrator: Send + Sync {
    /// Integrates the segments of a batch on a lane set.
    fn run(&self, lanes: LaneSet, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>);

    /// Bytes of the tables that the kernel made.
    fn table_bytes(&self) -> usize;
}

impl<K: LaneKernel> LaneIntegrator for K {
    fn run(&self, lanes: LaneSet, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        dispatch(lanes, BatchRun { kernel: self, batch, results });
    }

    fn table_bytes(&self) -> usize {
        LaneKernel::table_bytes(self)
    }
}

struct BatchRun<'a, 'b, K> {
    kernel: &'a K,
    batch: SegmentBatch<'a>,
    results: &'a mut SegmentResults<'b>,
}

impl<K: LaneKernel> Kernel for BatchRun<'_, '_, K> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.kernel.integrate::<L>(self.batch, self.results);
    }
}
