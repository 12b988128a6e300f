//! Ground of the graph: a grid, frames with their titles, and notes; moved (a frame with all that it holds), resized, written on,
//! coloured, taken away.

use super::places::{Places, Viewport};
use crate::actions::Actions;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{
    self, Align2, Area, Color32, CursorIcon, FontId, Galley, Key, Order, Pos2, Rect, Response, Rounding,
    Sense, Stroke, TextEdit, Ui, Vec2, vec2,
};
use std::sync::Arc;
use voltet_document::{Edit, Frame, Note};

/// Height of a frame's title and width of a note, points at the usual scale.
const TITLE: f32 = 22.0;
const NOTE: f32 = 220.0;

/// Least height of a title in the window, points: a hand must find it.
const MIN_TITLE_HEIGHT: f32 = 12.0;

/// Side of the corner that a frame is resized by, and its least width and height, points.
const CORNER: f32 = 14.0;
const MIN_SIZE: f64 = 60.0;

/// A frame or a note, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Annotation {
    Frame(usize),
    Note(usize),
}

/// Drag of an annotation: its earlier position, and the offset.
#[derive(Debug, Default)]
struct AnnotationDrag {
    frames: Vec<(usize, Frame)>,
    notes: Vec<(usize, Note)>,
    nodes: Vec<(String, [f64; 2])>,
    /// The frame changes its size instead.
    resizes: bool,
    way: Vec2,
}

/// Words that are being written.
#[derive(Debug)]
struct Writing {
    thing: Annotation,
    text: String,
    is_new: bool,
}

/// Frames and notes, as far as a hand is at them.
#[derive(Debug, Default)]
pub(super) struct Annotations {
    carried: Option<AnnotationDrag>,
    writing: Option<Writing>,
}

impl Annotations {
    /// Has the words of a frame or a note written.
    pub fn write_on(&mut self, thing: Annotation, text: &str) {
        self.writing = Some(Writing { thing, text: text.to_string(), is_new: true });
    }

    /// Handles drags and clicks of frames and notes; true if the pointer is at one. Called after the nodes, which lie
    /// above and take precedence.
    pub fn hold(
        &mut self,
        ui: &mut Ui,
        places: &Places,
        scene: &Scene,
        is_wiring: bool,
        actions: &mut Actions,
    ) -> bool {
        let (viewport, mut is_at_one) = (places.viewport, false);
        let rect = viewport.rect;
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let is_covered = pointer.is_some_and(|at| places.node_at(at).is_some()) || is_wiring;
        let sense = if is_covered { Sense::hover() } else { Sense::click_and_drag() };
        let view = scene.document.view();
        for (i, frame) in view.frames.iter().enumerate() {
            let title = title_place(viewport, frame).intersect(rect);
            if title.is_positive() {
                let response = ui.interact(title, ui.id().with(("frame", i)), sense);
                is_at_one |= response.contains_pointer();
                let thing = Annotation::Frame(i);
                self.hold_thing(ui, places, scene, thing, &response, actions);
            }
            let corner = frame_place(viewport, frame).max;
            let corner = Rect::from_min_max(corner - Vec2::splat(CORNER), corner).intersect(rect);
            if corner.is_positive() {
                let response = ui.interact(corner, ui.id().with(("corner", i)), sense);
                if response.drag_started() {
                    let frames = vec![(i, frame.clone())];
                    self.carried =
                        Some(AnnotationDrag { frames, resizes: true, ..AnnotationDrag::default() });
                }
                self.carry(&response, viewport.zoom, actions);
                response.on_hover_cursor(CursorIcon::ResizeNwSe);
            }
        }
        for (i, note) in view.notes.iter().enumerate() {
            let place = note_place(ui, viewport, note).0.intersect(rect);
            if place.is_positive() {
                let response = ui.interact(place, ui.id().with(("note", i)), sense);
                is_at_one |= response.contains_pointer();
                let thing = Annotation::Note(i);
                self.hold_thing(ui, places, scene, thing, &response, actions);
            }
        }
        self.write(ui, viewport, scene, actions);
        if !ui.input(|input| input.pointer.any_down()) {
            self.carried = None;
        }
        is_at_one
    }

