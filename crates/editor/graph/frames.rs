//! Background of the graph: a grid, frames with their titles, and notes; in a hand these are moved (a frame with all that it holds),
//! resized, written on, coloured, taken away.

use super::{Dragged, GraphView, Writing};
use crate::scene::Scene;
use crate::theme::{self, Help};
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{
    Align2, Area, Color32, CursorIcon, FontId, Galley, Key, Order, Rect, Response, Sense, Stroke, StrokeKind,
    TextEdit, Ui, Vec2, vec2,
};
use std::sync::Arc;
use voltet_core::arithmetic::decimal;
use voltet_document::{Annotation, AnnotationId, Edit};

/// Height of a frame's title and width of a note, points at the usual scale.
const TITLE: f32 = 22.0;
const NOTE: f32 = 220.0;

/// Least height of a title in the window, points: a hand must find it.
const MIN_TITLE_HEIGHT: f32 = 12.0;

impl GraphView {
    pub(super) fn grid(&self, ui: &Ui) {
        let step = 40.0 * self.view.zoom * if self.view.zoom < 0.5 { 4.0 } else { 1.0 };
        let color = if ui.visuals().dark_mode { Color32::from_gray(30) } else { Color32::from_gray(216) };
        let stroke = Stroke::new(1.0, color);
        let lines = |pan: f32, length: f32| {
            (0..).map(move |i| pan.rem_euclid(step) + i as f32 * step).take_while(move |x| *x < length)
        };
        for x in lines(self.view.pan.x, self.view.clip_rect.width()) {
            ui.painter().vline(self.view.clip_rect.left() + x, self.view.clip_rect.y_range(), stroke);
        }
        for y in lines(self.view.pan.y, self.view.clip_rect.height()) {
            ui.painter().hline(self.view.clip_rect.x_range(), self.view.clip_rect.top() + y, stroke);
        }
    }

    pub(super) fn frames_and_notes(&self, ui: &Ui, scene: &Scene) {
        let dark = ui.visuals().dark_mode;
        for frame in &scene.document.view().frames {
            let place = self.frame_place(frame);
            let color = frame.color.map_or(theme::weak(dark), of_channels);
            let (fill, stroke) = (color.gamma_multiply(0.12), Stroke::new(1.0, color));
            ui.painter().rect(place, 6, fill, stroke, StrokeKind::Middle);
            let corner = place.min + vec2(8.0, 4.0) * self.view.zoom;
            let clipped = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
            let font = FontId::proportional(self.letters());
            clipped.text(corner, Align2::LEFT_TOP, &frame.text, font, theme::weak(dark));
        }
        let paper = if dark { Color32::from_rgb(60, 56, 40) } else { Color32::from_rgb(255, 250, 215) };
        for note in &scene.document.view().notes {
            let (place, galley) = self.note_place(ui, note);
            ui.painter().rect_filled(place, 3.0, paper);
            ui.painter().galley(self.to_window()(note.position), galley, theme::weak(dark));
        }
    }

    fn letters(&self) -> f32 {
        (12.0 * self.view.zoom).max(8.0)
    }

    fn frame_place(&self, frame: &Annotation) -> Rect {
        let [width, height] = frame.size.unwrap_or_default().map(|x| x as f32);
        let size = self.view.zoom * vec2(width, height);
        Rect::from_min_size(self.to_window()(frame.position), size)
    }

    fn title_place(&self, frame: &Annotation) -> Rect {
        let place = self.frame_place(frame);
        let height = (TITLE * self.view.zoom).max(MIN_TITLE_HEIGHT).min(place.height());
        Rect::from_min_size(place.min, vec2(place.width(), height))
    }

