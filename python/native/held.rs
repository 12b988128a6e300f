//! What a pipeline holds: its text as a document, and what its runs left.

use crate::filter;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};
use voltet_document::{Document, Edit, Fault, FaultTarget, Path as Place};
use voltet_embed::{Account, Scene, Session};
use voltet_graph::pipeline::Pipeline as Nodes;
use voltet_graph::{Field, NodeEntry, ParameterValue, SourceSpan};
use voltet_io::provenance::{Provenance, Source};

/// A pipeline's text, and what its runs left.
pub struct Held {
    pub stated: Stated,
    pub runs: Session,
    /// The filters that the session knows.
    epoch: u64,
}

/// What is stated, and where it came from.
pub struct Stated {
    pub document: Document,
    /// The picture that carries it, in place of a file, and what it says of itself.
    pub picture: Option<(PathBuf, Provenance)>,
}

impl Scene for Stated {
    fn pipeline(&self) -> &Nodes {
        self.document.pipeline()
    }

    fn folder(&self) -> PathBuf {
        match &self.picture {
            Some((path, _)) => path.parent().unwrap_or(Path::new("")).to_path_buf(),
            None => self.document.folder(),
        }
    }

    fn path(&self) -> PathBuf {
        let file = self.document.path().map(Path::to_path_buf);
        let picture = self.picture.as_ref().map(|picture| picture.0.clone());
        picture.or(file).unwrap_or("a new pipeline".into())
    }

    fn locate(&self, error: Error) -> Error {
        match &self.picture {
            Some((path, _)) => voltet_graph::pipeline::locate(error, self.document.text(), path),
            None => self.document.locate(error),
        }
    }
}

impl Held {
    /// From a file, or a picture that carries one; from a text; or empty.
    pub fn open(path: Option<PathBuf>, text: Option<String>) -> Result<Held> {
        let empty = path.is_none() && text.is_none();
        let (document, picture) = match (path, text) {
            (Some(path), None) => {
                let source = Source::read(&path)?;
                match source.embedded {
                    Some(carried) => (Document::from_text(source.text, None), Some((path, carried))),
                    None => (Document::open(&path)?, None),
                }
            }
            (path, Some(text)) => (Document::from_text(text, path), None),
            (None, None) => (Document::new(), None),
        };
        let epoch = filter::epoch();
        let runs = Session::new(filter::registry()?)?;
        let mut held = Held { stated: Stated { document, picture }, runs, epoch };
        // Nodes are to come.
        if !empty {
            held.sound()?;
        }
        Ok(held)
    }

    /// Knows the filters that are registered now.
    fn refresh(&mut self) -> Result<()> {
        let epoch = filter::epoch();
        if epoch != self.epoch {
            self.runs.know(filter::registry()?)?;
            self.epoch = epoch;
        }
        Ok(())
    }

    /// Refuses a text that is no pipeline.
    pub fn sound(&mut self) -> Result<()> {
        self.refresh()?;
        let faults = self.stated.document.faults_of(&[], self.runs.registry());
        faults.into_iter().find(|fault| fault.node.is_none()).map_or(Ok(()), |fault| Err(fault.error))
    }

    /// Carries out edits; what they leave wrong in the parameters of these nodes undoes them.
    pub fn edit(&mut self, nodes: &[&str], label: String, edits: &[Edit]) -> Result<()> {
        self.refresh()?;
        let before = self.faults(nodes);
        let document = &mut self.stated.document;
        document.edit_all(label, edits, None).map_err(|error| document.locate(error))?;
        let is_new = |fault: &Fault| !before.iter().any(|known| known.error.what == fault.error.what);
        match self.faults(nodes).into_iter().find(is_new) {
            None => Ok(()),
            Some(fault) => {
                self.stated.document.undo()?;
                Err(fault.error)
            }
        }
    }

