//! The ellipses that Gaussians are in the plane, and Gaussians over s and g as a file states them.

use crate::transfer::plane::{Change, Handle, Plane, WidgetPainter, list, rounded, rows};
use eframe::egui::{self, Color32, Stroke};
use std::f64::consts::TAU;
use voltet_core::arithmetic::decimal;

/// Position of the handle of a turned axis (half axes).
const ARM: f64 = 1.7;

const ROUND: u32 = 72;

/// Its middle and its two half axes at one standard deviation; an infinite one ignores its axis.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct Ellipse {
    pub centre: [f64; 2],
    pub axes: [[f64; 2]; 2],
}

impl Ellipse {
    /// Ellipse of exp(−|K v|²) about a centre, along two columns of K. `extent`: lengths along the axes that are equal
    /// on the screen, where the half axes are at right angles. The first is the one that its own row of K is about, as
    /// [`spread`] writes it: so the ring stays where it was dragged to.
    pub fn new(centre: [f64; 2], k: &[Vec<f64>], columns: [Option<usize>; 2], extent: [f64; 2]) -> Ellipse {
        let [a, b] = half_axes(metric(k, columns), extent);
        let row = k.get(columns[0].unwrap_or(0));
        let entry = |column: Option<usize>| row.zip(column).map_or(0.0, |(row, column)| row[column]);
        let along = |axis: [f64; 2]| {
            let part = |i: usize| if axis[i] == 0.0 { 0.0 } else { entry(columns[i]) * axis[i] };
            part(0) + part(1)
        };
        let turned = |axis: [f64; 2]| axis.map(|x| if x == 0.0 { 0.0 } else { -x });
        let axes = if along(a).abs() >= along(b).abs() { [a, b] } else { [b, turned(a)] };
        Ellipse { centre, axes: if along(axes[0]) < 0.0 { axes.map(turned) } else { axes } }
    }

    pub fn handles(&self) -> Vec<(Handle, [f64; 2])> {
        let Ellipse { centre, axes } = self;
        let mut handles = vec![(Handle::Centre, *centre)];
        let finite = |axis: &[f64; 2]| axis.iter().all(|x| x.is_finite());
        for (i, axis) in axes.iter().enumerate().filter(|(_, axis)| finite(axis)) {
            handles.push((Handle::Width(i), [centre[0] + axis[0], centre[1] + axis[1]]));
        }
        if axes.iter().all(finite) {
            handles.push((Handle::Angle, self.arm()));
        }
        handles
    }

    fn arm(&self) -> [f64; 2] {
        [0, 1].map(|k: usize| self.centre[k] + ARM * self.axes[0][k])
    }

