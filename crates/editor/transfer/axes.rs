//! Choice of the plane's quantities: s, g, arrays of the data, and arrays that widgets name.

use super::TransferPanel;
use super::edited_function::EditedFunction;
use super::quantities::{axis_name, volume_of};
use super::scale::S_AND_G;
use super::screen_widget;
use crate::scene::Scene;
use eframe::egui::{Key, ScrollArea, TextEdit, Ui};
use std::collections::BTreeMap;
use voltet_document::links;
use voltet_graph::{ArrayRef, LocatedValue};

/// Width of one list, and the most of its height, points.
const WIDTH: f32 = 230.0;
const HEIGHT: f32 = 220.0;

impl TransferPanel {
    /// A list for each axis, side by side.
    pub(super) fn axes_menu(&mut self, ui: &mut Ui, scene: &Scene, look: &EditedFunction) {
        let [x, y] = self.axes.each_ref().map(axis_name);
        ui.menu_button(format!("axes {x}, {y}"), |ui| {
            if ui.button("s, g").on_hover_text("the scalar and its gradient magnitude").clicked() {
                self.set_axes(S_AND_G);
                ui.close_menu();
            }
            ui.separator();
            let choices = choices(ui, scene, look);
            ui.horizontal_top(|ui| {
                for (k, title) in ["to the right", "up"].into_iter().enumerate() {
                    ui.vertical(|ui| {
                        ui.set_width(WIDTH);
                        ui.label(title);
                        self.list_of_axis(ui, k, &choices);
                    });
                }
            });
        })
        .response
        .on_hover_text("the quantities that the plane is over; widgets of several fields lie on theirs");
    }

    fn list_of_axis(&mut self, ui: &mut Ui, k: usize, choices: &[(ArrayRef, String)]) {
        let mut taken = None;
        ScrollArea::vertical().id_salt(("axis", k)).max_height(HEIGHT).show(ui, |ui| {
            for (axis, label) in choices {
                if ui.selectable_label(self.axes[k] == *axis, label).clicked() {
                    taken = Some(axis.clone());
                }
            }
        });
        let typed = TextEdit::singleline(&mut self.typed_axis[k]).hint_text("another, by its name");
        let response = ui.add(typed.desired_width(WIDTH - 20.0));
        let enters = ui.input(|input| input.key_pressed(Key::Enter));
        if response.lost_focus() && enters && !self.typed_axis[k].is_empty() {
            taken = Some(ArrayRef::Array(std::mem::take(&mut self.typed_axis[k])));
        }
        if let Some(axis) = taken {
            let mut axes = self.axes.clone();
            axes[k] = axis;
            self.set_axes(axes);
            ui.close_menu();
        }
    }
}

/// Choices for an axis, labelled with kind and range where the data have it.
fn choices(ui: &Ui, scene: &Scene, look: &EditedFunction) -> Vec<(ArrayRef, String)> {
    let nodes = &scene.document.pipeline().nodes;
    let source = volume_of(scene, &look.node.name);
    let source = source.as_deref().map(|source| links::source(source, nodes).0);
    let of_data = source
        .map(|node| scene.arrays.feeding(ui.ctx(), scene.document, scene.registry, node))
        .unwrap_or_default();
    let named = look.list.iter().filter_map(LocatedValue::table).flat_map(screen_widget::arrays);
    let mut arrays: BTreeMap<String, String> = named.map(|name| (name.clone(), name)).collect();
    arrays.extend(of_data.iter().map(|array| (array.name.clone(), array.label.clone())));
    let named = S_AND_G.into_iter().map(|axis| (axis.clone(), axis_name(&axis)));
    named.chain(arrays.into_iter().map(|(name, label)| (ArrayRef::Array(name), label))).collect()
}
