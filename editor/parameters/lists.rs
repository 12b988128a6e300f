//! Lists of tables, such as the widgets of a transfer function, and tables within tables.

use super::{ParameterPanel, Table};
use crate::actions::Actions;
use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{CollapsingHeader, Color32, Rgba, Sense, Ui, vec2};
use voltet_core::graph::{Datum, Field, Kind, Parameter, Setting, Standard};
use voltet_document::Edit;

impl ParameterPanel {
    /// Each entry under its kind, with ways to take away, double and move it; and a way to add one.
    pub(super) fn kinds(
        &mut self,
        ui: &mut Ui,
        table: &Table,
        parameter: &Parameter,
        kinds: &'static [Kind],
        actions: &mut Actions,
    ) {
        let list = table.stated(parameter.name).and_then(Setting::list).unwrap_or_default();
        let path = table.path.with(parameter.name);
        let node = || table.node.to_string();
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            ui.strong(parameter.name);
            ui.menu_button("add", |ui| {
                for kind in kinds {
                    if ui.button(kind.name).on_hover_text(kind.summary).clicked() {
                        let entry = begun(kind);
                        actions.edit(Edit::Insert {
                            node: node(),
                            list: path.clone(),
                            place: list.len(),
                            entry,
                        });
                        ui.close_menu();
                    }
                }
            });
        });
        for (i, entry) in list.iter().enumerate() {
            let fields = entry.table().unwrap_or_default();
            let word =
                |name: &str| fields.iter().find(|field| field.name == name).map(|field| &field.setting);
            let kind_name = word("kind").and_then(Setting::text).unwrap_or("no kind");
            let own = path.with(i);
            let salt = (table.node, own.to_string());
            let id = ui.make_persistent_id(salt);
            let state = CollapsingState::load_with_default_open(ui.ctx(), id, list.len() <= 2);
            let head = state.show_header(ui, |ui| {
                swatch(ui, fields);
                ui.label(format!("{} {kind_name}", i + 1));
                if ui.small_button("⬆").on_hover_text("before the one above").clicked() && i > 0 {
                    actions.edit(Edit::MoveEntry { node: node(), list: path.clone(), from: i, to: i - 1 });
                }
                if ui.small_button("⬇").on_hover_text("after the one below").clicked() && i + 1 < list.len()
                {
                    actions.edit(Edit::MoveEntry { node: node(), list: path.clone(), from: i, to: i + 1 });
                }
                if ui.small_button("×2").on_hover_text("duplicate").clicked() {
                    actions.edit(Edit::Duplicate { node: node(), list: path.clone(), place: i });
                }
                if ui.small_button("✖").on_hover_text("take away").clicked() {
                    actions.edit(Edit::Unset { node: node(), path: own.clone() });
                }
            });
            head.body(|ui| {
                let Some(kind) = kinds.iter().find(|kind| kind.name == kind_name) else { return };
                let inner = Table { scene: table.scene, node: table.node, path: own.clone(), stated: fields };
                self.table(ui, &inner, kind.parameters, actions);
            });
        }
    }

    /// A table within a table.
    pub(super) fn inner(
        &mut self,
        ui: &mut Ui,
        table: &Table,
        parameter: &Parameter,
        declared: &'static [Parameter],
        actions: &mut Actions,
    ) {
        let stated = table.stated(parameter.name);
        let path = table.path.with(parameter.name);
        let salt = (table.node, path.to_string());
        CollapsingHeader::new(parameter.name)
            .id_salt(salt)
            .default_open(stated.is_some())
            .show(ui, |ui| {
                let fields = stated.and_then(Setting::table).unwrap_or_default();
                let inner =
                    Table { scene: table.scene, node: table.node, path: path.clone(), stated: fields };
                self.table(ui, &inner, declared, actions);
                if stated.is_some()
                    && !matches!(parameter.standard, Standard::Required)
                    && ui.small_button("take out").clicked()
                {
                    actions.edit(Edit::Unset { node: table.node.to_string(), path });
                }
            })
            .header_response
            .on_hover_text(parameter.help);
    }
}

/// The widget's colour.
fn swatch(ui: &mut Ui, fields: &[Field]) {
    let color = fields.iter().find(|field| field.name == "color");
    let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
    let color = match color.and_then(|field| super::value::numbers_of::<3>(Some(&field.setting.datum))) {
        Some(channels) => {
            let [r, g, b] = channels.map(|x| x.min(1.0) as f32);
            Color32::from(Rgba::from_rgb(r, g, b))
        }
        None => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, 3.0, color);
}

/// A new entry: what is required has a value to begin with.
fn begun(kind: &Kind) -> Datum {
    let numbers = |list: &[f64]| Datum::List(list.iter().map(|&x| Setting::from(Datum::Number(x))).collect());
    let text = |text: &str| Datum::Text(text.into());
    let mut fields = vec![("kind", text(kind.name))];
    for parameter in kind.parameters {
        let has = |name: &str| parameter.name == name;
        let needed = matches!(parameter.standard, Standard::Required)
            || (has("sigma") && kind.name.starts_with("gaussian"));
        if !needed {
            continue;
        }
        let both = kind.name == "gaussian";
        let value = match parameter.name {
            "color" => numbers(&[1.0, 0.6, 0.2]),
            "extinction" => Datum::Number(10.0),
            "centre" if both => Datum::List(vec![text("50 %").into(), text("0 %").into()]),
            "sigma" if both => Datum::List(vec![text("10 %").into(), text("20 %").into()]),
            "centre" => text("50 %"),
            "sigma" => text("10 %"),
            "period" => text("10 %"),
            "points" => Datum::List(vec![
                numbers(&[0.0, 0.1, 0.2, 0.9, 0.0]).into(),
                numbers(&[1.0, 1.0, 0.6, 0.2, 10.0]).into(),
            ]),
            "region" => Datum::Table(vec![Field {
                name: "s".into(),
                origin: Default::default(),
                setting: Datum::List(vec![text("25 %").into(), text("75 %").into()]).into(),
            }]),
            _ => continue,
        };
        fields.push((parameter.name, value));
    }
    let field = |(name, datum): (&str, Datum)| Field {
        name: name.into(),
        origin: Default::default(),
        setting: datum.into(),
    };
    Datum::Table(fields.into_iter().map(field).collect())
}
