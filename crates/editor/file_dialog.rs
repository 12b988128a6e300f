//! Dialogs: a question with a few answers; and the choice of a file that is opened, saved, or named in a parameter.

use crate::actions::{Action, Actions, FilePurpose};
use crate::files::{DATA, is_pipeline_ending};
use eframe::egui::{Align2, Context, Key, ScrollArea, TextEdit, Ui, Window};
use std::path::{Path, PathBuf};

/// Asks a question in the middle of the window; the answer, once a button is clicked.
pub(crate) fn ask<T: Copy>(ctx: &Context, title: &str, text: String, answers: &[(&str, T)]) -> Option<T> {
    let mut answer = None;
    let window = Window::new(title).collapsible(false).resizable(false);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        ui.label(text);
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            for (text, of_button) in answers {
                if ui.button(*text).clicked() {
                    answer = Some(*of_button);
                }
            }
        });
    });
    answer
}

impl FilePurpose {
    fn title(&self) -> String {
        match self {
            FilePurpose::Open => "Open a pipeline or data".into(),
            FilePurpose::SaveAs => "Save as".into(),
            FilePurpose::Parameter { node, path, writes: false } => format!("A file to read: {node}.{path}"),
            FilePurpose::Parameter { node, path, writes: true } => format!("A file to write: {node}.{path}"),
        }
    }

    /// True if the choice alone overwrites an existing file.
    fn overwrites(&self) -> bool {
        *self == FilePurpose::SaveAs
    }

    fn accepts(&self, name: &str) -> bool {
        let end = Path::new(name).extension().map(|end| end.to_string_lossy().to_lowercase());
        let end = end.unwrap_or_default();
        match self {
            FilePurpose::Open => is_pipeline_ending(&end) || DATA.contains(&end.as_str()),
            FilePurpose::SaveAs => is_pipeline_ending(&end),
            FilePurpose::Parameter { .. } => true,
        }
    }

    fn action(self, file: PathBuf) -> Action {
        match self {
            FilePurpose::Open => Action::Open(file),
            FilePurpose::SaveAs => Action::SaveAs(file),
            FilePurpose::Parameter { node, path, .. } => Action::Name { node, path, file },
        }
    }
}

/// An open file dialog.
#[derive(Debug)]
pub(crate) struct FileDialog {
    purpose: FilePurpose,
    folder: PathBuf,
    name: String,
    entries: Vec<(String, bool)>,
    is_new: bool,
    /// True once the dialog warned that the file exists.
    warned: bool,
}

impl FileDialog {
    /// Starts in the folder of `path`, with its file name where a file is to be written.
    pub fn new(purpose: FilePurpose, path: Option<&Path>) -> FileDialog {
        let folder = path.and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let folder =
            std::fs::canonicalize(folder).unwrap_or_else(|_| std::env::current_dir().unwrap_or_default());
        let own = path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = match &purpose {
            FilePurpose::Open => String::new(),
            FilePurpose::SaveAs => own.unwrap_or_else(|| "pipeline.toml".into()),
            FilePurpose::Parameter { .. } => own.unwrap_or_default(),
        };
        let mut dialog =
            FileDialog { purpose, folder, name, entries: Vec::new(), is_new: true, warned: false };
        dialog.read();
        dialog
    }

    /// Lists the folder: folders, then accepted files.
    fn read(&mut self) {
        let entries = std::fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut entries: Vec<(String, bool)> = entries
            .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()))
            .filter(|(name, is_folder)| !name.starts_with('.') && (*is_folder || self.purpose.accepts(name)))
            .collect();
        entries.sort_by_key(|(name, is_folder)| (!is_folder, name.to_lowercase()));
        self.entries = entries;
    }

    fn go(&mut self, folder: PathBuf) {
        self.folder = std::fs::canonicalize(&folder).unwrap_or(folder);
        self.read();
    }

    /// Shows the dialog; returns the file once it is chosen.
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
                ui.label("This folder has no files of an accepted kind.");
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
            let text = match (&self.purpose, self.warned) {
                (FilePurpose::Open, _) => "Open",
                (FilePurpose::SaveAs, false) => "Save",
                (FilePurpose::SaveAs, true) => "Write over it",
                (FilePurpose::Parameter { .. }, _) => "Choose",
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
        if self.purpose.overwrites() && path.exists() && !self.warned {
            self.warned = true;
            return None;
        }
        Some(path)
    }
}

/// Shows the dialog, if one is open.
pub(crate) fn show(open_dialog: &mut Option<FileDialog>, ctx: &Context, actions: &mut Actions) {
    let Some(mut dialog) = open_dialog.take() else { return };
    let mut open = true;
    let mut chosen = None;
    Window::new(dialog.purpose.title())
        .id(eframe::egui::Id::new("asking for a file"))
        .open(&mut open)
        .collapsible(false)
        .default_width(460.0)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| chosen = dialog.show(ui));
    match chosen {
        Some(path) => actions.push(dialog.purpose.action(path)),
        None if open && !ctx.input(|input| input.key_pressed(Key::Escape)) => *open_dialog = Some(dialog),
        None => {}
    }
}
