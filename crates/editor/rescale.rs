//! Widgets where another array is to be drawn: their numbers become the same shares of its ranges once those are known, in the step
//! that chose the array. And widgets whose axes get other scales: they reach to the same values, in the step that chose the scale.

use crate::editor::Editor;
use crate::rescale_edits::{PendingRescale, edits, edits_of_scales, is_absolute};
use crate::transfer;
use crate::worker::DataScales;
use std::collections::BTreeSet;
use voltet_core::{Result, counted};
use voltet_document::links::upstream;
use voltet_document::{Edit, Gesture};
use voltet_graph::NodeEntry;

/// Parameters that choose the array: of a reader, or of a node that makes one.
const CHOICE: [&str; 2] = ["scalar", "association"];

/// Parameters of a transfer function that are of the scales of its axes.
const SCALES: [&str; 4] = ["s_scale", "s_linear_below", "g_scale", "g_linear_below"];

impl Editor {
    /// The widgets and ranges before edits by which another array is drawn; `None` of other edits.
    pub(crate) fn before_rescale(&mut self, edits: &[Edit]) -> Option<PendingRescale> {
        let chooses = |edit: &&Edit| match edit {
            Edit::Set { path, .. } | Edit::Unset { path, .. } => {
                CHOICE.iter().any(|name| *path == (*name).into())
            }
            _ => false,
        };
        let (Edit::Set { node, .. } | Edit::Unset { node, .. }) = edits.iter().find(chooses)? else {
            return None;
        };
        let has_scalar = |entry: &&NodeEntry| {
            self.registry.node_type(entry).is_some_and(|of| of.parameter(CHOICE[0]).is_some())
        };
        let chooser = self.node(node).filter(has_scalar)?.clone();
        let pending = self.pending_rescale.as_ref();
        if let Some(pending) = pending.filter(|one| one.chooser.name == *node && self.is_as_left(one)) {
            // Still those of the array before that one, in one step with it.
            return Some(PendingRescale { chooser, ..pending.clone() });
        }
        let output = self.edited().map(|(_, output)| output).unwrap_or_default();
        let before = self.known_of(&output).and_then(Result::ok);
        let scene = self.scene();
        let nodes = &self.document.pipeline().nodes;
        let edited = scene.output_of(&output);
        let (mut looks, mut left) = (Vec::new(), Vec::new());
        let of_type = |entry: &&NodeEntry| entry.node_type.text() == Some("transfer-function");
        for look in nodes.iter().filter(of_type).filter(|look| is_absolute(look)) {
            let volumes = transfer::volumes_of(&scene, &look.name);
            let is_chosen = |(name, _): &(String, String)| upstream(nodes, name).contains(node);
            if !volumes.iter().any(is_chosen) {
                continue;
            }
            // One that is drawn with several volumes is right for all of them, or none.
            if before.is_some() && volumes.iter().all(|volume| *volume == edited) {
                looks.push(look.clone());
            } else {
                left.push(look.name.clone());
            }
        }
        drop(scene);
        let gesture = self.gesture.unwrap_or_else(|| self.gestures.begin());
        Some(PendingRescale { chooser, looks, left, output, before, gesture })
    }

    /// The edits were carried out: the widgets are rescaled once the ranges of the other array are known.
    pub(crate) fn expect_ranges(&mut self, pending: PendingRescale) {
        let Some(chooser) = self.node(&pending.chooser.name) else { return };
        if CHOICE.iter().all(|name| chooser.setting(name) == pending.chooser.setting(name)) {
            return;
        }
        let chooser = chooser.clone();
        if !pending.left.is_empty() {
            self.say(said_of_left(&pending.left));
        }
        if !pending.looks.is_empty() {
            self.pending_rescale = Some(PendingRescale { chooser, ..pending });
        }
    }

