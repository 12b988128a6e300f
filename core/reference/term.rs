//! One widget, evaluated point by point, and where along a straight path through the (s, g) plane it changes.
//!
//! Every profile is a function of a few coordinates that are linear along the path; they are formed as
//! differences from the widget's own centre before anything else, so that values near 1e8 that vary by 1e-2
//! keep their digits. Symbols as in docs/optics.md, section 5.

use super::along::{Along, quadratic_crossings};
use super::side::{Side, sides_of};
use crate::transfer::{ControlPoint, Profile, Table, Wave, Widget};
use crate::{Error, Result};
use std::f64::consts::PI;
use std::sync::Arc;

/// More bands than this in one cell are refused rather than drawn for hours.
const BANDS_AT_MOST: f64 = 1e6;

/// One widget made ready.
pub(super) struct Term {
    shape: Shape,
    /// Extinction / unit distance, 1/L.
    peak: f64,
    color: [f64; 3],
    /// Half planes whose intersection is the region.
    pub(super) sides: Vec<Side>,
}

enum Shape {
    Uniform,
    /// Coordinates: K (v − v0).
    Gaussian {
        columns: Vec<usize>,
        centre: Vec<f64>,
        matrix: Vec<Vec<f64>>,
    },
    /// Coordinates: s − s0, σ g.
    Triangular {
        centre: f64,
        sigma: f64,
    },
    /// Coordinate: φ − ½, so that peaks lie at whole numbers.
    Bands {
        wave: Wave,
        sine: bool,
    },
    /// Coordinate: s − (first control point).
    Linear {
        points: Vec<ControlPoint>,
        peak: f64,
    },
    /// Coordinates: texel column and row, 0 at the first centre; distances inside the four range ends.
    Table(Arc<Table>),
}

impl Term {
    /// `fields` are the names of the point quantities that follow s and g in a value.
    pub(super) fn new(widget: &Widget, unit_distance: f64, fields: &[&str]) -> Result<Self> {
        let shape = match &widget.profile {
            Profile::Uniform => Shape::Uniform,
            Profile::Gaussian { centre, matrix } => Shape::Gaussian {
                columns: vec![0, 1],
                centre: centre.to_vec(),
                matrix: matrix.iter().map(|row| row.to_vec()).collect(),
            },
            Profile::GaussianNd { fields: own, centre, matrix } => {
                let column = |name: &String| fields.iter().position(|f| f == name).map(|k| k + 2);
                let columns: Option<Vec<usize>> = own.iter().map(column).collect();
                let columns = columns.ok_or_else(|| {
                    Error::usage("a gaussian-nd widget names a field that is not at hand")
                        .found(own.join(", "))
                })?;
                let n = columns.len();
                if centre.len() != n || matrix.len() != n || matrix.iter().any(|row| row.len() != n) {
                    return Err(Error::usage(
                        "a gaussian-nd widget's centre or matrix has not its fields' number",
                    )
                    .accepted(format!("{n} numbers and {n} × {n} numbers")));
                }
                Shape::Gaussian { columns, centre: centre.clone(), matrix: matrix.clone() }
            }
            Profile::TriangularGaussian { centre, sigma } => {
                Shape::Triangular { centre: *centre, sigma: *sigma }
            }
            Profile::TriangleWave(wave) => Shape::Bands { wave: *wave, sine: false },
            Profile::SineWave(wave) => Shape::Bands { wave: *wave, sine: true },
            Profile::PiecewiseLinear { points } => {
                if points.is_empty() {
                    return Err(Error::usage("a piecewise-linear widget has no control points"));
                }
                let peak = points.iter().map(|p| p.extinction).fold(0.0, f64::max);
                Shape::Linear { points: points.clone(), peak }
            }
            Profile::Table(table) => Shape::Table(table.clone()),
        };
        let extinction = match &shape {
            Shape::Linear { .. } => 1.0,
            _ => widget.extinction,
        };
        let sides = match &widget.region {
            Some(region) => sides_of(region)?,
            None if matches!(shape, Shape::Uniform) => {
                return Err(Error::usage("a uniform widget has no region"));
            }
            None => Vec::new(),
        };
        Ok(Term { shape, peak: extinction / unit_distance, color: widget.color, sides })
    }

