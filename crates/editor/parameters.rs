//! The parameter panel: the rows that the document makes of the selected node's declaration, as widgets by their controls; lists of
//! tables; and texts that are being typed.

use crate::blocks::block_tree;
use crate::expression::ExpressionField;
use crate::fields::{REASON, array_list, channels, choice, color, number, number_field, numbers, texts};
use crate::focus::FollowFocus;
use crate::jobs::reads;
use crate::scene::{Action, FilePurpose, Scene, error_text};
use crate::theme::{self, Help, button};
use crate::ways_out::RowFailure;
use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{
    CollapsingHeader, Color32, ComboBox, FocusDirection, Grid, Label, Response, RichText, ScrollArea, Sense,
    TextEdit, Ui, WidgetInfo, WidgetType, vec2,
};
use std::collections::HashMap;
use std::ops::RangeInclusive;
use voltet_core::Error;
use voltet_core::expression::Expression;
use voltet_document::panel::{Control, Row, default_value, to_text, typed};
use voltet_document::{Edit, Path};
use voltet_graph::{
    DefaultValue, NodeEntry, ParameterType, ParameterValue, Range, SourceSpan, VariantSchema,
};
use voltet_io::formats::Association;

/// Width of the panel below which names stand above their values, points.
const NARROW_WIDTH: f32 = 480.0;

/// Width of the column of names beside their values, points.
const NAMES_WIDTH: f32 = 150.0;

#[derive(Default)]
struct Typing {
    texts: HashMap<String, String>,
    /// A text that says nothing right: whose, itself, why.
    refused: Option<[String; 3]>,
    wants_focus: Option<String>,
    /// Most of a field's width, points.
    width: f32,
    /// Reason for which a number field holds another number than was typed in it in this frame.
    remark: Option<String>,
    /// The last such remark: whose, itself; and the revisions of the document that it holds for.
    remarked: Option<([String; 2], RangeInclusive<u64>)>,
}

impl Typing {
    /// True if a text is unfinished or invalid.
    fn holds(&self, key: &str) -> bool {
        self.texts.contains_key(key) || self.refused(key).is_some()
    }

    fn begin(&mut self, key: &str, text: String) {
        self.texts.insert(key.to_string(), text);
        self.wants_focus = Some(key.to_string());
    }

    fn refused(&self, key: &str) -> Option<&[String; 3]> {
        self.refused.as_ref().filter(|refused| refused[0] == key)
    }

    /// A field that gives its text once it is done and another than before.
    fn line(&mut self, ui: &mut Ui, key: &str, now: &str, width: f32, hint: &str) -> Option<String> {
        let width = width.min(self.width);
        self.line_in(ui, key, now, &mut |ui, text| {
            ui.add(TextEdit::singleline(text).id_salt(key).desired_width(width).hint_text(hint))
        })
    }

    /// Text of a field that a function shows, as of [`Typing::line`].
    fn line_in(
        &mut self,
        ui: &mut Ui,
        key: &str,
        now: &str,
        show: &mut dyn FnMut(&mut Ui, &mut String) -> Response,
    ) -> Option<String> {
        let begun = self.texts.get(key).or_else(|| self.refused(key).map(|refused| &refused[1]));
        let mut text = begun.cloned().unwrap_or_else(|| now.to_string());
        let response = show(ui, &mut text);
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(key));
        if self.wants_focus.as_deref() == Some(key) {
            self.wants_focus = None;
            response.request_focus();
            return None;
        }
        if response.has_focus() {
            self.texts.insert(key.to_string(), text);
            return None;
        }
        let done = self.texts.remove(key);
        (response.lost_focus() || done.is_some()).then_some(text).filter(|text| text != now)
    }

    /// Field for the value of a row; an invalid text stays in it, with the reason below.
    fn value(&mut self, ui: &mut Ui, key: &str, row: &Row, width: f32, hint: &str) -> Option<ParameterValue> {
        let now = row.value().map(to_text).unwrap_or_default();
        let had = self.texts.contains_key(key);
        let text = self.line(ui, key, &now, width, hint);
        // A hand came back to it, or has taken back what it typed.
        if self.refused(key).is_some() && (text.is_some() || had) {
            self.refused = None;
        }
        let text = text?;
        match typed(row, &text) {
            Ok(value) => Some(value),
            Err(error) => {
                self.refused = Some([key.to_string(), text, error.to_string()]);
                None
            }
        }
    }

    /// Keeps the remark of this frame on the row of a key. It holds until the document changes, after the edit that it is about.
    fn keep_remark(&mut self, key: &str, is_changed: bool, revision: u64) {
        if let Some(remark) = self.remark.take() {
            let last = revision + u64::from(is_changed);
            self.remarked = Some(([key.to_string(), remark], revision..=last));
        }
        self.remarked.take_if(|(_, revisions)| !revisions.contains(&revision));
    }

    fn say_why_refused(&self, ui: &mut Ui, key: &str) {
        let remark = self.remarked.as_ref().map(|(remark, _)| remark);
        let remark = remark.filter(|[whose, _]| whose == key).map(|[_, remark]| remark);
        if let Some(why) = self.refused(key).map(|[_, _, why]| why).or(remark) {
            let color = theme::wrong(ui.visuals().dark_mode);
            ui.set_max_width(REASON);
            ui.add(Label::new(RichText::new(why).small().color(color)).wrap());
        }
    }
}

