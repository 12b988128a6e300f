//! Widgets as they lie in the plane.

use super::fields::OfFields;
use super::look::S_AND_G;
use super::relative;
use crate::worker::Known;
use voltet_core::graph::{Field, Quantity, Setting};

/// A widget in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub kind: String,
    pub form: Form,
    pub region: Region,
    /// Linear RGB.
    pub color: [f64; 3],
    pub extinction: f64,
    /// Of one over a list of fields, what lies outside of the plane.
    pub of_fields: Option<OfFields>,
    /// Its table as the file states it.
    pub stated: Vec<Field>,
    /// Why it is not drawn.
    pub fault: Option<String>,
}

/// What its profile is.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    /// Its middle and its two half axes at one standard deviation; an infinite one ignores its axis.
    Gaussian { centre: [f64; 2], axes: [[f64; 2]; 2] },
    /// Its s, and its width in s a unit of g; or a field and the magnitude of its gradients.
    Triangular { centre: f64, sigma: f64 },
    /// Bands: where the wave is 0, the direction across (degrees), factors on the axes, distance, share that is kept.
    Wave { origin: [f64; 2], angle: f64, scale: [f64; 2], period: f64, band_width: f64 },
    /// [s, r, g, b, extinction] each.
    Points(Vec<[f64; 5]>),
    /// A picture over ranges of s and g.
    Table { s: [f64; 2], g: [f64; 2] },
    /// The same everywhere in its region.
    Uniform,
    /// Along other axes, or with numbers that are not known yet.
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

pub(super) fn find<'a>(fields: &'a [Field], name: &str) -> Option<&'a Setting> {
    fields.iter().find(|field| field.name == name).map(|field| &field.setting)
}

pub(super) fn array<const N: usize>(fields: &[Field], name: &str) -> Option<[f64; N]> {
    find(fields, name)?.numbers()?.try_into().ok()
}

fn number(fields: &[Field], name: &str) -> Option<f64> {
    find(fields, name).and_then(Setting::number)
}

impl Drawn {
    /// From what the file states, with numbers relative to data found by what is known of these.
    pub fn of(fields: &[Field], axes: &[Quantity; 2], known: Option<&Known>, extent: [f64; 2]) -> Drawn {
        match relative::resolved(fields, known) {
            Ok(resolved) => Drawn { stated: fields.to_vec(), ..Drawn::read(&resolved, axes, known, extent) },
            Err(error) => {
                let mut drawn = Drawn::read(fields, axes, known, extent);
                drawn.form = Form::Elsewhere;
                drawn.region = Region::Whole;
                drawn.fault = Some(error.to_string());
                drawn
            }
        }
    }

    /// From a table of numbers. `extent`: lengths of the axes, for angles.
    pub fn read(fields: &[Field], axes: &[Quantity; 2], known: Option<&Known>, extent: [f64; 2]) -> Drawn {
        let kind = find(fields, "kind").and_then(Setting::text).unwrap_or_default().to_string();
        let of_fields = OfFields::read(fields, axes, known);
        let is_flat = *axes == S_AND_G;
        let form = match (&of_fields, is_flat || (kind == "piecewise-linear" && axes[0] == S_AND_G[0])) {
            (Some(of_fields), _) => of_fields.form(extent),
            (None, true) => stated(&kind, fields, extent),
            (None, false) => None,
        };
        Drawn {
            region: if is_flat { region(fields) } else { Region::Whole },
            color: array(fields, "color").or_else(|| strongest(&form)).unwrap_or([1.0; 3]),
            extinction: number(fields, "extinction").unwrap_or(0.0),
            of_fields,
            stated: fields.to_vec(),
            fault: None,
            kind,
            form: form.unwrap_or(Form::Elsewhere),
        }
    }

    /// The largest extinction of a curve; 0 of others.
    pub fn peak_of_curve(&self) -> f64 {
        match &self.form {
            Form::Points(points) => points.iter().map(|point| point[4]).fold(0.0, f64::max),
            _ => 0.0,
        }
    }
}

/// The colour of a curve where it is strongest.
fn strongest(form: &Option<Form>) -> Option<[f64; 3]> {
    let Some(Form::Points(points)) = form else { return None };
    let strongest = points.iter().max_by(|a, b| a[4].total_cmp(&b[4]))?;
    Some([strongest[1], strongest[2], strongest[3]])
}

fn region(fields: &[Field]) -> Region {
    let Some(region) = find(fields, "region").and_then(Setting::table) else { return Region::Whole };
    let corners: Option<Vec<[f64; 2]>> = find(region, "polygon")
        .and_then(Setting::list)
        .and_then(|list| list.iter().map(|row| row.numbers()?.try_into().ok()).collect());
    let limits = |name: &str| array(region, name).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    corners.map_or_else(|| Region::Box([limits("s"), limits("g")]), Region::Polygon)
}

/// What the metric of a Gaussian, exp(−p x² − 2 r x y − q y²), has for half axes: at right angles in the plane where both extents
/// are as long.
pub(super) fn half_axes([p, r, q]: [f64; 3], extent: [f64; 2]) -> [[f64; 2]; 2] {
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
pub(super) fn metric(k: &[Vec<f64>], columns: [Option<usize>; 2]) -> [f64; 3] {
    let of = |row: &Vec<f64>, column: Option<usize>| column.and_then(|c| row.get(c).copied()).unwrap_or(0.0);
    let product = |a: usize, b: usize| k.iter().map(|row| of(row, columns[a]) * of(row, columns[b])).sum();
    [product(0, 0), product(0, 1), product(1, 1)]
}

fn stated(kind: &str, fields: &[Field], extent: [f64; 2]) -> Option<Form> {
    match kind {
        "gaussian" => {
            let centre = array(fields, "centre")?;
            if let Some([s, g]) = array(fields, "sigma") {
                return Some(Form::Gaussian { centre, axes: [[s, 0.0], [0.0, g]] });
            }
            let rows: Option<Vec<Vec<f64>>> =
                find(fields, "matrix")?.list()?.iter().map(Setting::numbers).collect();
            let axes = half_axes(metric(&rows?, [Some(0), Some(1)]), extent);
            Some(Form::Gaussian { centre, axes })
        }
        "triangular-gaussian" => {
            Some(Form::Triangular { centre: number(fields, "centre")?, sigma: number(fields, "sigma")? })
        }
        "triangle-wave" | "sine-wave" => {
            let standing = |name: &str, or: [f64; 2]| match find(fields, name) {
                Some(_) => array(fields, name),
                None => Some(or),
            };
            Some(Form::Wave {
                origin: standing("origin", [0.0; 2])?,
                angle: number(fields, "angle").unwrap_or(0.0),
                scale: standing("scale", [1.0; 2])?,
                period: number(fields, "period")?,
                band_width: number(fields, "band_width").unwrap_or(1.0),
            })
        }
        "piecewise-linear" => {
            let list = find(fields, "points")?.list()?;
            let points: Option<Vec<[f64; 5]>> =
                list.iter().map(|row| row.numbers()?.try_into().ok()).collect();
            points.map(Form::Points)
        }
        "table" => Some(Form::Table { s: array(fields, "s")?, g: array(fields, "g")? }),
        "uniform" => Some(Form::Uniform),
        _ => None,
    }
}

#[cfg(test)]
#[path = "form_tests.rs"]
mod tests;
