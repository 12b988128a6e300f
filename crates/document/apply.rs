//! Edits carried out on a text.

mod view;

use crate::delta::Delta;
use crate::edit::Edit;
use crate::links;
use crate::path::Path;
use crate::text::{Draft, Syntax};
use crate::view::View;
use std::sync::Arc;
use voltet_core::parameters::key_text;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::{EDITOR, ParsedPipeline, Pipeline};
use voltet_graph::{Field, LocatedValue, NodeEntry, ParameterValue, suggest};

/// A text that edits are carried out on, and what it states.
pub(crate) struct EditContext {
    draft: Draft,
    survey: Arc<ParsedPipeline>,
}

/// A text that edits made, and the way to it.
pub(crate) struct EditOutcome {
    pub delta: Delta,
    pub text: Arc<str>,
    pub syntax: Arc<Syntax>,
    pub survey: Arc<ParsedPipeline>,
}

impl EditContext {
    pub fn new(text: Arc<str>, syntax: Arc<Syntax>, survey: Arc<ParsedPipeline>) -> EditContext {
        EditContext { draft: Draft::new(text, syntax), survey }
    }

    /// All changes, the text that they make, and what it states.
    pub fn finish(self) -> Result<EditOutcome> {
        let (delta, text, syntax) = self.draft.into_delta()?;
        Ok(EditOutcome { delta, text, syntax, survey: self.survey })
    }

    /// Carries one out. `shown`: the places of the nodes in the view, which the file gets where it has none.
    pub fn apply(&mut self, edit: &Edit, shown: &dyn Fn(&str) -> Option<[f64; 2]>) -> Result<()> {
        self.change(edit, shown)?;
        self.draft.reparse()?;
        self.survey = Arc::new(Pipeline::survey(self.draft.text()));
        if !self.survey.is_toml {
            // A form that this does not know how to change.
            let error = Error::run(format!(
                "this cannot be done in the way that the file is written: {}",
                edit.label()
            ));
            return Err(error.expected("the change made in the text"));
        }
        Ok(())
    }

    fn change(&mut self, edit: &Edit, shown: &dyn Fn(&str) -> Option<[f64; 2]>) -> Result<()> {
        match edit {
            Edit::AddNode { name, node_type, settings, at } => {
                self.add_node(name, node_type, settings, *at, shown)
            }
            Edit::RemoveNodes(names) => self.remove_nodes(names),
            Edit::Rename { node, to } => self.rename(node, to),
            Edit::Set { node, path, value } => self.draft.set(&self.parameter(node, path)?, value),
            Edit::Unset { node, path } => {
                let path = self.parameter(node, path)?;
                self.draft.unset(&path)
            }
            Edit::Insert { node, list, place, entry } => {
                self.draft.insert(&self.parameter(node, list)?, *place, entry)
            }
            Edit::Duplicate { node, list, place } => {
                self.draft.duplicate(&self.parameter(node, list)?, *place)
            }
            Edit::MoveEntry { node, list, from, to } => {
                self.draft.move_entry(&self.parameter(node, list)?, *from, *to)
            }
            Edit::Connect { node, port, source, beside } => self.connect(node, port, source, *beside),
            Edit::Disconnect { node, port, source } => self.disconnect(node, port, source.as_deref()),
            Edit::AddLines(text) => self.draft.add_block(&Path::from(["nodes"]), text),
            Edit::MoveNodes(moved) => self.move_nodes(moved, shown),
            Edit::Fold { node, folded } => self.show_node(node, shown, |view| view.folded = *folded),
            Edit::Remark { node, text } => self.show_node(node, shown, |view| view.remark = text.clone()),
            Edit::PutFrame(number, frame) => self.put("frames", *number, &frame.datum()),
            Edit::RemoveFrame(number) => self.take("frames", *number),
            Edit::PutNote(number, note) => self.put("notes", *number, &note.datum()),
            Edit::RemoveNote(number) => self.take("notes", *number),
            Edit::StoreSet(digit, widgets) => {
                if *digit > 9 {
                    return Err(Error::usage("there is no such set").got(digit).expected("0 to 9"));
                }
                let path = Path::from([EDITOR, "sets", &digit.to_string()]);
                // Written anew: what stood there says nothing of these.
                self.draft.unset(&path)?;
                self.draft.reparse()?;
                self.draft.add(&path, &ParameterValue::List(widgets.clone()).to_string())
            }
            Edit::Title(Some(title)) => {
                self.draft.set(&Path::from(["pipeline", "title"]), &ParameterValue::Text(title.clone()))
            }
            Edit::Title(None) => self.draft.unset(&Path::from(["pipeline", "title"])),
            // Whole texts are no work on a draft; the document takes them in itself.
            Edit::Text(_) => Ok(()),
        }
    }

