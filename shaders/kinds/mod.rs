//! The kinds of widgets as shaders know them, one file each: the calls that the generated block makes for one, the numbers
//! that its pieces read, and what 32 bits do not hold of it. The pieces stand under `wgsl/`, in a folder of the kind's name.

mod gaussian;
mod gaussian_nd;
mod piecewise_linear;
mod snippets;
mod table;
mod triangular_gaussian;
mod triangular_gaussian_nd;
mod uniform;
mod wave;

pub(crate) use snippets::{Light, Mixing, Snippet, WidgetSnippets};

use crate::segment_extent::SegmentExtent;
use crate::writer::{WidgetRecord, Writer};
use voltet_core::Result;
use voltet_core::transfer::{Profile, Widget};

/// A widget's profile, as far as it decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 1 inside its region.
    Uniform,
    /// A Gaussian of the scalar alone.
    GaussianLine,
    /// A Gaussian over the (s, g) plane.
    GaussianPlane,
    /// A Gaussian over so many fields.
    GaussianNd(usize),
    /// A triangular Gaussian.
    TriangularGaussian,
    /// A triangular Gaussian over so many fields.
    TriangularGaussianNd(usize),
    /// A triangle wave.
    TriangleWave,
    /// A sine wave.
    SineWave,
    /// Linear between so many control points.
    PiecewiseLinear(usize),
    /// An image over the (s, g) plane.
    Table,
}

impl Kind {
    pub(crate) fn from_profile(profile: &Profile) -> Kind {
        match profile {
            Profile::Uniform => Kind::Uniform,
            Profile::Gaussian { matrix, .. } if gaussian::is_line(matrix) => Kind::GaussianLine,
            Profile::Gaussian { .. } => Kind::GaussianPlane,
            Profile::GaussianNd { fields, .. } => Kind::GaussianNd(fields.len()),
            Profile::TriangularGaussian { .. } => Kind::TriangularGaussian,
            Profile::TriangularGaussianNd { fields, .. } => Kind::TriangularGaussianNd(fields.len()),
            Profile::TriangleWave(_) => Kind::TriangleWave,
            Profile::SineWave(_) => Kind::SineWave,
            Profile::PiecewiseLinear { points } => Kind::PiecewiseLinear(points.len()),
            Profile::Table(_) => Kind::Table,
        }
    }

    /// Functions that the generated block calls for it.
    pub(crate) fn snippets(&self, constant_emitter: bool) -> WidgetSnippets {
        match self {
            Kind::Uniform => uniform::snippets(constant_emitter),
            Kind::GaussianLine => gaussian::line_snippets(constant_emitter),
            Kind::GaussianPlane => gaussian::plane_snippets(constant_emitter),
            Kind::GaussianNd(count) => gaussian_nd::snippets(*count, constant_emitter),
            Kind::TriangularGaussian => triangular_gaussian::snippets(constant_emitter),
            Kind::TriangularGaussianNd(count) => triangular_gaussian_nd::snippets(*count, constant_emitter),
            Kind::TriangleWave | Kind::SineWave => wave::snippets(constant_emitter),
            Kind::PiecewiseLinear(count) => piecewise_linear::snippets(*count, constant_emitter),
            Kind::Table => table::snippets(constant_emitter),
        }
    }

    /// True if its light alone has no closed form under the model.
    pub(crate) fn is_integrated(&self, constant_emitter: bool) -> bool {
        self.snippets(constant_emitter).light == Light::Integrated
    }

    /// Count of its `numbers` beside its region's edges.
    pub(crate) fn number_count(&self) -> usize {
        match self {
            Kind::GaussianNd(count) => gaussian_nd::number_count(*count),
            Kind::TriangularGaussianNd(count) => triangular_gaussian_nd::number_count(*count),
            Kind::PiecewiseLinear(count) => piecewise_linear::NUMBERS * count,
            _ => 0,
        }
    }

    /// True if it reads an image.
    pub(crate) fn reads_texels(&self) -> bool {
        *self == Kind::Table
    }

    /// The piece that fills the slot `wave_mean_on_flank`, and its function, of a kind that asks for it.
    pub(crate) fn flank(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Kind::TriangleWave => Some(("wave/triangle", "triangle_mean_on_flank")),
            Kind::SineWave => Some(("wave/sine", "sine_mean_on_flank")),
            _ => None,
        }
    }
}

/// Writes the numbers of a profile, into the record and behind the numbers so far.
pub(crate) fn write(profile: &Profile, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    match profile {
        Profile::Uniform => Ok(()),
        Profile::Gaussian { centre, matrix } => gaussian::write(centre, matrix, writer, record),
        Profile::GaussianNd { fields, centre, matrix } => gaussian_nd::write(fields, centre, matrix, writer),
        Profile::TriangularGaussian { centre, sigma } => {
            triangular_gaussian::write(*centre, *sigma, writer, record)
        }
        Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
            triangular_gaussian_nd::write(fields, magnitude, centre, matrix, writer)
        }
        Profile::TriangleWave(wave) => wave::write(wave, false, writer, record),
        Profile::SineWave(wave) => wave::write(wave, true, writer, record),
        Profile::PiecewiseLinear { points } => piecewise_linear::write(points, writer, record),
        Profile::Table(table) => table::write(table, writer, record),
    }
}

/// Checks that 32 bits hold the widget on every segment of a data set.
pub(crate) fn check_32_bits(widget: &Widget, extent: &SegmentExtent) -> Result<()> {
    match &widget.profile {
        Profile::Gaussian { matrix, .. } => gaussian::check_32_bits(matrix, extent),
        Profile::GaussianNd { fields, matrix, .. } => gaussian_nd::check_32_bits(fields, matrix, extent),
        Profile::TriangleWave(wave) | Profile::SineWave(wave) => wave::check_32_bits(widget, wave, extent),
        Profile::PiecewiseLinear { points } => piecewise_linear::check_32_bits(points, extent),
        // Their ends are formed in the values' own 32 bits, and their panels follow the segment.
        Profile::Uniform
        | Profile::TriangularGaussian { .. }
        | Profile::TriangularGaussianNd { .. }
        | Profile::Table(_) => Ok(()),
    }
}
