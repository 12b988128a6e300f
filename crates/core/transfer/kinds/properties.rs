//! Parts that kinds of widgets share: properties, keys of pipeline files and their reading, and checks of single numbers.
//!
//! The file gives angles in degrees and widths as σ; the library takes radians and the matrix K with
//! K = diag(1/(√2 σ)) for the axis-aligned Gaussian (docs/src/explanation/optics.md, section 5).

use crate::colormap::{ColorCurve, Colormap};
use crate::parameters::{
    AxisRef, DefaultValue, ENTRY_NAME, Parameter, ParameterType, Parameters, Range, RelativeNumberType,
    StatisticKind,
};
use crate::transfer::region::Region;
use crate::{Error, Result, counted};

/// Most fields of a widget that looks at a list of its own.
pub const MAX_FIELDS: usize = 8;

/// φ = ((s − s₀) cos θ·w_s + (g − g₀) sin θ·w_g) / period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// [s₀, g₀].
    pub origin: [f64; 2],
    /// θ in radians (files give degrees).
    pub angle: f64,
    /// [w_s, w_g].
    pub scale: [f64; 2],
    /// One period of φ is one band; > 0.
    pub period: f64,
    /// Share of the profile kept around its peaks, in (0, 1].
    pub band_width: f64,
}

/// A control point of a piecewise-linear widget.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlPoint {
    /// Scalar.
    pub s: f64,
    /// Linear RGB.
    pub color: [f64; 3],
    /// Extinction per unit distance.
    pub extinction: f64,
}

/// A transfer function painted as an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Columns (along s).
    pub width: usize,
    /// Rows (along g; row 0 at the largest g).
    pub height: usize,
    /// Straight linear RGB and alpha, row-major.
    pub texels: Vec<[f32; 4]>,
    /// [s_a, s_b].
    pub s: [f64; 2],
    /// [g_a, g_b].
    pub g: [f64; 2],
}

/// Properties of a profile that hold for every engine.
#[derive(Debug, Clone, PartialEq)]
pub struct Properties<'a> {
    /// The kind's name in pipeline files.
    pub name: &'static str,
    /// Source of the colour.
    pub color: ColorSource<'a>,
    /// The largest extinction per unit distance, where the profile holds extinctions and not shares of the widget's.
    pub own_peak: Option<f64>,
    /// Names of the further point arrays that it looks at.
    pub fields: Vec<&'a str>,
    /// True if it looks at the gradient magnitude.
    pub depends_on_g: bool,
    /// Best origins of s, g and each of the fields; any where the list is too short.
    pub axes: Vec<AxisOrigin>,
    /// The bands of a profile that is periodic in s and g.
    pub bands: Option<BandSpacing>,
    /// True if it jumps somewhere, so that sampling converges by first order only.
    pub jumps: bool,
    /// The part of the plane outside which it is 0, beside the widget's region.
    pub range: Option<Region>,
    /// True if it is drawn only inside a region, which must be given.
    pub needs_region: bool,
    /// True if its mean over a segment is an elementary function (with erf and polynomials), so that no quadrature
    /// has a part in the optical depth.
    pub has_elementary_mean: bool,
}

impl Properties<'_> {
    /// Properties of a profile in the widget's colour that is smooth, of neither g nor fields, everywhere, with an elementary mean.
    pub(super) const PLAIN: Properties<'static> = Properties {
        name: "",
        color: ColorSource::Widget,
        own_peak: None,
        fields: Vec::new(),
        depends_on_g: false,
        axes: Vec::new(),
        bands: None,
        jumps: false,
        range: None,
        needs_region: false,
        has_elementary_mean: true,
    };
}

/// The bands of a periodic profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandSpacing {
    /// [s₀, g₀], where φ = 0.
    pub origin: [f64; 2],
    /// φ per unit of s and of g; one band is a unit of φ.
    pub step: [f64; 2],
}

/// Source of a widget's colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColorSource<'a> {
    /// The widget has one.
    Widget,
    /// Linear between those of control points.
    Points(&'a [ControlPoint]),
    /// Bilinear between those of texels.
    Texels(&'a [[f32; 4]]),
}

/// Best origin of an axis' values, for a profile to keep its digits in 32 bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxisOrigin {
    /// From anywhere.
    Any,
    /// From here: only differences from it matter.
    Centre(f64),
    /// From 0: the values are widths themselves, and small ones matter.
    Zero,
}

