//! Profiles of widgets in 64 bits: compiled (`CompiledProfile`), along one segment (`Path`), and as the quadrature
//! sees it ([`AnyTrack`]). The formulas stand in one file a kind.

use crate::Segment;
use crate::clip::ClippedSpan;
use crate::quadrature::GAUSS_12;
use crate::special::{mean_transmittance, opacity};
use crate::track::{POINTS, Track};
use gaussian::{GaussianPath, GaussianTrack};
use piecewise_linear::{PiecewisePath, PiecewiseTrack};
use std::sync::Arc;
use table::TablePath;
use triangular_gaussian::TriangularPath;
use voltet_core::transfer::{ControlPoint, MAX_FIELDS, Profile, Table};
use wave::{Bell, WavePath, WaveTrack};

pub mod gaussian;
pub mod piecewise_linear;
pub mod table;
pub mod triangular_gaussian;
pub mod wave;

/// The constant-emitter's cutoff.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cutoff {
    /// Share of the peak under which a widget does not glow.
    pub share: f64,
    /// −ln share: a Gaussian is lit where |q|² is less.
    pub level: f64,
}

#[derive(Debug, Clone)]
pub(crate) enum CompiledProfile {
    Uniform,
    Gaussian {
        centre: [f64; 2],
        matrix: [[f64; 2]; 2],
    },
    GaussianNd(Box<Fields>),
    Triangular {
        centre: f64,
        sigma: f64,
    },
    /// With the place of m among the segments' further fields.
    TriangularNd(Box<Fields>, usize),
    Wave(Bell),
    Piecewise {
        points: Vec<ControlPoint>,
        peak: f64,
    },
    Table(Arc<Table>),
}

/// One widget along one segment.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Path<'a> {
    Uniform,
    Gaussian(GaussianPath),
    Triangular(TriangularPath),
    Wave(WavePath),
    Piecewise(PiecewisePath<'a>),
    Table(TablePath<'a>),
}

/// C of a widget that is alone on a segment.
pub(crate) enum WidgetLight {
    /// This times the widget's colour.
    OfWidget(f64),
    /// In colours of its own.
    OwnColors([f64; 3]),
    /// There is no closed form: the ordered integral finds it.
    Integrated,
}

/// Part of a segment inside a widget.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WidgetPart {
    /// The part inside its region.
    pub stretch: ClippedSpan,
    /// Rate of optical depth per t where the profile is 1.
    pub peak: f64,
    /// D/U.
    pub scale: f64,
}

impl CompiledProfile {
    /// `fields`: the segments' further fields.
    pub fn new(profile: &Profile, fields: &[&str]) -> CompiledProfile {
        match profile {
            Profile::Uniform => CompiledProfile::Uniform,
            Profile::Gaussian { centre, matrix } => {
                CompiledProfile::Gaussian { centre: *centre, matrix: *matrix }
            }
            Profile::GaussianNd { fields: names, centre, matrix } => {
                CompiledProfile::GaussianNd(Box::new(Fields::new(names, centre, matrix, fields)))
            }
            Profile::TriangularGaussian { centre, sigma } => {
                CompiledProfile::Triangular { centre: *centre, sigma: *sigma }
            }
            Profile::TriangularGaussianNd { fields: names, magnitude, centre, matrix } => {
                let own = Fields::new(names, centre, matrix, fields);
                CompiledProfile::TriangularNd(Box::new(own), slot(magnitude, fields))
            }
            Profile::TriangleWave(wave) => CompiledProfile::Wave(Bell::triangle(wave)),
            Profile::SineWave(wave) => CompiledProfile::Wave(Bell::sine(wave)),
            Profile::PiecewiseLinear { points } => {
                let peak = profile.properties().own_peak.unwrap_or(0.0);
                CompiledProfile::Piecewise { points: points.clone(), peak }
            }
            Profile::Table(table) => CompiledProfile::Table(Arc::clone(table)),
        }
    }

    /// The largest value of what its paths integrate: extinctions of their own, or a profile whose peak is 1.
    pub fn peak(&self) -> f64 {
        match self {
            CompiledProfile::Piecewise { peak, .. } => *peak,
            _ => 1.0,
        }
    }

