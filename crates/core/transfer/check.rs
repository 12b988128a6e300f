//! Checks of single numbers.

use crate::{Error, Result};

/// Every one of the values is finite.
pub(super) fn finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(v) => Err(Error::usage(format!("{what} is not finite")).got(v).expected("finite numbers")),
    }
}

/// 0 ≤ value < ∞.
pub(super) fn not_negative(what: &str, value: f64) -> Result<()> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is negative or not finite")).got(value).expected("a number ≥ 0"))
}

/// 0 < value < ∞.
pub(super) fn positive(what: &str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is not positive")).got(value).expected("a number > 0"))
}
