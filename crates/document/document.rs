//! The document: a pipeline file with its history of undo steps.

use crate::arrange::{USUAL, tidy};
use crate::edit::{Edit, EditContext};
use crate::text::{Draft, Syntax};
use crate::view::View;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::{FORMAT, ParsedPipeline, Pipeline, locate};
use voltet_graph::{NodeEntry, Stamp};

/// A pipeline file that is edited. It is the text: everything else is read from it.
#[derive(Debug, Clone)]
pub struct Document {
    pub(crate) text: Arc<str>,
    pub(crate) syntax: Arc<Syntax>,
    pub(crate) survey: Arc<ParsedPipeline>,
    view: Arc<View>,
    pub(crate) history: History,
    pub(crate) path: Option<PathBuf>,
    /// The file as it was when it was read or written here.
    pub(crate) stamp: Stamp,
    revision: u64,
    /// Positions of nodes that the file gives none, once shown.
    shown: BTreeMap<String, [f64; 2]>,
}

impl Document {
    /// A new pipeline without nodes, not in a file yet.
    pub fn new() -> Document {
        Self::from_text(format!("[pipeline]\nformat = {FORMAT}\n"), None)
    }

    /// A document that begins with a text, the floor of its steps; `path`: where it is, or would be saved. Whatever the text: faults are
    /// asked for later.
    pub fn from_text(text: String, path: Option<PathBuf>) -> Document {
        let (text, syntax, survey) = read(&text);
        let mut document = Document {
            view: Arc::new(View::read(&survey.editor)),
            text,
            syntax,
            survey,
            history: History { saved: Some(0), ..History::default() },
            path,
            stamp: None,
            revision: 0,
            shown: BTreeMap::new(),
        };
        document.show_new();
        document
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The file; none for a document that was never saved.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The folder that paths in it are relative to: that of its file.
    pub fn folder(&self) -> PathBuf {
        self.path.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).to_path_buf()
    }

    /// Pipeline that the text states, as far as it can be read.
    pub fn pipeline(&self) -> &Pipeline {
        &self.survey.pipeline
    }

    /// Comment of a part of a node: the lines directly above it, or the one behind it. `None` where there is none.
    pub fn comment(&self, node: &str, path: &crate::Path) -> Option<String> {
        self.syntax.comment(&self.text, &crate::Path::from(["nodes", node]).and(path))
    }

    /// Contents of the table `[editor]`.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Changes whenever the text does: what was made of the document holds as long as this is the same.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// True if the text is TOML. If it is not, [`Edit::Text`] alone can be done.
    pub fn is_toml(&self) -> bool {
        self.survey.is_toml
    }

    /// Carries out an edit, as a step of its own. Errors: it cannot be done; then nothing has changed.
    pub fn edit(&mut self, edit: &Edit) -> Result<()> {
        self.edit_all(edit.label(), std::slice::from_ref(edit), None)
    }

    /// Carries out several edits, one after the other, as one step. Errors: one cannot be done; then nothing has changed.
    pub fn edit_all(&mut self, label: String, edits: &[Edit], gesture: Option<Gesture>) -> Result<()> {
        let (text, syntax, survey) = self.worked(edits)?;
        self.history.record(label, &self.text, &text, gesture);
        for edit in edits {
            if let Edit::Rename { node, to } = edit
                && let Some(&at) = self.shown.get(node)
            {
                self.shown.insert(to.clone(), at);
            }
        }
        self.take((text, syntax, survey));
        Ok(())
    }

    /// The text after edits, and what it states.
    fn worked(&self, edits: &[Edit]) -> Result<Reading> {
        if let Some(Edit::Text(new)) = edits.last() {
            return Ok(read(new));
        }
        if !self.survey.is_toml {
            let fault = self.survey.faults.first().cloned();
            let error = fault.unwrap_or_else(|| Error::usage("the text is not valid TOML"));
            return Err(error.expected("the text mended first"));
        }
        let shown = |name: &str| self.shown.get(name).copied();
        let draft = Draft::new(self.text.clone(), self.syntax.clone());
        let mut work = EditContext { draft, survey: self.survey.clone(), shown: &shown };
        edits.iter().try_for_each(|edit| work.apply(edit))?;
        Ok((work.draft.text, work.draft.syntax, work.survey))
    }

    /// Undoes the last step; false where there is none.
    pub fn undo(&mut self) -> bool {
        let text = self.history.undo();
        text.map(|text| self.take(read(&text))).is_some()
    }

