//! Scenes: shading and order with their parameters, declared once for the nodes that draw; the demand of a scene on its data; values
//! that pass from stage to stage.

use super::diagnostics::note_bands;
use crate::relative::{MIDDLE, NORMAL, ORIGIN, POSITION, RADIUS, note_numbers, placed};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::clip::{Clip, ClipShape};
use voltet_core::parameters::{RelativeNumber, VariantSchema};
use voltet_core::transfer::{TransferFunction, with_placeholders};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_cpu::{Cells, Projection, needs_gradient};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Parameter, ParameterType, Parameters, Port, PortType, Range,
    Revision, RunContext, StatisticKind, TransferFunctionSpec, diagonal,
};
use voltet_optics::WidgetBlend;
use voltet_optics::engine::EngineInfo;
use voltet_optics::integrators::{INTEGRATOR, Integrator, kinds, stated};
use voltet_optics::scene::{Scene, needs_order};
use voltet_optics::shading::{Light, Shading, VisibilityOrder};

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

/// The parameter that cuts the volume, for the declarations of the nodes that draw from a volume. What is not stated cuts through the middle of
/// the data.
pub const CLIP: Parameter = Parameter {
    name: "clip",
    parameter_type: ParameterType::Kinds(&[
        VariantSchema {
            name: "plane",
            summary: "the side of a plane to which its normal points",
            parameters: &[ORIGIN, NORMAL, INVERT],
        },
        VariantSchema {
            name: "box",
            summary: "a box along the axes",
            parameters: &[
                point("low", MIDDLE, "its lowest corner"),
                point("high", DefaultValue::Texts(&["100 %", "100 %", "100 %"]), "its highest corner"),
                INVERT,
            ],
        },
        VariantSchema {
            name: "sphere",
            summary: "a ball",
            parameters: &[point("centre", MIDDLE, "its centre"), QUARTER, INVERT],
        },
        VariantSchema {
            name: "cylinder",
            summary: "a cylinder with flat ends",
            parameters: &[
                point("from", DefaultValue::Texts(&["50 %", "50 %", "0 %"]), "middle of one end"),
                point("to", DefaultValue::Texts(&["50 %", "50 %", "100 %"]), "middle of the other"),
                QUARTER,
                INVERT,
            ],
        },
    ]),
    unit: "",
    default: DefaultValue::Unset("the whole volume"),
    help: "the parts of space in all of which the volume is drawn; rays are cut there, exactly; surfaces are drawn everywhere",
};

const fn point(name: &'static str, default: DefaultValue, help: &'static str) -> Parameter {
    Parameter { name, default, help, ..POSITION }
}

const QUARTER: Parameter = Parameter {
    default: DefaultValue::Text("25 %"),
    help: "its radius; a percentage: of the diagonal of the bounds",
    ..RADIUS
};

/// The parameter by which the rest is kept.
pub const INVERT: Parameter = Parameter {
    name: "invert",
    parameter_type: ParameterType::Boolean,
    unit: "",
    default: DefaultValue::Boolean(false),
    help: "keeps what is outside",
};

/// The clips that the parameters state in numbers, where the node has them.
pub fn clips(p: &Parameters) -> Result<Vec<Clip>> {
    p.kinds(CLIP.name)?.into_iter().map(|(kind, p)| clip(kind, &p)).collect()
}

fn clip(kind: &str, p: &Parameters) -> Result<Clip> {
    let at = |name: &str| Ok::<_, Error>(DVec3::from(p.vector(name)?));
    let shape = match kind {
        "plane" => ClipShape::Plane { origin: at("origin")?, normal: at("normal")? },
        "box" => ClipShape::Box { low: at("low")?, high: at("high")? },
        "sphere" => ClipShape::Sphere { centre: at("centre")?, radius: p.number("radius")? },
        _ => ClipShape::Cylinder { from: at("from")?, to: at("to")?, radius: p.number("radius")? },
    };
    shape.check().map_err(|error| p.locate("kind", error))?;
    Ok(Clip { shape, invert: p.flag("invert")? })
}

/// Checks the clips as far as they can be before data are known: how a corner in numbers lies to one in percentages is not.
pub fn check_clips(p: &Parameters) -> Result<()> {
    p.kinds(CLIP.name)?.into_iter().try_for_each(|(kind, p)| {
        let is_place = |number: &RelativeNumber| number.is == StatisticKind::Place;
        let places = p.relative_numbers().into_iter().filter(is_place).count();
        match (kind, places) {
            ("box" | "cylinder", 1..=5) => Ok(()),
            _ => clip(kind, &with_placeholders(&p)?).map(drop),
        }
    })
}

