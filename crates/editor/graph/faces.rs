//! The visible nodes as the package is given them, made from the document each frame.

use super::face::Face;
use super::package::{End, NoValue};
use super::places::Port;
use super::{GraphView, Pictures};
use crate::scene::Scene;
use eframe::egui::{Ui, pos2};
use egui_node_graph2::{AnyParameterId, InputParamKind, NodeId};
use std::collections::BTreeSet;
use std::rc::Rc;
use voltet_graph::{Node, NodeEntry};

/// Letters of a name that fit beside the time.
const LETTERS: usize = 17;

impl GraphView {
    /// Makes the package's graph that of the visible nodes.
    pub(super) fn sync(&mut self, ui: &Ui, scene: &Scene, pictures: &Pictures, visible: &BTreeSet<String>) {
        let gone: Vec<String> = self.ids.keys().filter(|name| !visible.contains(*name)).cloned().collect();
        gone.iter().for_each(|name| self.forget(name));
        let is_same = self.ported.replace(scene.document.revision()) == Some(scene.document.revision());
        let is_far = self.is_far(ui);
        for name in visible {
            let Some(entry) = scene.entry(name) else { continue };
            let node = scene.node_type(entry);
            let view = scene.document.view().nodes.get(name);
            let is_folded = view.is_some_and(|view| view.folded);
            let id = match self.ids.get(name).copied().filter(|_| is_same) {
                Some(id) => id,
                None => self.with_ports(name, if is_folded { Vec::new() } else { ports(entry, node) }),
            };
            let at = scene.document.position(name);
            self.state.node_positions.insert(id, pos2(at[0] as f32 * self.zoom, at[1] as f32 * self.zoom));
            if let Some(shown) = self.state.graph.nodes.get_mut(id) {
                shown.user_data = face(scene, entry, node, pictures);
                shown.label = if is_far { String::new() } else { shortened(name) };
            }
        }
        let joined: Vec<_> = self.state.graph.connections.keys().collect();
        for input in joined {
            if let Some(outputs) = self.state.graph.connections.get_mut(input) {
                outputs.clear();
            }
        }
        self.state.pan_zoom.pan = self.pan;
        // A selection made elsewhere; while a hand is at work the package's own holds.
        if !ui.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
            self.state.selected_nodes =
                scene.selection.iter().filter_map(|name| self.ids.get(name).copied()).collect();
        }
    }

    /// The node of that name with these ports: another type has others, a folded node none.
    fn with_ports(&mut self, name: &str, ports: Vec<Port>) -> NodeId {
        if let Some(id) = self.ids.get(name).copied() {
            if self.has_ports(id, &ports) {
                return id;
            }
            self.forget(name);
        }
        self.add(name, ports)
    }

    fn has_ports(&self, id: NodeId, ports: &[Port]) -> bool {
        let Some(node) = self.state.graph.nodes.get(id) else { return false };
        let inputs = node.inputs.iter().map(|(_, id)| AnyParameterId::Input(*id));
        let ends = inputs.chain(node.outputs.iter().map(|(_, id)| AnyParameterId::Output(*id)));
        ends.map(|end| self.ports.get(&end).map(|port| &**port)).eq(ports.iter().map(Some))
    }

    fn add(&mut self, name: &str, ports: Vec<Port>) -> NodeId {
        let face = Face { name: name.to_string(), ..Face::default() };
        let id = self.state.graph.add_node(name.to_string(), face, |_, _| {});
        for port in ports {
            let end = End { port_type: port.port_type, is_input: port.is_input };
            let key = match port.is_input {
                true => AnyParameterId::Input(self.state.graph.add_input_param(
                    id,
                    port.name.clone(),
                    end,
                    NoValue,
                    InputParamKind::ConnectionOnly,
                    true,
                )),
                false => {
                    AnyParameterId::Output(self.state.graph.add_output_param(id, port.name.clone(), end))
                }
            };
            self.ports.insert(key, Rc::new(port));
        }
        self.ids.insert(name.to_string(), id);
        self.state.node_order.push(id);
        id
    }

    fn forget(&mut self, name: &str) {
        let Some(id) = self.ids.remove(name) else { return };
        self.state.graph.remove_node(id);
        self.state.node_positions.remove(id);
        self.state.node_order.retain(|other| *other != id);
        self.state.selected_nodes.retain(|other| *other != id);
        if self.state.connection_in_progress.is_some_and(|(node, _)| node == id) {
            self.state.connection_in_progress = None;
        }
        self.ports.retain(|_, port| port.node != name);
    }
}

/// The ports of a node in the order in which they are shown; those that its wires name where its type is not known.
fn ports(entry: &NodeEntry, node: Option<&'static Node>) -> Vec<Port> {
    let Some(node) = node else { return Vec::new() };
    let of = |port: &voltet_graph::Port, is_input: bool, is_optional: bool| Port {
        node: entry.name.clone(),
        name: port.name.to_string(),
        port_type: port.port_type,
        is_input,
        is_optional,
    };
    let inputs = node.inputs.iter().map(|port| of(port, true, false));
    let optional = node.optional_inputs.iter().map(|port| of(port, true, true));
    inputs.chain(optional).chain(node.outputs.iter().map(|port| of(port, false, false))).collect()
}

fn face(scene: &Scene, entry: &NodeEntry, node: Option<&'static Node>, pictures: &Pictures) -> Face {
    let status = scene.nodes.get(&entry.name);
    let is_at = |error: &&voltet_core::Error| error.location.node.as_deref() == Some(&entry.name);
    let fault = scene.faults.iter().find(is_at).or(scene.failure.as_ref().filter(is_at));
    let view = scene.document.view().nodes.get(&entry.name);
    let texture = pictures(&entry.name);
    Face {
        name: entry.name.clone(),
        node_type: entry.node_type.text().unwrap_or("no type").to_string(),
        summary: node.map_or(String::new(), |node| node.summary.to_string()),
        state: status.map(|status| status.state.clone()),
        seconds: status.and_then(|status| status.seconds),
        idle: status.is_none().then(|| idle(scene, node)),
        fault: fault.map(|error| {
            error.what.clone() + &error.got.as_ref().map_or(String::new(), |f| format!(": {f}"))
        }),
        picture: texture
            .map(|texture| (texture.id(), texture.size_vec2().x / texture.size_vec2().y.max(1.0))),
        is_folded: view.is_some_and(|view| view.folded),
        remark: view.and_then(|view| view.remark.clone()),
    }
}

/// Reason why a node does not run for the picture.
fn idle(scene: &Scene, node: Option<&'static Node>) -> String {
    match (node, scene.shown_node) {
        (None, _) => "its type is not known".into(),
        (Some(node), _) if node.outputs.is_empty() => {
            "it writes a file, which a run does and the window never".into()
        }
        (Some(_), Some(shown)) => format!("nothing of it leads to the picture of '{shown}'"),
        (Some(_), None) => "no picture is shown".into(),
    }
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= LETTERS {
        return name.to_string();
    }
    name.chars().take(LETTERS - 1).chain(['…']).collect()
}
