//! `boundary`: the outer faces of the cells.

use crate::relative::{self, RELATIVE_TO};
use crate::surfacing::{self, SMOOTH, Shape, with_paint};
use voltet_core::Result;
use voltet_core::grid::boundary;
use voltet_graph::{DefaultValue, Node, Outputs, Parameter, ParameterType, Range, RunContext};

pub const NODE: Node = Node {
    name: "boundary",
    summary: "Makes a surface of the faces that one cell alone has: the outside of the grid.",
    inputs: surfacing::INPUTS,
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/surfaces.toml"),
    check: &|p| {
        if p.is_set("feature_angle") && !p.flag("smooth")? {
            let error = p.error("feature_angle", "'feature_angle' keeps edges of a smooth look sharp");
            return Err(error.got("smooth = false").expected("smooth = true"));
        }
        surfacing::check(p)
    },
    demand: &|asking| {
        let p = asking.parameters;
        surfacing::ask(asking, [surfacing::color_by(p, None), None])
    },
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 11] = with_paint(
    [
        Parameter { default: DefaultValue::Boolean(false), ..SMOOTH },
        Parameter {
            name: "feature_angle",
            parameter_type: ParameterType::Number(Range::within(0.0, 180.0)),
            unit: "degrees",
            default: DefaultValue::Unset("none: all edges look smooth"),
            help: "of a smooth look: edges where normals turn by more than this stay sharp",
        },
        RELATIVE_TO,
    ],
    "one colour",
    0.15,
    0.3,
);

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let color_by = surfacing::color_by(p, None);
    let own = surfacing::known_of_volume(call, &volume, "s", color_by)?;
    let surface = call.stage("boundary", |progress| boundary(&volume.grid, progress))?;
    let values = color_by.map(|name| surfacing::values(p, "color_by", &volume, name)).transpose()?;
    let colors = values.map(|values| surface.values(values));
    let shape = Shape::of_grid(surface, &volume.grid.points, colors);
    let shape = match p.optional_number("feature_angle") {
        Some(angle) if p.number("ambient")? < 1.0 => shape.sharp(angle),
        _ => shape.smoothed(p)?,
    };
    shape.painted(call, &own, "the grid has no cells with a volume")
}
