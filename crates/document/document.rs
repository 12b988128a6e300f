//! The document: a pipeline file with its history.

use crate::apply::{EditContext, blank};
use crate::arrange::{USUAL, tidy};
use crate::edit::Edit;
use crate::history::{Gesture, History};
use crate::text::Syntax;
use crate::view::View;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::{ParsedPipeline, Pipeline, locate};
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
        Self::from_text(blank(None), None)
    }

    /// A document of a text that stands so in the file at `path`, if in one. Whatever the text: faults are asked for later.
    pub fn from_text(text: String, path: Option<PathBuf>) -> Document {
        let (text, syntax, survey) = read(&text);
        let mut document = Document {
            view: Arc::new(View::read(&survey.editor)),
            text,
            syntax,
            survey,
            history: History::of_saved(),
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

    /// The text, to be shared with another thread.
    pub fn shared_text(&self) -> Arc<str> {
        self.text.clone()
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

    /// Edits as a part of a gesture, such as a drag: all edits of one gesture are one undo step.
    pub fn edit_in(&mut self, gesture: Gesture, edit: &Edit) -> Result<()> {
        self.edit_all(edit.label(), std::slice::from_ref(edit), Some(gesture))
    }

    /// Carries out several edits, one after the other, as one step. Errors: one cannot be done; then nothing has changed.
    pub fn edit_all(&mut self, label: String, edits: &[Edit], gesture: Option<Gesture>) -> Result<()> {
        let (text, syntax, survey) = self.worked(edits)?;
        self.history.record(label, &self.text, &text, gesture)?;
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
        let mut work = EditContext::new(self.text.clone(), self.syntax.clone(), self.survey.clone(), &shown);
        edits.iter().try_for_each(|edit| work.apply(edit))?;
        Ok(work.finish())
    }

    /// Undoes the last step; false where there is none.
    pub fn undo(&mut self) -> Result<bool> {
        let text = self.history.undo(&self.text)?;
        Ok(self.go(text))
    }

    /// Does the step again that was undone last; false where there is none.
    pub fn redo(&mut self) -> Result<bool> {
        let text = self.history.redo(&self.text)?;
        Ok(self.go(text))
    }

    fn go(&mut self, text: Option<String>) -> bool {
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

    /// True if the text is as its file.
    pub fn is_saved(&self) -> bool {
        self.history.is_saved()
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

/// A text, where everything stands in it, and what it states.
pub(crate) type Reading = (Arc<str>, Arc<Syntax>, Arc<ParsedPipeline>);

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

impl Default for Document {
    fn default() -> Self {
        Self::new()
    }
}
