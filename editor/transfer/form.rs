//! Widgets as they lie in the plane.

use super::fields::OfFields;
use super::numbers::{array, find, number};
use super::relative;
use super::scale::S_AND_G;
use super::shape::{Form, Region, half_axes, metric};
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
