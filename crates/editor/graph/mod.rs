//! The graph view: the document's nodes and wires, and the hand that moves and joins them.
//!
//! One small interface ([`GraphView::show`]) around the package that draws nodes (`package.rs`). Pan and zoom are this
//! module's, places are the document's; wires, the menu, frames and notes are drawn here.

mod annotations;
mod dragged_wire;
mod face;
mod faces;
mod frames;
mod ground;
mod menu;
mod package;
mod places;
mod pointer;
mod visible_area;
mod wires;

use crate::actions::{Action, Actions};
use crate::scene::Scene;
use crate::theme;
pub(crate) use annotations::Annotation;
use annotations::{AnnotationDrag, Writing};
use eframe::egui::{
    self, Color32, FontId, PointerButton, Rect, Rounding, Stroke, TextureHandle, Ui, Vec2, pos2, vec2,
};
use egui_node_graph2::{AnyParameterId, NodeId};
use menu::Menu;
use package::{NoTemplates, State, Written};
pub(crate) use places::usual_size;
use places::{Places, Port};
use std::collections::HashMap;
use std::rc::Rc;
use std::time::Duration;
use wires::DraggedWire;

/// Frames until nodes have the sizes that they are fitted by.
const FRAMES_TO_FIT: u32 = 3;

/// Distance from a port within which a pointer hits it (points).
const NEAR: f32 = 11.0;

/// Height of the letters of names where others are left out, points.
const MIN_LETTER_HEIGHT: f32 = 9.0;

/// Time that a pointer rests before a tooltip (seconds). A tooltip that comes while it moves would lie under it in its
/// first frame, and take the press.
const REST: f64 = 0.25;

/// The picture of a node, where there is one.
type Pictures<'a> = dyn Fn(&str) -> Option<TextureHandle> + 'a;

/// A drag of nodes: where they were, and how far it went.
type Dragged = (Vec<(String, [f64; 2])>, Vec2);

/// The view, with what a hand is doing in it.
pub(crate) struct GraphView {
    /// Position of the document's origin (points from the view's corner).
    pan: Vec2,
    zoom: f32,
    /// For so many frames more all nodes are brought into view: their sizes are known once they were drawn.
    fits: u32,
    state: State,
    ids: HashMap<String, NodeId>,
    ports: HashMap<AnyParameterId, Rc<Port>>,
    /// The document that the known nodes have the ports of, by its revision.
    ported: Option<u64>,
    places: Places,
    dragged: Option<Dragged>,
    carried: Option<AnnotationDrag>,
    writing: Option<Writing>,
    wire: Option<DraggedWire>,
    menu: Option<Menu>,
    /// The menu is to be opened at the pointer.
    asked: bool,
    /// Position of the pointer, and the time since when.
    rests: Option<(egui::Pos2, f64)>,
    /// The style that the package's scaled one was made of.
    styled: Option<(f32, bool)>,
}

impl Default for GraphView {
    fn default() -> Self {
        GraphView {
            pan: vec2(20.0, 20.0),
            zoom: 1.0,
            fits: FRAMES_TO_FIT,
            state: State::default(),
            ids: HashMap::new(),
            ports: HashMap::new(),
            ported: None,
            places: Places::default(),
            dragged: None,
            carried: None,
            writing: None,
            wire: None,
            menu: None,
            asked: false,
            rests: None,
            styled: None,
        }
    }
}

impl GraphView {
    /// Opens the menu of node types.
    pub fn open_menu(&mut self) {
        self.asked = true;
    }

    /// Width and height of a node as it was drawn; of one that was not, the usual ones.
    pub fn size_of(&self, node: &str) -> [f64; 2] {
        self.places.size_of(node)
    }

    /// Brings all nodes into view.
    pub fn fit(&mut self) {
        self.fits = FRAMES_TO_FIT;
    }

    /// Position of a port as drawn.
    #[cfg(test)]
    pub fn port_at(&self, node: &str, name: &str, is_input: bool) -> Option<egui::Pos2> {
        let is_it = |port: &Rc<Port>| port.node == node && port.name == name && port.is_input == is_input;
        self.places.seen.iter().find(|(port, _)| is_it(port)).map(|(_, at)| *at)
    }

    /// True if a port is shown at a position of the window.
    #[cfg(test)]
    pub fn shows_port_at(&self, at: egui::Pos2) -> bool {
        self.places.port_at(at, 1.0).is_some()
    }

