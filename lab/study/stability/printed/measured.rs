//! One printed formula, and how its errors are measured.

use super::real::Real;
use serde::Serialize;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_introspect::MeasuredEngine;
use voltet_judge::Evaluator64;
use voltet_judge::{EvalOutcome, PartialIntegrals, SegmentEvaluator};
use voltet_nodes::drawing::NATIVE;
use voltet_optics::engine::AdapterRequest;
use voltet_optics::{Contribution, Segment, WidgetBlend};

/// One printed formula and what was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PrintedFormula {
    /// Paper and equation.
    pub source: &'static str,
    /// The formula, in plain text.
    pub formula: &'static str,
    /// Failure and its cause.
    pub fails: &'static str,
    /// Replacement.
    pub instead: &'static str,
    /// At some inputs.
    pub rows: Vec<FormulaRow>,
}

/// Errors at one input; not finite where the formula gives no number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormulaRow {
    /// The input.
    pub inputs: String,
    /// The printed formula in 64 bits.
    pub printed_64: f64,
    /// The printed formula in 32 bits.
    pub printed_32: f64,
    /// Error of the replacement in 32 bits; `None` where that is 64-bit alone.
    pub ours_32: Option<f64>,
}

/// |found − exact| / |exact|; ∞ where the formula gives no number.
pub(super) fn error(found: impl Real, exact: f64) -> f64 {
    let found = found.wide();
    if found.is_finite() { (found - exact).abs() / exact.abs() } else { f64::INFINITY }
}

/// Formulas of the CPU engine on this processor.
pub(super) fn ours() -> Result<Box<dyn SegmentEvaluator>> {
    let forms = NATIVE.open(&AdapterRequest::default())?.evaluator();
    forms.ok_or_else(|| Error::run("the engine has no forms of segments").got(NATIVE.name))
}

/// The segment in 64 bits, and in the lanes of the native engine.
pub(super) fn segment(
    transfer_function: &TransferFunction,
    segment: &Segment,
) -> Result<[Option<Contribution>; 2]> {
    let found = |forms: &dyn SegmentEvaluator| -> Result<Option<Contribution>> {
        Ok(match forms.segment(transfer_function, segment, WidgetBlend::Exact)? {
            EvalOutcome::Served(found) => Some(found),
            EvalOutcome::Wider(..) | EvalOutcome::Skipped(_) => None,
        })
    };
    Ok([found(&Evaluator64)?, found(ours()?.as_ref())?])
}

/// A number of linear extinction in 64 bits, and in the lanes of the native engine.
pub(super) fn partial(
    a: f64,
    b: f64,
    number: impl Fn(&PartialIntegrals) -> f64,
) -> Result<(f64, Option<f64>)> {
    let found = |forms: &dyn SegmentEvaluator| -> Result<Option<f64>> {
        Ok(match forms.partial(a, b)? {
            EvalOutcome::Served(found) => Some(number(&found)),
            EvalOutcome::Wider(..) | EvalOutcome::Skipped(_) => None,
        })
    };
    Ok((found(&Evaluator64)?.unwrap_or(f64::NAN), found(ours()?.as_ref())?))
}

/// A segment from one pair (s, g) to another.
pub(super) fn between(front: [f64; 2], back: [f64; 2], length: f64) -> Segment<'static> {
    Segment { length, front, back, fields_front: &[], fields_back: &[] }
}
