//! voltet-document: a pipeline file as the document of an editor. Knows no window.
//!
//! The document **is** the text of the file. An [`Edit`] replaces the few bytes that it is about, so comments, order, spaces and
//! line ends stay; what was replaced is kept, so undoing gives every byte back. What the text states is read from it again
//! after each change, by the same reader that runs use.
//!
//! | file | what |
//! | --- | --- |
//! | [`document`](Document) | the text, what it states, its history, its file |
//! | [`edit`](Edit) | what can be done |
//! | `file` | opening, saving whole, noticing changes by others |
//! | `carry_out` | edits of nodes and wires as changes of the text |
//! | `text` | changes of a TOML text, whatever forms it is written in |
//! | [`delta`](Delta), [`history`](History) | how one text becomes another, and steps of it |
//! | [`view`](View) | what only the editor knows: the table `[editor]` |

mod arrange;
mod carry_out;
mod delta;
mod document;
mod edit;
mod file;
mod history;
pub mod links;
mod path;
mod text;
mod view;

pub use delta::{Delta, Hunk};
pub use document::Document;
pub use edit::Edit;
pub use history::{Gesture, History};
pub use path::{Path, Step};
pub use view::{Frame, NodeView, Note, View};
