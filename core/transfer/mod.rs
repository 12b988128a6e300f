//! Transfer functions: widgets over the (s, g) plane (docs/optics.md, section 5).
//!
//! Symbols: s the scalar, g the gradient magnitude, v = (s, g); ρ the extinction coefficient (1/L) =
//! extinction / unit distance × the widget's profile (peak 1); c the widget's linear RGB colour.

mod support;

pub use support::Support;

/// A transfer function: an optical model and a list of widgets, ρ = Σ ρ_i.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// How absorption and glow are related.
    pub model: OpticalModel,
    /// U: the length over which `extinction` is stated, world units, > 0.
    pub unit_distance: f64,
    /// The widgets; none at all draws nothing.
    pub widgets: Vec<Widget>,
}

/// The optical model (docs/optics.md, section 6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OpticalModel {
    /// C = ∫ Σ c_i ρ_i e^(−T) dl (Williams & Max 1992; Max 1995).
    DensityEmitter,
    /// C = ∫ Σ κ_i e^(−T) dl, κ_i = c_i/U where ρ_i > cutoff × its peak (Song et al. 2009, Eq. 4).
    ConstantEmitter {
        /// Share of the peak under which a widget does not glow, in [0, 1).
        cutoff: f64,
    },
}

impl OpticalModel {
    /// The constant-emitter's cutoff.
    pub fn cutoff(self) -> Option<f64> {
        match self {
            OpticalModel::DensityEmitter => None,
            OpticalModel::ConstantEmitter { cutoff } => Some(cutoff),
        }
    }
}

/// One widget.
#[derive(Debug, Clone, PartialEq)]
pub struct Widget {
    /// The profile and its parameters.
    pub profile: Profile,
    /// Linear RGB, ≥ 0, may exceed 1. Unused by piecewise-linear and table widgets, which hold their own.
    pub color: [f64; 3],
    /// Peak extinction per unit distance, ≥ 0.
    pub extinction: f64,
    /// Convex polygon in the (s, g) plane outside which ρ = 0; its boundary belongs to it.
    pub region: Option<Region>,
}

/// A convex polygon in the (s, g) plane, corners in either orientation, at least three.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Corners [s, g].
    pub corners: Vec<[f64; 2]>,
}

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
    /// The same over its own list of 1 … 8 fields. Kniss Eq. 11, 12.
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
    Table(std::sync::Arc<Table>),
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

impl Profile {
    /// The kind's name in pipeline files.
    pub fn name(&self) -> &'static str {
        match self {
            Profile::Uniform => "uniform",
            Profile::Gaussian { .. } => "gaussian",
            Profile::GaussianNd { .. } => "gaussian-nd",
            Profile::TriangularGaussian { .. } => "triangular-gaussian",
            Profile::TriangleWave(_) => "triangle-wave",
            Profile::SineWave(_) => "sine-wave",
            Profile::PiecewiseLinear { .. } => "piecewise-linear",
            Profile::Table(_) => "table",
        }
    }
}

impl Widget {
    /// The same widget with its extinction, or those of its control points, multiplied.
    pub fn with_extinction_times(&self, factor: f64) -> Widget {
        let mut widget = Widget { extinction: self.extinction * factor, ..self.clone() };
        if let Profile::PiecewiseLinear { points } = &mut widget.profile {
            points.iter_mut().for_each(|point| point.extinction *= factor);
        }
        widget
    }

    /// Whether the widget's profile or region depends on the gradient magnitude.
    pub fn uses_gradient_magnitude(&self) -> bool {
        let region = self.region.as_ref().is_some_and(Region::depends_on_g);
        region
            || match &self.profile {
                Profile::Uniform | Profile::GaussianNd { .. } | Profile::PiecewiseLinear { .. } => false,
                Profile::Gaussian { matrix, .. } => matrix[0][1] != 0.0 || matrix[1][1] != 0.0,
                Profile::TriangularGaussian { .. } | Profile::Table(_) => true,
                Profile::TriangleWave(w) | Profile::SineWave(w) => w.angle.sin() * w.scale[1] != 0.0,
            }
    }
}

impl Region {
    /// A rectangle; infinite limits (an axis that was not limited) are allowed.
    pub fn rectangle(s: [f64; 2], g: [f64; 2]) -> Self {
        Region { corners: vec![[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]] }
    }

    /// False for a strip that is limited in s only.
    pub fn depends_on_g(&self) -> bool {
        self.corners.iter().any(|c| c[1].is_finite())
    }
}

impl TransferFunction {
    /// Whether any widget looks at the gradient magnitude.
    pub fn uses_gradient_magnitude(&self) -> bool {
        self.widgets.iter().any(Widget::uses_gradient_magnitude)
    }

    /// The centre along an axis (0: s, 1: g), if there is a single one: offsets are then taken from it in 64 bits, so
    /// that a widget far narrower than the range loses nothing.
    ///
    /// Widths of triangular Gaussians are shares of g itself: it is counted from 0 where they need its small values.
    pub fn single_centre(&self, axis: usize) -> Option<f64> {
        let triangular = |widget: &Widget| matches!(widget.profile, Profile::TriangularGaussian { .. });
        if axis == 1 && self.widgets.iter().any(triangular) {
            return Some(0.0);
        }
        match self.widgets.as_slice() {
            [widget] => match &widget.profile {
                Profile::Gaussian { centre, .. } => centre.get(axis).copied(),
                Profile::TriangularGaussian { centre, .. } if axis == 0 => Some(*centre),
                _ => None,
            },
            _ => None,
        }
    }

    /// Names of further point arrays that the widgets look at.
    pub fn fields(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for widget in &self.widgets {
            if let Profile::GaussianNd { fields, .. } = &widget.profile {
                names.extend(fields.iter().map(String::as_str));
            }
        }
        names.sort_unstable();
        names.dedup();
        names
    }
}
