//! The parameter panel: every parameter of the selected node, made from its declaration.

mod arrays;
mod lists;
mod value;

use crate::actions::Actions;
use crate::scene::Scene;
use crate::theme;
use arrays::Arrays;
use eframe::egui::{Grid, RichText, ScrollArea, TextEdit, Ui};
use std::collections::HashMap;
use voltet_core::graph::{Datum, Field, NodeEntry, Parameter, ParameterType, Setting, Standard};
use voltet_document::{Edit, Path};

/// The panel, with what is being typed in it.
#[derive(Default)]
pub(crate) struct ParameterPanel {
    /// Texts that are being typed, by what they belong to; they become edits when they are done.
    typed: HashMap<String, String>,
    arrays: Arrays,
}

/// One table of parameters: a node's, a widget's, or one within these.
pub(super) struct Table<'a> {
    pub scene: &'a Scene<'a>,
    pub node: &'a str,
    pub path: Path,
    pub stated: &'a [Field],
}

impl Table<'_> {
    /// What is stated of a parameter.
    pub fn stated(&self, name: &str) -> Option<&Setting> {
        self.stated.iter().find(|field| field.name == name).map(|field| &field.setting)
    }

    /// The edit that states it.
    pub fn set(&self, name: &str, value: Datum) -> Edit {
        Edit::Set { node: self.node.to_string(), path: self.path.with(name), value }
    }

    /// What tells it from others while something is typed.
    pub fn key(&self, name: &str) -> String {
        format!("{}.{}", self.node, self.path.with(name))
    }
}

impl ParameterPanel {
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        ui.set_min_height(ui.available_height());
        let mut selected = scene.selection.iter();
        let (Some(name), None) = (selected.next(), selected.next()) else {
            let text = match scene.selection.len() {
                0 => "Select a node to see its parameters.",
                _ => "Several nodes are selected.",
            };
            ui.add_space(4.0);
            ui.label(RichText::new(text).color(theme::weak(dark)));
            return;
        };
        let Some(entry) = scene.entry(name) else { return };
        self.head(ui, scene, entry, actions);
        ScrollArea::vertical().auto_shrink([false, false]).id_salt(("parameters", name)).show(ui, |ui| {
            for fault in scene.faults.iter().filter(|fault| fault.place.node.as_deref() == Some(name)) {
                ui.label(RichText::new(fault.to_string()).color(theme::wrong(dark)));
            }
            let Some(node) = scene.node_type(entry) else { return };
            let table = Table { scene, node: name, path: Path::default(), stated: &entry.settings };
            self.table(ui, &table, node.parameters, actions);
            // What a gradient filter declares stands beside the parameter that names it.
            if let Some(method) = node.method() {
                let word = table.stated(method.name).and_then(Setting::text);
                let word = word.or(match method.standard {
                    Standard::Text(text) => Some(text),
                    _ => None,
                });
                if let Some(filter) = word.and_then(|word| scene.registry.find_filter(word).ok()) {
                    self.table(ui, &table, filter.declaration().parameters, actions);
                }
            }
        });
    }

    /// The node's name, which can be changed, its type and what it does.
    fn head(&mut self, ui: &mut Ui, scene: &Scene, entry: &NodeEntry, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        ui.add_space(3.0);
        ui.horizontal(|ui| {
            if let Some(name) = self.typed_text(ui, &format!("{}!", entry.name), &entry.name, 130.0, "name")
                && name != entry.name
                && !name.is_empty()
            {
                actions.edit(Edit::Rename { node: entry.name.clone(), to: name });
            }
            let node = scene.node_type(entry);
            ui.strong(entry.node_type.text().unwrap_or("no type"));
            let summary = node.map_or("a type that is not known", |node| node.summary);
            let label = eframe::egui::Label::new(RichText::new(summary).color(theme::weak(dark))).truncate();
            ui.add(label).on_hover_text(summary);
        });
        ui.separator();
    }

    /// One row a parameter; lists of tables follow.
    pub(super) fn table(
        &mut self,
        ui: &mut Ui,
        table: &Table,
        declared: &[Parameter],
        actions: &mut Actions,
    ) {
        let is_row =
            |p: &&Parameter| !matches!(p.parameter_type, ParameterType::Kinds(_) | ParameterType::Table(_));
        Grid::new(("rows", table.node, table.path.to_string())).num_columns(3).spacing([8.0, 4.0]).show(
            ui,
            |ui| {
                for parameter in declared.iter().filter(is_row) {
                    self.row(ui, table, parameter, actions);
                    ui.end_row();
                }
            },
        );
        for parameter in declared.iter().filter(|p| !is_row(p)) {
            match parameter.parameter_type {
                ParameterType::Kinds(kinds) => self.kinds(ui, table, parameter, kinds, actions),
                ParameterType::Table(inner) => self.inner(ui, table, parameter, inner, actions),
                _ => {}
            }
        }
    }

    /// Its name, its value, its unit; and the way back to the standard value.
    fn row(&mut self, ui: &mut Ui, table: &Table, parameter: &Parameter, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        let stated = table.stated(parameter.name);
        let is_missing = stated.is_none() && matches!(parameter.standard, Standard::Required);
        let color = match (is_missing, stated) {
            (true, _) => theme::wrong(dark),
            (false, None) => theme::weak(dark),
            (false, Some(_)) => ui.visuals().text_color(),
        };
        let help = format!(
            "{}\n{}{}\nstandard: {}",
            parameter.help,
            parameter.parameter_type.describe(),
            if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) },
            parameter.standard
        );
        ui.label(RichText::new(parameter.name).color(color)).on_hover_text(&help);
        ui.horizontal(|ui| {
            if let (None, Some(first), Standard::Unset(meaning)) =
                (stated, value::first(&parameter.parameter_type), parameter.standard)
            {
                // A number that is not there is no number.
                if ui.small_button("set").on_hover_text("states a value to begin with").clicked() {
                    actions.edit(table.set(parameter.name, first));
                }
                ui.label(RichText::new(meaning).small().color(theme::weak(dark)));
                return;
            }
            if let Some(value) = self.value(ui, table, parameter) {
                actions.edit(table.set(parameter.name, value));
            }
            if !parameter.unit.is_empty() {
                ui.label(RichText::new(parameter.unit).small().color(theme::weak(dark)));
            }
        });
        let may_go = stated.is_some() && !matches!(parameter.standard, Standard::Required);
        if may_go {
            let standard = format!("back to the standard: {}", parameter.standard);
            if ui.small_button("↺").on_hover_text(standard).clicked() {
                let path = table.path.with(parameter.name);
                actions.edit(Edit::Unset { node: table.node.to_string(), path });
            }
        } else {
            ui.label("");
        }
    }

    /// A text field that gives its text once it is done.
    pub(super) fn typed_text(
        &mut self,
        ui: &mut Ui,
        key: &str,
        now: &str,
        width: f32,
        hint: &str,
    ) -> Option<String> {
        let mut text = self.typed.get(key).cloned().unwrap_or_else(|| now.to_string());
        let field = TextEdit::singleline(&mut text).id_salt(key).desired_width(width).hint_text(hint);
        let response = ui.add(field);
        if response.has_focus() {
            self.typed.insert(key.to_string(), text);
            None
        } else {
            let done = self.typed.remove(key);
            (response.lost_focus() || done.is_some()).then_some(text).filter(|text| text != now)
        }
    }
}
