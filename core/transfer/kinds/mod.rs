//! The kinds of widgets, one file each: keys in a pipeline file, checks, properties, and where the support lies.
//!
//! To add a kind, add a variant to [`Profile`] and a file here; the compiler then lists what else must be said. No `match`
//! over kinds has an arm for the rest.

mod gaussian;
mod gaussian_nd;
mod keys;
mod piecewise_linear;
mod table;
mod triangular_gaussian;
mod triangular_gaussian_nd;
mod uniform;
mod wave;

pub use keys::{LoadImage, read};
pub use wave::Bands;

use super::region::Region;
use super::support::slabs::{Reach, Slab};
use super::support::{Corners, MaximumTable};
use crate::Result;
use crate::parameters::Kind;
use keys::Declared;
use std::sync::Arc;

/// All kinds, in the order in which help lists them.
const DECLARED: [Declared; 9] = [
    uniform::KIND,
    gaussian::KIND,
    gaussian_nd::KIND,
    triangular_gaussian::KIND,
    triangular_gaussian_nd::KIND,
    wave::TRIANGLE,
    wave::SINE,
    piecewise_linear::KIND,
    table::KIND,
];

/// The kinds of widgets and their keys.
pub const WIDGET_KINDS: &[Kind] = &{
    let mut kinds = [DECLARED[0].kind; DECLARED.len()];
    let mut i = 0;
    while i < kinds.len() {
        kinds[i] = DECLARED[i].kind;
        i += 1;
    }
    kinds
};

/// Most fields of a widget that looks at a list of its own.
pub const FIELDS_MOST: usize = 8;

/// A widget's profile (peak 1). Lengths along s are in units of s, along g in units of g.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// 1 inside the region (which is required). Song et al. 2009, section 4.1.
    Uniform,
    /// exp(−|K (v − centre)|²). Song section 4.2; Kniss et al. 2003, Eq. 12.
    Gaussian {
        /// [s, g].
        centre: [f64; 2],
        /// K, rows first; the axis-aligned form is diag(1/(√2 σ_s), 1/(√2 σ_g)).
        matrix: [[f64; 2]; 2],
    },
    /// The same over its own list of 1 … [`FIELDS_MOST`] fields. Kniss Eq. 11, 12.
    GaussianNd {
        /// Names of the point arrays.
        fields: Vec<String>,
        /// One value a field.
        centre: Vec<f64>,
        /// K, rows first, `fields.len()` squared.
        matrix: Vec<Vec<f64>>,
    },
    /// exp(−((s − centre)/(sigma g))²), 0 where g = 0. Kniss section 3.2.
    TriangularGaussian {
        /// s₀.
        centre: f64,
        /// Width per unit of g.
        sigma: f64,
    },
    /// exp(−|K (v − centre)|²/m²) over a list of 1 … [`FIELDS_MOST`] − 1 fields of its own, 0 where m ≤ 0. Kniss section
    /// 3.2, with m² for the norm of DᵀD, so that one field is the same as above.
    TriangularGaussianNd {
        /// Names of the point arrays.
        fields: Vec<String>,
        /// Name of the point array m, the magnitude of all their gradients.
        magnitude: String,
        /// One value a field.
        centre: Vec<f64>,
        /// K, rows first, `fields.len()` squared: the inverse of the widths per unit of m.
        matrix: Vec<Vec<f64>>,
    },
    /// tri(φ). Song section 4.3.
    TriangleWave(Wave),
    /// |sin(π φ)|. Song section 4.4.
    SineWave(Wave),
    /// Colour and extinction linear between control points in s, constant beyond the ends.
    PiecewiseLinear {
        /// In rising s, at least one.
        points: Vec<ControlPoint>,
    },
    /// A W × H image over [s_a, s_b] × [g_a, g_b]. Song section 3.3.2.
    Table(Arc<Table>),
}

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

