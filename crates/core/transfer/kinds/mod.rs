//! The kinds of widgets, one file each: keys in a pipeline file, checks, properties, and bounds of the support.
//!
//! To add a kind, add a file here, a variant to [`Profile`] and an entry to [`DECLARED`]; the compiler then lists the other layers'
//! `match`es; only what a kind may lack has an arm for the rest. CONTRIBUTING.md names their files.

mod colormap;
mod gaussian;
mod gaussian_colormap;
mod gaussian_nd;
mod piecewise_linear;
pub(super) mod properties;
mod table;
mod triangular_gaussian;
mod triangular_gaussian_nd;
mod uniform;
mod wave;

pub use colormap::{CURVE_PARAMETERS, color_curve};
pub use properties::{
    AxisOrigin, BandSpacing, ColorSource, ControlPoint, LoadFiles, MAX_FIELDS, Properties, Table,
    UnreadFiles, Wave,
};
pub(super) use wave::ACROSS;

use crate::Result;
use crate::parameters::{Parameters, VariantSchema};
use crate::transfer::hull::Corners;
use crate::transfer::region::{Slab, SupportRadius};
use gaussian::{GaussianPlane, Line};
use gaussian_nd::GaussianNdBounds;
use piecewise_linear::PiecewiseLinearBounds;
use properties::fields_of;
use std::sync::Arc;
use table::MaximumTable;
use triangular_gaussian::TriangularGaussianBounds;
use triangular_gaussian_nd::TriangularGaussianNdBounds;
use wave::WaveBounds;

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
    /// Gaussian over its own list of 1 … [`MAX_FIELDS`] fields. Kniss Eq. 11, 12.
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
    /// exp(−|K (v − centre)|²/m²) over a list of 1 … [`MAX_FIELDS`] − 1 fields of its own, 0 where m ≤ 0. Kniss section
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

/// Function that reads the profile of a kind.
type ReadProfile = fn(&Parameters, &dyn LoadFiles) -> Result<Profile>;

/// All kinds, in the order in which help lists them.
pub(super) const DECLARED: &[(VariantSchema, ReadProfile)] = &[
    (uniform::KIND, |_, _| Ok(Profile::Uniform)),
    (gaussian::KIND, |p, _| gaussian::read(p).map(|(centre, matrix)| Profile::Gaussian { centre, matrix })),
    (gaussian_nd::KIND, |p, _| {
        let (fields, centre, matrix) = fields_of(p, MAX_FIELDS, std::f64::consts::SQRT_2)?;
        Ok(Profile::GaussianNd { fields, centre, matrix })
    }),
    (triangular_gaussian::KIND, |p, _| {
        Ok(Profile::TriangularGaussian { centre: p.number("centre")?, sigma: p.number("sigma")? })
    }),
    (triangular_gaussian_nd::KIND, |p, _| {
        let (magnitude, (fields, centre, matrix)) = triangular_gaussian_nd::read(p)?;
        Ok(Profile::TriangularGaussianNd { fields, magnitude, centre, matrix })
    }),
    (wave::TRIANGLE, |p, _| wave::read(p).map(Profile::TriangleWave)),
    (wave::SINE, |p, _| wave::read(p).map(Profile::SineWave)),
    (piecewise_linear::KIND, |p, _| Ok(Profile::PiecewiseLinear { points: piecewise_linear::read(p)? })),
    (colormap::KIND, |p, files| Ok(Profile::PiecewiseLinear { points: colormap::read(p, files)? })),
    (gaussian_colormap::KIND, |p, files| Ok(Profile::Table(Arc::new(gaussian_colormap::read(p, files)?)))),
    (table::KIND, |p, files| Ok(Profile::Table(Arc::new(table::read(p, files)?)))),
];

/// The kinds of widgets and their keys.
pub const WIDGET_KINDS: &[VariantSchema] = &{
    let mut kinds = [DECLARED[0].0; DECLARED.len()];
    let mut i = 0;
    while i < kinds.len() {
        kinds[i] = DECLARED[i].0;
        i += 1;
    }
    kinds
};

