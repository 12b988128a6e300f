//! Edits of a document.

use crate::path::Path;
use crate::view::{Frame, Note};
use voltet_graph::{Field, LocatedValue, ParameterValue};

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
    /// Words that stand with a node in the graph view; none takes them away.
    Remark { node: String, text: Option<String> },
    /// A frame in place of another; one more where the number is that of all.
    PutFrame(usize, Frame),
    /// A frame less.
    RemoveFrame(usize),
    /// A note in place of another; one more where the number is that of all.
    PutNote(usize, Note),
    /// A note less.
    RemoveNote(usize),
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
            many => format!("{} nodes", many.len()),
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
            Edit::Remark { node, .. } => format!("remark on '{node}'"),
            Edit::PutFrame(..) => "change a frame".into(),
            Edit::RemoveFrame(_) => "remove a frame".into(),
            Edit::PutNote(..) => "change a note".into(),
            Edit::RemoveNote(_) => "remove a note".into(),
            Edit::StoreSet(digit, widgets) => format!("store {} widgets as {digit}", widgets.len()),
            Edit::Title(_) => "change the title".into(),
            Edit::Text(_) => "edit the text".into(),
        }
    }
}
