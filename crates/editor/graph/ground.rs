//! Background of the graph: a grid, frames with their titles, and notes.

use super::GraphView;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{Align2, Color32, FontId, Galley, Rect, Rounding, Stroke, Ui, Vec2, vec2};
use std::sync::Arc;
use voltet_document::{Frame, Note};

/// Height of a frame's title and width of a note, points at the usual scale.
const TITLE: f32 = 22.0;
const NOTE: f32 = 220.0;

/// Least height of a title in the window, points: a hand must find it.
const MIN_TITLE_HEIGHT: f32 = 12.0;

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

    pub(super) fn frames_and_notes(&self, ui: &Ui, rect: Rect, scene: &Scene) {
        let dark = ui.visuals().dark_mode;
        for frame in &scene.document.view().frames {
            let place = self.frame_place(rect, frame);
            let color = frame.color.map_or(theme::weak(dark), of_channels);
            let (fill, stroke) = (color.gamma_multiply(0.12), Stroke::new(1.0, color));
            ui.painter().rect(place, Rounding::same(6.0), fill, stroke);
            let corner = place.min + vec2(8.0, 4.0) * self.zoom;
            let clipped = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
            let font = FontId::proportional(self.letters());
            clipped.text(corner, Align2::LEFT_TOP, &frame.title, font, theme::weak(dark));
        }
        let paper = if dark { Color32::from_rgb(60, 56, 40) } else { Color32::from_rgb(255, 250, 215) };
        for note in &scene.document.view().notes {
            let (place, galley) = self.note_place(ui, rect, note);
            ui.painter().rect_filled(place, 3.0, paper);
            ui.painter().galley(self.to_window(rect)(note.position), galley, theme::weak(dark));
        }
    }

    /// Size of the letters of titles and notes.
    fn letters(&self) -> f32 {
        (12.0 * self.zoom).max(8.0)
    }

    /// Rectangle of a frame in the window.
    pub(super) fn frame_place(&self, rect: Rect, frame: &Frame) -> Rect {
        let size = self.zoom * vec2(frame.size[0] as f32, frame.size[1] as f32);
        Rect::from_min_size(self.to_window(rect)(frame.position), size)
    }

    /// Rectangle of a frame's title.
    pub(super) fn title_place(&self, rect: Rect, frame: &Frame) -> Rect {
        let place = self.frame_place(rect, frame);
        let height = (TITLE * self.zoom).max(MIN_TITLE_HEIGHT).min(place.height());
        Rect::from_min_size(place.min, vec2(place.width(), height))
    }

    /// Rectangle of a note, with its text.
    pub(super) fn note_place(&self, ui: &Ui, rect: Rect, note: &Note) -> (Rect, Arc<Galley>) {
        let (font, color) = (FontId::proportional(self.letters()), theme::weak(ui.visuals().dark_mode));
        let galley = ui.painter().layout(note.text.clone(), font, color, NOTE * self.zoom.max(0.6));
        // An empty note can be found, too.
        let size = galley.size().max(Vec2::splat(self.letters()));
        (Rect::from_min_size(self.to_window(rect)(note.position), size).expand(5.0 * self.zoom), galley)
    }
}

/// Red, green and blue, 0 to 1.
fn of_channels(color: [f64; 3]) -> Color32 {
    let [r, g, b] = color.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8);
    Color32::from_rgb(r, g, b)
}
