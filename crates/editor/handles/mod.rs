//! Handles in the picture: grips of clips, slices and annotations, which the pointer drags and keys move. What is moved is the parameters of their node.

mod movable;
mod notes;
mod space;

use crate::eyes::eye;
use crate::scene::Scene;
use crate::theme::{self, Help};
use eframe::egui::{
    Color32, CursorIcon, EventFilter, Key, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2,
    WidgetInfo, WidgetType, vec2,
};
use movable::{Movable, PictureGrip};
pub(crate) use space::clip_parameters;
use std::rc::Rc;
use voltet_document::Edit;
use voltet_document::links::upstream;
use voltet_graph::NodeEntry;

/// Side of the square in which the pointer takes hold of a grip, and radius of its mark, points.
const GRIP: f32 = 16.0;
const RADIUS: f32 = 5.0;

/// With Alt a drag goes so much of the hand's way, and a key of its step.
const FINE: f64 = 0.2;

/// Drag of a grip: what it belongs to as it was, and where the hand is.
struct GripDrag {
    object: Rc<dyn Movable>,
    grip: PictureGrip,
    /// Edits that were made last: those that change nothing are not made.
    last: Vec<Edit>,
    /// True in the frame in which it begins.
    is_new: bool,
}

impl GripDrag {
    fn is_of(&self, object: &dyn Movable) -> bool {
        (self.object.node(), self.object.name()) == (object.node(), object.name())
    }
}

/// The handles, with what a hand is doing to them.
#[derive(Default)]
pub(crate) struct Handles {
    drag: Option<GripDrag>,
    /// True if a key moved a grip in the last frame.
    is_nudged: bool,
    /// Places of the grips in the window, in the last frame in which they were shown.
    pub places: Vec<Pos2>,
}

impl Handles {
    /// True while a hand moves a grip.
    pub fn are_moved(&self) -> bool {
        self.drag.is_some() || self.is_nudged
    }

