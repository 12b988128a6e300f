//! Edits of a document, carried out on its text.

use crate::links;
use crate::path::Path;
use crate::text::Draft;
use crate::view::{Annotation, AnnotationId, NodeView, View, position_value};
use std::sync::Arc;
use voltet_core::{Error, Result, counted};
use voltet_graph::pipeline::{EDITOR, ParsedPipeline, Pipeline};
use voltet_graph::{Field, LocatedValue, NodeEntry, ParameterValue, find_setting};

/// One edit. A path leads from a node's table to a part of its parameters: `"widgets.0.centre".into()`. Numbers of entries count
/// from 0; a source is `node` or `node.port`.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the fields' names say what they are")]
pub enum Edit {
    /// A node more, of a type, with parameters, under a name that no node has (see [`Document::free_name`]); `at`: its place in the
    /// graph view.
    ///
    /// [`Document::free_name`]: crate::Document::free_name
    AddNode { name: String, node_type: String, settings: Vec<Field>, at: Option<[f64; 2]> },
    /// Nodes less. Their wires go with them, and the comments that belong to them.
    RemoveNodes(Vec<String>),
    /// Another name, which no node has yet; wires follow.
    Rename { node: String, to: String },
    /// Another value of a parameter or of a part of it, stated so far or not.
    Set { node: String, path: Path, value: ParameterValue },
    /// A parameter, or a part of it, is not stated any more; an entry of a list is gone.
    Unset { node: String, path: Path },
    /// An entry more in a list, such as a widget; its number is the list's length for the end.
    Insert { node: String, list: Path, place: usize, entry: ParameterValue },
    /// A copy of an entry, after it.
    Duplicate { node: String, list: Path, place: usize },
    /// An entry of a list gets another number.
    MoveEntry { node: String, list: Path, from: usize, to: usize },
    /// A wire: in place of what feeds the input, or beside that.
    Connect { node: String, port: String, source: String, beside: bool },
    /// A wire less, as the file says it; without a source all wires of the input.
    Disconnect { node: String, port: String, source: Option<String> },
    /// Nodes more, as TOML text, after the others; see [`Document::paste`](crate::Document::paste).
    AddLines(String),
    /// Other places in the graph view.
    MoveNodes(Vec<(String, [f64; 2])>),
    /// A node shows its head alone, or all.
    Fold { node: String, folded: bool },
    /// A node adds nothing to the window's picture.
    Hide { node: String, hidden: bool },
    /// Words that stand with a node in the graph view; none takes them away.
    Remark { node: String, text: Option<String> },
    /// A frame or a note in place of another; one more where the number is that of all.
    Annotate(AnnotationId, Annotation),
    /// A frame or a note less.
    RemoveAnnotation(AnnotationId),
    /// A set of widgets under a digit, 0 to 9, in place of what was there.
    StoreSet(u8, Vec<LocatedValue>),
    /// Another title; none takes it away.
    Title(Option<String>),
    /// Another text, which need not be valid: for typing in it.
    Text(String),
}

impl Edit {
    /// A parameter set: what most edits are.
    pub fn set(node: &str, path: impl Into<Path>, value: ParameterValue) -> Edit {
        Edit::Set { node: node.to_string(), path: path.into(), value }
    }

