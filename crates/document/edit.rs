//! Edits of a document.

use crate::path::Path;
use crate::view::{Frame, Note};
use voltet_graph::{Field, LocatedValue, ParameterValue};

/// One edit. A path leads from a node's table to a part of its parameters: `"widgets.0.centre".into()`.
#[derive(Debug, Clone, PartialEq)]
pub enum Edit {
    /// A node more, of a type, with parameters; `at` is its place in the graph view.
    AddNode {
        /// Its name, which no node has yet; see [`Document::free_name`](crate::Document::free_name).
        name: String,
        /// Its type.
        node_type: String,
        /// Its parameters.
        settings: Vec<Field>,
        /// Its place.
        at: Option<[f64; 2]>,
    },
    /// Nodes less. Their wires go with them, and the comments that belong to them.
    RemoveNodes(Vec<String>),
    /// Another name; wires follow.
    Rename {
        /// The node.
        node: String,
        /// Its new name, which no node has yet.
        to: String,
    },
    /// Another value of a parameter or of a part of it, stated so far or not.
    Set {
        /// The node.
        node: String,
        /// Path of the value.
        path: Path,
        /// Its value.
        value: ParameterValue,
    },
    /// A parameter, or a part of it, is not stated any more; an entry of a list is gone.
    Unset {
        /// The node.
        node: String,
        /// Path of the value.
        path: Path,
    },
    /// An entry more in a list, such as a widget.
    Insert {
        /// The node.
        node: String,
        /// The list.
        list: Path,
        /// The number that it gets; the list's length for the end.
        place: usize,
        /// The entry.
        entry: ParameterValue,
    },
    /// A copy of an entry, after it.
    Duplicate {
        /// The node.
        node: String,
        /// The list.
        list: Path,
        /// The entry.
        place: usize,
    },
    /// An entry of a list gets another number.
    MoveEntry {
        /// The node.
        node: String,
        /// The list.
        list: Path,
        /// Its number.
        from: usize,
        /// The number that it gets.
        to: usize,
    },
    /// A wire: in place of what feeds the input, or beside that.
    Connect {
        /// The node that is fed.
        node: String,
        /// Its input.
        port: String,
        /// Source: `node` or `node.port`.
        source: String,
        /// True if other wires to the input stay.
        beside: bool,
    },
    /// A wire less.
    Disconnect {
        /// The node that was fed.
        node: String,
        /// Its input.
        port: String,
        /// The wire, as the file says it; `None`: all of the input.
        source: Option<String>,
    },
    /// Nodes more, as TOML text, after the others; see [`Document::paste`](crate::Document::paste).
    AddLines(String),
    /// Other places in the graph view.
    MoveNodes(Vec<(String, [f64; 2])>),
    /// A node shows its head alone, or all.
    Fold {
        /// The node.
        node: String,
        /// True if it is folded.
        folded: bool,
    },
    /// Words that stand with a node in the graph view; none takes them away.
    Remark {
        /// The node.
        node: String,
        /// The words.
        text: Option<String>,
    },
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
