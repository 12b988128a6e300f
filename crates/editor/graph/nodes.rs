//! Nodes: drawn by the package, moved and selected by the pointer.

use super::package::{self, EyePress, Face, NodeGraph, Pictures, Response};
use super::{Dragged, GraphView};
use crate::scene::{Action, Command, Scene, command_buttons};
use eframe::egui::{
    Color32, EventFilter, FocusDirection, Id, Key, PointerButton, Rect, Response as EguiResponse, Sense,
    Stroke, StrokeKind, Ui, Vec2, WidgetInfo, WidgetType, pos2,
};
use egui_node_editor::{GraphNodeWidget, NodeId, NodeRects, NodeResponse, PortLocations, show_zoomed};
use std::collections::BTreeSet;

/// Menu of a node, for all that are selected.
const NODE_MENU: &[(&str, Command)] = &[
    ("Parameters", Command::Edit),
    ("Wire …", Command::Wire),
    ("Duplicate", Command::Duplicate),
    ("Copy", Command::Copy),
    ("Fold or unfold", Command::Fold),
    ("Show in the picture, or not", Command::Eye),
    ("Frame", Command::Frame),
    ("Delete", Command::Delete),
];

impl GraphView {
    /// Draws the visible nodes and handles the pointer's actions on them and on the ground; returns them as drawn.
    ///
    /// The package's graph is made anew in each frame, with an empty node for each that is out of view: so each node has the key of
    /// its place in the document, by which egui knows it again.
    pub(super) fn nodes(&mut self, ui: &mut Ui, scene: &Scene, pictures: &Pictures) -> NodeGraph {
        let is_far = self.is_far(ui);
        let mut graph = NodeGraph::new();
        let mut order: Vec<(usize, NodeId)> = Vec::new();
        for entry in &scene.document.pipeline().nodes {
            if !self.is_visible(scene, entry) {
                graph.add_node(String::new(), Face::default(), |_, _| {});
                continue;
            }
            let place = self.raised.iter().position(|name| *name == entry.name).map_or(0, |place| place + 1);
            order.push((place, package::add(&mut graph, scene, entry, pictures, self.view.zoom, is_far)));
        }
        order.sort_by_key(|(place, _)| *place);
        let order: Vec<NodeId> = order.into_iter().map(|(_, id)| id).collect();
        let leaves = self.leaves.take();
        if let Some(way) = leaves {
            // From the node that egui takes for the last one in this direction.
            let last = if way == FocusDirection::Next { order.last() } else { order.first() };
            ui.memory_mut(|memory| {
                last.inspect(|id| memory.request_focus(held_by(**id)));
                memory.move_focus(way);
            });
        }
        // Before the nodes, which lie above and take precedence; the focus passes it over.
        let ground = ui.interact(self.view.clip_rect, ui.id().with("ground"), Sense::CLICK | Sense::DRAG);
        let (mut frames, mut ports) = (NodeRects::new(), PortLocations::new());
        let (mut responses, before) = (Vec::new(), std::mem::take(&mut self.places.drawn));
        show_zoomed(ui.style().clone(), self.view.zoomed_style.clone(), ui, |ui| {
            for id in &order {
                let name = graph[*id].user_data.name.clone();
                // The package draws a node larger than it takes hold of it.
                if let Some((_, frame)) = before.iter().find(|(drawn, _)| *drawn == name) {
                    let foot = ui.interact(*frame, ui.id().with(("foot", &name)), Sense::CLICK | Sense::DRAG);
                    if foot.clicked() {
                        responses.extend([NodeResponse::SelectNode(*id), NodeResponse::RaiseNode(*id)]);
                    }
                    node_menu(scene, &name, &foot);
                    if foot.drag_delta() != Vec2::ZERO {
                        responses.push(NodeResponse::MoveNode { node: *id, drag_delta: foot.drag_delta() });
                    }
                }
                let at = scene.document.position(&name).map(|x| x as f32 * self.view.zoom);
                // As if a wire were drawn from its own port: the package's ports then take no part, and this module's do.
                let port = package::drawn_ports(&graph, *id).next().map(|(_, key)| key);
                let widget = GraphNodeWidget {
                    position: &mut pos2(at[0], at[1]),
                    graph: &mut graph,
                    port_locations: &mut ports,
                    node_rects: &mut frames,
                    node_id: *id,
                    ongoing_drag: port.map(|key| (*id, key)),
                    selected: scene.selection.contains(&name),
                    pan: self.view.pan + self.view.clip_rect.min.to_vec2(),
                };
                responses.extend(widget.show(&self.view, ui, &mut ()));
            }
        });
        self.places.write_down(&graph, &order, &frames, &ports, self.view.zoom);
        let before = self.focused;
        let held = |id: &NodeId| (&graph[*id].user_data.name, held_by(*id));
        let held: Vec<(&String, Id)> = order.iter().map(held).collect();
        for (name, id) in &held {
            let Some(response) = ui.ctx().read_response(*id) else { continue };
            self.name_node(ui, scene, name, &response, leaves.is_some());
        }
        if std::mem::take(&mut self.takes_tab) {
            self.gains_focus = true;
            self.follow_tab(ui, scene, scene.selection.first().map(String::as_str));
        }
        self.move_focus(ui, scene.selection, &held, before);
        self.hold_ports(ui, scene);
        let mut selected: Option<BTreeSet<String>> = ground.clicked().then(BTreeSet::new);
        for response in responses {
            self.respond(ui, scene, &graph, response, &mut selected);
        }
        if ground.drag_started_by(PointerButton::Primary) && !ui.input(|input| input.modifiers.command_only())
        {
            self.boxed = ui.input(|input| input.pointer.press_origin());
        }
        if let (Some(from), Some(to)) = (self.boxed, ui.input(|input| input.pointer.hover_pos())) {
            let chosen = Rect::from_two_pos(from, to);
            let gray = |alpha| Color32::from_rgba_unmultiplied(200, 200, 200, alpha);
            ui.painter().rect(chosen, 2.0, gray(20), Stroke::new(3.0, gray(180)), StrokeKind::Middle);
            let inside = self.places.drawn.iter().filter(|(_, frame)| chosen.intersects(*frame));
            selected = Some(inside.map(|(name, _)| name.clone()).collect());
        }
        if !ui.input(|input| input.pointer.primary_down()) {
            self.boxed = None;
        }
        if let Some(mut selected) = selected.filter(|_| self.menu.is_none() && self.wire.is_none()) {
            if ui.input(|input| input.modifiers.shift || input.modifiers.command) {
                selected.extend(scene.selection.iter().cloned());
            }
            scene.actions.push(Action::Select(selected));
        }
        graph
    }

