//! Field for an expression: names of arrays and functions are completed while they are typed, signatures stand at functions, and the first
//! fault is pointed at.

use crate::jobs::ArrayChoice;
use crate::theme::{self, Help};
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::text_edit::TextEditOutput;
use eframe::egui::{
    Align2, EventFilter, FontId, Id, Key, Label, Modifiers, Popup, PopupCloseBehavior, Response, RichText,
    Sense, TextEdit, Ui, pos2, vec2,
};
use voltet_core::expression::Expression;

/// Functions and constants of expressions: name, signature, meaning.
const SIGNATURES: &[(&str, &str, &str)] = &[
    ("abs", "abs(a)", "magnitude"),
    ("sqrt", "sqrt(a)", "square root"),
    ("cbrt", "cbrt(a)", "cube root"),
    ("exp", "exp(a)", "e to the power a"),
    ("ln", "ln(a)", "natural logarithm"),
    ("log10", "log10(a)", "logarithm to the base 10"),
    ("sin", "sin(a)", "sine of an angle, radians"),
    ("cos", "cos(a)", "cosine of an angle, radians"),
    ("tan", "tan(a)", "tangent of an angle, radians"),
    ("asin", "asin(a)", "angle of a sine, radians"),
    ("acos", "acos(a)", "angle of a cosine, radians"),
    ("atan", "atan(a)", "angle of a tangent, radians"),
    ("sinh", "sinh(a)", "hyperbolic sine"),
    ("cosh", "cosh(a)", "hyperbolic cosine"),
    ("tanh", "tanh(a)", "hyperbolic tangent"),
    ("floor", "floor(a)", "whole number below"),
    ("ceil", "ceil(a)", "whole number above"),
    ("min", "min(a, b)", "the lesser"),
    ("max", "max(a, b)", "the greater"),
    ("atan2", "atan2(y, x)", "angle of a direction in the plane, radians"),
    ("pow", "pow(a, b)", "a to the power b"),
    ("mag", "mag(V)", "length of a vector array"),
    ("gradient_magnitude", "gradient_magnitude(s)", "length of the gradient of an array"),
    ("vorticity", "vorticity(V)", "length of the curl of a vector array"),
    ("divergence", "divergence(V)", "divergence of a vector array"),
    ("q_criterion", "q_criterion(V)", "Q of a vector array"),
    ("pi", "pi", "3.14159 …"),
];

/// Longest list that is shown.
const MAX_OFFERS: usize = 8;

/// A word that may take the place of what is typed.
#[derive(Debug, Clone, PartialEq)]
struct Offer {
    label: String,
    /// Text that is inserted, in place of the characters from `start` up to `end`.
    insert: String,
    start: usize,
    end: usize,
}

/// State of the field that has the focus.
#[derive(Debug, Default)]
pub(crate) struct ExpressionField {
    offers: Vec<Offer>,
    chosen: usize,
    /// Text of the last frame; `None` before the field has the focus. Words are offered for what is typed alone.
    text: Option<String>,
    /// True once a letter was typed since a word was taken, the list was closed or the cursor moved.
    is_typed: bool,
    /// Cursor of the last frame, in characters.
    cursor: Option<usize>,
    /// True from the press that took a word of the list until the button is up: the field keeps the focus.
    is_held: bool,
}

