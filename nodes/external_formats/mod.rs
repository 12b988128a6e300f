//! Formats that come from outside: the node that a reader of one is, beside the node `reader`.

use crate::reader;
use std::path::{Path, PathBuf};
use voltet_core::Result;
use voltet_core::reading::GridReader;
use voltet_graph::{
    Field, GridPart, Node, NodeEntry, Outputs, Parameter, Parameters, PlanContext, Preparation, Registry,
    RunContext,
};
use voltet_io::formats::{Request, SelectedArrays};

/// The parameters of the node `reader` that belong to some of its formats.
const OF_FORMATS: [&str; 2] = ["blocks", "solution"];

/// The node of a reader: its name is that of the reader, its parameters are those that every reader has and its own. It lives from
/// now on as long as the program; a registry takes it as any other ([`voltet_graph::Registry::add`]).
pub fn reader(reader: &'static dyn GridReader) -> &'static Node {
    let kind = reader.declaration();
    let shared = reader::NODE.parameters.iter().filter(|parameter| !OF_FORMATS.contains(&parameter.name));
    let files: &str = format!("the file, {}", reader.files()).leak();
    let shared = shared.map(|parameter| match parameter.name {
        "path" => Parameter { help: files, ..*parameter },
        _ => *parameter,
    });
    let parameters: Vec<Parameter> = shared.chain(kind.parameters.iter().copied()).collect();
    let example = format!("[nodes.grid]\ntype = \"{}\"\npath = \"…\"\nscalar = \"…\"\n", kind.name);
    let chosen = move |p: &Parameters| Some(SelectedArrays { reader, parameters: p.clone() });
    Box::leak(Box::new(Node {
        name: kind.name,
        summary: kind.summary,
        parameters: parameters.leak(),
        example: example.leak(),
        plugin: reader.plugin(),
        reader: Some(reader),
        foreign_head: &|_| None,
        check: leak(move |p: &Parameters| reader::request(p, None).and_then(|_| reader.check(p))),
        foresee: leak(move |foresight: &mut PlanContext| {
            reader::foresee(foresight, chosen(foresight.parameters))
        }),
        steps: leak(move |preparation: &Preparation| {
            reader::steps(preparation, chosen(preparation.parameters))
        }),
        files_beside: &|_, _| Vec::<PathBuf>::new(),
        begin_parts: leak(move |call: &mut RunContext, parts: &[GridPart]| -> Result<()> {
            reader::begin_parts(call, parts, chosen(call.parameters))
        }),
        run: leak(move |call: &mut RunContext| -> Result<Outputs> {
            reader::run(call, chosen(call.parameters))
        }),
        ..reader::NODE
    }))
}

fn leak<T>(thing: T) -> &'static T {
    Box::leak(Box::new(thing))
}

/// Completes a request to a file, if it is of a format that a node of the registry reads.
///
/// Errors: the file cannot be read; the reader has a parameter that must be given.
pub fn request(request: Request, path: &Path, registry: &Registry) -> Result<Request> {
    let chosen = SelectedArrays::for_file(path, registry.readers().map(|(_, reader)| reader))?;
    Ok(Request { chosen, ..request })
}

/// Keys of a reader that choose among what its file holds.
const CHOICES: [&str; 4] = ["scalar", "blocks", "displacement", "displacement_factor"];

/// Settings of a reader about its file and how that is read, without the choice among what it holds.
pub fn settings_of(entry: &NodeEntry) -> impl Iterator<Item = &Field> {
    entry.settings.iter().filter(|field| !CHOICES.contains(&field.name.as_str()))
}

/// The file of a node that reads one, and the request of all that it may choose from. `folder`: what paths are relative to.
///
/// Errors: the node reads no file, or one of [its settings](settings_of) is wrong; as of [`request`].
pub fn request_of(entry: &NodeEntry, folder: &Path, registry: &Registry) -> Result<(PathBuf, Request)> {
    let node = registry.find(entry.node_type.text().unwrap_or_default())?;
    let stated: Vec<Field> = settings_of(entry).cloned().collect();
    let parameters = Parameters::check(node.parameters, &stated, &entry.origin, &[])?;
    let path = parameters.path("path", folder)?;
    let mut asked = reader::request(&parameters, None)?;
    if parameters.is_set("solution") {
        asked.solution = Some(parameters.path("solution", folder)?);
    }
    if let Some(reader) = node.reader {
        asked.chosen = Some(SelectedArrays { reader, parameters });
        return Ok((path, asked));
    }
    Ok((path.clone(), request(asked, &path, registry)?))
}
