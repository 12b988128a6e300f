//! The graph view: the document's nodes and wires, and the hand that moves and joins them. Pan and zoom are this module's, places
//! are the document's.

mod ground;
mod menu;
mod node;
mod places;
mod wires;

use crate::actions::{Action, Actions};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{self, Color32, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, vec2};
pub(crate) use ground::Annotation;
use ground::Annotations;
use menu::Menu;
pub(crate) use node::usual_size;
use node::{NodeShape, Pictures};
use places::{NodePlace, Places, Viewport};
use std::collections::BTreeSet;
use std::time::Duration;
use voltet_document::Edit;
use wires::{DraggedWire, WireEnd};

/// Frames until the panels around have the sizes that the nodes are fitted to.
const FRAMES_TO_FIT: u32 = 3;

/// Distance from a port within which a pointer hits it (points).
const NEAR: f32 = 11.0;

/// Least and largest scale: beyond, nothing else is seen.
const ZOOM: [f32; 2] = [0.2, 2.0];

/// Time that a pointer rests before a tooltip (seconds). A tooltip that comes while it moves would lie under it in its
/// first frame, and take the press.
const REST: f64 = 0.25;

/// A drag of nodes: where they were, and how far it went.
type Dragged = (Vec<(String, [f64; 2])>, Vec2);

/// The view, with what a hand is doing in it.
pub(crate) struct GraphView {
    /// Position of the document's origin (points from the view's corner).
    pan: Vec2,
    zoom: f32,
    /// For so many frames more all nodes are brought into view.
    fits: u32,
    /// The names of the nodes, the upper ones last: those that a hand took hold of.
    order: Vec<String>,
    places: Places,
    dragged: Option<Dragged>,
    /// The corner of a box that selects nodes.
    boxed: Option<Pos2>,
    annotations: Annotations,
    wire: Option<DraggedWire>,
    menu: Option<Menu>,
    /// The menu is to be opened at the pointer.
    asked: bool,
    /// Position of the pointer, and the time since when.
    rests: Option<(Pos2, f64)>,
}

impl Default for GraphView {
    fn default() -> Self {
        GraphView {
            pan: vec2(20.0, 20.0),
            zoom: 1.0,
            fits: FRAMES_TO_FIT,
            order: Vec::new(),
            places: Places::default(),
            dragged: None,
            boxed: None,
            annotations: Annotations::default(),
            wire: None,
            menu: None,
            asked: false,
            rests: None,
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
        self.places.node(node).map_or(usual_size(None), |node| {
            let size = node.rect.size() / self.zoom;
            [f64::from(size.x), f64::from(size.y)]
        })
    }

    /// Brings all nodes into view.
    pub fn fit(&mut self) {
        self.fits = FRAMES_TO_FIT;
    }

    /// Has the words of a frame or a note written.
    pub fn write_on(&mut self, thing: Annotation, text: &str) {
        self.annotations.write_on(thing, text);
    }

    /// Position of a port as drawn.
    #[cfg(test)]
    pub fn port_at(&self, node: &str, name: &str, is_input: bool) -> Option<Pos2> {
        let mut ports = self.places.node(node)?.ports.iter();
        ports.find(|(port, _)| port.name == name && port.is_input == is_input).map(|(_, at)| *at)
    }

    /// True if a port is shown at a position of the window.
    #[cfg(test)]
    pub fn shows_port_at(&self, at: Pos2) -> bool {
        self.places.port_at(at, 1.0).is_some()
    }

    /// Rectangle of a node as drawn.
    #[cfg(test)]
    pub fn frame_of(&self, node: &str) -> Option<Rect> {
        self.places.node(node).map(|node| node.rect)
    }

    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, pictures: &Pictures, actions: &mut Actions) {
        let rect = ui.max_rect();
        ui.set_clip_rect(rect);
        let nodes = &scene.document.pipeline().nodes;
        let place_of = |name: &str| self.order.iter().position(|known| known == name);
        let mut shapes: Vec<NodeShape> =
            nodes.iter().map(|entry| NodeShape::new(ui, scene, entry, pictures)).collect();
        shapes.sort_by_key(|shape| place_of(&shape.entry.name).map_or(0, |place| place + 1));
        self.order = shapes.iter().map(|shape| shape.entry.name.clone()).collect();
        self.move_view(ui, rect, scene, &shapes);
        let viewport = Viewport { rect, pan: self.pan, zoom: self.zoom };
        self.places = Places::new(viewport, shapes.iter().map(|shape| shape.place(viewport)).collect());
        ground::draw_grid(ui, viewport);
        ground::draw(ui, viewport, scene);
        let ground = ui.interact(rect, ui.id().with("ground"), Sense::click_and_drag());
        wires::draw(ui, scene, &self.places, self.wire.as_ref(), self.zoom);
        let places = std::mem::take(&mut self.places);
        for (shape, place) in shapes.iter().zip(&places.nodes) {
            if rect.intersects(place.rect.expand(20.0)) {
                self.show_node(ui, scene, shape, place, &places, actions);
            }
        }
        self.places = places;
        self.select_box(ui, scene, &ground, actions);
        self.hold_wire(ui, rect, scene, actions);
        let is_wiring = self.wire.is_some();
        let is_at_ground = self.annotations.hold(ui, &self.places, scene, is_wiring, actions);
        self.point_at(ui, scene, &shapes, is_at_ground, actions);
        self.show_menu(ui, viewport, scene, actions);
        if !ui.input(|input| input.pointer.any_down()) {
            self.dragged = None;
        }
    }