    /// The edit in words, for "Undo …".
    pub fn label(&self) -> String {
        let nodes = |names: &[String]| match names {
            [one] => format!("'{one}'"),
            many => counted(many.len(), "node"),
        };
        match self {
            Edit::AddNode { name, .. } => format!("add '{name}'"),
            Edit::RemoveNodes(names) => format!("remove {}", nodes(names)),
            Edit::Rename { node, to } => format!("rename '{node}' to '{to}'"),
            Edit::Set { node, path, .. } => format!("set {node}.{path}"),
            Edit::Unset { node, path } => format!("take out {node}.{path}"),
            Edit::Insert { node, list, .. } => format!("add to {node}.{list}"),
            Edit::Duplicate { node, list, place } => format!("duplicate {node}.{list}.{place}"),
            Edit::MoveEntry { node, list, from, .. } => format!("move {node}.{list}.{from}"),
            Edit::Connect { node, port, source, .. } => format!("connect '{source}' to {node}.{port}"),
            Edit::Disconnect { node, port, .. } => format!("disconnect {node}.{port}"),
            Edit::AddLines(_) => "paste".into(),
            Edit::MoveNodes(moved) => {
                format!("move {}", nodes(&moved.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>()))
            }
            Edit::Fold { node, folded: true } => format!("fold '{node}'"),
            Edit::Fold { node, folded: false } => format!("unfold '{node}'"),
            Edit::Hide { node, hidden: true } => format!("take '{node}' out of the picture"),
            Edit::Hide { node, hidden: false } => format!("bring '{node}' back into the picture"),
            Edit::Remark { node, .. } => format!("remark on '{node}'"),
            Edit::Annotate(id, _) => format!("change {}", id.parts().1),
            Edit::RemoveAnnotation(id) => format!("remove {}", id.parts().1),
            Edit::StoreSet(digit, widgets) => {
                format!("store {} as {digit}", counted(widgets.len(), "widget"))
            }
            Edit::Title(_) => "change the title".into(),
            Edit::Text(_) => "edit the text".into(),
        }
    }
}

/// A text that edits are carried out on, and what it states.
pub(crate) struct EditContext<'a> {
    pub draft: Draft,
    pub survey: Arc<ParsedPipeline>,
    /// The places of the nodes in the view, which the file gets where it has none.
    pub shown: &'a dyn Fn(&str) -> Option<[f64; 2]>,
}