    fn hold_thing(
        &mut self,
        ui: &Ui,
        places: &Places,
        scene: &Scene,
        thing: Annotation,
        response: &Response,
        actions: &mut Actions,
    ) {
        let view = scene.document.view();
        let words = match thing {
            Annotation::Frame(i) => view.frames[i].title.as_str(),
            Annotation::Note(i) => view.notes[i].text.as_str(),
        };
        // The middle button and Ctrl move the view.
        let moves_view = ui.input(|input| input.modifiers.command || input.pointer.middle_down());
        if response.drag_started() && !moves_view {
            self.carried = Some(match thing {
                Annotation::Frame(i) => held_by(places, scene, i),
                Annotation::Note(i) => {
                    AnnotationDrag { notes: vec![(i, view.notes[i].clone())], ..AnnotationDrag::default() }
                }
            });
        }
        self.carry(response, places.viewport.zoom, actions);
        if response.double_clicked() {
            self.write_on(thing, words);
        }
        response.context_menu(|ui| {
            let (rename, remove) = match thing {
                Annotation::Frame(i) => ("Rename", Edit::RemoveFrame(i)),
                Annotation::Note(i) => ("Write", Edit::RemoveNote(i)),
            };
            if ui.button(rename).clicked() {
                self.write_on(thing, words);
                ui.close_menu();
            }
            if let Annotation::Frame(i) = thing {
                let frame = &view.frames[i];
                let mut color = frame.color.unwrap_or([0.5; 3]).map(|x| x as f32);
                if ui.color_edit_button_rgb(&mut color).on_hover_text("colour").changed() {
                    let color = Some(color.map(f64::from));
                    actions.edit(Edit::PutFrame(i, Frame { color, ..frame.clone() }));
                }
            }
            if ui.button("Remove").clicked() {
                actions.edit(remove);
                ui.close_menu();
            }
        });
    }

    /// The edits of what is carried; all of a drag are one step.
    fn carry(&mut self, response: &Response, zoom: f32, actions: &mut Actions) {
        let Some(carried) = self.carried.as_mut().filter(|_| response.dragged()) else { return };
        if response.drag_delta() == Vec2::ZERO {
            return;
        }
        carried.way += response.drag_delta() / zoom;
        let by = [f64::from(carried.way.x), f64::from(carried.way.y)];
        let moved = |at: [f64; 2]| [at[0] + by[0], at[1] + by[1]];
        let frames = carried.frames.iter().map(|(i, frame)| {
            let (at, size) = match carried.resizes {
                true => (frame.position, moved(frame.size).map(|side| side.max(MIN_SIZE))),
                false => (moved(frame.position), frame.size),
            };
            Edit::PutFrame(*i, Frame { position: at, size, ..frame.clone() })
        });
        let notes = carried.notes.iter();
        let notes =
            notes.map(|(i, note)| Edit::PutNote(*i, Note { position: moved(note.position), ..note.clone() }));
        let mut edits: Vec<Edit> = frames.chain(notes).collect();
        if !carried.nodes.is_empty() {
            let nodes = carried.nodes.iter().map(|(name, at)| (name.clone(), moved(*at)));
            edits.push(Edit::MoveNodes(nodes.collect()));
        }
        let label = match (carried.resizes, carried.frames.is_empty()) {
            (true, _) => "resize a frame",
            (false, false) => "move a frame",
            (false, true) => "move a note",
        };
        actions.edits(label, edits);
    }

    /// The field that words are written in.
    fn write(&mut self, ui: &Ui, viewport: Viewport, scene: &Scene, actions: &mut Actions) {
        let Some(mut writing) = self.writing.take() else { return };
        let view = scene.document.view();
        let (at, edit): (Pos2, Box<dyn Fn(String) -> Edit>) = match writing.thing {
            Annotation::Frame(i) => {
                let Some(frame) = view.frames.get(i).cloned() else { return };
                let at = title_place(viewport, &frame).min;
                (at, Box::new(move |title| Edit::PutFrame(i, Frame { title, ..frame.clone() })))
            }
            Annotation::Note(i) => {
                let Some(note) = view.notes.get(i).cloned() else { return };
                let at = note_place(ui, viewport, &note).0.min;
                (at, Box::new(move |text| Edit::PutNote(i, Note { text, ..note.clone() })))
            }
        };
        let at = at.clamp(viewport.rect.min, viewport.rect.max - vec2(230.0, 60.0));
        let area = Area::new(ui.id().with("writing")).order(Order::Foreground).fixed_pos(at);
        let response = area.show(ui.ctx(), |ui| {
            let field = match writing.thing {
                Annotation::Frame(_) => TextEdit::singleline(&mut writing.text),
                Annotation::Note(_) => TextEdit::multiline(&mut writing.text).desired_rows(3),
            };
            let shown = field.desired_width(220.0).show(ui);
            let response = shown.response;
            if std::mem::take(&mut writing.is_new) {
                response.request_focus();
                let all = egui::text::CCursorRange::two(
                    egui::text::CCursor::new(0),
                    egui::text::CCursor::new(writing.text.chars().count()),
                );
                let mut state = shown.state;
                state.cursor.set_char_range(Some(all));
                state.store(ui.ctx(), response.id);
            }
            response
        });
        let response = response.inner;
        match response.lost_focus() {
            false => self.writing = Some(writing),
            true if ui.input(|input| input.key_pressed(Key::Escape)) => {}
            true => actions.edit(edit(writing.text)),
        }
    }
}

