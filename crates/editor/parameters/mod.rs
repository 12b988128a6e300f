//! The parameter panel: the rows that the document makes of the selected node's declaration, as widgets.

mod lists;
mod typing;
mod value;

use crate::actions::Actions;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{Grid, Label, RichText, ScrollArea, Ui};
use std::rc::Rc;
use typing::Typing;
pub(crate) use value::{channels_value, edited_color};
use voltet_document::panel::Row;
use voltet_document::{Edit, Path};
use voltet_graph::{DefaultValue, NodeEntry, ParameterValue};

/// The panel, with what is being typed in it.
#[derive(Default)]
pub(crate) struct ParameterPanel {
    typing: Typing,
    /// The rows of a node, as long as the document is the same.
    rows: Option<(u64, String, Rc<Vec<Row>>)>,
    /// Positions of the values by the keys of their rows, for tests.
    #[cfg(test)]
    pub places: std::collections::HashMap<String, eframe::egui::Rect>,
}

/// The node whose rows are shown.
#[derive(Clone, Copy)]
pub(super) struct Of<'a> {
    pub scene: &'a Scene<'a>,
    pub node: &'a str,
}

impl Of<'_> {
    /// The edit that states a row.
    pub fn set(&self, row: &Row, value: ParameterValue) -> Edit {
        Edit::Set { node: self.node.to_string(), path: row.path.clone(), value }
    }

    /// The edit that takes out what leads somewhere.
    pub fn unset(&self, path: &Path) -> Edit {
        Edit::Unset { node: self.node.to_string(), path: path.clone() }
    }

    /// Unique key of a row.
    pub fn key(&self, row: &Row) -> String {
        format!("{}.{}", self.node, row.path)
    }
}

