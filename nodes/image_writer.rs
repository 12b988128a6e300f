//! `image-writer`: a picture to a file, or to the standard output.

use crate::{encode, files};
use std::path::Path;
use voltet_core::graph::{
    Call, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType, Range, Standard,
};
use voltet_core::{Error, Result};

/// The word for a format that the path decides.
const BY_ENDING: &str = "auto";

/// The declaration.
pub const NODE: Node = Node {
    name: "image-writer",
    summary: "Writes a picture: .png over a background, or .exr with the linear floats as they are.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &[
        Parameter {
            name: "path",
            parameter_type: ParameterType::OutputPath,
            unit: "",
            standard: Standard::Required,
            help: "the file; \"-\": the standard output",
        },
        Parameter {
            name: "format",
            parameter_type: ParameterType::Choice(&[
                (BY_ENDING, "what the path ends in, .png or .exr; png on the standard output and on devices"),
                ("png", "8-bit sRGB over the background"),
                ("exr", "premultiplied linear 32-bit RGBA"),
            ]),
            unit: "",
            standard: Standard::Text(BY_ENDING),
            help: "how the picture is written",
        },
        Parameter {
            name: "background",
            parameter_type: ParameterType::Numbers(Some(3), Range::within(0.0, 1.0)),
            unit: "linear RGB",
            standard: Standard::Numbers(&[0.0, 0.0, 0.0]),
            help: "png: the colour behind the picture",
        },
    ],
    example: include_str!("examples/stages.toml"),
    check: &|parameters| format(parameters).map(drop),
    prepare: &|preparation| {
        let path = preparation.path("path")?;
        files::refuse_unwritable(&path).map_err(|error| preparation.parameters.blame("path", error))
    },
    run: &run,
    ..Node::BLANK
};

/// The formats.
enum Format {
    Png,
    Exr,
}

fn run(call: &mut Call) -> Result<Outputs> {
    let picture = call.image("image")?;
    let path = call.path("path")?;
    let encoded = match format(call.parameters)? {
        Format::Png => encode::png(&picture, call.parameters.vector("background")?)?,
        Format::Exr => encode::exr(&picture)?,
    };
    // Encoding a large picture takes seconds, in which a stop may have been asked for.
    if call.progress().cancelled() {
        return Err(Error::cancelled());
    }
    files::write_whole(&path, &encoded).map_err(|error| call.parameters.blame("path", error))?;
    call.notes.files.push(files::shown(&path));
    Ok(Vec::new())
}

fn format(parameters: &Parameters) -> Result<Format> {
    let path = parameters.text("path")?;
    let ending = Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase());
    match (parameters.text("format")?, ending.as_deref()) {
        ("png", _) | (BY_ENDING, Some("png")) => Ok(Format::Png),
        ("exr", _) | (BY_ENDING, Some("exr")) => Ok(Format::Exr),
        (_, None) if files::is_stream(path) => Ok(Format::Png),
        _ => Err(parameters
            .error("path", "the picture's format is not known")
            .found(path)
            .accepted("a path that ends in .png or .exr, or format = \"png\" or \"exr\"")),
    }
}