    /// Rectangle of a node as drawn.
    #[cfg(test)]
    pub fn frame_of(&self, node: &str) -> Option<Rect> {
        self.places.drawn.iter().find(|(name, _)| name == node).map(|(_, frame)| *frame)
    }

    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, pictures: &Pictures, actions: &mut Actions) {
        let rect = ui.max_rect();
        ui.set_clip_rect(rect);
        self.move_view(ui, rect, scene);
        self.grid(ui, rect);
        self.frames_and_notes(ui, rect, scene);
        let wires_at = ui.painter().add(egui::Shape::Noop);
        let visible = self.visible(scene, rect);
        self.sync(ui, scene, pictures, &visible);
        self.style(ui);
        let in_hand_before = self.state.connection_in_progress;
        let is_far = self.is_far(ui);
        let mut written = Written { zoom: self.zoom, is_far, ..Written::default() };
        let response = self.state.draw_graph_editor(ui, NoTemplates, &mut written, Vec::new());
        // The package's own menu knows nothing of what fits.
        self.state.node_finder = None;
        self.places.write_down(&self.state, &written, &self.ports, rect.min.to_vec2() + self.pan, self.zoom);
        wires::draw(ui, wires_at, scene, &self.places, self.wire.as_ref(), self.to_window(rect), self.zoom);
        self.over_nodes(ui, scene, is_far);
        for response in response.node_responses {
            self.respond(ui, scene, response, actions);
        }
        self.selected(ui, scene, in_hand_before.is_some(), actions);
        self.joining(ui, rect, scene, actions);
        let is_at_ground = self.hold_ground(ui, rect, scene, actions);
        self.point_at(ui, scene, is_at_ground, actions);
        self.show_menu(ui, rect, scene, actions);
        if !ui.input(|input| input.pointer.any_down()) {
            (self.dragged, self.carried) = (None, None);
        }
    }

    /// The package scales a copy of the style; it is made again where the scale or the theme is another.
    fn style(&mut self, ui: &Ui) {
        let key = (self.zoom, ui.visuals().dark_mode);
        if self.styled != Some(key) {
            let by = self.zoom / self.state.pan_zoom.zoom;
            self.state.pan_zoom.zoom(ui.clip_rect(), ui.style(), by);
            self.state.pan_zoom.started = true;
            self.styled = Some(key);
        }
    }

    /// Ports in their shapes, and what is selected, over the package's nodes.
    fn over_nodes(&self, ui: &Ui, scene: &Scene, is_far: bool) {
        let dark = ui.visuals().dark_mode;
        for (name, frame) in &self.places.drawn {
            if is_far {
                let font = FontId::proportional(MIN_LETTER_HEIGHT);
                let painter = ui.painter().with_clip_rect(frame.intersect(ui.clip_rect()));
                let galley = painter.layout_no_wrap(name.clone(), font, ui.visuals().strong_text_color());
                let at = frame.center() - 0.5 * galley.size();
                painter.galley(at.max(pos2(frame.left() + 2.0, at.y)), galley, Color32::WHITE);
            }
            if scene.selection.contains(name) {
                let stroke = Stroke::new(2.0, theme::accent(dark));
                ui.painter().rect_stroke(frame.expand(2.0), Rounding::same(5.0 * self.zoom), stroke);
            }
        }
        for (port, at) in &self.places.seen {
            if self.places.is_under(&port.node, *at) {
                continue;
            }
            let fed = !port.is_input
                || scene
                    .entry(&port.node)
                    .is_some_and(|entry| entry.inputs.iter().any(|l| l.port == port.name));
            theme::port(ui.painter(), *at, 5.0 * self.zoom, port.port_type, dark, fed);
        }
    }

    /// Words about what the pointer points at; a double click shows a picture or opens the menu.
    fn point_at(&mut self, ui: &Ui, scene: &Scene, is_at_ground: bool, actions: &mut Actions) {
        let Some(at) = ui.input(|input| input.pointer.hover_pos()) else { return };
        if !ui.rect_contains_pointer(ui.max_rect())
            || self.menu.is_some()
            || self.wire.is_some()
            || scene.asks
        {
            return;
        }
        let double = ui.input(|input| input.pointer.button_double_clicked(PointerButton::Primary));
        let secondary = ui.input(|input| input.pointer.secondary_clicked());
        let port = self.places.port_at(at, NEAR * self.zoom.max(0.6));
        let node = self.places.node_at(at);
        if let Some(name) = node.filter(|_| double) {
            if scene.pictures().contains(&name) {
                actions.push(Action::Show(name.to_string()));
            }
        } else if (double || secondary) && node.is_none() && !is_at_ground {
            self.asked = true;
        }
        let id = ui.id().with("words");
        let (now, is_down) = ui.input(|input| (input.time, input.pointer.any_down()));
        let since = self.rests.filter(|(place, _)| *place == at && !is_down).map_or(now, |(_, since)| since);
        self.rests = Some((at, since));
        let left = REST - (now - since);
        let still = left <= 0.0 && !is_down;
        let words = match (port, node) {
            (Some(port), _) => Some(wires::port_description(scene, &port)),
            (None, Some(name)) => {
                let id = self.ids.get(name);
                id.and_then(|id| self.state.graph.nodes.get(*id)).map(|node| node.user_data.description())
            }
            (None, None) => None,
        };
        if words.is_some() && !still && !is_down {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(left));
        }
        if let Some(words) = words.filter(|_| still) {
            egui::show_tooltip_at_pointer(ui.ctx(), ui.layer_id(), id, |ui| {
                ui.set_max_width(320.0);
                ui.label(words);
            });
        }
    }

    fn show_menu(&mut self, ui: &mut Ui, rect: Rect, scene: &Scene, actions: &mut Actions) {
        if std::mem::take(&mut self.asked) {
            let at = ui.input(|input| input.pointer.hover_pos()).filter(|at| rect.contains(*at));
            self.menu = Some(Menu::new(at.unwrap_or(rect.center()), None));
        }
        let Some(mut menu) = self.menu.take() else { return };
        let at = self.to_document(rect, menu.at);
        if menu.show(ui, rect, scene, at, actions) {
            self.menu = Some(menu);
        }
    }
}
