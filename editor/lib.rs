//! voltet-editor: the node editor, a window over the pipeline file. The only crate that names egui.
//!
//! | room | what |
//! | --- | --- |
//! | [`worker`] | draws the picture at a node, on a thread of its own |
//! | [`view`] | movements of the camera |
//! | `editor`, `layout`, `actions`, `keys` | one frame: what is shown where, and what is done then |
//! | `graph` | nodes and wires, by `egui_node_graph2` behind a small interface |
//! | `picture`, `parameters`, `files` | the picture, the panel of the selected node, asking for files |
//! | `transfer` | the transfer function over the histogram of s and g |
//! | `window` | eframe's window around it |

mod actions;
#[cfg(test)]
mod by_hand;
mod clipboard;
mod editor;
mod files;
mod graph;
mod keys;
mod layout;
mod parameters;
mod picture;
mod scene;
mod theme;
mod transfer;
pub mod view;
mod window;
pub mod worker;

pub use editor::{Editor, Start};
pub use window::run;
