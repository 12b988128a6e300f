//! The widget for a value, by its declared type.

use super::{ParameterPanel, Table};
use eframe::egui::{Color32, ComboBox, DragValue, Response, Rgba, Slider, Ui};
use voltet_core::graph::{Datum, Parameter, ParameterType, Range, Setting};

/// The largest span that a slider serves: beyond, a drag of a few points is a large step.
const SPAN_OF_SLIDER: f64 = 1000.0;

impl ParameterPanel {
    /// Shows a value; gives another one where a hand made it.
    pub(super) fn value(&mut self, ui: &mut Ui, table: &Table, parameter: &Parameter) -> Option<Datum> {
        let stated = table.stated(parameter.name).map(|setting| setting.datum.clone());
        let now = stated.or_else(|| parameter.standard.datum());
        let key = table.key(parameter.name);
        self.of_type(ui, table, parameter, &parameter.parameter_type, now, &key)
    }

    fn of_type(
        &mut self,
        ui: &mut Ui,
        table: &Table,
        parameter: &Parameter,
        parameter_type: &ParameterType,
        now: Option<Datum>,
        key: &str,
    ) -> Option<Datum> {
        match parameter_type {
            ParameterType::Boolean => {
                let mut flag = now == Some(Datum::Boolean(true));
                ui.checkbox(&mut flag, "").changed().then_some(Datum::Boolean(flag))
            }
            ParameterType::Integer(range) => {
                let mut x = now.as_ref().and_then(number).unwrap_or(range.min.max(0.0));
                let field = DragValue::new(&mut x)
                    .range(range.min..=range.max)
                    .speed(0.2)
                    .update_while_editing(false);
                by_hand(&ui.add(field.max_decimals(0))).then_some(Datum::Integer(x.round() as i64))
            }
            ParameterType::Number(range) => {
                number_field(ui, now.as_ref().and_then(number), range).map(Datum::Number)
            }
            ParameterType::NumberOr(range, word) => {
                let mut is_word = !matches!(now, Some(Datum::Number(_) | Datum::Integer(_)));
                if ui.checkbox(&mut is_word, *word).changed() {
                    return Some(if is_word { Datum::Text(word.to_string()) } else { Datum::Number(1.0) });
                }
                if is_word {
                    return None;
                }
                number_field(ui, now.as_ref().and_then(number), range).map(Datum::Number)
            }
            ParameterType::Choice(words) => choice(ui, key, now.as_ref(), words),
            ParameterType::GradientFilter => {
                let filters = table.scene.registry.filters();
                let words: Vec<(&str, &str)> =
                    filters.map(|filter| (filter.declaration().name, filter.declaration().summary)).collect();
                choice(ui, key, now.as_ref(), &words)
            }
            ParameterType::Text => self.text_or_array(ui, table, parameter, now.as_ref(), key),
            ParameterType::InputPath | ParameterType::OutputPath => {
                let text = now.as_ref().and_then(text).unwrap_or_default();
                self.typed_text(ui, key, &text, 220.0, "path").map(Datum::Text)
            }
            ParameterType::Numbers(_, range) => {
                if parameter.name == "color" || parameter.name == "background" {
                    return color(ui, now.as_ref());
                }
                let count = match parameter_type {
                    ParameterType::Numbers(Some(count), _) => *count,
                    _ => 0,
                };
                numbers(ui, now.as_ref(), count, range, false)
            }
            ParameterType::Integers(count, range) => numbers(ui, now.as_ref(), *count, range, true),
            ParameterType::Measured(measured) => {
                if is_relative(now.as_ref()) {
                    // As text: "25 %", "p90".
                    let written = now.map_or(String::new(), |now| now.to_string());
                    let typed = self.typed_text(ui, key, &written, 160.0, "25 %, p90")?;
                    return typed_datum(&typed);
                }
                self.of_type(ui, table, parameter, &measured.plain, now, key)
            }
            ParameterType::Rows(_) | ParameterType::Texts => {
                let written = now.map_or(String::new(), |now| now.to_string());
                let typed = self.typed_text(ui, key, &written, 260.0, "[…]")?;
                typed_datum(&typed)
            }
            ParameterType::Table(_) | ParameterType::Kinds(_) => None,
        }
    }

