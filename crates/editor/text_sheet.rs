//! The text of a pipeline file in which something is wrong beside its nodes: what it is, and a sheet in which it is mended.

use crate::focus::Sheet;
use crate::scene::{Action, FilePurpose, Scene};
use crate::theme::{self, Help};
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{Context, Frame, Id, Rect, RichText, ScrollArea, TextEdit, Ui, UiBuilder, vec2};
use voltet_core::Error;
use voltet_document::Edit;

/// The sheet, while it is open.
#[derive(Default)]
pub(crate) struct TextSheet {
    pub is_open: bool,
    /// The text as it is typed; it stays while the sheet is closed.
    typed: String,
    /// The text of the document that it began with.
    begun: String,
    /// True once something was wrong beside the nodes while it was open.
    is_wrong: bool,
    /// The line to go to, from 1.
    line: Option<usize>,
}

fn line_of(fault: &Error) -> Option<usize> {
    fault.location.line_column.map(|(line, _)| line)
}

impl TextSheet {
    /// Says above the graph what is wrong with the text, and offers to mend it. What can be read of the file is shown below.
    pub fn offer(&mut self, ui: &mut Ui, place: Rect, scene: &Scene) {
        let dark = ui.visuals().dark_mode;
        let rect = Rect::from_min_size(place.min + vec2(12.0, 8.0), vec2(place.width() - 24.0, 120.0));
        ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
            Frame::NONE.fill(ui.visuals().window_fill).inner_margin(8.0).corner_radius(4).show(ui, |ui| {
                if let Some(fault) = scene.faults.first() {
                    ui.label(RichText::new(fault.to_string()).color(theme::wrong(dark)));
                }
                ui.horizontal(|ui| {
                    let line = scene.faults.first().and_then(line_of);
                    let place = line.map_or(String::new(), |line| format!(" at line {line}"));
                    if ui.button(format!("Mend the text{place} …")).clicked() {
                        self.open_at(line);
                    }
                    if ui.button("Open another file …").clicked() {
                        let path = scene.document.path().map(ToOwned::to_owned);
                        scene.actions.push(Action::ChooseFile(FilePurpose::Open, path));
                    }
                });
                let text = "What another program mends and saves is offered here, too.";
                ui.label(RichText::new(text).color(theme::weak(dark)));
            });
        });
    }

    pub fn open_at(&mut self, line: Option<usize>) {
        (self.is_open, self.line) = (true, line);
    }

    /// Closes the sheet; true if it was open. What is typed stays.
    pub fn close(&mut self) -> bool {
        std::mem::take(&mut self.is_open)
    }

    /// Shows the sheet where it is open; it closes once a text that was wrong is right.
    pub fn show(&mut self, ctx: &Context, scene: &Scene) {
        let now = scene.document.text();
        // What a node has wrong is mended there.
        let is_of_node =
            |fault: &Error| fault.location.node.as_ref().is_some_and(|node| scene.entry(node).is_some());
        let is_right = scene.document.is_toml() && scene.faults.iter().all(is_of_node);
        self.is_wrong |= !is_right;
        if is_right && (self.is_wrong || !self.is_open) {
            *self = TextSheet::default();
        } else if self.typed == self.begun || self.typed == now {
            // Nothing is typed, or it is taken over.
            self.begin(now);
        }
        if !self.is_open {
            return;
        }
        let (mut is_open, mut is_taken) = (true, false);
        let room = ctx.content_rect().size();
        let window = Sheet::TEXT.window().open(&mut is_open);
        let window = window.default_size(vec2(0.6 * room.x, 0.6 * room.y)).max_size(0.9 * room);
        window.show(ctx, |ui| {
            ui.horizontal_wrapped(|ui| {
                is_taken = ui.button("Take over").help("a step that can be undone").clicked();
                let said = scene.faults.first().map(Error::to_string).unwrap_or_default();
                ui.label(RichText::new(said).color(theme::wrong(ui.visuals().dark_mode)));
            });
            if self.begun != now {
                ui.horizontal_wrapped(|ui| {
                    let help = "what is typed here is dropped";
                    if ui.button("Show the new text").help(help).clicked() {
                        self.begin(now);
                    }
                    ui.label(
                        "The pipeline has changed since: \"Take over\" replaces it by what is typed here.",
                    );
                });
            }
            ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| self.field(ui));
        });
        if is_taken {
            self.line = None;
            scene.actions.edits("mend the text", vec![Edit::Text(self.typed.clone())]);
        }
        self.is_open = is_open;
    }

    #[cfg(test)]
    pub fn typed(&self) -> &str {
        &self.typed
    }

    fn begin(&mut self, text: &str) {
        if self.begun != text || self.typed != text {
            (self.typed, self.begun) = (text.to_string(), text.to_string());
        }
    }

    fn field(&mut self, ui: &mut Ui) {
        let id = Id::new("text of the pipeline");
        let field = TextEdit::multiline(&mut self.typed).id(id).code_editor().desired_width(f32::INFINITY);
        let mut output = field.show(ui);
        ui.ctx().accesskit_node_builder(id, |node| node.set_label("text of the pipeline"));
        let Some(line) = self.line.take() else { return };
        let before: usize =
            self.typed.split_inclusive('\n').take(line - 1).map(|line| line.chars().count()).sum();
        let cursor = CCursor::new(before);
        output.state.cursor.set_char_range(Some(CCursorRange::one(cursor)));
        output.state.store(ui.ctx(), id);
        output.response.response.request_focus();
        let at = output.galley.pos_from_cursor(cursor).translate(output.galley_pos.to_vec2());
        ui.scroll_to_rect(at, Some(eframe::egui::Align::Center));
    }
}