#[derive(Default)]
pub(crate) struct ParameterPanel {
    typing: Typing,
    expression: ExpressionField,
    /// Entry of a list that was added, which is to be seen in the next frame, and the number of the frame in which it was.
    added: Option<(String, u64)>,
    /// True if names stand above their values.
    is_narrow: bool,
    /// Place where values begin, beside their names, points.
    values_at: f32,
    /// True if the first value is to get the focus.
    pub begins: bool,
    /// True if something here had the focus in the last frame, from which Escape leads back.
    pub has_focus: bool,
    /// True if the field before the first value has it, from which it goes on.
    goes_on: bool,
}

#[derive(Clone, Copy)]
struct Of<'a> {
    scene: &'a Scene<'a>,
    node: &'a str,
    failure: Option<&'a RowFailure>,
}

impl Of<'_> {
    fn set(&self, row: &Row, value: ParameterValue) {
        self.scene.actions.edit(Edit::set(self.node, row.path.clone(), value));
    }

    fn unset(&self, path: &Path) {
        self.scene.actions.edit(Edit::Unset { node: self.node.to_string(), path: path.clone() });
    }

    fn key(&self, row: &Row) -> String {
        format!("{}.{}", self.node, row.path)
    }
}

impl ParameterPanel {
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene) {
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
            self.title(ui, scene);
            return;
        };
        let Some(entry) = scene.entry(name) else { return };
        self.move_focus(ui, entry);
        self.is_narrow = ui.available_width() < NARROW_WIDTH;
        self.values_at = ui.cursor().left() + NAMES_WIDTH;
        self.typing.width = (ui.available_width() - 90.0).max(80.0);
        self.head(ui, scene, entry);
        let rows = scene.document.rows(scene.registry, name);
        let failure = RowFailure::find(scene, name, &rows);
        ScrollArea::vertical().auto_shrink([false, false]).id_salt(("parameters", name)).show_followed(
            ui,
            |ui| {
                let is_pointed_at =
                    |fault: &&Error| rows.iter().any(|row| is_of_expression(entry, row, fault));
                let own = scene.faults.iter().filter(|fault| fault.location.node.as_deref() == Some(name));
                for fault in own.filter(|fault| !is_pointed_at(fault)) {
                    ui.label(RichText::new(error_text(fault, scene.document)).color(theme::wrong(dark)));
                }
                self.table(ui, Of { scene, node: name, failure: failure.as_ref() }, &Path::default(), &rows);
            },
        );
    }

    /// Gives the focus to the first value, as Tab in the remark before it does.
    fn move_focus(&mut self, ui: &Ui, entry: &NodeEntry) {
        if std::mem::take(&mut self.goes_on) {
            ui.memory_mut(|memory| memory.move_focus(FocusDirection::Next));
        }
        if std::mem::take(&mut self.begins) {
            self.typing.wants_focus = Some(format!("remark of {}", entry.name));
            self.goes_on = true;
            ui.ctx().request_repaint();
        }
    }

    /// The title of the pipeline, which its pictures carry.
    fn title(&mut self, ui: &mut Ui, scene: &Scene) {
        let now = scene.document.pipeline().title.clone().unwrap_or_default();
        ui.horizontal(|ui| {
            ui.label("title").help("of the pipeline; its pictures carry it");
            if let Some(title) = self.typing.line(ui, "title of the pipeline", &now, 320.0, "none") {
                scene.actions.edit(Edit::Title(Some(title).filter(|title| !title.is_empty())));
            }
        });
    }

    /// The node's name, which can be changed, its type and what it does.
    fn head(&mut self, ui: &mut Ui, scene: &Scene, entry: &NodeEntry) {
        let dark = ui.visuals().dark_mode;
        ui.add_space(3.0);
        ui.horizontal_wrapped(|ui| {
            let key = format!("name of {}", entry.name);
            if let Some(name) = self.typing.line(ui, &key, &entry.name, 130.0, "name")
                && !name.is_empty()
            {
                scene.actions.edit(Edit::Rename { node: entry.name.clone(), to: name });
            }
            ui.strong(entry.node_type.text().unwrap_or("no type"));
            let summary = scene.node_type(entry).map_or("a type that is not known", |node| node.summary);
            let label = Label::new(RichText::new(summary).color(theme::weak(dark))).truncate();
            ui.add(label).help(summary);
        });
        let view = scene.document.view().nodes.get(&entry.name);
        let now = view.and_then(|view| view.remark.clone()).unwrap_or_default();
        let width = (ui.available_width() - 24.0).max(80.0);
        let key = format!("remark of {}", entry.name);
        if let Some(text) = self.typing.line(ui, &key, &now, width, "a remark, shown in the node") {
            let text = Some(text).filter(|text| !text.is_empty());
            scene.actions.edit(Edit::Remark { node: entry.name.clone(), text });
        }
        ui.separator();
    }

    /// One line a row; tables and lists of tables follow.
    fn table(&mut self, ui: &mut Ui, of: Of, path: &Path, rows: &[Row]) {
        use Control::{Entries, Table};
        let is_line = |row: &&Row| !matches!(row.control, Table | Entries(_));
        let lines = rows.iter().filter(is_line);
        if self.is_narrow {
            for row in lines {
                ui.horizontal(|ui| {
                    self.name(ui, row);
                    self.way_back(ui, of, row);
                });
                ui.indent(of.key(row), |ui| self.values(ui, of, row));
            }
        } else {
            let salt = ("rows", of.node, path.to_string());
            Grid::new(salt).num_columns(3).spacing([8.0, 4.0]).show(ui, |ui| {
                for row in lines {
                    self.name(ui, row);
                    self.values(ui, of, row);
                    self.way_back(ui, of, row);
                    ui.end_row();
                }
            });
        }
        for row in rows {
            match row.control {
                Entries(kinds) => self.entries(ui, of, row, kinds),
                Table => self.inner(ui, of, row),
                _ => {}
            }
        }
    }

    fn name(&self, ui: &mut Ui, row: &Row) {
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
        ui.horizontal(|ui| {
            // Values of all tables stand below each other, however far their names are indented.
            if !self.is_narrow {
                ui.set_min_width((self.values_at - ui.cursor().left()).max(0.0));
            }
            let name = ui.label(RichText::new(parameter.name).color(color));
            name.help(&help);
        });
    }

    /// The value of a row with its unit.
    fn values(&mut self, ui: &mut Ui, of: Of, row: &Row) {
        let (dark, parameter) = (ui.visuals().dark_mode, row.parameter);
        let shown = ui.vertical(|ui| {
            let is_narrow = self.is_narrow;
            let line = |ui: &mut Ui| {
                if let (None, Some(first), DefaultValue::Unset(meaning)) =
                    (&row.set_value, row.begin(), parameter.default)
                {
                    // A number that is not there is no number.
                    if ui.small_button("set").help("states a value to begin with").clicked() {
                        of.set(row, first);
                    }
                    ui.label(RichText::new(meaning).small().color(theme::weak(dark)));
                    return;
                }
                let value = self.value(ui, of, row);
                let revision = of.scene.document.revision();
                self.typing.keep_remark(&of.key(row), value.is_some(), revision);
                if let Some(value) = value {
                    of.set(row, value);
                }
                if !parameter.unit.is_empty() {
                    ui.label(RichText::new(parameter.unit).small().color(theme::weak(dark)));
                }
            };
            if is_narrow {
                ui.horizontal_wrapped(line)
            } else {
                ui.horizontal(line)
            };
            self.typing.say_why_refused(ui, &of.key(row));
            if let Some(failure) = of.failure {
                failure.say(ui, of.scene, &row.path);
            }
        });
        // The value's fields and buttons stand under the name of the parameter.
        shown.response.widget_info(|| WidgetInfo::labeled(WidgetType::Panel, true, of.key(row)));
    }

    /// The way back to the standard value.
    fn way_back(&self, ui: &mut Ui, of: Of, row: &Row) {
        let parameter = row.parameter;
        if row.set_value.is_some() && !matches!(parameter.default, DefaultValue::Required) {
            let standard = format!("back to the standard: {}", row.default_text());
            if button(ui, "↺", &format!("standard {}", of.key(row)), &standard).clicked() {
                of.unset(&row.path);
            }
        } else {
            ui.label("");
        }
    }

    /// Each entry under its kind, with ways to take away, double and move it; and a way to add one.
    fn entries(&mut self, ui: &mut Ui, of: Of, row: &Row, kinds: &'static [VariantSchema]) {
        let (node, list, count) = (|| of.node.to_string(), &row.path, row.entries.len());
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            ui.strong(row.parameter.name).help(row.parameter.help);
            ui.menu_button("add", |ui| {
                for kind in kinds {
                    if ui.button(kind.name).help(kind.summary).clicked() {
                        let (list, entry) = (list.clone(), default_value(kind, &of.scene.data_extent()));
                        of.scene.actions.edit(Edit::Insert { node: node(), list, place: count, entry });
                        let frame = ui.ctx().cumulative_frame_nr();
                        self.added = Some((of.key(row) + &format!(".{count}"), frame));
                        ui.close();
                    }
                }
            });
        });
        let last = ui.ctx().cumulative_frame_nr().saturating_sub(1);
        for (place, entry) in row.entries.iter().enumerate() {
            let id = ui.make_persistent_id((of.node, entry.path.to_string()));
            let state = CollapsingState::load_with_default_open(ui.ctx(), id, count <= 2);
            let head = state.show_header(ui, |ui| {
                swatch(ui, &entry.rows);
                let kind = entry.kind.map_or("of no kind that is known", |kind| kind.name);
                let stated = entry.rows.iter().find(|row| row.parameter.name == "name");
                let stated =
                    stated.and_then(Row::value).map(texts).and_then(|texts| texts.into_iter().next());
                let name = of.scene.name_of(of.node, &entry.path, stated.as_deref());
                ui.label(
                    name.map_or(format!("{} {kind}", place + 1), |name| format!("{} {name}", place + 1)),
                )
                .help(kind);
                let name = |what: &str| format!("{what} {}", entry.path);
                for (text, what, help, to) in [
                    ("⬆", "earlier", "before the one above", place.saturating_sub(1)),
                    ("⬇", "later", "after the one below", (place + 1).min(count - 1)),
                ] {
                    if button(ui, text, &name(what), help).clicked() && to != place {
                        let (node, list) = (node(), list.clone());
                        of.scene.actions.edit(Edit::MoveEntry { node, list, from: place, to });
                    }
                }
                if button(ui, "×2", &name("duplicate"), "duplicate").clicked() {
                    of.scene.actions.edit(Edit::Duplicate { node: node(), list: list.clone(), place });
                }
                if button(ui, "✖", &name("take away"), "take away").clicked() {
                    of.unset(&entry.path);
                }
            });
            let key = format!("{}.{}", of.node, entry.path);
            let is_new = self.added.take_if(|(added, frame)| *added == key && *frame >= last).is_some();
            let (_, head, body) = head.body(|ui| self.table(ui, of, &entry.path, &entry.rows));
            if is_new {
                body.map_or(head.response, |body| body.response).scroll_to_me(None);
            }
        }
    }

    fn inner(&mut self, ui: &mut Ui, of: Of, row: &Row) {
        let parameter = row.parameter;
        let header = CollapsingHeader::new(parameter.name)
            .id_salt((of.node, row.path.to_string()))
            .default_open(row.set_value.is_some());
        let shown = header.show(ui, |ui| {
            self.table(ui, of, &row.path, &row.rows);
            let may_go = row.set_value.is_some() && !matches!(parameter.default, DefaultValue::Required);
            if may_go && ui.small_button("take out").clicked() {
                of.unset(&row.path);
            }
        });
        shown.header_response.help(parameter.help);
    }

    /// Shows a value; gives another one where a hand made it.
    fn value(&mut self, ui: &mut Ui, of: Of, row: &Row) -> Option<ParameterValue> {
        let key = of.key(row);
        let now = row.value();
        match &row.control {
            Control::Toggle => {
                let mut flag = now == Some(&ParameterValue::Boolean(true));
                ui.checkbox(&mut flag, "").changed().then_some(ParameterValue::Boolean(flag))
            }
            // What is wrong is typed anew; a field would set it within its range.
            Control::Integer(range) | Control::Number { range, .. } | Control::Vector { range, .. }
                if !holds_all(range, now) =>
            {
                self.typing.value(ui, &key, row, 160.0, "")
            }
            Control::Integer(range) => {
                let given = number_field(ui, now.and_then(number), range, None, &mut self.typing.remark);
                given.map(|x| ParameterValue::Integer(x as i64))
            }
            Control::Number { range, scale, word, relative } => {
                if let Some(word) = word {
                    let mut is_word = matches!(now, Some(ParameterValue::Text(text)) if text == word);
                    if ui.checkbox(&mut is_word, *word).changed() {
                        return if is_word { Some((*word).into()) } else { row.begin() };
                    }
                    if is_word {
                        return None;
                    }
                }
                if row.is_relative() || self.typing.holds(&key) {
                    return self.typing.value(ui, &key, row, 160.0, "2.5, 25 %, p90");
                }
                let remark = &mut self.typing.remark;
                let given = number_field(ui, now.and_then(number), range, Some(*scale), remark);
                self.offer_typing(ui, *relative, &key, now);
                given.map(ParameterValue::Number)
            }
            Control::Vector { count, range, whole, relative } => {
                if row.is_relative() || self.typing.holds(&key) {
                    return self.typing.value(ui, &key, row, 200.0, "2.5, 25 %, p90");
                }
                let remark = &mut self.typing.remark;
                let given = numbers(ui, now, count.unwrap_or_default(), range, *whole, remark);
                self.offer_typing(ui, *relative || count.is_none(), &key, now);
                given
            }
            Control::Colour { most } => color(ui, now, *most, &mut self.typing.remark),
            Control::Choice(words) => choice(ui, &key, now, words),
            Control::Expression => {
                let arrays = of.scene.arrays.feeding(ui.ctx(), of.scene.document, of.scene.registry, of.node);
                let mut choices = arrays.choices();
                let stated = of.scene.entry(of.node).and_then(|entry| entry.setting("association")?.text());
                let place = if stated == Some("cell") { Association::Cell } else { Association::Point };
                choices.retain(|choice| choice.is_at(place));
                let now = now.map(to_text).unwrap_or_default();
                let width = self.typing.width.min(420.0);
                let field = &mut self.expression;
                let text = self
                    .typing
                    .line_in(ui, &key, &now, &mut |ui, text| field.show(ui, &key, text, width, &choices));
                text.map(ParameterValue::Text)
            }
            Control::Text => self.typing.value(ui, &key, row, 160.0, ""),
            Control::Array | Control::Arrays => self.arrays(ui, of, row, &key),
            Control::InputFile | Control::OutputFile => {
                // A colour map is a word or a file.
                if let ParameterType::ChoiceOrPath(words, _) = row.parameter.parameter_type
                    && let Some(taken) = choice(ui, &key, now, words)
                {
                    return Some(taken);
                }
                let given = self.typing.value(ui, &key, row, 200.0, "path");
                if button(ui, "…", &format!("choose {key}"), "choose a file").clicked() {
                    of.scene.actions.push(browse(of, row));
                }
                given
            }
            Control::Texts if row.parameter.name == "blocks" => self.blocks(ui, of, row, &key),
            Control::Texts | Control::Rows { .. } => self.typing.value(ui, &key, row, 260.0, "[…]"),
            Control::Table | Control::Entries(_) => None,
        }
    }

    /// A way to type what is no plain number.
    fn offer_typing(&mut self, ui: &mut Ui, is_offered: bool, key: &str, now: Option<&ParameterValue>) {
        let help = "type it: relative to the data (25 %, p90), or several numbers at once";
        if is_offered && button(ui, "✏", &format!("type {key}"), help).clicked() {
            self.typing.begin(key, now.map(to_text).unwrap_or_default());
        }
    }

    /// Names of blocks, typed or ticked. A reader without names reads all; other nodes look at other things then.
    fn blocks(&mut self, ui: &mut Ui, of: Of, row: &Row, key: &str) -> Option<ParameterValue> {
        let found = of.scene.arrays.feeding(ui.ctx(), of.scene.document, of.scene.registry, of.node);
        let is_reader = of.scene.entry(of.node).is_some_and(|entry| reads(entry, of.scene.registry));
        let names = row.value().map(texts).unwrap_or_default();
        match block_tree(ui, &names, &found.of_file.blocks, is_reader) {
            // A list without names is none.
            Some(names) if names.is_empty() => {
                of.unset(&row.path);
                None
            }
            Some(names) => Some(names.iter().map(String::as_str).collect()),
            None => self.typing.value(ui, key, row, 260.0, if is_reader { "all" } else { "" }),
        }
    }

    /// Names of arrays, typed or chosen among those that the data have: one, or several.
    fn arrays(&mut self, ui: &mut Ui, of: Of, row: &Row, key: &str) -> Option<ParameterValue> {
        let several = matches!(row.control, Control::Arrays);
        let mut taken = None;
        let arrays = of.scene.arrays.feeding(ui.ctx(), of.scene.document, of.scene.registry, of.node);
        let choices = arrays.choices();
        if !choices.is_empty() {
            let names = row.value().map(texts).unwrap_or_default();
            ComboBox::from_id_salt(("arrays", key)).selected_text("data").width(48.0).show_ui(ui, |ui| {
                taken = array_list(ui, &choices, &names, several);
            });
        }
        let (width, hint) = if several { (260.0, "all that are named") } else { (160.0, "") };
        taken.or_else(|| self.typing.value(ui, key, row, width, hint))
    }
}

