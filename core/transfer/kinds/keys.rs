//! Keys that several kinds have, and what is read from them.
//!
//! The file gives angles in degrees and widths as σ; the library takes radians and the matrix K with
//! K = diag(1/(√2 σ)) for the axis-aligned Gaussian (docs/optics.md, section 5).

use super::{DECLARED, Profile, WIDGET_KINDS};
use crate::parameters::{Kind, Parameter, ParameterType, Parameters, Range, Standard};
use crate::transfer::{Region, Widget};
use crate::{Error, Result};

/// Reads the image of a table widget: width, height and straight linear RGBA texels, row 0 at the top.
pub type LoadImage<'a> = &'a dyn Fn(&str) -> Result<(usize, usize, Vec<[f32; 4]>)>;

/// A kind as it is declared, and how its profile is read.
pub(super) struct Declared {
    pub kind: Kind,
    pub read: fn(&Parameters, LoadImage) -> Result<Profile>,
}

/// One widget of the given kind from its keys.
pub fn read(kind: &str, p: &Parameters, load_image: LoadImage) -> Result<Widget> {
    let Some(declared) = DECLARED.iter().find(|declared| declared.kind.name == kind) else {
        let names: Vec<&str> = WIDGET_KINDS.iter().map(|kind| kind.name).collect();
        return Err(Error::usage("unknown kind of widget").found(kind).accepted(names.join(", ")));
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

pub(super) const COLOR: Parameter = Parameter {
    name: "color",
    parameter_type: ParameterType::Numbers(Some(3), Range::at_least(0.0)),
    unit: "linear RGB",
    standard: Standard::Required,
    help: "colour; components may exceed 1",
};

pub(super) const EXTINCTION: Parameter = Parameter {
    name: "extinction",
    parameter_type: ParameterType::Number(Range::at_least(0.0)),
    unit: "per unit_distance",
    standard: Standard::Required,
    help: "peak of the extinction coefficient: light is dimmed by exp(-extinction) over one unit distance",
};

pub(super) const REGION: Parameter = Parameter {
    name: "region",
    parameter_type: ParameterType::Table(REGION_KEYS),
    unit: "",
    standard: Standard::Unset("the whole plane"),
    help: "the widget is 0 outside this part of the (s, g) plane",
};

const REGION_KEYS: &[Parameter] = &[
    Parameter {
        name: "s",
        parameter_type: LIMITS,
        unit: "units of s",
        standard: Standard::Unset("no limit"),
        help: "range of the scalar, [low, high]",
    },
    Parameter {
        name: "g",
        parameter_type: LIMITS,
        unit: "units of g",
        standard: Standard::Unset("no limit"),
        help: "range of the gradient magnitude, [low, high]",
    },
    Parameter {
        name: "polygon",
        parameter_type: ParameterType::Rows(Some(2)),
        unit: "(s, g)",
        standard: Standard::Unset("the ranges s and g"),
        help: "corners [s, g] of a convex polygon, in place of the ranges",
    },
];

const LIMITS: ParameterType = ParameterType::Numbers(Some(2), Range::ANY_OR_INFINITE);

/// What a standard deviation may be: an infinite one ignores its axis.
pub(super) const POSITIVE_OR_INFINITE: Range = Range { infinite: true, ..Range::above(0.0) };

pub(super) const SIGMA: Parameter = Parameter {
    name: "sigma",
    parameter_type: ParameterType::Numbers(None, POSITIVE_OR_INFINITE),
    unit: "",
    standard: Standard::Unset("matrix is given"),
    help: "",
};

pub(super) const MATRIX: Parameter = Parameter {
    name: "matrix",
    parameter_type: ParameterType::Rows(None),
    unit: "",
    standard: Standard::Unset("diag(1 / (√2 sigma))"),
    help: "K of exp(-|K (v - centre)|²), rows first, in place of sigma",
};

pub(super) const FIELDS: Parameter = Parameter {
    name: "fields",
    parameter_type: ParameterType::Texts,
    unit: "",
    standard: Standard::Required,
    help: "names of one to eight point arrays; \"NAME:0\" and \"NAME:magnitude\" for vectors",
};

pub(super) const CENTRE_OF_FIELDS: Parameter = Parameter {
    name: "centre",
    parameter_type: ParameterType::Numbers(None, Range::ANY),
    unit: "units of the fields",
    standard: Standard::Required,
    help: "the middle of the widget, one number a field",
};

pub(super) const SIGMA_OF_FIELDS: Parameter = Parameter {
    unit: "units of the fields",
    help: "standard deviations, one a field; inf ignores the field",
    ..SIGMA
};

pub(super) const MATRIX_OF_FIELDS: Parameter = Parameter { unit: "1 / units of the fields", ..MATRIX };

/// `fields` and `centre` of a widget over so many fields at most.
pub(super) fn fields_and_centre(p: &Parameters, most: usize) -> Result<(Vec<String>, Vec<f64>)> {
    let fields = p.texts("fields")?;
    if !(1..=most).contains(&fields.len()) || fields.iter().any(String::is_empty) {
        return Err(p
            .error("fields", "the number of fields is out of range")
            .found(fields.len())
            .accepted(format!("1 to {most} names")));
    }
    let centre = p.numbers("centre")?;
    if centre.len() != fields.len() {
        let error = p.error("centre", "'centre' has the wrong length").found(centre.len());
        return Err(error.accepted(format!("{}, one number a field", fields.len())));
    }
    Ok((fields, centre))
}

/// K from `matrix`, or diag(1/(`per_width` σ)) from `sigma`: n rows of n.
pub(super) fn kernel(p: &Parameters, n: usize, per_width: f64) -> Result<Vec<Vec<f64>>> {
    let rows = match (p.optional("sigma"), p.optional("matrix")) {
        (Some(_), Some(_)) => return Err(p.error("matrix", "'sigma' and 'matrix' exclude each other")),
        (None, None) => return Err(p.error("sigma", "the widget needs 'sigma' or 'matrix'")),
        (Some(_), None) => {
            let sigma = p.numbers("sigma")?;
            let inverse = |i: usize| 1.0 / (per_width * sigma[i]);
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
