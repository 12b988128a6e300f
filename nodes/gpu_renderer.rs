//! `gpu-renderer`: culls, projects, sorts and composites on the graphics device.

use crate::drawing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::graph::{Call, Node, Outputs, Parameter, Port, PortType, Value};

/// The declaration.
pub const NODE: Node = Node {
    name: "gpu-renderer",
    summary: "Draws a volume on the graphics device, where the grid stays: culls, projects, sorts and composites.",
    inputs: &[
        Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" },
        Port { name: "transfer_function", port_type: PortType::TransferFunction, summary: "what is drawn" },
        Port { name: "camera", port_type: PortType::Camera, summary: "where it is seen from" },
    ],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &PARAMETERS,
    example: include_str!("examples/gpu_renderer.toml"),
    check: &|parameters| drawing::shading(parameters).map(drop),
    demand: &|asking| drawing::ask_engine(asking, "gpu"),
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 10] = {
    let [integrator, overlap, segments, tolerance, table_size, silhouette, light] = drawing::PARAMETERS;
    [
        drawing::ADAPTER,
        drawing::COMPOSITOR,
        drawing::ORDER,
        integrator,
        overlap,
        segments,
        tolerance,
        table_size,
        silhouette,
        light,
    ]
};

fn run(call: &mut Call) -> Result<Outputs> {
    let scene = drawing::scene(call)?;
    let picture = drawing::draw(call, &scene, "gpu")?;
    Ok(vec![Value::Image(Arc::new(picture))])
}
