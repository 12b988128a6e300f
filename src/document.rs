//! A pipeline file, or a picture that carries one, with its text and its checked graph; conflicts of inputs and outputs of a call, by
//! file identity: no output may be an input or another output.

pub use voltet_document::Change;
pub use voltet_io::encode::Source;

use crate::core::counted;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_document::{Document as DocumentText, Edit, Path as KeyPath};
use voltet_graph::pipeline::{Pipeline, locate, value};
use voltet_graph::{Graph, GraphNode, NamedPath, ParameterValue, Registry, ResolvedPipeline, SourceSpan};
use voltet_io::formats::files_beside;
use voltet_io::provenance::{DataFile, PluginRecord, Provenance};
use voltet_nodes::files::{Use, collision};

/// An error with the text that its location points into.
#[derive(Debug)]
#[cfg_attr(not(feature = "cli"), allow(dead_code, reason = "the command line alone shows the text"))]
pub(crate) struct LocatedError {
    pub error: Error,
    pub text: Option<String>,
}

impl From<Error> for LocatedError {
    fn from(error: Error) -> Self {
        LocatedError { error, text: None }
    }
}

/// A pipeline, read and checked.
#[derive(Debug)]
pub struct Document {
    /// The path of its file, or of the picture that carries it.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Parsed pipeline, with the options carried out.
    pub pipeline: Pipeline,
    /// The graph that it makes.
    pub graph: Graph,
    /// Provenance of the picture that carries it.
    pub carried: Option<Provenance>,
}

impl Document {
    /// The document with some parameters changed, as if its file said so.
    ///
    /// # Errors
    /// - a node or parameter that does not exist, a value that is refused.
    pub fn changed(&self, changes: &[Change], registry: &Registry) -> Result<Document> {
        let located = |error| self.locate(error);
        let mut pipeline = self.pipeline.clone();
        changes.iter().try_for_each(|change| change.apply(&mut pipeline.nodes)).map_err(located)?;
        let folder = self.graph.folder.clone();
        let mut graph = Graph::build(&pipeline.nodes, registry, folder).map_err(located)?;
        let mut text = DocumentText::from_text(self.graph.stated.text.clone(), None);
        let is_written = changes.iter().all(|change| text.edit(&change.edit()).is_ok());
        let written = is_written.then(|| text.text().to_string());
        let written = written.filter(|text| Pipeline::parse(text).is_ok_and(|read| read == pipeline));
        let stated = Pipeline::stated(written.unwrap_or_else(|| pipeline.to_string()), registry);
        graph.stated = stated.map_err(located)?;
        let (path, text, carried) = (self.path.clone(), self.text.clone(), self.carried.clone());
        Ok(Document { path, text, pipeline, graph, carried })
    }

    /// Reads a pipeline file, or a picture that carries its pipeline, carries out `options` (`node.param=value`)
    /// and checks it.
    pub fn open(path: &Path, options: &[String], registry: &Registry) -> Result<Document> {
        Self::from_source(path, Source::read(path)?, options, registry)
    }

    /// Like [`Document::open`], for a text; paths in it are relative to the folder of `path`.
    pub fn from_text(path: &Path, text: String, options: &[String], registry: &Registry) -> Result<Document> {
        Self::from_source(path, Source { text, embedded: None }, options, registry)
    }

    /// Like [`Document::open`], for a source that was read before.
    pub fn from_source(
        path: &Path,
        source: Source,
        options: &[String],
        registry: &Registry,
    ) -> Result<Document> {
        let Source { text, embedded: carried } = source;
        let located = |error| locate(error, &text, path);
        let mut pipeline = Pipeline::parse(&text).map_err(located)?;
        options.iter().try_for_each(|option| pipeline.set(option)).map_err(located)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut graph = Graph::build(&pipeline.nodes, registry, folder)
            .map_err(|error| with_plugins(error, carried.as_ref()))
            .map_err(located)?;
        graph.stated = stated(&text, options, &pipeline, registry).map_err(located)?;
        Ok(Document { path: path.to_path_buf(), text, pipeline, graph, carried })
    }

    /// Completes an error of a run with its location in this file.
    pub fn locate(&self, error: Error) -> Error {
        locate(error, &self.text, &self.path)
    }

    /// Completes an error of a run with its location in this file, and with its text.
    #[cfg(feature = "cli")]
    pub(crate) fn failure(&self, error: Error) -> LocatedError {
        LocatedError { error: self.locate(error), text: Some(self.text.clone()) }
    }

    /// Checks, before any work, that the data files that a picture names exist.
    pub fn refuse_missing_data(&self) -> Result<()> {
        for (node, named, former) in self.data() {
            let path = named.from(&self.graph.folder);
            if let Err(error) = std::fs::metadata(&path) {
                let what = "a data file that the picture was drawn from is not where the picture says";
                let state = former.map(state).unwrap_or_default();
                return Err(Error::usage(what)
                    .got(format!("no '{}'{state}: {error}", path.display()))
                    .expected(format!(
                        "the picture where it was written, or --set {node}.{}=FILE (a path is relative to the picture)",
                        named.parameter
                    ))
                    .in_file(&self.path));
            }
        }
        Ok(())
    }

