//! `image-writer`: a picture to a file, or to the standard output.

use crate::files::output::{self, BY_ENDING, FORMAT, PATH};
use std::path::Path;
use voltet_core::Result;
use voltet_graph::{
    DefaultValue, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType, Range, RunContext,
};
use voltet_io::encode;
use voltet_io::provenance::{self, Provenance};

/// The formats.
const PNG: &str = "png";
const EXR: &str = "exr";

/// The declaration.
pub const NODE: Node = Node {
    name: "image-writer",
    summary: "Writes a picture: .png over a background, or .exr with the linear floats as they are.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &[
        PATH,
        Parameter {
            parameter_type: ParameterType::Choice(&[
                (BY_ENDING, "what the path ends in, .png or .exr; png on the standard output and on devices"),
                (PNG, "8-bit sRGB over the background"),
                (EXR, "premultiplied linear 32-bit RGBA"),
            ]),
            help: "how the picture is written",
            ..FORMAT
        },
        Parameter {
            name: "background",
            parameter_type: ParameterType::Numbers(Some(3), Range::within(0.0, 1.0)),
            unit: "linear RGB",
            default: DefaultValue::Numbers(&[0.0, 0.0, 0.0]),
            help: "png: the colour behind the picture",
        },
        Parameter {
            name: "provenance",
            parameter_type: ParameterType::Boolean,
            unit: "",
            default: DefaultValue::Boolean(true),
            help: "whether the picture carries the pipeline that drew it, its camera, and names, sizes and dates of the data",
        },
    ],
    example: include_str!("examples/stages.toml"),
    check: &|parameters| format(parameters).map(drop),
    prepare: &output::prepare,
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let picture = call.image("image")?;
    let path = call.path("path")?;
    let carried = carried(call, &path)?;
    let encoded = match format(call.parameters)? {
        PNG => encode::png(&picture, call.parameters.vector("background")?, carried.as_ref())?,
        _ => encode::exr(&picture, carried.as_ref())?,
    };
    output::write(call, &encoded)?;
    Ok(Vec::new())
}

/// Provenance to embed in the picture.
fn carried(call: &mut RunContext, path: &Path) -> Result<Option<Provenance>> {
    if !call.parameters.flag("provenance")? {
        return Ok(None);
    }
    let provenance = Provenance::of_picture(call, call.parameters.text("path")?, path);
    if provenance.texts().is_none() {
        call.notes.warnings.push(format!(
            "the picture does not carry its pipeline, which is longer than {} bytes",
            provenance::MAX_TEXT
        ));
    }
    Ok(Some(provenance))
}

fn format(parameters: &Parameters) -> Result<&'static str> {
    output::format(parameters, "the picture's format", [PNG, EXR])
}
