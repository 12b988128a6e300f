//! Lists of tables, such as the widgets of a transfer function, and tables within tables.

use super::value::channels;
use super::{Of, ParameterPanel};
use crate::actions::Actions;
use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{CollapsingHeader, Color32, Rgba, Sense, Ui, vec2};
use voltet_document::Edit;
use voltet_document::panel::{Row, default_value};
use voltet_graph::{DefaultValue, VariantSchema};

impl ParameterPanel {
    /// Each entry under its kind, with ways to take away, double and move it; and a way to add one.
    pub(super) fn entries(
        &mut self,
        ui: &mut Ui,
        of: Of,
        row: &Row,
        kinds: &'static [VariantSchema],
        actions: &mut Actions,
    ) {
        let (node, list, count) = (|| of.node.to_string(), &row.path, row.entries.len());
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            ui.strong(row.parameter.name).on_hover_text(row.parameter.help);
            ui.menu_button("add", |ui| {
                for kind in kinds {
                    if ui.button(kind.name).on_hover_text(kind.summary).clicked() {
                        let (list, entry) = (list.clone(), default_value(kind));
                        actions.edit(Edit::Insert { node: node(), list, place: count, entry });
                        ui.close_menu();
                    }
                }
            });
        });
        for (place, entry) in row.entries.iter().enumerate() {
            let id = ui.make_persistent_id((of.node, entry.path.to_string()));
            let state = CollapsingState::load_with_default_open(ui.ctx(), id, count <= 2);
            let head = state.show_header(ui, |ui| {
                swatch(ui, &entry.rows);
                ui.label(format!(
                    "{} {}",
                    place + 1,
                    entry.kind.map_or("of no kind that is known", |kind| kind.name)
                ));
                let moved = |to| Edit::MoveEntry { node: node(), list: list.clone(), from: place, to };
                if ui.small_button("⬆").on_hover_text("before the one above").clicked() && place > 0 {
                    actions.edit(moved(place - 1));
                }
                if ui.small_button("⬇").on_hover_text("after the one below").clicked() && place + 1 < count
                {
                    actions.edit(moved(place + 1));
                }
                if ui.small_button("×2").on_hover_text("duplicate").clicked() {
                    actions.edit(Edit::Duplicate { node: node(), list: list.clone(), place });
                }
                if ui.small_button("✖").on_hover_text("take away").clicked() {
                    actions.edit(of.unset(&entry.path));
                }
            });
            head.body(|ui| self.table(ui, of, &entry.path, &entry.rows, actions));
        }
    }

    /// A table within a table.
    pub(super) fn inner(&mut self, ui: &mut Ui, of: Of, row: &Row, actions: &mut Actions) {
        let parameter = row.parameter;
        let header = CollapsingHeader::new(parameter.name)
            .id_salt((of.node, row.path.to_string()))
            .default_open(row.set_value.is_some());
        let shown = header.show(ui, |ui| {
            self.table(ui, of, &row.path, &row.rows, actions);
            let may_go = row.set_value.is_some() && !matches!(parameter.default, DefaultValue::Required);
            if may_go && ui.small_button("take out").clicked() {
                actions.edit(of.unset(&row.path));
            }
        });
        shown.header_response.on_hover_text(parameter.help);
    }
}

/// The widget's colour.
fn swatch(ui: &mut Ui, rows: &[Row]) {
    let color = rows.iter().find(|row| row.parameter.name == "color").and_then(Row::value).and_then(channels);
    let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
    let color = color.map_or(Color32::TRANSPARENT, |channels| {
        let [r, g, b] = channels.map(|x| x.min(1.0) as f32);
        Rgba::from_rgb(r, g, b).into()
    });
    ui.painter().rect_filled(rect, 3.0, color);
}
