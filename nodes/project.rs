//! `project`: cells to the picture plane.

use crate::drawing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_graph::{DemandContext, Node, Outputs, Port, PortType, RunContext, Value};

/// The declaration.
pub const NODE: Node = Node {
    name: "project",
    summary: "Projects each cell's silhouette, and prepares what the compositor walks.",
    inputs: &[
        Port { name: "cells", port_type: PortType::Cells, summary: "the cells" },
        Port { name: "camera", port_type: PortType::Camera, summary: "where they are seen from" },
    ],
    outputs: &[Port { name: "projection", port_type: PortType::Projection, summary: "the projected cells" }],
    example: include_str!("examples/stages.toml"),
    demand: &|asking: &mut DemandContext| {
        let demand = asking.asked.clone();
        asking.ask("cells", &demand)
    },
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (culled, camera) = (call.cells::<drawing::Culled>("cells")?, call.camera("camera")?);
    let transfer_function = culled.transfer_function.clone();
    let projection =
        drawing::project(call, &culled.cells, &transfer_function, &camera, call.demand.gradient)?;
    Ok(vec![Value::Projection(Arc::new(drawing::Projected { projection, transfer_function }))])
}
