//! Texts that are being typed: an edit once they are done, or the reason why they cannot be one.

use crate::theme;
use eframe::egui::{Label, RichText, TextEdit, Ui};
use std::collections::HashMap;
use voltet_document::panel::{Row, to_text, typed};
use voltet_graph::ParameterValue;

/// Width of a reason, points.
const REASON: f32 = 280.0;

/// Texts being typed, by the keys of their fields.
#[derive(Default)]
pub(super) struct Typing {
    texts: HashMap<String, String>,
    /// A text that says nothing right: whose, itself, why.
    refused: Option<[String; 3]>,
    /// The field that is to have the keys.
    wants_focus: Option<String>,
}

impl Typing {
    /// True if a text is unfinished or invalid.
    pub fn holds(&self, key: &str) -> bool {
        self.texts.contains_key(key) || self.refused(key).is_some()
    }

    /// A text begins where there was none.
    pub fn begin(&mut self, key: &str, text: String) {
        self.texts.insert(key.to_string(), text);
        self.wants_focus = Some(key.to_string());
    }

    fn refused(&self, key: &str) -> Option<&[String; 3]> {
        self.refused.as_ref().filter(|refused| refused[0] == key)
    }

    /// A field that gives its text once it is done and another than before.
    pub fn line(&mut self, ui: &mut Ui, key: &str, now: &str, width: f32, hint: &str) -> Option<String> {
        let begun = self.texts.get(key).or_else(|| self.refused(key).map(|refused| &refused[1]));
        let mut text = begun.cloned().unwrap_or_else(|| now.to_string());
        let field = TextEdit::singleline(&mut text).id_salt(key).desired_width(width).hint_text(hint);
        let response = ui.add(field);
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
    pub fn value(
        &mut self,
        ui: &mut Ui,
        key: &str,
        row: &Row,
        width: f32,
        hint: &str,
    ) -> Option<ParameterValue> {
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

    /// Shows why the text of a row is refused.
    pub fn say_why_refused(&self, ui: &mut Ui, key: &str) {
        if let Some([_, _, why]) = self.refused(key) {
            let color = theme::wrong(ui.visuals().dark_mode);
            ui.set_max_width(REASON);
            ui.add(Label::new(RichText::new(why).small().color(color)).wrap());
        }
    }
}
