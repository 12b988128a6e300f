//! Widgets as they lie in the plane.

use voltet_core::graph::{Field, Setting};
use voltet_core::transfer::{Profile, Widget};

/// A widget in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub kind: String,
    pub form: Form,
    pub region: Region,
    /// Linear RGB.
    pub color: [f64; 3],
    pub extinction: f64,
}

/// What its profile is.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    /// Its middle and its two half axes at one standard deviation; an infinite one ignores its axis.
    Gaussian { centre: [f64; 2], axes: [[f64; 2]; 2] },
    /// Its s, and its width in s a unit of g.
    Triangular { centre: f64, sigma: f64 },
    /// Bands: where the wave is 0, the direction across (degrees), factors on the axes, distance.
    Wave { origin: [f64; 2], angle: f64, scale: [f64; 2], period: f64 },
    /// [s, r, g, b, extinction] each.
    Points(Vec<[f64; 5]>),
    /// A picture over ranges of s and g.
    Table { s: [f64; 2], g: [f64; 2] },
    /// The same everywhere in its region.
    Uniform,
    /// Over other fields, or with numbers that are not known yet.
    Elsewhere,
}

/// Where a widget is not 0.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Region {
    Whole,
    /// Ranges of s and g; infinite ones are no limit.
    Box([[f64; 2]; 2]),
    Polygon(Vec<[f64; 2]>),
}

impl Drawn {
    /// From what the file states. `known`: the widget with its relative numbers resolved, where a run found them; `extent`:
    /// lengths of the axes, for angles.
    pub fn read(fields: &[Field], known: Option<&Widget>, extent: [f64; 2]) -> Drawn {
        let find = |name: &str| fields.iter().find(|field| field.name == name).map(|field| &field.setting);
        let kind = find("kind").and_then(Setting::text).unwrap_or_default().to_string();
        let pair = |name: &str| -> Option<[f64; 2]> { find(name)?.numbers()?.try_into().ok() };
        let number = |name: &str| find(name).and_then(Setting::number);
        let form = stated(&kind, &pair, &number, &find, extent)
            .or_else(|| known.map(|widget| of_profile(&widget.profile, extent)));
        let region = match find("region").and_then(Setting::table) {
            None => Region::Whole,
            Some(region) => {
                let of =
                    |name: &str| region.iter().find(|field| field.name == name).map(|field| &field.setting);
                let corners: Option<Vec<[f64; 2]>> = of("polygon")
                    .and_then(Setting::list)
                    .and_then(|list| list.iter().map(|row| row.numbers()?.try_into().ok()).collect());
                let limits = |name: &str| -> [f64; 2] {
                    let stated = of(name).and_then(|s| s.numbers()).and_then(|list| list.try_into().ok());
                    stated.unwrap_or([f64::NEG_INFINITY, f64::INFINITY])
                };
                corners.map_or_else(|| Region::Box([limits("s"), limits("g")]), Region::Polygon)
            }
        };
        Drawn {
            form: form.unwrap_or(Form::Elsewhere),
            region,
            color: find("color").and_then(|s| s.numbers()?.try_into().ok()).unwrap_or([1.0; 3]),
            extinction: number("extinction").unwrap_or(0.0),
            kind,
        }
    }

    /// Its strength at a place, 0 to 1 of its peak; what it holds is where that is half or more.
    pub fn strength(&self, at: [f64; 2]) -> f64 {
        let within = match &self.region {
            Region::Whole => true,
            Region::Box(limits) => (0..2).all(|k| at[k] >= limits[k][0] && at[k] <= limits[k][1]),
            Region::Polygon(corners) => holds(corners, at),
        };
        let of_form = match &self.form {
            Form::Gaussian { centre, axes } => {
                let v = [at[0] - centre[0], at[1] - centre[1]];
                (-0.5 * squared(axes, v)).exp()
            }
            Form::Triangular { centre, sigma } => {
                let q = (at[0] - centre) / (sigma * at[1]).abs().max(1e-300);
                (-q * q).exp()
            }
            Form::Wave { .. } | Form::Points(_) | Form::Elsewhere => 0.0,
            Form::Table { s, g } => {
                f64::from(at[0] >= s[0] && at[0] <= s[1] && at[1] >= g[0] && at[1] <= g[1])
            }
            Form::Uniform => 1.0,
        };
        if within { of_form } else { 0.0 }
    }
}

