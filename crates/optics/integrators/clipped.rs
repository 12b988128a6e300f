//! A piecewise-linear function cut at its control points: each piece is linear, so nothing is sampled
//! (Moreland 2004). The pieces are those of module `piecewise_linear`.

use super::{Integrator, SegmentIntegrator, can_serve};
use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// A piecewise-linear function cut at its control points.
#[derive(Debug, Clone)]
pub struct Clipped(CompiledTransferFunction);

impl Clipped {
    /// Serves one piecewise-linear widget, with or without a region.
    pub fn new(transfer_function: &TransferFunction) -> Result<Self> {
        can_serve(&Integrator::Clipped, transfer_function)?;
        Ok(Clipped(CompiledTransferFunction::new(transfer_function)?))
    }
}

impl SegmentIntegrator for Clipped {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.0.integrate(segment, WidgetBlend::Exact)
    }
}
