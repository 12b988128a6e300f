//! voltet-editor: the node editor, a window over the pipeline file. The only crate that names egui.
//!
//! | room | what |
//! | --- | --- |
//! | [`worker`] | draws the picture at a node, on a thread of its own |
//! | [`view`] | movements of the camera |
//! | `editor`, `frame`, `layout`, `menus`, `scene` | one frame: what is shown where, and what the parts of the window look at |
//! | `actions`, `carry_out`, `hand`, `keys` | what a hand asks for, what is done then, which edits are one step |
//! | `presses` | a button counts where it was pressed |
//! | `saving`, `recover`, `keeping` | saving; unsaved work outlives a crash |
//! | `wishes`, `lookups` | what the worker is asked for, and which answers are the newest |
//! | `graph` | nodes and wires, by `egui_node_graph2` behind a small interface |
//! | `picture`, `parameters`, `costs` | the picture, the panel of the selected node, times and errors |
//! | `arrays` | the arrays that the data have |
//! | `files`, `watch`, `asking`, `recent`, `begin` | what the names of files say, and whether files changed; asking for one; the last ones; what an empty window invites to |
//! | `run` | a whole run, which writes files |
//! | `section`, `study` | a plane through the data; error against time |
//! | `transfer` | the transfer function over the histogram of s and g |
//! | `window` | eframe's window around it |

mod actions;
mod arrays;
mod asking;
mod begin;
#[cfg(test)]
mod by_hand;
mod carry_out;
mod clipboard;
mod costs;
mod editor;
mod files;
mod frame;
mod graph;
mod hand;
mod keeping;
mod keys;
mod layout;
mod lookups;
mod menus;
mod parameters;
mod picture;
mod presses;
mod recent;
mod recover;
mod run;
mod saving;
mod scene;
mod section;
mod study;
mod theme;
mod transfer;
pub mod view;
mod watch;
mod window;
mod wishes;
pub mod worker;

pub use editor::{Editor, Start};
pub use study::{Studied, StudiedRow, Study, StudyOf};
pub use window::run;