    /// Appends the coordinates along the path from `front` to `back` (each [s, g, fields …]).
    pub(super) fn coordinates(&self, front: &[f64], back: &[f64], out: &mut Vec<Along>) {
        let mut push = |f: f64, b: f64| out.push(Along { front: f, back: b });
        match &self.shape {
            Shape::Uniform => {}
            Shape::Gaussian { columns, centre, matrix } => {
                for row in matrix {
                    let q = |v: &[f64]| -> f64 {
                        row.iter().zip(columns).zip(centre).map(|((k, &c), v0)| k * (v[c] - v0)).sum()
                    };
                    push(q(front), q(back));
                }
            }
            Shape::Triangular { centre, sigma } => {
                push(front[0] - centre, back[0] - centre);
                push(sigma * front[1], sigma * back[1]);
            }
            Shape::Bands { wave, .. } => {
                let (sin, cos) = wave.angle.sin_cos();
                let phase = |v: &[f64]| {
                    let along_s = (v[0] - wave.origin[0]) * cos * wave.scale[0];
                    (along_s + (v[1] - wave.origin[1]) * sin * wave.scale[1]) / wave.period - 0.5
                };
                push(phase(front), phase(back));
            }
            Shape::Linear { points, .. } => push(front[0] - points[0].s, back[0] - points[0].s),
            Shape::Table(table) => {
                let ([sa, sb], [ga, gb]) = (table.s, table.g);
                let (w, h) = (table.width as f64, table.height as f64);
                let column = |v: &[f64]| (v[0] - sa) * w / (sb - sa) - 0.5;
                let row = |v: &[f64]| (gb - v[1]) * h / (gb - ga) - 0.5;
                push(column(front), column(back));
                push(row(front), row(back));
            }
        }
    }

    /// Appends the places t in (0, 1) where the profile has its peaks, kinks and steps, or leaves a width of
    /// its centre; with a cutoff also where the profile passes it.
    pub(super) fn features(&self, along: &[Along], cutoff: Option<f64>, out: &mut Vec<f64>) -> Result<()> {
        match &self.shape {
            Shape::Uniform => {}
            Shape::Gaussian { .. } => gaussian_features(along, cutoff, out),
            Shape::Triangular { .. } => {
                let [offset, width] = [along[0], along[1]];
                width.level(0.0, out);
                let cut = cutoff.map(|c| (-c.ln()).sqrt());
                for x in [0.0, 1.0, 2.0, 3.0, 4.5, 6.5, 9.0, 13.0, 26.0].into_iter().chain(cut) {
                    for x in [x, -x] {
                        let line = Along {
                            front: offset.front - x * width.front,
                            back: offset.back - x * width.back,
                        };
                        line.level(0.0, out);
                    }
                }
            }
            Shape::Bands { wave, sine } => {
                let phase = along[0];
                let low = phase.front.min(phase.back).round();
                let high = phase.front.max(phase.back).round();
                if high - low > BANDS_AT_MOST {
                    return Err(Error::run("a cell holds more bands of a wave widget than are drawn")
                        .found(format!("{:.3e} bands", high - low))
                        .accepted(format!("at most {BANDS_AT_MOST:.0e}")));
                }
                let half_width = |height: f64| {
                    let below = wave.band_width * (1.0 - height);
                    if *sine { (0.5 * below).sqrt().asin() * 2.0 / PI } else { 0.5 * below }
                };
                let cut = cutoff.map(half_width);
                for band in 0..=(high - low) as u64 {
                    let peak = low + band as f64;
                    phase.level(peak, out);
                    phase.level(peak + 0.5, out);
                    for half in [Some(half_width(0.0)), cut].into_iter().flatten() {
                        phase.level(peak - half, out);
                        phase.level(peak + half, out);
                    }
                }
            }
            Shape::Linear { points, peak } => {
                let at = |p: &ControlPoint| p.s - points[0].s;
                for point in points {
                    along[0].level(at(point), out);
                }
                let level = cutoff.unwrap_or(0.0) * peak;
                for pair in points.windows(2).filter(|_| cutoff.is_some()) {
                    let (e0, e1) = (pair[0].extinction, pair[1].extinction);
                    if (e0 > level) != (e1 > level) {
                        let share = (level - e0) / (e1 - e0);
                        along[0].level(at(&pair[0]) + share * (pair[1].s - pair[0].s), out);
                    }
                }
            }
            Shape::Table(table) => table_features(table, along, cutoff, out),
        }
        Ok(())
    }