    /// Warnings about data files that have changed since a picture was drawn, by their sizes.
    pub fn changed_data(&self) -> Vec<Error> {
        let changed = self.data().filter_map(|(node, named, former)| {
            let path = named.from(&self.graph.folder);
            let (now, then) = (std::fs::metadata(&path).ok()?.len(), former?.bytes?);
            (now != then).then(|| {
                Error::usage("the picture was drawn from other data than this file holds now")
                    .got(format!("{now} bytes in '{}'", path.display()))
                    .expected(format!("{then} bytes, or no such picture as before"))
                    .at_node(node)
            })
        });
        changed.collect()
    }

    /// Warnings about plug-ins that have changed since a picture was drawn.
    pub fn changed_plugins(&self) -> Vec<Error> {
        let drawn_with = self.carried.iter().flat_map(|carried| &carried.plugins);
        let changed = drawn_with.filter_map(|then| {
            let now = self.graph.node(&then.node)?.plugin()?;
            let fingerprint = now.fingerprint_text();
            (fingerprint != then.fingerprint).then(|| {
                Error::usage("the picture was drawn with another plug-in than is loaded now")
                    .got(format!("{now}, version {}, {} bytes, {fingerprint}", now.version, now.bytes))
                    .expected(format!("{}, or no such picture as before", describe_plugin(then)))
                    .at_node(&then.node)
            })
        });
        changed.collect()
    }

    /// The files that a run reads: its own, those that nodes name, and those beside them.
    #[cfg(feature = "cli")]
    pub(crate) fn inputs(&self) -> impl Iterator<Item = PathBuf> {
        self.entries(false).into_iter().map(|entry| entry.file.path)
    }

    /// The files that nodes name to be read.
    #[cfg(feature = "cli")]
    pub(crate) fn named_inputs(&self) -> Vec<PathBuf> {
        let named = self.graph.nodes.iter().flat_map(|node| node.parameters.paths());
        named.filter(|named| !named.written).map(|named| named.from(&self.graph.folder)).collect()
    }

    /// The files that its nodes write.
    #[cfg(feature = "cli")]
    pub(crate) fn outputs(&self) -> impl Iterator<Item = PathBuf> {
        let named = self.graph.nodes.iter().flat_map(|node| node.parameters.paths());
        named.filter(|named| named.written).map(|named| named.from(&self.graph.folder))
    }

    /// The data files that are read, each with the node that does, and how it was when the picture was drawn.
    fn data(&self) -> impl Iterator<Item = (&str, NamedPath, Option<&DataFile>)> {
        let nodes = self.carried.iter().flat_map(|_| &self.graph.order).map(|&i| &self.graph.nodes[i]);
        let read = nodes.flat_map(|node| node.parameters.paths().into_iter().map(move |named| (node, named)));
        read.filter(|(_, named)| !named.written).map(|(node, named)| {
            let carried = self.carried.as_ref();
            let former = carried.and_then(|c| c.data_file(&node.name, &named.parameter, &named.path));
            (node.name.as_str(), named, former)
        })
    }
}

/// An error of a picture's pipeline, with the plug-ins that it was drawn with: one may be missing.
fn with_plugins(error: Error, carried: Option<&Provenance>) -> Error {
    let plugins: Vec<String> =
        carried.iter().flat_map(|carried| &carried.plugins).map(describe_plugin).collect();
    match (plugins.is_empty(), error.expected.clone()) {
        (false, Some(accepted)) => {
            error.expected(format!("{accepted}; the picture was drawn with the {}", plugins.join(", ")))
        }
        _ => error,
    }
}

/// "plug-in 'name' (path), version 1.0, 16000 bytes, 0123456789abcdef".
fn describe_plugin(plugin: &PluginRecord) -> String {
    let PluginRecord { name, path, version, bytes, fingerprint, .. } = plugin;
    format!("plug-in '{name}' ({path}), version {version}, {bytes} bytes, {fingerprint}")
}

/// " (12 bytes, of 2026-11-22T14:51:03Z, when the picture was drawn)".
fn state(former: &DataFile) -> String {
    let bytes = former.bytes.map(|bytes| counted(bytes, "byte"));
    let date = former.modified.as_ref().map(|date| format!("of {date}"));
    let parts: Vec<String> = bytes.into_iter().chain(date).collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" ({}, when the picture was drawn)", parts.join(", "))
    }
}

/// The text that states `pipeline`, which `options` (`node.param=value`) made of `text`. Where they cannot be written into it,
/// a plain text that states the same.
fn stated(
    text: &str,
    options: &[String],
    pipeline: &Pipeline,
    registry: &Registry,
) -> Result<ResolvedPipeline> {
    let written = match options.is_empty() {
        true => Some(text.to_string()),
        false => {
            written(text, options).filter(|text| Pipeline::parse(text).is_ok_and(|read| read == *pipeline))
        }
    };
    Pipeline::stated(written.unwrap_or_else(|| pipeline.to_string()), registry)
}

