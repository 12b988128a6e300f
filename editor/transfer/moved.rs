//! What a drag of a handle makes of a widget's numbers.

use super::form::Drawn;
use super::handles::Handle;
use super::numbers::{Change, list, rounded, rows};
use super::scale::{Scale, extinction_at};
use super::shape::{Form, Region};
use voltet_core::graph::Datum;

impl Drawn {
    /// What becomes of the numbers when a handle is brought to a place.
    pub fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        let extent = scale.extent;
        match (&self.form, handle) {
            (Form::Gaussian { .. } | Form::Triangular { .. }, Handle::Centre) if self.of_fields.is_some() => {
                self.of_fields.as_ref().map_or(Vec::new(), |of| of.centred(to))
            }
            (Form::Gaussian { .. }, Handle::Centre) => vec![("centre", Some(list(&to)))],
            (Form::Gaussian { centre, axes }, Handle::Width(i)) => {
                let v = [(to[0] - centre[0]) / extent[0], (to[1] - centre[1]) / extent[1]];
                let own = [axes[i][0] / extent[0], axes[i][1] / extent[1]];
                let length = own[0].hypot(own[1]);
                let share = (v[0] * own[0] + v[1] * own[1]).abs() / (length * length);
                let mut after = *axes;
                after[i] = after[i].map(|x| x * share.max(1e-6));
                self.spread(*axes, after)
            }
            (Form::Gaussian { centre, axes }, Handle::Angle) => {
                self.spread(*axes, turned(*axes, [to[0] - centre[0], to[1] - centre[1]], extent))
            }
            (Form::Triangular { .. }, Handle::Centre) => {
                vec![("centre", Some(Datum::Number(rounded(to[0]))))]
            }
            (Form::Triangular { centre, sigma }, Handle::Width(_)) => {
                let g = to[1].max(0.02 * scale.top());
                let after = ((to[0] - centre) / g).abs().max(1e-9 * extent[0] / extent[1]);
                match &self.of_fields {
                    Some(of) => of.scaled([after / sigma, 1.0]),
                    None => vec![("sigma", Some(Datum::Number(rounded(after))))],
                }
            }
            (Form::Wave { .. }, Handle::Centre) => vec![("origin", Some(list(&to)))],
            (Form::Wave { origin, scale: factors, .. }, Handle::Width(_)) => {
                let v = [(to[0] - origin[0]) * factors[0], (to[1] - origin[1]) * factors[1]];
                let period = v[0].hypot(v[1]).max(1e-6 * extent[0] * factors[0].abs());
                let angle = v[1].atan2(v[0]).to_degrees();
                let angle = if angle.abs() < 2.0 { 0.0 } else { angle };
                vec![
                    ("period", Some(Datum::Number(rounded(period)))),
                    ("angle", Some(Datum::Number(rounded(angle)))),
                ]
            }
            (Form::Wave { origin, angle, scale: factors, period, .. }, Handle::Band) => {
                let (sin, cos) = angle.to_radians().sin_cos();
                let across = (to[0] - origin[0]) * cos * factors[0] + (to[1] - origin[1]) * sin * factors[1];
                let half = (across / period - 0.5).clamp(0.005, 0.5);
                let width = match self.kind.as_str() {
                    "sine-wave" => 2.0 * (0.5 * std::f64::consts::PI * half).sin().powi(2),
                    _ => 2.0 * half,
                };
                vec![("band_width", Some(Datum::Number(rounded(width.min(1.0)))))]
            }
            (Form::Points(points), Handle::Point(i)) => {
                let mut points = points.clone();
                let low = i.checked_sub(1).and_then(|i| points.get(i)).map_or(f64::NEG_INFINITY, |p| p[0]);
                let high = points.get(i + 1).map_or(f64::INFINITY, |p| p[0]);
                if let Some(point) = points.get_mut(i) {
                    let gap = 1e-6 * extent[0];
                    point[0] = to[0].clamp(low + gap, (high - gap).max(low + gap));
                    point[4] = extinction_at(to[1] / scale.top(), scale.peak);
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
                    // A region is convex: a hand that would dent it waits at its bounds.
                    if !is_convex(&corners) {
                        return Vec::new();
                    }
                    vec![("region.polygon", Some(rows(&corners)))]
                }
            },
            (_, Handle::Side(axis, upper)) => {
                let Region::Box(limits) = &self.region else { return Vec::new() };
                let mut limits = limits[axis];
                limits[usize::from(upper)] = to[axis];
                let limits = [limits[0].min(limits[1]), limits[0].max(limits[1])];
                vec![(if axis == 0 { "region.s" } else { "region.g" }, Some(list(&limits)))]
            }
            _ => Vec::new(),
        }
    }

    /// What becomes of the numbers when all of it is moved along.
    pub fn shifted(&self, by: [f64; 2], scale: &Scale) -> Vec<Change> {
        let mut changes = match &self.form {
            Form::Gaussian { centre, .. } => {
                self.moved(Handle::Centre, [centre[0] + by[0], centre[1] + by[1]], scale)
            }
            Form::Triangular { centre, .. } => self.moved(Handle::Centre, [centre + by[0], 0.0], scale),
            Form::Wave { origin, .. } => {
                self.moved(Handle::Centre, [origin[0] + by[0], origin[1] + by[1]], scale)
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
            Region::Box(limits) => {
                let names = ["region.s", "region.g"];
                for (axis, name) in names.into_iter().enumerate() {
                    if limits[axis].iter().any(|x| x.is_finite()) && by[axis] != 0.0 {
                        changes.push((name, Some(list(&limits[axis].map(|x| x + by[axis])))));
                    }
                }
            }
            Region::Polygon(corners) => {
                let moved: Vec<[f64; 2]> = corners.iter().map(|&[s, g]| [s + by[0], g + by[1]]).collect();
                changes.push(("region.polygon", Some(rows(&moved))));
            }
        }
        changes
    }

    /// Other half axes, as the file states them.
    fn spread(&self, before: [[f64; 2]; 2], after: [[f64; 2]; 2]) -> Vec<Change> {
        match &self.of_fields {
            Some(of) => of.stretched(before, after),
            None => gaussian(after),
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

/// Half axes as a file states them: upright ones as sigma, turned ones as a matrix.
pub(super) fn gaussian(axes: [[f64; 2]; 2]) -> Vec<Change> {
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

/// Whether a polygon turns one way at all of its corners.
pub(super) fn is_convex(corners: &[[f64; 2]]) -> bool {
    let n = corners.len();
    let turn = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % n]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    n >= 3 && ((0..n).all(|i| turn(i) > 0.0) || (0..n).all(|i| turn(i) < 0.0))
}

/// The ranges with a corner elsewhere; the lower end stays the lower one.
fn with_corner([mut s, mut g]: [[f64; 2]; 2], corner: usize, to: [f64; 2]) -> [[f64; 2]; 2] {
    let (right, upper) = (corner == 1 || corner == 2, corner >= 2);
    s[usize::from(right)] = to[0];
    g[usize::from(upper)] = to[1];
    [s, g].map(|[a, b]| [a.min(b), a.max(b)])
}
