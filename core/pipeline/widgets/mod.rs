//! Widgets as a pipeline file states them, and their conversion to [`crate::transfer`].
//!
//! The file gives angles in degrees and widths as σ; the library takes radians and the matrix K with
//! K = diag(1/(√2 σ)) for the axis-aligned Gaussian (docs/optics.md, section 5).

mod kinds;
#[cfg(test)]
mod tests;

use crate::graph::Parameters;
pub use kinds::WIDGET_KINDS;

use crate::transfer::{ControlPoint, Profile, Region, Table, Wave, Widget};
use crate::{Error, Result};
use std::sync::Arc;

/// Reads the image of a table widget: width, height and straight linear RGBA texels, row 0 at the top.
pub type LoadImage<'a> = &'a dyn Fn(&str) -> Result<(usize, usize, Vec<[f32; 4]>)>;

/// One widget of the given kind.
pub fn widget(kind: &str, p: &Parameters, load_image: LoadImage) -> Result<Widget> {
    let profile = match kind {
        "uniform" => Profile::Uniform,
        "gaussian" => {
            let rows = kernel(p, 2)?;
            Profile::Gaussian {
                centre: p.vector("centre")?,
                matrix: [[rows[0][0], rows[0][1]], [rows[1][0], rows[1][1]]],
            }
        }
        "gaussian-nd" => gaussian_nd(p)?,
        "triangular-gaussian" => {
            Profile::TriangularGaussian { centre: p.number("centre")?, sigma: p.number("sigma")? }
        }
        "triangle-wave" => Profile::TriangleWave(wave(p)?),
        "sine-wave" => Profile::SineWave(wave(p)?),
        "piecewise-linear" => Profile::PiecewiseLinear { points: control_points(p)? },
        "table" => table(p, load_image)?,
        other => return Err(Error::run(format!("the widget kind '{other}' is declared but not known"))),
    };
    // Piecewise-linear widgets hold their own colour and extinction; their peak is the largest of their points.
    let peak = match &profile {
        Profile::PiecewiseLinear { points } => points.iter().fold(0.0, |peak: f64, q| peak.max(q.extinction)),
        _ => p.number("extinction")?,
    };
    let color = if p.optional("color").is_some() { p.vector("color")? } else { [1.0; 3] };
    let region = p.table("region")?.map(|region| polygon(&region)).transpose()?;
    Ok(Widget { profile, color, extinction: peak, region })
}

/// K from `matrix` or `sigma`, n rows of n.
fn kernel(p: &Parameters, n: usize) -> Result<Vec<Vec<f64>>> {
    let rows = match (p.optional("sigma"), p.optional("matrix")) {
        (Some(_), Some(_)) => return Err(p.error("matrix", "'sigma' and 'matrix' exclude each other")),
        (None, None) => return Err(p.error("sigma", "the widget needs 'sigma' or 'matrix'")),
        (Some(_), None) => {
            let sigma = p.numbers("sigma")?;
            let inverse = |i: usize| 1.0 / (std::f64::consts::SQRT_2 * sigma[i]);
            let row = |i: usize| (0..sigma.len()).map(|j| if i == j { inverse(i) } else { 0.0 }).collect();
            (0..sigma.len()).map(row).collect::<Vec<Vec<f64>>>()
        }
        (None, Some(_)) => p.rows("matrix")?,
    };
    let name = if p.optional("sigma").is_some() { "sigma" } else { "matrix" };
    if rows.len() != n || rows.iter().any(|row| row.len() != n) {
        let found = format!("{} × {}", rows.len(), rows.first().map_or(0, Vec::len));
        return Err(p
            .error(name, format!("'{name}' has the wrong size"))
            .found(found)
            .accepted(format!("{n} × {n}")));
    }
    if rows.iter().flatten().any(|x| !x.is_finite()) {
        return Err(p.error(name, format!("'{name}' is so small that its inverse is not finite")));
    }
    Ok(rows)
}

fn gaussian_nd(p: &Parameters) -> Result<Profile> {
    let fields = p.texts("fields")?;
    if !(1..=8).contains(&fields.len()) || fields.iter().any(String::is_empty) {
        return Err(p
            .error("fields", "the number of fields is out of range")
            .found(fields.len())
            .accepted("1 to 8 names"));
    }
    let centre = p.numbers("centre")?;
    if centre.len() != fields.len() {
        let error = p.error("centre", "'centre' has the wrong length").found(centre.len());
        return Err(error.accepted(format!("{}, one number a field", fields.len())));
    }
    let matrix = kernel(p, fields.len())?;
    Ok(Profile::GaussianNd { fields, centre, matrix })
}

fn wave(p: &Parameters) -> Result<Wave> {
    Ok(Wave {
        origin: p.vector("origin")?,
        angle: p.number("angle")?.to_radians(),
        scale: p.vector("scale")?,
        period: p.number("period")?,
        band_width: p.number("band_width")?,
    })
}

