//! `gpu-renderer`: culls, projects, sorts and composites on the graphics device.

use crate::{drawing, renderer};
use voltet_core::Result;
use voltet_graph::{Node, Outputs, Parameter, RunContext};

pub const NODE: Node = Node {
    name: "gpu-renderer",
    summary: "Draws a volume on the graphics device, where the grid stays: culls, projects, sorts and composites.",
    inputs: renderer::NODE.inputs,
    outputs: renderer::NODE.outputs,
    parameters: PARAMETERS,
    example: include_str!("examples/gpu_renderer.toml"),
    optional_inputs: renderer::NODE.optional_inputs,
    check: &drawing::check,
    demand: &|asking| drawing::ask_engine(asking, drawing::DEVICE.name),
    run: &run,
    ..Node::BLANK
};

/// Parameters of `renderer` without the engine.
const PARAMETERS: &[Parameter] = match renderer::NODE.parameters {
    [_engine, others @ ..] => others,
    [] => &[],
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let scene = drawing::scene(call)?;
    let picture = drawing::draw(call, &scene, drawing::DEVICE.name)?;
    let cells = |call: &RunContext| drawing::contributing_cells(call, &scene);
    Ok(vec![drawing::image(call, &scene, picture, cells)?])
}
