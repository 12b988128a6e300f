//! `renderer`: culls, sorts, projects and composites in one node, on the engine that is there.

use crate::drawing;
use voltet_core::Result;
use voltet_graph::{Node, Outputs, Parameter, PartWork, Port, PortType, RunContext};

pub const NODE: Node = Node {
    name: "renderer",
    summary: "Draws a volume in one node: culls, sorts, projects and composites.",
    inputs: &[
        Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" },
        Port { name: "transfer_function", port_type: PortType::TransferFunction, summary: "what is drawn" },
        Port { name: "camera", port_type: PortType::Camera, summary: "where it is seen from" },
    ],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &PARAMETERS,
    example: include_str!("examples/renderer.toml"),
    optional_inputs: &[drawing::SURFACES],
    check: &drawing::check,
    demand: &|asking| {
        let parameters = asking.parameters;
        drawing::ask_engine(asking, parameters.text("engine")?)
    },
    part_work: PartWork::All,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 9] = {
    let [integrator, overlap, silhouette, light] = drawing::PARAMETERS;
    [
        drawing::ENGINE,
        drawing::ADAPTER,
        drawing::COMPOSITOR,
        drawing::ORDER,
        integrator,
        overlap,
        silhouette,
        light,
        drawing::CLIP,
    ]
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    if call.is_in_parts() {
        return drawing::draw_parts(call);
    }
    let scene = drawing::scene(call)?;
    let picture = drawing::draw(call, &scene, call.parameters.text("engine")?)?;
    let cells = |call: &RunContext| drawing::contributing_cells(call, &scene);
    Ok(vec![drawing::image(call, &scene, picture, cells)?])
}
