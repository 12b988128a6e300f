//! Wires in a hand: begun at a port, ended at another, on empty space, or where they do not fit, with the reason.

use super::menu::Menu;
use super::places::Port;
use super::wires::{DraggedWire, connect_edit};
use super::{GraphView, NEAR};
use crate::actions::{Action, Actions};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{self, Rect, RichText, Ui};
use egui_node_graph2::AnyParameterId;
use std::rc::Rc;
use voltet_document::{Edit, links};

impl GraphView {
    /// A wire begins. One that is drawn from a fed input is taken off from it.
    pub(super) fn begin_wire(&mut self, scene: &Scene, end: AnyParameterId) {
        let Some(port) = self.ports.get(&end).cloned() else { return };
        let from =
            self.places.seen.iter().find(|(seen, _)| *seen == port).map(|(_, at)| *at).unwrap_or_default();
        self.wire = Some(DraggedWire { node: port.node.clone(), port: port.clone(), taken_off: None, from });
        if !port.is_input {
            return;
        }
        let Some(entry) = scene.entry(&port.node) else { return };
        let nodes = &scene.document.pipeline().nodes;
        let Some(link) = entry.inputs.iter().find(|link| link.port == port.name) else { return };
        let Some(text) = links::sources(link).last().map(str::to_string) else { return };
        let (feeding, output) = links::source(&text, nodes);
        let Some(feeding) = scene.entry(feeding) else { return };
        let Some(given) = scene.node_type(feeding).and_then(|node| match output {
            Some(output) => node.outputs.iter().find(|port| port.name == output),
            None => node.outputs.first(),
        }) else {
            return;
        };
        let taken_off = Some((port.node.clone(), port.name.clone(), text.clone()));
        let held = Rc::new(Port {
            node: feeding.name.clone(),
            name: given.name.to_string(),
            port_type: given.port_type,
            is_input: false,
            is_optional: false,
        });
        let key = self.ports.iter().find(|(_, known)| **known == held).map(|(key, _)| *key);
        if let (Some(key), Some(id)) = (key, self.ids.get(&held.node)) {
            self.state.connection_in_progress = Some((*id, key));
        }
        let from = self.places.seen.iter().find(|(seen, _)| *seen == held).map(|(_, at)| *at).unwrap_or(from);
        self.wire = Some(DraggedWire { node: held.node.clone(), port: held, taken_off, from });
    }

    /// A wire ends at a port that fits.
    pub(super) fn end_wire(&mut self, scene: &Scene, from: &Port, to: &Port, actions: &mut Actions) {
        let mut edits = Vec::new();
        let taken_off = self.wire.take().and_then(|wire| wire.taken_off);
        if let Some((node, port, source)) = taken_off {
            if node == to.node && port == to.name {
                return;
            }
            edits.push(Edit::Disconnect { node, port, source: Some(source) });
        }
        match connect_edit(scene, from, to) {
            Ok(connect) => {
                let label = connect.label();
                edits.push(connect);
                actions.edits(label, edits);
            }
            Err(error) => actions.push(Action::Say(error.to_string())),
        }
    }

    /// The wire in the hand: what it would do here, and what it does when let go.
    pub(super) fn joining(&mut self, ui: &mut Ui, rect: Rect, scene: &Scene, actions: &mut Actions) {
        let Some(wire) = self.wire.clone() else { return };
        let Some(at) = ui.input(|input| input.pointer.interact_pos()) else { return };
        let is_held = ui.input(|input| input.pointer.any_down());
        let dark = ui.visuals().dark_mode;
        let target = self.places.port_at(at, NEAR * self.zoom.max(0.6));
        let reason = target.as_ref().filter(|target| **target != wire.port).and_then(|target| {
            let back = wire
                .taken_off
                .as_ref()
                .is_some_and(|(node, port, _)| *node == target.node && *port == target.name);
            connect_edit(scene, &wire.port, target).err().filter(|_| !back).map(|error| error.to_string())
        });
        if is_held {
            let words = match (&target, &reason) {
                (Some(_), Some(reason)) => Some(RichText::new(reason).color(theme::wrong(dark))),
                (Some(target), None) if *target != wire.port => {
                    Some(RichText::new(format!("to {}.{}", target.node, target.name)))
                }
                _ => None,
            };
            if let Some(words) = words {
                egui::show_tooltip_at_pointer(ui.ctx(), ui.layer_id(), ui.id().with("joining"), |ui| {
                    ui.label(words)
                });
            }
            return;
        }
        self.wire = None;
        self.state.connection_in_progress = None;
        match (target, reason) {
            (Some(_), Some(reason)) => actions.push(Action::Say(reason)),
            (Some(target), None) if target != wire.port => {
                let (from, to) = if target.is_input { (&wire.port, &target) } else { (&target, &wire.port) };
                self.wire = Some(wire.clone());
                self.end_wire(scene, from, to, actions);
            }
            (Some(_), None) => {}
            (None, _) => match wire.taken_off {
                Some((node, port, source)) => {
                    actions.edit(Edit::Disconnect { node, port, source: Some(source) });
                }
                None if rect.contains(at) && self.places.node_at(at).is_none() => {
                    self.menu = Some(Menu::new(at, Some(wire.port)));
                }
                None => {}
            },
        }
    }
}