    fn node(&self, name: &str) -> Result<&NodeEntry> {
        let nodes = &self.survey.pipeline.nodes;
        nodes.iter().find(|node| node.name == name).ok_or_else(|| {
            let known = suggest(name, nodes.iter().map(|node| node.name.as_str()));
            Error::usage(format!("there is no node '{name}'")).expected(known)
        })
    }

    fn parameter(&self, node: &str, path: &Path) -> Result<Path> {
        self.node(node)?;
        if path.0.is_empty() {
            return Err(Error::usage("a path must name a parameter"));
        }
        Ok(Path::from(["nodes", node]).and(path))
    }

    fn refuse_taken(&self, name: &str) -> Result<()> {
        if name.is_empty() {
            return Err(Error::usage("a node needs a name"));
        }
        match self.node(name) {
            Ok(_) => Err(Error::usage(format!("there is a node '{name}' already")).expected("another name")),
            Err(_) => Ok(()),
        }
    }

    fn add_node(
        &mut self,
        name: &str,
        node_type: &str,
        settings: &[Field],
        at: Option<[f64; 2]>,
        shown: &dyn Fn(&str) -> Option<[f64; 2]>,
    ) -> Result<()> {
        self.refuse_taken(name)?;
        let type_field = Field {
            name: "type".into(),
            origin: Default::default(),
            setting: ParameterValue::Text(node_type.into()).into(),
        };
        let fields: Vec<Field> = [type_field].into_iter().chain(settings.iter().cloned()).collect();
        self.draft.add_table(&Path::from(["nodes", name]), &fields)?;
        if let Some(at) = at {
            self.draft.reparse()?;
            self.pin(&[(name.to_string(), at)], shown)?;
        }
        Ok(())
    }

    fn remove_nodes(&mut self, names: &[String]) -> Result<()> {
        let nodes = self.survey.pipeline.nodes.clone();
        let view = View::read(&self.survey.editor);
        for name in names {
            self.node(name)?;
            self.draft.unset(&Path::from(["nodes", name]))?;
            if view.nodes.contains_key(name) {
                self.draft.unset(&Path::from([EDITOR, "nodes", name]))?;
            }
        }
        for node in nodes.iter().filter(|node| !names.contains(&node.name)) {
            let kept =
                links::without(node, |source| names.iter().any(|name| links::is_of(source, name, &nodes)));
            self.put_inputs(node, kept)?;
        }
        Ok(())
    }

    fn rename(&mut self, from: &str, to: &str) -> Result<()> {
        self.node(from)?;
        if from == to {
            return Ok(());
        }
        self.refuse_taken(to)?;
        let nodes = self.survey.pipeline.nodes.clone();
        self.draft.rename(&Path::from(["nodes", from]), to)?;
        if View::read(&self.survey.editor).nodes.contains_key(from) {
            self.draft.rename(&Path::from([EDITOR, "nodes", from]), to)?;
        }
        // Where the renamed node is fed by itself or others, its inputs are written below the old name still.
        for node in &nodes {
            let named = links::renamed(node, from, to, &nodes);
            self.put_inputs(node, named)?;
        }
        Ok(())
    }

    fn connect(&mut self, node: &str, port: &str, source: &str, beside: bool) -> Result<()> {
        let path = Path::from(["nodes", node, "inputs", port]);
        let there = self.node(node)?.inputs.iter().find(|link| link.port == port).map(|link| &link.source);
        let wire = LocatedValue::from(ParameterValue::Text(source.to_string()));
        let datum = match there.filter(|_| beside) {
            None => wire.datum,
            Some(there) => {
                let several =
                    there.list().map(<[LocatedValue]>::to_vec).unwrap_or_else(|| vec![there.clone()]);
                if several.iter().any(|known| known.text() == Some(source)) {
                    return Ok(());
                }
                ParameterValue::List(several.into_iter().chain([wire]).collect())
            }
        };
        self.draft.set(&path, &datum)
    }

    fn disconnect(&mut self, node: &str, port: &str, source: Option<&str>) -> Result<()> {
        let entry = self.node(node)?.clone();
        let kept = links::without_wire(&entry, port, source);
        self.put_inputs(&entry, kept)
    }

    /// Writes what feeds a node, where that differs.
    fn put_inputs(&mut self, node: &NodeEntry, inputs: Option<Vec<Field>>) -> Result<()> {
        let path = Path::from(["nodes", &node.name, "inputs"]);
        match inputs {
            None => Ok(()),
            Some(fields) if fields.is_empty() => self.draft.unset(&path),
            Some(fields) => self.draft.set(&path, &ParameterValue::Table(fields)),
        }
    }
}

/// The text of a new pipeline file.
pub(crate) fn blank(title: Option<&str>) -> String {
    let title =
        title.map(|title| format!("{} = {}\n", key_text("title"), ParameterValue::Text(title.into())));
    format!("[pipeline]\nformat = {}\n{}", voltet_graph::pipeline::FORMAT, title.unwrap_or_default())
}
