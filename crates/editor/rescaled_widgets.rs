//! Widgets of the array before, where a reader is to draw another: their numbers become the same shares of its range once that is known,
//! in the step that chose the array.

use crate::editor::Editor;
use crate::former_array::{FormerArray, edits};
use crate::jobs::reads;
use crate::transfer;
use crate::worker::DataScales;
use voltet_core::Result;
use voltet_document::Edit;
use voltet_document::links::{self, upstream};
use voltet_graph::{LocatedValue, NodeEntry};

/// Parameters of a reader that choose the array.
const CHOICE: [&str; 2] = ["scalar", "association"];

impl Editor {
    /// The widgets and ranges before edits by which a reader draws another array; `None` of other edits, and where the ranges are not known.
    pub(crate) fn before_other_array(&mut self, edits: &[Edit]) -> Option<FormerArray> {
        let chooses = |edit: &&Edit| match edit {
            Edit::Set { path, .. } | Edit::Unset { path, .. } => {
                CHOICE.iter().any(|name| *path == (*name).into())
            }
            _ => false,
        };
        let (Edit::Set { node, .. } | Edit::Unset { node, .. }) = edits.iter().find(chooses)? else {
            return None;
        };
        let reader = self.node(node).filter(|entry| reads(entry, &self.registry))?.clone();
        let gesture = self.gesture.unwrap_or_else(|| self.gestures.begin());
        if let Some(former) = self.former_array.take().filter(|former| self.is_as_left(former)) {
            // Still those of the array before that one.
            return Some(FormerArray { reader, gesture, ..former });
        }
        let output = self.edited()?.1;
        let nodes = &self.document.pipeline().nodes;
        if !upstream(nodes, links::source(&output, nodes).0).contains(node) {
            return None;
        }
        let Some(Ok(known)) = self.known_of(&output) else {
            self.actions
                .say("the widgets stay at their numbers: the ranges of the array before were not known yet");
            return None;
        };
        let scene = self.scene();
        let is_drawn = |entry: &&NodeEntry| {
            entry.node_type.text() == Some("transfer-function")
                && transfer::volume_of(&scene, &entry.name).as_ref() == Some(&output)
        };
        let looks = nodes.iter().filter(is_drawn).cloned().collect();
        drop(scene);
        Some(FormerArray { reader, looks, output, known, gesture })
    }

    /// The edits were carried out: the widgets follow once the ranges of the other array are known.
    pub(crate) fn expect_ranges(&mut self, former: FormerArray) {
        let Some(reader) = self.node(&former.reader.name) else { return };
        if CHOICE.iter().any(|name| reader.setting(name) != former.reader.setting(name)) {
            self.former_array = Some(FormerArray { reader: reader.clone(), ..former });
        }
    }

    /// Has widgets follow the array that is drawn, unless a hand changed one of them since.
    pub(crate) fn rescale_widgets(&mut self) {
        let Some(former) = self.former_array.take() else { return };
        if !self.is_as_left(&former) {
            return;
        }
        let (done, all) = self.document.history().position();
        let after = match self.known_of(&former.output).filter(|_| done == all) {
            Some(Ok(after)) => after,
            // Where an array cannot be read, the next choice may be one that can.
            None | Some(Err(_)) => return self.former_array = Some(former),
        };
        let edits: Vec<Edit> =
            former.looks.iter().flat_map(|look| edits(look, &former.known, &after)).collect();
        if edits.is_empty() {
            return;
        }
        let scalar =
            former.reader.setting("scalar").and_then(LocatedValue::text).unwrap_or("the array").to_string();
        let outcome = self.document.edit_all(format!("draw '{scalar}'"), &edits, Some(former.gesture));
        if self.check(outcome).is_some() {
            self.panels.transfer.show_all();
            self.say(format!("'{scalar}' is drawn; the widgets stand at the same shares of its range"));
        }
    }

    fn node(&self, name: &str) -> Option<&NodeEntry> {
        self.document.pipeline().nodes.iter().find(|entry| entry.name == name)
    }

    /// True if the array is chosen still, and the widgets are those of the one before.
    fn is_as_left(&self, former: &FormerArray) -> bool {
        let stands = |entry: &NodeEntry, names: &[&str]| {
            let now = self.node(&entry.name);
            now.is_some_and(|now| names.iter().all(|name| now.setting(name) == entry.setting(name)))
        };
        stands(&former.reader, &CHOICE) && former.looks.iter().all(|look| stands(look, &["widgets"]))
    }

    /// Ranges of the volume of an output; `None` while they are looked for.
    fn known_of(&self, output: &str) -> Option<Result<DataScales>> {
        let (source, found) = self.worker.shown(|shown| {
            let source = shown.distribution.asked()?.source.clone();
            Some((source, shown.distribution.answer()?.clone()))
        })?;
        (source.output == output && self.is_current(&source)).then(|| found.map(|found| found.known.clone()))
    }
}
