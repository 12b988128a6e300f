//! Undo and redo: steps that each know the way on and the way back.

use voltet_core::{Error, Result};

/// Gesture: all edits of one drag are one undo step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gesture(pub u64);

/// The way from one text to another: what takes the place of a range of bytes. What lies outside is not touched, and turning it
/// round gives back the former text to the byte.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Change {
    offset: usize,
    old: String,
    new: String,
}

impl Change {
    /// Difference between the longest equal beginnings and ends.
    fn between(old: &str, new: &str) -> Change {
        let equal = |pairs: &mut dyn Iterator<Item = (char, char)>| {
            pairs.take_while(|(a, b)| a == b).map(|(a, _)| a.len_utf8()).sum::<usize>()
        };
        let offset = equal(&mut old.chars().zip(new.chars()));
        let (old, new) = (&old[offset..], &new[offset..]);
        let end = equal(&mut old.chars().rev().zip(new.chars().rev()));
        let without_end = |text: &str| text[..text.len() - end].to_string();
        Change { offset, old: without_end(old), new: without_end(new) }
    }

    fn is_empty(&self) -> bool {
        self.old == self.new
    }

    /// The way back.
    fn inverse(&self) -> Change {
        Change { offset: self.offset, old: self.new.clone(), new: self.old.clone() }
    }

    /// The later text. Errors: `text` is not the former one.
    fn applied(&self, text: &str) -> Result<String> {
        let rest = text.get(self.offset..).and_then(|rest| rest.strip_prefix(self.old.as_str()));
        let wrong = || Error::run("a step of the history does not belong to this text");
        Ok([&text[..self.offset.min(text.len())], &self.new, rest.ok_or_else(wrong)?].concat())
    }
}

#[derive(Debug, Clone)]
struct EditStep {
    label: String,
    change: Change,
    gesture: Option<Gesture>,
}

/// The steps of a document, and how many of them hold now.
#[derive(Debug, Clone, Default)]
pub struct History {
    steps: Vec<EditStep>,
    /// Number of steps done; later ones are undone.
    cursor: usize,
    /// The cursor at which the text is as its file; none where no cursor leads there.
    saved: Option<usize>,
}

impl History {
    /// History of a text that equals its file.
    pub(crate) fn of_saved() -> History {
        History { saved: Some(0), ..History::default() }
    }

    /// Takes a change in; what was undone is forgotten. One of the same gesture as the last step becomes part of it.
    pub(crate) fn record(
        &mut self,
        label: String,
        old: &str,
        new: &str,
        gesture: Option<Gesture>,
    ) -> Result<()> {
        if old == new {
            return Ok(());
        }
        self.steps.truncate(self.cursor);
        self.saved = self.saved.filter(|saved| *saved <= self.cursor);
        let is_saved = self.is_saved();
        match self.steps.last_mut().filter(|last| gesture.is_some() && last.gesture == gesture && !is_saved) {
            Some(last) => {
                last.change = Change::between(&last.change.inverse().applied(old)?, new);
                if last.change.is_empty() {
                    self.steps.pop();
                }
            }
            None => self.steps.push(EditStep { label, change: Change::between(old, new), gesture }),
        }
        self.cursor = self.steps.len();
        Ok(())
    }

    /// The text before the last step that is done, which is undone now; none where there is none.
    pub(crate) fn undo(&mut self, text: &str) -> Result<Option<String>> {
        let Some(step) = self.cursor.checked_sub(1).and_then(|last| self.steps.get_mut(last)) else {
            return Ok(None);
        };
        step.gesture = None;
        self.cursor -= 1;
        step.change.inverse().applied(text).map(Some)
    }

    /// The text after the first step that is undone, which is done now; none where there is none.
    pub(crate) fn redo(&mut self, text: &str) -> Result<Option<String>> {
        let Some(step) = self.steps.get(self.cursor) else { return Ok(None) };
        self.cursor += 1;
        step.change.applied(text).map(Some)
    }

    /// Description of the step that undo would revert.
    pub fn undo_label(&self) -> Option<&str> {
        Some(&self.steps.get(self.cursor.checked_sub(1)?)?.label)
    }

    /// Description of the step that redo would repeat.
    pub fn redo_label(&self) -> Option<&str> {
        Some(&self.steps.get(self.cursor)?.label)
    }

    /// The text is as its file now.
    pub(crate) fn save(&mut self) {
        self.saved = Some(self.cursor);
    }

    /// True if the text is as its file.
    pub fn is_saved(&self) -> bool {
        self.saved == Some(self.cursor)
    }

    /// Number of steps done, and number of steps.
    pub fn position(&self) -> (usize, usize) {
        (self.cursor, self.steps.len())
    }

    /// The bytes of text that the steps keep.
    pub fn size(&self) -> usize {
        self.steps.iter().map(|step| step.change.old.len() + step.change.new.len()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(history: &mut History, text: &mut String, new: &str, gesture: Option<Gesture>) {
        history.record(new.to_string(), text, new, gesture).unwrap();
        *text = new.to_string();
    }

    #[test]
    fn a_change_turned_round_gives_the_text_back() {
        let texts = ["añb = 12 # ñ\nc = 3\n", "añb = 100 # ñ\ncé = 3", "", "ñ", "aab", "ab"];
        for (old, new) in texts.iter().flat_map(|old| texts.map(|new| (*old, new))) {
            let change = Change::between(old, new);
            assert_eq!(change.applied(old).unwrap(), new);
            assert_eq!(change.inverse().applied(new).unwrap(), old);
        }
        assert!(Change::between("abc", "xbc").applied("bbc").is_err(), "another text");
        assert!(Change::between("abc", "abd").applied("a").is_err(), "a shorter text");
    }

    #[test]
    fn a_gesture_is_one_step_until_it_is_saved_or_undone() {
        let (mut history, mut text) = (History::of_saved(), "a".to_string());
        let drag = Some(Gesture(1));
        for new in ["b", "c", "d"] {
            typed(&mut history, &mut text, new, drag);
        }
        assert_eq!(history.position(), (1, 1));
        history.save();
        typed(&mut history, &mut text, "e", drag);
        assert_eq!(history.position(), (2, 2));
        assert_eq!(history.undo("e").unwrap().unwrap(), "d");
        assert!(history.is_saved());
        assert_eq!(history.redo("d").unwrap().unwrap(), "e");
        assert!(!history.is_saved());
        typed(&mut history, &mut text, "f", drag);
        assert_eq!(history.position(), (3, 3), "a gesture ends where it is undone");
    }

    #[test]
    fn a_drag_back_to_its_beginning_is_no_step() {
        let (mut history, mut text) = (History::of_saved(), "a".to_string());
        typed(&mut history, &mut text, "b", Some(Gesture(7)));
        typed(&mut history, &mut text, "a", Some(Gesture(7)));
        assert_eq!(history.position(), (0, 0));
        assert!(history.is_saved());
    }

    #[test]
    fn a_new_edit_cuts_what_was_undone_and_the_way_to_what_was_saved() {
        let (mut history, mut text) = (History::of_saved(), "a".to_string());
        typed(&mut history, &mut text, "b", None);
        history.save();
        text = history.undo(&text).unwrap().unwrap();
        assert_eq!((history.undo_label(), history.redo_label()), (None, Some("b")));
        typed(&mut history, &mut text, "c", None);
        assert_eq!(history.redo_label(), None);
        assert!(!history.is_saved());
        history.undo(&text).unwrap();
        assert!(!history.is_saved(), "what was saved was cut off");
    }
}
