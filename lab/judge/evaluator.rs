//! Segment formulas of an engine, apart from any picture: the subject that exact values judge.

use serde::{Deserialize, Deserializer};
use serde_json::Value;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend, compositing, linear};

/// A set of formulas.
pub trait SegmentEvaluator {
    fn name(&self) -> &str;

    fn precision(&self) -> Precision;

    /// Condition numbers of T, C and A that its bounds are stated with: those of differences, unless the formulas round raw
    /// numbers.
    fn condition(&self, _transfer_function: &TransferFunction, of: &Conditions) -> Condition {
        of.differences
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome>;

    fn chain(&self, segments: &[Contribution]) -> Chain;

    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>>;
}

/// Result of an evaluation: in the evaluator's own precision, in a wider one, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EvalOutcome<T = Contribution> {
    /// In its own precision.
    Served(T),
    /// In a wider precision, to which the engine falls back; with the reason.
    Wider(T, &'static str),
    /// None; with the reason.
    Skipped(&'static str),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    pub color: [f64; 3],
    pub opacity: f64,
    /// 1 − A, with its own relative accuracy; `None` where compositing ends before that is known.
    pub transparency: Option<f64>,
}

/// Integrals of a segment of linear extinction (module `linear` of `voltet_optics`).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PartialIntegrals {
    #[serde(deserialize_with = "exact")]
    pub psi: f64,
    #[serde(rename = "F", deserialize_with = "exact")]
    pub front: f64,
    #[serde(rename = "B", deserialize_with = "exact")]
    pub back: f64,
    #[serde(deserialize_with = "exact")]
    pub zeta: f64,
}

/// Result of reading a part of a case.
pub(crate) type Read<'de, T, D> = std::result::Result<T, <D as Deserializer<'de>>::Error>;

/// The number of a decimal string (or a number), ≥ 0, which may be too small for doubles.
pub(crate) fn number<E: serde::de::Error>(value: &Value) -> std::result::Result<f64, E> {
    let number: Option<f64> = value.as_str().map_or_else(|| value.as_f64(), |text| text.parse().ok());
    number
        .filter(|number| *number >= 0.0 && number.is_finite())
        .ok_or_else(|| E::custom(format!("{value} is no exact value: a decimal string of a number ≥ 0")))
}

pub(crate) fn exact<'de, D: Deserializer<'de>>(input: D) -> Read<'de, f64, D> {
    number(&Value::deserialize(input)?)
}

/// Condition numbers of T, C and A; `None` where the result is discontinuous.
pub type Condition = [Option<f64>; 3];

/// Condition numbers of a segment, by what of its inputs is rounded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
pub struct Conditions {
    /// The differences from where widgets lie.
    #[serde(rename = "k", default)]
    pub differences: Condition,
    /// The raw numbers, the values at both ends.
    #[serde(rename = "k_in", default)]
    pub values: Condition,
}

impl Conditions {
    /// True if values that widgets share as 32-bit numbers keep digits of the differences between them; near 1e8 they keep none.
    pub fn values_keep_digits(&self) -> bool {
        let lost = |k: f64| 16.0 * f64::from(f32::EPSILON) * (4.0 + k) > 0.1;
        !self.values[0].is_some_and(lost)
    }
}

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

/// The 64-bit formulas: the truth of which engines have twins.
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
