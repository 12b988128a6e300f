//! A pipeline file, or a picture that carries one, with its text and its checked graph.

use crate::stated_text::stated;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_graph::pipeline::{Pipeline, locate};
use voltet_graph::{Graph, NamedPath, Registry};
use voltet_io::provenance::{DataFile, PluginRecord, Provenance};

pub use voltet_io::encode::Source;

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
    let bytes = former.bytes.map(|bytes| format!("{bytes} bytes"));
    let date = former.modified.as_ref().map(|date| format!("of {date}"));
    let parts: Vec<String> = bytes.into_iter().chain(date).collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" ({}, when the picture was drawn)", parts.join(", "))
    }
}