impl EditContext<'_> {
    /// Carries one out.
    pub fn apply(&mut self, edit: &Edit) -> Result<()> {
        self.change(edit)?;
        self.draft.reparse()?;
        self.survey = Arc::new(Pipeline::survey(&self.draft.text));
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

    fn change(&mut self, edit: &Edit) -> Result<()> {
        match edit {
            Edit::AddNode { name, node_type, settings, at } => self.add_node(name, node_type, settings, *at),
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
            Edit::MoveNodes(moved) => self.move_nodes(moved),
            Edit::Fold { node, folded } => self.show_node(node, |view| view.folded = *folded),
            Edit::Hide { node, hidden } => self.show_node(node, |view| view.hidden = *hidden),
            Edit::Remark { node, text } => self.show_node(node, |view| view.remark = text.clone()),
            Edit::Annotate(id, annotation) => self.put(*id, &annotation.datum()),
            Edit::RemoveAnnotation(id) => self.take(*id),
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
        links::node(&self.survey.pipeline.nodes, name)
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
    ) -> Result<()> {
        self.refuse_taken(name)?;
        let type_field = Field::new("type", node_type);
        let fields: Vec<Field> = std::iter::once(type_field).chain(settings.iter().cloned()).collect();
        self.draft.add_table(&Path::from(["nodes", name]), &fields)?;
        if let Some(at) = at {
            self.draft.reparse()?;
            self.pin(&[(name.to_string(), at)])?;
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
            let is_gone = |text: &str| names.iter().any(|name| name == links::source(text, &nodes).0);
            self.put_inputs(node, |_, text| (!is_gone(text)).then(|| text.to_string()))?;
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
            self.put_inputs(node, |_, text| match links::source(text, &nodes) {
                (name, Some(port)) if name == from => Some(format!("{to}.{port}")),
                (name, None) if name == from => Some(to.to_string()),
                _ => Some(text.to_string()),
            })?;
        }
        Ok(())
    }

    fn connect(&mut self, node: &str, port: &str, source: &str, beside: bool) -> Result<()> {
        let path = Path::from(["nodes", node, "inputs", port]);
        let there = self.node(node)?.inputs.iter().find(|link| link.port == port).map(|link| &link.source);
        let wire = LocatedValue::from(source);
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
        let is_gone = |name: &str, text: &str| name == port && source.is_none_or(|gone| gone == text);
        self.put_inputs(&entry, |name, text| (!is_gone(name, text)).then(|| text.to_string()))
    }

    /// Writes what feeds a node after a change of each wire (its input and its source), where that differs.
    fn put_inputs(&mut self, node: &NodeEntry, change: impl Fn(&str, &str) -> Option<String>) -> Result<()> {
        let path = Path::from(["nodes", &node.name, "inputs"]);
        match links::changed(node, change) {
            None => Ok(()),
            Some(fields) if fields.is_empty() => self.draft.unset(&path),
            Some(fields) => self.draft.set(&path, &ParameterValue::Table(fields)),
        }
    }

    fn move_nodes(&mut self, moved: &[(String, [f64; 2])]) -> Result<()> {
        moved.iter().try_for_each(|(name, _)| self.node(name).map(drop))?;
        self.pin(moved)
    }

    /// Writes places: those given, and those of all other nodes as they are shown, so that the file shows the same again.
    fn pin(&mut self, given: &[(String, [f64; 2])]) -> Result<()> {
        let view = View::read(&self.survey.editor);
        let has_place = |name: &str| view.nodes.get(name).is_some_and(|node| node.position.is_some());
        let others = self.survey.pipeline.nodes.iter().map(|node| &node.name);
        let others = others.filter(|name| !has_place(name) && !given.iter().any(|(known, _)| known == *name));
        let others: Vec<(String, [f64; 2])> =
            others.filter_map(|name| Some((name.clone(), (self.shown)(name)?))).collect();
        let mut fresh = Vec::new();
        for (name, at) in others.iter().chain(given) {
            let mut node = view.nodes.get(name).cloned().unwrap_or_default();
            node.position = Some(*at);
            if view.nodes.contains_key(name) {
                self.put_view(name, &node)?
            } else {
                fresh.push((name.as_str(), position_value(*at)))
            }
        }
        self.draft.add_lines(&Path::from([EDITOR, "nodes"]), &fresh)
    }

    fn show_node(&mut self, name: &str, change: impl FnOnce(&mut NodeView)) -> Result<()> {
        self.node(name)?;
        let mut node = View::read(&self.survey.editor).nodes.remove(name).unwrap_or_default();
        node.position = node.position.or_else(|| (self.shown)(name));
        change(&mut node);
        self.put_view(name, &node)
    }

    fn put_view(&mut self, name: &str, node: &NodeView) -> Result<()> {
        let path = Path::from([EDITOR, "nodes", name]);
        match node.datum() {
            Some(datum) => self.draft.set(&path, &datum),
            None => self.draft.unset(&path),
        }
    }

    /// Puts a frame or a note, each on a line of its own.
    fn put(&mut self, id: AnnotationId, datum: &ParameterValue) -> Result<()> {
        let (list, _, number) = id.parts();
        let path = Path::from([EDITOR, list]);
        match self.count_of(list) {
            0 if number == 0 => {
                self.draft.unset(&path)?;
                self.draft.reparse()?;
                self.draft.add(&path, &format!("[\n  {datum},\n]"))
            }
            count if number < count => self.draft.set(&path.with(number), datum),
            _ => self.draft.insert(&path, number, datum),
        }
    }

    fn count_of(&self, list: &str) -> usize {
        find_setting(&self.survey.editor, list).and_then(LocatedValue::list).map_or(0, <[_]>::len)
    }

    fn take(&mut self, id: AnnotationId) -> Result<()> {
        let (list, _, number) = id.parts();
        let path = Path::from([EDITOR, list]);
        match self.count_of(list) {
            1 if number == 0 => self.draft.unset(&path),
            count if number < count => self.draft.unset(&path.with(number)),
            _ => Err(Error::usage("there is no such thing in the view").got(path.with(number))),
        }
    }
}
