//! voltet-document: a pipeline file as the document of an editor. Knows no window.
//!
//! The document **is** the text of the file. An [`Edit`] replaces the few bytes that it is about, so comments, order, spaces and
//! line ends stay; what was replaced is kept, so undoing gives every byte back. What the text states is read from it again
//! after each change, by the same reader that runs use.
//!
//! | file | what |
//! | --- | --- |
//! | [`document`](Document) | the text, what it states, its history |
//! | `file`, [`recovery`](Recovery) | opening, saving whole, changes by others, another folder; work that outlives a crash |
//! | [`edit`](Edit), `apply` | what can be done, as changes of the text |
//! | `text` | a TOML text changed where asked, whatever forms it is written in |
//! | [`history`](History) | steps from one text to another |
//! | [`faults`](Diagnostic) | every mistake, at its node, parameter or input |
//! | [`fits`](Fitting) | node types by kind and words, what can be joined with what |
//! | `clipboard`, [`arrange`] | nodes copied, pasted, duplicated; brought in line and in layers |
//! | [`panel`] | the parameters of a node as rows: values, controls, what is typed |
//! | [`view`](View) | what only the editor knows: the table `[editor]` |

mod apply;
pub mod arrange;
mod clipboard;
mod document;
mod edit;
mod faults;
mod file;
mod fits;
mod history;
pub mod links;
pub mod panel;
mod path;
mod recovery;
mod text;
mod view;

pub use document::Document;
pub use edit::Edit;
pub use faults::{Diagnostic, FaultTarget};
pub use file::stamp;
pub use fits::{Fitting, Group, giving, search, taking};
pub use history::{Gesture, History};
pub use path::{Path, Step};
pub use recovery::{Autosave, OrphanedDraft, Recovery};
pub use view::{Frame, NodeView, Note, View};