    /// Along a segment; `peak`: the rate of optical depth per t where the profile is 1. `None` where the values are not
    /// numbers and the path would not tell.
    pub fn path(&self, segment: &Segment, peak: f64, cutoff: Option<Cutoff>) -> Option<Path<'_>> {
        let (front, back) = (segment.front, segment.back);
        Some(match self {
            CompiledProfile::Uniform => Path::Uniform,
            CompiledProfile::Gaussian { centre, matrix } => {
                let times = |v: [f64; 2]| {
                    [matrix[0][0] * v[0] + matrix[0][1] * v[1], matrix[1][0] * v[0] + matrix[1][1] * v[1]]
                };
                let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
                Path::Gaussian(GaussianPath::new(
                    times(minus(front, *centre)),
                    times(minus(back, *centre)),
                    times(minus(back, front)),
                ))
            }
            CompiledProfile::GaussianNd(fields) => {
                let [front, back, along] = fields.ends(segment);
                Path::Gaussian(GaussianPath::new(front, back, along))
            }
            CompiledProfile::TriangularNd(fields, magnitude) => {
                let [front, back, along] = fields.ends(segment);
                let magnitude = [segment.fields_front[*magnitude], segment.fields_back[*magnitude]];
                Path::Triangular(TriangularPath::over_fields(front, back, along, magnitude, peak))
            }
            // Comparisons with a control point do not tell what is no number.
            CompiledProfile::Piecewise { .. } if (back[0] - front[0]).is_nan() => return None,
            CompiledProfile::Piecewise { points, .. } => {
                Path::Piecewise(PiecewisePath::new(points, front[0], back[0]))
            }
            CompiledProfile::Triangular { centre, sigma } => Path::Triangular(TriangularPath::new(
                [front[0] - centre, back[0] - centre],
                [sigma * front[1], sigma * back[1]],
                peak,
            )),
            CompiledProfile::Wave(bell) => Path::Wave(bell.path(front, back)),
            CompiledProfile::Table(table) => {
                Path::Table(TablePath::new(table, front, back, peak, cutoff.map(|cutoff| cutoff.share)))
            }
        })
    }
}

impl<'a> Path<'a> {
    /// T over the widget's part.
    pub fn depth(&self, extent: &WidgetPart) -> f64 {
        let WidgetPart { stretch, peak, .. } = extent;
        match self {
            Path::Uniform => peak * stretch.length,
            Path::Gaussian(path) => path.optical_depth(*peak, stretch),
            Path::Piecewise(path) => peak * path.integral(stretch),
            Path::Triangular(path) => path.optical_depth(stretch),
            Path::Wave(path) => peak * path.integral(stretch),
            Path::Table(path) => path.depth(stretch.start, stretch.length),
        }
    }

    /// C under the density-emitter where the widget is alone.
    pub fn density_light(&self, extent: &WidgetPart, depth: f64) -> WidgetLight {
        match self {
            Path::Piecewise(path) => WidgetLight::OwnColors(path.emission(extent.scale, &extent.stretch)),
            Path::Table(_) => WidgetLight::Integrated,
            Path::Uniform | Path::Gaussian(_) | Path::Triangular(_) | Path::Wave(_) => {
                WidgetLight::OfWidget(opacity(depth))
            }
        }
    }

    /// C under the constant-emitter where the widget is alone; `threshold`: extinction above which control points glow.
    pub fn constant_light(
        &self,
        extent: &WidgetPart,
        depth: f64,
        cutoff: Cutoff,
        threshold: f64,
    ) -> WidgetLight {
        let WidgetPart { stretch, peak, scale } = extent;
        let lit = match self {
            Path::Uniform => stretch.length * mean_transmittance(depth),
            Path::Gaussian(path) => path.glow(*peak, stretch, cutoff.level),
            Path::Triangular(path) => path.glow(stretch, cutoff.level),
            Path::Wave(path) => path.glow(*peak, stretch, cutoff.share),
            Path::Table(_) => return WidgetLight::Integrated,
            Path::Piecewise(path) => {
                return WidgetLight::OwnColors(path.glow(*scale, stretch, threshold).map(|c| c * scale));
            }
        };
        WidgetLight::OfWidget(scale * lit)
    }

