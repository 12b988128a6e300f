//! `composite`: integrates every ray segment and composites the pixels.

use crate::drawing;
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_graph::{DemandContext, Node, Outputs, Parameters, Port, PortType, RunContext, Value};
use voltet_optics::integrators::stated;

/// The declaration.
pub const NODE: Node = Node {
    name: "composite",
    summary: "Integrates every ray segment and composites each pixel's segments front to back.",
    inputs: &[
        Port { name: "projection", port_type: PortType::Projection, summary: "the projected cells" },
        Port { name: "transfer_function", port_type: PortType::TransferFunction, summary: "what is drawn" },
    ],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &drawing::PARAMETERS,
    example: include_str!("examples/stages.toml"),
    check: &check,
    demand: &|asking: &mut DemandContext| {
        let (engine, why) = match stated(asking.parameters)?.extension() {
            Some(engine) => (engine, drawing::registered_reason(engine)),
            None => (drawing::NATIVE, "the stages are nodes of their own, which the CPU runs".into()),
        };
        asking.notes.engine = Some((engine.name.into(), why));
        drawing::ask(asking, "projection", "transfer_function").map(drop)
    },
    run: &run,
    ..Node::BLANK
};

fn check(parameters: &Parameters) -> Result<()> {
    let integrator = drawing::shading(parameters)?.integrator;
    if integrator.kind().scene_preparation().is_some() {
        let name = integrator.name();
        let what = format!("the integrator '{name}' reads the grid's points, which no stage of its own has");
        let error = Error::usage(what).expected("a node of type renderer, or another integrator");
        return Err(parameters.locate("integrator", error));
    }
    Ok(())
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let projected = call.projection::<drawing::Projected>("projection")?;
    let look = call.look("transfer_function")?;
    let shading = drawing::shading(call.parameters)?;
    let revision = call.revision("projection")?;
    let cells = projected.projection.cells();
    let transfer_function = drawing::for_data(call, &look, &cells.volume, revision)?;
    if transfer_function != projected.transfer_function {
        let what = "the cells were culled for another transfer function than the one to draw";
        return Err(
            Error::usage(what).expected("the same transfer_function at the nodes of type cull and composite")
        );
    }
    drawing::note_bands(call, &cells.volume, &transfer_function)?;
    let picture = match shading.integrator.extension() {
        Some(engine) => {
            let projection = &projected.projection;
            drawing::composite_registered(call, engine, projection, &transfer_function, &shading)?
        }
        None => drawing::composite(call, &projected.projection, &transfer_function, &shading)?,
    };
    Ok(vec![Value::Image(Arc::new(picture))])
}
