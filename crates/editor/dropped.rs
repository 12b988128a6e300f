//! Files that are dropped on the window: pipelines, pictures and data are opened, a colour map goes to what is selected, a plug-in is
//! loaded where a hand says so.

use crate::editor::Editor;
use crate::files::ask;
use crate::jobs::Job;
use crate::scene::Action;
use crate::templates::templates;
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use voltet_document::panel::Row;
use voltet_document::{Edit, Path as KeyPath};
use voltet_graph::ParameterType;
use voltet_nodes::files::relative_to;

/// Ends of the names of plug-ins.
const PLUGINS: [&str; 4] = ["so", "dylib", "dll", "wasm"];

/// Ends of the names of colour maps.
const MAPS: [&str; 2] = ["json", "xml"];

impl Editor {
    /// Takes files that were dropped together.
    pub(crate) fn take_dropped(&mut self, files: &[impl AsRef<Path>]) {
        let [file] = files else {
            return self.say("drop one file at a time; a series is opened by its .pvd or .series file");
        };
        let file = file.as_ref();
        let end = file.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
        if PLUGINS.contains(&&*end) {
            return self.plugins.offered.push(file.to_path_buf());
        }
        if !MAPS.contains(&&*end) {
            return self.actions.push(Action::Begin(file.to_path_buf()));
        }
        let Some((node, path)) = self.place_of_map(&end) else {
            return self.say("select a widget or a node that has a colour map, then drop the file again");
        };
        let value = relative_to(file, &self.document.folder()).to_string_lossy().into_owned();
        let text = format!("{node}.{path} is now {value}");
        self.edit_one(Edit::Set { node, path, value: value.into() });
        if self.message.is_none() {
            self.say(text);
        }
    }

    /// The parameter that a colour map goes to: of the widget in hand where that was selected last; else of the selected node, there of the
    /// widget in hand before others.
    fn place_of_map(&self, end: &str) -> Option<(String, KeyPath)> {
        let transfer = &self.panels.transfer;
        let in_hand = transfer.in_hand();
        let selected = self.selection.first().filter(|_| self.selection.len() == 1);
        let node = match in_hand {
            Some((node, _)) if transfer.is_last() => node,
            _ => selected?,
        };
        let mut paths = Vec::new();
        collect(&self.document.rows(&self.registry, node), end, &mut paths);
        let of_widget = in_hand.filter(|(of, _)| *of == node).map(|(_, place)| format!("widgets.{place}."));
        let is_in_hand =
            |path: &&KeyPath| of_widget.as_ref().is_some_and(|own| path.to_string().starts_with(own));
        let others = paths.first().filter(|_| !transfer.is_last());
        let path = paths.iter().find(is_in_hand).or(others)?;
        Some((node.to_string(), path.clone()))
    }

    /// True if a plug-in that was dropped is asked about: no other question or dialog is open, and no plug-in is being loaded.
    pub(crate) fn offers_plugin(&self) -> bool {
        let is_asking = self.unsaved.is_some() || self.large.is_some();
        let is_free = !is_asking && self.file_dialog.is_none() && self.plugins.loading.is_none();
        is_free && !self.plugins.offered.is_empty()
    }

    /// Asks about the first plug-in that was dropped, and loads it where a hand says so.
    pub(crate) fn offer_plugin(&mut self, ctx: &Context) {
        let Some(path) = self.plugins.offered.first() else { return };
        let file = path.display();
        let text = format!("{file} is a plug-in: a program. Load it if you trust those who made it.");
        let Some(is_wanted) = ask(ctx, "Plug-in", text, &[("Load it", true), ("Cancel", false)]) else {
            return;
        };
        let path = self.plugins.offered.remove(0);
        if is_wanted {
            self.load_plugin(ctx, path);
        }
    }

    fn load_plugin(&mut self, ctx: &Context, path: PathBuf) {
        let Some(load) = self.plugins.load.clone() else {
            return self
                .say(format!("this program loads no plug-ins: voltet edit --plugin {}", path.display()));
        };
        self.say(format!("loading {} …", path.display()));
        let job = Job::start("plug-in", ctx, move |_| load(&path));
        self.plugins.loading = self.check(job);
    }

    /// Takes over what a plug-in offers, once it is loaded.
    pub(crate) fn take_plugin(&mut self) {
        let Some(loaded) = self.plugins.loading.as_ref().and_then(Job::result) else { return };
        self.plugins.loading = None;
        let Some((registry, plugin)) = self.check(loaded) else { return };
        let used = self.worker.use_registry(&registry);
        if self.check(used).is_some() {
            self.registry = registry;
            self.templates = templates(&self.registry);
            self.faults = (None, Vec::new());
            self.read_again();
            self.say(format!("loaded until the window closes: {plugin}"));
        }
    }
}

/// Collects the paths of parameters that name a colour map by a file with this ending.
fn collect(rows: &[Row], end: &str, paths: &mut Vec<KeyPath>) {
    for row in rows {
        if let ParameterType::ChoiceOrPath(_, ends) = row.parameter.parameter_type
            && ends.contains(&end)
        {
            paths.push(row.path.clone());
        }
        collect(&row.rows, end, paths);
        row.entries.iter().for_each(|entry| collect(&entry.rows, end, paths));
    }
}
