//! `boundary`: the outer faces of the cells.

use crate::surfacing::{self, SMOOTH, Shape, VolumeQuantities, with_paint};
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
    example: include_str!("examples/boundary.toml"),
    check: &surfacing::check,
    demand: &|asking| {
        let p = asking.parameters;
        surfacing::ask(asking, [surfacing::color_by(p, None), None])
    },
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 9] =
    with_paint([Parameter { default: DefaultValue::Boolean(false), ..SMOOTH }], 0.15, 0.3);

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let color_by = surfacing::color_by(p, None);
    let quantities = VolumeQuantities { volume: &volume, array: "s", color_by };
    let own = quantities.known(call)?;
    let surface = call.stage("boundary", |progress| boundary(&volume.grid, progress))?;
    let colors = color_by.map(|name| quantities.values(name)).transpose();
    let colors = colors.map_err(|error| p.locate("color_by", error))?.map(|values| surface.values(values));
    let shape = Shape::of_grid(surface, &volume.grid.points, colors).smoothed(p)?;
    shape.painted(call, &own, "the grid has no cells with a volume")
}
