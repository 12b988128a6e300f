//! `cull`: keeps the cells that could contribute to the picture.

use crate::drawing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_cpu::VolumeCache;
use voltet_graph::{Demand, DemandContext, Node, Outputs, Port, PortType, RunContext, Value};
use voltet_optics::engine::{RenderStats, Stage};

pub const NODE: Node = Node {
    name: "cull",
    summary: "Keeps the cells that could contribute: those that a widget touches and that the camera sees.",
    inputs: &[
        Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" },
        Port { name: "transfer_function", port_type: PortType::TransferFunction, summary: "what is drawn" },
        Port { name: "camera", port_type: PortType::Camera, summary: "what is seen" },
    ],
    outputs: &[Port { name: "cells", port_type: PortType::Cells, summary: "the cells that are left" }],
    example: include_str!("examples/stages.toml"),
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

/// Demand on the volume: the arrays that the cells' values are tested by, and those that later nodes need.
fn demand(asking: &mut DemandContext) -> Result<()> {
    let mut demand = asking.asked.clone();
    demand.join(&match asking.look("transfer_function") {
        Some(look) => Demand {
            gradient_for: asking.known_look("transfer_function").map(|look| vec![look]),
            ..Demand::of_function(&look.transfer_function)
        },
        None => Demand { order: false, ..Demand::unknown() },
    });
    asking.ask("volume", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    let camera = call.camera("camera")?;
    let transfer_function = drawing::for_data(call, &look, &volume, call.revision("volume")?)?;
    let (exhaustive, each) = (call.exhaustive(), call.demand.kept_cells);
    let known = call.keep(call.revision("volume")?, || VolumeCache::new(&volume))?;
    let cells = call.stage(Stage::Cull.name(), |progress| match exhaustive {
        // That is what is asked for, and leaves nothing out.
        _ if each => known.cull_exact(&transfer_function, &camera, progress),
        true => known.all(&transfer_function, &camera),
        false => known.cull(&transfer_function, &camera, progress),
    })?;
    call.notes.counts.insert("cells_total", volume.grid.tetrahedra.len() as u64);
    let mut counts = RenderStats::default();
    cells.count(&mut counts);
    cells.note(&mut call.notes);
    drawing::note(call, &counts);
    Ok(vec![Value::Cells(Arc::new(drawing::Culled { cells, transfer_function }))])
}
