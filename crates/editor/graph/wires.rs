//! Wires: curves from outputs to inputs, in the colour of what runs through them. One in a hand begins at a port, and ends at another, on
//! empty space, or where it does not fit, with the reason.

use super::menu::Menu;
use super::package::Port;
use super::wire_list::taking_off;
use super::{DraggedWire, GraphView, NEAR};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::layers::ShapeIdx;
use eframe::egui::{
    Color32, PointerButton, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, WidgetType,
    vec2,
};
use voltet_core::{Error, Result};
use voltet_document::{Edit, links};

/// Width and height in which a pointer takes hold of a port, points at the usual scale: no higher than ports are apart.
const PORT: Vec2 = Vec2::new(2.0 * NEAR, 16.0);

/// Distance from a wire within which a pointer means it, points, and the pieces that it is measured by.
const WIRE: f32 = 6.0;
const SAMPLES: usize = 32;

impl GraphView {
    /// Draws them where `at` was kept free, behind the nodes.
    pub(super) fn wires(&mut self, ui: &Ui, at: ShapeIdx, scene: &Scene) {
        self.drawn_wires.clear();
        let (dark, clip, to_window) = (ui.visuals().dark_mode, ui.clip_rect(), self.to_window());
        let taken_off = self.wire.as_ref().and_then(|wire| wire.taken_off.as_ref());
        let mut shapes = Vec::new();
        for entry in &scene.document.pipeline().nodes {
            for (link, text) in
                entry.inputs.iter().flat_map(|link| links::sources(link).map(move |text| (link, text)))
            {
                if taken_off.is_some_and(|(node, port, source)| {
                    *node == entry.name && *port == link.port && source == text
                }) {
                    continue;
                }
                let (feeding, output, given) = scene.giving(text);
                let Some(feeding) = scene.entry(feeding) else { continue };
                let color = given.map_or(theme::wrong(dark), |port| theme::port_color(port.port_type, dark));
                let from = to_window(self.places.port(scene, feeding, output, false));
                let to = to_window(self.places.port(scene, entry, &link.port, true));
                let selected =
                    [&feeding.name, &entry.name].iter().any(|name| scene.selection.contains(*name));
                let (width, color) = if selected { (3.0, color) } else { (2.0, color.gamma_multiply(0.75)) };
                let curve =
                    curve(from, to, Stroke::new(width * self.view.zoom.max(0.5), color), self.view.zoom);
                if curve.visual_bounding_rect().intersects(clip) {
                    let names = [&entry.name, &link.port, text].map(str::to_string);
                    self.drawn_wires.push((curve.clone(), names));
                    shapes.push(Shape::CubicBezier(curve));
                }
            }
        }
        ui.painter().set(at, Shape::Vec(shapes));
        if let (Some(DraggedWire { port, .. }), Some(pointer)) =
            (&self.wire, ui.input(|input| input.pointer.interact_pos()))
            && let Some(entry) = scene.entry(&port.node)
        {
            let own = to_window(self.places.port(scene, entry, port.declared.name, port.is_input));
            let (from, to) = if port.is_input { (pointer, own) } else { (own, pointer) };
            let stroke = Stroke::new(2.5, theme::port_color(port.declared.port_type, dark));
            ui.painter().add(Shape::CubicBezier(curve(from, to, stroke, self.view.zoom)));
        }
    }