    /// True if quadrature has a part in C of the widget alone.
    pub fn is_integrated(&self, constant_emitter: bool) -> bool {
        match self {
            Path::Table(_) => true,
            Path::Gaussian(_) | Path::Triangular(_) => constant_emitter,
            Path::Uniform | Path::Wave(_) | Path::Piecewise(_) => false,
        }
    }

    /// True if its colour is the widget's.
    pub fn has_one_color(&self) -> bool {
        !matches!(self, Path::Piecewise(_) | Path::Table(_))
    }

    /// The t between which the profile exceeds the cutoff, where the track does not break there by itself.
    pub fn window(&self, cutoff: Cutoff) -> Option<[f64; 2]> {
        match self {
            Path::Gaussian(path) => path.window_ends(cutoff.level),
            Path::Triangular(path) => path.window_ends(cutoff.level),
            Path::Uniform | Path::Wave(_) | Path::Piecewise(_) | Path::Table(_) => None,
        }
    }

    /// The track over the whole segment; `threshold`: extinction above which control points glow.
    pub fn track(&self, extent: &WidgetPart, cutoff: Option<Cutoff>, threshold: Option<f64>) -> AnyTrack<'a> {
        match *self {
            Path::Uniform => AnyTrack::Uniform(extent.peak),
            Path::Gaussian(path) => AnyTrack::Gaussian(path.track(extent.peak)),
            Path::Triangular(path) => AnyTrack::Triangular(path),
            Path::Wave(path) => AnyTrack::Wave(path.track(extent.peak, cutoff.map(|c| c.share))),
            Path::Table(path) => AnyTrack::Table(path),
            Path::Piecewise(path) => {
                AnyTrack::Piecewise(PiecewiseTrack { path, scale: extent.scale, threshold })
            }
        }
    }
}

/// A widget's rate along the segment.
#[derive(Debug, Clone, Copy)]
pub enum AnyTrack<'a> {
    /// Constant rate.
    Uniform(f64),
    /// A Gaussian.
    Gaussian(GaussianTrack),
    /// Linear between control points.
    Piecewise(PiecewiseTrack<'a>),
    /// A triangular Gaussian.
    Triangular(TriangularPath),
    /// A triangle or sine wave.
    Wave(WaveTrack),
    /// An image.
    Table(TablePath<'a>),
}

/// Variation of the colour of a track along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackColor {
    /// Not at all: it is the widget's.
    OfWidget,
    /// Linearly between two breaks.
    Linear,
    /// So that two values do not tell what lies between.
    Curved,
}

impl AnyTrack<'_> {
    /// Variation of its colour.
    pub fn color(&self) -> TrackColor {
        match self {
            AnyTrack::Piecewise(_) => TrackColor::Linear,
            AnyTrack::Table(_) => TrackColor::Curved,
            _ => TrackColor::OfWidget,
        }
    }

    /// Its colour at t, where that is not the widget's.
    pub fn color_at(&self, t: f64) -> Option<[f64; 3]> {
        match self {
            AnyTrack::Piecewise(track) => Some(track.path.color(t)),
            AnyTrack::Table(track) => Some(track.color(t)),
            _ => None,
        }
    }

    /// T over [t, t + dt], also where breaks lie within it.
    pub fn depth_over(&self, t: f64, dt: f64) -> f64 {
        match self {
            // Its depth is that of one piece between control points.
            AnyTrack::Piecewise(track) => track.depth_over(t, dt),
            _ => self.depth(t, dt),
        }
    }

    /// True if it may glow on several parts of a segment under the constant-emitter, between which it breaks by itself.
    pub fn glows_in_parts(&self) -> bool {
        matches!(self, AnyTrack::Wave(_) | AnyTrack::Piecewise(_) | AnyTrack::Table(_))
    }
}

