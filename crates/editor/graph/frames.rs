//! Frames and notes in a hand: moved (a frame with all that it holds), resized, written on, coloured, taken away.

use super::GraphView;
use super::annotations::{Annotation, AnnotationDrag, Writing};
use crate::actions::Actions;
use crate::scene::Scene;
use eframe::egui::{
    self, Area, CursorIcon, Key, Order, Pos2, Rect, Response, Sense, TextEdit, Ui, Vec2, vec2,
};
use voltet_document::{Edit, Frame, Note};

/// Side of the corner that a frame is resized by, and its least width and height, points.
const CORNER: f32 = 14.0;
const MIN_SIZE: f64 = 60.0;

impl GraphView {
    /// Has the words of a frame or a note written.
    pub fn write_on(&mut self, thing: Annotation, text: &str) {
        self.writing = Some(Writing { thing, text: text.to_string(), is_new: true });
    }

    /// Handles drags and clicks of frames and notes; true if the pointer is at one. Called after the nodes, which lie
    /// above and take precedence.
    pub(super) fn hold_ground(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        scene: &Scene,
        actions: &mut Actions,
    ) -> bool {
        let mut is_at_one = false;
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let is_covered = pointer.is_some_and(|at| self.places.node_at(at).is_some()) || self.wire.is_some();
        let sense = if is_covered { Sense::hover() } else { Sense::click_and_drag() };
        let view = scene.document.view();
        for (i, frame) in view.frames.iter().enumerate() {
            let title = self.title_place(rect, frame).intersect(rect);
            if title.is_positive() {
                let response = ui.interact(title, ui.id().with(("frame", i)), sense);
                is_at_one |= response.contains_pointer();
                self.hold_thing(ui, scene, Annotation::Frame(i), &response, actions);
            }
            let corner = self.frame_place(rect, frame).max;
            let corner = Rect::from_min_max(corner - Vec2::splat(CORNER), corner).intersect(rect);
            if corner.is_positive() {
                let response = ui.interact(corner, ui.id().with(("corner", i)), sense);
                if response.drag_started() {
                    let frames = vec![(i, frame.clone())];
                    self.carried =
                        Some(AnnotationDrag { frames, resizes: true, ..AnnotationDrag::default() });
                }
                self.carry(&response, actions);
                response.on_hover_cursor(CursorIcon::ResizeNwSe);
            }
        }
        for (i, note) in view.notes.iter().enumerate() {
            let place = self.note_place(ui, rect, note).0.intersect(rect);
            if place.is_positive() {
                let response = ui.interact(place, ui.id().with(("note", i)), sense);
                is_at_one |= response.contains_pointer();
                self.hold_thing(ui, scene, Annotation::Note(i), &response, actions);
            }
        }
        self.write(ui, rect, scene, actions);
        is_at_one
    }

    fn hold_thing(
        &mut self,
        ui: &Ui,
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
                Annotation::Frame(i) => self.held_by(scene, i, &view.frames[i]),
                Annotation::Note(i) => {
                    AnnotationDrag { notes: vec![(i, view.notes[i].clone())], ..AnnotationDrag::default() }
                }
            });
        }
        self.carry(response, actions);
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

    /// A frame with what stands wholly in it.
    fn held_by(&self, scene: &Scene, number: usize, frame: &Frame) -> AnnotationDrag {
        let holds = |at: [f64; 2], size: [f64; 2]| {
            (0..2).all(|i| at[i] >= frame.position[i] && at[i] + size[i] <= frame.position[i] + frame.size[i])
        };
        let view = scene.document.view();
        let nodes = scene.document.pipeline().nodes.iter();
        let nodes = nodes.map(|node| (node.name.clone(), scene.document.position(&node.name)));
        let frames = view.frames.iter().cloned().enumerate();
        let notes = view.notes.iter().cloned().enumerate();
        AnnotationDrag {
            nodes: nodes.filter(|(name, at)| holds(*at, self.places.size_of(name))).collect(),
            frames: frames.filter(|(i, other)| *i == number || holds(other.position, other.size)).collect(),
            notes: notes.filter(|(_, note)| holds(note.position, [0.0; 2])).collect(),
            ..AnnotationDrag::default()
        }
    }

    /// The edits of what is carried; all of a drag are one step.
    fn carry(&mut self, response: &Response, actions: &mut Actions) {
        let Some(carried) = self.carried.as_mut().filter(|_| response.dragged()) else { return };
        if response.drag_delta() == Vec2::ZERO {
            return;
        }
        carried.way += response.drag_delta() / self.zoom;
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
    fn write(&mut self, ui: &Ui, rect: Rect, scene: &Scene, actions: &mut Actions) {
        let Some(mut writing) = self.writing.take() else { return };
        let view = scene.document.view();
        let (at, edit): (Pos2, Box<dyn Fn(String) -> Edit>) = match writing.thing {
            Annotation::Frame(i) => {
                let Some(frame) = view.frames.get(i).cloned() else { return };
                let at = self.title_place(rect, &frame).min;
                (at, Box::new(move |title| Edit::PutFrame(i, Frame { title, ..frame.clone() })))
            }
            Annotation::Note(i) => {
                let Some(note) = view.notes.get(i).cloned() else { return };
                let at = self.note_place(ui, rect, &note).0.min;
                (at, Box::new(move |text| Edit::PutNote(i, Note { text, ..note.clone() })))
            }
        };
        let at = at.clamp(rect.min, rect.max - vec2(230.0, 60.0));
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
