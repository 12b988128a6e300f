//! `colormap`: the colours of a map along s, and an opacity curve over them; a piecewise-linear function of s.

use super::properties::{ControlPoint, LoadFiles, NAME, REGION};
use crate::Result;
use crate::colormap::{ColorCurve, Colormap, NAMES, limits};
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, ParameterValue, Parameters, Range, RelativeNumberType,
    StatisticKind, VariantSchema,
};

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "colormap",
    summary: "A colour map along s, and an opacity curve over it: a piecewise-linear function of s.",
    parameters: &[
        CURVE_PARAMETERS[0],
        RANGE,
        Parameter {
            name: "centre",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Number(Range::ANY),
                ..*VALUES
            }),
            unit: "units of s",
            default: DefaultValue::Unset("the middle of the range"),
            help: "s at the map's middle colour; the range is widened to be as long on both sides of it",
        },
        Parameter {
            name: "extinction",
            parameter_type: ParameterType::Number(Range::at_least(0.0)),
            unit: "per unit_distance",
            default: DefaultValue::Number(0.1),
            help: "extinction coefficient where the opacity curve is 1",
        },
        Parameter {
            name: "opacity",
            parameter_type: ParameterType::RowsOr(2, SHAPES),
            unit: "(share of the range, share of extinction)",
            default: DefaultValue::Text("ramp"),
            help: "the extinction over the range: a shape, or points [place, share], both 0 to 1 and places rising; \
                   two points of one place are a jump",
        },
        CURVE_PARAMETERS[1],
        CURVE_PARAMETERS[2],
        Parameter {
            name: "below",
            help: "colour of s below the range, with the opacity of its low end",
            ..OUTSIDE_COLOR
        },
        Parameter {
            name: "above",
            help: "colour of s above the range, with the opacity of its high end",
            ..OUTSIDE_COLOR
        },
        REGION,
        NAME,
    ],
};

/// The range of s over which a map's colours go.
pub(super) const RANGE: Parameter = Parameter {
    name: "range",
    parameter_type: ParameterType::Measured(VALUES),
    unit: "units of s",
    default: DefaultValue::Texts(&["0 %", "100 %"]),
    help: "s at the map's first and last colour, which hold beyond it; default: all of the data",
};

/// The parameters of a map's colours, for whatever is coloured by values.
pub const CURVE_PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "colormap",
        parameter_type: ParameterType::ChoiceOrPath(NAMES, &["json", "xml"]),
        unit: "",
        default: DefaultValue::Text("viridis"),
        help: "colours by name, or of a colour map file of ParaView, whose points are stretched over the range",
    },
    Parameter {
        name: "reversed",
        parameter_type: ParameterType::Boolean,
        unit: "",
        default: DefaultValue::Boolean(false),
        help: "the colours from the last to the first; the opacity stays",
    },
    Parameter {
        name: "steps",
        parameter_type: ParameterType::Integer(Range::within(2.0, 256.0)),
        unit: "bands",
        default: DefaultValue::Unset("continuous colours"),
        help: "bands of one colour each, from the map's first to its last",
    },
];

const VALUES: &RelativeNumberType = &RelativeNumberType {
    plain: ParameterType::Numbers(Some(2), Range::ANY),
    statistic: StatisticKind::Value,
    axis: AxisRef::Every("s"),
};

const OUTSIDE_COLOR: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Color(Range::at_least(0.0)),
    unit: "linear RGB",
    default: DefaultValue::Unset("the colour at that end"),
    help: "",
};

const SHAPES: &[(&str, &str)] = &[
    ("ramp", "rises from 0 to 1"),
    ("fall", "falls from 1 to 0"),
    ("constant", "1 everywhere"),
    ("ends", "1 at both ends, 0 in the middle: what differs from the centre"),
    ("middle", "0 at both ends, 1 in the middle"),
    ("peaks", "five narrow peaks, like level surfaces"),
];

/// Half a peak's width, as a share of the range.
const HALF_PEAK: f64 = 0.02;

/// Share of the range at which the colours beyond it begin: its ends belong to it, also with 32 bits.
const END_MARGIN: f64 = 1e-6;

type Knots<const N: usize> = Vec<(f64, [f64; N])>;

/// The colours that [`CURVE_PARAMETERS`] state.
pub fn color_curve(p: &Parameters, files: &dyn LoadFiles) -> Result<ColorCurve> {
    let name = p.text("colormap")?;
    let mut curve = match Colormap::named(name) {
        Some(map) => map.curve(),
        None => files.colors(name).map_err(|error| p.locate("colormap", error))?,
    };
    if p.flag("reversed")? {
        curve = curve.reversed();
    }
    if p.optional("steps").is_some() {
        curve = curve.stepped(p.integer("steps")? as usize);
    }
    Ok(curve)
}