    /// Any text; the arrays of the data to choose from where the parameter names one.
    fn text_or_array(
        &mut self,
        ui: &mut Ui,
        table: &Table,
        parameter: &Parameter,
        now: Option<&Datum>,
        key: &str,
    ) -> Option<Datum> {
        let text = now.and_then(text).unwrap_or_default();
        let mut taken = None;
        if super::arrays::names_array(parameter) {
            let arrays = self.arrays.of(ui.ctx(), table.scene, table.node);
            if !arrays.is_empty() {
                ComboBox::from_id_salt(("arrays", key)).selected_text("▾").width(24.0).show_ui(ui, |ui| {
                    for array in arrays.iter() {
                        let row = ui.selectable_label(array.name == text, &array.label);
                        if row.clicked() {
                            taken = Some(Datum::Text(array.name.clone()));
                        }
                    }
                });
            }
        }
        taken.or_else(|| self.typed_text(ui, key, &text, 160.0, "").map(Datum::Text))
    }
}

/// Whether a hand changed it: to be shown rounded or within its range is no change.
fn by_hand(response: &Response) -> bool {
    response.changed()
        && (response.dragged() || response.drag_stopped() || response.lost_focus() || response.has_focus())
}

/// A value to begin with where nothing is stated and nothing holds; none for types that are typed as text.
pub(super) fn first(parameter_type: &ParameterType) -> Option<Datum> {
    let within = |range: &Range| 1.0f64.clamp(range.min, range.max);
    let several = |count: usize, one: Datum| Datum::List(vec![Setting::from(one); count]);
    match parameter_type {
        ParameterType::Integer(range) => Some(Datum::Integer(within(range) as i64)),
        ParameterType::Number(range) | ParameterType::NumberOr(range, _) => {
            Some(Datum::Number(within(range)))
        }
        ParameterType::Numbers(Some(2), range) if range.min < 0.0 => {
            Some(Datum::List([0.0, 1.0].map(|x| Setting::from(Datum::Number(x))).to_vec()))
        }
        ParameterType::Numbers(Some(count), range) => Some(several(*count, Datum::Number(within(range)))),
        ParameterType::Integers(count, range) => Some(several(*count, Datum::Integer(within(range) as i64))),
        ParameterType::Measured(measured) => first(&measured.plain),
        ParameterType::Boolean
        | ParameterType::Text
        | ParameterType::Choice(_)
        | ParameterType::InputPath
        | ParameterType::OutputPath
        | ParameterType::Numbers(None, _)
        | ParameterType::Rows(_)
        | ParameterType::Texts
        | ParameterType::Table(_)
        | ParameterType::Kinds(_)
        | ParameterType::GradientFilter => None,
    }
}

/// A number: with a slider where its range is not wide.
fn number_field(ui: &mut Ui, now: Option<f64>, range: &Range) -> Option<f64> {
    let mut x = now.unwrap_or(range.min.max(0.0).min(range.max));
    let span = range.max - range.min;
    let response = if span.is_finite() && span <= SPAN_OF_SLIDER {
        ui.add(Slider::new(&mut x, range.min..=range.max).max_decimals(6))
    } else {
        let speed = (x.abs() * 0.01).max(1e-3);
        let field = DragValue::new(&mut x).range(range.min..=range.max).speed(speed).max_decimals(9);
        ui.add(field.update_while_editing(false).custom_formatter(|x, _| written(x)))
    };
    (by_hand(&response) && range.holds(x)).then(|| rounded(x))
}

