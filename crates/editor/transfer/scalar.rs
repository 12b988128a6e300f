//! Choice of the array that is drawn as s, among those of the file and those that nodes make of them.

use super::edited_function::{EditedFunction, volume_of};
use crate::fields::{LIST_WIDTH, follow_arrows, list_area};
use crate::jobs::{ArrayChoice, reads};
use crate::scene::Scene;
use crate::theme::Help;
use eframe::egui::Ui;
use std::collections::BTreeSet;
use voltet_document::{Edit, links};
use voltet_graph::{LocatedValue, NodeEntry, ParameterType, ParameterValue};

/// Parameter of a reader that names the scalar; of a node that makes an array, true if that is the scalar.
const SCALAR: &str = "scalar";

/// Menu of the arrays that can be drawn.
pub(super) fn scalar_menu(ui: &mut Ui, look: &EditedFunction) {
    let (scene, nodes) = (look.scene, &look.scene.document.pipeline().nodes);
    let Some(source) = volume_of(scene, &look.node.name) else { return };
    let volume = links::source(&source, nodes).0;
    let feeding = links::upstream(nodes, volume);
    let chooses = |entry: &NodeEntry| reads(entry, scene.registry) || is_maker(scene, entry);
    if !nodes.iter().any(|entry| feeding.contains(&entry.name) && chooses(entry)) {
        return;
    }
    let now = scene.scalar().unwrap_or("…");
    let menu = ui.menu_button(format!("s: {now}"), |ui| {
        ui.set_min_width(LIST_WIDTH);
        let arrays = scene.arrays.given_by(ui.ctx(), scene.document, scene.registry, volume);
        list_area().show(ui, |ui| {
            let mut entries = Vec::new();
            for array in arrays.choices().into_iter().filter(|array| !array.name.is_empty()) {
                let Some(edits) = drawing(scene, &feeding, array) else { continue };
                let entry = ui.selectable_label(array.name == now, &array.label);
                if entry.clicked() {
                    look.actions.edits(format!("draw '{}'", array.name), edits);
                    ui.close();
                }
                entries.push((entry, array.name == now));
            }
            follow_arrows(ui, &entries);
        });
    });
    menu.response.help("the array that is drawn; the widgets follow to the same shares of its range");
}

/// True if a node makes an array that may be the scalar, or not.
fn is_maker(scene: &Scene, entry: &NodeEntry) -> bool {
    let parameter = scene.node_type(entry).and_then(|node| node.parameter(SCALAR));
    parameter.is_some_and(|parameter| matches!(parameter.parameter_type, ParameterType::Boolean))
}

/// Edits after which an array is the scalar of a volume, of all nodes that feed that; `None` of an array that cannot be.
fn drawing(scene: &Scene, feeding: &BTreeSet<String>, array: &ArrayChoice) -> Option<Vec<Edit>> {
    let nodes = || scene.document.pipeline().nodes.iter().filter(|entry| feeding.contains(&entry.name));
    let is_drawn = |entry: &NodeEntry| {
        entry.setting(SCALAR).is_none_or(|stated| stated.datum != ParameterValue::Boolean(false))
    };
    let unset = |entry: &NodeEntry, name: &str| Edit::Unset { node: entry.name.clone(), path: [name].into() };
    let mut edits = Vec::new();
    match array.maker.as_deref().and_then(|maker| scene.entry(maker)) {
        Some(maker) if is_maker(scene, maker) => {
            edits.extend((!is_drawn(maker)).then(|| unset(maker, SCALAR)));
        }
        // What a source makes is its scalar.
        Some(source) => drop(scene.node_type(source).filter(|node| node.inputs.is_empty())?),
        None => {
            let reader = nodes().find(|entry| reads(entry, scene.registry))?;
            if reader.setting(SCALAR).and_then(LocatedValue::text) != Some(&array.name) {
                edits.push(Edit::set(&reader.name, [SCALAR], array.name.as_str().into()));
            }
            edits.extend(reader.setting("association").map(|_| unset(reader, "association")));
        }
    }
    let others = nodes().filter(|entry| Some(&entry.name) != array.maker.as_ref());
    let others = others.filter(|entry| is_maker(scene, entry) && is_drawn(entry));
    edits.extend(others.map(|entry| Edit::set(&entry.name, [SCALAR], ParameterValue::Boolean(false))));
    Some(edits)
}