/// What is true of a profile, whatever draws it.
#[derive(Debug, Clone, PartialEq)]
pub struct Properties<'a> {
    /// The kind's name in pipeline files.
    pub name: &'static str,
    /// Where the colour comes from.
    pub color: ColorSource<'a>,
    /// The largest extinction per unit distance, where the profile holds extinctions and not shares of the widget's.
    pub own_peak: Option<f64>,
    /// Names of the further point arrays that it looks at.
    pub fields: Vec<&'a str>,
    /// Whether it looks at the gradient magnitude.
    pub depends_on_g: bool,
    /// Where s, g and each of the fields are best counted from.
    pub axes: Vec<AxisOrigin>,
    /// The bands of a profile that is periodic in s and g.
    pub bands: Option<Bands>,
    /// Whether it jumps somewhere, so that sampling converges by first order only.
    pub jumps: bool,
    /// The part of the plane outside which it is 0, beside the widget's region.
    pub range: Option<Region>,
    /// Whether it is drawn only inside a region, which must be given.
    pub needs_region: bool,
    /// Whether its mean over a segment is an elementary function (with erf and polynomials), so that no quadrature
    /// has a part in the optical depth.
    pub has_elementary_mean: bool,
}

/// Where a widget's colour comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColorSource<'a> {
    /// The widget has one.
    Widget,
    /// Linear between those of control points.
    Points(&'a [ControlPoint]),
    /// Bilinear between those of texels.
    Texels(&'a [[f32; 4]]),
}

/// Where the values of an axis are best counted from, for a profile to keep its digits in 32 bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxisOrigin {
    /// From anywhere.
    Any,
    /// From here: only differences from it matter.
    Centre(f64),
    /// From 0: the values are widths themselves, and small ones matter.
    Zero,
}

impl Profile {
    /// The kind's name in pipeline files.
    pub fn name(&self) -> &'static str {
        self.properties().name
    }

    /// What is true of it.
    pub fn properties(&self) -> Properties<'_> {
        match self {
            Profile::Uniform => uniform::properties(),
            Profile::Gaussian { centre, matrix } => gaussian::properties(centre, matrix),
            Profile::GaussianNd { fields, centre, .. } => gaussian_nd::properties(fields, centre),
            Profile::TriangularGaussian { centre, .. } => triangular_gaussian::properties(*centre),
            Profile::TriangularGaussianNd { fields, magnitude, centre, .. } => {
                triangular_gaussian_nd::properties(fields, magnitude, centre)
            }
            Profile::TriangleWave(wave) => wave::properties("triangle-wave", wave),
            Profile::SineWave(wave) => wave::properties("sine-wave", wave),
            Profile::PiecewiseLinear { points } => piecewise_linear::properties(points),
            Profile::Table(table) => table::properties(table),
        }
    }

    /// Checks its numbers.
    pub(super) fn check(&self) -> Result<()> {
        match self {
            Profile::Uniform => Ok(()),
            Profile::Gaussian { centre, matrix } => gaussian::check(centre, matrix),
            Profile::GaussianNd { fields, centre, matrix } => gaussian_nd::check(fields, centre, matrix),
            Profile::TriangularGaussian { centre, sigma } => triangular_gaussian::check(*centre, *sigma),
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                triangular_gaussian_nd::check(fields, magnitude, centre, matrix)
            }
            Profile::TriangleWave(wave) | Profile::SineWave(wave) => wave::check(wave),
            Profile::PiecewiseLinear { points } => piecewise_linear::check(points),
            Profile::Table(table) => table::check(table),
        }
    }

    /// The same profile, its own extinctions multiplied where it holds any.
    pub(super) fn with_extinction_times(&self, factor: f64) -> Profile {
        let mut profile = self.clone();
        match &mut profile {
            Profile::PiecewiseLinear { points } => {
                points.iter_mut().for_each(|point| point.extinction *= factor);
            }
            Profile::Uniform
            | Profile::Gaussian { .. }
            | Profile::GaussianNd { .. }
            | Profile::TriangularGaussian { .. }
            | Profile::TriangularGaussianNd { .. }
            | Profile::TriangleWave(_)
            | Profile::SineWave(_)
            | Profile::Table(_) => {}
        }
        profile
    }

    /// The same profile, its own colours, where it holds any, all replaced by one.
    pub(super) fn in_color(&self, color: [f64; 3]) -> Profile {
        match self {
            Profile::PiecewiseLinear { points } => {
                let points = points.iter().map(|point| ControlPoint { color, ..*point }).collect();
                Profile::PiecewiseLinear { points }
            }
            Profile::Table(table) => {
                let [r, g, b] = color.map(|c| c as f32);
                let texels = table.texels.iter().map(|texel| [r, g, b, texel[3]]).collect();
                Profile::Table(Arc::new(Table { texels, ..table.as_ref().clone() }))
            }
            Profile::Uniform
            | Profile::Gaussian { .. }
            | Profile::GaussianNd { .. }
            | Profile::TriangularGaussian { .. }
            | Profile::TriangularGaussianNd { .. }
            | Profile::TriangleWave(_)
            | Profile::SineWave(_) => self.clone(),
        }
    }

    /// Its bounds over cells; `names`: the further fields in their order.
    pub(super) fn bounds(&self, names: &[&str]) -> Bounds {
        match self {
            Profile::Uniform => Bounds::Uniform,
            Profile::Gaussian { centre, matrix } => match gaussian::Line::new(centre, matrix) {
                Some(line) => Bounds::GaussianLine(line),
                None => Bounds::GaussianPlane(gaussian::Plane { centre: *centre, matrix: *matrix }),
            },
            Profile::GaussianNd { fields, centre, matrix } => {
                Bounds::GaussianNd(gaussian_nd::Bounds::new(fields, centre, matrix, names))
            }
            Profile::TriangularGaussian { centre, sigma } => {
                Bounds::TriangularGaussian(triangular_gaussian::Bounds { centre: *centre, sigma: *sigma })
            }
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                let fields = gaussian_nd::Bounds::new(fields, centre, matrix, names);
                let bounds = triangular_gaussian_nd::Bounds::new(fields, magnitude, names);
                Bounds::TriangularGaussianNd(bounds)
            }
            Profile::TriangleWave(wave) => Bounds::Wave(wave::Bounds::new(wave, false)),
            Profile::SineWave(wave) => Bounds::Wave(wave::Bounds::new(wave, true)),
            Profile::PiecewiseLinear { points } => {
                Bounds::PiecewiseLinear(piecewise_linear::Bounds::new(points))
            }
            Profile::Table(table) => Bounds::Table(MaximumTable::new(table)),
        }
    }

    /// Lists of slabs that hold its support, all that exceeds e^(−r²) within the reach; none at all where it has none.
    pub(super) fn slabs(&self, reach: Reach) -> Vec<Vec<Slab>> {
        match self {
            // Limited by its region and range alone.
            Profile::Uniform
            | Profile::GaussianNd { .. }
            | Profile::TriangularGaussianNd { .. }
            | Profile::TriangleWave(_)
            | Profile::SineWave(_)
            | Profile::Table(_) => reach.everywhere(),
            Profile::Gaussian { centre, matrix } => {
                reach.within(|distance| gaussian::slabs(centre, matrix, distance))
            }
            Profile::TriangularGaussian { centre, sigma } => {
                reach.within(|distance| triangular_gaussian::slabs(*centre, *sigma, distance))
            }
            Profile::PiecewiseLinear { points } => piecewise_linear::slabs(points),
        }
    }
}

