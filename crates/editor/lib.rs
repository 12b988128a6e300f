//! voltet-editor: the node editor, a window over the pipeline file. The only crate that names egui.

mod apply_actions;
mod blocks;
mod compare;
mod dropped;
mod editor;
mod expression;
mod eyes;
mod fields;
mod files;
mod film;
mod first_arrays;
mod graph;
mod handles;
mod hit_marks;
mod invitation;
mod jobs;
mod keys;
mod new_document;
mod outline;
mod panes;
mod parameters;
mod picture;
mod plugins;
mod probes;
mod requests;
mod scene;
mod section;
mod selection;
mod study;
mod templates;
mod text_sheet;
mod textures;
mod theme;
mod time_following;
mod time_strip;
mod transfer;
#[cfg(test)]
mod ui_tests;
pub mod view;
mod window;
pub mod worker;

pub use editor::{Editor, Start};
pub use film::{Film, FilmRequest};
pub use plugins::LoadPlugin;
pub use study::{Studied, StudiedRow, Study, StudyRequest};
pub use window::{Services, run};
