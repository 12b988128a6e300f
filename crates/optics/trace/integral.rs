//! Integral of a ray segment, as the ray tracer takes it.

use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// Integral of a ray segment. Ends are [s, g, fields …], the fields in the order of [`TransferFunction::fields`].
pub trait SegmentIntegral: Send + Sync {
    /// Contribution of a segment of this length (world units). Errors: what cannot be integrated.
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution>;

    /// Upper bound of a colour channel of a segment of this length (world units).
    fn max_color(&self, _length: f64) -> f64 {
        f64::INFINITY
    }
}

/// Closed forms of the transfer function.
#[derive(Debug)]
pub struct ClosedForms {
    compiled: CompiledTransferFunction,
    blend: WidgetBlend,
}

impl ClosedForms {
    /// Closed forms of a transfer function. Errors: a number out of range.
    pub fn new(transfer_function: &TransferFunction, blend: WidgetBlend) -> Result<ClosedForms> {
        Ok(ClosedForms { compiled: CompiledTransferFunction::new(transfer_function)?, blend })
    }
}

impl SegmentIntegral for ClosedForms {
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution> {
        let segment = Segment {
            length,
            front: [front[0], front[1]],
            back: [back[0], back[1]],
            fields_front: &front[2..],
            fields_back: &back[2..],
        };
        Ok(self.compiled.integrate(&segment, self.blend))
    }
}
