//! Selection of nodes: what is worked on, moved by keys, and brought into view; and of the picture that is shown.

use crate::editor::Editor;
use crate::scene::pictures;
use std::collections::BTreeSet;
use voltet_document::Edit;
use voltet_document::links::upstream;

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

    /// Shows the picture of a node, and that of the one before again where this one is gone.
    pub(crate) fn show_picture(&mut self, node: &str) {
        self.chosen_pictures.retain(|chosen| chosen != node);
        self.chosen_pictures.push(node.to_string());
        self.shown_node = Some(node.to_string());
    }

    /// Shows the picture of a node that was added at once if it is made of the shown one.
    pub(crate) fn show_made_of_shown(&mut self, added: &str) {
        // A former node of that name was another.
        self.chosen_pictures.retain(|chosen| chosen != added);
        let feeding = upstream(&self.document.pipeline().nodes, added);
        if self.shown_node.as_ref().is_some_and(|shown| feeding.contains(shown))
            && pictures(&self.document, &self.registry).contains(&added)
        {
            self.show_picture(added);
        }
    }

    /// Shows the picture that was chosen last among those that are there; where there is none, the last one.
    pub(crate) fn settle_on_picture(&mut self) {
        let pictures = pictures(&self.document, &self.registry);
        let mut chosen = self.chosen_pictures.iter().rev();
        let chosen = chosen.find(|chosen| pictures.contains(&chosen.as_str())).cloned();
        let last = || pictures.last().map(|last| last.to_string());
        match (chosen, last()) {
            (None, Some(last)) => self.show_picture(&last),
            (chosen, _) => self.shown_node = chosen,
        }
    }
}
