//! What a cell can contribute at most: the culling test.
//!
//! The papers look at the four vertices only, which drops a cell whose vertices straddle a narrow widget.
//! Here every bound is one over the convex hull of the four (s, g) points, within which the cell's values
//! lie, so a cell that is left out could not have changed a pixel by more than the bound times its length.

mod hull;
mod maximum_table;

use super::{ControlPoint, OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use crate::Result;
use crate::optics::Prepared;
use crate::optics::clip::Clip;
use hull::{distance_squared_from_origin, meets};
use maximum_table::MaximumTable;

/// Bounds of all widgets of a transfer function over cells.
#[derive(Debug, Clone)]
pub struct Support {
    widgets: Vec<WidgetSupport>,
}

#[derive(Debug, Clone)]
struct WidgetSupport {
    shape: Shape,
    clip: Option<Clip>,
    /// The most that a profile of 1 absorbs or emits per world unit.
    strength: f64,
    /// Constant-emitter: where the profile can exceed the cutoff, the widget emits this per world unit.
    glow: Option<Glow>,
}

#[derive(Debug, Clone, Copy)]
struct Glow {
    cutoff: f64,
    brightest: f64,
}

#[derive(Debug, Clone)]
enum Shape {
    Uniform,
    /// K looks at one axis only: the distance is that of an interval.
    Gaussian1d {
        axis: usize,
        centre: f64,
        width: f64,
    },
    Gaussian {
        centre: [f64; 2],
        matrix: [[f64; 2]; 2],
    },
    GaussianNd {
        slots: Vec<usize>,
        centre: Vec<f64>,
        matrix: Vec<Vec<f64>>,
    },
    TriangularGaussian {
        centre: f64,
        sigma: f64,
    },
    Wave {
        origin: [f64; 2],
        step: [f64; 2],
        band_width: f64,
        sine: bool,
    },
    Piecewise {
        points: Vec<ControlPoint>,
        peak: f64,
    },
    Table(MaximumTable),
}

impl Support {
    /// Checks the transfer function and makes its bounds ready.
    pub fn new(transfer_function: &TransferFunction) -> Result<Support> {
        Prepared::new(transfer_function)?;
        let fields = transfer_function.fields();
        let widgets = transfer_function
            .widgets
            .iter()
            .map(|widget| WidgetSupport::new(widget, transfer_function, &fields))
            .collect::<Result<_>>()?;
        Ok(Support { widgets })
    }

    /// The most that a ray can lose or gain per world unit inside a cell: an upper bound, over the convex
    /// hull of the vertices' values, of ρ, of Σ cᵢ ρᵢ and of Σ κᵢ.
    ///
    /// `s` and `g` are the vertices' values; `fields` the further fields in the order of
    /// [`TransferFunction::fields`], or empty if unknown: then a gaussian-nd widget counts as everywhere.
    pub fn bound(&self, s: &[f64; 4], g: &[f64; 4], fields: &[[f64; 4]]) -> f64 {
        self.widgets.iter().map(|widget| widget.bound(s, g, fields)).sum()
    }

    /// Whether the cell can contribute more than `least` per world unit. With `least` = 1e-6 divided by the
    /// grid's diameter no pixel changes by more than 1e-6 when all other cells are left out.
    pub fn touches(&self, s: &[f64; 4], g: &[f64; 4], fields: &[[f64; 4]], least: f64) -> bool {
        // If the sum exceeds `least`, some widget exceeds its share of it.
        let share = least / self.widgets.len() as f64;
        self.widgets.iter().any(|widget| widget.touches(s, g, fields, share))
    }

    /// Whether one widget's share of [`Support::touches`] is exceeded.
    pub fn widget_touches(
        &self,
        widget: usize,
        s: &[f64; 4],
        g: &[f64; 4],
        fields: &[[f64; 4]],
        least: f64,
    ) -> bool {
        self.widgets[widget].touches(s, g, fields, least / self.widgets.len() as f64)
    }
}

impl Widget {
    /// An upper bound of the profile (peak 1) over the convex hull of four points of the (s, g) plane; 0
    /// where the hull is outside the region. To ask this of many cells, make a [`Support`] once.
    pub fn profile_bound(&self, s: &[f64; 4], g: &[f64; 4]) -> Result<f64> {
        let clip = self.region.as_ref().map(Region::clip).transpose()?;
        let widget = WidgetSupport { shape: Shape::new(self, &[]), clip, strength: 1.0, glow: None };
        Ok(widget.profile_bound(s, g, &[]))
    }
}

impl Region {
    fn clip(&self) -> Result<Clip> {
        Clip::new(self)
    }
}

impl WidgetSupport {
    fn new(widget: &Widget, transfer_function: &TransferFunction, fields: &[&str]) -> Result<Self> {
        let shape = Shape::new(widget, fields);
        let (peak, brightest) = match &widget.profile {
            Profile::PiecewiseLinear { points } => (
                points.iter().map(|p| p.extinction).fold(0.0, f64::max),
                points.iter().flat_map(|p| p.color).fold(0.0, f64::max),
            ),
            Profile::Table(table) => (
                widget.extinction,
                table.texels.iter().flat_map(|t| [t[0], t[1], t[2]]).fold(0.0, f32::max).into(),
            ),
            _ => (widget.extinction, widget.color.into_iter().fold(0.0, f64::max)),
        };
        let per_length = peak / transfer_function.unit_distance;
        let (strength, glow) = match transfer_function.model {
            OpticalModel::DensityEmitter => (per_length * brightest.max(1.0), None),
            OpticalModel::ConstantEmitter { cutoff } => {
                let glow = Glow { cutoff, brightest: brightest / transfer_function.unit_distance };
                (per_length, (peak > 0.0).then_some(glow))
            }
        };
        Ok(WidgetSupport {
            shape,
            clip: widget.region.as_ref().map(Region::clip).transpose()?,
            strength,
            glow,
        })
    }

    #[inline]
    fn bound(&self, s: &[f64; 4], g: &[f64; 4], fields: &[[f64; 4]]) -> f64 {
        let profile = self.profile_bound(s, g, fields);
        let absorbed = self.strength * profile;
        match self.glow {
            Some(glow) if profile > glow.cutoff => absorbed.max(glow.brightest),
            _ => absorbed,
        }
    }

    /// Whether the bound exceeds `least`; true also for values that are not numbers, which are not this test's
    /// business.
    #[inline]
    fn touches(&self, s: &[f64; 4], g: &[f64; 4], fields: &[[f64; 4]], least: f64) -> bool {
        let Shape::Gaussian { centre, matrix } = &self.shape else {
            let bound = self.bound(s, g, fields);
            return bound > least || bound.is_nan();
        };
        // Compared by squared distance, without an exponential.
        let mut level = (self.strength / least).ln();
        if let Some(glow) = self.glow.filter(|glow| glow.brightest > least) {
            level = level.max(-glow.cutoff.ln());
        }
        let level = level + ROUNDING * (1.0 + level.abs());
        let points = scaled(centre, matrix, s, g);
        let axis = |i: usize| {
            let (low, high) = range(&points.map(|p| p[i]));
            low.max(-high).max(0.0)
        };
        let (x, y) = (axis(0), axis(1));
        if x * x + y * y > level {
            return false;
        }
        let vertex = points.iter().any(|p| p[0] * p[0] + p[1] * p[1] <= level);
        let far = !vertex && distance_squared_from_origin(&points) * (1.0 - ROUNDING) > level;
        !far && self.clip.as_ref().is_none_or(|clip| meets(clip, s, g))
    }

    #[inline]
    fn profile_bound(&self, s: &[f64; 4], g: &[f64; 4], fields: &[[f64; 4]]) -> f64 {
        if let Some(clip) = &self.clip
            && !meets(clip, s, g)
        {
            return 0.0;
        }
        self.shape.bound(s, g, fields)
    }
}

/// Exact bounds are raised by this, so that rounding never makes them too low.
const ROUNDING: f64 = 1e-12;

/// K (v − centre) of four points.
#[inline]
fn scaled(centre: &[f64; 2], matrix: &[[f64; 2]; 2], s: &[f64; 4], g: &[f64; 4]) -> [[f64; 2]; 4] {
    std::array::from_fn(|i| {
        let (ds, dg) = (s[i] - centre[0], g[i] - centre[1]);
        matrix.map(|row| row[0] * ds + row[1] * dg)
    })
}

#[inline]
fn gaussian(distance_squared: f64) -> f64 {
    (-distance_squared * (1.0 - ROUNDING)).exp()
}

#[inline]
fn range(values: &[f64; 4]) -> (f64, f64) {
    (
        values[0].min(values[1]).min(values[2].min(values[3])),
        values[0].max(values[1]).max(values[2].max(values[3])),
    )
}

impl Shape {
    fn new(widget: &Widget, names: &[&str]) -> Shape {
        match &widget.profile {
            Profile::Uniform => Shape::Uniform,
            Profile::Gaussian { centre, matrix } => {
                let norm = |axis: usize| matrix[0][axis].hypot(matrix[1][axis]);
                if norm(1) == 0.0 {
                    Shape::Gaussian1d { axis: 0, centre: centre[0], width: norm(0) }
                } else if norm(0) == 0.0 {
                    Shape::Gaussian1d { axis: 1, centre: centre[1], width: norm(1) }
                } else {
                    Shape::Gaussian { centre: *centre, matrix: *matrix }
                }
            }
            Profile::GaussianNd { fields, centre, matrix } => Shape::GaussianNd {
                slots: fields
                    .iter()
                    .map(|f| names.iter().position(|n| n == f).unwrap_or(usize::MAX))
                    .collect(),
                centre: centre.clone(),
                matrix: matrix.clone(),
            },
            Profile::TriangularGaussian { centre, sigma } => {
                Shape::TriangularGaussian { centre: *centre, sigma: *sigma }
            }
            Profile::TriangleWave(wave) => Shape::wave(wave, false),
            Profile::SineWave(wave) => Shape::wave(wave, true),
            Profile::PiecewiseLinear { points } => Shape::Piecewise {
                points: points.clone(),
                peak: points.iter().map(|p| p.extinction).fold(0.0, f64::max),
            },
            Profile::Table(table) => Shape::Table(MaximumTable::new(table)),
        }
    }

    fn wave(wave: &Wave, sine: bool) -> Shape {
        let step =
            [wave.angle.cos() * wave.scale[0] / wave.period, wave.angle.sin() * wave.scale[1] / wave.period];
        Shape::Wave { origin: wave.origin, step, band_width: wave.band_width, sine }
    }

    fn bound(&self, s: &[f64; 4], g: &[f64; 4], fields: &[[f64; 4]]) -> f64 {
        match self {
            Shape::Uniform => 1.0,
            Shape::Gaussian1d { axis, centre, width } => {
                let (low, high) = range(if *axis == 0 { s } else { g });
                let distance = (low - centre).max(centre - high).max(0.0) * width;
                gaussian(distance * distance)
            }
            Shape::Gaussian { centre, matrix } => {
                gaussian(distance_squared_from_origin(&scaled(centre, matrix, s, g)))
            }
            Shape::GaussianNd { slots, centre, matrix } => nd_bound(slots, centre, matrix, fields),
            Shape::TriangularGaussian { centre, sigma } => {
                // |s − s₀|/(σ g) is a ratio of linear functions: its least value over the hull is at a vertex
                // unless s − s₀ changes sign.
                let (low, high) = range(s);
                if range(g).1 <= 0.0 {
                    return 0.0;
                }
                if low <= *centre && *centre <= high {
                    return 1.0;
                }
                let nearest = (0..4)
                    .filter(|&i| g[i] > 0.0)
                    .map(|i| (s[i] - centre).abs() / (sigma * g[i]))
                    .fold(f64::INFINITY, f64::min);
                gaussian(nearest * nearest)
            }
            Shape::Wave { origin, step, band_width, sine } => {
                let phases =
                    std::array::from_fn(|i| (s[i] - origin[0]) * step[0] + (g[i] - origin[1]) * step[1]);
                let (low, high) = range(&phases);
                let slack = ROUNDING * (1.0 + low.abs().max(high.abs()));
                wave_bound(low - slack, high + slack, *band_width, *sine)
            }
            Shape::Piecewise { points, peak } => {
                let (low, high) = range(s);
                let first = points.partition_point(|p| p.s < low);
                let last = points.partition_point(|p| p.s <= high);
                let inside = points[first..last].iter().map(|p| p.extinction).fold(0.0, f64::max);
                let most = inside.max(extinction_at(points, low)).max(extinction_at(points, high));
                if *peak > 0.0 { most / peak } else { 0.0 }
            }
            Shape::Table(table) => table.bound(range(s), range(g)),
        }
    }
}

/// A direction that separates the four points from the centre bounds the distance from below.
fn nd_bound(slots: &[usize], centre: &[f64], matrix: &[Vec<f64>], fields: &[[f64; 4]]) -> f64 {
    if slots.iter().any(|&slot| slot >= fields.len()) {
        return 1.0;
    }
    let n = slots.len();
    let mut q = [[0.0; 4]; 8];
    for i in 0..n {
        for j in 0..n {
            for v in 0..4 {
                q[i][v] += matrix[i][j] * (fields[slots[j]][v] - centre[j]);
            }
        }
    }
    let mean: [f64; 8] = std::array::from_fn(|i| q[i].iter().sum::<f64>());
    let length = mean.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0 || length.is_nan() {
        return 1.0;
    }
    let along = |v: usize| (0..n).map(|i| q[i][v] * mean[i]).sum::<f64>() / length;
    let distance = (0..4).map(along).fold(f64::INFINITY, f64::min).max(0.0);
    gaussian(distance * distance)
}

/// The most of a wave's profile over the phases [low, high].
fn wave_bound(low: f64, high: f64, band_width: f64, sine: bool) -> f64 {
    // Distance of the nearest peak, a half-integer.
    let peak_passed = (high - 0.5).floor() >= (low - 0.5).ceil();
    if peak_passed {
        return 1.0;
    }
    let off_peak = |phase: f64| (phase - (phase - 0.5).round() - 0.5).abs();
    let away = off_peak(low).min(off_peak(high)).min(0.5);
    let full = if sine { (std::f64::consts::PI * away).cos() } else { 1.0 - 2.0 * away };
    (1.0 - (1.0 - full) / band_width).max(0.0)
}

fn extinction_at(points: &[ControlPoint], s: f64) -> f64 {
    let after = points.partition_point(|p| p.s <= s);
    match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
        (Some(low), Some(high)) => {
            let x = (s - low.s) / (high.s - low.s);
            low.extinction + (high.extinction - low.extinction) * x
        }
        (Some(only), None) => only.extinction,
        (None, Some(only)) => only.extinction,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests;
