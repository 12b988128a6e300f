//! The keys of what lies over the panes, and of what has the focus where nothing else has: Escape, Tab, and keys that scroll a sheet.

use crate::editor::Editor;
use crate::focus::Sheet;
use crate::scene::TimeMove;
use crate::theme;
use eframe::egui::{Context, FocusDirection, Id, Key, Modifiers, Popup};

impl Editor {
    /// Closes what lies above the rest, when Escape is pressed and nothing else has a use for it: a sheet, else what plays, what a hand
    /// does in the picture, the comparison, or the strip of frames.
    pub(crate) fn close_uppermost(&mut self, ctx: &Context) {
        let is_asking = self.asks() || self.file_dialog.is_some();
        let is_taken =
            self.was_typing || is_asking || Popup::is_any_open(ctx) || self.panels.graph.is_choosing();
        if is_taken || !ctx.input(|input| input.key_pressed(Key::Escape)) {
            return;
        }
        if self.close_sheet() || self.leave_mode() {
            ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
        }
    }

    fn close_sheet(&mut self) -> bool {
        let panels = &mut self.panels;
        let sheets = [
            &mut panels.help,
            &mut panels.time.film.is_open,
            &mut panels.study.open,
            &mut panels.costs,
            &mut panels.section.open,
        ];
        let open = sheets.into_iter().find(|open| **open);
        panels.text.close() || open.map(|open| *open = false).is_some()
    }

    /// Leaves a mode; false if there was none, or Escape leads from the parameters or the keys of widgets back.
    fn leave_mode(&mut self) -> bool {
        if self.panels.time.playing.is_some() {
            self.move_time(TimeMove::Play);
            return true;
        }
        if self.panels.parameters.has_focus || self.panels.transfer.by_keyboard {
            return false;
        }
        let has_bare_strip = self.panels.time.is_open && !self.panels.time.moves(self.camera());
        if self.panels.picture.leave_mode() {
            return true;
        }
        self.panels.time.is_open &= !has_bare_strip;
        has_bare_strip
    }

    /// Gives the keys of a frame to the sheet that has them, else to what was used last; help goes where something opens over it.
    pub(crate) fn follow_focus(&mut self, ctx: &Context) {
        let panels = &self.panels;
        let sheets = [
            (self.file_dialog.is_some(), Sheet::FILE.id()),
            (panels.text.is_open, Sheet::TEXT.id()),
            (panels.help, Sheet::KEYS.id()),
            (panels.time.film.is_open, Sheet::FILM.id()),
            (panels.study.open, Sheet::STUDY.id()),
            (panels.costs, Sheet::COSTS.id()),
            (panels.section.open, Sheet::SECTION.id()),
        ];
        let mut over: Vec<Id> =
            sheets.into_iter().filter(|(is_open, _)| *is_open).map(|(_, id)| id).collect();
        self.sheet_keys.follow(ctx, over.clone());
        let others =
            [(self.asks(), "question"), (panels.graph.is_choosing() || panels.graph.opens_menu, "menu")];
        over.extend(others.into_iter().filter(|(is_open, _)| *is_open).map(|(_, name)| Id::new(name)));
        if over.iter().any(|id| !self.over.contains(id)) {
            theme::hide_help(ctx);
        }
        self.over = over;
        if self.asks() || Popup::is_any_open(ctx) || self.panels.graph.is_choosing() {
            return;
        }
        if self.sheet_keys.sheet.is_some() {
            // In the text of the pipeline Tab is a character.
            if !(self.panels.text.is_open && ctx.text_edit_focused()) {
                self.sheet_keys.take_tab(ctx);
            }
            if self.file_dialog.is_none() {
                self.sheet_keys.take_scroll(ctx);
            }
        } else {
            self.begin_tab(ctx);
        }
    }

    /// Has Tab go on from the selected node, or from the widget that was selected after it, where nothing has the focus.
    fn begin_tab(&mut self, ctx: &Context) {
        let is_pressed = ctx
            .input(|input| input.key_pressed(Key::Tab) && !input.modifiers.command && !input.modifiers.alt);
        let is_bare = ctx.memory(|memory| memory.focused().is_none());
        if !is_pressed || !is_bare || self.document.pipeline().nodes.is_empty() {
            return;
        }
        // egui would begin at the first menu.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        if self.panels.transfer.is_last() {
            self.panels.transfer.begins = true;
        } else {
            self.panels.graph.takes_tab = true;
        }
    }
}
