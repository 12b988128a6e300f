//! Fields for numbers, colours and words: what a hand makes of them, and why a number is another than was typed.

use crate::jobs::ArrayChoice;
use crate::theme::{self, Help};
use eframe::egui::color_picker::{Alpha, color_picker_color32};
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{
    Button, Color32, ComboBox, DragValue, FocusDirection, Key, Modifiers, Popup, PopupCloseBehavior, Rect,
    Response, Rgba, RichText, ScrollArea, Sense, Slider, TextEdit, Ui, WidgetInfo, WidgetType, vec2,
};
use std::cell::RefCell;
use voltet_core::arithmetic::decimal;
use voltet_core::colormap::Colormap;
use voltet_document::panel::{Scale, to_text};
use voltet_graph::{LocatedValue, ParameterValue, Range};

/// The largest span that a slider of equal steps serves: beyond, a drag of a few points is a large step.
const SPAN_OF_SLIDER: f64 = 1000.0;

/// Share of a number that a drag over one point changes, and its least step.
const SPEED: f64 = 0.01;
const MIN_STEP: f64 = 1e-3;

/// Width of what is said below a field, points.
pub(crate) const REASON: f32 = 280.0;

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
pub(crate) fn number_field(
    ui: &mut Ui,
    now: Option<f64>,
    range: &Range,
    scale: Option<Scale>,
    remark: &mut Option<String>,
) -> Option<f64> {
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
    let (response, x) = drag(ui, x, range, step, scale.is_none(), remark);
    slid.or((by_hand(&response) && x != before && range.holds(x)).then_some(x))
}

/// Magnitudes from which on a number has an exponent.
const SCIENTIFIC: f64 = 1e6;

/// A number as a file may have it, with all its digits: what is edited from there loses none.
fn stated(x: f64) -> String {
    if x.abs() >= SCIENTIFIC && x.is_finite() {
        format!("{x:e}")
    } else {
        ParameterValue::Number(x).to_string()
    }
}

/// Significant digits from which on a number is one that was computed, of which seven are shown.
const COMPUTED: usize = 15;

/// A number that nobody edits: one of 32 bits has the shortest form that reads back as such, and of one that was computed, such as 1/255,
/// the first digits are shown.
fn shown(x: f64) -> String {
    if f64::from(x as f32) == x && x.abs() < SCIENTIFIC {
        return ParameterValue::Number((x as f32).to_string().parse().unwrap_or(x)).to_string();
    }
    let text = stated(x);
    let digits = text.split('e').next().unwrap_or_default().chars().filter(char::is_ascii_digit);
    if digits.skip_while(|digit| *digit == '0').count() < COMPUTED {
        return text;
    }
    let rounded = format!("{x:.6e}").parse().unwrap_or(x);
    stated(rounded) + "…"
}

/// The number that a text means, with any sign for minus.
fn parsed(text: &str) -> Option<f64> {
    let plain: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    plain.replace('−', "-").parse().ok().filter(|x: &f64| !x.is_nan())
}

/// Reason for which a number field holds another number than was typed; `None` where it does not.
fn correction(text: &str, before: f64, range: &Range, whole: bool) -> Option<String> {
    let Some(x) = parsed(text) else {
        return Some(format!("'{text}' is not a number; {} stays", stated(before)));
    };
    match x.clamp(range.min, range.max) {
        end if end != x && end == range.min => {
            Some(format!("{} is the least: {text} is below it", stated(end)))
        }
        end if end != x => Some(format!("{} is the most: {text} is above it", stated(end))),
        _ if !range.holds(x) => Some(format!("the number is not {text} itself; {} stays", stated(before))),
        _ if whole && x.round() != x => Some(format!("{text} is rounded: the number is a whole one")),
        _ => None,
    }
}

