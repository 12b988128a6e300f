//! Asking for a file in the window: to open, to save in, or for a parameter that names one.

use crate::actions::{Action, Actions};
use crate::files::{DATA, PIPELINES};
use eframe::egui::{Align2, Context, Key, ScrollArea, TextEdit, Ui, Window};
use std::path::{Path, PathBuf};

/// What a file is asked for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Asked {
    /// To open.
    Open,
    /// To save in.
    SaveAs,
    /// For a parameter of a node: one to read, or one to write.
    Parameter {
        /// The node.
        node: String,
        /// What leads to the parameter.
        path: voltet_document::Path,
        /// Whether it is written.
        writes: bool,
    },
}

impl Asked {
    fn title(&self) -> String {
        match self {
            Asked::Open => "Open a pipeline or data".into(),
            Asked::SaveAs => "Save as".into(),
            Asked::Parameter { node, path, writes: false } => format!("A file to read: {node}.{path}"),
            Asked::Parameter { node, path, writes: true } => format!("A file to write: {node}.{path}"),
        }
    }

    /// Whether a file that is there would be written over by the choice alone.
    fn writes_at_once(&self) -> bool {
        *self == Asked::SaveAs
    }

    fn could_be(&self, name: &str) -> bool {
        let end = Path::new(name).extension().map(|end| end.to_string_lossy().to_lowercase());
        let end = end.unwrap_or_default();
        match self {
            Asked::Open => PIPELINES.contains(&end.as_str()) || DATA.contains(&end.as_str()),
            Asked::SaveAs => PIPELINES.contains(&end.as_str()),
            Asked::Parameter { .. } => true,
        }
    }

    fn action(self, file: PathBuf) -> Action {
        match self {
            Asked::Open => Action::Open(file),
            Asked::SaveAs => Action::SaveAs(file),
            Asked::Parameter { node, path, .. } => Action::Name { node, path, file },
        }
    }
}

/// A file that is asked for.
#[derive(Debug)]
pub(crate) struct FileAsking {
    asked: Asked,
    folder: PathBuf,
    name: String,
    entries: Vec<(String, bool)>,
    is_new: bool,
    /// The file is there; whether it shall be written over was asked.
    warned: bool,
}

impl FileAsking {
    /// Begins in the folder of a file, with its name where one is to be written.
    pub fn new(asked: Asked, path: Option<&Path>) -> FileAsking {
        let folder = path.and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let folder =
            std::fs::canonicalize(folder).unwrap_or_else(|_| std::env::current_dir().unwrap_or_default());
        let own = path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = match &asked {
            Asked::Open => String::new(),
            Asked::SaveAs => own.unwrap_or_else(|| "pipeline.toml".into()),
            Asked::Parameter { .. } => own.unwrap_or_default(),
        };
        let mut asking = FileAsking { asked, folder, name, entries: Vec::new(), is_new: true, warned: false };
        asking.read();
        asking
    }

    /// What is in the folder that could be meant: folders, then files.
    fn read(&mut self) {
        let entries = std::fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut entries: Vec<(String, bool)> = entries
            .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()))
            .filter(|(name, is_folder)| !name.starts_with('.') && (*is_folder || self.asked.could_be(name)))
            .collect();
        entries.sort_by_key(|(name, is_folder)| (!is_folder, name.to_lowercase()));
        self.entries = entries;
    }

    fn go(&mut self, folder: PathBuf) {
        self.folder = std::fs::canonicalize(&folder).unwrap_or(folder);
        self.read();
    }

    /// The file, once it is chosen.
    fn show(&mut self, ui: &mut Ui) -> Option<PathBuf> {
        let mut chosen = None;
        ui.horizontal(|ui| {
            if ui.button("⬆").on_hover_text("the folder above").clicked()
                && let Some(above) = self.folder.parent().map(Path::to_path_buf)
            {
                self.go(above);
            }
            ui.label(self.folder.display().to_string());
        });
        ScrollArea::vertical().max_height(320.0).auto_shrink([false, false]).show(ui, |ui| {
            let mut into = None;
            for (name, is_folder) in &self.entries {
                let text = if *is_folder { format!("🗀  {name}") } else { format!("      {name}") };
                let row = ui.selectable_label(*name == self.name, text);
                if row.clicked() && *is_folder {
                    into = Some(self.folder.join(name));
                } else if row.clicked() {
                    self.name = name.clone();
                    self.warned = false;
                }
                if row.double_clicked() && !is_folder {
                    chosen = Some(self.folder.join(name));
                }
            }
            if self.entries.is_empty() {
                ui.label("There is nothing here that could be meant.");
            }
            if let Some(into) = into {
                self.go(into);
            }
        });
        ui.horizontal(|ui| {
            let field = ui
                .add(TextEdit::singleline(&mut self.name).desired_width(360.0).hint_text("a name or a path"));
            if std::mem::take(&mut self.is_new) {
                field.request_focus();
            }
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let text = match (&self.asked, self.warned) {
                (Asked::Open, _) => "Open",
                (Asked::SaveAs, false) => "Save",
                (Asked::SaveAs, true) => "Write over it",
                (Asked::Parameter { .. }, _) => "Choose",
            };
            if (ui.button(text).clicked() || entered) && !self.name.is_empty() {
                chosen = Some(self.folder.join(&self.name));
            }
        });
        if self.warned {
            ui.label("There is a file of that name.");
        }
        let path = chosen?;
        if path.is_dir() {
            self.name.clear();
            self.go(path);
            return None;
        }
        if self.asked.writes_at_once() && path.exists() && !self.warned {
            self.warned = true;
            return None;
        }
        Some(path)
    }
}

/// Shows what is asked for.
pub(crate) fn show(wanted: &mut Option<FileAsking>, ctx: &Context, actions: &mut Actions) {
    let Some(mut asking) = wanted.take() else { return };
    let mut open = true;
    let mut chosen = None;
    Window::new(asking.asked.title())
        .id(eframe::egui::Id::new("asking for a file"))
        .open(&mut open)
        .collapsible(false)
        .default_width(460.0)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| chosen = asking.show(ui));
    match chosen {
        Some(path) => actions.push(asking.asked.action(path)),
        None if open && !ctx.input(|input| input.key_pressed(Key::Escape)) => *wanted = Some(asking),
        None => {}
    }
}
