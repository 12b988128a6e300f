//! What a transfer function must fulfil before anything is drawn with it.

use super::{OpticalModel, TransferFunction, Widget};
use crate::{Error, Result};

impl TransferFunction {
    /// Checks every number.
    pub fn check(&self) -> Result<()> {
        let u = self.unit_distance;
        if !(u > 0.0 && u.is_finite()) {
            return Err(Error::usage("the unit distance is not a length").found(u).accepted("a number > 0"));
        }
        if let OpticalModel::ConstantEmitter { cutoff } = self.model
            && !(0.0..1.0).contains(&cutoff)
        {
            return Err(Error::usage("the cutoff is out of range").found(cutoff).accepted("0 ≤ cutoff < 1"));
        }
        for (i, widget) in self.widgets.iter().enumerate() {
            check(widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
        }
        Ok(())
    }
}

fn check(widget: &Widget) -> Result<()> {
    not_negative("the extinction", widget.extinction)?;
    for c in widget.color {
        not_negative("a colour component", c)?;
    }
    widget.profile.check()?;
    let properties = widget.profile.properties();
    if properties.needs_region && widget.region.is_none() {
        let what = format!("a {} widget has no region", properties.name);
        return Err(Error::usage(what).accepted("a region"));
    }
    Ok(())
}

/// Every one of the values is finite.
pub(super) fn finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(v) => Err(Error::usage(format!("{what} is not finite")).found(v).accepted("finite numbers")),
    }
}

/// 0 ≤ value < ∞.
pub(super) fn not_negative(what: &str, value: f64) -> Result<()> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is negative or not finite")).found(value).accepted("a number ≥ 0"))
}

/// 0 < value < ∞.
pub(super) fn positive(what: &str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is not positive")).found(value).accepted("a number > 0"))
}
