//! A widget from the keys of a pipeline file (docs/optics.md, section 5).

use crate::parameters::Parameters;
use crate::transfer::kinds::{DECLARED, LoadImage, WIDGET_KINDS};
use crate::transfer::region::Region;
use crate::transfer::widget::Widget;
use crate::{Error, Result};

/// One widget of the given kind from its keys.
pub fn read(kind: &str, p: &Parameters, load_image: LoadImage) -> Result<Widget> {
    let Some(declared) = DECLARED.iter().find(|declared| declared.kind.name == kind) else {
        let names: Vec<&str> = WIDGET_KINDS.iter().map(|kind| kind.name).collect();
        return Err(Error::usage("unknown kind of widget").got(kind).expected(names.join(", ")));
    };
    let profile = (declared.read)(p, load_image)?;
    let extinction = match profile.properties().own_peak {
        Some(peak) => peak,
        None => p.number("extinction")?,
    };
    let color = if p.optional("color").is_some() { p.vector("color")? } else { [1.0; 3] };
    let region = p.table("region")?.map(|region| polygon(&region)).transpose()?;
    Ok(Widget { profile, color, extinction, region })
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
            return Err(error.got(format!("[{low}, {high}]")).expected("the smaller number first"));
        }
        Ok([low, high])
    };
    if p.optional("polygon").is_none() {
        if p.optional("s").is_none() && p.optional("g").is_none() {
            return Err(p
                .error("s", "the region has no limits")
                .expected("s = [low, high], g = [low, high] or polygon"));
        }
        return Ok(Region::rectangle(limits("s")?, limits("g")?));
    }
    if p.optional("s").is_some() || p.optional("g").is_some() {
        return Err(p.error("polygon", "'polygon' and the ranges 's' and 'g' exclude each other"));
    }
    let corners: Vec<[f64; 2]> = p.rows("polygon")?.iter().map(|row| [row[0], row[1]]).collect();
    if !is_convex(&corners) {
        let error = p.error("polygon", "the region is not a convex polygon with an area");
        return Err(error.expected("at least three corners in order around a convex polygon"));
    }
    Ok(Region { corners })
}

/// True if the corners go once around a convex polygon with an area, in either direction.
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