/// The clips with places for percentages of the bounds of the data, which are noted. `bounds`: finds these, if there are percentages.
pub fn clips_of_data(
    call: &mut RunContext,
    bounds: impl FnOnce(&RunContext) -> Result<Option<[DVec3; 2]>>,
) -> Result<Vec<Clip>> {
    let p = call.parameters;
    if p.relative_numbers().is_empty() {
        return clips(p);
    }
    let own = placed(p, bounds(call)?)?;
    note_numbers(&mut call.notes, "clip", "over the bounds", p, &own);
    clips(&own)
}

/// Optional input of the nodes that draw from a volume.
pub const SURFACES: Port = Port {
    name: "surfaces",
    port_type: PortType::Surface,
    summary: "surfaces in the volume, each in its place along every ray; any number of them",
};

/// Checks the parameters of a node that draws, before data are read.
pub fn check(p: &Parameters) -> Result<()> {
    check_clips(p)?;
    shading(p).map(drop)
}

/// The shading that the parameters state.
pub fn shading(p: &Parameters) -> Result<Shading> {
    let overlap = if p.text("overlap")? == "mix" { WidgetBlend::Mix } else { WidgetBlend::Exact };
    let integrator = stated(p)?;
    integrator.check().map_err(|error| p.locate("integrator", error))?;
    Ok(Shading { integrator, overlap, silhouette: p.optional_number("silhouette"), light: light(p)? })
}

fn light(p: &Parameters) -> Result<Option<Light>> {
    let Some(light) = p.table("light")? else { return Ok(None) };
    let direction: DVec3 = light.vector("direction")?.into();
    if direction == DVec3::ZERO {
        return Err(light
            .error("direction", "the light has no direction")
            .expected("a vector that is not zero"));
    }
    Ok(Some(Light { direction, ambient: light.number("ambient")?, diffuse: light.number("diffuse")? }))
}

/// The parameter, for the declarations of `sort` and `renderer`.
pub const ORDER: Parameter = Parameter {
    name: "order",
    parameter_type: ParameterType::Choice(&VisibilityOrder::NAMES),
    unit: "",
    default: DefaultValue::Text("exact"),
    help: "the order in which a pixel's ray segments are composited",
};

/// The order that the parameters request.
pub fn order(p: &Parameters) -> Result<VisibilityOrder> {
    p.text("order")?.parse()
}

/// Asks at `port` for what drawing the transfer function at `look_port` with the node's parameters needs; gives what
/// was asked for.
pub fn ask(asking: &mut DemandContext, port: &str, look_port: &str) -> Result<Demand> {
    let (look, shading) = (asking.look(look_port), shading(asking.parameters)?);
    if let Some(look) = &look {
        // Refused before any data are read.
        check_engine(&voltet_cpu::ENGINE, asking.parameters, &look.transfer_function, &shading)?;
        shading.check(&look.transfer_function)?;
    }
    let mut demand = demand(look.as_deref(), &shading);
    // Surfaces and the ends of clips have their places in the order.
    let has_surfaces = asking.fed_by(SURFACES.name).is_ok_and(|fed| fed.is_some());
    demand.order |= has_surfaces || asking.parameters.is_set(CLIP.name);
    // A table spans the range of g.
    if !shading.integrator.has_table() {
        demand.gradient_for = asking.known_look(look_port).map(|look| vec![look]);
    }
    asking.ask(port, &demand)?;
    Ok(demand)
}

/// Checks, without any data, that an engine can draw the transfer function with this shading.
///
/// Errors: those of [`EngineInfo::can_serve`], with the integrators by which it could.
pub fn check_engine(
    engine: &EngineInfo,
    parameters: &Parameters,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> Result<()> {
    let check = |integrator| engine.can_serve(transfer_function, &Shading { integrator, ..*shading });
    check(shading.integrator).map_err(|mut error| {
        let kinds = kinds(parameters.variants(INTEGRATOR)).into_iter();
        let others: Vec<&str> = kinds
            .filter(|kind| check(Integrator::new(*kind)).is_ok())
            .map(|kind| kind.schema().name)
            .collect();
        if !others.is_empty() {
            let accepted = error.expected.take().map_or(String::new(), |accepted| format!("{accepted}, or "));
            error = error.expected(format!("{accepted}one of the integrators {}", others.join(", ")));
        }
        parameters.locate(INTEGRATOR, error)
    })
}

fn demand(look: Option<&TransferFunctionSpec>, shading: &Shading) -> Demand {
    let gradient = needs_gradient(shading);
    let Some(look) = look else { return Demand { gradient, ..Demand::unknown() } };
    let transfer_function = &look.transfer_function;
    let order = needs_order(transfer_function, shading);
    Demand { gradient, order, ..Demand::of_function(transfer_function) }
}

/// The scene at the inputs `volume`, `transfer_function` and `camera`.
pub fn scene(call: &mut RunContext) -> Result<Scene> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    let camera = *call.camera("camera")?;
    let shading = shading(call.parameters)?;
    let transfer_function = for_data(call, &look, &volume, call.revision("volume")?)?;
    note_bands(call, &volume, &transfer_function)?;
    let order = order(call.parameters)?;
    let surfaces = call.surfaces("surfaces")?;
    let revision = call.revision("volume")?;
    let clips = clips_of_data(call, |call| bounds(call, &volume, revision))?;
    Ok(Scene { volume, transfer_function, camera, shading, order, surfaces, clips })
}

