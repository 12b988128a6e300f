//! The declarations of the widget kinds.

use crate::graph::{Kind, Parameter, ParameterType, Range, Standard};

const fn parameter(
    name: &'static str,
    parameter_type: ParameterType,
    unit: &'static str,
    standard: Standard,
    help: &'static str,
) -> Parameter {
    Parameter { name, parameter_type, unit, standard, help }
}

const COLOR: Parameter = parameter(
    "color",
    ParameterType::Numbers(Some(3), Range::at_least(0.0)),
    "linear RGB",
    Standard::Required,
    "colour; components may exceed 1",
);
const EXTINCTION: Parameter = parameter(
    "extinction",
    ParameterType::Number(Range::at_least(0.0)),
    "per unit_distance",
    Standard::Required,
    "peak of the extinction coefficient: light is dimmed by exp(-extinction) over one unit distance",
);
const LIMITS: ParameterType = ParameterType::Numbers(Some(2), Range::ANY_OR_INFINITE);
const REGION_KEYS: &[Parameter] = &[
    parameter("s", LIMITS, "units of s", Standard::Unset("no limit"), "range of the scalar, [low, high]"),
    parameter(
        "g",
        LIMITS,
        "units of g",
        Standard::Unset("no limit"),
        "range of the gradient magnitude, [low, high]",
    ),
    parameter(
        "polygon",
        ParameterType::Rows(Some(2)),
        "(s, g)",
        Standard::Unset("the ranges s and g"),
        "corners [s, g] of a convex polygon, in place of the ranges",
    ),
];
const REGION: Parameter = parameter(
    "region",
    ParameterType::Table(REGION_KEYS),
    "",
    Standard::Unset("the whole plane"),
    "the widget is 0 outside this part of the (s, g) plane",
);
const REQUIRED_REGION: Parameter = Parameter { standard: Standard::Required, ..REGION };
const CENTRE: Parameter = parameter(
    "centre",
    ParameterType::Numbers(Some(2), Range::ANY),
    "(s, g)",
    Standard::Required,
    "the middle of the widget, [s, g]",
);
const POSITIVE_OR_INFINITE: Range = Range { infinite: true, ..Range::above(0.0) };
const MATRIX: Parameter = parameter(
    "matrix",
    ParameterType::Rows(Some(2)),
    "1 / units of s, g",
    Standard::Unset("diag(1 / (√2 sigma))"),
    "K of exp(-|K (v - centre)|²), rows first, in place of sigma",
);
const WAVE_KEYS: &[Parameter] = &[
    COLOR,
    EXTINCTION,
    parameter(
        "origin",
        ParameterType::Numbers(Some(2), Range::ANY),
        "(s, g)",
        Standard::Numbers(&[0.0, 0.0]),
        "a point where the wave is 0",
    ),
    parameter(
        "angle",
        ParameterType::Number(Range::ANY),
        "degrees",
        Standard::Number(0.0),
        "direction across the bands in the (s, g) plane; 0 bands the scalar",
    ),
    parameter(
        "scale",
        ParameterType::Numbers(Some(2), Range::ANY),
        "",
        Standard::Numbers(&[1.0, 1.0]),
        "factors on the two axes, [ws, wg]",
    ),
    parameter(
        "period",
        ParameterType::Number(Range::above(0.0)),
        "units of scaled s, g",
        Standard::Required,
        "distance between two bands",
    ),
    parameter(
        "band_width",
        ParameterType::Number(Range { above_min: true, ..Range::within(0.0, 1.0) }),
        "",
        Standard::Number(1.0),
        "share of the profile that is kept around its peaks",
    ),
    REGION,
];

/// The kinds of widgets and their keys.
pub const WIDGET_KINDS: &[Kind] = &[
    Kind {
        name: "uniform",
        summary: "The same extinction everywhere in its region.",
        parameters: &[COLOR, EXTINCTION, REQUIRED_REGION],
    },
    Kind {
        name: "gaussian",
        summary: "A Gaussian over the scalar and its gradient magnitude.",
        parameters: &[
            COLOR,
            EXTINCTION,
            CENTRE,
            parameter(
                "sigma",
                ParameterType::Numbers(Some(2), POSITIVE_OR_INFINITE),
                "(s, g)",
                Standard::Unset("matrix is given"),
                "standard deviations along s and g; inf ignores the axis",
            ),
            MATRIX,
            REGION,
        ],
    },
    Kind {
        name: "gaussian-nd",
        summary: "A Gaussian over one to eight point arrays.",
        parameters: &[
            COLOR,
            EXTINCTION,
            parameter(
                "fields",
                ParameterType::Texts,
                "",
                Standard::Required,
                "names of one to eight point arrays; \"NAME:0\" and \"NAME:magnitude\" for vectors",
            ),
            parameter(
                "centre",
                ParameterType::Numbers(None, Range::ANY),
                "units of the fields",
                Standard::Required,
                "the middle of the widget, one number a field",
            ),
            parameter(
                "sigma",
                ParameterType::Numbers(None, POSITIVE_OR_INFINITE),
                "units of the fields",
                Standard::Unset("matrix is given"),
                "standard deviations, one a field; inf ignores the field",
            ),
            Parameter {
                parameter_type: ParameterType::Rows(None),
                unit: "1 / units of the fields",
                ..MATRIX
            },
            REGION,
        ],
    },
    Kind {
        name: "triangular-gaussian",
        summary: "exp(-((s - centre) / (sigma g))²): a Gaussian in s that widens with the gradient magnitude.",
        parameters: &[
            COLOR,
            EXTINCTION,
            parameter(
                "centre",
                ParameterType::Number(Range::ANY),
                "units of s",
                Standard::Required,
                "the scalar in the middle",
            ),
            parameter(
                "sigma",
                ParameterType::Number(Range::above(0.0)),
                "units of s / units of g",
                Standard::Required,
                "width in s for each unit of g",
            ),
            REGION,
        ],
    },
    Kind { name: "triangle-wave", summary: "Bands with straight flanks.", parameters: WAVE_KEYS },
    Kind { name: "sine-wave", summary: "Bands shaped like |sin|.", parameters: WAVE_KEYS },
    Kind {
        name: "piecewise-linear",
        summary: "Colour and extinction linear between control points in s, constant beyond the ends.",
        parameters: &[
            parameter(
                "points",
                ParameterType::Rows(Some(5)),
                "(s, linear RGB, per unit_distance)",
                Standard::Required,
                "control points [s, r, g, b, extinction], s rising",
            ),
            REGION,
        ],
    },
    Kind {
        name: "table",
        summary: "A picture over the (s, g) plane: its colour, and its alpha times the extinction.",
        parameters: &[
            Parameter {
                standard: Standard::Unset("the picture's own"),
                help: "not used: the picture has its own",
                ..COLOR
            },
            EXTINCTION,
            parameter(
                "image",
                ParameterType::InputPath,
                "",
                Standard::Required,
                "PNG file, sRGB with alpha; its lowest row is the smallest g",
            ),
            parameter(
                "s",
                ParameterType::Numbers(Some(2), Range::ANY),
                "units of s",
                Standard::Required,
                "range of the scalar across the picture, [left, right]",
            ),
            parameter(
                "g",
                ParameterType::Numbers(Some(2), Range::ANY),
                "units of g",
                Standard::Required,
                "range of the gradient magnitude up the picture, [bottom, top]",
            ),
            REGION,
        ],
    },
];
