//! The record of one widget, and what writes its numbers.

use bytemuck::{Pod, Zeroable};
use voltet_core::transfer::{HalfPlane, Widget};
use voltet_core::{Error, Result};

/// Storage of a value: stored = (value − offset) / scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// In units of the value.
    pub offset: f64,
    /// In units of the value, > 0.
    pub scale: f64,
}

impl Axis {
    /// Values as they are.
    pub const PLAIN: Axis = Axis { offset: 0.0, scale: 1.0 };

    /// The stored number of a value.
    pub fn stored(&self, value: f64) -> f64 {
        (value - self.offset) / self.scale
    }
}

/// `Widget` of `scene.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct WidgetRecord {
    /// Linear RGB.
    pub color: [f32; 3],
    /// ρ₀ per scene length.
    pub extinction: f32,
    /// Numbers of the profile.
    pub matrix: [f32; 4],
    /// 1/w, reach, half area, half-width of what glows; of a table columns and rows.
    pub bell: [f32; 4],
    /// As values are stored.
    pub centre: [f32; 2],
    /// Index of the region's first edge in `numbers`.
    pub first_edge: u32,
    /// Index of the profile's first further number, or of a table's first texel.
    pub first_number: u32,
    /// Bit 0: a sine wave; bit 1: nothing is cut away.
    pub bell_kind: u32,
    /// Fills up to the alignment of a widget.
    pub padding: [u32; 3],
}

/// Writes the numbers of one widget after the other.
pub(crate) struct Writer<'a> {
    pub axes: &'a [Axis],
    /// 1/U in scene lengths.
    pub per_unit: f64,
    /// The constant-emitter's.
    pub cutoff: Option<f64>,
    pub fields: Vec<&'a str>,
    /// Index of the first further field among a segment's values.
    pub first_field: usize,
    /// Index of the widgets' first number in the buffer.
    pub first_number: u32,
    /// Edges, control points, matrices so far.
    pub numbers: Vec<f32>,
    /// Number of texels of the tables so far.
    pub texel_count: u32,
}

impl Writer<'_> {
    /// Index of the next number in the buffer.
    pub fn next_place(&self) -> u32 {
        self.first_number.saturating_add(self.numbers.len() as u32)
    }

    /// The axes of s and g.
    pub fn plane(&self) -> [Axis; 2] {
        [self.axes[0], self.axes[1]]
    }

    /// The place of a field among the further ones.
    pub fn field(&self, name: &str) -> usize {
        self.fields.iter().position(|field| *field == name).unwrap_or(0)
    }

    pub fn axis(&self, field: usize) -> Axis {
        self.axes[2 + field]
    }

    /// The place of a further field among a segment's values.
    pub fn value_of_field(&self, field: usize) -> usize {
        self.first_field + field
    }

    /// The edges of its region and range.
    pub fn edges(&mut self, widget: &Widget) -> Result<()> {
        for HalfPlane { normal, corner } in widget.half_planes() {
            let scaled = [normal[0] * self.axes[0].scale, normal[1] * self.axes[1].scale];
            // Only the ratio of distances matters: a power of two keeps the digits.
            let size = scaled[0].abs().max(scaled[1].abs());
            let unit = size.log2().floor().exp2();
            let stored = [0, 1].map(|a| if normal[a] == 0.0 { 0.0 } else { self.axes[a].stored(corner[a]) });
            let row = [scaled[0] / unit, scaled[1] / unit, stored[0], stored[1]];
            self.numbers.extend(all_finite("a corner of the region", row)?);
        }
        Ok(())
    }
}

/// A number in 32 bits, if it has one there.
pub(crate) fn finite(what: &str, x: f64) -> Result<f32> {
    let stored = x as f32;
    if stored.is_finite() {
        return Ok(stored);
    }
    Err(Error::run(format!("{what} leaves the range of 32 bits"))
        .got(x)
        .expected(format!("at most {:.1e} in the units of the scene", f32::MAX)))
}

/// Checks that several numbers are finite.
pub(crate) fn all_finite<const N: usize>(what: &str, numbers: [f64; N]) -> Result<[f32; N]> {
    let mut stored = [0.0; N];
    for (stored, x) in stored.iter_mut().zip(numbers) {
        *stored = finite(what, x)?;
    }
    Ok(stored)
}