/// A field for a number, and the number that a hand leaves there; `remark`: the reason for which that is another than was typed.
pub(crate) fn drag(
    ui: &mut Ui,
    before: f64,
    range: &Range,
    step: f64,
    whole: bool,
    remark: &mut Option<String>,
) -> (Response, f64) {
    let (mut x, text) = (before, RefCell::new(None));
    let parse = |typed: &str| {
        *text.borrow_mut() = Some(typed.to_string());
        parsed(typed)
    };
    let field = DragValue::new(&mut x).range(range.min..=range.max).speed(step).update_while_editing(false);
    let field = field.custom_parser(parse);
    // Who edits a number begins with all its digits.
    let is_edited = ui.memory(|memory| memory.has_focus(ui.next_auto_id()));
    let text_of = |x: f64| if is_edited { stated(x) } else { shown(x) };
    let field = if whole { field.max_decimals(0) } else { field.custom_formatter(|x, _| text_of(x)) };
    let mut response = ui.add(field);
    if !whole && response.clicked() {
        // The field selects as many letters as it showed; what is typed takes the place of all that is edited.
        let mut state = TextEdit::load_state(ui.ctx(), response.id).unwrap_or_default();
        let end = CCursor::new(stated(before).chars().count());
        state.cursor.set_char_range(Some(CCursorRange::two(CCursor::default(), end)));
        state.store(ui.ctx(), response.id);
    }
    if !whole && text_of(before) != stated(before) {
        response = response.help(stated(before));
    }
    if let Some(typed) = text.into_inner() {
        *remark = correction(&typed, before, range, whole).or(remark.take());
    }
    let x = if whole { x.round() } else { meant(&response, x, step) };
    (response, x)
}

pub(crate) fn numbers(
    ui: &mut Ui,
    now: Option<&ParameterValue>,
    count: usize,
    range: &Range,
    whole: bool,
    remark: &mut Option<String>,
) -> Option<ParameterValue> {
    let mut list = match now {
        Some(ParameterValue::List(list)) => list.iter().map(|part| part.number().unwrap_or(0.0)).collect(),
        _ => vec![range.min.max(0.0).min(range.max); count],
    };
    list.resize(list.len().max(count), 0.0);
    let mut changed = false;
    for number in &mut list {
        let step = if whole { 1.0 } else { (SPEED * number.abs()).max(MIN_STEP) };
        let (response, x) = drag(ui, *number, range, step, whole, remark);
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
pub(crate) fn color(
    ui: &mut Ui,
    now: Option<&ParameterValue>,
    most: f64,
    remark: &mut Option<String>,
) -> Option<ParameterValue> {
    let linear = now.and_then(|now| LocatedValue::from(now.clone()).color()).unwrap_or([1.0; 3]);
    match edited_color(ui, linear) {
        Some(channels) => Some(channels.into_iter().collect()),
        None => numbers(ui, now, 3, &Range::within(0.0, most), false, remark),
    }
}

/// A linear colour as a button that edits it, by its hue or as the screen's code (sRGB); the new one.
pub(crate) fn edited_color(ui: &mut Ui, linear: [f64; 3]) -> Option<[f64; 3]> {
    let brightest = linear.iter().copied().fold(1.0, f64::max);
    let [r, g, b] = linear.map(|x| (x / brightest) as f32);
    let before: Color32 = Rgba::from_rgb(r, g, b).into();
    let mut display = before;
    let button = ui.add(Button::new("").fill(display).min_size(vec2(32.0, 16.0)));
    button.widget_info(|| WidgetInfo::labeled(WidgetType::ColorButton, true, "colour"));
    let menu = Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    menu.show(|ui| color_controls(ui, &mut display));
    button.help(format!("{} in sRGB", hex(before)));
    (display != before).then(|| {
        let linear = Rgba::from(display);
        // A screen has 256 levels of each.
        [linear.r(), linear.g(), linear.b()].map(|x| decimal(f64::from(x) * brightest, 1e-5 * brightest))
    })
}

/// Controls of a colour, which stays what it is until a hand changes it.
fn color_controls(ui: &mut Ui, display: &mut Color32) {
    ui.spacing_mut().slider_width = 220.0;
    // What the package says of a change is true of colours that it rounds on the way to a hue and back, too.
    let _ = color_picker_color32(ui, display, Alpha::Opaque);
    ui.horizontal(|ui| {
        ui.label("sRGB").help("the code of colours on screens; the file has linear numbers");
        if let Some(typed) = hex_field(ui, *display) {
            *display = typed;
        }
    });
}

/// Width and steps of a colour map beside its name, points.
const GRADIENT: f32 = 96.0;
const STEPS: usize = 48;

/// The colours of a map from left to right.
pub(crate) fn gradient(ui: &mut Ui, map: Colormap) {
    let (rect, response) = ui.allocate_exact_size(vec2(GRADIENT, 14.0), Sense::hover());
    response
        .widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, format!("colours of {}", map.name())));
    let curve = map.curve();
    let step = rect.width() / STEPS as f32;
    for i in 0..STEPS {
        let at = Rect::from_min_size(rect.min + vec2(i as f32 * step, 0.0), vec2(step + 0.5, rect.height()));
        let color = theme::on_screen(curve.at((i as f64 + 0.5) / STEPS as f64));
        ui.painter().rect_filled(at.intersect(rect), 0.0, color);
    }
}