    /// Does the step again that was undone last; false where there is none.
    pub fn redo(&mut self) -> bool {
        let text = self.history.redo();
        text.map(|text| self.take(read(&text))).is_some()
    }

    fn take(&mut self, (text, syntax, survey): Reading) {
        if *text == *self.text {
            return;
        }
        if survey.editor != self.survey.editor {
            self.view = Arc::new(View::read(&survey.editor));
        }
        (self.text, self.syntax, self.survey) = (text, syntax, survey);
        self.revision += 1;
        self.show_new();
    }

    /// The steps: what undoing would undo, whether there is something unsaved.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// True if nothing would be lost with it: the text is as its file, or as it was begun.
    pub fn is_saved(&self) -> bool {
        self.history.is_saved()
    }

    /// True if saving would change its file: the text is another, or stands in no file yet.
    pub fn is_unwritten(&self) -> bool {
        !self.is_saved() || self.path.is_some() && self.stamp.is_none()
    }

    /// The place of a node in the view: what the file says, else where it was laid out when it was first seen.
    pub fn position(&self, node: &str) -> [f64; 2] {
        let stated = self.view.nodes.get(node).and_then(|node| node.position);
        stated.or_else(|| self.shown.get(node).copied()).unwrap_or_default()
    }

    /// Lays out all nodes anew that the file gives no place. `size`: the width and height that each will have.
    pub fn lay_out(&mut self, size: &dyn Fn(&NodeEntry) -> [f64; 2]) {
        let nodes = &self.survey.pipeline.nodes;
        let of = |name: &str| nodes.iter().find(|node| node.name == name).map_or(USUAL, size);
        let places = tidy(nodes, &of);
        self.shown = nodes.iter().map(|node| node.name.clone()).zip(places).collect();
    }

    /// Lays out nodes that are new and have no place.
    fn show_new(&mut self) {
        let nodes = &self.survey.pipeline.nodes;
        let (shown, view) = (&self.shown, &self.view);
        let has_place = |name: &String| {
            shown.contains_key(name) || view.nodes.get(name).is_some_and(|node| node.position.is_some())
        };
        let new: Vec<usize> = (0..nodes.len()).filter(|&i| !has_place(&nodes[i].name)).collect();
        if new.is_empty() {
            return;
        }
        let laid_out = tidy(nodes, &|_| USUAL);
        let new = new.into_iter().map(|i| (nodes[i].name.clone(), laid_out[i]));
        self.shown.extend(new.collect::<Vec<_>>());
    }

    /// Completes an error with the place in this file.
    pub fn locate(&self, error: Error) -> Error {
        locate(error, &self.text, self.path.as_deref().unwrap_or(Path::new("a new pipeline")))
    }

    /// A name for a new node that no node has: `like` itself or with a number.
    pub fn free_name(&self, like: &str) -> String {
        free_name(like, &|name| self.survey.pipeline.nodes.iter().any(|node| node.name == name))
    }
}

impl Default for Document {
    fn default() -> Self {
        Self::new()
    }
}

/// A text, where everything stands in it, and what it states.
type Reading = (Arc<str>, Arc<Syntax>, Arc<ParsedPipeline>);

fn read(text: &str) -> Reading {
    (text.into(), Arc::new(Syntax::read(text)), Arc::new(Pipeline::survey(text)))
}

/// The first of `like`, `like_2`, `like_3` … that is not taken.
pub(crate) fn free_name(like: &str, is_taken: &dyn Fn(&str) -> bool) -> String {
    if !is_taken(like) {
        return like.to_string();
    }
    let base = like.trim_end_matches(|c: char| c.is_ascii_digit());
    let base = if base.len() < like.len() { base.trim_end_matches('_') } else { like };
    let mut numbered = (2..).map(|number: u64| format!("{base}_{number}"));
    numbered.find(|name| !is_taken(name)).unwrap_or_default()
}

/// Gesture: all edits of one drag are one undo step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gesture(pub u64);

#[derive(Debug, Clone)]
struct EditStep {
    label: String,
    before: Arc<str>,
    after: Arc<str>,
    gesture: Option<Gesture>,
}