fn control_points(p: &Parameters) -> Result<Vec<ControlPoint>> {
    let rows = p.rows("points")?;
    if rows.is_empty() {
        return Err(p
            .error("points", "there is no control point")
            .accepted("at least one [s, r, g, b, extinction]"));
    }
    if let Some(pair) = rows.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let found = format!("{} after {}", pair[1][0], pair[0][0]);
        return Err(p
            .error("points", "the control points do not rise in s")
            .found(found)
            .accepted("s rising"));
    }
    if let Some(row) = rows.iter().find(|row| row[1..].iter().any(|&x| x < 0.0)) {
        let error = p.error("points", "a control point has a negative colour or extinction");
        return Err(error.found(format!("{row:?}")).accepted("0 or more"));
    }
    let point =
        |row: &Vec<f64>| ControlPoint { s: row[0], color: [row[1], row[2], row[3]], extinction: row[4] };
    Ok(rows.iter().map(point).collect())
}

fn table(p: &Parameters, load_image: LoadImage) -> Result<Profile> {
    let (s, g): ([f64; 2], [f64; 2]) = (p.vector("s")?, p.vector("g")?);
    for (name, [low, high]) in [("s", s), ("g", g)] {
        if low >= high {
            let error =
                p.error(name, format!("the range '{name}' is empty")).found(format!("[{low}, {high}]"));
            return Err(error.accepted("the smaller number first"));
        }
    }
    let (width, height, texels) = load_image(p.text("image")?)?;
    Ok(Profile::Table(Arc::new(Table { width, height, texels, s, g })))
}

/// The region: a rectangle, whose missing limits are infinite, or a convex polygon.
fn polygon(p: &Parameters) -> Result<Region> {
    let limits = |name: &str| -> Result<[f64; 2]> {
        if p.optional(name).is_none() {
            return Ok([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let [low, high] = p.vector(name)?;
        if low > high {
            let error = p.error(name, format!("the range '{name}' of the region is empty"));
            return Err(error.found(format!("[{low}, {high}]")).accepted("the smaller number first"));
        }
        Ok([low, high])
    };
    if p.optional("polygon").is_none() {
        if p.optional("s").is_none() && p.optional("g").is_none() {
            return Err(p
                .error("s", "the region has no limits")
                .accepted("s = [low, high], g = [low, high] or polygon"));
        }
        return Ok(Region::rectangle(limits("s")?, limits("g")?));
    }
    if p.optional("s").is_some() || p.optional("g").is_some() {
        return Err(p.error("polygon", "'polygon' and the ranges 's' and 'g' exclude each other"));
    }
    let corners: Vec<[f64; 2]> = p.rows("polygon")?.iter().map(|row| [row[0], row[1]]).collect();
    if !is_convex(&corners) {
        let error = p.error("polygon", "the region is not a convex polygon with an area");
        return Err(error.accepted("at least three corners in order around a convex polygon"));
    }
    Ok(Region { corners })
}

/// Whether the corners go once around a convex polygon with an area, in either direction.
fn is_convex(corners: &[[f64; 2]]) -> bool {
    let n = corners.len();
    // Scaled to the unit square, so that units of s and g do not matter.
    let extent = |axis: usize| {
        let values = corners.iter().map(|c| c[axis]);
        let low = values.clone().fold(f64::INFINITY, f64::min);
        (low, values.fold(f64::NEG_INFINITY, f64::max) - low)
    };
    let (s, g) = (extent(0), extent(1));
    if n < 3 || !(s.1 > 0.0 && g.1 > 0.0) {
        return false;
    }
    let scaled: Vec<[f64; 2]> = corners.iter().map(|c| [(c[0] - s.0) / s.1, (c[1] - g.0) / g.1]).collect();
    let edge = |i: usize| {
        let (a, b) = (scaled[i % n], scaled[(i + 1) % n]);
        [b[0] - a[0], b[1] - a[1]]
    };
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    // Rounding of coordinates near 1; corners on a straight line are allowed.
    let slack = 1e-12;
    let turns: Vec<f64> = (0..n).map(|i| cross(edge(i), edge(i + 1))).collect();
    let one_way = turns.iter().all(|&t| t >= -slack) || turns.iter().all(|&t| t <= slack);
    // A star turns one way too, but more than once around.
    let angle = |i: usize| {
        let (a, b) = (edge(i), edge(i + 1));
        cross(a, b).atan2(a[0] * b[0] + a[1] * b[1])
    };
    let around: f64 = (0..n).map(angle).sum::<f64>().abs();
    one_way && turns.iter().any(|t| t.abs() > slack) && (around - std::f64::consts::TAU).abs() < 1e-6
}
