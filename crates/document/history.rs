//! Undo and redo: steps that each know the way on and the way back.

use crate::delta::Delta;

/// Gesture: all edits of one drag are one undo step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gesture(pub u64);

/// One step: a change of the text.
#[derive(Debug, Clone)]
struct EditStep {
    label: String,
    delta: Delta,
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
    pub fn of_saved() -> History {
        History { saved: Some(0), ..History::default() }
    }

    /// Takes a change in; what was undone is forgotten. One of the same gesture as the last step becomes part of it.
    pub fn record(&mut self, label: String, delta: Delta, gesture: Option<Gesture>) {
        if delta.is_empty() {
            return;
        }
        self.steps.truncate(self.cursor);
        self.saved = self.saved.filter(|saved| *saved <= self.cursor);
        let is_saved = self.is_saved();
        match self.steps.last_mut().filter(|last| gesture.is_some() && last.gesture == gesture && !is_saved) {
            Some(last) => {
                last.delta = last.delta.then(&delta);
                if last.delta.is_empty() {
                    self.steps.pop();
                }
            }
            None => self.steps.push(EditStep { label, delta, gesture }),
        }
        self.cursor = self.steps.len();
    }

    /// The way back over the last step that is done, which is undone now.
    pub fn back(&mut self) -> Option<Delta> {
        let step = self.steps.get_mut(self.cursor.checked_sub(1)?)?;
        step.gesture = None;
        self.cursor -= 1;
        Some(step.delta.inverse())
    }

    /// The way on over the first step that is undone, which is done now.
    pub fn on(&mut self) -> Option<Delta> {
        let step = self.steps.get(self.cursor)?;
        self.cursor += 1;
        Some(step.delta.clone())
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
    pub fn save(&mut self) {
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
        self.steps.iter().map(|step| step.delta.size()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(history: &mut History, text: &mut String, new: &str, gesture: Option<Gesture>) {
        let delta = Delta::between(text, new);
        *text = delta.applied(text).unwrap();
        history.record(new.to_string(), delta, gesture);
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
        assert_eq!(history.back().unwrap().applied("e").unwrap(), "d");
        assert!(history.is_saved());
        assert_eq!(history.on().unwrap().applied("d").unwrap(), "e");
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
        text = history.back().unwrap().applied(&text).unwrap();
        assert_eq!((history.undo_label(), history.redo_label()), (None, Some("b")));
        typed(&mut history, &mut text, "c", None);
        assert_eq!(history.redo_label(), None);
        assert!(!history.is_saved());
        history.back();
        assert!(!history.is_saved(), "what was saved was cut off");
    }
}
