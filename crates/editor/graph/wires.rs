//! Wires: curves from outputs to inputs, in the colour of what runs through them; begun at a port, ended at another, on empty space,
//! or where they do not fit, with the reason.

use super::places::{Places, Port};
use crate::actions::{Action, Actions};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::{self, Color32, Pos2, RichText, Shape, Stroke, Ui, vec2};
use voltet_core::{Error, Result};
use voltet_document::{Edit, links};
use voltet_graph::NodeEntry;

/// A wire in the hand.
#[derive(Debug, Clone)]
pub(super) struct DraggedWire {
    /// The port that it is held by.
    pub port: Port,
    /// The input that it was taken off from, and its source as the file says it.
    taken_off: Option<(String, String, String)>,
}

/// End of a wire in a hand.
pub(super) enum WireEnd {
    /// It is held still.
    Held,
    /// It was let go of at a node or a port, or was taken off.
    Done,
    /// It was let go of over the ground: a node may be added to it.
    OnGround,
}

/// The output that a wire comes from: its node and its port.
fn output<'a>(
    scene: &Scene<'a>,
    source: &str,
) -> Option<(&'a NodeEntry, Option<&'static voltet_graph::Port>)> {
    let (name, port) = links::source(source, &scene.document.pipeline().nodes);
    let entry = scene.entry(name)?;
    let outputs = scene.node_type(entry).map_or(&[][..], |node| node.outputs);
    let port = match port {
        Some(name) => outputs.iter().find(|port| port.name == name),
        None => outputs.first(),
    };
    Some((entry, port))
}

impl DraggedWire {
    /// A wire that begins at a port. One that is drawn from a fed input is taken off from it.
    pub fn new(scene: &Scene, port: &Port) -> DraggedWire {
        let link = scene.entry(&port.node).filter(|_| port.is_input);
        let link = link.and_then(|entry| entry.inputs.iter().find(|link| link.port == port.name));
        let source = link.and_then(|link| links::sources(link).last());
        let held = source.and_then(|source| {
            let (node, given) = output(scene, source)?;
            let given = given?;
            let port = Port {
                node: node.name.clone(),
                name: given.name,
                port_type: given.port_type,
                is_input: false,
                is_optional: false,
            };
            Some((port, source.to_string()))
        });
        match held {
            Some((held, source)) => {
                let taken_off = Some((port.node.clone(), port.name.to_string(), source));
                DraggedWire { port: held, taken_off }
            }
            None => DraggedWire { port: port.clone(), taken_off: None },
        }
    }

    fn is_from(&self, node: &str, port: &str) -> bool {
        self.taken_off.as_ref().is_some_and(|(of, input, _)| of == node && input == port)
    }

    /// Says what the wire would do here while it is held, and does it when it is let go of. `target`: the port at the pointer.
    pub fn hold(&self, ui: &Ui, scene: &Scene, target: Option<&Port>, actions: &mut Actions) -> WireEnd {
        let target = target.filter(|target| **target != self.port);
        let edit = target
            .filter(|target| !self.is_from(&target.node, target.name))
            .map(|target| (target, connect_edit(scene, &self.port, target)));
        if ui.input(|input| input.pointer.any_down()) {
            let words = edit.map(|(target, edit)| match edit {
                Err(reason) => RichText::new(reason.to_string()).color(theme::wrong(ui.visuals().dark_mode)),
                Ok(_) => RichText::new(format!("to {}.{}", target.node, target.name)),
            });
            if let Some(words) = words {
                egui::show_tooltip_at_pointer(ui.ctx(), ui.layer_id(), ui.id().with("joining"), |ui| {
                    ui.label(words)
                });
            }
            return WireEnd::Held;
        }
        let take_off = self.taken_off.clone().map(|(node, port, source)| Edit::Disconnect {
            node,
            port,
            source: Some(source),
        });
        match (edit, take_off) {
            (Some((_, Ok(connect))), take_off) => {
                actions.edits(connect.label(), take_off.into_iter().chain([connect]).collect());
            }
            (Some((_, Err(reason))), _) => actions.push(Action::Say(reason.to_string())),
            (None, Some(take_off)) if target.is_none() => actions.edit(take_off),
            (None, None) if target.is_none() => return WireEnd::OnGround,
            (None, _) => {}
        }
        WireEnd::Done
    }
}

/// Draws the wires, behind the nodes.
pub(super) fn draw(ui: &Ui, scene: &Scene, places: &Places, in_hand: Option<&DraggedWire>, zoom: f32) {
    let dark = ui.visuals().dark_mode;
    for entry in &scene.document.pipeline().nodes {
        for link in &entry.inputs {
            for text in links::sources(link) {
                let is_in_hand = in_hand.and_then(|wire| wire.taken_off.as_ref());
                if is_in_hand.is_some_and(|(node, port, source)| {
                    *node == entry.name && *port == link.port && source == text
                }) {
                    continue;
                }
                let Some((feeding, given)) = output(scene, text) else { continue };
                let color = given.map_or(theme::wrong(dark), |port| theme::port_color(port.port_type, dark));
                let from = places.port(&feeding.name, given.map_or("", |port| port.name), false);
                let (Some(from), Some(to)) = (from, places.port(&entry.name, &link.port, true)) else {
                    continue;
                };
                let selected =
                    [&feeding.name, &entry.name].iter().any(|name| scene.selection.contains(*name));
                let width = if selected { 3.0 } else { 2.0 };
                let color = if selected { color } else { color.gamma_multiply(0.75) };
                let curve = curve(from, to, Stroke::new(width * zoom.max(0.5), color), zoom);
                if curve.visual_bounding_rect().intersects(ui.clip_rect()) {
                    ui.painter().add(curve);
                }
            }
        }
    }
    if let (Some(wire), Some(pointer)) = (in_hand, ui.input(|input| input.pointer.interact_pos())) {
        let port = &wire.port;
        let at = places.port(&port.node, port.name, port.is_input).unwrap_or(pointer);
        let (from, to) = if port.is_input { (pointer, at) } else { (at, pointer) };
        ui.painter().add(curve(from, to, Stroke::new(2.5, theme::port_color(port.port_type, dark)), zoom));
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
fn connect_edit(scene: &Scene, held: &Port, target: &Port) -> Result<Edit> {
    let (from, to) = match (held.is_input, target.is_input) {
        (false, true) => (held, target),
        (true, false) => (target, held),
        (false, false) => {
            return Err(Error::usage("both are outputs: a wire leads from an output to an input"));
        }
        (true, true) => return Err(Error::usage("both are inputs: a wire leads from an output to an input")),
    };
    scene.document.join(scene.registry, (&from.node, from.name), (&to.node, to.name))
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