    /// A node with its ports; handles the pointer's actions on them.
    fn show_node(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        shape: &NodeShape,
        place: &NodePlace,
        places: &Places,
        actions: &mut Actions,
    ) {
        let response = ui.interact(place.rect, ui.id().with(("node", &place.name)), Sense::click_and_drag());
        shape.draw(ui, place, self.zoom);
        if scene.selection.contains(&place.name) {
            NodeShape::draw_selection(ui, place, self.zoom);
        }
        let moves_view = ui.input(|input| input.modifiers.command);
        if response.clicked() {
            select(ui, scene, [place.name.clone()].into(), actions);
        }
        if response.dragged_by(PointerButton::Primary) && !moves_view {
            self.drag(scene, &place.name, response.drag_delta(), actions);
        }
        if response.clicked() || response.dragged() {
            self.order.retain(|name| *name != place.name);
            self.order.push(place.name.clone());
        }
        for (port, at) in &place.ports {
            if places.is_under(&place.name, *at) {
                continue;
            }
            let is_fed = !port.is_input || shape.entry.inputs.iter().any(|link| link.port == port.name);
            theme::port(ui.painter(), *at, 5.0 * self.zoom, port.port_type, ui.visuals().dark_mode, is_fed);
            let around = Rect::from_center_size(*at, Vec2::splat(12.0 * self.zoom.max(0.6)));
            let id = ui.id().with(("port", &place.name, port.name, port.is_input));
            let response = ui.interact(around, id, Sense::click_and_drag());
            if response.drag_started_by(PointerButton::Primary) && !moves_view {
                self.wire = Some(DraggedWire::new(scene, port));
            }
        }
    }

    /// A node is dragged, with all that are selected if it is.
    fn drag(&mut self, scene: &Scene, name: &str, delta: Vec2, actions: &mut Actions) {
        if delta == Vec2::ZERO {
            return;
        }
        let (origins, way) = self.dragged.get_or_insert_with(|| {
            let with: BTreeSet<String> = match scene.selection.contains(name) {
                true => scene.selection.clone(),
                false => BTreeSet::from([name.to_string()]),
            };
            let at = |name: &String| (name.clone(), scene.document.position(name));
            (with.iter().map(at).collect(), Vec2::ZERO)
        });
        *way += delta / self.zoom;
        let moved = origins
            .iter()
            .map(|(name, at)| (name.clone(), [at[0] + f64::from(way.x), at[1] + f64::from(way.y)]));
        actions.edit(Edit::MoveNodes(moved.collect()));
    }

    /// A box on the ground selects the nodes that it touches, a click none.
    fn select_box(&mut self, ui: &Ui, scene: &Scene, ground: &Response, actions: &mut Actions) {
        let (pointer, command) = ui.input(|input| (input.pointer.clone(), input.modifiers.command));
        if ground.clicked() && self.menu.is_none() {
            select(ui, scene, BTreeSet::new(), actions);
        }
        if ground.drag_started_by(PointerButton::Primary) && !command {
            self.boxed = pointer.press_origin();
        }
        let (Some(from), Some(to)) = (self.boxed.filter(|_| pointer.primary_down()), pointer.interact_pos())
        else {
            self.boxed = None;
            return;
        };
        let chosen = Rect::from_two_pos(from, to);
        let stroke = Stroke::new(3.0, Color32::from_rgba_unmultiplied(200, 200, 200, 180));
        ui.painter().rect(chosen, 2.0, Color32::from_rgba_unmultiplied(200, 200, 200, 20), stroke);
        let touched = self.places.nodes.iter().filter(|node| chosen.intersects(node.rect));
        select(ui, scene, touched.map(|node| node.name.clone()).collect(), actions);
    }

