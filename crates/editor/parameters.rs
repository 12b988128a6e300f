//! The parameter panel: the rows that the document makes of the selected node's declaration, as widgets by their controls; lists of
//! tables; and texts that are being typed.

use crate::scene::{Action, FilePurpose, Scene, error_text};
use crate::theme::{self, button};
use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{
    CollapsingHeader, Color32, ComboBox, DragValue, FocusDirection, Grid, Label, Response, Rgba, RichText,
    ScrollArea, Sense, Slider, TextEdit, Ui, WidgetInfo, WidgetType, vec2,
};
use std::collections::HashMap;
use voltet_core::arithmetic::decimal;
use voltet_document::panel::{Control, Row, Scale, default_value, to_text, typed};
use voltet_document::{Edit, Path};
use voltet_graph::{DefaultValue, LocatedValue, NodeEntry, ParameterValue, Range, VariantSchema};

/// The largest span that a slider of equal steps serves: beyond, a drag of a few points is a large step.
const SPAN_OF_SLIDER: f64 = 1000.0;

/// Share of a number that a drag over one point changes, and its least step.
const SPEED: f64 = 0.01;
const MIN_STEP: f64 = 1e-3;

const REASON: f32 = 280.0;

#[derive(Default)]
struct Typing {
    texts: HashMap<String, String>,
    /// A text that says nothing right: whose, itself, why.
    refused: Option<[String; 3]>,
    wants_focus: Option<String>,
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
        let begun = self.texts.get(key).or_else(|| self.refused(key).map(|refused| &refused[1]));
        let mut text = begun.cloned().unwrap_or_else(|| now.to_string());
        let field = TextEdit::singleline(&mut text).id_salt(key).desired_width(width).hint_text(hint);
        let response = ui.add(field);
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

    fn say_why_refused(&self, ui: &mut Ui, key: &str) {
        if let Some([_, _, why]) = self.refused(key) {
            let color = theme::wrong(ui.visuals().dark_mode);
            ui.set_max_width(REASON);
            ui.add(Label::new(RichText::new(why).small().color(color)).wrap());
        }
    }
}

#[derive(Default)]
pub(crate) struct ParameterPanel {
    typing: Typing,
    /// True if the first value is to get the focus.
    pub begins: bool,
    /// True if the field before the first value has it, from which it goes on.
    goes_on: bool,
}

