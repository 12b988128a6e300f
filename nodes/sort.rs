//! `sort`: decides in which order the compositor takes a pixel's segments.

use crate::drawing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_graph::{DemandContext, Node, Outputs, Port, PortType, RunContext, Value};
use voltet_optics::engine::Stage;
use voltet_optics::shading::Ordering;

pub const NODE: Node = Node {
    name: "sort",
    summary: "Says in which order ray segments are composited; the exact order is carried out pixel by pixel.",
    inputs: &[
        Port { name: "cells", port_type: PortType::Cells, summary: "the cells" },
        Port { name: "camera", port_type: PortType::Camera, summary: "where they are seen from" },
    ],
    outputs: &[Port { name: "cells", port_type: PortType::Cells, summary: "the cells with their order" }],
    parameters: &[drawing::ORDER],
    example: include_str!("examples/stages.toml"),
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    if !asking.asked.order {
        drawing::record_unsorted(asking.notes, None);
    }
    let demand = asking.asked.clone();
    asking.ask("cells", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let ordering = Ordering::new(drawing::order(call.parameters)?, call.demand.order);
    let culled = call.cells::<drawing::Culled>("cells")?;
    let camera = call.camera("camera")?;
    let cells = call.stage(Stage::Sort.name(), |_| voltet_cpu::sort(&culled.cells, &camera, ordering))?;
    cells.note_order(&mut call.notes);
    let transfer_function = culled.transfer_function.clone();
    Ok(vec![Value::Cells(Arc::new(drawing::Culled { cells, transfer_function }))])
}
