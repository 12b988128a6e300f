//! Segment formulas of the GPU engine, for the judge.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_gpu::Device;
use voltet_judge::{
    Chain, Condition, Conditions, EvalOutcome, PartialIntegrals, Precision, SegmentEvaluator,
};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_shaders::segment_list::origin;

/// Composed shaders of a device. A device that fails on the way gives no numbers, which no bound allows.
pub struct WgslEvaluator {
    device: Arc<Device>,
    name: String,
}

impl WgslEvaluator {
    pub fn new(device: Arc<Device>) -> WgslEvaluator {
        let name = format!("WGSL on {}", device.name);
        WgslEvaluator { device, name }
    }
}

impl SegmentEvaluator for WgslEvaluator {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        Precision::Wgsl
    }

    /// Values are stored about one origin, or else as 32-bit numbers that all widgets share. Where rounding those leaves no digit
    /// of T, no linear condition number bounds C and A.
    fn condition(&self, transfer_function: &TransferFunction, of: &Conditions) -> Condition {
        match (origin(&transfer_function.widgets), of.values_keep_digits()) {
            (Some(_), _) => of.differences,
            (None, true) => of.values,
            (None, false) => [None; 3],
        }
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome> {
        let contribution = self.device.integrate_segment(transfer_function, segment, overlap)?;
        Ok(contribution.map_or_else(EvalOutcome::Skipped, EvalOutcome::Served))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let values = self.device.composite_chain(segments);
        let [red, green, blue, _, transparency, opacity] = values.unwrap_or([f64::NAN; 6]);
        Chain { color: [red, green, blue], opacity, transparency: Some(transparency) }
    }

    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
        let [psi, front, back, zeta] = self.device.partial_integrals(a, b)?;
        Ok(EvalOutcome::Served(PartialIntegrals { psi, front, back, zeta }))
    }
}