impl ExpressionField {
    /// Shows the field, its list and its fault. `arrays`: those of the data.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        key: &str,
        text: &mut String,
        width: f32,
        arrays: &[&ArrayChoice],
    ) -> Response {
        let id = Id::new(("expression", key));
        let has_focus = ui.memory(|memory| memory.has_focus(id));
        if has_focus {
            self.read_keys(ui, id, text);
        }
        let output = ui.vertical(|ui| {
            ui.set_min_width(width);
            let field = TextEdit::singleline(text).id(id).desired_width(width).hint_text("sqrt(u*u + v*v)");
            // Tab takes a word of the list while there is one.
            let output = field.lock_focus(has_focus && !self.offers.is_empty()).show(ui);
            if has_focus && !self.offers.is_empty() {
                // Escape closes the list, and leaves the field once there is none.
                let [tab, horizontal_arrows, vertical_arrows, escape] = [true; 4];
                let all = EventFilter { tab, horizontal_arrows, vertical_arrows, escape };
                ui.memory_mut(|memory| memory.set_focus_lock_filter(id, all));
            }
            point_at_fault(ui, text, &output, has_focus);
            output
        });
        let output = output.inner;
        let response = output.response.response.clone();
        let cursor = output.cursor_range.and_then(|range| range.single()).filter(|_| has_focus);
        let cursor = cursor.map(|cursor| cursor.index.0);
        match &self.text {
            Some(before) if before != text => self.is_typed = true,
            _ if cursor != self.cursor => self.is_typed = false,
            _ => {}
        }
        (self.text, self.cursor) = (has_focus.then(|| text.clone()), cursor);
        let offers = cursor.filter(|_| self.is_typed).map(|cursor| offers(text, cursor, arrays));
        self.take_offers(offers.unwrap_or_default());
        self.list(ui, &response, text);
        if self.is_held {
            response.request_focus();
            self.is_held = ui.input(|input| input.pointer.any_down());
        }
        let word = response.hover_pos().and_then(|at| {
            let place = output.galley.cursor_from_pos(at - output.galley_pos).index.0;
            word_at(text, place)
        });
        match word.and_then(|word| SIGNATURES.iter().find(|known| known.0 == word)) {
            Some((_, signature, help)) => response.help(format!("{signature}: {help}")),
            None => response,
        }
    }

    /// Lists other words, from the first; the same ones, of which more is known, leave the choice.
    fn take_offers(&mut self, offers: Vec<Offer>) {
        let words = |offers: &[Offer]| offers.iter().map(|offer| offer.insert.clone()).collect::<Vec<_>>();
        if words(&offers) != words(&self.offers) {
            self.chosen = 0;
        }
        self.offers = offers;
    }

    fn read_keys(&mut self, ui: &Ui, id: Id, text: &mut String) {
        let Some(last) = self.offers.len().checked_sub(1) else { return };
        let pressed = |key: Key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        if pressed(Key::ArrowDown) {
            self.chosen = if self.chosen == last { 0 } else { self.chosen + 1 };
        }
        if pressed(Key::ArrowUp) {
            self.chosen = if self.chosen == 0 { last } else { self.chosen - 1 };
        }
        if pressed(Key::Escape) {
            self.close();
        } else if pressed(Key::Tab) | pressed(Key::Enter) {
            self.take(ui, id, text, self.chosen);
        }
    }

    /// Closes the list until something is typed.
    fn close(&mut self) {
        self.offers.clear();
        self.is_typed = false;
    }

    /// Puts a word of the list into the text, and the cursor behind it.
    fn take(&mut self, ui: &Ui, id: Id, text: &mut String, number: usize) {
        let Some(Offer { insert, start, end, .. }) = self.offers.get(number).cloned() else { return };
        let (before, after) = (text.chars().take(start), text.chars().skip(end));
        *text = before.chain(insert.chars()).chain(after).collect();
        let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
        let end = CCursor::new(start + insert.chars().count());
        state.cursor.set_char_range(Some(CCursorRange::one(end)));
        state.store(ui.ctx(), id);
        (self.text, self.cursor) = (Some(text.clone()), Some(end.index.0));
        self.close();
    }

    /// The list below the field. A word is taken as the button goes down, before the field would be left.
    fn list(&mut self, ui: &Ui, response: &Response, text: &mut String) {
        if self.offers.is_empty() {
            return;
        }
        let popup = Popup::from_response(response).open(true).gap(2.0);
        let popup = popup.id(response.id.with("list")).close_behavior(PopupCloseBehavior::IgnoreClicks);
        let mut taken = None;
        popup.show(|ui| {
            for (number, offer) in self.offers.iter().enumerate() {
                let row = ui.selectable_label(number == self.chosen, &offer.label);
                if row.is_pointer_button_down_on() {
                    taken = Some(number);
                }
            }
        });
        if let Some(number) = taken {
            self.take(ui, response.id, text, number);
            self.is_held = true;
        }
    }
}

