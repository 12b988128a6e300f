//! The 64-bit formulas as a set of forms: the truth of which engines have twins.

use crate::{Chain, EvalOutcome, PartialIntegrals, Precision, SegmentEvaluator};
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend, compositing, linear};

/// The 64-bit forms.
#[derive(Debug, Clone, Copy, Default)]
pub struct Evaluator64;

impl SegmentEvaluator for Evaluator64 {
    fn name(&self) -> &str {
        "64-bit"
    }

    fn precision(&self) -> Precision {
        Precision::F64
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome> {
        Ok(EvalOutcome::Served(CompiledTransferFunction::new(transfer_function)?.integrate(segment, overlap)))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let mut composite = compositing::Composite::default();
        for segment in segments {
            composite.add(segment.color, segment.opacity);
        }
        let transparency = Some(composite.transparency());
        Chain { color: composite.color, opacity: composite.opacity(), transparency }
    }

    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
        let (front, back) = linear::front_back(a, b);
        let (psi, zeta) = (linear::psi(a, b), linear::zeta(a, b));
        Ok(EvalOutcome::Served(PartialIntegrals { psi, front, back, zeta }))
    }
}