impl ParameterPanel {
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        ui.set_min_height(ui.available_height());
        #[cfg(test)]
        self.places.clear();
        let mut selected = scene.selection.iter();
        let (Some(name), None) = (selected.next(), selected.next()) else {
            let text = match scene.selection.len() {
                0 => "Select a node to see its parameters.",
                _ => "Several nodes are selected.",
            };
            ui.add_space(4.0);
            ui.label(RichText::new(text).color(theme::weak(dark)));
            self.title(ui, scene, actions);
            return;
        };
        let Some(entry) = scene.entry(name) else { return };
        self.head(ui, scene, entry, actions);
        let rows = self.rows_of(scene, name);
        ScrollArea::vertical().auto_shrink([false, false]).id_salt(("parameters", name)).show(ui, |ui| {
            for fault in scene.faults.iter().filter(|fault| fault.location.node.as_deref() == Some(name)) {
                ui.label(RichText::new(fault.to_string()).color(theme::wrong(dark)));
            }
            self.table(ui, Of { scene, node: name }, &Path::default(), &rows, actions);
        });
    }

    /// The title of the pipeline, which its pictures carry.
    fn title(&mut self, ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
        let now = scene.document.pipeline().title.clone().unwrap_or_default();
        ui.horizontal(|ui| {
            ui.label("title").on_hover_text("of the pipeline; its pictures carry it");
            if let Some(title) = self.typing.line(ui, "title!", &now, 320.0, "none") {
                actions.edit(Edit::Title(Some(title).filter(|title| !title.is_empty())));
            }
        });
    }

    /// The rows of a node, made anew where the document is another.
    fn rows_of(&mut self, scene: &Scene, node: &str) -> Rc<Vec<Row>> {
        let revision = scene.document.revision();
        match &self.rows {
            Some((of, name, rows)) if *of == revision && name == node => rows.clone(),
            _ => {
                let rows = Rc::new(scene.document.rows(scene.registry, node));
                self.rows = Some((revision, node.to_string(), rows.clone()));
                rows
            }
        }
    }

    /// The node's name, which can be changed, its type and what it does.
    fn head(&mut self, ui: &mut Ui, scene: &Scene, entry: &NodeEntry, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        ui.add_space(3.0);
        ui.horizontal(|ui| {
            let key = format!("{}!", entry.name);
            if let Some(name) = self.typing.line(ui, &key, &entry.name, 130.0, "name")
                && !name.is_empty()
            {
                actions.edit(Edit::Rename { node: entry.name.clone(), to: name });
            }
            ui.strong(entry.node_type.text().unwrap_or("no type"));
            let summary = scene.node_type(entry).map_or("a type that is not known", |node| node.summary);
            let label = Label::new(RichText::new(summary).color(theme::weak(dark))).truncate();
            ui.add(label).on_hover_text(summary);
        });
        let view = scene.document.view().nodes.get(&entry.name);
        let now = view.and_then(|view| view.remark.clone()).unwrap_or_default();
        let width = (ui.available_width() - 24.0).max(80.0);
        let key = format!("{}?", entry.name);
        if let Some(text) = self.typing.line(ui, &key, &now, width, "a remark, shown in the node") {
            let text = Some(text).filter(|text| !text.is_empty());
            actions.edit(Edit::Remark { node: entry.name.clone(), text });
        }
        ui.separator();
    }

    /// One line a row; tables and lists of tables follow.
    pub(super) fn table(&mut self, ui: &mut Ui, of: Of, path: &Path, rows: &[Row], actions: &mut Actions) {
        use voltet_document::panel::Control::{Entries, Table};
        let is_line = |row: &&Row| !matches!(row.control, Table | Entries(_));
        let salt = ("rows", of.node, path.to_string());
        Grid::new(salt).num_columns(3).spacing([8.0, 4.0]).show(ui, |ui| {
            for row in rows.iter().filter(is_line) {
                self.line(ui, of, row, actions);
                ui.end_row();
            }
        });
        for row in rows {
            match row.control {
                Entries(kinds) => self.entries(ui, of, row, kinds, actions),
                Table => self.inner(ui, of, row, actions),
                _ => {}
            }
        }
    }

    /// Its name, its value, its unit; and the way back to the standard value.
    fn line(&mut self, ui: &mut Ui, of: Of, row: &Row, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        let parameter = row.parameter;
        let color = match (row.is_missing(), &row.set_value) {
            (true, _) => theme::wrong(dark),
            (false, None) => theme::weak(dark),
            (false, Some(_)) => ui.visuals().text_color(),
        };
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
        let what = parameter.parameter_type.describe();
        let help = format!("{}\n{what}{unit}\nstandard: {}", parameter.help, row.default_text());
        ui.label(RichText::new(parameter.name).color(color)).on_hover_text(&help);
        let _shown = ui.vertical(|ui| {
            ui.horizontal(|ui| {
                if let (None, Some(first), DefaultValue::Unset(meaning)) =
                    (&row.set_value, row.begin(), parameter.default)
                {
                    // A number that is not there is no number.
                    if ui.small_button("set").on_hover_text("states a value to begin with").clicked() {
                        actions.edit(of.set(row, first));
                    }
                    ui.label(RichText::new(meaning).small().color(theme::weak(dark)));
                    return;
                }
                if let Some(value) = self.value(ui, of, row, actions) {
                    actions.edit(of.set(row, value));
                }
                if !parameter.unit.is_empty() {
                    ui.label(RichText::new(parameter.unit).small().color(theme::weak(dark)));
                }
            });
            self.typing.say_why_refused(ui, &of.key(row));
        });
        #[cfg(test)]
        self.places.insert(of.key(row), _shown.response.rect);
        if row.set_value.is_some() && !matches!(parameter.default, DefaultValue::Required) {
            let standard = format!("back to the standard: {}", row.default_text());
            if ui.small_button("↺").on_hover_text(standard).clicked() {
                actions.edit(of.unset(&row.path));
            }
        } else {
            ui.label("");
        }
    }
}