    /// Draws them over the picture and follows the hand. Shown after the picture, above which they lie. Returns the picture's response with
    /// what is done at grips and is not for them: clicks, the wheel, other buttons.
    pub fn show(&mut self, ui: &Ui, scene: &Scene, picture: Rect, mut below: Response) -> Response {
        let painter = ui.painter().with_clip_rect(picture.intersect(ui.clip_rect()));
        let to_window = |[x, y]: [f64; 2]| picture.center() + picture.height() * vec2(x as f32, -y as f32);
        let color = theme::accent(true);
        let mut is_held = false;
        self.is_nudged = false;
        self.places.clear();
        for object in objects(scene) {
            for ends in object.lines() {
                // On a rim of black, so that it is seen over whatever the picture shows there.
                painter.line_segment(ends.map(to_window), Stroke::new(3.0, Color32::from_black_alpha(110)));
                painter.line_segment(ends.map(to_window), Stroke::new(1.2, color));
            }
            let mut grips = object.grips();
            if let Some(drag) = &self.drag
                && drag.is_of(&*object)
                && grips.iter().all(|grip| grip.number != drag.grip.number)
            {
                // Held also where it is behind the eye.
                grips.push(drag.grip.clone());
            }
            // The first above the others: where a plane faces the eye, its position above the tip of its arrow.
            for grip in grips.into_iter().rev() {
                let at = to_window(grip.place);
                let name = format!("{}: {}", object.name(), grip.name);
                let held = |drag: &GripDrag| drag.is_of(&*object) && drag.grip.number == grip.number;
                let is_dragged = self.drag.as_ref().is_some_and(held);
                is_held |= is_dragged;
                if !is_dragged && !painter.clip_rect().contains(at) {
                    continue;
                }
                self.places.push(at);
                let rect = Rect::from_center_size(at, Vec2::splat(GRIP));
                let response = ui.interact(rect, ui.id().with(&name), Sense::click_and_drag());
                response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, &name));
                let response = response.on_hover_cursor(CursorIcon::Move).help(&name);
                self.hold(ui, scene, &object, &grip, &response, picture.height());
                if !(response.drag_started_by(PointerButton::Primary) || is_dragged) {
                    below = below.union(response.clone());
                }
                let is_chosen = response.has_focus() || response.hovered() || is_dragged;
                let edge = if is_chosen { Color32::WHITE } else { Color32::BLACK };
                painter.circle(at, RADIUS, color, Stroke::new(if is_chosen { 2.0 } else { 1.2 }, edge));
            }
        }
        // What is gone, as by a key that takes it away, is not dragged on.
        self.drag = self.drag.take().filter(|drag| is_held || drag.is_new);
        self.drag.iter_mut().for_each(|drag| drag.is_new = false);
        below
    }

    fn hold(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        object: &Rc<dyn Movable>,
        grip: &PictureGrip,
        response: &Response,
        height: f32,
    ) {
        let alt = ui.input(|input| input.modifiers.alt);
        let times = if alt { FINE } else { 1.0 };
        let label = || format!("move the {}", object.name());
        let begins = response.drag_started_by(PointerButton::Primary);
        if begins || response.clicked() {
            response.request_focus();
        }
        if begins {
            let last = object.moved(grip.number, grip.place);
            self.drag = Some(GripDrag { object: object.clone(), grip: grip.clone(), last, is_new: true });
        }
        if response.dragged_by(PointerButton::Primary)
            && let Some(drag) = &mut self.drag
        {
            // From where it was taken hold of the hand has gone a little before that is a drag.
            let press = ui.input(|input| input.pointer.press_origin()).filter(|_| begins);
            let way = press.zip(response.interact_pointer_pos()).map(|(from, to)| to - from);
            let by = way.unwrap_or(response.drag_delta()) / height.max(1.0);
            drag.grip.place[0] += times * f64::from(by.x);
            drag.grip.place[1] -= times * f64::from(by.y);
            let edits = drag.object.moved(drag.grip.number, drag.grip.place);
            if edits != drag.last {
                drag.last = edits.clone();
                scene.actions.edits(label(), edits);
            }
        }
        if response.drag_stopped() {
            self.drag = None;
        }
        if response.has_focus() && self.drag.is_none() {
            let [right, up] = arrows(ui, response);
            if [right, up] != [0.0; 2] {
                scene.actions.edits(label(), object.nudged(grip.number, [times * right, times * up]));
                self.is_nudged = true;
            }
        }
    }
}

/// Steps to the right and up by the arrow keys, which go to what has the focus.
fn arrows(ui: &Ui, response: &Response) -> [f64; 2] {
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    ui.input(|input| {
        let count = |key: Key| input.num_presses(key) as f64;
        let [left, right, down, up] =
            [Key::ArrowLeft, Key::ArrowRight, Key::ArrowDown, Key::ArrowUp].map(count);
        [right - left, up - down]
    })
}

/// The objects that have handles: those of the selected nodes; without a clip or slice among these, the only one of the picture.
fn objects(scene: &Scene) -> Vec<Rc<dyn Movable>> {
    let (Some(shown), Some(view)) = (scene.shown_node, scene.view) else { return Vec::new() };
    let nodes = &scene.document.pipeline().nodes;
    let feeding = upstream(nodes, shown);
    let is_drawn = |node: &NodeEntry| eye(scene, node) != Some(false);
    let in_picture = nodes.iter().filter(|node| feeding.contains(&node.name) && is_drawn(node));
    let mut found = space::objects(scene, view, in_picture.clone());
    let is_selected = |node: &str| scene.selection.contains(node);
    if found.iter().any(|object| is_selected(object.node())) {
        found.retain(|object| is_selected(object.node()));
    } else if found.len() > 1 {
        found.clear();
    }
    found.extend(notes::objects(scene, in_picture.filter(|node| is_selected(&node.name))));
    found
}