/// True if a fault lies in the expression of a row, and its field points at it: it does where that is not empty and cannot be parsed.
fn is_of_expression(entry: &NodeEntry, row: &Row, fault: &Error) -> bool {
    let stated = entry.setting(row.parameter.name).filter(|_| matches!(row.control, Control::Expression));
    let (Some(stated), Some(place)) = (stated, &fault.location.span) else { return false };
    let is_wrong = stated.text().is_some_and(|text| !text.is_empty() && Expression::parse(text).is_err());
    is_wrong
        && matches!(&stated.origin, SourceSpan::Span(all) if all.start <= place.start && place.end <= all.end)
}

fn swatch(ui: &mut Ui, rows: &[Row]) {
    let color = rows.iter().find(|row| row.parameter.name == "color").and_then(Row::value).and_then(channels);
    let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
    ui.painter().rect_filled(rect, 3.0, color.map_or(Color32::TRANSPARENT, theme::on_screen));
}

fn holds_all(range: &Range, datum: Option<&ParameterValue>) -> bool {
    match datum {
        Some(ParameterValue::List(list)) => list.iter().all(|part| holds_all(range, Some(&part.datum))),
        Some(datum) => number(datum).is_none_or(|x| range.holds(x)),
        None => true,
    }
}

/// Asks for the file of a row, beginning where the one lies that it names.
fn browse(of: Of, row: &Row) -> Action {
    let named = row.value().map(texts).unwrap_or_default().into_iter().find(|name| !name.is_empty());
    let document = of.scene.document;
    let at = match named {
        Some(name) => Some(document.folder().join(name)),
        None => document.path().map(|path| path.with_file_name("")),
    };
    let (node, writes) = (of.node.to_string(), matches!(row.control, Control::OutputFile));
    Action::ChooseFile(FilePurpose::Parameter { node, path: row.path.clone(), writes }, at)
}