/// Squared length of a vector in half axes; those that are infinite count nothing.
fn squared(axes: &[[f64; 2]; 2], v: [f64; 2]) -> f64 {
    if axes[0][1] == 0.0 && axes[1][0] == 0.0 {
        return (v[0] / axes[0][0]).powi(2) + (v[1] / axes[1][1]).powi(2);
    }
    let det = axes[0][0] * axes[1][1] - axes[1][0] * axes[0][1];
    let a = (v[0] * axes[1][1] - v[1] * axes[1][0]) / det;
    let b = (axes[0][0] * v[1] - axes[0][1] * v[0]) / det;
    a * a + b * b
}

/// Half axes of the matrix K, at right angles in the plane where both extents are as long.
fn half_axes(k: [[f64; 2]; 2], extent: [f64; 2]) -> [[f64; 2]; 2] {
    let k = k.map(|row| [row[0] * extent[0], row[1] * extent[1]]);
    let (p, q) = (k[0][0] * k[0][0] + k[1][0] * k[1][0], k[0][1] * k[0][1] + k[1][1] * k[1][1]);
    let r = k[0][0] * k[0][1] + k[1][0] * k[1][1];
    // KᵀK is diagonal in these directions.
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

fn stated<'a>(
    kind: &str,
    pair: &dyn Fn(&str) -> Option<[f64; 2]>,
    number: &dyn Fn(&str) -> Option<f64>,
    find: &dyn Fn(&str) -> Option<&'a Setting>,
    extent: [f64; 2],
) -> Option<Form> {
    match kind {
        "gaussian" => {
            let centre = pair("centre")?;
            if let Some([s, g]) = pair("sigma") {
                return Some(Form::Gaussian { centre, axes: [[s, 0.0], [0.0, g]] });
            }
            let list = find("matrix")?.list()?;
            let row = |i: usize| -> Option<[f64; 2]> { list.get(i)?.numbers()?.try_into().ok() };
            Some(Form::Gaussian { centre, axes: half_axes([row(0)?, row(1)?], extent) })
        }
        "triangular-gaussian" => {
            Some(Form::Triangular { centre: number("centre")?, sigma: number("sigma")? })
        }
        "triangle-wave" | "sine-wave" => {
            let standing =
                |name: &str, or: [f64; 2]| if find(name).is_some() { pair(name) } else { Some(or) };
            Some(Form::Wave {
                origin: standing("origin", [0.0; 2])?,
                angle: number("angle").unwrap_or(0.0),
                scale: standing("scale", [1.0; 2])?,
                period: number("period")?,
            })
        }
        "piecewise-linear" => {
            let list = find("points")?.list()?;
            let points: Option<Vec<[f64; 5]>> =
                list.iter().map(|row| row.numbers()?.try_into().ok()).collect();
            points.map(Form::Points)
        }
        "table" => Some(Form::Table { s: pair("s")?, g: pair("g")? }),
        "uniform" => Some(Form::Uniform),
        _ => None,
    }
}

/// The form of a widget whose numbers a run resolved.
fn of_profile(profile: &Profile, extent: [f64; 2]) -> Form {
    match profile {
        Profile::Gaussian { centre, matrix } => {
            Form::Gaussian { centre: *centre, axes: half_axes(*matrix, extent) }
        }
        _ => Form::Elsewhere,
    }
}

/// Whether a polygon holds a place.
fn holds(corners: &[[f64; 2]], at: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (a[1] > at[1]) != (b[1] > at[1]) && at[0] < (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]) + a[0] {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
#[path = "form_tests.rs"]
mod tests;