/// Cells that were culled, and for which transfer function: no other one may be drawn from them.
#[derive(Debug)]
pub struct Culled {
    /// The cells that are left.
    pub cells: Cells,
    /// The transfer function.
    pub transfer_function: Arc<TransferFunction>,
}

/// Projected cells, and for which transfer function.
#[derive(Debug)]
pub struct Projected {
    /// The cells.
    pub projection: Projection,
    /// The transfer function.
    pub transfer_function: Arc<TransferFunction>,
}

impl Projected {
    /// The scene with this shading.
    pub fn scene(&self, shading: Shading) -> Scene {
        let cells = self.projection.cells();
        Scene::new(
            cells.volume.clone(),
            self.transfer_function.clone(),
            *self.projection.camera(),
            shading,
            cells.ordering.requested(),
        )
    }
}

/// The bounds of the data with one revision, kept between runs.
struct DataBounds(Option<[DVec3; 2]>);

/// The bounds of a volume. `revision`: that of the data.
pub fn bounds(call: &RunContext, volume: &Volume, revision: Revision) -> Result<Option<[DVec3; 2]>> {
    Ok(call.keep(revision, || Ok(DataBounds(volume.grid.bounds())))?.0)
}

/// The transfer function for the data: its unit distance is known from here on. `revision`: that of the data.
pub fn for_data(
    call: &RunContext,
    look: &TransferFunctionSpec,
    volume: &Volume,
    revision: Revision,
) -> Result<Arc<TransferFunction>> {
    let diagonal = match look.auto_unit_distance {
        true => diagonal(bounds(call, volume, revision)?),
        false => 0.0,
    };
    Ok(Arc::new(look.for_diagonal(diagonal)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Widget};

    fn widget(color: [f64; 3], extinction: f64) -> Widget {
        let profile = Profile::Gaussian { centre: [0.0; 2], matrix: [[1.0, 0.0], [0.0, 0.0]] };
        Widget { profile, color, extinction, region: None }
    }

    fn look(widgets: Vec<Widget>) -> TransferFunctionSpec {
        let model = OpticalModel::DensityEmitter;
        let transfer_function =
            TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
        TransferFunctionSpec::new(transfer_function, false)
    }

    fn shading(diffuse: Option<f64>, silhouette: Option<f64>) -> Shading {
        let direction = DVec3::X;
        let light = diffuse.map(|diffuse| Light { direction, ambient: 0.3, diffuse });
        Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette, light }
    }

    #[test]
    fn one_colour_needs_no_order_unless_it_is_lit_or_glows_evenly() {
        let red = [1.0, 0.0, 0.0];
        let one = look(vec![widget(red, 1.0), widget(red, 2.0), widget([0.0; 3], 0.0)]);
        assert!(!demand(Some(&one), &shading(None, Some(2.0))).order);
        assert!(demand(Some(&one), &shading(Some(0.5), None)).order);
        assert!(
            demand(Some(&look(vec![widget(red, 1.0), widget([0.0; 3], 1.0)])), &shading(None, None)).order
        );
        let mut even = one.clone();
        even.transfer_function.model = OpticalModel::ConstantEmitter { cutoff: 0.1 };
        assert!(demand(Some(&even), &shading(None, None)).order);
        let point = |s: f64, color| ControlPoint { s, color, extinction: 1.0 };
        let profile = Profile::PiecewiseLinear { points: vec![point(0.0, red), point(1.0, [0.5, 0.0, 0.0])] };
        let ramp = Widget { profile, ..widget(red, 1.0) };
        assert!(demand(Some(&look(vec![ramp])), &shading(None, None)).order);
    }

    #[test]
    fn gradients_are_asked_for_where_something_looks_at_them() {
        let scalar_only = look(vec![widget([1.0; 3], 1.0)]);
        assert_eq!(demand(Some(&scalar_only), &shading(None, Some(0.0))), Demand::default());
        let lit = demand(Some(&scalar_only), &shading(Some(0.0), None));
        assert!(lit.gradient && !lit.gradient_magnitude);
        assert!(demand(Some(&scalar_only), &shading(None, Some(1.0))).gradient);
        let unknown = demand(None, &shading(None, None));
        assert!(unknown.gradient_magnitude && unknown.order && !unknown.gradient);
    }
}