pub(super) fn read(p: &Parameters, files: &dyn LoadFiles) -> Result<Vec<ControlPoint>> {
    let curve = color_curve(p, files)?;
    let opacity = opacity(p)?;
    let [low, high] = ends(p)?;
    let peak = p.number("extinction")?;
    let point = |level: f64, color: [f64; 3], [share]: [f64; 1]| ControlPoint {
        s: if level <= 0.0 {
            low
        } else if level == 1.0 {
            high
        } else {
            low + (high - low) * level
        },
        color,
        extinction: peak * share,
    };
    let mut levels: Vec<f64> =
        curve.knots().iter().map(|knot| knot.0).chain(opacity.iter().map(|knot| knot.0)).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let mut points = Vec::new();
    for level in levels {
        let ([front, back], [thin, dense]) = (limits(curve.knots(), level), limits(&opacity, level));
        points.push(point(level, front, thin));
        if (front, thin) != (back, dense) {
            points.push(point(level, back, dense));
        }
    }
    if low == high {
        // What is the same everywhere has the first colour.
        points.truncate(1);
    }
    let ends = [points.first().copied(), points.last().copied()];
    if let (Some(color), Some(end)) = (p.optional_color("below")?, ends[0]) {
        let s = end.s - END_MARGIN * (high - low);
        points.splice(0..0, [ControlPoint { s, color, ..end }, ControlPoint { s, ..end }]);
    }
    if let (Some(color), Some(end)) = (p.optional_color("above")?, ends[1]) {
        let s = end.s + END_MARGIN * (high - low);
        points.extend([ControlPoint { s, ..end }, ControlPoint { s, color, ..end }]);
    }
    Ok(points)
}

pub(super) fn range(p: &Parameters) -> Result<[f64; 2]> {
    let [low, high]: [f64; 2] = p.vector("range")?;
    if low > high {
        let error = p.error("range", "the range is empty").got(format!("[{low}, {high}]"));
        return Err(error.expected("the smaller number first; reversed = true turns the colours round"));
    }
    Ok([low, high])
}

/// s at levels 0 and 1.
fn ends(p: &Parameters) -> Result<[f64; 2]> {
    let [low, high] = range(p)?;
    let Some(centre) = p.optional_number("centre") else { return Ok([low, high]) };
    let half = (centre - low).max(high - centre);
    Ok([centre - half, centre + half])
}

/// Share of the extinction over levels from 0 to 1.
fn opacity(p: &Parameters) -> Result<Knots<1>> {
    let knots = |points: &[[f64; 2]]| points.iter().map(|&[level, share]| (level, [share])).collect();
    if let ParameterValue::Text(shape) = &p.get("opacity")?.datum {
        return Ok(match shape.as_str() {
            "fall" => knots(&[[0.0, 1.0], [1.0, 0.0]]),
            "constant" => knots(&[[0.0, 1.0], [1.0, 1.0]]),
            "ends" => knots(&[[0.0, 1.0], [0.5, 0.0], [1.0, 1.0]]),
            "middle" => knots(&[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]),
            "peaks" => (0..5)
                .flat_map(|k| {
                    let level = 0.1 + 0.2 * f64::from(k);
                    [(level - HALF_PEAK, [0.0]), (level, [1.0]), (level + HALF_PEAK, [0.0])]
                })
                .collect(),
            _ => knots(&[[0.0, 0.0], [1.0, 1.0]]),
        });
    }
    let rows = p.rows("opacity")?;
    let is_share = |x: &f64| (0.0..=1.0).contains(x);
    let wrong = |what: &str, found: String, accepted: &str| {
        Err(p.error("opacity", what).got(found).expected(accepted))
    };
    if rows.is_empty() {
        return wrong("the opacity has no points", "[]".into(), "at least one [place, share]");
    }
    if let Some(row) = rows.iter().find(|row| !row.iter().all(is_share)) {
        return wrong(
            "a point of the opacity is out of range",
            format!("{row:?}"),
            "[place, share], both from 0 to 1",
        );
    }
    if let Some(pair) = rows.windows(2).find(|pair| pair[1][0] < pair[0][0]) {
        return wrong(
            "the places of the opacity do not rise",
            format!("{} after {}", pair[1][0], pair[0][0]),
            "places rising",
        );
    }
    Ok(rows.iter().map(|row| (row[0], [row[1]])).collect())
}
