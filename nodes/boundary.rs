//! `boundary`: the outer faces of the cells.

use crate::surfacing::{self, SMOOTH, Shape, with_paint};
use voltet_core::Result;
use voltet_core::grid::boundary;
use voltet_graph::{DefaultValue, Node, Outputs, Parameter, RunContext};

/// The declaration.
pub const NODE: Node = Node {
    name: "boundary",
    summary: "Makes a surface of the faces that one cell alone has: the outside of the grid.",
    inputs: surfacing::INPUTS,
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/surfaces.toml"),
    check: &surfacing::check,
    demand: &|asking| {
        let p = asking.parameters;
        surfacing::ask(asking, [surfacing::color_by(p, None), None])
    },
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 9] =
    with_paint([Parameter { default: DefaultValue::Boolean(false), ..SMOOTH }], "one colour", 0.15, 0.3);

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let color_by = surfacing::color_by(p, None);
    let own = surfacing::known_of_volume(call, &volume, "s", color_by)?;
    let surface = call.stage("boundary", |progress| boundary(&volume.grid, progress))?;
    let values = color_by.map(|name| surfacing::values(p, "color_by", &volume, name)).transpose()?;
    let colors = values.map(|values| surface.values(values));
    let shape = Shape::of_grid(surface, &volume.grid.points, colors).smoothed(p)?;
    shape.painted(call, &own, "the grid has no cells with a volume")
}
