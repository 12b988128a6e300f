//! `image-writer`: a picture to a file, or to the standard output.

use crate::files::{self, BY_ENDING, FORMAT, PATH};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::parameters::LocatedValue;
use voltet_core::picture_parts::PictureLayer;
use voltet_graph::{
    DefaultValue, Demand, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType, Range,
    RunContext, suggest,
};
use voltet_io::encode::{FORMATS, PictureFormat, SampleForm, all_endings};
use voltet_io::provenance::{self, Provenance};

/// Names and contents of the formats, behind the word for the path's ending.
const CHOICES: [(&str, &str); FORMATS.len() + 1] = {
    let mut choices =
        [(BY_ENDING, "what the path ends in; png on the standard output and on devices"); FORMATS.len() + 1];
    let mut i = 0;
    while i < FORMATS.len() {
        choices[i + 1] = (FORMATS[i].name, FORMATS[i].summary);
        i += 1;
    }
    choices
};

pub const NODE: Node = Node {
    name: "image-writer",
    summary: "Writes a picture in the format that its path ends in.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &[
        PATH,
        Parameter {
            parameter_type: ParameterType::Choice(&CHOICES),
            help: "how the picture is written",
            ..FORMAT
        },
        Parameter {
            name: "background",
            parameter_type: ParameterType::Color(Range::within(0.0, 1.0)),
            unit: "linear RGB",
            default: DefaultValue::Numbers(&[0.0, 0.0, 0.0]),
            help: "the colour behind the picture, in files without alpha",
        },
        Parameter {
            name: "alpha",
            parameter_type: ParameterType::Boolean,
            unit: "",
            default: DefaultValue::Boolean(false),
            help: "whether the file has straight alpha in place of the background; .exr has premultiplied alpha always",
        },
        Parameter {
            name: "bits",
            parameter_type: ParameterType::Integer(Range::within(8.0, 16.0)),
            unit: "bits a channel",
            default: DefaultValue::Integer(8),
            help: "8 or 16; .exr has floats of 32 bits always",
        },
        Parameter {
            name: "layers",
            parameter_type: ParameterType::Texts,
            unit: "",
            default: DefaultValue::Unset("none"),
            help: "of .exr: any of depth, first_hit, cell, optical_depth, as channels; of the rays through the pixels' centres",
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
    check: &|parameters| form(parameters).and_then(|_| layers(parameters)).map(drop),
    demand: &|asking| {
        let (layers, shapes) = (layers(asking.parameters)?, format(asking.parameters)?.has_shapes);
        asking.ask("image", &Demand { layers, shapes, ..Demand::default() })
    },
    prepare: &files::prepare,
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let mut picture = call.picture_parts("image")?;
    let path = call.path("path")?;
    let requested = layers(call.parameters)?;
    if !requested.is_empty() && picture.layers.is_none() {
        let error = call.parameters.error("layers", "the picture has no layers");
        let expected =
            "the image of a node of type renderer, gpu-renderer or composite, or of an annotation over it";
        return Err(error.expected(expected));
    }
    let carried = carried(call, &path)?;
    let format = format(call.parameters)?;
    // Others than these were requested for another file.
    if let Some(layers) = &mut picture.layers
        && !layers.keys().all(|layer| requested.contains(layer))
    {
        let own = layers.iter().filter(|(layer, _)| requested.contains(layer));
        *layers = Arc::new(own.map(|(layer, values)| (*layer, values.clone())).collect());
    }
    let (file, unheld) = format.file(&picture, form(call.parameters)?, carried.as_ref())?;
    call.notes.warnings.extend(unheld);
    files::write(call, &file)?;
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

fn form(p: &Parameters) -> Result<SampleForm> {
    let bits = match p.integer("bits")? {
        8 => 8,
        16 => 16,
        other => return Err(p.error("bits", "no format has so many bits").got(other).expected("8 or 16")),
    };
    Ok(SampleForm { alpha: p.flag("alpha")?, background: p.color("background")?, bits })
}

/// The requested layers. Errors: a name that is none of theirs; a format that holds none.
fn layers(p: &Parameters) -> Result<BTreeSet<PictureLayer>> {
    let format = format(p)?;
    let Some(list) = p.optional("layers").and_then(|setting| setting.list()) else {
        return Ok(BTreeSet::new());
    };
    let layer = |setting: &LocatedValue| {
        let name = setting.text().unwrap_or_default();
        PictureLayer::named(name).ok_or_else(|| {
            setting.error(
                "there is no such layer",
                suggest(name, PictureLayer::ALL.into_iter().map(PictureLayer::name)),
            )
        })
    };
    let layers = list.iter().map(layer).collect::<Result<BTreeSet<PictureLayer>>>()?;
    if !layers.is_empty() && !format.has_layers {
        let error = p.error("layers", format!("{} holds no layers", format.name));
        return Err(error.expected("a path that ends in .exr"));
    }
    Ok(layers)
}

fn format(parameters: &Parameters) -> Result<&'static PictureFormat> {
    let endings: Vec<&str> = all_endings().collect();
    let ending = endings[files::format(parameters, "the picture's format", &endings)?];
    let found = FORMATS.iter().find(|format| format.endings.contains(&ending));
    Ok(found.expect("the ending is of one of them"))
}