    /// Moves the coordinates of a short stretch to where they have the most digits (waves: whole bands off).
    pub(super) fn localise(&self, along: &mut [Along]) {
        if let Shape::Bands { .. } = self.shape {
            let whole = along[0].at(0.5).round();
            along[0] = Along { front: along[0].front - whole, back: along[0].back - whole };
        }
    }

    /// Share of the peak extinction at a point, which the cutoff of the constant-emitter model looks at.
    pub(super) fn share_of_peak(&self, x: &[f64]) -> f64 {
        match &self.shape {
            Shape::Linear { points, peak } if *peak > 0.0 => linear(points, x[0]).0 / peak,
            Shape::Linear { .. } => 0.0,
            _ if self.peak == 0.0 => 0.0,
            _ => self.profile(x).0,
        }
    }

    /// ρ (1/L) and linear RGB at a point.
    pub(super) fn sample(&self, x: &[f64]) -> (f64, [f64; 3]) {
        let (profile, color) = self.profile(x);
        (self.peak * profile, color)
    }

    fn profile(&self, x: &[f64]) -> (f64, [f64; 3]) {
        let profile = match &self.shape {
            Shape::Uniform => 1.0,
            Shape::Gaussian { .. } => (-x.iter().map(|q| q * q).sum::<f64>()).exp(),
            Shape::Triangular { .. } if x[1] > 0.0 => (-(x[0] / x[1]).powi(2)).exp(),
            Shape::Triangular { .. } => 0.0,
            Shape::Bands { wave, sine } => {
                let from_peak = x[0] - x[0].round();
                // 1 − the profile without band width; |sin πφ| is cos π(φ − ½) there.
                let below =
                    if *sine { 2.0 * (0.5 * PI * from_peak).sin().powi(2) } else { 2.0 * from_peak.abs() };
                (1.0 - below / wave.band_width).max(0.0)
            }
            Shape::Linear { points, .. } => return linear(points, x[0]),
            Shape::Table(table) => return texels(table, x),
        };
        (profile, self.color)
    }
}

/// Places around the point nearest to the centre, by widths, and where |q|² passes −ln cutoff.
fn gaussian_features(along: &[Along], cutoff: Option<f64>, out: &mut Vec<f64>) {
    let step = |a: &Along| a.back - a.front;
    let square: f64 = along.iter().map(|a| step(a).powi(2)).sum();
    let length = square.sqrt();
    if length == 0.0 || length.is_nan() {
        return;
    }
    let nearest = -along.iter().map(|a| a.front * step(a)).sum::<f64>() / square;
    let mut push = |t: f64| {
        if t > 0.0 && t < 1.0 {
            out.push(t);
        }
    };
    // A stretch of less than a width and a half is smooth enough as it is.
    if length > 1.5 {
        push(nearest);
        let mut widths = 1.5;
        while widths / length < 1.0 + nearest.abs() && widths < 1e4 {
            push(nearest - widths / length);
            push(nearest + widths / length);
            widths = if widths < 4.0 { widths + 1.5 } else { widths * 1.45 };
        }
    }
    if let Some(cutoff) = cutoff {
        let reach = -cutoff.ln();
        if (-1.0..=2.0).contains(&nearest) {
            let apart: f64 = along.iter().map(|a| a.at(nearest).powi(2)).sum();
            if apart < reach {
                let half = (reach - apart).sqrt() / length;
                push(nearest - half);
                push(nearest + half);
            }
        } else {
            let slope: f64 = along.iter().map(|a| a.front * step(a)).sum();
            let offset = along.iter().map(|a| a.front * a.front).sum::<f64>() - reach;
            quadratic_crossings(square, slope, offset, push);
        }
    }
}