    /// Gives what a pointer takes hold of a node by its name, and the keys: the node that has the focus is the selected one.
    fn name_node(&mut self, ui: &Ui, scene: &Scene, name: &str, response: &EguiResponse, leaves: bool) {
        let is_selected = scene.selection.contains(name);
        let label = format!("node {name}");
        response.widget_info(|| WidgetInfo::selected(WidgetType::SelectableLabel, true, is_selected, &label));
        node_menu(scene, name, response);
        if response.has_focus() && !leaves {
            // Arrows and Tab choose among nodes, also those out of view; arrows do not leave them for the next button.
            let [tab, horizontal_arrows, vertical_arrows, escape] = [true, true, true, false];
            let keys = EventFilter { tab, horizontal_arrows, vertical_arrows, escape };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, keys));
            match self.focused.replace(response.id) == Some(response.id) {
                true => self.follow_tab(ui, scene, Some(name)),
                // Tab comes to the nodes by the first one, whichever egui takes for that.
                false if ui.input(|input| input.key_pressed(Key::Tab) && !input.modifiers.shift) => {
                    let first = scene.document.pipeline().nodes.first();
                    first.inspect(|first| self.choose(scene, &first.name));
                }
                false => scene.actions.push(Action::Select(BTreeSet::from([name.to_string()]))),
            }
        }
    }

    /// The focus goes with the selection where keys choose another node than had it in the last frame, and is lost where no drawn node is
    /// the selected one.
    fn move_focus(
        &mut self,
        ui: &Ui,
        selection: &BTreeSet<String>,
        drawn: &[(&String, Id)],
        before: Option<Id>,
    ) {
        let now = ui.memory(|memory| memory.focused());
        let is_chosen = |(name, _): &&(&String, Id)| selection.len() == 1 && selection.contains(*name);
        let chosen = drawn.iter().find(is_chosen).map(|(_, id)| *id);
        if now.is_some() {
            self.gains_focus = false;
        } else if let Some(chosen) = chosen.filter(|_| std::mem::take(&mut self.gains_focus)) {
            ui.memory_mut(|memory| memory.request_focus(chosen));
            self.focused = Some(chosen);
            return;
        }
        self.focused = self.focused.filter(|id| Some(*id) == now);
        let Some(focused) = self.focused.filter(|id| Some(*id) == before) else { return };
        if chosen != Some(focused) {
            ui.memory_mut(|memory| match chosen {
                Some(chosen) => memory.request_focus(chosen),
                None => memory.surrender_focus(focused),
            });
            self.focused = chosen;
        }
    }

    fn respond(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        graph: &NodeGraph,
        response: Response,
        selected: &mut Option<BTreeSet<String>>,
    ) {
        let name_of = |id: NodeId| graph[id].user_data.name.clone();
        match response {
            NodeResponse::MoveNode { node, drag_delta } => {
                self.drag(ui, scene, &name_of(node), drag_delta);
            }
            NodeResponse::SelectNode(node) => *selected = Some(BTreeSet::from([name_of(node)])),
            NodeResponse::User(EyePress(name)) => {
                scene.actions.push(Action::ToggleEyes([name].into()));
            }
            NodeResponse::RaiseNode(node) => {
                let name = name_of(node);
                self.raised.retain(|known| *known != name);
                self.raised.push(name);
            }
            // Wires are drawn, and nodes are made and deleted, by this module's own hand.
            _ => {}
        }
    }

    fn drag(&mut self, ui: &Ui, scene: &Scene, name: &str, delta: Vec2) {
        if ui.input(|input| input.pointer.button_down(PointerButton::Middle)) {
            return;
        }
        self.dragged.get_or_insert_with(|| {
            let alone = BTreeSet::from([name.to_string()]);
            let with = if scene.selection.contains(name) { scene.selection } else { &alone };
            let at = |name: &String| (name.clone(), scene.document.position(name));
            Dragged { nodes: with.iter().map(at).collect(), ..Dragged::default() }
        });
        self.carry(scene, delta);
    }
}

/// The package's key of what a pointer takes hold of a node by.
fn held_by(node: NodeId) -> Id {
    Id::new((node, "window"))
}

/// The menu of a node, by the right button at what a pointer takes hold of it by.
fn node_menu(scene: &Scene, name: &str, held: &EguiResponse) {
    if held.secondary_clicked() {
        // Its commands are for nodes, those that are selected or this one.
        let alone = BTreeSet::from([name.to_string()]);
        let nodes = if scene.selection.contains(name) { scene.selection } else { &alone };
        scene.actions.push(Action::Select(nodes.clone()));
    }
    held.context_menu(|ui| {
        if scene.pictures().contains(&name) && ui.button("Show its picture").clicked() {
            scene.actions.push(Action::Show(name.to_string()));
            ui.close();
        }
        command_buttons(ui, scene.actions, NODE_MENU);
    });
}
