//! Wires: curves from outputs to inputs, in the colour of what runs through them.

use super::places::{Places, Port};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::layers::ShapeIdx;
use eframe::egui::{Color32, Pos2, Shape, Stroke, Ui, vec2};
use std::rc::Rc;
use voltet_core::{Error, Result};
use voltet_document::{Edit, links};
use voltet_graph::NodeEntry;

/// A wire in the hand.
#[derive(Debug, Clone)]
pub(super) struct DraggedWire {
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
    in_hand: Option<&DraggedWire>,
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

/// Edit that connects two ports.
///
/// Errors: the ports do not fit.
pub(super) fn connect_edit(scene: &Scene, held: &Port, target: &Port) -> Result<Edit> {
    let (from, to) = match (held.is_input, target.is_input) {
        (false, true) => (held, target),
        (true, false) => (target, held),
        (false, false) => {
            return Err(Error::usage("both are outputs: a wire leads from an output to an input"));
        }
        (true, true) => return Err(Error::usage("both are inputs: a wire leads from an output to an input")),
    };
    scene.document.join(scene.registry, (&from.node, &from.name), (&to.node, &to.name))
}

/// Type and summary of a port, and the values of its wires.
pub(super) fn port_description(scene: &Scene, port: &Port) -> String {
    let entry = scene.entry(&port.node);
    let node = entry.and_then(|entry| scene.node_type(entry));
    let declared = node.and_then(|node| {
        let mut all = node.all_inputs().chain(node.outputs);
        all.find(|declared| declared.name == port.name && declared.port_type == port.port_type)
    });
    let summary = declared.map_or("", |declared| declared.summary);
    let side = match (port.is_input, port.is_optional) {
        (true, true) => "optional input",
        (true, false) => "input",
        (false, _) => "output",
    };
    let nodes = &scene.document.pipeline().nodes;
    let sources: Vec<String> = match port.is_input {
        false => vec![format!("{}.{}", port.node, port.name)],
        true => entry
            .and_then(|entry| entry.inputs.iter().find(|link| link.port == port.name))
            .map(|link| links::sources(link).map(|text| full_source(scene, text, nodes)).collect())
            .unwrap_or_default(),
    };
    let runs: Vec<String> = sources
        .iter()
        .filter_map(|source| {
            let value = scene.values.get(source)?;
            Some(if port.is_input { format!("from {source}: {value}") } else { value.clone() })
        })
        .collect();
    let mut text = format!("{} ({}, {side})\n{summary}", port.name, port.port_type.name());
    if !runs.is_empty() {
        text += &format!("\n{}", runs.join("\n"));
    } else if sources.is_empty() {
        text += "\nnot wired";
    }
    text
}

/// Source of a wire as "node.port", with the port if the file leaves it out.
fn full_source(scene: &Scene, text: &str, nodes: &[NodeEntry]) -> String {
    let (name, output) = links::source(text, nodes);
    let first = || {
        let entry = scene.entry(name)?;
        Some(scene.node_type(entry)?.outputs.first()?.name)
    };
    format!("{name}.{}", output.or_else(first).unwrap_or_default())
}