/// The letters that a name has without quotes.
fn is_plain(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

/// The name around a character.
fn word_at(text: &str, place: usize) -> Option<String> {
    let letters: Vec<char> = text.chars().collect();
    let start =
        letters[..place.min(letters.len())].iter().rposition(|c| !is_plain(*c)).map_or(0, |at| at + 1);
    let word: String = letters[start..].iter().take_while(|c| is_plain(**c)).collect();
    Some(word).filter(|word| !word.is_empty())
}

/// Functions that take a vector array by its bare name.
const OF_VECTORS: [&str; 4] = ["mag(", "vorticity(", "divergence(", "q_criterion("];

/// Words that may take the place of the word at the cursor; none where that is one of them.
fn offers(text: &str, cursor: usize, arrays: &[&ArrayChoice]) -> Vec<Offer> {
    let letters: Vec<char> = text.chars().collect();
    let (before, after) = letters.split_at(cursor.min(letters.len()));
    let is_quote = |c: &char| ['\'', '"'].contains(c);
    let is_quoted = before.iter().filter(|c| is_quote(c)).count() % 2 == 1;
    let is_of_name = |c: &char| is_plain(*c) || *c == ':';
    let (start, rest) = match is_quoted {
        true => {
            let closing = after.iter().position(is_quote).map(|at| at + 1);
            (before.iter().rposition(is_quote).unwrap_or(0), closing.unwrap_or(0))
        }
        false => {
            let start = before.iter().rposition(|c| !is_of_name(c)).map_or(0, |at| at + 1);
            (start, after.iter().take_while(|c| is_of_name(c)).count())
        }
    };
    let end = before.len() + rest;
    let typed: String = before[start..].iter().filter(|c| !is_quote(c)).collect();
    let whole: String = letters[start..end].iter().filter(|c| !is_quote(c)).collect();
    let begins = typed.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_');
    if !(begins || is_quoted && !typed.is_empty()) {
        return Vec::new();
    }
    let lower = typed.to_lowercase();
    let call: String = before[..start].iter().collect();
    let takes_vector = OF_VECTORS.iter().any(|function| call.trim_end().ends_with(function));
    let array = |array: &ArrayChoice| {
        let vector = array.name.strip_suffix(":magnitude");
        let (name, label) = match vector {
            Some(vector) if takes_vector => (vector, vector.to_string()),
            _ if takes_vector => return None,
            _ => (array.name.as_str(), array.label.clone()),
        };
        let at = name.to_lowercase().find(&lower)?;
        Some((at > 0, Offer { label, insert: in_expression(name), start, end }))
    };
    let word = |(name, signature, help): &(&str, &str, &str)| {
        let insert = if name == signature { name.to_string() } else { format!("{name}(") };
        let offer = Offer { label: format!("{signature}  ({help})"), insert, start, end };
        name.starts_with(&lower).then_some((false, offer))
    };
    let has_words = !is_quoted && !takes_vector;
    let of_words = SIGNATURES.iter().filter(|_| has_words).filter_map(word);
    let mut all: Vec<(bool, Offer)> = arrays.iter().copied().filter_map(array).chain(of_words).collect();
    let is_whole = |insert: &str| [&typed, &whole].contains(&&insert.replace(['(', '\'', '"'], ""));
    if all.iter().any(|(_, offer)| is_whole(&offer.insert)) {
        return Vec::new();
    }
    // Names that begin so come first.
    all.sort_by_key(|(is_inner, _)| *is_inner);
    all.into_iter().map(|(_, offer)| offer).take(MAX_OFFERS).collect()
}

/// The name of an array as an expression has it.
pub(crate) fn in_expression(name: &str) -> String {
    let (own, component) = name.rsplit_once(':').map_or((name, None), |(own, part)| (own, Some(part)));
    let begins = own.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let own = if begins && own.chars().all(is_plain) { own.to_string() } else { format!("'{own}'") };
    component.map_or(own.clone(), |part| format!("{own}:{part}"))
}

/// Points at the character where an expression is wrong, and says why. Its end is no fault while it is typed.
fn point_at_fault(ui: &mut Ui, text: &str, output: &TextEditOutput, is_typed: bool) {
    let Err((error, span)) = Expression::parse(text) else { return };
    if text.is_empty() || is_typed && span.start >= text.trim_end().len() {
        return;
    }
    let character = text[..span.start].chars().count();
    let [left, right] = [character, character + 1].map(|at| output.galley.pos_from_cursor(CCursor::new(at)));
    let color = theme::wrong(ui.visuals().dark_mode);
    let (rect, _) = ui.allocate_exact_size(vec2(output.response.rect.width(), 9.0), Sense::hover());
    let at = pos2(output.galley_pos.x + 0.5 * (left.min.x + right.min.x), rect.top() - 2.0);
    ui.painter().text(at, Align2::CENTER_TOP, "^", FontId::monospace(14.0), color);
    ui.set_max_width(output.response.rect.width().max(200.0));
    ui.add(Label::new(RichText::new(error.to_string()).small().color(color)).wrap());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrays(names: &[&str]) -> Vec<ArrayChoice> {
        let choice = |name: &&str| {
            let name = name.to_string();
            ArrayChoice { label: name.clone(), name, at: None, maker: None }
        };
        names.iter().map(choice).collect()
    }

    #[test]
    fn the_words_are_those_that_expressions_have() {
        for (name, signature, _) in SIGNATURES {
            let found = Expression::parse(signature);
            assert!(found.is_ok() && signature.starts_with(name), "{signature}");
        }
        // The message about an unknown function lists 24, and counts the others.
        let (error, _) = Expression::parse("zzzzzz(a)").unwrap_err();
        let functions = SIGNATURES.iter().filter(|(name, signature, _)| name != signature).count();
        assert!(error.to_string().contains(&format!("and {} more", functions - 24)), "{error}");
    }

    #[test]
    fn the_chosen_word_stays_when_ranges_come() {
        let offer = |insert: &str, label: &str| Offer {
            label: label.into(),
            insert: insert.into(),
            start: 0,
            end: 1,
        };
        let mut field = ExpressionField::default();
        field.take_offers(vec![offer("max(", "max(a, b)"), offer("mass", "mass")]);
        field.chosen = 1;
        field.take_offers(vec![offer("max(", "max(a, b)"), offer("mass", "mass  (points, 0 to 1)")]);
        assert_eq!((field.chosen, field.offers[1].label.as_str()), (1, "mass  (points, 0 to 1)"));
        field.take_offers(vec![offer("max(", "max(a, b)")]);
        assert_eq!(field.chosen, 0);
    }

    #[test]
    fn what_is_typed_is_completed_by_arrays_and_functions() {
        let arrays = arrays(&["speed", "V:magnitude", "V:0", "mass fraction", "sine"]);
        let arrays: Vec<&ArrayChoice> = arrays.iter().collect();
        let of = |text: &str| {
            offers(text, text.chars().count(), &arrays)
                .into_iter()
                .map(|offer| offer.insert)
                .collect::<Vec<_>>()
        };
        assert_eq!(of("2*s"), ["speed", "sine", "sqrt(", "sin(", "sinh(", "'mass fraction'"]);
        assert_eq!(of("V:"), ["V:magnitude", "V:0"]);
        assert_eq!(of("1 + 'mass f"), ["'mass fraction'"]);
        assert_eq!(of("FRAC"), ["'mass fraction'"]);
        assert_eq!([of("speed"), of(""), of("1e3"), of("2 * ")], [[""; 0]; 4]);
        assert_eq!(of("sqrt("), [""; 0]);
        // A function of a vector takes its bare name, which is finished where it stands.
        assert_eq!([of("mag(v"), of("1 + vorticity( V")], [vec!["V"], vec![]]);
        assert_eq!([of("mag(V"), of("'mass fraction")], [[""; 0]; 2]);
    }

    #[test]
    fn the_whole_word_at_the_cursor_is_replaced() {
        let arrays = arrays(&["speed", "mass fraction"]);
        let arrays: Vec<&ArrayChoice> = arrays.iter().collect();
        let of = |text: &str, cursor: usize| {
            let found = offers(text, cursor, &arrays).into_iter();
            found.map(|Offer { insert, start, end, .. }| (insert, start, end)).collect::<Vec<_>>()
        };
        assert_eq!(of("2*speX + 1", 5), [("speed".to_string(), 2, 6)]);
        assert_eq!(of("2*speed + 1", 5), []);
        assert_eq!(of("'mass X' * 2", 5), [("'mass fraction'".to_string(), 0, 8)]);
    }

    #[test]
    fn names_of_other_letters_stand_in_quotes() {
        for name in ["T", "V:0", "mass fraction", "mass fraction:1", "2nd"] {
            let text = in_expression(name);
            assert_eq!(Expression::parse(&text).unwrap().arrays[0].name, name, "{text}");
        }
    }
}
