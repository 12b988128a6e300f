//! The graph view: the document's nodes and wires, and the hand that moves and joins them.
//!
//! One small interface ([`GraphView::show`]) around the package that draws nodes (`package.rs`). Pan and zoom are this
//! module's, places are the document's; wires, the menu, frames and notes are drawn here.

mod by_keyboard;
mod frames;
mod menu;
mod new_node;
mod nodes;
mod package;
mod places;
mod wire_list;
mod wires;

use crate::scene::{Action, Scene};
use crate::theme;
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::{
    self, Color32, FocusDirection, FontId, Id, PointerButton, Pos2, Rect, Stroke, StrokeKind, TextStyle, Ui,
    Vec2, pos2, vec2,
};
use egui_node_editor::PanZoom;
use menu::Menu;
use package::{Face, NodeGraph, Pictures, Port};
use places::Places;
pub(crate) use places::usual_size;
use std::time::Duration;
use voltet_document::{Annotation, AnnotationId};
use voltet_graph::NodeEntry;

/// Frames until nodes have the sizes that they are fitted by.
const FRAMES_TO_FIT: u32 = 3;

/// Least and largest scale of the wheel: the package draws no smaller in one step, and beyond the other nothing else is seen.
const ZOOM: [f32; 2] = [0.2, 2.0];

/// Least scale at which all nodes are brought into view: a node is a fifth of a point wide.
const MIN_FIT: f32 = 1e-3;

/// Height of letters, points, below which they are left out; and that of the names which are drawn then.
const FAR_LETTERS: f32 = 6.0;
const MIN_LETTER_HEIGHT: f32 = 9.0;

/// Distance from a port within which a pointer hits it (points).
const NEAR: f32 = 11.0;

/// Time that a pointer rests before a tooltip (seconds). A tooltip that comes while it moves would lie under it in its
/// first frame, and take the press.
const REST: f32 = 0.25;

/// Drag of nodes, frames and notes from where they were; and how far it went.
#[derive(Default)]
struct Dragged {
    things: Vec<(AnnotationId, Annotation)>,
    nodes: Vec<(String, [f64; 2])>,
    /// The frame changes its size instead.
    resizes: bool,
    way: Vec2,
}

/// Words of a frame or a note that are being written.
struct Writing {
    thing: AnnotationId,
    text: String,
    is_new: bool,
}

/// A wire in the hand, by the port that it comes from.
struct DraggedWire {
    port: Port,
    /// The input that it was taken off from, and its source as the file says it.
    taken_off: Option<(String, &'static str, String)>,
}

/// The view, with what a hand is doing in it.
#[derive(Default)]
pub(crate) struct GraphView {
    /// The view in the window, its scale, and where the document's origin is (points from the view's corner).
    view: PanZoom,
    /// Frames since all nodes were to be brought into view, which goes on until they were drawn and their sizes are known.
    fitted: u32,
    /// The nodes that were clicked or moved, the last one above the others.
    raised: Vec<String>,
    places: Places,
    dragged: Option<Dragged>,
    writing: Option<Writing>,
    wire: Option<DraggedWire>,
    /// The wires of this frame, each with the node and the port that it feeds, and its source as the file says it.
    drawn_wires: Vec<(CubicBezierShape, [String; 3])>,
    boxed: Option<Pos2>,
    menu: Option<Menu>,
    /// True if the menu is to be opened at the pointer.
    pub opens_menu: bool,
    /// Node whose wires are to be listed.
    pub wires_of: Option<String>,
    revealed: Option<String>,
    /// The node that has the focus, by what a pointer takes hold of it by.
    focused: Option<Id>,
    /// True if Tab was pressed where nothing had the focus: it goes on from the selected node.
    pub takes_tab: bool,
    /// True until the node that it leads to has the focus.
    gains_focus: bool,
    /// Way out of the nodes that the focus takes in the next frame.
    leaves: Option<FocusDirection>,
}

impl GraphView {
    /// Width and height of a node as it was drawn; of one that was not, the usual ones.
    pub fn size_of(&self, node: &str) -> [f64; 2] {
        self.places.size_of(node)
    }

    /// True if the menu is open, or words are being written.
    pub fn is_choosing(&self) -> bool {
        self.menu.is_some() || self.writing.is_some()
    }

    /// The view in the window.
    #[cfg(test)]
    pub fn pane(&self) -> Rect {
        self.view.clip_rect
    }