/// Lines of texel centres, range ends, and where the bilinear alpha passes the cutoff.
fn table_features(table: &Table, along: &[Along], cutoff: Option<f64>, out: &mut Vec<f64>) {
    let first = out.len();
    for (axis, count) in [(along[0], table.width), (along[1], table.height)] {
        axis.level(-0.5, out);
        axis.level(count as f64 - 0.5, out);
        let low = axis.front.min(axis.back).max(0.0).floor() as usize;
        let high = axis.front.max(axis.back).max(0.0).min(count as f64).ceil() as usize;
        for line in low..=high {
            axis.level(line as f64, out);
        }
    }
    let Some(cutoff) = cutoff else { return };
    // Between those places alpha is a quadratic polynomial of t; three values give it.
    let mut ends = vec![0.0, 1.0];
    ends.extend_from_slice(&out[first..]);
    ends.sort_unstable_by(f64::total_cmp);
    for pair in ends.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let above = |u: f64| {
            let t = a + (b - a) * u;
            texels(table, &[along[0].at(t), along[1].at(t)]).0 - cutoff
        };
        // Inner points only: at the ends a step may belong to the other side.
        let (p, q, r) = (above(0.25), above(0.5), above(0.75));
        let square = 8.0 * (p - 2.0 * q + r);
        let slope = 2.0 * (r - p) - square;
        let offset = q - 0.25 * square - 0.5 * slope;
        quadratic_crossings(square, 0.5 * slope, offset, |u| {
            if u > 0.0 && u < 1.0 {
                out.push(a + (b - a) * u);
            }
        });
    }
}

/// Extinction and colour of a piecewise-linear widget at `x` = s − (first point).
fn linear(points: &[ControlPoint], x: f64) -> (f64, [f64; 3]) {
    let at = |k: usize| points[k].s - points[0].s;
    let after = points.partition_point(|p| p.s - points[0].s <= x);
    if after == 0 {
        return (points[0].extinction, points[0].color);
    }
    let (low, last) = (after - 1, points.len() - 1);
    if low == last {
        return (points[last].extinction, points[last].color);
    }
    let share = (x - at(low)) / (at(after) - at(low));
    let mix = |a: f64, b: f64| a * (1.0 - share) + b * share;
    let (p, q) = (&points[low], &points[after]);
    (mix(p.extinction, q.extinction), std::array::from_fn(|c| mix(p.color[c], q.color[c])))
}

/// Alpha and colour of a table at fractional column x[0] and row x[1].
fn texels(table: &Table, x: &[f64]) -> (f64, [f64; 3]) {
    let (w, h) = (table.width, table.height);
    let inside = |v: f64, count: usize| (-0.5..=count as f64 - 0.5).contains(&v);
    if !inside(x[0], w) || !inside(x[1], h) {
        return (0.0, [0.0; 3]);
    }
    let split = |v: f64, count: usize| {
        let v = v.clamp(0.0, (count - 1) as f64);
        let low = (v.floor() as usize).min(count.saturating_sub(2));
        (low, (low + 1).min(count - 1), v - low as f64)
    };
    let ((i0, i1, u), (j0, j1, v)) = (split(x[0], w), split(x[1], h));
    let channel = |c: usize| {
        let texel = |i: usize, j: usize| f64::from(table.texels[j * w + i][c]);
        let upper = texel(i0, j0) * (1.0 - u) + texel(i1, j0) * u;
        let lower = texel(i0, j1) * (1.0 - u) + texel(i1, j1) * u;
        upper * (1.0 - v) + lower * v
    };
    (channel(3), [channel(0), channel(1), channel(2)])
}