/// Loader of the files that widgets name.
pub trait LoadFiles {
    /// Image of a table: width, height and straight linear RGBA texels, row 0 at the top.
    fn image(&self, path: &str) -> Result<(usize, usize, Vec<[f32; 4]>)>;

    /// Colours of a colour map file.
    fn colors(&self, path: &str) -> Result<ColorCurve>;
}

/// Stand-ins for files that are not read: a clear texel, and any colours.
#[derive(Debug, Clone, Copy)]
pub struct UnreadFiles;

impl LoadFiles for UnreadFiles {
    fn image(&self, _path: &str) -> Result<(usize, usize, Vec<[f32; 4]>)> {
        Ok((1, 1, vec![[0.0; 4]]))
    }

    fn colors(&self, _path: &str) -> Result<ColorCurve> {
        Ok(Colormap::Viridis.curve())
    }
}

pub(super) const COLOR: Parameter = Parameter {
    name: "color",
    parameter_type: ParameterType::Color(Range::at_least(0.0)),
    unit: "linear RGB",
    default: DefaultValue::Required,
    help: "colour; components may exceed 1",
};

pub(super) const EXTINCTION: Parameter = Parameter {
    name: "extinction",
    parameter_type: ParameterType::Number(Range::at_least(0.0)),
    unit: "per unit_distance",
    default: DefaultValue::Required,
    help: "peak of the extinction coefficient: light is dimmed by exp(-extinction) over one unit distance",
};

/// A name for people: no engine reads it.
pub(super) const NAME: Parameter = Parameter {
    name: ENTRY_NAME,
    parameter_type: ParameterType::Text,
    unit: "",
    default: DefaultValue::Unset("the comment before the widget"),
    help: "what the widget shows, such as \"bone\": the editor's name for it",
};

pub(super) const REGION: Parameter = Parameter {
    name: "region",
    parameter_type: ParameterType::Table(REGION_KEYS),
    unit: "",
    default: DefaultValue::Unset("the whole plane"),
    help: "the widget is 0 outside this part of the (s, g) plane",
};

const REGION_KEYS: &[Parameter] = &[
    Parameter {
        name: "s",
        parameter_type: ParameterType::Measured(&RelativeNumberType { axis: AxisRef::Every("s"), ..LIMITS }),
        unit: "units of s",
        default: DefaultValue::Unset("no limit"),
        help: "range of the scalar, [low, high]",
    },
    Parameter {
        name: "g",
        parameter_type: ParameterType::Measured(&RelativeNumberType { axis: AxisRef::Every("g"), ..LIMITS }),
        unit: "units of g",
        default: DefaultValue::Unset("no limit"),
        help: "range of the gradient magnitude, [low, high]",
    },
    Parameter {
        name: "polygon",
        parameter_type: ParameterType::Measured(&RelativeNumberType {
            plain: ParameterType::Rows(Some(2)),
            statistic: StatisticKind::Value,
            axis: AxisRef::Places(&["s", "g"]),
        }),
        unit: "(s, g)",
        default: DefaultValue::Unset("the ranges s and g"),
        help: "corners [s, g] of a convex polygon, in place of the ranges",
    },
];

const LIMITS: RelativeNumberType = RelativeNumberType {
    plain: ParameterType::Numbers(Some(2), Range::ANY_OR_INFINITE),
    statistic: StatisticKind::Value,
    axis: AxisRef::Every("s"),
};

/// [s, g], each a value of its axis.
pub(super) const PLACE: ParameterType = ParameterType::Measured(&RelativeNumberType {
    plain: ParameterType::Numbers(Some(2), Range::ANY),
    statistic: StatisticKind::Value,
    axis: AxisRef::Places(&["s", "g"]),
});

/// The middle of a Gaussian.
pub(super) const CENTRE: Parameter = Parameter {
    name: "centre",
    parameter_type: PLACE,
    unit: "(s, g)",
    default: DefaultValue::Required,
    help: "the middle of the widget, [s, g]",
};

/// Valid standard deviations: an infinite one ignores its axis.
pub(super) const POSITIVE_OR_INFINITE: Range = Range { infinite: true, ..Range::above(0.0) };

pub(super) const SIGMA: Parameter = Parameter {
    name: "sigma",
    parameter_type: ParameterType::Numbers(None, POSITIVE_OR_INFINITE),
    unit: "",
    default: DefaultValue::Unset("matrix is given"),
    help: "",
};