    /// What is wrong with nodes, but for their wires, which may lead to nodes that are to come.
    fn faults(&self, nodes: &[&str]) -> Vec<Fault> {
        if nodes.is_empty() {
            return Vec::new();
        }
        let concerns = |fault: &Fault| fault.node.as_deref().is_some_and(|name| nodes.contains(&name));
        let mut faults = self.stated.document.faults_of(nodes, self.runs.registry());
        faults.retain(|fault| concerns(fault) && !matches!(fault.target, FaultTarget::Input(_)));
        faults
    }

    pub fn node(&self, name: &str) -> Result<&NodeEntry> {
        let nodes = &self.stated.pipeline().nodes;
        nodes.iter().find(|node| node.name == name).ok_or_else(|| {
            let error = Error::usage(format!("there is no node '{name}'"));
            error.expected(voltet_graph::suggest(name, nodes.iter().map(|node| node.name.as_str())))
        })
    }

    /// Saves the text; what it reads is found from the new file, too. `readers`: nodes that a program gives grids to, each with the
    /// file that holds its grid and the scalar: they read it from there. Where nothing is written, what writes the picture is added,
    /// so that the file can be run.
    pub fn save(&mut self, path: Option<PathBuf>, readers: Vec<(String, String, String)>) -> Result<PathBuf> {
        self.sound()?;
        let own = self.stated.document.path().map(Path::to_path_buf);
        let nowhere = || Error::usage("the pipeline has no file yet").expected("a path to save it to");
        let to = path.or(own).ok_or_else(nowhere)?;
        if let Some((picture, _)) = self.stated.picture.take() {
            // From now on it is a file's, which was in the picture's folder.
            let text = self.stated.document.text().to_string();
            self.stated.document = Document::from_text(text, Some(picture));
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
        edits.extend(self.stated.document.following_to(self.runs.registry(), folder));
        edits.extend(self.writer(&to));
        if !edits.is_empty() {
            let document = &mut self.stated.document;
            document
                .edit_all("save elsewhere".into(), &edits, None)
                .map_err(|error| document.locate(error))?;
        }
        self.stated.document.save_as(&to)?;
        Ok(to)
    }

    /// What adds a node `file` that writes the only picture beside the file `to`, where no node writes anything.
    fn writer(&self, to: &Path) -> Vec<Edit> {
        let nodes = &self.stated.pipeline().nodes;
        let node_type = |entry: &NodeEntry| self.runs.registry().find(entry.node_type.text()?).ok();
        let writes = nodes.iter().filter_map(node_type).any(|node| node.outputs.is_empty());
        let (Ok(source), Some(stem)) = (self.runs.picture(&self.stated, None), to.file_stem()) else {
            return Vec::new();
        };
        let name = "file".to_string();
        if writes || nodes.iter().any(|entry| entry.name == name) {
            return Vec::new();
        }
        let picture = ParameterValue::Text(format!("{}.png", stem.to_string_lossy()));
        let path = Field { name: "path".into(), origin: SourceSpan::Nowhere, setting: picture.into() };
        let node_type = "image-writer".to_string();
        let add = Edit::AddNode { name: name.clone(), node_type, settings: vec![path], at: None };
        vec![add, Edit::Connect { node: name, port: "image".into(), source, beside: false }]
    }

    /// The program's own view of the pipeline: what `voltet run` would refuse to write over is refused.
    pub fn as_run(&mut self) -> Result<voltet::Document> {
        self.sound()?;
        let mut graph = self.runs.whole(&self.stated)?;
        let text = self.stated.document.text().to_string();
        if let Ok(stated) = Nodes::stated(text.clone(), self.runs.registry()) {
            graph.stated = stated;
        }
        let pipeline = self.stated.pipeline().clone();
        let carried = self.stated.picture.as_ref().map(|picture| picture.1.clone());
        let document = voltet::Document { path: self.stated.path(), text, pipeline, graph, carried };
        document.refuse_collisions()?;
        Ok(document)
    }

    /// An account of the last run.
    pub fn account(&self) -> Option<Account> {
        self.runs.account(&self.stated, self.stated.document.text().to_string())
    }
}
