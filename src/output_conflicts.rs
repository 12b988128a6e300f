//! Conflicts of inputs and outputs of a call, by file identity: no output may be an input or another output.

use crate::Document;
use crate::core::{Error, Result};
use crate::graph::SourceSpan;
use crate::io::formats::files_beside;
use crate::nodes::files::{Use, collision};
use std::path::PathBuf;

/// A file that an option of the command names.
#[derive(Debug)]
pub struct OptionFile {
    /// The path.
    pub path: PathBuf,
    /// True if it is written, false if it is read.
    pub written: bool,
    /// The option as typed.
    pub option: String,
}

impl OptionFile {
    /// A file that the option names to be written.
    #[cfg(feature = "cli")]
    pub fn written(option: &str, path: &std::path::Path) -> Self {
        OptionFile { path: path.into(), written: true, option: format!("{option} {}", path.display()) }
    }
}

/// A use of a file, with its description for messages.
struct Entry<'a> {
    one: Use,
    /// "'path' of the node 'file'".
    by: String,
    document: Option<&'a Document>,
    /// The node and the parameter that name it.
    node: Option<(String, String)>,
    /// An error that points there.
    blame: Box<dyn Fn(Error) -> Error + 'a>,
}

impl Entry<'_> {
    /// "'path' of the node 'file' (scene.toml:7:8)".
    fn place(&self) -> String {
        let place = (self.blame)(Error::usage("")).location;
        match (place.file, place.line_column) {
            (Some(file), Some((line, column))) => format!("{} ({file}:{line}:{column})", self.by),
            (Some(file), None) if file != self.by => format!("{} ({file})", self.by),
            _ => self.by.clone(),
        }
    }
}

impl Document {
    /// Refuses a run that would overwrite its inputs, or write one file twice.
    ///
    /// # Errors
    /// - an output that is an input, or another output.
    pub fn refuse_collisions(&self) -> Result<()> {
        refuse([self], true, &[]).map_err(|(error, _)| error)
    }
}

/// Refuses a call that would overwrite its inputs or outputs. `nodes_write`: true if the writers run. The error comes with the text
/// that it points into.
pub fn refuse<'a>(
    documents: impl IntoIterator<Item = &'a Document>,
    nodes_write: bool,
    options: &'a [OptionFile],
) -> std::result::Result<(), (Error, Option<&'a str>)> {
    let mut entries: Vec<Entry> = Vec::new();
    for document in documents {
        entries.push(of_pipeline(document));
        let of_nodes: Vec<Entry> =
            of_nodes(document).filter(|entry| nodes_write || !entry.one.written).collect();
        entries.extend(of_nodes.iter().filter(|entry| !entry.one.written).flat_map(beside));
        entries.extend(of_nodes);
    }
    entries.extend(options.iter().map(of_option));
    let uses: Vec<Use> = entries.iter().map(|entry| entry.one.clone()).collect();
    let Some([writer, other]) = collision(&uses) else { return Ok(()) };
    let (writer, other) = (&entries[writer], &entries[other]);
    let (what, verb) = match other.one.written {
        true => ("two outputs of this call are one file", "writes, too"),
        false => ("this output would overwrite what the call reads", "reads"),
    };
    let (own, others) = (writer.one.path.display(), other.one.path.display());
    let spelled = if writer.one.path == other.one.path {
        String::new()
    } else {
        format!(", the same file as '{others}'")
    };
    let error = Error::usage(what).got(format!("'{own}'{spelled}, which {} {verb}", other.place())).expected(
        match (&writer.node, other.document) {
            // Only what is read has no node and a document.
            (Some((node, parameter)), Some(document))
                if other.node.is_none() && document.carried.is_some() =>
            {
                format!("--set {node}.{parameter}=OTHER, or the picture to draw again under another name")
            }
            _ => "a file of its own for every output".into(),
        },
    );
    Err(((writer.blame)(error), writer.document.map(|document| document.text.as_str())))
}

/// Files that are read with a file because it names them.
fn beside<'a>(entry: &Entry<'a>) -> Vec<Entry<'a>> {
    let by = format!("the data file '{}'", entry.one.path.display());
    let of = |path| Entry {
        one: Use { path, written: false },
        by: format!("the program, as a part of {by},"),
        document: entry.document,
        node: None,
        blame: Box::new(|error| error),
    };
    files_beside(&entry.one.path).into_iter().map(of).collect()
}

fn of_option(file: &OptionFile) -> Entry<'_> {
    Entry {
        one: Use { path: file.path.clone(), written: file.written },
        by: file.option.clone(),
        document: None,
        node: None,
        blame: Box::new(|error| error.in_file(&file.option)),
    }
}

fn of_pipeline(document: &Document) -> Entry<'_> {
    Entry {
        one: Use { path: document.path.clone(), written: false },
        by: match document.carried {
            Some(_) => "the program, as the picture to draw again,".into(),
            None => "the program, as a pipeline file,".into(),
        },
        document: Some(document),
        node: None,
        blame: Box::new(|error| error),
    }
}

fn of_nodes(document: &Document) -> impl Iterator<Item = Entry<'_>> {
    let graph = &document.graph;
    let named =
        graph.nodes.iter().flat_map(|node| node.parameters.paths().into_iter().map(move |p| (node, p)));
    named.map(move |(node, named)| Entry {
        one: Use { path: named.from(&graph.folder), written: named.written },
        by: format!("'{}' of the node '{}'", named.parameter, node.name),
        document: Some(document),
        node: Some((node.name.clone(), named.parameter.clone())),
        blame: Box::new(move |error| {
            let origin = match &named.origin {
                SourceSpan::Nowhere => &node.origin,
                given => given,
            };
            document.locate(origin.locate(error.at_node(&node.name)))
        }),
    })
}
