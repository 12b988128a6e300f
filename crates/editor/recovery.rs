//! Copies of unsaved work: kept while a hand works, and offered in the window after one that ended without a word.

use crate::editor::{Editor, Next};
use crate::files::{Recover, age};
use crate::theme::Help;
use eframe::egui::{Context, Panel, Ui};
use std::time::{Duration, Instant};
use voltet_document::Recovery;

/// Shortest interval between two copies of unsaved work while a hand goes on with one edit, and after one that failed.
const BETWEEN: Duration = Duration::from_secs(2);

impl Editor {
    pub(crate) fn keep_in(&mut self, place: Recovery) {
        self.recover = Recover::at(place);
    }

    /// Keeps the work as it is now, or wakes the window to do so a little later.
    pub(crate) fn keep(&mut self, ctx: &Context) {
        self.recover.look_again().into_iter().for_each(|left| ctx.request_repaint_after(left));
        let Some(place) = &self.recover.place else { return };
        if self.document.is_saved() {
            // What is saved is not offered again, however the window ends.
            if let (Some(_), Some(keeper)) = (self.recover.kept.take(), &mut self.recover.keeper) {
                let _ = keeper.give_up();
            }
            return;
        }
        let goes_on = self.gesture.is_some() || self.recover.failed.is_some();
        if let Some(kept) = self.recover.kept.filter(|kept| goes_on && kept.elapsed() < BETWEEN) {
            // The hand may rest without a frame that follows.
            ctx.request_repaint_after(BETWEEN.saturating_sub(kept.elapsed()));
            return;
        }
        if self.recover.keeper.is_none() {
            // Without a folder to write to, work is not kept; saving says why.
            self.recover.keeper = place.keeper(&self.document).ok();
        }
        let document = &self.document;
        let outcome = self.recover.keeper.as_mut().map(|keeper| keeper.follow(document));
        self.recover.kept = Some(Instant::now());
        let is_kept = matches!(outcome, Some(Ok(())));
        let failed = (!is_kept).then_some(document.revision());
        let is_said = self.recover.failed == failed;
        self.recover.failed = failed;
        // Once for each edit: other messages are read, too.
        outcome.filter(|_| !is_said).map(|outcome| self.check(outcome));
    }

    /// Offers work that was left behind, above what is shown, until it is answered.
    pub(crate) fn offer_left_behind(&mut self, ui: &mut Ui) {
        let Some(left) = self.recover.left.first() else { return };
        let name = left.path.as_ref().map_or("a new pipeline".into(), |path| path.display().to_string());
        let when = left.written.elapsed().map(|time| format!(", {}", age(time))).unwrap_or_default();
        let text = format!("A window ended without saving what was done in {name}{when}.");
        let answers = [
            ("Open it", "its changes as they were, not saved yet"),
            ("Discard it", "its changes are gone; its file stays as it is"),
            ("Later", "the next window offers it again"),
        ];
        let mut answer = None;
        Panel::top("left behind").show(ui, |ui| {
            // What was asked about stays until it is answered.
            if self.unsaved.is_some() {
                ui.disable();
            }
            ui.horizontal_wrapped(|ui| {
                for (text, help) in answers {
                    answer = ui.button(text).help(help).clicked().then_some(text).or(answer);
                }
                ui.label(text);
            });
        });
        match answer {
            Some("Open it") => self.unless_unsaved(ui.ctx(), Next::Recover),
            Some("Discard it") => _ = self.recover.left.remove(0).give_up(),
            Some(_) => (self.recover.left, self.recover.looks_again) = (Vec::new(), None),
            None => {}
        }
    }

    /// Takes up work that was left behind. It stays there, and is offered still, until this window keeps it.
    pub(crate) fn recover(&mut self, ctx: &Context) {
        if self.recover.left.is_empty() {
            return;
        }
        let left = self.recover.left.remove(0);
        self.take(left.document());
        // Kept anew under this window's name before it goes.
        self.recover.kept = None;
        self.keep(ctx);
        let Recover { keeper, kept, failed, .. } = &self.recover;
        if self.document.is_saved() || (keeper.is_some() && kept.is_some() && failed.is_none()) {
            let _ = left.give_up();
            return;
        }
        self.recover.left.insert(0, left);
        if self.message.is_none() {
            self.say("this work cannot be kept here before it is saved: the copy that was left behind stays");
        }
    }
}
