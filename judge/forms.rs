//! The sets of formulas that can be judged.

use super::bounds::Precision;
use super::case::SegmentCase;
use voltet_core::Result;
use voltet_core::optics::{Contribution, Overlap, Prepared, Segment, compositing, linear};
use voltet_core::transfer::TransferFunction;

/// A composited chain of segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// C.
    pub color: [f64; 3],
    /// A.
    pub opacity: f64,
    /// 1 − A, with its own relative accuracy; `None` where the forms leave off before they know it.
    pub transparency: Option<f64>,
}

/// The integrals of a stretch of linear extinction (module `linear`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartialIntegrals {
    /// ψ.
    pub psi: f64,
    /// F.
    pub front: f64,
    /// B.
    pub back: f64,
    /// ζ.
    pub zeta: f64,
}

/// How a set of forms answers a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer<T = Contribution> {
    /// In its own precision.
    Served(T),
    /// In a wider precision, as the engine does where its own cannot; with the reason.
    Wider(T, &'static str),
    /// Not at all; with the reason.
    Skipped(&'static str),
}

/// A set of formulas.
pub trait Forms {
    /// Name for reports.
    fn name(&self) -> &str;

    /// The precision that its bounds are stated in.
    fn precision(&self) -> Precision;

    /// Which condition numbers of a case its bounds are stated with: those of differences, unless the forms round raw
    /// numbers.
    fn condition(&self, case: &SegmentCase) -> [Option<f64>; 3] {
        case.condition
    }

    /// One segment.
    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: Overlap,
    ) -> Result<Answer>;

    /// A chain, front to back.
    fn chain(&self, segments: &[Contribution]) -> Chain;

    /// ψ, F, B, ζ.
    fn partial(&self, a: f64, b: f64) -> Result<Answer<PartialIntegrals>>;
}

/// The 64-bit forms.
#[derive(Debug, Clone, Copy, Default)]
pub struct Native64;

impl Forms for Native64 {
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
        overlap: Overlap,
    ) -> Result<Answer> {
        Ok(Answer::Served(Prepared::new(transfer_function)?.integrate(segment, overlap)))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let mut composite = compositing::Composite::default();
        for segment in segments {
            composite.add(segment.color, segment.opacity);
        }
        let transparency = Some(composite.transparency());
        Chain { color: composite.color, opacity: composite.opacity(), transparency }
    }

    fn partial(&self, a: f64, b: f64) -> Result<Answer<PartialIntegrals>> {
        let (front, back) = linear::front_back(a, b);
        let (psi, zeta) = (linear::psi(a, b), linear::zeta(a, b));
        Ok(Answer::Served(PartialIntegrals { psi, front, back, zeta }))
    }
}
