//! Properties that each kind of widget declares, and the parts of profiles.

use crate::transfer::region::Region;

/// Most fields of a widget that looks at a list of its own.
pub const MAX_FIELDS: usize = 8;

/// φ = ((s − s₀) cos θ·w_s + (g − g₀) sin θ·w_g) / period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// [s₀, g₀].
    pub origin: [f64; 2],
    /// θ in radians (files give degrees).
    pub angle: f64,
    /// [w_s, w_g].
    pub scale: [f64; 2],
    /// One period of φ is one band; > 0.
    pub period: f64,
    /// Share of the profile kept around its peaks, in (0, 1].
    pub band_width: f64,
}

/// A control point of a piecewise-linear widget.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlPoint {
    /// Scalar.
    pub s: f64,
    /// Linear RGB.
    pub color: [f64; 3],
    /// Extinction per unit distance.
    pub extinction: f64,
}

/// A transfer function painted as an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Columns (along s).
    pub width: usize,
    /// Rows (along g; row 0 at the largest g).
    pub height: usize,
    /// Straight linear RGB and alpha, row-major.
    pub texels: Vec<[f32; 4]>,
    /// [s_a, s_b].
    pub s: [f64; 2],
    /// [g_a, g_b].
    pub g: [f64; 2],
}

/// Properties of a profile that hold for every engine.
#[derive(Debug, Clone, PartialEq)]
pub struct Properties<'a> {
    /// The kind's name in pipeline files.
    pub name: &'static str,
    /// Source of the colour.
    pub color: ColorSource<'a>,
    /// The largest extinction per unit distance, where the profile holds extinctions and not shares of the widget's.
    pub own_peak: Option<f64>,
    /// Names of the further point arrays that it looks at.
    pub fields: Vec<&'a str>,
    /// True if it looks at the gradient magnitude.
    pub depends_on_g: bool,
    /// Best origins of s, g and each of the fields.
    pub axes: Vec<AxisOrigin>,
    /// The bands of a profile that is periodic in s and g.
    pub bands: Option<BandSpacing>,
    /// True if it jumps somewhere, so that sampling converges by first order only.
    pub jumps: bool,
    /// The part of the plane outside which it is 0, beside the widget's region.
    pub range: Option<Region>,
    /// True if it is drawn only inside a region, which must be given.
    pub needs_region: bool,
    /// True if its mean over a segment is an elementary function (with erf and polynomials), so that no quadrature
    /// has a part in the optical depth.
    pub has_elementary_mean: bool,
}

/// The bands of a periodic profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandSpacing {
    /// [s₀, g₀], where φ = 0.
    pub origin: [f64; 2],
    /// φ per unit of s and of g; one band is a unit of φ.
    pub step: [f64; 2],
}

/// Source of a widget's colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColorSource<'a> {
    /// The widget has one.
    Widget,
    /// Linear between those of control points.
    Points(&'a [ControlPoint]),
    /// Bilinear between those of texels.
    Texels(&'a [[f32; 4]]),
}

/// Best origin of an axis' values, for a profile to keep its digits in 32 bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxisOrigin {
    /// From anywhere.
    Any,
    /// From here: only differences from it matter.
    Centre(f64),
    /// From 0: the values are widths themselves, and small ones matter.
    Zero,
}
