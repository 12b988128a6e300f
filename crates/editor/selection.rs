//! Selection of nodes: what is worked on, moved by keys, and brought into view.

use crate::editor::Editor;
use std::collections::BTreeSet;
use voltet_document::Edit;

/// Way that a key moves the selected nodes by, points.
const STEP: f64 = 20.0;

impl Editor {
    /// Selects the next node in a direction, and has it in view.
    pub(crate) fn choose_beside(&mut self, way: [f32; 2]) {
        let beside = self.panels.graph.beside(&self.scene(), way).map(str::to_string);
        if let Some(node) = beside {
            self.panels.graph.reveal(&node);
            self.select([node].into());
        }
    }

    /// Selects nodes, for which keys are from then on.
    pub(crate) fn select(&mut self, names: BTreeSet<String>) {
        self.selection = names;
        self.panels.transfer.lose_keys();
        // What keys do to these is a step of its own.
        if self.gestures.end_of_keys() {
            self.gesture = None;
        }
    }

    pub(crate) fn shift(&mut self, way: [f64; 2]) {
        let moved = self.selected().into_iter().map(|name| {
            let [x, y] = self.document.position(&name);
            (name, [x + STEP * way[0], y + STEP * way[1]])
        });
        let moved: Vec<(String, [f64; 2])> = moved.collect();
        if !moved.is_empty() {
            self.edit_one(Edit::MoveNodes(moved));
        }
    }

    pub(crate) fn selected(&self) -> Vec<String> {
        self.selection.iter().cloned().collect()
    }

    /// Selects nodes that were added, if any, and brings the first into view.
    pub(crate) fn show_new(&mut self, added: BTreeSet<String>) {
        if let Some(first) = added.first() {
            self.panels.graph.reveal(first);
            self.select(added);
        }
    }
}
