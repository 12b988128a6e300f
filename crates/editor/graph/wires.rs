//! Wires: curves from outputs to inputs, in the colour of what runs through them.

use super::places::{Places, Port};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::layers::ShapeIdx;
use eframe::egui::{Color32, Pos2, Shape, Stroke, Ui, vec2};
use std::rc::Rc;
use voltet_document::links;

/// A wire in the hand.
#[derive(Debug, Clone)]
pub(super) struct InHand {
    /// The node that it is held by.
    pub node: String,
    pub port: Rc<Port>,
    /// The input that it was taken off from, and its source as the file says it.
    pub taken_off: Option<(String, String, String)>,
    pub from: Pos2,
}

/// Draws them where `at` was kept free, behind the nodes.
pub(super) fn draw(
    ui: &Ui,
    at: ShapeIdx,
    scene: &Scene,
    places: &Places,
    in_hand: Option<&InHand>,
    to_window: impl Fn([f64; 2]) -> Pos2,
    zoom: f32,
) {
    let dark = ui.visuals().dark_mode;
    let clip = ui.clip_rect();
    let nodes = &scene.document.pipeline().nodes;
    let mut shapes = Vec::new();
    for entry in nodes {
        for link in &entry.inputs {
            for text in links::sources(link) {
                let taken_off = in_hand.and_then(|wire| wire.taken_off.as_ref());
                if taken_off.is_some_and(|(node, port, source)| {
                    *node == entry.name && *port == link.port && source == text
                }) {
                    continue;
                }
                let (feeding, output) = links::source(text, nodes);
                let Some(feeding) = scene.entry(feeding) else { continue };
                let outputs = scene.node_type(feeding).map_or(&[][..], |node| node.outputs);
                let given = match output {
                    Some(name) => outputs.iter().find(|port| port.name == name),
                    None => outputs.first(),
                };
                let name = given.map_or("", |port| port.name);
                let color = given.map_or(theme::wrong(dark), |port| theme::port_color(port.port_type, dark));
                let from = to_window(places.port(scene, feeding, name, false));
                let to = to_window(places.port(scene, entry, &link.port, true));
                let selected =
                    [&feeding.name, &entry.name].iter().any(|name| scene.selection.contains(*name));
                let width = if selected { 3.0 } else { 2.0 };
                let color = if selected { color } else { color.gamma_multiply(0.75) };
                let curve = curve(from, to, Stroke::new(width * zoom.max(0.5), color), zoom);
                if curve.visual_bounding_rect().intersects(clip) {
                    shapes.push(curve);
                }
            }
        }
    }
    ui.painter().set(at, Shape::Vec(shapes));
    if let (Some(wire), Some(pointer)) = (in_hand, ui.input(|input| input.pointer.interact_pos())) {
        let color = theme::port_color(wire.port.port_type, dark);
        let ends = if wire.port.is_input { (pointer, wire.from) } else { (wire.from, pointer) };
        ui.painter().add(curve(ends.0, ends.1, Stroke::new(2.5, color), zoom));
    }
}

fn curve(from: Pos2, to: Pos2, stroke: Stroke, zoom: f32) -> Shape {
    let bend = ((to.x - from.x).abs() * 0.5).clamp(20.0 * zoom, 160.0 * zoom);
    let points = [from, from + vec2(bend, 0.0), to - vec2(bend, 0.0), to];
    Shape::CubicBezier(CubicBezierShape::from_points_stroke(points, false, Color32::TRANSPARENT, stroke))
}
