//! Requests of the window's parts, applied after all of them were shown, so that each shows the same document.

use crate::view::View;
use crate::worker::PixelProbe;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_document::Edit;
use voltet_document::arrange::Align;

/// Something that is to be done.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Edits of the document, one step in its history; while a mouse button is held, all of them are one.
    Edit(String, Vec<Edit>),
    /// These nodes are selected, and no others.
    Select(BTreeSet<String>),
    /// The picture of this node is shown.
    Show(String),
    /// Moves the camera.
    MoveCamera(View),
    /// The values at places of the picture are asked for (heights from its middle, to the right and up).
    Probe(Vec<[f64; 2]>),
    /// Values were found otherwise.
    PixelProbe(Arc<PixelProbe>),
    /// Centres the picture on the point at a position.
    Centre([f64; 2]),
    /// Estimates the error of the picture.
    Estimate,
    /// Runs a command.
    Do(Command),
    /// A line for the person.
    Say(String),
    /// A pipeline file is opened, or one that is made for a file that is none.
    Open(PathBuf),
    /// Like [`Action::Open`], after a question about unsaved work.
    Begin(PathBuf),
    /// The document is saved in this file.
    SaveAs(PathBuf),
    /// Opens a file dialog, at the path of a file if there is one.
    ChooseFile(FilePurpose, Option<PathBuf>),
    /// A parameter names this file.
    Name {
        /// The node.
        node: String,
        /// The parameter.
        path: voltet_document::Path,
        /// The file.
        file: PathBuf,
    },
}

/// Purposes of a file dialog.
#[derive(Debug, Clone, PartialEq)]
pub enum FilePurpose {
    /// Opens the file.
    Open,
    /// Saves the document in it.
    SaveAs,
    /// Names it in a parameter of a node.
    Parameter {
        /// The node.
        node: String,
        /// The parameter.
        path: voltet_document::Path,
        /// True if the node writes the file.
        writes: bool,
    },
}

/// Commands of keys and menus; the table of keys has words for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Command {
    New,
    Open,
    Save,
    SaveAs,
    ReadAgain,
    Run,
    Quit,
    Undo,
    Redo,
    Copy,
    Cut,
    Duplicate,
    Delete,
    SelectAll,
    Add,
    Tidy,
    Align(Align),
    Fold,
    Frame,
    Note,
    FitGraph,
    Home,
    /// Seen along an axis (0: x, 1: y, 2: z), from its positive or its negative side.
    Along(usize, bool),
    /// To the left, or to the right.
    Roll(bool),
    Theme,
    Costs,
    Widgets,
    Section,
    Study,
    Help,
}

/// Requests collected while a frame is shown.
#[derive(Debug, Default)]
pub struct Actions(pub Vec<Action>);

impl Actions {
    /// Asks for something.
    pub fn push(&mut self, action: Action) {
        self.0.push(action);
    }

    /// Asks for an edit.
    pub fn edit(&mut self, edit: Edit) {
        self.0.push(Action::Edit(edit.label(), vec![edit]));
    }

    /// Asks for several edits as one step.
    pub fn edits(&mut self, label: impl Into<String>, edits: Vec<Edit>) {
        if !edits.is_empty() {
            self.0.push(Action::Edit(label.into(), edits));
        }
    }

    /// Asks for what a key says.
    pub fn command(&mut self, command: Command) {
        self.0.push(Action::Do(command));
    }
}
