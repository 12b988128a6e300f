//! The kinds of widgets, one file each: keys in a pipeline file, checks, properties, and where the support lies.
//!
//! To add a kind, add a variant to [`Profile`] and a file here; the compiler then lists what else must be said. No `match`
//! over kinds has an arm for the rest.

mod gaussian;
mod gaussian_nd;
mod keys;
mod maximum_table;
mod piecewise_linear;
mod profile;
mod table;
mod triangular_gaussian;
mod triangular_gaussian_nd;
mod uniform;
mod wave;

pub use keys::LoadImage;
pub use profile::{
    AxisOrigin, Bands, ColorSource, ControlPoint, MAX_FIELDS, Profile, Properties, Table, Wave,
};
pub(super) use wave::ACROSS;

use super::hull::Corners;
use super::slab::{Slab, SupportRadius};
use crate::Result;
use crate::parameters::VariantSchema;
use keys::DeclaredKind;
use maximum_table::MaximumTable;
use std::sync::Arc;

/// All kinds, in the order in which help lists them.
pub(super) const DECLARED: [DeclaredKind; 9] = [
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
pub const WIDGET_KINDS: &[VariantSchema] = &{
    let mut kinds = [DECLARED[0].kind; DECLARED.len()];
    let mut i = 0;
    while i < kinds.len() {
        kinds[i] = DECLARED[i].kind;
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

    /// Profile with its own extinctions, where it holds any, multiplied by a factor.
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
    pub(super) fn bounds(&self, names: &[&str]) -> ProfileBounds {
        match self {
            Profile::Uniform => ProfileBounds::Uniform,
            Profile::Gaussian { centre, matrix } => match gaussian::Line::new(centre, matrix) {
                Some(line) => ProfileBounds::GaussianLine(line),
                None => ProfileBounds::GaussianPlane(gaussian::Plane { centre: *centre, matrix: *matrix }),
            },
            Profile::GaussianNd { fields, centre, matrix } => {
                ProfileBounds::GaussianNd(gaussian_nd::GaussianNdBounds::new(fields, centre, matrix, names))
            }
            Profile::TriangularGaussian { centre, sigma } => {
                ProfileBounds::TriangularGaussian(triangular_gaussian::TriangularGaussianBounds {
                    centre: *centre,
                    sigma: *sigma,
                })
            }
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                let fields = gaussian_nd::GaussianNdBounds::new(fields, centre, matrix, names);
                let bounds =
                    triangular_gaussian_nd::TriangularGaussianNdBounds::new(fields, magnitude, names);
                ProfileBounds::TriangularGaussianNd(bounds)
            }
            Profile::TriangleWave(wave) => ProfileBounds::Wave(wave::WaveBounds::new(wave, false)),
            Profile::SineWave(wave) => ProfileBounds::Wave(wave::WaveBounds::new(wave, true)),
            Profile::PiecewiseLinear { points } => {
                ProfileBounds::PiecewiseLinear(piecewise_linear::PiecewiseLinearBounds::new(points))
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
    GaussianLine(gaussian::Line),
    GaussianPlane(gaussian::Plane),
    GaussianNd(gaussian_nd::GaussianNdBounds),
    TriangularGaussian(triangular_gaussian::TriangularGaussianBounds),
    TriangularGaussianNd(triangular_gaussian_nd::TriangularGaussianNdBounds),
    Wave(wave::WaveBounds),
    PiecewiseLinear(piecewise_linear::PiecewiseLinearBounds),
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
            ProfileBounds::GaussianNd(_)
            | ProfileBounds::TriangularGaussian(_)
            | ProfileBounds::TriangularGaussianNd(_)
            | ProfileBounds::Wave(_)
            | ProfileBounds::Table(_) => 0.0,
        }
    }
}