pub(super) const MATRIX: Parameter = Parameter {
    name: "matrix",
    parameter_type: ParameterType::Rows(None),
    unit: "",
    default: DefaultValue::Unset("diag(1 / (√2 sigma))"),
    help: "K of exp(-|K (v - centre)|²), rows first, in place of sigma",
};

pub(super) const FIELDS: Parameter = Parameter {
    name: "fields",
    parameter_type: ParameterType::ArrayNames,
    unit: "",
    default: DefaultValue::Required,
    help: "names of one to eight point arrays; \"NAME:0\" and \"NAME:magnitude\" for vectors",
};

pub(super) const CENTRE_OF_FIELDS: Parameter = Parameter {
    name: "centre",
    parameter_type: ParameterType::Measured(&RelativeNumberType {
        plain: ParameterType::Numbers(None, Range::ANY),
        statistic: StatisticKind::Value,
        axis: AxisRef::Names("fields"),
    }),
    unit: "units of the fields",
    default: DefaultValue::Required,
    help: "the middle of the widget, one number a field",
};

pub(super) const SIGMA_OF_FIELDS: Parameter = Parameter {
    parameter_type: ParameterType::Measured(&RelativeNumberType {
        plain: ParameterType::Numbers(None, POSITIVE_OR_INFINITE),
        statistic: StatisticKind::Width,
        axis: AxisRef::Names("fields"),
    }),
    unit: "units of the fields",
    help: "standard deviations, one a field; inf ignores the field",
    ..SIGMA
};

pub(super) const MATRIX_OF_FIELDS: Parameter = Parameter {
    parameter_type: ParameterType::Measured(&RelativeNumberType {
        plain: ParameterType::Rows(None),
        statistic: StatisticKind::Factor,
        axis: AxisRef::Names("fields"),
    }),
    unit: "1 / units of the fields",
    ..MATRIX
};

/// Fields, centre and matrix, row by row, of a widget over a list of fields.
pub(super) type FieldsOfWidget = (Vec<String>, Vec<f64>, Vec<Vec<f64>>);

/// `fields`, `centre` and K ([`kernel`]) of a widget over so many fields at most.
pub(super) fn fields_of(p: &Parameters, most: usize, per_width: f64) -> Result<FieldsOfWidget> {
    let fields = p.texts("fields")?;
    if !(1..=most).contains(&fields.len()) || fields.iter().any(String::is_empty) {
        return Err(p
            .error("fields", "the number of fields is out of range")
            .got(fields.len())
            .expected(format!("1 to {most} names")));
    }
    let centre = p.numbers("centre")?;
    if centre.len() != fields.len() {
        let error = p.error("centre", "'centre' has the wrong length").got(centre.len());
        return Err(error.expected(format!("{}, one a field", counted(fields.len(), "number"))));
    }
    let matrix = kernel(p, fields.len(), per_width)?;
    Ok((fields, centre, matrix))
}

/// K from `matrix`, or diag(1/(`per_width` σ)) from `sigma`: n rows of n.
pub(super) fn kernel(p: &Parameters, n: usize, per_width: f64) -> Result<Vec<Vec<f64>>> {
    let rows = match (p.optional("sigma"), p.optional("matrix")) {
        (Some(_), Some(_)) => {
            return Err(p.error("matrix", "'sigma' and 'matrix' exclude each other").expected("one of them"));
        }
        (None, None) => {
            return Err(p
                .error("sigma", "the widget needs 'sigma' or 'matrix'")
                .expected("sigma, its widths along the axes, or matrix"));
        }
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
            .got(found)
            .expected(format!("{n} × {n}")));
    }
    if rows.iter().flatten().any(|x| !x.is_finite()) {
        return Err(p.error(name, format!("'{name}' is so small that its inverse is not finite")));
    }
    Ok(rows)
}

pub(super) fn finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(v) => Err(Error::usage(format!("{what} is not finite")).got(v).expected("finite numbers")),
    }
}

/// 0 ≤ value < ∞.
pub(in crate::transfer) fn not_negative(what: &str, value: f64) -> Result<()> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is negative or not finite")).got(value).expected("a number ≥ 0"))
}

/// 0 < value < ∞.
pub(super) fn positive(what: &str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("{what} is not positive")).got(value).expected("a number > 0"))
}
