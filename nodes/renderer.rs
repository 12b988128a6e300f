//! `renderer`: culls, sorts, projects and composites in one node, on the engine that is there.

use crate::drawing;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::graph::{
    Asking, Call, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType, Standard, Value,
};
use voltet_core::shading::Integrator;

/// The declaration.
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
    check: &|parameters| {
        engine(parameters)?;
        drawing::shading(parameters).map(drop)
    },
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 10] = {
    let [integrator, overlap, segments, tolerance, table_size, silhouette, light] = drawing::PARAMETERS;
    [
        Parameter {
            name: "engine",
            parameter_type: ParameterType::Choice(&[
                ("auto", "the GPU where this build and this machine have one, the CPU otherwise"),
                ("cpu", "native code on all cores"),
                ("gpu", "the graphics device"),
            ]),
            unit: "",
            standard: Standard::Text("auto"),
            help: "what draws",
        },
        Parameter {
            name: "compositor",
            parameter_type: ParameterType::Choice(&[
                ("auto", "what suits the device"),
                ("tiles", "compute passes over tiles"),
                ("raster", "triangles with hardware blending"),
            ]),
            unit: "",
            standard: Standard::Text("auto"),
            help: "gpu: how pixels are composited; the CPU always works in tiles",
        },
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

/// The engine and why it is taken.
fn engine(p: &Parameters) -> Result<(&'static str, &'static str)> {
    match (p.text("engine")?, p.text("integrator")?) {
        ("gpu", _) => {
            let error = p.error("engine", "this build has no GPU engine");
            Err(error.found("gpu").accepted("\"cpu\", or \"auto\", which takes the CPU"))
        }
        (_, "reference") => Ok(("reference", "the integrator is the 64-bit reference")),
        ("cpu", _) => Ok(("cpu", "the pipeline asks for it")),
        _ => Ok(("cpu", "this build has no GPU engine")),
    }
}

fn demand(asking: &mut Asking) -> Result<()> {
    let (name, why) = engine(asking.parameters)?;
    asking.notes.engine = Some((name.into(), why.into()));
    let needed = drawing::ask(asking, "volume", "transfer_function")?;
    if !needed.order && !asking.thorough {
        drawing::leave_out_order(asking.notes, None);
    }
    Ok(())
}

fn run(call: &mut Call) -> Result<Outputs> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    let camera = call.camera("camera")?;
    let shading = drawing::shading(call.parameters)?;
    let transfer_function = drawing::for_data(call, &look, &volume, call.revision("volume")?)?;
    drawing::note_bands(call, &volume, &transfer_function)?;
    let needed = call.thorough || drawing::needs_order(&transfer_function, &shading);
    let order = drawing::order(call.parameters, needed)?;
    let picture = if shading.integrator == Integrator::Reference {
        drawing::referee(call, &volume, &transfer_function, &camera, &shading, order)?
    } else {
        let cells = drawing::cull(call, &volume, &transfer_function, &camera)?;
        let cells = drawing::sort(call, &cells, &camera, order)?;
        let projection = {
            let gradient = voltet_engine::needs_gradient(&shading);
            drawing::project(call, &cells, &transfer_function, &camera, gradient)?
        };
        drawing::composite(call, &projection, &transfer_function, &shading)?
    };
    Ok(vec![Value::Image(Arc::new(picture))])
}
