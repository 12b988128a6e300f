//! What stands behind the nodes: a grid, frames with their titles, and notes.

use super::GraphView;
use crate::actions::Actions;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{self, Color32, Rect, Rounding, Sense, Stroke, Ui, Vec2, vec2};
use voltet_document::Edit;

impl GraphView {
    pub(super) fn grid(&self, ui: &Ui, rect: Rect) {
        let step = 40.0 * self.zoom * if self.zoom < 0.5 { 4.0 } else { 1.0 };
        let color = if ui.visuals().dark_mode { Color32::from_gray(30) } else { Color32::from_gray(216) };
        let stroke = Stroke::new(1.0, color);
        let first = |pan: f32| pan.rem_euclid(step);
        let mut x = rect.left() + first(self.pan.x);
        while x < rect.right() {
            ui.painter().vline(x, rect.y_range(), stroke);
            x += step;
        }
        let mut y = rect.top() + first(self.pan.y);
        while y < rect.bottom() {
            ui.painter().hline(rect.x_range(), y, stroke);
            y += step;
        }
    }

    /// What stands behind the nodes: frames with their titles, and notes.
    pub(super) fn frames_and_notes(&self, ui: &mut Ui, rect: Rect, scene: &Scene, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        let to_window = self.to_window(rect);
        let size = egui::FontId::proportional(12.0 * self.zoom);
        for (i, frame) in scene.document.view().frames.iter().enumerate() {
            let low = to_window(frame.at);
            let place =
                Rect::from_min_size(low, self.zoom * vec2(frame.size[0] as f32, frame.size[1] as f32));
            let color = frame.color.map_or(theme::weak(dark), |c| {
                Color32::from_rgb((c[0] * 255.0) as u8, (c[1] * 255.0) as u8, (c[2] * 255.0) as u8)
            });
            ui.painter().rect(
                place,
                Rounding::same(6.0),
                color.gamma_multiply(0.12),
                Stroke::new(1.0, color),
            );
            ui.painter().text(
                low + vec2(8.0, 4.0) * self.zoom,
                egui::Align2::LEFT_TOP,
                &frame.title,
                size.clone(),
                theme::weak(dark),
            );
            let title = Rect::from_min_size(low, vec2(place.width(), 22.0 * self.zoom));
            let response = ui.interact(title, ui.id().with(("frame", i)), Sense::click_and_drag());
            response.context_menu(|ui| {
                let mut title = frame.title.clone();
                if ui.text_edit_singleline(&mut title).changed() {
                    actions.edit(Edit::PutFrame(i, voltet_document::Frame { title, ..frame.clone() }));
                }
                if ui.button("Remove the frame").clicked() {
                    actions.edit(Edit::RemoveFrame(i));
                    ui.close_menu();
                }
            });
        }
        for (i, note) in scene.document.view().notes.iter().enumerate() {
            let low = to_window(note.at);
            let galley =
                ui.painter().layout(note.text.clone(), size.clone(), theme::weak(dark), 220.0 * self.zoom);
            let place = Rect::from_min_size(low, galley.size()).expand(5.0 * self.zoom);
            let paper = if dark { Color32::from_rgb(60, 56, 40) } else { Color32::from_rgb(255, 250, 215) };
            ui.painter().rect_filled(place, 3.0, paper);
            ui.painter().galley(low, galley, theme::weak(dark));
            let response = ui.interact(place, ui.id().with(("note", i)), Sense::click_and_drag());
            if response.dragged() && response.drag_delta() != Vec2::ZERO {
                let by = response.drag_delta() / self.zoom;
                let at = [note.at[0] + f64::from(by.x), note.at[1] + f64::from(by.y)];
                actions.edit(Edit::PutNote(i, voltet_document::Note { at, ..note.clone() }));
            }
            response.context_menu(|ui| {
                let mut text = note.text.clone();
                if ui.text_edit_multiline(&mut text).changed() {
                    actions.edit(Edit::PutNote(i, voltet_document::Note { text, ..note.clone() }));
                }
                if ui.button("Remove the note").clicked() {
                    actions.edit(Edit::RemoveNote(i));
                    ui.close_menu();
                }
            });
        }
    }
}