#[derive(Clone, Copy)]
struct Of<'a> {
    scene: &'a Scene<'a>,
    node: &'a str,
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
        self.head(ui, scene, entry);
        let rows = scene.document.rows(scene.registry, name);
        ScrollArea::vertical().auto_shrink([false, false]).id_salt(("parameters", name)).show(ui, |ui| {
            for fault in scene.faults.iter().filter(|fault| fault.location.node.as_deref() == Some(name)) {
                ui.label(RichText::new(error_text(fault, scene.document)).color(theme::wrong(dark)));
            }
            self.table(ui, Of { scene, node: name }, &Path::default(), &rows);
        });
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
            ui.label("title").on_hover_text("of the pipeline; its pictures carry it");
            if let Some(title) = self.typing.line(ui, "title of the pipeline", &now, 320.0, "none") {
                scene.actions.edit(Edit::Title(Some(title).filter(|title| !title.is_empty())));
            }
        });
    }

    /// The node's name, which can be changed, its type and what it does.
    fn head(&mut self, ui: &mut Ui, scene: &Scene, entry: &NodeEntry) {
        let dark = ui.visuals().dark_mode;
        ui.add_space(3.0);
        ui.horizontal(|ui| {
            let key = format!("name of {}", entry.name);
            if let Some(name) = self.typing.line(ui, &key, &entry.name, 130.0, "name")
                && !name.is_empty()
            {
                scene.actions.edit(Edit::Rename { node: entry.name.clone(), to: name });
            }
            ui.strong(entry.node_type.text().unwrap_or("no type"));
            let summary = scene.node_type(entry).map_or("a type that is not known", |node| node.summary);
            let label = Label::new(RichText::new(summary).color(theme::weak(dark))).truncate();
            ui.add(label).on_hover_text(summary);
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
        let salt = ("rows", of.node, path.to_string());
        Grid::new(salt).num_columns(3).spacing([8.0, 4.0]).show(ui, |ui| {
            for row in rows.iter().filter(is_line) {
                self.line(ui, of, row);
                ui.end_row();
            }
        });
        for row in rows {
            match row.control {
                Entries(kinds) => self.entries(ui, of, row, kinds),
                Table => self.inner(ui, of, row),
                _ => {}
            }
        }
    }

    /// Its name, its value, its unit; and the way back to the standard value.
    fn line(&mut self, ui: &mut Ui, of: Of, row: &Row) {
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
        let shown = ui.vertical(|ui| {
            ui.horizontal(|ui| {
                if let (None, Some(first), DefaultValue::Unset(meaning)) =
                    (&row.set_value, row.begin(), parameter.default)
                {
                    // A number that is not there is no number.
                    if ui.small_button("set").on_hover_text("states a value to begin with").clicked() {
                        of.set(row, first);
                    }
                    ui.label(RichText::new(meaning).small().color(theme::weak(dark)));
                    return;
                }
                if let Some(value) = self.value(ui, of, row) {
                    of.set(row, value);
                }
                if !parameter.unit.is_empty() {
                    ui.label(RichText::new(parameter.unit).small().color(theme::weak(dark)));
                }
            });
            self.typing.say_why_refused(ui, &of.key(row));
        });
        // The value's fields and buttons stand under the name of the parameter.
        shown.response.widget_info(|| WidgetInfo::labeled(WidgetType::Panel, true, of.key(row)));
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
            ui.strong(row.parameter.name).on_hover_text(row.parameter.help);
            ui.menu_button("add", |ui| {
                for kind in kinds {
                    if ui.button(kind.name).on_hover_text(kind.summary).clicked() {
                        let (list, entry) = (list.clone(), default_value(kind));
                        of.scene.actions.edit(Edit::Insert { node: node(), list, place: count, entry });
                        ui.close();
                    }
                }
            });
        });
        for (place, entry) in row.entries.iter().enumerate() {
            let id = ui.make_persistent_id((of.node, entry.path.to_string()));
            let state = CollapsingState::load_with_default_open(ui.ctx(), id, count <= 2);
            let head = state.show_header(ui, |ui| {
                swatch(ui, &entry.rows);
                let kind = entry.kind.map_or("of no kind that is known", |kind| kind.name);
                ui.label(format!("{} {kind}", place + 1));
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
            head.body(|ui| self.table(ui, of, &entry.path, &entry.rows));
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
        shown.header_response.on_hover_text(parameter.help);
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
                number_field(ui, now.and_then(number), range, None).map(|x| ParameterValue::Integer(x as i64))
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
                let given = number_field(ui, now.and_then(number), range, Some(*scale));
                self.offer_typing(ui, *relative, &key, now);
                given.map(ParameterValue::Number)
            }
            Control::Vector { count, range, whole, relative } => {
                if row.is_relative() || self.typing.holds(&key) {
                    return self.typing.value(ui, &key, row, 200.0, "2.5, 25 %, p90");
                }
                let given = numbers(ui, now, count.unwrap_or_default(), range, *whole);
                self.offer_typing(ui, *relative || count.is_none(), &key, now);
                given
            }
            Control::Colour { most } => color(ui, now, *most),
            Control::Choice(words) => choice(ui, &key, now, words),
            Control::Text => self.typing.value(ui, &key, row, 160.0, ""),
            Control::Array | Control::Arrays => self.arrays(ui, of, row, &key),
            Control::InputFile | Control::OutputFile => {
                let given = self.typing.value(ui, &key, row, 200.0, "path");
                if button(ui, "…", &format!("choose {key}"), "choose a file").clicked() {
                    of.scene.actions.push(browse(of, row));
                }
                given
            }
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

    /// Names of arrays, typed or chosen among those that the data have: one, or several.
    fn arrays(&mut self, ui: &mut Ui, of: Of, row: &Row, key: &str) -> Option<ParameterValue> {
        let several = matches!(row.control, Control::Arrays);
        let mut taken = None;
        let arrays = of.scene.arrays.feeding(ui.ctx(), of.scene.document, of.scene.registry, of.node);
        if !arrays.is_empty() {
            let names = row.value().map(texts).unwrap_or_default();
            ComboBox::from_id_salt(("arrays", key)).selected_text("data").width(48.0).show_ui(ui, |ui| {
                for array in arrays.iter() {
                    let mut is_taken = names.contains(&array.name);
                    if several && ui.checkbox(&mut is_taken, &array.label).changed() {
                        let others = names.iter().filter(|name| **name != array.name);
                        let all = others.chain(is_taken.then_some(&array.name));
                        taken = Some(all.map(String::as_str).collect());
                    } else if !several && ui.selectable_label(is_taken, &array.label).clicked() {
                        taken = Some(ParameterValue::Text(array.name.clone()));
                    }
                }
            });
        }
        let (width, hint) = if several { (260.0, "all that are named") } else { (160.0, "") };
        taken.or_else(|| self.typing.value(ui, key, row, width, hint))
    }
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

/// True if the user changed it; rounding for display, or clamping to its range, is no change.
pub(crate) fn by_hand(response: &Response) -> bool {
    response.changed()
        && (response.dragged() || response.drag_stopped() || response.lost_focus() || response.has_focus())
}

/// Result of a drag, with the digits that its step resolves; a typed number stays as it is.
fn meant(response: &Response, x: f64, step: f64) -> f64 {
    if response.dragged() || response.drag_stopped() { decimal(x, 0.1 * step) } else { x }
}

/// A field for one number; a whole one where it has no scale. With a slider where the range has two ends that are not too far.
fn number_field(ui: &mut Ui, now: Option<f64>, range: &Range, scale: Option<Scale>) -> Option<f64> {
    let mut x = now.unwrap_or(range.min.max(0.0).min(range.max));
    let span = range.max - range.min;
    let is_logarithmic = scale == Some(Scale::Logarithmic);
    let mut slid = None;
    if scale.is_some() && span.is_finite() && (is_logarithmic || span <= SPAN_OF_SLIDER) {
        let slider = Slider::new(&mut x, range.min..=range.max).logarithmic(is_logarithmic).show_value(false);
        let response = ui.add(slider.smart_aim(true));
        let step = span / f64::from(response.rect.width().max(1.0));
        let step = if is_logarithmic { step.min(SPEED * x.abs()) } else { step };
        slid = (by_hand(&response) && range.holds(x)).then(|| meant(&response, x, step));
    }
    let step = match scale {
        Some(_) => (SPEED * x.abs()).max(MIN_STEP),
        None => 0.2,
    };
    let before = x;
    let (response, x) = drag(ui, x, range, step, scale.is_none());
    slid.or((by_hand(&response) && x != before && range.holds(x)).then_some(x))
}

/// A number as a file has it, with all its digits: what is edited from there loses none.
fn stated(x: f64) -> String {
    ParameterValue::Number(x).to_string()
}

/// A field for a number, and the number that a hand leaves there.
pub(crate) fn drag(ui: &mut Ui, before: f64, range: &Range, step: f64, whole: bool) -> (Response, f64) {
    let mut x = before;
    let field = DragValue::new(&mut x).range(range.min..=range.max).speed(step).update_while_editing(false);
    let field = if whole { field.max_decimals(0) } else { field.custom_formatter(|x, _| stated(x)) };
    let response = ui.add(field);
    let x = if whole { x.round() } else { meant(&response, x, step) };
    (response, x)
}

fn numbers(
    ui: &mut Ui,
    now: Option<&ParameterValue>,
    count: usize,
    range: &Range,
    whole: bool,
) -> Option<ParameterValue> {
    let mut list = match now {
        Some(ParameterValue::List(list)) => list.iter().map(|part| part.number().unwrap_or(0.0)).collect(),
        _ => vec![range.min.max(0.0).min(range.max); count],
    };
    list.resize(list.len().max(count), 0.0);
    let mut changed = false;
    for number in &mut list {
        let step = if whole { 1.0 } else { (SPEED * number.abs()).max(MIN_STEP) };
        let (response, x) = drag(ui, *number, range, step, whole);
        if by_hand(&response) && x != *number && range.holds(x) {
            (*number, changed) = (x, true);
        }
    }
    changed.then(|| {
        let datum =
            |x: f64| if whole { ParameterValue::Integer(x as i64) } else { ParameterValue::Number(x) };
        list.into_iter().map(datum).collect()
    })
}

/// A colour, linear in the file; brighter than the screen is kept by its factor.
fn color(ui: &mut Ui, now: Option<&ParameterValue>, most: f64) -> Option<ParameterValue> {
    let linear = now.and_then(channels).unwrap_or([1.0; 3]);
    match edited_color(ui, linear) {
        Some(channels) => Some(channels.into_iter().collect()),
        None => numbers(ui, now, 3, &Range::within(0.0, most), false),
    }
}

/// A linear colour as a button that edits it; the new one.
pub(crate) fn edited_color(ui: &mut Ui, linear: [f64; 3]) -> Option<[f64; 3]> {
    let brightest = linear.iter().copied().fold(1.0, f64::max);
    let [r, g, b] = linear.map(|x| (x / brightest) as f32);
    let mut display: Color32 = Rgba::from_rgb(r, g, b).into();
    ui.color_edit_button_srgba(&mut display).changed().then(|| {
        let linear = Rgba::from(display);
        // A screen has 256 levels of each.
        [linear.r(), linear.g(), linear.b()].map(|x| decimal(f64::from(x) * brightest, 1e-5 * brightest))
    })
}

fn channels(datum: &ParameterValue) -> Option<[f64; 3]> {
    LocatedValue::from(datum.clone()).color()
}

fn choice(
    ui: &mut Ui,
    key: &str,
    now: Option<&ParameterValue>,
    words: &[(&str, &str)],
) -> Option<ParameterValue> {
    let now = now.map(to_text).unwrap_or_default();
    let mut taken = None;
    ComboBox::from_id_salt(("choice", key)).selected_text(&now).width(150.0).show_ui(ui, |ui| {
        for (word, meaning) in words {
            if ui.selectable_label(now == *word, *word).on_hover_text(*meaning).clicked() {
                taken = Some((*word).into());
            }
        }
    });
    taken
}

fn number(datum: &ParameterValue) -> Option<f64> {
    LocatedValue::from(datum.clone()).number()
}

fn texts(datum: &ParameterValue) -> Vec<String> {
    let value = LocatedValue::from(datum.clone());
    let parts = value.list().unwrap_or(std::slice::from_ref(&value));
    parts.iter().filter_map(|part| part.text().map(str::to_string)).collect()
}
