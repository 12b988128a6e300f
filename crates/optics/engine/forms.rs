//! What an engine makes of ray segments alone, apart from any picture: what exact values judge.

use crate::{Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// A set of formulas.
pub trait SegmentEvaluator {
    /// Name for reports.
    fn name(&self) -> &str;

    /// The precision that its bounds are stated in.
    fn precision(&self) -> Precision;

    /// Which condition numbers of T, C and A its bounds are stated with: those of differences, unless the forms round raw
    /// numbers.
    fn condition(&self, _transfer_function: &TransferFunction, of: &Conditions) -> Condition {
        of.differences
    }

    /// One segment.
    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome>;

    /// A chain, front to back.
    fn chain(&self, segments: &[Contribution]) -> Chain;

    /// ψ, F, B, ζ.
    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>>;
}

/// How a set of forms answers a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EvalOutcome<T = Contribution> {
    /// In its own precision.
    Served(T),
    /// In a wider precision, as the engine does where its own cannot; with the reason.
    Wider(T, &'static str),
    /// Not at all; with the reason.
    Skipped(&'static str),
}

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

/// Condition numbers of T, C and A; `None` where the result is discontinuous.
pub type Condition = [Option<f64>; 3];

/// Condition numbers of a segment, by what of its inputs is rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// The differences from where widgets lie.
    pub differences: Condition,
    /// The raw numbers, the values at both ends.
    pub values: Condition,
}

/// The precision of a set of forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 64-bit.
    F64,
    /// 32-bit, with differences formed in 64 bits.
    F32,
    /// 32-bit on a device: WGSL lets a quotient err by 2.5 and e^x by 3 + 2|x| units in the last place.
    Wgsl,
}

impl Precision {
    /// ε: the spacing of numbers at 1.
    pub fn epsilon(self) -> f64 {
        match self {
            Precision::F64 => f64::EPSILON,
            Precision::F32 | Precision::Wgsl => f64::from(f32::EPSILON),
        }
    }

    /// Absolute floor of T and A: below it numbers leave the normal range.
    pub fn floor(self) -> f64 {
        match self {
            Precision::F64 => 1e-290,
            Precision::F32 | Precision::Wgsl => 1e-30,
        }
    }
}
