//! voltet-editor: the node editor, a window over the pipeline file. The only crate that names egui.
//!
//! | module | responsibility |
//! | --- | --- |
//! | [`worker`] | drawing and queries, on a thread of its own |
//! | [`view`] | movements of the camera |
//! | `editor`, `frame`, `scene` | one frame: its state, layout, read-only view |
//! | `actions`, `apply_actions` | requests of the window's parts, and their application |
//! | `input`, `keys` | steps of the undo history; queued input events; keys and menus |
//! | `files`, `file_dialog`, `saving` | file names and changes on disk; choosing; opening, saving, recovery |
//! | `requests` | requests to the worker, and handling of its answers |
//! | `graph` | nodes and wires, by `egui_node_graph2` behind a small interface |
//! | `picture`, `parameters`, `costs` | the picture, the panel of the selected node, times and errors |
//! | `arrays` | the arrays of data files |
//! | `jobs` | work on threads of their own: runs, studies, pipelines made for data |
//! | `section`, `study` | a plane through the data; error against time |
//! | `transfer` | the transfer function over the histogram of s and g |
//! | `window` | eframe's window |

mod actions;
mod apply_actions;
mod arrays;
mod costs;
mod editor;
mod file_dialog;
mod files;
mod frame;
mod graph;
mod input;
mod jobs;
mod keys;
mod parameters;
mod picture;
mod requests;
mod saving;
mod scene;
mod section;
mod study;
mod theme;
mod transfer;
#[cfg(test)]
mod ui_tests;
pub mod view;
mod window;
pub mod worker;

pub use editor::{Editor, Start};
pub use study::{Studied, StudiedRow, Study, StudyRequest};
pub use window::run;
