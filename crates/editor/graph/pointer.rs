//! Moving and selecting nodes with the pointer.

use super::GraphView;
use super::face::Face;
use super::package::{NoResponse, State};
use crate::actions::{Action, Actions};
use crate::scene::Scene;
use eframe::egui::{PointerButton, Ui, Vec2};
use egui_node_graph2::{AnyParameterId, NodeId, NodeResponse};
use std::collections::BTreeSet;
use voltet_document::Edit;

impl GraphView {
    /// Handles the pointer's action on a node.
    pub(super) fn respond(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        response: NodeResponse<NoResponse, Face>,
        actions: &mut Actions,
    ) {
        let name_of =
            |state: &State, id: NodeId| state.graph.nodes.get(id).map(|node| node.user_data.name.clone());
        match response {
            NodeResponse::MoveNode { node, drag_delta } => {
                let Some(name) = name_of(&self.state, node) else { return };
                self.drag(ui, scene, &name, drag_delta, actions);
            }
            NodeResponse::ConnectEventStarted(_, end) => self.begin_wire(scene, end),
            NodeResponse::ConnectEventEnded { output, input, .. } => {
                let ends = [AnyParameterId::Output(output), AnyParameterId::Input(input)];
                if let [Some(from), Some(to)] = ends.map(|end| self.ports.get(&end).cloned()) {
                    self.end_wire(scene, &from, &to, actions);
                }
                self.wire = None;
            }
            NodeResponse::CreatedNode(_)
            | NodeResponse::SelectNode(_)
            | NodeResponse::DeleteNodeUi(_)
            | NodeResponse::DeleteNodeFull { .. }
            | NodeResponse::DisconnectEvent { .. }
            | NodeResponse::RaiseNode(_)
            | NodeResponse::User(_) => {}
        }
    }

    /// A node is dragged, with all that are selected if it is.
    fn drag(&mut self, ui: &Ui, scene: &Scene, name: &str, delta: Vec2, actions: &mut Actions) {
        if ui.input(|input| input.pointer.button_down(PointerButton::Middle)) {
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
        let moved: Vec<(String, [f64; 2])> = origins
            .iter()
            .map(|(name, at)| (name.clone(), [at[0] + f64::from(way.x), at[1] + f64::from(way.y)]))
            .collect();
        actions.edit(Edit::MoveNodes(moved));
    }

    /// Hands on which nodes are selected.
    pub(super) fn selected(&mut self, ui: &Ui, scene: &Scene, was_wiring: bool, actions: &mut Actions) {
        if was_wiring || self.wire.is_some() {
            return;
        }
        let (released, down, adds) = ui.input(|input| {
            (
                input.pointer.primary_released(),
                input.pointer.primary_down(),
                input.modifiers.shift || input.modifiers.command,
            )
        });
        if !(released || down) || !ui.rect_contains_pointer(ui.max_rect()) || self.menu.is_some() {
            return;
        }
        let of_package: BTreeSet<String> = self
            .state
            .selected_nodes
            .iter()
            .filter_map(|id| self.state.graph.nodes.get(*id))
            .map(|node| node.user_data.name.clone())
            .collect();
        let hidden = scene.selection.iter().filter(|name| !self.ids.contains_key(*name));
        let wanted: BTreeSet<String> = match adds {
            true => of_package.union(scene.selection).cloned().collect(),
            // What is out of view stays selected while other nodes are moved.
            false if self.dragged.is_some() => of_package.iter().chain(hidden).cloned().collect(),
            false => of_package,
        };
        if wanted != *scene.selection {
            actions.push(Action::Select(wanted));
        }
    }
}