fn hex(color: Color32) -> String {
    format!("#{:02x}{:02x}{:02x}", color.r(), color.g(), color.b())
}

/// A field for a colour's code, "#ff8020": the new colour, once it is one.
fn hex_field(ui: &mut Ui, color: Color32) -> Option<Color32> {
    let id = ui.id().with("code");
    let mut text = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| hex(color));
    let response = ui.add(TextEdit::singleline(&mut text).desired_width(70.0).hint_text("#rrggbb"));
    response.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, "code of the colour"));
    let is_whole = text.trim().len() == "#rrggbb".len();
    let typed = Color32::from_hex(text.trim()).ok().filter(|_| is_whole);
    let has_focus = response.has_focus();
    ui.data_mut(|data| match has_focus {
        true => drop(data.insert_temp(id, text.clone())),
        false => data.remove::<String>(id),
    });
    if has_focus && typed.is_none() {
        ui.label(RichText::new("#rrggbb").small().color(theme::wrong(ui.visuals().dark_mode)));
    }
    typed.filter(|_| response.changed())
}

/// Width of a list in a menu, and the most of its height, points.
pub(crate) const LIST_WIDTH: f32 = 230.0;
const LIST_HEIGHT: f32 = 220.0;

/// Area of a list in a menu: as high as its entries, up to a height from which on it scrolls.
pub(crate) fn list_area() -> ScrollArea {
    ScrollArea::vertical().max_height(LIST_HEIGHT).min_scrolled_height(LIST_HEIGHT)
}

/// Has the arrow keys go from entry to entry of an open list, from the chosen one (true) on; Enter takes the entry that has the focus.
pub(crate) fn follow_arrows(ui: &Ui, entries: &[(Response, bool)]) {
    let keys = [Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight];
    let pressed = keys.map(|key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)));
    if pressed.contains(&true) {
        // egui's own way would go on to what lies behind the list.
        ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
    let focused = entries.iter().position(|(entry, _)| entry.has_focus());
    let now = focused.or_else(|| entries.iter().position(|(_, is_chosen)| *is_chosen));
    let next = arrow_step([pressed[0], pressed[1]], now);
    if let Some((entry, _)) = next.and_then(|next| entries.get(next)) {
        entry.request_focus();
        entry.scroll_to_me(None);
    }
}

/// Place in a list that the arrows up and down lead to, from a place or from none; `None` if neither is pressed.
pub(crate) fn arrow_step([up, down]: [bool; 2], now: Option<usize>) -> Option<usize> {
    let next = match now {
        None => 0,
        Some(place) if up => place.saturating_sub(1),
        Some(place) => place + 1,
    };
    (up || down).then_some(next)
}

/// Choice of a word, with the gradients of colour maps; gives the word that is taken.
pub(crate) fn choice(
    ui: &mut Ui,
    key: &str,
    now: Option<&ParameterValue>,
    words: &[(&str, &str)],
) -> Option<ParameterValue> {
    let now = now.map(to_text).unwrap_or_default();
    let mut taken = None;
    ComboBox::from_id_salt(("choice", key)).selected_text(&now).width(150.0).show_ui(ui, |ui| {
        let mut entries = Vec::new();
        for (word, meaning) in words {
            ui.horizontal(|ui| {
                if let Some(map) = Colormap::named(word) {
                    gradient(ui, map);
                }
                let entry = ui.selectable_label(now == *word, *word).help(*meaning);
                if entry.clicked() {
                    taken = Some((*word).into());
                    ui.close();
                }
                entries.push((entry, now == *word));
            });
        }
        follow_arrows(ui, &entries);
    });
    taken
}

/// List of arrays, of which one is taken, or several; gives the names that are.
pub(crate) fn array_list(
    ui: &mut Ui,
    choices: &[&ArrayChoice],
    names: &[String],
    several: bool,
) -> Option<ParameterValue> {
    let (mut taken, mut entries) = (None, Vec::new());
    for array in choices {
        let mut is_taken = names.contains(&array.name);
        let entry = match several {
            true => ui.checkbox(&mut is_taken, &array.label),
            false => ui.selectable_label(is_taken, &array.label),
        };
        if several && entry.changed() {
            let others = names.iter().filter(|name| **name != array.name);
            let all = others.chain(is_taken.then_some(&array.name));
            taken = Some(all.map(String::as_str).collect());
        } else if !several && entry.clicked() {
            taken = Some(ParameterValue::Text(array.name.clone()));
            ui.close();
        }
        entries.push((entry, is_taken));
    }
    follow_arrows(ui, &entries);
    taken
}