/// A frame with what stands wholly in it.
fn held_by(places: &Places, scene: &Scene, number: usize) -> AnnotationDrag {
    let viewport = places.viewport;
    let view = scene.document.view();
    let outer = frame_place(viewport, &view.frames[number]).expand(0.5);
    let position = |name: &str| (name.to_string(), scene.document.position(name));
    let nodes = places.nodes.iter().filter(|node| outer.contains_rect(node.rect));
    let frames = view.frames.iter().cloned().enumerate();
    let is_held =
        |(i, frame): &(usize, Frame)| *i == number || outer.contains_rect(frame_place(viewport, frame));
    let notes = view.notes.iter().cloned().enumerate();
    AnnotationDrag {
        nodes: nodes.map(|node| position(&node.name)).collect(),
        frames: frames.filter(is_held).collect(),
        notes: notes.filter(|(_, note)| outer.contains(viewport.to_window(note.position))).collect(),
        ..AnnotationDrag::default()
    }
}

/// The grid.
pub(super) fn draw_grid(ui: &Ui, viewport: Viewport) {
    let Viewport { rect, pan, zoom } = viewport;
    let step = 40.0 * zoom * if zoom < 0.5 { 4.0 } else { 1.0 };
    let color = if ui.visuals().dark_mode { Color32::from_gray(30) } else { Color32::from_gray(216) };
    let stroke = Stroke::new(1.0, color);
    let first = |pan: f32| pan.rem_euclid(step);
    let mut x = rect.left() + first(pan.x);
    while x < rect.right() {
        ui.painter().vline(x, rect.y_range(), stroke);
        x += step;
    }
    let mut y = rect.top() + first(pan.y);
    while y < rect.bottom() {
        ui.painter().hline(rect.x_range(), y, stroke);
        y += step;
    }
}

/// Frames with their titles, and notes.
pub(super) fn draw(ui: &Ui, viewport: Viewport, scene: &Scene) {
    let dark = ui.visuals().dark_mode;
    for frame in &scene.document.view().frames {
        let place = frame_place(viewport, frame);
        let color = frame.color.map_or(theme::weak(dark), of_channels);
        let (fill, stroke) = (color.gamma_multiply(0.12), Stroke::new(1.0, color));
        ui.painter().rect(place, Rounding::same(6.0), fill, stroke);
        let corner = place.min + vec2(8.0, 4.0) * viewport.zoom;
        let clipped = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
        let font = FontId::proportional(letters(viewport));
        clipped.text(corner, Align2::LEFT_TOP, &frame.title, font, theme::weak(dark));
    }
    let paper = if dark { Color32::from_rgb(60, 56, 40) } else { Color32::from_rgb(255, 250, 215) };
    for note in &scene.document.view().notes {
        let (place, galley) = note_place(ui, viewport, note);
        ui.painter().rect_filled(place, 3.0, paper);
        ui.painter().galley(viewport.to_window(note.position), galley, theme::weak(dark));
    }
}

/// Size of the letters of titles and notes.
fn letters(viewport: Viewport) -> f32 {
    (12.0 * viewport.zoom).max(8.0)
}

/// Rectangle of a frame in the window.
fn frame_place(viewport: Viewport, frame: &Frame) -> Rect {
    viewport.rect_of(frame.position, frame.size)
}

/// Rectangle of a frame's title.
fn title_place(viewport: Viewport, frame: &Frame) -> Rect {
    let place = frame_place(viewport, frame);
    let height = (TITLE * viewport.zoom).max(MIN_TITLE_HEIGHT).min(place.height());
    Rect::from_min_size(place.min, vec2(place.width(), height))
}

/// Rectangle of a note, with its text.
fn note_place(ui: &Ui, viewport: Viewport, note: &Note) -> (Rect, Arc<Galley>) {
    let (font, color) = (FontId::proportional(letters(viewport)), theme::weak(ui.visuals().dark_mode));
    let galley = ui.painter().layout(note.text.clone(), font, color, NOTE * viewport.zoom.max(0.6));
    // An empty note can be found, too.
    let size = galley.size().max(Vec2::splat(letters(viewport)));
    (Rect::from_min_size(viewport.to_window(note.position), size).expand(5.0 * viewport.zoom), galley)
}

/// Red, green and blue, 0 to 1.
fn of_channels(color: [f64; 3]) -> Color32 {
    let [r, g, b] = color.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8);
    Color32::from_rgb(r, g, b)
}
