//! The closed forms; where widgets overlap, the ordered integral or Kniss's mix.

use super::SegmentIntegrator;
use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// The closed forms.
#[derive(Debug, Clone)]
pub struct Analytic {
    prepared: CompiledTransferFunction,
    overlap: WidgetBlend,
}

impl Analytic {
    /// Serves every transfer function.
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend) -> Result<Self> {
        Ok(Analytic { prepared: CompiledTransferFunction::new(transfer_function)?, overlap })
    }
}

impl SegmentIntegrator for Analytic {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.prepared.integrate(segment, self.overlap)
    }
}
