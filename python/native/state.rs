//! State of a pipeline: its text as a document, and the results that its runs left.

use crate::error::refuse_freeing;
use crate::filter;
use std::path::{Path, PathBuf};
use voltet::{Pipeline, PipelineText};
use voltet_core::{Error, Result};
use voltet_document::{Diagnostic, Document, Edit, FaultTarget, Path as Place, links};
use voltet_graph::pipeline::Pipeline as Nodes;
use voltet_graph::{Field, NodeEntry, ParameterValue};
use voltet_io::encode::Source;
use voltet_io::provenance::Provenance;

/// A pipeline, and the results that its runs left.
pub struct State {
    pub document: Document,
    /// The picture that carries the text, in place of a file, with its provenance where the picture is seen.
    pub picture: Option<(PathBuf, Option<Provenance>)>,
    /// Nodes of the document as it was checked last.
    pub pipeline: Pipeline,
    /// Version of the registered filters.
    epoch: u64,
}

impl State {
    /// From a file, or a picture that carries one; from a text; from a text that was opened from a file or, where `is_picture`, a
    /// picture, as another process hands it over; or empty.
    pub fn open(path: Option<PathBuf>, text: Option<String>, is_picture: bool) -> Result<State> {
        let empty = path.is_none() && text.is_none();
        let (document, picture) = match (path, text) {
            (Some(path), None) => {
                let source = Source::read(&path)?;
                match source.embedded {
                    Some(carried) => (Document::from_text(source.text, None), Some((path, Some(carried)))),
                    None => (Document::open(&path)?, None),
                }
            }
            // The file may be gone, or not be seen from here: the text is what counts.
            (Some(path), Some(text)) if is_picture => {
                let carried = Source::read(&path).ok().and_then(|source| source.embedded);
                (Document::from_text(text, None), Some((path, carried)))
            }
            (Some(path), Some(text)) => (Document::from_text(text, Some(path)), None),
            (None, Some(text)) => (Document::from_text(text, None), None),
            (None, None) => (Document::new(), None),
        };
        let epoch = filter::epoch();
        let mut state = State { document, picture, pipeline: Pipeline::new(filter::registry()?)?, epoch };
        // Nodes are added later.
        if !empty {
            state.check_text()?;
        }
        Ok(state)
    }

    /// Brings the session's filters up to date.
    fn refresh(&mut self) -> Result<()> {
        let epoch = filter::epoch();
        if epoch != self.epoch {
            // Results of former filters are freed, on a device, too.
            refuse_freeing()?;
            self.pipeline.set_registry(filter::registry()?)?;
            self.epoch = epoch;
        }
        Ok(())
    }

    /// The file, or the picture that it came from.
    pub fn path(&self) -> Option<&Path> {
        self.picture.as_ref().map(|picture| &*picture.0).or(self.document.path())
    }

    /// Checks that the text is a pipeline, which runs have from now on.
    pub fn check_text(&mut self) -> Result<()> {
        self.refresh()?;
        let (nodes, text) = (self.document.pipeline().clone(), self.document.text().to_string());
        let path = self.path().unwrap_or(Path::new("a new pipeline")).to_path_buf();
        let folder = match &self.picture {
            Some((path, _)) => path.parent().unwrap_or(Path::new("")).to_path_buf(),
            None => self.document.folder(),
        };
        self.pipeline.source = PipelineText::new(nodes, text, path, folder);
        let faults = self.document.faults_of(&[], self.pipeline.registry());
        faults.into_iter().find(|fault| fault.node.is_none()).map_or(Ok(()), |fault| Err(fault.error))
    }

    /// Carries out edits, and undoes them where they leave wrong parameters of these nodes.
    pub fn edit(&mut self, nodes: &[&str], label: String, edits: &[Edit]) -> Result<()> {
        self.refresh()?;
        let before = self.faults(nodes);
        let document = &mut self.document;
        document.edit_all(label, edits, None).map_err(|error| document.locate(error))?;
        let is_new = |fault: &Diagnostic| !before.iter().any(|known| known.error.what == fault.error.what);
        match self.faults(nodes).into_iter().find(is_new) {
            None => Ok(()),
            Some(fault) => {
                self.document.undo();
                Err(fault.error)
            }
        }
    }