fn written(text: &str, options: &[String]) -> Option<String> {
    let mut document = DocumentText::from_text(text.to_string(), None);
    for option in options {
        let (path, given) = option.split_once('=')?;
        let (node, path) = path.trim().split_once('.')?;
        let value = value(given.trim())
            .map_or_else(|| ParameterValue::Text(given.trim().into()), |setting| setting.datum);
        document.edit(&Edit::Set { node: node.to_string(), path: KeyPath::from(path), value }).ok()?;
    }
    Some(document.text().to_string())
}

/// A use of a file, with its description for messages.
struct Entry<'a> {
    file: Use,
    /// "'path' of the node 'file'".
    by: String,
    document: Option<&'a Document>,
    /// The node that names it, and how.
    node: Option<(&'a GraphNode, NamedPath)>,
}

impl Entry<'_> {
    /// An error that points to the file's name.
    fn locate(&self, error: Error) -> Error {
        match (&self.node, self.document) {
            (Some((node, named)), Some(document)) => {
                let is_given = !matches!(named.origin, SourceSpan::Nowhere);
                let origin = if is_given { &named.origin } else { &node.origin };
                document.locate(origin.locate(error.at_node(&node.name)))
            }
            (None, None) => error.in_file(&self.by),
            _ => error,
        }
    }

    /// "'path' of the node 'file' (scene.toml:7:8)".
    fn place(&self) -> String {
        let place = self.locate(Error::usage("")).location;
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
        refuse_conflicts([self], true, &[]).map_err(|failure| failure.error)
    }

    /// The file itself, those that nodes name, and those that are read beside these. `nodes_write`: true if the writers run.
    fn entries(&self, nodes_write: bool) -> Vec<Entry<'_>> {
        let read = |path: PathBuf, by: String| Entry {
            file: Use { path, written: false },
            by,
            document: Some(self),
            node: None,
        };
        let own = if self.carried.is_some() { "as the picture to draw again" } else { "as a pipeline file" };
        let mut entries = vec![read(self.path.clone(), format!("the program, {own},"))];
        for node in &self.graph.nodes {
            for named in node.parameters.paths().into_iter().filter(|named| nodes_write || !named.written) {
                let path = named.from(&self.graph.folder);
                if !named.written {
                    let by = format!("the program, as a part of the data file '{}',", path.display());
                    entries.extend(files_beside(&path).into_iter().map(|path| read(path, by.clone())));
                }
                let by = format!("'{}' of the node '{}'", named.parameter, node.name);
                let file = Use { path, written: named.written };
                entries.push(Entry { file, by, document: Some(self), node: Some((node, named)) });
            }
        }
        entries
    }
}

/// Refuses a call that would overwrite its inputs or outputs. `nodes_write`: true if the writers run; `options`: options with the files
/// to be written that they name.
pub(crate) fn refuse_conflicts<'a>(
    documents: impl IntoIterator<Item = &'a Document>,
    nodes_write: bool,
    options: &'a [(&'a str, &'a Path)],
) -> std::result::Result<(), LocatedError> {
    let of_option = |(option, path): &(&str, &Path)| Entry {
        file: Use { path: path.to_path_buf(), written: true },
        by: format!("{option} {}", path.display()),
        document: None,
        node: None,
    };
    let of_documents = documents.into_iter().flat_map(|document| document.entries(nodes_write));
    let entries: Vec<Entry> = of_documents.chain(options.iter().map(of_option)).collect();
    let uses: Vec<Use> = entries.iter().map(|entry| entry.file.clone()).collect();
    let Some([writer, other]) = collision(&uses) else { return Ok(()) };
    let (writer, other) = (&entries[writer], &entries[other]);
    let (what, verb) = match other.file.written {
        true => ("two outputs of this call are one file", "writes, too"),
        false => ("this output would overwrite what the call reads", "reads"),
    };
    let (own, others) = (writer.file.path.display(), other.file.path.display());
    let is_same = writer.file.path == other.file.path;
    let spelled = if is_same { String::new() } else { format!(", the same file as '{others}'") };
    let expected = match (&writer.node, other.document) {
        // Only what is read has no node and a document.
        (Some((node, named)), Some(document)) if other.node.is_none() && document.carried.is_some() => {
            let parameter = format!("{}.{}", node.name, named.parameter);
            format!("--set {parameter}=OTHER, or the picture to draw again under another name")
        }
        _ => "a file of its own for every output".into(),
    };
    let error = Error::usage(what).got(format!("'{own}'{spelled}, which {} {verb}", other.place()));
    let text = writer.document.map(|document| document.text.clone());
    Err(LocatedError { error: writer.locate(error.expected(expected)), text })
}
