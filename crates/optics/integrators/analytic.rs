//! The closed forms; where widgets overlap, the ordered integral or Kniss's mix.

use super::{Extent, Integrator, IntegratorKind, SegmentIntegrator};
use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::TransferFunction;

/// The closed forms.
#[derive(Debug, Clone)]
pub struct Analytic {
    prepared: CompiledTransferFunction,
    overlap: WidgetBlend,
}

impl Analytic {
    /// Closed forms of a transfer function.
    ///
    /// Errors: a number out of range.
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend) -> Result<Self> {
        Ok(Analytic { prepared: CompiledTransferFunction::new(transfer_function)?, overlap })
    }
}

impl Integrator {
    /// Closed forms; quadrature with closed-form optical depth where widgets overlap.
    pub const ANALYTIC: Integrator = Integrator::with_settings(&AnalyticKind, []);
}

/// The kind `analytic`.
pub(super) struct AnalyticKind;

impl IntegratorKind for AnalyticKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "analytic",
            summary: "closed forms; quadrature with closed-form optical depth where widgets overlap",
            parameters: &[],
        }
    }

    fn compile(
        &self,
        _: &Integrator,
        blend: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Analytic::new(transfer_function, blend)?))
    }
}

impl SegmentIntegrator for Analytic {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.prepared.integrate(segment, self.overlap)
    }
}