    /// The wire in the hand; dropped on the ground it opens the menu of what fits.
    fn hold_wire(&mut self, ui: &Ui, rect: Rect, scene: &Scene, actions: &mut Actions) {
        let Some(wire) = self.wire.take() else { return };
        let Some(at) = ui.input(|input| input.pointer.interact_pos()) else { return };
        match wire.hold(ui, scene, self.places.port_at(at, NEAR * self.zoom.max(0.6)), actions) {
            WireEnd::Held => self.wire = Some(wire),
            WireEnd::OnGround if rect.contains(at) && self.places.node_at(at).is_none() => {
                self.menu = Some(Menu::new(at, Some(wire.port)));
            }
            WireEnd::OnGround | WireEnd::Done => {}
        }
    }

    /// Wheel, middle drag, and bringing all into view.
    fn move_view(&mut self, ui: &mut Ui, rect: Rect, scene: &Scene, shapes: &[NodeShape]) {
        if self.fits > 0 {
            self.fits -= 1;
            self.bring_into_view(rect, scene, shapes);
            ui.ctx().request_repaint();
        }
        let over = ui.rect_contains_pointer(rect) && self.menu.is_none();
        let (scroll, zoom_delta, at, delta, pans) = ui.input(|input| {
            let pans =
                input.pointer.middle_down() || (input.pointer.primary_down() && input.modifiers.command);
            (
                input.smooth_scroll_delta,
                input.zoom_delta(),
                input.pointer.hover_pos(),
                input.pointer.delta(),
                pans,
            )
        });
        if let Some(at) = at.filter(|_| over) {
            let factor = (scroll.y * 0.0025).exp() * zoom_delta;
            let zoom = (self.zoom * factor).clamp(ZOOM[0], ZOOM[1]);
            let from = at - rect.min;
            self.pan = from - (from - self.pan) * (zoom / self.zoom);
            self.zoom = zoom;
            if pans {
                self.pan += delta;
            }
        }
    }

    fn bring_into_view(&mut self, rect: Rect, scene: &Scene, shapes: &[NodeShape]) {
        let usual = Viewport { rect: Rect::ZERO, ..Viewport::default() };
        let view = scene.document.view();
        let nodes = shapes.iter().map(|shape| usual.rect_of(shape.position, shape.size));
        let frames = view.frames.iter().map(|frame| usual.rect_of(frame.position, frame.size));
        let mut all = nodes.chain(frames).fold(Rect::NOTHING, Rect::union);
        view.notes.iter().for_each(|note| all.extend_with(usual.to_window(note.position)));
        if !all.is_finite() || all.is_negative() {
            (self.pan, self.zoom) = (vec2(20.0, 20.0), 1.0);
            return;
        }
        let room = rect.size() - vec2(40.0, 40.0);
        self.zoom = (room.x / all.width()).min(room.y / all.height()).clamp(ZOOM[0], 1.0);
        self.pan = rect.size() / 2.0 - self.zoom * all.center().to_vec2();
    }

    /// Words about what the pointer points at; a double click shows a picture or opens the menu.
    fn point_at(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        shapes: &[NodeShape],
        is_at_ground: bool,
        actions: &mut Actions,
    ) {
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
            (Some(port), _) => Some(wires::port_description(scene, port)),
            (None, Some(name)) => {
                let shape = shapes.iter().find(|shape| shape.entry.name == name);
                shape.map(|shape| shape.description(scene))
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

    fn show_menu(&mut self, ui: &mut Ui, viewport: Viewport, scene: &Scene, actions: &mut Actions) {
        let rect = viewport.rect;
        if std::mem::take(&mut self.asked) {
            let at = ui.input(|input| input.pointer.hover_pos()).filter(|at| rect.contains(*at));
            self.menu = Some(Menu::new(at.unwrap_or(rect.center()), None));
        }
        let Some(mut menu) = self.menu.take() else { return };
        let at = viewport.to_document(menu.at);
        if menu.show(ui, rect, scene, at, actions) {
            self.menu = Some(menu);
        }
    }
}

/// Selects nodes; with Shift or Ctrl beside those that are selected.
fn select(ui: &Ui, scene: &Scene, names: BTreeSet<String>, actions: &mut Actions) {
    let adds = ui.input(|input| input.modifiers.shift || input.modifiers.command);
    let names = if adds { &names | scene.selection } else { names };
    if names != *scene.selection {
        actions.push(Action::Select(names));
    }
}
