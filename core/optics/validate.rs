//! What a transfer function must fulfil before anything is drawn with it.

use super::gaussian::FIELD_LIMIT;
use crate::transfer::{OpticalModel, Profile, TransferFunction, Wave, Widget};
use crate::{Error, Result};

/// Checks every number of the transfer function.
pub fn validate(transfer_function: &TransferFunction) -> Result<()> {
    let u = transfer_function.unit_distance;
    if !(u > 0.0 && u.is_finite()) {
        return Err(Error::usage("the unit distance is not a length").found(u).accepted("a number > 0"));
    }
    if let OpticalModel::ConstantEmitter { cutoff } = transfer_function.model
        && !(0.0..1.0).contains(&cutoff)
    {
        return Err(Error::usage("the cutoff is out of range").found(cutoff).accepted("0 ≤ cutoff < 1"));
    }
    for (i, widget) in transfer_function.widgets.iter().enumerate() {
        check(widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
    }
    Ok(())
}

fn check(widget: &Widget) -> Result<()> {
    not_negative("the extinction", widget.extinction)?;
    for c in widget.color {
        not_negative("a colour component", c)?;
    }
    match &widget.profile {
        Profile::Uniform => {
            if widget.region.is_none() {
                return Err(Error::usage("a uniform widget has no region").accepted("a region"));
            }
        }
        Profile::Gaussian { centre, matrix } => {
            finite("the centre", centre)?;
            finite("the matrix", matrix.as_flattened())?;
        }
        Profile::GaussianNd { fields, centre, matrix } => {
            let n = fields.len();
            if !(1..=FIELD_LIMIT).contains(&n) {
                return Err(Error::usage("a gaussian-nd widget has a wrong number of fields")
                    .found(n)
                    .accepted(format!("1 to {FIELD_LIMIT}")));
            }
            if centre.len() != n {
                return Err(Error::usage("the centre does not fit the fields")
                    .found(centre.len())
                    .accepted(format!("{n} numbers, one a field")));
            }
            if matrix.len() != n || matrix.iter().any(|row| row.len() != n) {
                return Err(Error::usage("the matrix does not fit the fields")
                    .found(format!("{} rows", matrix.len()))
                    .accepted(format!("{n} × {n} numbers")));
            }
            finite("the centre", centre)?;
            for row in matrix {
                finite("the matrix", row)?;
            }
        }
        Profile::TriangularGaussian { centre, sigma } => {
            finite("the centre", &[*centre])?;
            positive("sigma", *sigma)?;
        }
        Profile::TriangleWave(wave) | Profile::SineWave(wave) => check_wave(wave)?,
        Profile::PiecewiseLinear { points } => {
            if points.is_empty() {
                return Err(
                    Error::usage("a piecewise-linear widget has no control points").accepted("at least one")
                );
            }
            for (i, point) in points.iter().enumerate() {
                let place = |e: Error| e.at_item(format!("points[{i}]"));
                finite("the scalar of a control point", &[point.s]).map_err(place)?;
                not_negative("the extinction of a control point", point.extinction).map_err(place)?;
                for c in point.color {
                    not_negative("a colour component", c).map_err(place)?;
                }
            }
            if let Some(pair) = points.windows(2).find(|pair| pair[1].s < pair[0].s) {
                return Err(Error::usage("control points are not in rising order of the scalar")
                    .found(format!("{} after {}", pair[1].s, pair[0].s)));
            }
        }
        Profile::Table(table) => {
            if table.width == 0 || table.height == 0 || table.texels.len() != table.width * table.height {
                return Err(Error::usage("a table's texels do not fit its size")
                    .found(table.texels.len())
                    .accepted(format!("{} × {}", table.width, table.height)));
            }
            for (name, range) in [("s", table.s), ("g", table.g)] {
                if !(range[0] < range[1] && (range[1] - range[0]).is_finite()) {
                    return Err(Error::usage(format!("a table's range of {name} is empty"))
                        .found(format!("{range:?}"))
                        .accepted("[a, b] with a < b"));
                }
            }
            if table.texels.iter().flatten().any(|c| !(*c >= 0.0 && c.is_finite())) {
                return Err(Error::usage("a table holds a texel that is negative or not a number"));
            }
        }
    }
    Ok(())
}

fn check_wave(wave: &Wave) -> Result<()> {
    finite("the origin", &wave.origin)?;
    finite("the scale", &wave.scale)?;
    finite("the angle", &[wave.angle])?;
    positive("the period", wave.period)?;
    if wave.band_width > 0.0 && wave.band_width <= 1.0 {
        return Ok(());
    }
    Err(Error::usage("the band width is out of range").found(wave.band_width).accepted("0 < band width ≤ 1"))
}

fn finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(v) => Err(Error::usage(format!("{what} is not finite")).found(v).accepted("finite numbers")),
    }
}

fn not_negative(what: &str, value: f64) -> Result<()> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is negative or not finite")).found(value).accepted("a number ≥ 0"))
}

fn positive(what: &str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is not positive")).found(value).accepted("a number > 0"))
}
