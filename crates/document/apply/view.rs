//! Edits of the table `[editor]`: places, frames, notes.

use super::EditContext;
use crate::path::Path;
use crate::view::{NodeView, View, position_value};
use voltet_core::{Error, Result};
use voltet_graph::pipeline::EDITOR;
use voltet_graph::{LocatedValue, ParameterValue};

impl EditContext {
    pub(super) fn move_nodes(
        &mut self,
        moved: &[(String, [f64; 2])],
        shown: &dyn Fn(&str) -> Option<[f64; 2]>,
    ) -> Result<()> {
        moved.iter().try_for_each(|(name, _)| self.node(name).map(drop))?;
        self.pin(moved, shown)
    }

    /// Writes places: those given, and those of all other nodes as they are shown, so that the file shows the same again.
    pub(super) fn pin(
        &mut self,
        given: &[(String, [f64; 2])],
        shown: &dyn Fn(&str) -> Option<[f64; 2]>,
    ) -> Result<()> {
        let view = View::read(&self.survey.editor);
        let has_place = |name: &str| view.nodes.get(name).is_some_and(|node| node.position.is_some());
        let others = self.survey.pipeline.nodes.iter().map(|node| &node.name);
        let others = others.filter(|name| !has_place(name) && !given.iter().any(|(known, _)| known == *name));
        let others: Vec<(String, [f64; 2])> =
            others.filter_map(|name| Some((name.clone(), shown(name)?))).collect();
        let mut fresh = Vec::new();
        for (name, at) in others.iter().chain(given) {
            let mut node = view.nodes.get(name).cloned().unwrap_or_default();
            node.position = Some(*at);
            match view.nodes.contains_key(name) {
                true => self.put_view(name, &node)?,
                false => fresh.push((name.as_str(), position_value(*at))),
            }
        }
        self.draft.add_lines(&Path::from([EDITOR, "nodes"]), &fresh)
    }

    pub(super) fn show_node(
        &mut self,
        name: &str,
        shown: &dyn Fn(&str) -> Option<[f64; 2]>,
        change: impl FnOnce(&mut NodeView),
    ) -> Result<()> {
        self.node(name)?;
        let mut node = View::read(&self.survey.editor).nodes.remove(name).unwrap_or_default();
        node.position = node.position.or_else(|| shown(name));
        change(&mut node);
        self.put_view(name, &node)
    }

    pub(super) fn put_view(&mut self, name: &str, node: &NodeView) -> Result<()> {
        let path = Path::from([EDITOR, "nodes", name]);
        match node.datum() {
            Some(datum) => self.draft.set(&path, &datum),
            None => self.draft.unset(&path),
        }
    }

    /// Puts a frame or a note, each on a line of its own.
    pub(super) fn put(&mut self, list: &str, number: usize, datum: &ParameterValue) -> Result<()> {
        let path = Path::from([EDITOR, list]);
        let count = self.survey.editor.iter().find(|field| field.name == list);
        match count.and_then(|field| field.setting.list()).map_or(0, <[LocatedValue]>::len) {
            0 if number == 0 => {
                self.draft.unset(&path)?;
                self.draft.reparse()?;
                self.draft.add(&path, &format!("[\n  {datum},\n]"))
            }
            count if number < count => self.draft.set(&path.with(number), datum),
            _ => self.draft.insert(&path, number, datum),
        }
    }

    pub(super) fn take(&mut self, list: &str, number: usize) -> Result<()> {
        let path = Path::from([EDITOR, list]);
        let entries = self.survey.editor.iter().find(|field| field.name == list);
        match entries.and_then(|field| field.setting.list()).map_or(0, <[LocatedValue]>::len) {
            1 if number == 0 => self.draft.unset(&path),
            count if number < count => self.draft.unset(&path.with(number)),
            _ => Err(Error::usage("there is no such thing in the view").got(path.with(number))),
        }
    }
}