pub(crate) fn channels(datum: &ParameterValue) -> Option<[f64; 3]> {
    LocatedValue::from(datum.clone()).color()
}

/// A number, if it is one.
pub(crate) fn number(datum: &ParameterValue) -> Option<f64> {
    LocatedValue::from(datum.clone()).number()
}

/// Texts of a list, or the one that it is.
pub(crate) fn texts(datum: &ParameterValue) -> Vec<String> {
    let value = LocatedValue::from(datum.clone());
    let parts = value.list().unwrap_or(std::slice::from_ref(&value));
    parts.iter().filter_map(|part| part.text().map(str::to_string)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_not_taken_as_typed_is_explained() {
        let share = Range::within(0.0, 1.0);
        let why = |text: &str| correction(text, 0.5, &share, false);
        assert_eq!(why("0.25"), None);
        assert_eq!(why(" −0 "), None);
        assert_eq!(why("a bit").unwrap(), "'a bit' is not a number; 0.5 stays");
        assert_eq!(why("3").unwrap(), "1.0 is the most: 3 is above it");
        assert_eq!(why("-inf").unwrap(), "0.0 is the least: -inf is below it");
        assert!(correction("2.5", 2.0, &Range::ANY, true).unwrap().contains("rounded"));
        assert!(correction("0", 1.0, &Range::above(0.0), false).is_some());
    }

    #[test]
    fn long_numbers_have_an_exponent_and_all_digits() {
        for (x, text) in
            [(2.5, "2.5"), (123456.5, "123456.5"), (1.0e6, "1e6"), (-12_345_678.25, "-1.234567825e7")]
        {
            assert_eq!(stated(x), text);
            assert_eq!(parsed(text), Some(x));
        }
    }

    #[test]
    fn a_number_that_nobody_edits_is_short() {
        for (x, text) in [
            (1.0 / 255.0, "0.003921569…"),
            (f64::from(0.1f32), "0.1"),
            (0.1, "0.1"),
            (101_325.023_437, "101325.023437"),
            (-1.0 / 3.0, "-0.3333333…"),
            (2.0, "2.0"),
            (1e12 / 3.0, "3.333333e11…"),
        ] {
            assert_eq!(shown(x), text);
        }
    }

    #[test]
    fn what_is_typed_into_a_shortened_number_takes_the_place_of_all_its_digits() {
        let held = std::rc::Rc::new(std::cell::Cell::new(1.0 / 255.0));
        let of_field = held.clone();
        let mut harness = egui_kittest::Harness::new_ui(move |ui| {
            let (_, x) = drag(ui, of_field.get(), &Range::ANY, 0.1, false, &mut None);
            of_field.set(x);
        });
        let at = eframe::egui::pos2(20.0, 16.0);
        for events in [
            vec![eframe::egui::Event::PointerMoved(at)],
            vec![press(at, true)],
            vec![press(at, false)],
            vec![],
            vec![eframe::egui::Event::Text("0.5".into())],
            vec![],
        ] {
            harness.input_mut().events.extend(events);
            harness.step();
        }
        harness.key_press(Key::Enter);
        harness.run_steps(2);
        assert_eq!(held.get(), 0.5);
    }

    fn press(pos: eframe::egui::Pos2, pressed: bool) -> eframe::egui::Event {
        let (button, modifiers) = (eframe::egui::PointerButton::Primary, Modifiers::NONE);
        eframe::egui::Event::PointerButton { pos, button, pressed, modifiers }
    }

    #[test]
    fn a_colour_that_is_looked_at_stays_as_it_is() {
        let mut harness = egui_kittest::Harness::new_ui(|ui| {
            for level in 0..=255 {
                let before = Color32::from_gray(level);
                let mut display = before;
                ui.push_id(level, |ui| color_controls(ui, &mut display));
                assert_eq!(display, before);
                let linear = Rgba::from(before);
                assert_eq!(Color32::from(Rgba::from_rgb(linear.r(), linear.g(), linear.b())), before);
            }
        });
        harness.run_steps(2);
    }
}
