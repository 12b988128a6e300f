//! `project`: cells to the picture plane.

use crate::drawing::{self, Culled, Projected};
use std::sync::Arc;
use voltet_core::Result;
use voltet_graph::{DemandContext, Node, Outputs, Port, PortType, RunContext, Value};
use voltet_optics::engine::{RenderStats, Stage};

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
    let (culled, camera) = (call.cells::<Culled>("cells")?, call.camera("camera")?);
    let Culled { cells, transfer_function } = &*culled;
    // For comparison everything that there is goes along.
    let gradient = call.demand.gradient || (call.exhaustive() && cells.volume.gradient.is_some());
    let projection = call.stage(Stage::Project.name(), |progress| {
        voltet_cpu::project(cells, transfer_function, &camera, gradient, progress)
    })?;
    let mut counts = RenderStats::default();
    projection.count(&mut counts);
    drawing::note(call, &counts);
    let transfer_function = transfer_function.clone();
    Ok(vec![Value::Projection(Arc::new(Projected { projection, transfer_function }))])
}