/// Upper bounds of a profile over the convex hull of a cell's values.
#[derive(Debug, Clone)]
pub(super) enum Bounds {
    Uniform,
    /// K looks at one axis only.
    GaussianLine(gaussian::Line),
    GaussianPlane(gaussian::Plane),
    GaussianNd(gaussian_nd::Bounds),
    TriangularGaussian(triangular_gaussian::Bounds),
    TriangularGaussianNd(triangular_gaussian_nd::Bounds),
    Wave(wave::Bounds),
    PiecewiseLinear(piecewise_linear::Bounds),
    Table(MaximumTable),
}

impl Bounds {
    #[inline]
    pub fn bound(&self, corners: &Corners) -> f64 {
        match self {
            Bounds::Uniform => 1.0,
            Bounds::GaussianLine(line) => line.bound(corners),
            Bounds::GaussianPlane(plane) => plane.bound(corners),
            Bounds::GaussianNd(fields) => fields.bound(corners),
            Bounds::TriangularGaussian(triangular) => triangular.bound(corners),
            Bounds::TriangularGaussianNd(triangular) => triangular.bound(corners),
            Bounds::Wave(wave) => wave.bound(corners),
            Bounds::PiecewiseLinear(points) => points.bound(corners),
            Bounds::Table(table) => table.bound(corners.s_range(), corners.g_range()),
        }
    }
}

#[cfg(test)]
mod tests;