impl Profile {
    /// The kind's name in pipeline files.
    pub fn name(&self) -> &'static str {
        self.properties().name
    }

    /// Properties of the profile.
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

    /// Value at a point of the plane, 0 to 1 (docs/src/explanation/optics.md, section 5). `fields`: values of its further fields, in the
    /// order of [`Properties::fields`]. A table is 0 outside of its range.
    pub fn eval(&self, v: [f64; 2], fields: &[f64]) -> f64 {
        match self {
            Profile::Uniform => 1.0,
            Profile::Gaussian { centre, matrix } => gaussian::at(centre, matrix, v),
            Profile::GaussianNd { centre, matrix, .. } => gaussian_nd::at(centre, matrix, fields),
            Profile::TriangularGaussian { centre, sigma } => triangular_gaussian::at(*centre, *sigma, v),
            Profile::TriangularGaussianNd { centre, matrix, .. } => {
                triangular_gaussian_nd::at(centre, matrix, fields)
            }
            Profile::TriangleWave(wave) => wave.at(v, false),
            Profile::SineWave(wave) => wave.at(v, true),
            Profile::PiecewiseLinear { points } => piecewise_linear::at(points, v[0]),
            Profile::Table(table) => f64::from(table.at(v)[3]),
        }
    }

    /// Length along an axis (0: s, 1: g) over which it is smooth, beside its jumps and control points; infinite where it does not change.
    pub fn width(&self, axis: usize) -> f64 {
        match self {
            Profile::Gaussian { matrix, .. } => 1.0 / matrix[0][axis].hypot(matrix[1][axis]),
            Profile::TriangleWave(wave) | Profile::SineWave(wave) => {
                0.05 * wave.band_width / wave.step()[axis].abs()
            }
            Profile::Table(table) => {
                let ([low, high], count) = [(table.s, table.width), (table.g, table.height)][axis.min(1)];
                (high - low) / count as f64
            }
            Profile::Uniform
            | Profile::GaussianNd { .. }
            | Profile::TriangularGaussian { .. }
            | Profile::TriangularGaussianNd { .. }
            | Profile::PiecewiseLinear { .. } => f64::INFINITY,
        }
    }

    /// As of [`Widget::scalar_range`](super::Widget::scalar_range), without the region.
    pub(super) fn scalar_range(&self) -> [f64; 2] {
        const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        match self {
            Profile::Gaussian { centre, matrix } => gaussian::scalar_range(centre, matrix),
            Profile::PiecewiseLinear { points } => piecewise_linear::scalar_range(points),
            Profile::Table(table) => table.s,
            // Of these s is one of several fields, or the width depends on g, or they have no end.
            Profile::Uniform
            | Profile::GaussianNd { .. }
            | Profile::TriangularGaussian { .. }
            | Profile::TriangularGaussianNd { .. }
            | Profile::TriangleWave(_)
            | Profile::SineWave(_) => EVERYWHERE,
        }
    }

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

    /// Profile with its own extinctions, where it holds any, multiplied by a factor.
    pub(super) fn with_extinction_times(&self, factor: f64) -> Profile {
        let mut profile = self.clone();
        if let Profile::PiecewiseLinear { points } = &mut profile {
            points.iter_mut().for_each(|point| point.extinction *= factor);
        }
        profile
    }

    /// Profile with its own colours, where it holds any, all replaced by one.
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
            _ => self.clone(),
        }
    }

    /// Its bounds over cells; `names`: the further fields in their order.
    pub(super) fn bounds(&self, names: &[&str]) -> ProfileBounds {
        match self {
            Profile::Uniform => ProfileBounds::Uniform,
            Profile::Gaussian { centre, matrix } => match Line::new(centre, matrix) {
                Some(line) => ProfileBounds::GaussianLine(line),
                None => ProfileBounds::GaussianPlane(GaussianPlane { centre: *centre, matrix: *matrix }),
            },
            Profile::GaussianNd { fields, centre, matrix } => {
                ProfileBounds::GaussianNd(GaussianNdBounds::new(fields, centre, matrix, names))
            }
            &Profile::TriangularGaussian { centre, sigma } => {
                ProfileBounds::TriangularGaussian(TriangularGaussianBounds { centre, sigma })
            }
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                let fields = GaussianNdBounds::new(fields, centre, matrix, names);
                ProfileBounds::TriangularGaussianNd(TriangularGaussianNdBounds::new(fields, magnitude, names))
            }
            Profile::TriangleWave(wave) => ProfileBounds::Wave(WaveBounds::new(wave, false)),
            Profile::SineWave(wave) => ProfileBounds::Wave(WaveBounds::new(wave, true)),
            Profile::PiecewiseLinear { points } => {
                ProfileBounds::PiecewiseLinear(PiecewiseLinearBounds::new(points))
            }
            Profile::Table(table) => ProfileBounds::Table(MaximumTable::new(table)),
        }
    }

    /// Lists of slabs that hold its support, all that exceeds e^(−r²) within the reach; none at all where it has none.
    pub(super) fn slabs(&self, reach: SupportRadius) -> Vec<Vec<Slab>> {
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

/// Bounds of a profile over the convex hull of cells' values.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ProfileBounds {
    Uniform,
    /// K looks at one axis only.
    GaussianLine(Line),
    GaussianPlane(GaussianPlane),
    GaussianNd(GaussianNdBounds),
    TriangularGaussian(TriangularGaussianBounds),
    TriangularGaussianNd(TriangularGaussianNdBounds),
    Wave(WaveBounds),
    PiecewiseLinear(PiecewiseLinearBounds),
    Table(MaximumTable),
}

impl ProfileBounds {
    /// No less than it is anywhere in the hull.
    #[inline]
    pub fn bound(&self, corners: &Corners) -> f64 {
        match self {
            ProfileBounds::Uniform => 1.0,
            ProfileBounds::GaussianLine(line) => line.bound(corners),
            ProfileBounds::GaussianPlane(plane) => plane.bound(corners),
            ProfileBounds::GaussianNd(fields) => fields.bound(corners),
            ProfileBounds::TriangularGaussian(triangular) => triangular.bound(corners),
            ProfileBounds::TriangularGaussianNd(triangular) => triangular.bound(corners),
            ProfileBounds::Wave(wave) => wave.bound(corners),
            ProfileBounds::PiecewiseLinear(points) => points.bound(corners),
            ProfileBounds::Table(table) => table.bound(corners.s_range(), corners.g_range()),
        }
    }

    /// No more than it is anywhere in a box of s and g: 0 of kinds of which no more is known.
    pub fn min_in_box(&self, ranges: &[[f64; 2]; 2]) -> f64 {
        match self {
            ProfileBounds::Uniform => 1.0,
            ProfileBounds::GaussianLine(line) => line.min_in_box(ranges),
            ProfileBounds::GaussianPlane(plane) => plane.min_in_box(ranges),
            ProfileBounds::PiecewiseLinear(points) => points.min_in_range(ranges[0]),
            _ => 0.0,
        }
    }
}
