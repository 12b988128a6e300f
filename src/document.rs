//! A pipeline file with its text and its checked graph.

use std::path::{Path, PathBuf};
use voltet_core::graph::{Graph, Registry, suggest};
use voltet_core::pipeline::{Pipeline, locate};
use voltet_core::{Error, Result};

/// A pipeline file, read and checked.
#[derive(Debug)]
pub struct Document {
    /// Its path.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// What it states, with the options carried out.
    pub pipeline: Pipeline,
    /// The graph that it makes.
    pub graph: Graph,
}

impl Document {
    /// Reads a pipeline file, carries out `options` (`node.param=value`) and checks it.
    pub fn open(path: &Path, options: &[String], registry: &Registry) -> Result<Document> {
        let text = read_text(path)?;
        Self::from_text(path, text, options, registry)
    }

    /// The same for a text that was read already; paths in it are relative to the folder of `path`.
    pub fn from_text(path: &Path, text: String, options: &[String], registry: &Registry) -> Result<Document> {
        let located = |error| locate(error, &text, path);
        let mut pipeline = Pipeline::parse(&text).map_err(located)?;
        options.iter().try_for_each(|option| pipeline.set(option)).map_err(located)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let graph = pipeline.graph(registry, folder).map_err(located)?;
        Ok(Document { path: path.to_path_buf(), text, pipeline, graph })
    }

    /// Completes an error of a run with the place in this file.
    pub fn locate(&self, error: Error) -> Error {
        locate(error, &self.text, &self.path)
    }
}

/// The text of a pipeline file.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|error| {
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let names: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        let pipelines = names.iter().map(String::as_str).filter(|name| name.ends_with(".toml"));
        let wanted = path.file_name().unwrap_or_default().to_string_lossy();
        let error = Error::usage("the pipeline file cannot be read").found(error).in_file(path);
        match pipelines.clone().next() {
            Some(_) => error.accepted(suggest(&wanted, pipelines)),
            None => error.accepted("the path of a pipeline file (.toml)"),
        }
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
        Error::usage("the file is no pipeline file").found(found).accepted("TOML text").in_file(path)
    })
}
