//! `bands`: whether the bands of a transfer function are finer than the cells of a volume.

use crate::drawing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::probing::bands_of_cells;
use voltet_graph::{CellValues, Demand, DemandContext, Node, Outputs, Port, PortType, RunContext, Value};

pub const NODE: Node = Node {
    name: "bands",
    summary: "Says how many bands of each wave widget the cells cross: more than one is finer than the grid.",
    inputs: &[
        Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" },
        Port {
            name: "transfer_function",
            port_type: PortType::TransferFunction,
            summary: "its triangle-wave and sine-wave widgets are looked at",
        },
    ],
    outputs: &[Port {
        name: "cell_values",
        port_type: PortType::CellValues,
        summary: "the bands that each cell crosses, an array bands_N for widget N (from 0); 0 outside its region",
    }],
    example: include_str!("examples/bands.toml"),
    finds: true,
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    let look = asking.look("transfer_function");
    let gradient_magnitude = look.is_none_or(|look| look.transfer_function.uses_gradient_magnitude());
    asking.ask("volume", &Demand { gradient_magnitude, ..Demand::default() })
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    drawing::note_bands(call, &volume, &look.transfer_function)?;
    if call.notes.findings.is_empty() {
        let what = "the transfer function has no wave widgets whose bands any cell crosses";
        call.notes.find(what, serde_json::Value::Null);
    }
    let mut values = CellValues::default();
    if call.demand.cell_values {
        let found = bands_of_cells(&volume, &look.transfer_function)?;
        values.arrays = found.into_iter().map(|(widget, bands)| (format!("bands_{widget}"), bands)).collect();
    }
    Ok(vec![Value::CellValues(Arc::new(values))])
}
