//! Largest length and value spans of one segment of a data set: what 32 bits must resolve.

use voltet_core::transfer::{TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_simd::limits::MAX_GAUSSIAN_WIDTHS;

/// Largest spans of one segment of a data set; the ranges of the values bound it, tighter numbers refuse less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spans<'a> {
    /// |v_b − v_f| of s, g (also where it is not read) and the further fields by name.
    pub values: &'a [f64],
    /// D, world units.
    pub longest: f64,
}

/// Largest length and value spans of one segment, in the units of the transfer function.
pub(crate) struct SegmentExtent<'a> {
    pub transfer_function: &'a TransferFunction,
    pub spans: &'a Spans<'a>,
    /// True if widgets are walked together, in their order.
    pub is_in_order: bool,
}

impl SegmentExtent<'_> {
    /// Span of s (0) or g (1).
    pub fn span(&self, axis: usize) -> f64 {
        self.spans.values[axis]
    }

    /// Span of a further field.
    pub fn span_of(&self, field: &str) -> f64 {
        let place = self.transfer_function.fields().iter().position(|name| *name == field);
        place.map_or(0.0, |place| self.spans.values[2 + place])
    }

    /// D/U.
    pub fn length(&self) -> f64 {
        self.spans.longest / self.transfer_function.unit_distance
    }

    /// Optical depth at the widget's peak along the whole segment.
    pub fn depth(&self, widget: &Widget) -> f64 {
        self.length() * widget.peak()
    }

    /// Cutoff of the constant-emitter.
    pub fn cutoff(&self) -> Option<f64> {
        self.transfer_function.model.cutoff()
    }
}

/// Checks the widths of a Gaussian, one number a row of K.
pub(crate) fn check_widths(rows: impl Iterator<Item = f64>) -> Result<()> {
    let widths = rows.map(|x| x * x).sum::<f64>().sqrt();
    if widths <= MAX_GAUSSIAN_WIDTHS {
        return Ok(());
    }
    Err(Error::run("a Gaussian is narrower than 32 bits resolve along a segment")
        .got(format!("{widths:e} widths over one segment"))
        .expected(format!("at most {MAX_GAUSSIAN_WIDTHS:e}, or an engine of 64 bits")))
}
