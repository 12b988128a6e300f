//! The parameters of shading, declared once for the nodes that draw.

use voltet_core::Result;
use voltet_graph::{DefaultValue, Parameter, ParameterType, Parameters, Range};
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::{INTEGRATOR, stated};
use voltet_optics::shading::{Light, Shading};

/// The parameters of shading, for the declarations of `composite` and `renderer`; those of the integrators stand beside them.
pub const PARAMETERS: [Parameter; 4] = [
    Parameter {
        name: INTEGRATOR,
        parameter_type: ParameterType::Registered("an integrator"),
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
    let integrator = stated(p)?;
    integrator.check().map_err(|error| p.locate("integrator", error))?;
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