    /// Rescales widgets to the array that is drawn, unless a hand changed one of them since.
    pub(crate) fn rescale_widgets(&mut self) {
        let Some(pending) = self.pending_rescale.take() else { return };
        let (done, all) = self.document.history().position();
        if done != all {
            // A choice that is undone may be made once more.
            return self.pending_rescale = Some(pending);
        }
        if !self.is_as_left(&pending) {
            return;
        }
        let Some(before) = &pending.before else { return };
        let after = match self.known_of(&pending.output) {
            Some(Ok(after)) => after,
            // Where an array cannot be read, the next choice may be one that can.
            None | Some(Err(_)) => return self.pending_rescale = Some(pending),
        };
        let edits: Vec<Edit> = pending.looks.iter().flat_map(|look| edits(look, before, &after)).collect();
        if edits.is_empty() {
            return;
        }
        let scalar = self.scene().scalar().map_or("another array".into(), |scalar| format!("'{scalar}'"));
        let outcome = self.document.edit_all(format!("draw {scalar}"), &edits, Some(pending.gesture));
        if self.check(outcome).is_some() {
            self.panels.transfer.show_all();
            let left = match pending.left.is_empty() {
                true => String::new(),
                false => format!("; {}", said_of_left(&pending.left)),
            };
            self.say(format!("{scalar} is drawn; the widgets stand at the same shares of its range{left}"));
        }
    }

    /// The transfer functions whose axes edits may give other scales, with what is known of their data.
    pub(crate) fn before_scales(&self, edits: &[Edit]) -> Vec<(NodeEntry, Option<DataScales>)> {
        let names: BTreeSet<&String> = edits
            .iter()
            .filter_map(|edit| match edit {
                Edit::Set { node, path, .. } | Edit::Unset { node, path } => {
                    SCALES.iter().any(|name| *path == (*name).into()).then_some(node)
                }
                _ => None,
            })
            .collect();
        let looks = names.into_iter().filter_map(|name| self.node(name));
        let looks = looks.filter(|look| look.node_type.text() == Some("transfer-function"));
        let known = |look: &NodeEntry| {
            let output = transfer::volume_of(&self.scene(), &look.name)?;
            self.known_of(&output)?.ok()
        };
        looks.map(|look| (look.clone(), known(look))).collect()
    }

    /// The edits were carried out: widgets whose axes have other scales now reach to the values that they reached to before.
    pub(crate) fn follow_scales(
        &mut self,
        looks: Vec<(NodeEntry, Option<DataScales>)>,
        gesture: Option<Gesture>,
    ) {
        for (look, known) in looks {
            let scales = |look: &NodeEntry| transfer::scales(look, &transfer::S_AND_G);
            let after = self.node(&look.name).map_or_else(Default::default, scales);
            if after == scales(&look) {
                continue;
            }
            self.panels.transfer.show_all();
            let (edits, left) = edits_of_scales(&look, known.as_ref(), &after);
            if !edits.is_empty() {
                let outcome = self.document.edit_all("another scale".into(), &edits, gesture);
                self.check(outcome);
            }
            if !left.is_empty() {
                let numbers: Vec<String> = left.iter().map(usize::to_string).collect();
                self.say(format!(
                    "the widths of {} of '{}' ({}) stay as they are: the middle has no place on one of the scales, or the data are not known yet",
                    counted(left.len(), "widget"),
                    look.name,
                    numbers.join(", ")
                ));
            }
        }
    }

    fn node(&self, name: &str) -> Option<&NodeEntry> {
        self.document.pipeline().nodes.iter().find(|entry| entry.name == name)
    }

    /// True if the array is chosen still, and the widgets are those of the one before.
    fn is_as_left(&self, pending: &PendingRescale) -> bool {
        let stands = |entry: &NodeEntry, names: &[&str]| {
            let now = self.node(&entry.name);
            now.is_some_and(|now| names.iter().all(|name| now.setting(name) == entry.setting(name)))
        };
        stands(&pending.chooser, &CHOICE) && pending.looks.iter().all(|look| stands(look, &["widgets"]))
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

/// Words about transfer functions whose widgets are not rescaled.
fn said_of_left(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    format!(
        "the widgets of {} stay at their numbers: another volume is drawn with them, or the ranges before are not known",
        names.join(" and ")
    )
}
