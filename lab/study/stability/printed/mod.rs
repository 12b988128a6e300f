//! The formulas as papers print them, computed as they stand in 32 and in 64 bits, and what stands in their place.
//!
//! Truths are the 64-bit forms of `voltet_optics`, which the cases of the same report judge; their place in 32 bits is
//! what the native engine computes. Errors are relative, unless an entry says otherwise.

mod absorption;
mod colors;
mod measured;
mod real;
mod tables;

pub use measured::{FormulaRow, PrintedFormula};

use voltet_core::Result;

/// Every formula that was looked at.
pub fn printed() -> Result<Vec<PrintedFormula>> {
    let mut all = absorption::entries()?;
    all.extend(colors::entries()?);
    all.extend(tables::entries()?);
    Ok(all)
}
