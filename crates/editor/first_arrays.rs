//! Readers that were given a file in this window, and are to draw the array that `voltet start` would choose.

use crate::editor::Editor;
use crate::jobs::{DataSource, Extent, path_of, reads};
use eframe::egui::Context;
use std::path::PathBuf;
use voltet_document::Edit;
use voltet_graph::NodeEntry;
use voltet_io::formats::{ArrayChoice, Association};

impl Editor {
    /// The data file of the first reader.
    pub(crate) fn data_file(&self) -> Option<PathBuf> {
        let mut readers = self.document.pipeline().nodes.iter().filter(|node| reads(node, &self.registry));
        readers.find_map(path_of).map(|path| self.document.folder().join(path))
    }

    /// A node was given a file.
    pub(crate) fn expect_array(&mut self, node: &str) {
        let entry = self.document.pipeline().nodes.iter().find(|entry| entry.name == node);
        let source =
            entry.and_then(|entry| DataSource::of_node(entry, &self.document.folder(), &self.registry));
        self.new_readers.extend(source.map(|source| (node.to_string(), source)));
    }

    /// Has each reader that was given a file name the array that it draws, as `voltet start` does, where it would draw none or another:
    /// once that is found, if the reader is as it was and nothing stands undone, which an edit would forget.
    pub(crate) fn name_arrays(&mut self, ctx: &Context) {
        let (done, all) = self.document.history().position();
        for (name, source) in std::mem::take(&mut self.new_readers) {
            let entry = self.document.pipeline().nodes.iter().find(|node| node.name == name);
            let is_as_it_was = |entry: &&NodeEntry| {
                entry.setting("scalar").is_none()
                    && DataSource::of_node(entry, &self.document.folder(), &self.registry).as_ref()
                        == Some(&source)
            };
            let Some(entry) = entry.filter(is_as_it_was).filter(|_| done == all) else { continue };
            let found = self.arrays.of_reader(ctx, &self.document, &self.registry, entry, Extent::Whole);
            let is_any = entry.setting("association").is_none();
            match &found.to_be_named {
                Some(array) => self.name_array(&name, array, is_any),
                None if found.is_whole => {}
                None => drop(self.new_readers.insert(name, source)),
            }
        }
    }

    /// A step of its own, whatever a hand is doing meanwhile.
    fn name_array(&mut self, reader: &str, array: &ArrayChoice, is_any: bool) {
        let scalar = &array.scalar;
        let mut edits = vec![Edit::set(reader, ["scalar"], scalar.as_str().into())];
        if is_any && array.association == Some(Association::Cell) {
            edits.push(Edit::set(reader, ["association"], "cell".into()));
        }
        let outcome = self.document.edit_all(format!("draw '{scalar}'"), &edits, None);
        if self.check(outcome).is_some() {
            self.say(format!(
                "{reader}: draws '{scalar}', the first array that varies; 'scalar' names another"
            ));
        }
    }
}