fn numbers(ui: &mut Ui, now: Option<&Datum>, count: usize, range: &Range, whole: bool) -> Option<Datum> {
    let mut list: Vec<f64> = match now {
        Some(Datum::List(list)) => list.iter().map(|setting| setting.number().unwrap_or(0.0)).collect(),
        _ => vec![range.min.max(0.0).min(range.max); count],
    };
    list.resize(list.len().max(count), 0.0);
    let mut changed = false;
    for x in &mut list {
        let speed = if whole { 1.0 } else { (x.abs() * 0.01).max(1e-3) };
        let field = DragValue::new(x).range(range.min..=range.max).speed(speed).max_decimals(if whole {
            0
        } else {
            9
        });
        let field = field.update_while_editing(false).custom_formatter(|x, _| written(x));
        changed |= by_hand(&ui.add(field));
    }
    changed.then(|| {
        let datum = |x: f64| if whole { Datum::Integer(x.round() as i64) } else { Datum::Number(rounded(x)) };
        Datum::List(list.into_iter().map(|x| Setting::from(datum(x))).collect())
    })
}

/// A colour, linear in the file; brighter than the screen is kept by its factor.
fn color(ui: &mut Ui, now: Option<&Datum>) -> Option<Datum> {
    let linear = numbers_of(now).unwrap_or([1.0; 3]);
    let brightest = linear.iter().copied().fold(1.0, f64::max);
    let [r, g, b] = linear.map(|x| (x / brightest) as f32);
    let mut shown: Color32 = Rgba::from_rgb(r, g, b).into();
    if !ui.color_edit_button_srgba(&mut shown).changed() {
        return numbers(ui, now, 3, &Range::at_least(0.0), false);
    }
    let linear = Rgba::from(shown);
    let channels = [linear.r(), linear.g(), linear.b()].map(|x| rounded(f64::from(x) * brightest));
    Some(Datum::List(channels.map(|x| Setting::from(Datum::Number(x))).to_vec()))
}

pub(super) fn numbers_of<const N: usize>(datum: Option<&Datum>) -> Option<[f64; N]> {
    let Some(Datum::List(list)) = datum else { return None };
    list.iter().map(Setting::number).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

fn choice(ui: &mut Ui, key: &str, now: Option<&Datum>, words: &[(&str, &str)]) -> Option<Datum> {
    let now = now.and_then(text).unwrap_or_default();
    let mut taken = None;
    ComboBox::from_id_salt(("choice", key)).selected_text(&now).width(150.0).show_ui(ui, |ui| {
        for (word, meaning) in words {
            if ui.selectable_label(now == *word, *word).on_hover_text(*meaning).clicked() {
                taken = Some(Datum::Text(word.to_string()));
            }
        }
    });
    taken
}

/// Whether numbers are given relative to the data, as texts.
fn is_relative(now: Option<&Datum>) -> bool {
    match now {
        Some(Datum::Text(_)) => true,
        Some(Datum::List(list)) => list.iter().any(|part| is_relative(Some(&part.datum))),
        _ => false,
    }
}

fn number(datum: &Datum) -> Option<f64> {
    Setting::from(datum.clone()).number()
}

fn text(datum: &Datum) -> Option<String> {
    match datum {
        Datum::Text(text) => Some(text.clone()),
        _ => None,
    }
}

/// Six digits; no more than a hand can mean.
fn rounded(x: f64) -> f64 {
    if x.is_finite() { format!("{x:.6e}").parse().unwrap_or(x) } else { x }
}

/// As short as it can be read back.
fn written(x: f64) -> String {
    let x = rounded(x);
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) || !x.is_finite() {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// What was typed, as a file would have it.
fn typed_datum(text: &str) -> Option<Datum> {
    let document =
        format!("[pipeline]\nformat = 1\n[nodes.a]\ntype = \"t\"\nx = {}\n", text.replace('\n', " "));
    let pipeline = voltet_core::pipeline::Pipeline::parse(&document).ok()?;
    pipeline
        .nodes
        .first()?
        .settings
        .iter()
        .find(|field| field.name == "x")
        .map(|field| field.setting.datum.clone())
}