    /// The wire that a pointer at a place of the window means: its words and the edit that takes it off.
    pub(super) fn wire_at(&self, at: Pos2) -> Option<(String, Edit)> {
        let distance = |curve: &CubicBezierShape| {
            let along = (0..=SAMPLES).map(|i| curve.sample(i as f32 / SAMPLES as f32));
            let points: Vec<Pos2> = along.collect();
            let of_piece = |piece: &[Pos2]| {
                let (way, from) = (piece[1] - piece[0], at - piece[0]);
                let share = (from.dot(way) / way.length_sq().max(1e-6)).clamp(0.0, 1.0);
                (from - share * way).length()
            };
            points.windows(2).map(of_piece).fold(f32::INFINITY, f32::min)
        };
        let by_distance = self.drawn_wires.iter().map(|(curve, names)| (distance(curve), names));
        let near = by_distance.filter(|(distance, _)| *distance <= WIRE);
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, [node, port, source])| taking_off(node, port, source))
    }

    /// Takes hold of the ports: a drag begins a wire. Called after the nodes, on which they lie.
    pub(super) fn hold_ports(&mut self, ui: &Ui, scene: &Scene) {
        let size = PORT * self.view.zoom;
        for (port, at) in self.places.seen.clone() {
            let id = ui.id().with(("port", &port.node, port.declared.name, port.is_input));
            let response = ui.interact(Rect::from_center_size(at, size), id, Sense::CLICK | Sense::DRAG);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, port.full_name()));
            if response.drag_started_by(PointerButton::Primary) {
                self.begin_wire(scene, &port);
            }
            response.context_menu(|ui| {
                if ui.button("Add a node that fits …").clicked() {
                    self.menu = Some(Menu::new(at, Some(port.clone())));
                    ui.close();
                }
                if ui.button("Wire …").clicked() {
                    self.wires_of = Some(port.node.clone());
                    ui.close();
                }
            });
        }
    }

    /// A wire begins. One that is drawn from a fed input is taken off from it.
    fn begin_wire(&mut self, scene: &Scene, port: &Port) {
        let fed = || {
            let entry = scene.entry(&port.node).filter(|_| port.is_input)?;
            let name = port.declared.name;
            let text = links::sources(entry.inputs.iter().find(|link| link.port == name)?).last()?;
            let (node, _, given) = scene.giving(text);
            let held = Port { node: node.into(), declared: given?, is_input: false, is_optional: false };
            Some(DraggedWire { port: held, taken_off: Some((port.node.clone(), name, text.into())) })
        };
        self.wire = Some(fed().unwrap_or_else(|| DraggedWire { port: port.clone(), taken_off: None }));
    }

    /// The wire in the hand: what it would do here, and what it does when let go.
    pub(super) fn joining(&mut self, ui: &mut Ui, scene: &Scene) {
        let Some(wire) = &self.wire else { return };
        let Some(at) = ui.input(|input| input.pointer.interact_pos()) else { return };
        let target = self.places.port_at(at, NEAR * self.view.zoom.max(0.6));
        let is_own = |port: &Port| {
            let end = wire.taken_off.as_ref().filter(|_| port.is_input);
            let is_end = end.is_some_and(|(node, name, _)| (node, *name) == (&port.node, port.declared.name));
            *port == wire.port || is_end
        };
        let edit = target.filter(|port| !is_own(port)).map(|port| connect_edit(scene, &wire.port, port));
        if ui.input(|input| input.pointer.any_down()) {
            let words = match (target, &edit) {
                (Some(port), Some(Ok(_))) => {
                    RichText::new(format!("to {}.{}", port.node, port.declared.name))
                }
                (_, Some(Err(error))) => {
                    RichText::new(error.to_string()).color(theme::wrong(ui.visuals().dark_mode))
                }
                _ => return,
            };
            theme::words_at_pointer(ui, "joining", words);
            return;
        }
        let is_free = target.is_none();
        let Some(DraggedWire { port, taken_off }) = self.wire.take() else { return };
        let disconnect = taken_off.map(|(node, port, source)| Edit::Disconnect {
            node,
            port: port.into(),
            source: Some(source),
        });
        match (edit, disconnect) {
            (Some(Ok(edit)), disconnect) => {
                scene.actions.edits(edit.label(), disconnect.into_iter().chain([edit]).collect());
            }
            (Some(Err(error)), _) => scene.actions.say(error),
            (None, Some(edit)) if is_free => scene.actions.edit(edit),
            (None, None)
                if is_free && self.view.clip_rect.contains(at) && self.places.node_at(at).is_none() =>
            {
                self.menu = Some(Menu::new(at, Some(port)));
            }
            (None, _) => {}
        }
    }
}

fn curve(from: Pos2, to: Pos2, stroke: Stroke, zoom: f32) -> CubicBezierShape {
    let bend = ((to.x - from.x).abs() * 0.5).clamp(20.0 * zoom, 160.0 * zoom);
    let points = [from, from + vec2(bend, 0.0), to - vec2(bend, 0.0), to];
    CubicBezierShape::from_points_stroke(points, false, Color32::TRANSPARENT, stroke)
}

/// Edit that connects two ports. Errors: the ports do not fit.
fn connect_edit(scene: &Scene, held: &Port, target: &Port) -> Result<Edit> {
    let (from, to) = match (held.is_input, target.is_input) {
        (false, true) => (held, target),
        (true, false) => (target, held),
        (is_input, _) => {
            let both = if is_input { "inputs" } else { "outputs" };
            return Err(Error::usage(format!("both are {both}: a wire leads from an output to an input")));
        }
    };
    scene.document.join(scene.registry, (&from.node, from.declared.name), (&to.node, to.declared.name))
}
