//! Unsaved work outlives a crash: it is kept while it is unsaved, and what was left behind is offered at the next start.

use std::time::Instant;
use voltet_document::{Autosave, OrphanedDraft, Recovery};

/// Copy of this window's unsaved work, and copies left by crashed windows.
#[derive(Default)]
pub(crate) struct Recover {
    pub place: Option<Recovery>,
    pub keeper: Option<Autosave>,
    pub left: Vec<OrphanedDraft>,
    pub kept: Option<Instant>,
}

impl Recover {
    /// Keeps work in a place, and looks what was left behind there.
    pub fn at(place: Recovery) -> Recover {
        Recover { left: place.left_behind(), place: Some(place), ..Recover::default() }
    }

    /// Another document is worked on: what was kept of the former one is not wanted any more.
    pub fn forget(&mut self) {
        if let Some(mut keeper) = self.keeper.take() {
            let _ = keeper.give_up();
        }
        self.kept = None;
    }
}