/// The steps of a document, and how many of them hold now.
#[derive(Debug, Clone, Default)]
pub struct History {
    steps: Vec<EditStep>,
    /// Number of steps done; later ones are undone.
    cursor: usize,
    /// The cursor at which the text is as its file, or as it was begun; none where no cursor leads there.
    pub(crate) saved: Option<usize>,
}

impl History {
    /// Takes a step in; what was undone is forgotten. One of the same gesture as the last step becomes part of it.
    fn record(&mut self, label: String, before: &Arc<str>, after: &Arc<str>, gesture: Option<Gesture>) {
        if before == after {
            return;
        }
        self.steps.truncate(self.cursor);
        self.saved = self.saved.filter(|saved| *saved <= self.cursor);
        let is_saved = self.is_saved();
        match self.steps.last_mut().filter(|last| gesture.is_some() && last.gesture == gesture && !is_saved) {
            Some(last) if last.before == *after => drop(self.steps.pop()),
            Some(last) => last.after = after.clone(),
            None => {
                self.steps.push(EditStep { label, before: before.clone(), after: after.clone(), gesture })
            }
        }
        self.cursor = self.steps.len();
    }

    /// The text before the last step that is done, which is undone now; none where there is none.
    fn undo(&mut self) -> Option<Arc<str>> {
        let step = self.steps.get_mut(self.cursor.checked_sub(1)?)?;
        step.gesture = None;
        self.cursor -= 1;
        Some(step.before.clone())
    }

    /// The text after the first step that is undone, which is done now; none where there is none.
    fn redo(&mut self) -> Option<Arc<str>> {
        let step = self.steps.get(self.cursor)?;
        self.cursor += 1;
        Some(step.after.clone())
    }

    /// Description of the step that undo would revert.
    pub fn undo_label(&self) -> Option<&str> {
        Some(&self.steps.get(self.cursor.checked_sub(1)?)?.label)
    }

    /// Description of the step that redo would repeat.
    pub fn redo_label(&self) -> Option<&str> {
        Some(&self.steps.get(self.cursor)?.label)
    }

    pub(crate) fn save(&mut self) {
        self.saved = Some(self.cursor);
    }

    /// True if the text is as its file, or as it was begun.
    pub fn is_saved(&self) -> bool {
        self.saved == Some(self.cursor)
    }

    /// Number of steps done, and number of steps.
    pub fn position(&self) -> (usize, usize) {
        (self.cursor, self.steps.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(history: &mut History, text: &mut String, new: &str, gesture: Option<Gesture>) {
        history.record(new.to_string(), &text.as_str().into(), &new.into(), gesture);
        *text = new.to_string();
    }

    #[test]
    fn a_gesture_is_one_step_until_it_is_saved_or_undone() {
        let (mut history, mut text) = (History { saved: Some(0), ..History::default() }, "a".to_string());
        let drag = Some(Gesture(1));
        for new in ["b", "c", "d"] {
            typed(&mut history, &mut text, new, drag);
        }
        assert_eq!(history.position(), (1, 1));
        history.save();
        typed(&mut history, &mut text, "e", drag);
        assert_eq!(history.position(), (2, 2));
        assert_eq!(history.undo().unwrap().to_string(), "d");
        assert!(history.is_saved());
        assert_eq!(history.redo().unwrap().to_string(), "e");
        assert!(!history.is_saved());
        typed(&mut history, &mut text, "f", drag);
        assert_eq!(history.position(), (3, 3), "a gesture ends where it is undone");
    }

    #[test]
    fn a_drag_back_to_its_beginning_is_no_step() {
        let (mut history, mut text) = (History { saved: Some(0), ..History::default() }, "a".to_string());
        typed(&mut history, &mut text, "b", Some(Gesture(7)));
        typed(&mut history, &mut text, "a", Some(Gesture(7)));
        assert_eq!(history.position(), (0, 0));
        assert!(history.is_saved());
    }

    #[test]
    fn a_new_edit_cuts_what_was_undone_and_the_way_to_what_was_saved() {
        let (mut history, mut text) = (History { saved: Some(0), ..History::default() }, "a".to_string());
        typed(&mut history, &mut text, "b", None);
        history.save();
        text = history.undo().unwrap().to_string();
        assert_eq!((history.undo_label(), history.redo_label()), (None, Some("b")));
        typed(&mut history, &mut text, "c", None);
        assert_eq!(history.redo_label(), None);
        assert!(!history.is_saved());
        history.undo();
        assert!(!history.is_saved(), "what was saved was cut off");
    }
}
