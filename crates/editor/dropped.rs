//! Files that are dropped on the window: pipelines, pictures and data are opened, a colour map goes to what is selected.

use crate::editor::Editor;
use crate::scene::Action;
use std::path::Path;
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
            let plugin = file.display();
            return self.say(format!(
                "a plug-in is a program, which the window starts with: voltet edit --plugin {plugin}"
            ));
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