    pub fn fit(&mut self) {
        self.fitted = 0;
    }

    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, pictures: &Pictures) {
        self.view.clip_rect = ui.max_rect();
        ui.set_clip_rect(self.view.clip_rect);
        self.move_view(ui, scene);
        self.grid(ui);
        self.frames_and_notes(ui, scene);
        let wires_at = ui.painter().add(egui::Shape::Noop);
        self.scale_style(ui);
        let nodes = self.nodes(ui, scene, pictures);
        self.wires(ui, wires_at, scene);
        self.over_nodes(ui, scene);
        self.joining(ui, scene);
        let is_at_ground = self.hold_ground(ui, scene);
        self.point_at(ui, scene, &nodes, is_at_ground);
        self.show_menu(ui, scene);
        if !ui.input(|input| input.pointer.any_down()) {
            self.dragged = None;
        }
    }

    /// Ports in their shapes, and what is selected, over the package's nodes.
    fn over_nodes(&self, ui: &Ui, scene: &Scene) {
        let (dark, is_far) = (ui.visuals().dark_mode, self.is_far(ui));
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
                ui.painter().rect_stroke(frame.expand(2.0), 5.0 * self.view.zoom, stroke, StrokeKind::Middle);
            }
        }
        for (port, at) in &self.places.seen {
            let inputs = || scene.entry(&port.node).into_iter().flat_map(|entry| &entry.inputs);
            let fed = !port.is_input || inputs().any(|link| link.port == port.declared.name);
            theme::port(ui.painter(), *at, 5.0 * self.view.zoom, port.declared.port_type, dark, fed);
        }
    }

    /// Words about what the pointer points at; a double click shows a picture or opens the menu.
    fn point_at(&mut self, ui: &Ui, scene: &Scene, nodes: &NodeGraph, is_at_ground: bool) {
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
        let port = self.places.port_at(at, NEAR * self.view.zoom.max(0.6));
        let node = self.places.node_at(at);
        if let Some(name) = node.filter(|_| double) {
            if scene.pictures().contains(&name) {
                scene.actions.push(Action::Show(name.to_string()));
            }
        } else if (double || secondary) && node.is_none() && port.is_none() && !is_at_ground {
            match self.wire_at(at).filter(|_| secondary) {
                Some(wire) => self.menu = Some(Menu::of_wire(at, wire)),
                None => self.opens_menu = true,
            }
        }
        let (rest, is_down) = ui.input(|input| {
            let pointer = &input.pointer;
            (pointer.time_since_last_movement().min(pointer.time_since_last_click()), pointer.any_down())
        });
        let still = rest >= REST && !is_down;
        let words = match (port, node) {
            (Some(port), _) => Some(port.description(scene)),
            (None, name) => {
                let mut faces = nodes.nodes.values().map(|node| &node.user_data);
                faces.find(|face| Some(face.name.as_str()) == name).map(Face::description)
            }
        };
        if words.is_some() && !still && !is_down {
            ui.ctx().request_repaint_after(Duration::from_secs_f32(REST - rest));
        }
        let frame = self.places.drawn.iter().rev().find(|(name, _)| Some(name.as_str()) == node);
        match (words.filter(|_| still), frame.filter(|_| port.is_none())) {
            // Its ports can be reached meanwhile.
            (Some(words), Some((name, frame))) => {
                let others = self.places.drawn.iter().filter(|(other, _)| other != name);
                let others: Vec<Rect> = others.map(|(_, frame)| *frame).collect();
                theme::words_beside(ui, "words", *frame, &others, words);
            }
            (Some(words), None) => theme::words_at_pointer(ui, "words", words),
            (None, _) => {}
        }
    }

    fn show_menu(&mut self, ui: &mut Ui, scene: &Scene) {
        if std::mem::take(&mut self.opens_menu) {
            let at =
                ui.input(|input| input.pointer.hover_pos()).filter(|at| self.view.clip_rect.contains(*at));
            let middle = self.view.clip_rect.center();
            self.menu = Some(at.map_or_else(|| Menu::in_middle(middle), |at| Menu::new(at, None)));
        }
        if let Some(node) = self.wires_of.take() {
            let frame = self.places.drawn.iter().find(|(name, _)| *name == node).map(|(_, frame)| frame.min);
            let at = frame.unwrap_or(self.view.clip_rect.center());
            self.menu = Some(Menu::of_wires(at, scene, &node));
        }
        let Some(mut menu) = self.menu.take() else { return };
        let at = self.to_document(menu.at);
        if menu.show(ui, self.view.clip_rect, scene, &self.places, at) {
            self.menu = Some(menu);
        }
    }

    /// From the document's places to the window's.
    pub(super) fn to_window(&self) -> impl Fn([f64; 2]) -> Pos2 + use<> {
        let (pan, zoom, origin) = (self.view.pan, self.view.zoom, self.view.clip_rect.min);
        move |[x, y]| origin + pan + zoom * vec2(x as f32, y as f32)
    }

    /// From the window's places to the document's.
    pub(super) fn to_document(&self, at: Pos2) -> [f64; 2] {
        let from = (at - self.view.clip_rect.min - self.view.pan) / self.view.zoom;
        [f64::from(from.x), f64::from(from.y)]
    }

    /// Wheel, middle drag, and bringing all into view.
    fn move_view(&mut self, ui: &mut Ui, scene: &Scene) {
        if self.fitted < FRAMES_TO_FIT {
            self.fitted += 1;
            self.bring_into_view(scene);
            ui.ctx().request_repaint();
        }
        self.show_revealed(ui.ctx(), scene);
        let over = ui.rect_contains_pointer(self.view.clip_rect) && self.menu.is_none();
        let (factor, at, delta, pans) = ui.input(|input| {
            let pointer = &input.pointer;
            let pans = pointer.middle_down() || (pointer.primary_down() && input.modifiers.command);
            let factor = (input.smooth_scroll_delta.y * 0.0025).exp() * input.zoom_delta();
            (factor, pointer.hover_pos(), pointer.delta(), pans)
        });
        if let Some(at) = at.filter(|_| over) {
            let zoom = (self.view.zoom * factor).clamp(ZOOM[0].min(self.view.zoom), ZOOM[1]);
            let from = at - self.view.clip_rect.min;
            self.view.pan = from - (from - self.view.pan) * (zoom / self.view.zoom);
            self.view.zoom = zoom;
            if pans {
                self.view.pan += delta;
            }
        }
    }

    /// The package scales a copy of the style, by several steps where it goes no further in one.
    fn scale_style(&mut self, ui: &Ui) {
        let (zoom, clip_rect, mut style) = (self.view.zoom, self.view.clip_rect, ui.style().clone());
        let mut left = zoom;
        loop {
            let step = left.max(ZOOM[0]);
            self.view.zoom = step;
            self.view.zoom(clip_rect, &style, 1.0);
            if step == left {
                break;
            }
            (left, style) = (left / step, self.view.zoomed_style.clone());
        }
        self.view.zoom = zoom;
    }

    /// True if the letters of nodes are too small to read; then nodes show their names alone, in letters of one size.
    pub(super) fn is_far(&self, ui: &Ui) -> bool {
        let body = TextStyle::Body.resolve(ui.style()).size;
        // On screens of a high density smaller letters can be read, down to a limit.
        let sharp = ui.ctx().pixels_per_point().clamp(1.0, 1.5);
        body * self.view.zoom * sharp < FAR_LETTERS
    }

    fn bring_into_view(&mut self, scene: &Scene) {
        let mut all = Rect::NOTHING;
        for node in &scene.document.pipeline().nodes {
            all = all.union(self.places.frame(scene, node));
        }
        for (_, thing) in scene.document.view().annotations() {
            let [at, size] =
                [thing.position, thing.size.unwrap_or_default()].map(|v| vec2(v[0] as f32, v[1] as f32));
            all = all.union(Rect::from_min_size(at.to_pos2(), size));
        }
        if !all.is_finite() || all.is_negative() {
            (self.view.pan, self.view.zoom) = (vec2(20.0, 20.0), 1.0);
            return;
        }
        let room = self.view.clip_rect.size() - vec2(40.0, 40.0);
        self.view.zoom = (room.x / all.width()).min(room.y / all.height()).clamp(MIN_FIT, 1.0);
        self.view.pan = self.view.clip_rect.size() / 2.0 - self.view.zoom * all.center().to_vec2();
    }

    fn is_visible(&self, scene: &Scene, node: &NodeEntry) -> bool {
        let frame = self.places.frame(scene, node);
        let corner = |at: Pos2| self.to_window()([f64::from(at.x), f64::from(at.y)]);
        let frame = Rect::from_min_max(corner(frame.min), corner(frame.max));
        self.view.clip_rect.intersects(frame.expand(20.0))
    }
}