    /// Faults of nodes, but for their wires, which may lead to nodes that are added later.
    fn faults(&self, nodes: &[&str]) -> Vec<Diagnostic> {
        if nodes.is_empty() {
            return Vec::new();
        }
        let concerns = |fault: &Diagnostic| fault.node.as_deref().is_some_and(|name| nodes.contains(&name));
        let mut faults = self.document.faults_of(nodes, self.pipeline.registry());
        faults.retain(|fault| concerns(fault) && !matches!(fault.target, FaultTarget::Input(_)));
        faults
    }

    pub fn node(&self, name: &str) -> Result<&NodeEntry> {
        links::node(&self.document.pipeline().nodes, name)
    }

    /// Saves the text; what it reads is found from the new file, too. `readers`: nodes that a program gives grids to, each with the
    /// file that holds its grid and the scalar: they read it from there. Where nothing is written, what writes the picture is added,
    /// so that the file can be run.
    pub fn save(&mut self, path: Option<PathBuf>, readers: Vec<(String, String, String)>) -> Result<PathBuf> {
        self.check_text()?;
        let own = self.document.path().map(Path::to_path_buf);
        let nowhere = || Error::usage("the pipeline has no file yet").expected("a path to save it to");
        let to = path.or(own).ok_or_else(nowhere)?;
        if let Some((picture, _)) = self.picture.take() {
            // From now on it is a file's, which was in the picture's folder.
            let text = self.document.text().to_string();
            self.document = Document::from_text(text, Some(picture));
        }
        let mut edits = Vec::new();
        for (name, file, scalar) in readers {
            let stated = &self.node(&name)?.settings;
            let gone = stated.iter().filter(|field| field.name != "scalar");
            edits.extend(
                gone.map(|field| Edit::Unset { node: name.clone(), path: Place::from([&*field.name]) }),
            );
            for (key, value) in [("type", "reader".to_string()), ("path", file), ("scalar", scalar)] {
                edits.push(Edit::set(&name, [key], ParameterValue::Text(value)));
            }
        }
        let folder = to.parent().unwrap_or(Path::new(""));
        edits.extend(self.document.following_to(self.pipeline.registry(), folder));
        edits.extend(self.writer(&to));
        if !edits.is_empty() {
            let document = &mut self.document;
            document
                .edit_all("save elsewhere".into(), &edits, None)
                .map_err(|error| document.locate(error))?;
        }
        self.document.save_as(&to)?;
        Ok(to)
    }

    /// Edits that add a node `file` that writes the only picture beside the file `to`, where no node writes anything.
    fn writer(&self, to: &Path) -> Vec<Edit> {
        let nodes = &self.document.pipeline().nodes;
        let node_type = |entry: &NodeEntry| self.pipeline.registry().node_type(entry);
        let writes = nodes.iter().filter_map(node_type).any(|node| node.outputs.is_empty());
        let (Ok(source), Some(stem)) = (self.pipeline.picture_node(None), to.file_stem()) else {
            return Vec::new();
        };
        let name = "file".to_string();
        if writes || nodes.iter().any(|entry| entry.name == name) {
            return Vec::new();
        }
        let path = Field::new("path", format!("{}.png", stem.to_string_lossy()));
        let node_type = "image-writer".to_string();
        let add = Edit::AddNode { name: name.clone(), node_type, settings: vec![path], at: None };
        vec![add, Edit::Connect { node: name, port: "image".into(), source, beside: false }]
    }

    /// The pipeline as `voltet run` checks it: outputs that would overwrite inputs are refused.
    pub fn document(&mut self) -> Result<voltet::Document> {
        self.check_text()?;
        let mut graph = self.pipeline.whole_graph()?;
        let text = self.document.text().to_string();
        if let Ok(stated) = Nodes::stated(text.clone(), self.pipeline.registry()) {
            graph.stated = stated;
        }
        let path = self.path().unwrap_or(Path::new("a new pipeline")).to_path_buf();
        let (pipeline, carried) =
            (self.document.pipeline().clone(), self.picture.as_ref().and_then(|p| p.1.clone()));
        let document = voltet::Document { path, text, pipeline, graph, carried };
        document.refuse_collisions()?;
        Ok(document)
    }
}