impl Track for AnyTrack<'_> {
    fn rate(&self, t: f64) -> f64 {
        match self {
            AnyTrack::Uniform(rate) => *rate,
            AnyTrack::Gaussian(track) => track.rate(t),
            AnyTrack::Piecewise(track) => track.rate(t),
            AnyTrack::Triangular(track) => track.rate(t),
            AnyTrack::Wave(track) => track.rate(t),
            AnyTrack::Table(track) => track.rate(t),
        }
    }

    fn depth(&self, t: f64, dt: f64) -> f64 {
        match self {
            AnyTrack::Uniform(rate) => rate * dt,
            AnyTrack::Gaussian(track) => track.depth(t, dt),
            AnyTrack::Piecewise(track) => track.depth(t, dt),
            AnyTrack::Triangular(track) => track.depth(t, dt),
            AnyTrack::Wave(track) => track.depth(t, dt),
            AnyTrack::Table(track) => track.depth(t, dt),
        }
    }

    fn next_break(&self, t: f64) -> f64 {
        match self {
            AnyTrack::Uniform(_) => f64::INFINITY,
            AnyTrack::Gaussian(track) => track.next_break(t),
            AnyTrack::Piecewise(track) => track.next_break(t),
            AnyTrack::Triangular(track) => track.next_break(t),
            AnyTrack::Wave(track) => track.next_break(t),
            AnyTrack::Table(track) => track.next_break(t),
        }
    }

    fn depths(&self, t: f64, dt: f64) -> [f64; POINTS] {
        match self {
            AnyTrack::Uniform(rate) => GAUSS_12.map(|(x, _)| rate * dt * x),
            AnyTrack::Gaussian(track) => track.depths(t, dt),
            AnyTrack::Piecewise(track) => track.depths(t, dt),
            AnyTrack::Triangular(track) => track.depths(t, dt),
            AnyTrack::Wave(track) => track.depths(t, dt),
            AnyTrack::Table(track) => track.depths(t, dt),
        }
    }
}

/// The fields of a widget over a list of its own, its centre v₀ and K (Kniss et al. 2003, Eq. 11 and 12).
#[derive(Debug, Clone)]
pub(crate) struct Fields {
    /// Indices of its fields among the segment's.
    slots: [usize; MAX_FIELDS],
    count: usize,
    centre: [f64; MAX_FIELDS],
    matrix: [[f64; MAX_FIELDS]; MAX_FIELDS],
}

impl Fields {
    /// `names` are the widget's fields, `fields` those of the segments.
    pub fn new(names: &[String], centre: &[f64], matrix: &[Vec<f64>], fields: &[&str]) -> Self {
        let mut own = Fields {
            slots: [0; MAX_FIELDS],
            count: names.len(),
            centre: [0.0; MAX_FIELDS],
            matrix: [[0.0; MAX_FIELDS]; MAX_FIELDS],
        };
        for (i, name) in names.iter().enumerate() {
            own.slots[i] = slot(name, fields);
            own.centre[i] = centre[i];
            own.matrix[i][..names.len()].copy_from_slice(&matrix[i]);
        }
        own
    }

    /// K (v_f − v₀), K (v_b − v₀), and K (v_b − v_f) from the raw difference; unused components are 0.
    fn ends(&self, segment: &Segment) -> [[f64; MAX_FIELDS]; 3] {
        let mut ends = [[0.0; MAX_FIELDS]; 3];
        for j in 0..self.count {
            let slot = self.slots[j];
            let (f, b) = (segment.fields_front[slot], segment.fields_back[slot]);
            for (end, from) in ends.iter_mut().zip([f - self.centre[j], b - self.centre[j], b - f]) {
                for (end, row) in end.iter_mut().zip(&self.matrix[..self.count]) {
                    *end += row[j] * from;
                }
            }
        }
        ends
    }
}

/// Index of a field among the segments'; the transfer function lists all that its widgets read.
fn slot(name: &str, fields: &[&str]) -> usize {
    fields.iter().position(|field| *field == name).unwrap_or(0)
}
