//! The widget for a value, by its control.

use super::{Of, ParameterPanel};
use crate::actions::FilePurpose;
use crate::actions::{Action, Actions};
use eframe::egui::{Color32, ComboBox, DragValue, Response, Rgba, Slider, Ui};
use voltet_document::panel::{Control, Row, Scale, rounded, to_text};
use voltet_graph::{LocatedValue, ParameterValue, Range};

/// The largest span that a slider of equal steps serves: beyond, a drag of a few points is a large step.
const SPAN_OF_SLIDER: f64 = 1000.0;

/// Share of a number that a drag over one point changes, and its least step.
const SPEED: f64 = 0.01;
const MIN_STEP: f64 = 1e-3;

impl ParameterPanel {
    /// Shows a value; gives another one where a hand made it.
    pub(super) fn value(
        &mut self,
        ui: &mut Ui,
        of: Of,
        row: &Row,
        actions: &mut Actions,
    ) -> Option<ParameterValue> {
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
                        return if is_word {
                            Some(ParameterValue::Text(word.to_string()))
                        } else {
                            row.begin()
                        };
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
                if ui.small_button("…").on_hover_text("choose a file").clicked() {
                    actions.push(browse(of, row));
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
        if is_offered && ui.small_button("✏").on_hover_text(help).clicked() {
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
                    let clicked = match several {
                        true => ui.checkbox(&mut is_taken, &array.label).changed(),
                        false => ui.selectable_label(is_taken, &array.label).clicked(),
                    };
                    if clicked && several {
                        let others = names.iter().filter(|name| **name != array.name);
                        let all = others.chain(is_taken.then_some(&array.name));
                        let all = all.map(|name| LocatedValue::from(ParameterValue::Text(name.clone())));
                        taken = Some(ParameterValue::List(all.collect()));
                    } else if clicked {
                        taken = Some(ParameterValue::Text(array.name.clone()));
                    }
                }
            });
        }
        let width = if several { 260.0 } else { 160.0 };
        taken.or_else(|| {
            self.typing.value(ui, key, row, width, if several { "all that are named" } else { "" })
        })
    }
}

/// True if all numbers of a value lie in the range.
fn holds_all(range: &Range, datum: Option<&ParameterValue>) -> bool {
    match datum {
        Some(ParameterValue::List(list)) => list.iter().all(|part| holds_all(range, Some(&part.datum))),
        Some(datum) => number(datum).is_none_or(|x| range.holds(x)),
        None => true,
    }
}

/// Asks for the file of a row, beginning where the one lies that it names.
fn browse(of: Of, row: &Row) -> Action {
    let named = row.value().and_then(|datum| LocatedValue::from(datum.clone()).text().map(str::to_string));
    let document = of.scene.document;
    let at = match named.filter(|name| !name.is_empty()) {
        Some(name) => Some(document.folder().join(name)),
        None => document.path().map(|path| path.with_file_name("")),
    };
    let writes = matches!(row.control, Control::OutputFile);
    Action::ChooseFile(
        FilePurpose::Parameter { node: of.node.to_string(), path: row.path.clone(), writes },
        at,
    )
}

/// True if the user changed it; rounding for display, or clamping to its range, is no change.
fn by_hand(response: &Response) -> bool {
    response.changed()
        && (response.dragged() || response.drag_stopped() || response.lost_focus() || response.has_focus())
}

/// Result of a drag, with the digits that its step resolves; a typed number stays as it is.
fn meant(response: &Response, x: f64, step: f64) -> f64 {
    if response.dragged() || response.drag_stopped() { rounded(x, step) } else { x }
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

/// A number with no more digits than six, as a file would have it.
fn short(x: f64) -> String {
    ParameterValue::Number(format!("{x:.5e}").parse().unwrap_or(x)).to_string()
}

/// A number that is dragged and typed.
fn drag(ui: &mut Ui, before: f64, range: &Range, step: f64, whole: bool) -> (Response, f64) {
    let mut x = before;
    let field = DragValue::new(&mut x).range(range.min..=range.max).speed(step).update_while_editing(false);
    let field = match whole {
        true => field.max_decimals(0),
        false => field.custom_formatter(|x, _| short(x)),
    };
    let response = ui.add(field);
    let x = if whole { x.round() } else { meant(&response, x, step) };
    // What is shown shorter than it is stays as it is where nobody typed another number.
    (response, if short(x) == short(before) { before } else { x })
}

fn numbers(
    ui: &mut Ui,
    now: Option<&ParameterValue>,
    count: usize,
    range: &Range,
    whole: bool,
) -> Option<ParameterValue> {
    let mut list: Vec<f64> = match now {
        Some(ParameterValue::List(list)) => {
            list.iter().map(|setting| setting.number().unwrap_or(0.0)).collect()
        }
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
        ParameterValue::List(list.into_iter().map(|x| LocatedValue::from(datum(x))).collect())
    })
}

/// A colour, linear in the file; brighter than the screen is kept by its factor.
fn color(ui: &mut Ui, now: Option<&ParameterValue>, most: f64) -> Option<ParameterValue> {
    let linear = now.and_then(channels).unwrap_or([1.0; 3]);
    match edited_color(ui, linear) {
        Some(channels) => Some(channels_value(channels)),
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
        [linear.r(), linear.g(), linear.b()].map(|x| rounded(f64::from(x) * brightest, 1e-4))
    })
}

/// Three numbers as a value of a parameter.
pub(crate) fn channels_value(channels: [f64; 3]) -> ParameterValue {
    ParameterValue::List(channels.map(|x| LocatedValue::from(ParameterValue::Number(x))).to_vec())
}

/// Three numbers as a colour.
pub(super) fn channels(datum: &ParameterValue) -> Option<[f64; 3]> {
    let ParameterValue::List(list) = datum else { return None };
    list.iter().map(LocatedValue::number).collect::<Option<Vec<f64>>>()?.try_into().ok()
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
                taken = Some(ParameterValue::Text(word.to_string()));
            }
        }
    });
    taken
}

fn number(datum: &ParameterValue) -> Option<f64> {
    match datum {
        ParameterValue::Integer(x) => Some(*x as f64),
        ParameterValue::Number(x) => Some(*x),
        ParameterValue::Boolean(_)
        | ParameterValue::Text(_)
        | ParameterValue::List(_)
        | ParameterValue::Table(_) => None,
    }
}

/// A text, or those of a list.
fn texts(datum: &ParameterValue) -> Vec<String> {
    match datum {
        ParameterValue::Text(text) => vec![text.clone()],
        ParameterValue::List(list) => {
            list.iter().filter_map(|part| part.text().map(str::to_string)).collect()
        }
        ParameterValue::Boolean(_)
        | ParameterValue::Integer(_)
        | ParameterValue::Number(_)
        | ParameterValue::Table(_) => Vec::new(),
    }
}
