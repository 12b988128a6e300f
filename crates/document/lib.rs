//! voltet-document: a pipeline file as the document of an editor. Knows no window.
//!
//! The document **is** the text of the file. An [`Edit`] replaces the few bytes that it is about, so comments, order, spaces and
//! line ends stay; what was replaced is kept, so undoing gives every byte back. What the text states is read from it again
//! after each change, by the same reader that runs use.

pub mod arrange;
mod change;
mod document;
mod edit;
mod faults;
mod file;
pub mod links;
mod nodes;
pub mod panel;
mod path;
pub mod series;
mod text;
mod view;

pub use change::Change;
pub use document::{Document, Gesture, History};
pub use edit::Edit;
pub use faults::{Diagnostic, FaultTarget};
pub use file::{Autosave, OrphanedDraft, Recovery, stamp};
pub use nodes::{Fitting, Group, giving, search, taking};
pub use path::{Path, Step};
pub use series::Series;
pub use view::{Annotation, AnnotationId, NodeView, View};
