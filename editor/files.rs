//! Files: asking for one in the window, opening, saving.

use crate::actions::{Action, Actions};
use eframe::egui::{Align2, Context, Key, ScrollArea, TextEdit, Ui, Window};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use voltet_core::Result;
use voltet_document::{Document, Edit};

/// How often the file is looked at, while the window is shown anew anyway.
const BETWEEN: Duration = Duration::from_secs(1);

/// Whether another program wrote the document's file.
#[derive(Debug, Default)]
pub(crate) struct Disk {
    pub is_changed: bool,
    looked: Option<Instant>,
}

impl Disk {
    pub fn look(&mut self, document: &Document) {
        if self.looked.is_none_or(|looked| looked.elapsed() >= BETWEEN) {
            self.is_changed = document.changed_on_disk();
            self.looked = Some(Instant::now());
        }
    }
}

/// Ends of the names of pipelines, and of pictures that carry one.
const PIPELINES: [&str; 3] = ["toml", "png", "exr"];

/// Ends of the names of data files.
const DATA: [&str; 10] = ["vtu", "vtk", "vts", "vtr", "vti", "pvtu", "pvd", "xyz", "p3d", "x"];

/// What a file is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// To open.
    Open,
    /// To save in.
    SaveAs,
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
    pub fn new(asked: Asked, path: Option<&Path>) -> FileAsking {
        let folder = path.and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let folder = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf());
        let own = path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = match asked {
            Asked::Open => String::new(),
            Asked::SaveAs => own.unwrap_or_else(|| "pipeline.toml".into()),
        };
        let mut asking = FileAsking { asked, folder, name, entries: Vec::new(), is_new: true, warned: false };
        asking.read();
        asking
    }

    /// What is in the folder that could be meant: folders, then files.
    fn read(&mut self) {
        let known = |name: &str| {
            let end = Path::new(name)
                .extension()
                .map(|end| end.to_string_lossy().to_lowercase())
                .unwrap_or_default();
            PIPELINES.contains(&end.as_str()) || (self.asked == Asked::Open && DATA.contains(&end.as_str()))
        };
        let entries = std::fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut entries: Vec<(String, bool)> = entries
            .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()))
            .filter(|(name, is_folder)| !name.starts_with('.') && (*is_folder || known(name)))
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
            let text = match (self.asked, self.warned) {
                (Asked::Open, _) => "Open",
                (Asked::SaveAs, false) => "Save",
                (Asked::SaveAs, true) => "Write over it",
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
        if self.asked == Asked::SaveAs && path.exists() && !self.warned {
            self.warned = true;
            return None;
        }
        Some(path)
    }
}

/// Shows what is asked for.
pub(crate) fn show(wanted: &mut Option<FileAsking>, ctx: &Context, actions: &mut Actions) {
    let Some(mut asking) = wanted.take() else { return };
    let title = if asking.asked == Asked::Open { "Open a pipeline or data" } else { "Save as" };
    let mut open = true;
    let mut chosen = None;
    Window::new(title)
        .open(&mut open)
        .collapsible(false)
        .default_width(460.0)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| chosen = asking.show(ui));
    match chosen {
        Some(path) => actions.push(match asking.asked {
            Asked::SaveAs => Action::SaveAs(path),
            Asked::Open => Action::Open(path),
        }),
        None if open && !ctx.input(|input| input.key_pressed(Key::Escape)) => *wanted = Some(asking),
        None => {}
    }
}

/// Whether a name is that of a pipeline file.
pub(crate) fn is_pipeline(path: &Path) -> bool {
    path.extension().is_none_or(|end| end == "toml")
}

/// Where the pipeline of a file that is none would be saved: beside it, under a name that no file has.
pub(crate) fn free_path(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = (2..).map(|number| path.with_file_name(format!("{stem}_{number}.toml")));
    let mut all = std::iter::once(path.with_extension("toml")).chain(numbered);
    all.find(|path| !path.exists()).unwrap_or_default()
}

/// A document that is not saved yet, of a text whose paths are relative to where it would be.
pub(crate) fn begun(text: String, at: &Path) -> Result<Document> {
    let mut document = Document::from_text(String::new(), Some(at.to_path_buf()));
    document.edit(&Edit::Text(text))?;
    Ok(document)
}