    fn note_place(&self, ui: &Ui, note: &Annotation) -> (Rect, Arc<Galley>) {
        let (font, color) = (FontId::proportional(self.letters()), theme::weak(ui.visuals().dark_mode));
        let galley = ui.painter().layout(note.text.clone(), font, color, NOTE * self.view.zoom.max(0.6));
        // An empty note can be found, too.
        let size = galley.size().max(Vec2::splat(self.letters()));
        (Rect::from_min_size(self.to_window()(note.position), size).expand(5.0 * self.view.zoom), galley)
    }
}

/// Red, green and blue, 0 to 1.
fn of_channels(color: [f64; 3]) -> Color32 {
    let [r, g, b] = color.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// Side of the corner that a frame is resized by, and its least width and height, points.
const CORNER: f32 = 14.0;
const MIN_SIZE: f64 = 60.0;

impl GraphView {
    pub fn write_on(&mut self, thing: AnnotationId, text: &str) {
        self.writing = Some(Writing { thing, text: text.to_string(), is_new: true });
    }

    /// The title of a frame, or a note, in the window.
    fn words_place(&self, ui: &Ui, thing: &Annotation) -> Rect {
        if thing.size.is_some() { self.title_place(thing) } else { self.note_place(ui, thing).0 }
    }

    /// Handles drags and clicks of frames and notes; true if the pointer is at one. Called after the nodes, which lie
    /// above and take precedence.
    pub(super) fn hold_ground(&mut self, ui: &mut Ui, scene: &Scene) -> bool {
        let mut is_at_one = false;
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let is_covered = pointer.is_some_and(|at| self.places.node_at(at).is_some()) || self.wire.is_some();
        let sense = if is_covered { Sense::hover() } else { Sense::click_and_drag() };
        for (id, thing) in scene.document.view().annotations() {
            let place = self.words_place(ui, thing).intersect(self.view.clip_rect);
            if place.is_positive() {
                let response = ui.interact(place, ui.id().with(id), sense);
                is_at_one |= response.contains_pointer();
                self.hold_thing(ui, scene, id, thing, &response);
            }
            let corner = self.frame_place(thing).max;
            let corner =
                Rect::from_min_max(corner - Vec2::splat(CORNER), corner).intersect(self.view.clip_rect);
            if thing.size.is_some() && corner.is_positive() {
                let response = ui.interact(corner, ui.id().with(("corner", id)), sense);
                if response.drag_started() {
                    let things = vec![(id, thing.clone())];
                    self.dragged = Some(Dragged { things, resizes: true, ..Dragged::default() });
                }
                if response.dragged() {
                    self.carry(scene, response.drag_delta());
                }
                response.on_hover_cursor(CursorIcon::ResizeNwSe);
            }
        }
        self.write(ui, scene);
        is_at_one
    }

    fn hold_thing(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        id: AnnotationId,
        thing: &Annotation,
        response: &Response,
    ) {
        // The middle button and Ctrl move the view.
        let moves_view = ui.input(|input| input.modifiers.command || input.pointer.middle_down());
        if response.drag_started() && !moves_view {
            self.dragged = Some(self.held_by(scene, id, thing));
        }
        if response.dragged() {
            self.carry(scene, response.drag_delta());
        }
        if response.double_clicked() {
            self.write_on(id, &thing.text);
        }
        response.context_menu(|ui| {
            if ui.button(if thing.size.is_some() { "Rename" } else { "Write" }).clicked() {
                self.write_on(id, &thing.text);
                ui.close();
            }
            if thing.size.is_some() {
                let mut color = thing.color.unwrap_or([0.5; 3]).map(|x| x as f32);
                if ui.color_edit_button_rgb(&mut color).help("colour").changed() {
                    // A screen has 256 levels of each.
                    let color = Some(color.map(|x| decimal(f64::from(x), 1e-3)));
                    scene.actions.edit(Edit::Annotate(id, Annotation { color, ..thing.clone() }));
                }
            }
            if ui.button("Remove").clicked() {
                scene.actions.edit(Edit::RemoveAnnotation(id));
                ui.close();
            }
        });
    }

    /// A note, or a frame with what stands wholly in it.
    fn held_by(&self, scene: &Scene, id: AnnotationId, thing: &Annotation) -> Dragged {
        let holds = |at: [f64; 2], size: [f64; 2]| {
            let own = thing.size.unwrap_or([f64::NEG_INFINITY; 2]);
            (0..2).all(|i| at[i] >= thing.position[i] && at[i] + size[i] <= thing.position[i] + own[i])
        };
        let nodes = scene.document.pipeline().nodes.iter();
        let nodes = nodes.map(|node| (node.name.clone(), scene.document.position(&node.name)));
        let things =
            scene.document.view().annotations().filter(|(known, other)| {
                *known == id || holds(other.position, other.size.unwrap_or_default())
            });
        Dragged {
            nodes: nodes.filter(|(name, at)| holds(*at, self.places.size_of(name))).collect(),
            things: things.map(|(id, thing)| (id, thing.clone())).collect(),
            ..Dragged::default()
        }
    }

    /// Moves what is dragged by so much of the window.
    pub(super) fn carry(&mut self, scene: &Scene, delta: Vec2) {
        let Some(carried) = self.dragged.as_mut().filter(|_| delta != Vec2::ZERO) else { return };
        carried.way += delta / self.view.zoom;
        let by = [f64::from(carried.way.x), f64::from(carried.way.y)];
        let moved = |at: [f64; 2]| [at[0] + by[0], at[1] + by[1]];
        let thing = |(id, thing): &(AnnotationId, Annotation)| {
            let mut thing = thing.clone();
            match thing.size.filter(|_| carried.resizes) {
                Some(size) => thing.size = Some(moved(size).map(|side| side.max(MIN_SIZE))),
                None => thing.position = moved(thing.position),
            }
            Edit::Annotate(*id, thing)
        };
        let mut edits: Vec<Edit> = carried.things.iter().map(thing).collect();
        if !carried.nodes.is_empty() {
            let nodes = carried.nodes.iter().map(|(name, at)| (name.clone(), moved(*at)));
            edits.push(Edit::MoveNodes(nodes.collect()));
        }
        let label = match carried.things.iter().any(|(_, thing)| thing.size.is_some()) {
            _ if carried.resizes => "resize a frame".into(),
            true => "move a frame".into(),
            false if carried.things.is_empty() => edits[0].label(),
            false => "move a note".into(),
        };
        scene.actions.edits(label, edits);
    }

    fn write(&mut self, ui: &Ui, scene: &Scene) {
        let Some(mut writing) = self.writing.take() else { return };
        let mut things = scene.document.view().annotations();
        let Some((id, thing)) = things.find(|(id, _)| *id == writing.thing) else { return };
        let at = self
            .words_place(ui, thing)
            .min
            .clamp(self.view.clip_rect.min, self.view.clip_rect.max - vec2(230.0, 60.0));
        let area = Area::new(ui.id().with("writing")).order(Order::Foreground).fixed_pos(at);
        let response = area.show(ui.ctx(), |ui| {
            let field = match id {
                AnnotationId::Frame(_) => TextEdit::singleline(&mut writing.text),
                AnnotationId::Note(_) => TextEdit::multiline(&mut writing.text).desired_rows(3),
            };
            let mut shown = field.desired_width(220.0).show(ui);
            if std::mem::take(&mut writing.is_new) {
                shown.response.request_focus();
                let end = CCursor::new(writing.text.chars().count());
                shown.state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(0), end)));
                shown.state.store(ui.ctx(), shown.response.id);
            }
            shown.response
        });
        if !response.inner.lost_focus() {
            self.writing = Some(writing);
        } else if !ui.input(|input| input.key_pressed(Key::Escape)) {
            scene.actions.edit(Edit::Annotate(id, Annotation { text: writing.text, ..thing.clone() }));
        }
    }
}