    /// The half axes when the handle of one, or that of the angle, is brought to a place; `None` of other handles.
    pub fn stretched(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Option<[[f64; 2]; 2]> {
        let Ellipse { centre, axes } = self;
        let extent = plane.extent;
        match handle {
            Handle::Width(i) => {
                let v = [(to[0] - centre[0]) / extent[0], (to[1] - centre[1]) / extent[1]];
                let own = [axes[i][0] / extent[0], axes[i][1] / extent[1]];
                let length = own[0].hypot(own[1]);
                let share = (v[0] * own[0] + v[1] * own[1]).abs() / (length * length);
                let mut after = *axes;
                after[i] = after[i].map(|x| x * share.max(1e-6));
                Some(after)
            }
            Handle::Angle => Some(turned(*axes, [to[0] - centre[0], to[1] - centre[1]], extent)),
            _ => None,
        }
    }

    /// At one and at two standard deviations.
    pub fn draw(&self, pen: &WidgetPainter) {
        let Ellipse { centre, axes } = self;
        let stroke = pen.stroke;
        let infinite = axes.iter().position(|axis| axis.iter().any(|x| !x.is_finite()));
        for times in [1.0, 2.0] {
            let thin = Stroke::new(stroke.width / times as f32, stroke.color);
            let fill = if times == 1.0 {
                stroke.color.gamma_multiply(if pen.is_chosen { 0.12 } else { 0.05 })
            } else {
                Color32::TRANSPARENT
            };
            match infinite {
                None => {
                    let at = |t: f64| {
                        let (sin, cos) = t.sin_cos();
                        let along = |k: usize| centre[k] + times * (cos * axes[0][k] + sin * axes[1][k]);
                        pen.plane.to_window([along(0), along(1)])
                    };
                    let points = (0..ROUND).map(|i| at(TAU * f64::from(i) / f64::from(ROUND))).collect();
                    pen.painter.add(egui::Shape::convex_polygon(points, fill, thin));
                }
                // A band along the axis that is ignored.
                Some(ignored) => {
                    let kept = 1 - ignored;
                    let width = times * axes[kept][kept];
                    let mut limits = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
                    if width.is_finite() {
                        limits[kept] = [centre[kept] - width, centre[kept] + width];
                    }
                    pen.rectangle(limits, thin, fill);
                }
            }
        }
        if infinite.is_none() && pen.is_chosen {
            let ends = [*centre, self.arm()].map(|at| pen.plane.to_window(at));
            pen.painter.line_segment(ends, Stroke::new(1.0, stroke.color.gamma_multiply(0.6)));
        }
    }
}

/// Half axes as long as before, the first of them in a direction.
fn turned(axes: [[f64; 2]; 2], towards: [f64; 2], extent: [f64; 2]) -> [[f64; 2]; 2] {
    let lengths = axes.map(|axis| (axis[0] / extent[0]).hypot(axis[1] / extent[1]));
    let angle = (towards[1] / extent[1]).atan2(towards[0] / extent[0]);
    // Upright again within two degrees.
    let quarter = std::f64::consts::FRAC_PI_2;
    let near = (angle / quarter).round() * quarter;
    let angle = if (angle - near).abs() < 0.035 { near } else { angle };
    let (sin, cos) = angle.sin_cos();
    let directions = [[cos, sin], [-sin, cos]];
    [0, 1].map(|i| [0, 1].map(|k: usize| directions[i][k] * lengths[i] * extent[k]))
}

/// Half axes of the Gaussian exp(−p x² − 2 r x y − q y²), at right angles in the plane where both extents are equally long.
fn half_axes([p, r, q]: [f64; 3], extent: [f64; 2]) -> [[f64; 2]; 2] {
    let (p, r, q) = (p * extent[0] * extent[0], r * extent[0] * extent[1], q * extent[1] * extent[1]);
    let (sin, cos) = (0.5 * (2.0 * r).atan2(p - q)).sin_cos();
    let (sin, cos) = if r == 0.0 { (0.0, 1.0) } else { (sin, cos) };
    let length = |x: f64, y: f64| (0.5 / (p * x * x + 2.0 * r * x * y + q * y * y).max(0.0)).sqrt();
    // An infinite length along an axis keeps the other number at 0.
    let axis = |x: f64, y: f64| {
        let length = length(x, y);
        [(x, extent[0]), (y, extent[1])]
            .map(|(part, extent)| if part == 0.0 { 0.0 } else { part * length * extent })
    };
    [axis(cos, sin), axis(-sin, cos)]
}

/// p, r, q of |K v|² along two columns of K; 0 along one that it does not have.
fn metric(k: &[Vec<f64>], columns: [Option<usize>; 2]) -> [f64; 3] {
    let of = |row: &Vec<f64>, column: Option<usize>| column.and_then(|c| row.get(c).copied()).unwrap_or(0.0);
    let product = |a: usize, b: usize| k.iter().map(|row| of(row, columns[a]) * of(row, columns[b])).sum();
    [product(0, 0), product(0, 1), product(1, 1)]
}

/// A Gaussian by |K (v − centre)|²: its kind and its keys. `extent`: of the plane, where its half axes are at right angles.
pub(in crate::transfer) fn gaussian(
    centre: [f64; 2],
    k: &[Vec<f64>],
    extent: [f64; 2],
) -> (&'static str, Vec<Change>) {
    let ellipse = Ellipse::new(centre, k, [Some(0), Some(1)], extent);
    let reach = |k: usize| ellipse.axes[0][k].hypot(ellipse.axes[1][k]);
    let centre = finely(centre, [reach(0), reach(1)]);
    ("gaussian", std::iter::once(("centre", Some(list(&centre)))).chain(spread(ellipse.axes)).collect())
}

/// A centre as finely as deviations need it.
pub(super) fn finely(centre: [f64; 2], deviations: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k: usize| match deviations[k].is_finite() {
        true => decimal(centre[k], 1e-4 * deviations[k]),
        false => centre[k],
    })
}

/// Half axes as a file states them: upright ones as sigma, turned ones as a matrix.
pub(super) fn spread(axes: [[f64; 2]; 2]) -> Vec<Change> {
    let [[a, b], [c, d]] = axes;
    let small = |x: f64, of: f64| x.abs() <= 1e-9 * of.abs();
    if small(b, d) && small(c, a) {
        return vec![("sigma", Some(list(&[a.abs(), d.abs()].map(rounded)))), ("matrix", None)];
    }
    if small(a, c) && small(d, b) {
        return vec![("sigma", Some(list(&[c.abs(), b.abs()].map(rounded)))), ("matrix", None)];
    }
    // K = A⁻¹ / √2, where the half axes are the columns of A: |K v|² = ½ at one standard deviation.
    let det = (a * d - c * b) * std::f64::consts::SQRT_2;
    let matrix = [[d / det, -c / det], [-b / det, a / det]].map(|row| row.map(rounded));
    vec![("matrix", Some(rows(&matrix))), ("sigma", None)]
}
