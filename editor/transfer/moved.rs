//! Handles of widgets, and what a drag of one makes of their numbers.

use super::form::{Drawn, Form, Region};
use voltet_core::graph::{Datum, Setting};

/// What a hand takes hold of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Handle {
    Centre,
    /// The end of a half axis.
    Width(usize),
    Angle,
    /// A corner of the region.
    Corner(usize),
    /// A point of a curve, by its place.
    Point(usize),
}

/// A change of a widget's table: a key, and its value or none to take it out.
pub(super) type Change = (&'static str, Option<Datum>);

pub(super) fn list(numbers: &[f64]) -> Datum {
    Datum::List(numbers.iter().map(|&x| Setting::from(Datum::Number(rounded(x)))).collect())
}

pub(super) fn rows<const N: usize>(rows: &[[f64; N]]) -> Datum {
    Datum::List(rows.iter().map(|row| Setting::from(list(row))).collect())
}

/// Six digits: finer than a pixel of any screen.
fn rounded(x: f64) -> f64 {
    if x.is_finite() { format!("{x:.5e}").parse().unwrap_or(x) } else { x }
}

impl Drawn {
    /// The handles, each with its place. `top`: the largest g shown; `peak`: the extinction at the top of the plot.
    pub fn handles(&self, top: f64, peak: f64) -> Vec<(Handle, [f64; 2])> {
        let mut handles = Vec::new();
        match &self.form {
            Form::Gaussian { centre, axes } => {
                handles.push((Handle::Centre, *centre));
                for (i, axis) in
                    axes.iter().enumerate().filter(|(_, axis)| axis.iter().all(|x| x.is_finite()))
                {
                    handles.push((Handle::Width(i), [centre[0] + axis[0], centre[1] + axis[1]]));
                }
                if axes.as_flattened().iter().all(|x| x.is_finite()) {
                    handles
                        .push((Handle::Angle, [centre[0] + 1.7 * axes[0][0], centre[1] + 1.7 * axes[0][1]]));
                }
            }
            Form::Triangular { centre, sigma } => {
                handles.push((Handle::Centre, [*centre, 0.0]));
                handles.push((Handle::Width(0), [centre + sigma * 0.8 * top, 0.8 * top]));
            }
            Form::Wave { origin, angle, scale, period } => {
                handles.push((Handle::Centre, *origin));
                let (sin, cos) = angle.to_radians().sin_cos();
                let along = [cos * period / scale[0], sin * period / scale[1]];
                handles.push((Handle::Width(0), [origin[0] + along[0], origin[1] + along[1]]));
            }
            Form::Points(points) => {
                let place = |p: &[f64; 5]| [p[0], height_of(p[4], peak) * top];
                handles.extend(points.iter().enumerate().map(|(i, p)| (Handle::Point(i), place(p))));
            }
            Form::Table { s, g } => {
                for (i, corner) in corners([*s, *g]).into_iter().enumerate() {
                    handles.push((Handle::Corner(i), corner));
                }
            }
            Form::Uniform | Form::Elsewhere => {}
        }
        match &self.region {
            Region::Whole => {}
            Region::Box(limits) if limits.as_flattened().iter().all(|x| x.is_finite()) => {
                handles
                    .extend(corners(*limits).into_iter().enumerate().map(|(i, at)| (Handle::Corner(i), at)));
            }
            Region::Box(_) => {}
            Region::Polygon(corners) => {
                handles.extend(corners.iter().enumerate().map(|(i, at)| (Handle::Corner(i), *at)));
            }
        }
        handles
    }

    /// What becomes of the numbers when a handle is brought to a place. `extent`: lengths of the axes, for angles; `top` and
    /// `peak` as for [`Drawn::handles`].
    pub fn moved(
        &self,
        handle: Handle,
        to: [f64; 2],
        extent: [f64; 2],
        [top, peak]: [f64; 2],
    ) -> Vec<Change> {
        match (&self.form, handle) {
            (Form::Gaussian { .. }, Handle::Centre) => vec![("centre", Some(list(&to)))],
            (Form::Gaussian { centre, axes }, Handle::Width(i)) => {
                let v = [(to[0] - centre[0]) / extent[0], (to[1] - centre[1]) / extent[1]];
                let own = [axes[i][0] / extent[0], axes[i][1] / extent[1]];
                let length = own[0].hypot(own[1]);
                let share = (v[0] * own[0] + v[1] * own[1]).abs() / (length * length);
                let mut axes = *axes;
                axes[i] = axes[i].map(|x| x * share.max(1e-6));
                gaussian(axes)
            }
            (Form::Gaussian { centre, axes }, Handle::Angle) => {
                let v = [(to[0] - centre[0]) / extent[0], (to[1] - centre[1]) / extent[1]];
                let lengths = axes.map(|axis| (axis[0] / extent[0]).hypot(axis[1] / extent[1]));
                let angle = v[1].atan2(v[0]);
                // Upright again within two degrees.
                let quarter = std::f64::consts::FRAC_PI_2;
                let near = (angle / quarter).round() * quarter;
                let angle = if (angle - near).abs() < 0.035 { near } else { angle };
                let (sin, cos) = angle.sin_cos();
                let turned = [[cos, sin], [-sin, cos]];
                let axis =
                    |i: usize| [turned[i][0] * lengths[i] * extent[0], turned[i][1] * lengths[i] * extent[1]];
                gaussian([axis(0), axis(1)])
            }
            (Form::Triangular { .. }, Handle::Centre) => {
                vec![("centre", Some(Datum::Number(rounded(to[0]))))]
            }
            (Form::Triangular { centre, .. }, Handle::Width(_)) => {
                let g = to[1].max(0.02 * top);
                let sigma = ((to[0] - centre) / g).abs().max(1e-9 * extent[0] / extent[1]);
                vec![("sigma", Some(Datum::Number(rounded(sigma))))]
            }
            (Form::Wave { .. }, Handle::Centre) => vec![("origin", Some(list(&to)))],
            (Form::Wave { origin, scale, .. }, Handle::Width(_)) => {
                let v = [(to[0] - origin[0]) * scale[0], (to[1] - origin[1]) * scale[1]];
                let period = v[0].hypot(v[1]).max(1e-6 * extent[0] * scale[0].abs());
                let angle = v[1].atan2(v[0]).to_degrees();
                let angle = if angle.abs() < 2.0 { 0.0 } else { angle };
                vec![
                    ("period", Some(Datum::Number(rounded(period)))),
                    ("angle", Some(Datum::Number(rounded(angle)))),
                ]
            }
            (Form::Points(points), Handle::Point(i)) => {
                let mut points = points.clone();
                let low = i.checked_sub(1).and_then(|i| points.get(i)).map_or(f64::NEG_INFINITY, |p| p[0]);
                let high = points.get(i + 1).map_or(f64::INFINITY, |p| p[0]);
                if let Some(point) = points.get_mut(i) {
                    let gap = 1e-6 * extent[0];
                    point[0] = to[0].clamp(low + gap, (high - gap).max(low + gap));
                    point[4] = extinction_at(to[1] / top, peak);
                }
                vec![("points", Some(rows(&points)))]
            }
            (Form::Table { s, g }, Handle::Corner(i)) => {
                let [s, g] = with_corner([*s, *g], i, to);
                vec![("s", Some(list(&s))), ("g", Some(list(&g)))]
            }
            (_, Handle::Corner(i)) => match &self.region {
                Region::Whole => Vec::new(),
                Region::Box(limits) => {
                    let [s, g] = with_corner(*limits, i, to);
                    vec![("region.s", Some(list(&s))), ("region.g", Some(list(&g)))]
                }
                Region::Polygon(corners) => {
                    let mut corners = corners.clone();
                    if let Some(corner) = corners.get_mut(i) {
                        *corner = to;
                    }
                    vec![("region.polygon", Some(rows(&corners)))]
                }
            },
            _ => Vec::new(),
        }
    }

    /// What becomes of the numbers when all of it is moved along.
    pub fn shifted(&self, by: [f64; 2], extent: [f64; 2], bounds: [f64; 2]) -> Vec<Change> {
        let mut changes = match &self.form {
            Form::Gaussian { centre, .. } => {
                self.moved(Handle::Centre, [centre[0] + by[0], centre[1] + by[1]], extent, bounds)
            }
            Form::Triangular { centre, .. } => {
                self.moved(Handle::Centre, [centre + by[0], 0.0], extent, bounds)
            }
            Form::Wave { origin, .. } => {
                self.moved(Handle::Centre, [origin[0] + by[0], origin[1] + by[1]], extent, bounds)
            }
            Form::Points(points) => {
                let moved: Vec<[f64; 5]> =
                    points.iter().map(|&[s, r, g, b, e]| [s + by[0], r, g, b, e]).collect();
                vec![("points", Some(rows(&moved)))]
            }
            Form::Table { s, g } => {
                vec![("s", Some(list(&s.map(|x| x + by[0])))), ("g", Some(list(&g.map(|x| x + by[1]))))]
            }
            Form::Uniform | Form::Elsewhere => Vec::new(),
        };
        match &self.region {
            Region::Whole => {}
            Region::Box([s, g]) => {
                if s.iter().any(|x| x.is_finite()) {
                    changes.push(("region.s", Some(list(&s.map(|x| x + by[0])))));
                }
                if g.iter().any(|x| x.is_finite()) {
                    changes.push(("region.g", Some(list(&g.map(|x| x + by[1])))));
                }
            }
            Region::Polygon(corners) => {
                let moved: Vec<[f64; 2]> = corners.iter().map(|&[s, g]| [s + by[0], g + by[1]]).collect();
                changes.push(("region.polygon", Some(rows(&moved))));
            }
        }
        changes
    }
}

/// The height in the plot of an extinction, 0 to 1: its cube root, so that small ones are told apart.
pub(super) fn height_of(extinction: f64, peak: f64) -> f64 {
    (extinction / peak).max(0.0).cbrt()
}

fn extinction_at(height: f64, peak: f64) -> f64 {
    let height = height.clamp(0.0, 1.5);
    // At the foot it is none at all.
    if height < 0.01 { 0.0 } else { rounded(height.powi(3) * peak) }
}

/// Half axes as a file states them: upright ones as sigma, turned ones as a matrix.
fn gaussian(axes: [[f64; 2]; 2]) -> Vec<Change> {
    let [[a, b], [c, d]] = axes;
    let small = |x: f64, of: f64| x.abs() <= 1e-9 * of.abs();
    if small(b, d) && small(c, a) {
        return vec![("sigma", Some(list(&[a.abs(), d.abs()]))), ("matrix", None)];
    }
    if small(a, c) && small(d, b) {
        return vec![("sigma", Some(list(&[c.abs(), b.abs()]))), ("matrix", None)];
    }
    // K = A⁻¹ / √2, where the half axes are the columns of A: |K v|² = ½ at one standard deviation.
    let det = (a * d - c * b) * std::f64::consts::SQRT_2;
    let matrix = [[d / det, -c / det], [-b / det, a / det]];
    vec![("matrix", Some(rows(&matrix))), ("sigma", None)]
}

fn corners([s, g]: [[f64; 2]; 2]) -> [[f64; 2]; 4] {
    [[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]]
}

/// The ranges with a corner elsewhere; the lower end stays the lower one.
fn with_corner([mut s, mut g]: [[f64; 2]; 2], corner: usize, to: [f64; 2]) -> [[f64; 2]; 2] {
    let (right, upper) = (corner == 1 || corner == 2, corner >= 2);
    s[usize::from(right)] = to[0];
    g[usize::from(upper)] = to[1];
    [s, g].map(|[a, b]| [a.min(b), a.max(b)])
}
