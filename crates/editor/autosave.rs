//! Unsaved work kept while it is unsaved, and offered at the next start.

use crate::editor::Editor;
use crate::recover::Recover;
use eframe::egui::{Align2, Context, Window};
use std::time::{Duration, Instant};
use voltet_document::Recovery;

/// Shortest interval between two copies of unsaved work.
const BETWEEN: Duration = Duration::from_secs(2);

impl Editor {
    /// Keeps work from now on in a place.
    pub(crate) fn keep_in(&mut self, place: Recovery) {
        self.recover = Recover::at(place);
    }

    /// Keeps the work as it is now; true where there is more to keep a little later.
    pub(crate) fn keep(&mut self, ctx: &Context) {
        let Some(place) = &self.recover.place else { return };
        if self.document.is_saved() {
            // What is saved is not offered again, however the window ends.
            if let (Some(_), Some(keeper)) = (self.recover.kept.take(), &mut self.recover.keeper) {
                let _ = keeper.give_up();
            }
            return;
        }
        if let Some(kept) = self.recover.kept.filter(|kept| kept.elapsed() < BETWEEN) {
            ctx.request_repaint_after(BETWEEN - kept.elapsed().min(BETWEEN));
            return;
        }
        if self.recover.keeper.is_none() {
            // Without a folder to write to, work is not kept; saving says why.
            self.recover.keeper = place.keeper(&self.document).ok();
        }
        let document = &self.document;
        let outcome = self.recover.keeper.as_mut().map(|keeper| keeper.follow(document));
        self.recover.kept = Some(Instant::now());
        if let Some(Err(error)) = outcome {
            self.complain(&error);
        }
    }

    /// Offers what was left behind.
    pub(crate) fn offer_left_behind(&mut self, ctx: &Context) {
        let Some(left) = self.recover.left.first() else { return };
        let name = left.path.as_ref().map_or("a new pipeline".into(), |path| path.display().to_string());
        let mut answer = None;
        Window::new("Work that was not saved")
            .collapsible(false)
            .resizable(false)
            .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
            .show(ctx, |ui| {
                ui.label(format!("A window ended without saving what was done in {name}."));
                ui.add_space(6.0);
                ui.horizontal(|ui| {
                    for (text, choice) in [("Open it", 0), ("Throw it away", 1), ("Later", 2)] {
                        if ui.button(text).clicked() {
                            answer = Some(choice);
                        }
                    }
                });
            });
        let Some(answer) = answer else { return };
        let left = self.recover.left.remove(0);
        match answer {
            0 => {
                let document = left.document();
                self.take(document);
                // Kept anew under this window's name before it goes.
                self.recover.kept = None;
                self.keep(ctx);
                let _ = left.give_up();
            }
            1 => {
                let _ = left.give_up();
            }
            _ => self.recover.left.clear(),
        }
    }
}
