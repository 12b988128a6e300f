//! The parameters of shading, declared once for the nodes that draw.

use voltet_core::Result;
use voltet_graph::{DefaultValue, Parameter, ParameterType, Parameters, Range};
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::{
    Numbers, OVERSAMPLING_MOST, PARTIAL_SIDE_MOST, PLANES_MOST, STANDARD_OVERSAMPLING, STANDARD_PIECES,
    STANDARD_PLANES, STANDARD_SIDE,
};
use voltet_optics::shading::{Integrator, Light, Shading};

/// The numbers of an integrator that nobody sets.
pub const USUAL: Numbers = Numbers {
    tolerance: Some(TOLERANCE),
    count: Some(STANDARD_PIECES),
    table_size: Some(STANDARD_SIDE),
    oversampling: Some(STANDARD_OVERSAMPLING),
    planes: Some(STANDARD_PLANES),
};

const TOLERANCE: f64 = 1e-3;

/// The parameters of shading, for the declarations of `composite` and `renderer`.
pub const PARAMETERS: [Parameter; 9] = [
    Parameter {
        name: "integrator",
        parameter_type: ParameterType::Choice(&Integrator::WORDS),
        unit: "",
        default: DefaultValue::Text("analytic"),
        help: "how the light of one ray segment is found",
    },
    Parameter {
        name: "overlap",
        parameter_type: ParameterType::Choice(&[
            ("exact", "in their order along the ray"),
            ("mix", "optical depths added, colours averaged; fast"),
        ]),
        unit: "",
        default: DefaultValue::Text("exact"),
        help: "what happens where several widgets are active on one stretch",
    },
    Parameter {
        name: "segments",
        parameter_type: ParameterType::Integer(Range::within(1.0, 65536.0)),
        unit: "",
        default: DefaultValue::Integer(STANDARD_PIECES as i64),
        help: "segments and riemann: pieces of each ray segment",
    },
    Parameter {
        name: "tolerance",
        parameter_type: ParameterType::Number(Range { above_min: true, ..Range::within(0.0, 1.0) }),
        unit: "",
        default: DefaultValue::Number(TOLERANCE),
        help: "adaptive: largest error of colour and opacity of a ray segment",
    },
    Parameter {
        name: "table_size",
        parameter_type: ParameterType::Integer(Range::within(2.0, PARTIAL_SIDE_MOST as f64)),
        unit: "entries a side",
        default: DefaultValue::Integer(STANDARD_SIDE as i64),
        help: "segments, pre-integrated, tabulated: side of the table; 512 at most where it has three dimensions",
    },
    Parameter {
        name: "oversampling",
        parameter_type: ParameterType::Integer(Range::within(1.0, OVERSAMPLING_MOST as f64)),
        unit: "pieces",
        default: DefaultValue::Integer(STANDARD_OVERSAMPLING as i64),
        help: "pre-integrated: pieces of a path from one entry of the table to the next",
    },
    Parameter {
        name: "planes",
        parameter_type: ParameterType::Integer(Range::within(1.0, PLANES_MOST as f64)),
        unit: "times table_size",
        default: DefaultValue::Integer(STANDARD_PLANES as i64),
        help: "pre-integrated-cylindrical: planes that the table is resampled to; in all no more entries than for 512 once",
    },
    Parameter {
        name: "silhouette",
        parameter_type: ParameterType::Number(Range::at_least(0.0)),
        unit: "",
        default: DefaultValue::Unset("no enhancement"),
        help: "exponent p: opacity times (1 - |gradient · view|)^p brings out silhouettes",
    },
    Parameter {
        name: "light",
        parameter_type: ParameterType::Table(&[
            Parameter {
                name: "direction",
                parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
                unit: "world space",
                default: DefaultValue::Required,
                help: "direction of the light; any length above 0",
            },
            Parameter {
                name: "ambient",
                parameter_type: ParameterType::Number(Range::at_least(0.0)),
                unit: "",
                default: DefaultValue::Number(0.3),
                help: "share of the colour that needs no light",
            },
            Parameter {
                name: "diffuse",
                parameter_type: ParameterType::Number(Range::at_least(0.0)),
                unit: "",
                default: DefaultValue::Number(0.7),
                help: "share of the colour that faces the light",
            },
        ]),
        unit: "",
        default: DefaultValue::Unset("no light"),
        help: "diffuse light: colour times (ambient + diffuse |gradient · direction|)",
    },
];

/// The shading that the parameters state.
pub fn shading(p: &Parameters) -> Result<Shading> {
    let overlap = if p.text("overlap")? == "mix" { WidgetBlend::Mix } else { WidgetBlend::Exact };
    let integrator = integrator(p)?;
    integrator.check().map_err(|error| p.locate("table_size", error))?;
    Ok(Shading { integrator, overlap, silhouette: p.optional_number("silhouette"), light: light(p)? })
}

fn light(p: &Parameters) -> Result<Option<Light>> {
    let Some(light) = p.table("light")? else { return Ok(None) };
    let direction: glam::DVec3 = light.vector("direction")?.into();
    if direction == glam::DVec3::ZERO {
        return Err(light
            .error("direction", "the light has no direction")
            .expected("a vector that is not zero"));
    }
    Ok(Some(Light { direction, ambient: light.number("ambient")?, diffuse: light.number("diffuse")? }))
}

fn integrator(p: &Parameters) -> Result<Integrator> {
    let named = p.text("integrator")?;
    let kind = Integrator::EVERY.into_iter().find(|kind| kind.name() == named).ok_or_else(|| {
        p.error("integrator", format!("the integrator '{named}' is declared but not known"))
    })?;
    let whole = |name| p.integer(name).map(|n| Some(n as usize));
    Ok(kind.with(Numbers {
        tolerance: Some(p.number("tolerance")?),
        count: whole("segments")?,
        table_size: whole("table_size")?,
        oversampling: whole("oversampling")?,
        planes: whole("planes")?,
    }))
}
