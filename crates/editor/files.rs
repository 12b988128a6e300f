//! Files: names, changes by other programs, recent ones, what is known of copies of unsaved work; and dialogs: a question with a few
//! answers, and the choice of a file.

use crate::fields::arrow_step;
use crate::focus::{FollowFocus, Sheet};
use crate::scene::FilePurpose;
use crate::theme::{self, Help};
use eframe::egui::{
    Align, Align2, Context, FocusDirection, Key, Layout, Modifiers, Response, RichText, ScrollArea, TextEdit,
    Ui, Window,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::counted;
use voltet_document::{Autosave, Document, OrphanedDraft, Recovery, stamp};
use voltet_graph::Stamp;
use voltet_nodes::files::{state_folder, write_whole};

/// Interval between two checks of the files.
pub(crate) const BETWEEN: Duration = Duration::from_secs(1);

pub(crate) type FileStamps = BTreeMap<PathBuf, Stamp>;

/// Thread that wakes the window when a file is another than it was: the window need not look while nothing happens. It ends with this.
#[derive(Debug)]
pub(crate) struct FileWatcher {
    known: Arc<Mutex<FileStamps>>,
}

impl FileWatcher {
    /// Looks at the files again and again, and calls `wake` as long as a file differs from what is known of it. Errors: no thread can be started.
    pub fn start(between: Duration, wake: impl Fn() + Send + 'static) -> std::io::Result<FileWatcher> {
        let known = Arc::new(Mutex::new(FileStamps::new()));
        let watched = Arc::downgrade(&known);
        std::thread::Builder::new().name("files".into()).spawn(move || {
            loop {
                std::thread::sleep(between);
                let Some(known) = watched.upgrade() else { return };
                // Not held while a slow disk is asked.
                let known = known.lock().unwrap_or_else(PoisonError::into_inner).clone();
                if known.iter().any(|(path, before)| stamp(path) != *before) {
                    wake();
                }
            }
        })?;
        Ok(FileWatcher { known })
    }

    /// Sets the stamps that later ones are compared with.
    pub fn knows(&self, known: FileStamps) {
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = known;
    }
}

/// Changes by other programs: the document's file, and the data.
#[derive(Debug, Default)]
pub(crate) struct Disk {
    pub is_changed: bool,
    pub looked: Option<Instant>,
    data: FileStamps,
}

impl Disk {
    /// Looks now and then; whether data that were known have changed, come or gone since.
    pub fn look(
        &mut self,
        document: &Document,
        data: impl FnOnce() -> Vec<PathBuf>,
        watch: &FileWatcher,
    ) -> bool {
        if self.looked.is_some_and(|looked| looked.elapsed() < BETWEEN) {
            return false;
        }
        self.is_changed = document.changed_on_disk();
        self.looked = Some(Instant::now());
        let now: FileStamps = data().into_iter().map(|path| (path.clone(), stamp(&path))).collect();
        let own = document.path().map(|path| (path.to_path_buf(), stamp(path)));
        watch.knows(now.clone().into_iter().chain(own).collect());
        let before = std::mem::replace(&mut self.data, now);
        self.data.iter().any(|(path, now)| before.get(path).is_some_and(|before| before != now))
    }
}

/// True if the ending is that of a pipeline, or of a picture, which may carry one.
pub(crate) fn is_pipeline_ending(ending: &str) -> bool {
    ending == "toml" || voltet_io::encode::all_endings().any(|known| known == ending)
}

/// Ends of the names of data files, as [`voltet_io::formats`] lists them.
const DATA: &str = "vtu vts vtr vti pvtu pvts pvtr pvti vtm vtpc vtpd vthb htg pvd vtk series vtkhdf hdf cgns xdmf xmf e exo ex2 g msh mesh \
                    mfem_root foam case dat tec plt inp ucd avs su2 bdf nas fem xyz p3d x grd grid";

pub(crate) fn is_pipeline(path: &Path) -> bool {
    path.extension().is_none_or(|end| end == "toml")
}

/// Path for the pipeline made for a data file: beside it, under an unused name.
pub(crate) fn free_path(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = (2..).map(|number| path.with_file_name(format!("{stem}_{number}.toml")));
    let mut all = std::iter::once(path.with_extension("toml")).chain(numbered);
    all.find(|path| !path.exists()).unwrap_or_default()
}

/// Length of the list of files that were opened and saved last.
const MAX_COUNT: usize = 8;

/// The files that were opened and saved last, the last one first; kept nowhere unless the list has a file.
#[derive(Debug, Default)]
pub(crate) struct Recent {
    file: Option<PathBuf>,
    paths: Vec<PathBuf>,
}

impl Recent {
    pub fn usual() -> Recent {
        state_folder().map(|folder| Recent::in_file(folder.join("recent"))).unwrap_or_default()
    }

    pub fn in_file(file: PathBuf) -> Recent {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let paths = text.lines().filter(|line| !line.is_empty()).map(PathBuf::from).take(MAX_COUNT).collect();
        Recent { file: Some(file), paths }
    }

    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.paths.iter().map(PathBuf::as_path).filter(|path| path.is_file())
    }

    pub fn add(&mut self, path: &Path) {
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if self.paths.first() == Some(&path) {
            return;
        }
        self.paths.retain(|other| *other != path);
        self.paths.insert(0, path);
        self.paths.truncate(MAX_COUNT);
        let lines: Option<Vec<&str>> = self.paths.iter().map(|path| path.to_str()).collect();
        if let (Some(file), Some(lines)) = (&self.file, lines) {
            // Where it cannot be kept, the next window does without.
            let made = file.parent().map(std::fs::create_dir_all);
            let _ = made.map(|_| write_whole(file, (lines.join("\n") + "\n").as_bytes()));
        }
    }
}

/// Time for which a window that was killed may hold its work: until the system has taken its memory back.
const ENDING: Duration = Duration::from_secs(5);

/// Copy of this window's unsaved work, and copies left by crashed windows.
#[derive(Default)]
pub(crate) struct Recover {
    pub place: Option<Recovery>,
    pub keeper: Option<Autosave>,
    pub left: Vec<OrphanedDraft>,
    /// Time at which what was left behind is looked for once more.
    pub looks_again: Option<Instant>,
    /// Time when work was last kept, or could not be.
    pub kept: Option<Instant>,
    /// Revision of the work that could not be kept.
    pub failed: Option<u64>,
}

impl Recover {
    /// Keeps work in a place, and looks what was left behind there.
    pub fn at(place: Recovery) -> Recover {
        let (left, looks_again) = (place.left_behind(), Some(Instant::now() + ENDING));
        Recover { left, looks_again, place: Some(place), ..Recover::default() }
    }

    /// Looks once more for what was left behind, when it is time; returns the time until then.
    pub fn look_again(&mut self) -> Option<Duration> {
        let left = self.looks_again?.saturating_duration_since(Instant::now());
        if !left.is_zero() {
            return Some(left);
        }
        self.looks_again = None;
        // Those of which it is known are held, and are not found again.
        self.left.extend(self.place.iter().flat_map(Recovery::left_behind));
        // What was found is shown in another frame.
        (!self.left.is_empty()).then_some(Duration::ZERO)
    }

    /// Another document is worked on: what was kept of the former one is not wanted any more.
    pub fn forget(&mut self) {
        if let Some(mut keeper) = self.keeper.take() {
            let _ = keeper.give_up();
        }
        (self.kept, self.failed) = (None, None);
    }
}

/// Asks a question in the middle of the window; the answer, once a button is clicked. Escape is the last answer, which changes nothing and has
/// the focus at first.
pub(crate) fn ask<T: Copy>(ctx: &Context, title: &str, text: String, answers: &[(&str, T)]) -> Option<T> {
    let mut answer = None;
    let step = focus_step(ctx);
    let window = Window::new(title).collapsible(false).resizable(false);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        ui.label(text);
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let buttons: Vec<Response> = answers.iter().map(|(text, _)| ui.button(*text)).collect();
            answer = buttons.iter().zip(answers).find(|(button, _)| button.clicked()).map(|(_, (_, of))| *of);
            // The keys are for the question, whatever had the focus before.
            let at = buttons.iter().position(Response::has_focus);
            let step = at.map_or(-1, |at| at as isize + step);
            let to = step.rem_euclid(buttons.len().max(1) as isize) as usize;
            if let Some(button) = buttons.get(to).filter(|_| at != Some(to)) {
                button.request_focus();
            }
        });
    });
    if answer.is_none() && takes_escape(ctx) {
        return answers.last().map(|(_, last)| *last);
    }
    answer
}

/// True if Escape was pressed; it answers one question or dialog, and no other of the same frame.
fn takes_escape(ctx: &Context) -> bool {
    ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
}

/// Steps to the right by which Tab and the arrows of this frame move the focus in a row of buttons. Called before these are shown: egui
/// itself moves it no more.
fn focus_step(ctx: &Context) -> isize {
    ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    let pressed =
        |held: Modifiers, key: Key| isize::from(ctx.input_mut(|input| input.consume_key(held, key)));
    let back = pressed(Modifiers::SHIFT, Key::Tab) + pressed(Modifiers::NONE, Key::ArrowLeft);
    pressed(Modifiers::NONE, Key::Tab) + pressed(Modifiers::NONE, Key::ArrowRight) - back
}

impl FilePurpose {
    fn title(&self) -> String {
        match self {
            FilePurpose::Open => "Open a pipeline or data".into(),
            FilePurpose::SaveAs => "Save as".into(),
            FilePurpose::Data(template) => format!("Data for: {}", template.title),
            FilePurpose::Film => "The file of the film".into(),
            FilePurpose::Parameter { node, path, writes: false } => format!("A file to read: {node}.{path}"),
            FilePurpose::Parameter { node, path, writes: true } => format!("A file to write: {node}.{path}"),
        }
    }

    fn accepts(&self, name: &str) -> bool {
        let end = Path::new(name).extension().map(|end| end.to_string_lossy().to_lowercase());
        let end = end.unwrap_or_default();
        match self {
            FilePurpose::Open => is_pipeline_ending(&end) || DATA.split(' ').any(|data| data == end),
            FilePurpose::Data(_) => DATA.split(' ').any(|data| data == end),
            FilePurpose::SaveAs => is_pipeline_ending(&end),
            FilePurpose::Film => ["mp4", "webm", "gif", "png"].contains(&end.as_str()),
            FilePurpose::Parameter { .. } => true,
        }
    }
}

#[derive(Debug)]
pub(crate) struct FileDialog {
    pub purpose: FilePurpose,
    folder: PathBuf,
    pub name: String,
    /// Typed text: names that hold it are listed where a file is read.
    typed: String,
    entries: Vec<ListedFile>,
    /// True if the name gets the focus.
    takes_focus: bool,
    warned: bool,
    /// Reason why the file that was chosen last was not taken.
    pub fault: Option<String>,
}

#[derive(Debug)]
struct ListedFile {
    name: String,
    is_folder: bool,
    /// Size and age in words; of a folder none.
    figures: String,
}

impl ListedFile {
    fn new(entry: &std::fs::DirEntry) -> ListedFile {
        let name = entry.file_name().to_string_lossy().into_owned();
        let about = std::fs::metadata(entry.path()).ok();
        let is_folder = about.as_ref().is_some_and(std::fs::Metadata::is_dir);
        let age = about.as_ref().and_then(|about| about.modified().ok()?.elapsed().ok()).map(age);
        let size = about.filter(|_| !is_folder).map(|about| size(about.len()));
        let figures: Vec<String> = size.into_iter().chain(age.filter(|_| !is_folder)).collect();
        ListedFile { name, is_folder, figures: figures.join(" · ") }
    }
}

/// Size of a file or of memory in words: "12 kB", "3.1 GB".
pub(crate) fn size(bytes: u64) -> String {
    let mut size = bytes as f64;
    for unit in ["bytes", "kB", "MB", "GB"] {
        if size < 1000.0 {
            let digits = usize::from(unit == "GB" && size < 10.0);
            return format!("{size:.digits$} {unit}");
        }
        size /= 1000.0;
    }
    format!("{size:.1} TB")
}

/// Time since a file was written in words: "3 hours ago".
pub(crate) fn age(time: Duration) -> String {
    let seconds = time.as_secs();
    let units = [(86_400, "day"), (3600, "hour"), (60, "minute")];
    let words = units.into_iter().find_map(|(length, unit)| {
        let count = seconds / length;
        (count > 0).then(|| format!("{} ago", counted(count as usize, unit)))
    });
    words.unwrap_or_else(|| "just now".into())
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
            // Where no data file is known, the path is another file's.
            FilePurpose::Data(_) => own.filter(|name| purpose.accepts(name)).unwrap_or_default(),
            FilePurpose::Film | FilePurpose::Parameter { .. } => own.unwrap_or_default(),
        };
        let mut dialog = FileDialog {
            purpose,
            folder,
            name,
            typed: String::new(),
            entries: Vec::new(),
            takes_focus: true,
            warned: false,
            fault: None,
        };
        dialog.read();
        dialog
    }

    fn read(&mut self) {
        let entries = std::fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut entries: Vec<ListedFile> = entries
            .map(|entry| ListedFile::new(&entry))
            .filter(|file| {
                !file.name.starts_with('.') && (file.is_folder || self.purpose.accepts(&file.name))
            })
            .collect();
        entries.sort_by_key(|file| (!file.is_folder, file.name.to_lowercase()));
        self.entries = entries;
    }

    fn go(&mut self, folder: PathBuf) {
        self.folder = std::fs::canonicalize(&folder).unwrap_or(folder);
        self.typed.clear();
        self.read();
    }

    /// Shows a reason why the chosen file is not taken; another name can be typed.
    pub fn refuse(&mut self, fault: String) {
        (self.fault, self.takes_focus) = (Some(fault), true);
    }

    /// True if a file that is there is chosen.
    fn reads(&self) -> bool {
        matches!(
            self.purpose,
            FilePurpose::Open | FilePurpose::Data(_) | FilePurpose::Parameter { writes: false, .. }
        )
    }

    /// Names of the list that hold what was typed, in any letters; all where none does.
    fn fitting(&self) -> Vec<&ListedFile> {
        let typed = self.typed.to_lowercase();
        let fits = |file: &&ListedFile| !self.reads() || file.name.to_lowercase().contains(&typed);
        let fitting: Vec<&ListedFile> = self.entries.iter().filter(fits).collect();
        if fitting.is_empty() { self.entries.iter().collect() } else { fitting }
    }

    /// Takes the next name of the list by the arrows, while the field has the focus; true if it did.
    fn follow_arrows(&mut self, ui: &Ui) -> bool {
        let pressed = [Key::ArrowUp, Key::ArrowDown]
            .map(|key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)));
        let fitting = self.fitting();
        let next = arrow_step(pressed, fitting.iter().position(|file| file.name == self.name));
        let next = next.and_then(|next| fitting.get(next)).map(|file| file.name.clone());
        let is_moved = next.is_some();
        next.into_iter().for_each(|name| (self.name, self.warned) = (name, false));
        is_moved
    }

    fn show(&mut self, ui: &mut Ui) -> Option<PathBuf> {
        let mut chosen = None;
        let field_id = ui.id().with("name of the file");
        let is_moved = ui.memory(|memory| memory.has_focus(field_id)) && self.follow_arrows(ui);
        ui.horizontal(|ui| {
            if ui.button("⬆").help("the folder above").clicked()
                && let Some(above) = self.folder.parent().map(Path::to_path_buf)
            {
                self.go(above);
            }
            ui.label(self.folder.display().to_string());
        });
        ScrollArea::vertical().max_height(320.0).auto_shrink([false, false]).show_followed(ui, |ui| {
            let mut into = None;
            let mut clicked = None;
            for ListedFile { name, is_folder, figures } in self.fitting() {
                let text = if *is_folder { format!("🗀  {name}") } else { format!("      {name}") };
                let row = ui.horizontal(|ui| {
                    let row = ui.selectable_label(*name == self.name, text);
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        ui.label(RichText::new(figures).small().color(theme::weak(ui.visuals().dark_mode)));
                    });
                    row
                });
                let row = row.inner;
                if is_moved && *name == self.name {
                    row.scroll_to_me(None);
                }
                if row.clicked() && *is_folder {
                    into = Some(self.folder.join(name));
                } else if row.clicked() {
                    clicked = Some(name.clone());
                }
                if row.double_clicked() && !is_folder {
                    chosen = Some(self.folder.join(name));
                }
            }
            if let Some(name) = clicked {
                (self.name, self.warned) = (name, false);
            }
            if self.entries.is_empty() {
                ui.label("This folder has no files of an accepted kind.");
            }
            if let Some(into) = into {
                self.go(into);
            }
        });
        ui.horizontal(|ui| {
            let text = match (&self.purpose, self.warned) {
                (FilePurpose::Open | FilePurpose::Data(_), _) => "Open",
                (FilePurpose::SaveAs, false) => "Save",
                (FilePurpose::SaveAs, true) => "Write over it",
                (FilePurpose::Film | FilePurpose::Parameter { .. }, _) => "Choose",
            };
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let is_clicked = ui.button(text).clicked();
                let field = TextEdit::singleline(&mut self.name).id(field_id).hint_text("a name or a path");
                let field = ui.add(field.desired_width(f32::INFINITY));
                ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("name of the file"));
                if std::mem::take(&mut self.takes_focus) {
                    field.request_focus();
                }
                if field.changed() {
                    (self.typed, self.warned, self.fault) = (self.name.clone(), false, None);
                }
                let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if (is_clicked || entered) && !self.name.is_empty() {
                    chosen = Some(self.folder.join(&self.name));
                }
            });
        });
        if self.warned {
            ui.label("There is a file of that name.");
        }
        if let Some(fault) = &self.fault {
            ui.label(RichText::new(fault).color(theme::wrong(ui.visuals().dark_mode)));
        }
        let path = chosen?;
        if path.is_dir() {
            self.name.clear();
            self.takes_focus = true;
            self.go(path);
            return None;
        }
        if self.reads() && !path.exists() {
            // A part of one name alone stands for it.
            if let ([only], false) = (self.fitting().as_slice(), self.typed.is_empty()) {
                let path = self.folder.join(&only.name);
                if !only.is_folder {
                    return Some(path);
                }
                self.name.clear();
                self.go(path);
                self.takes_focus = true;
                return None;
            }
            self.refuse(format!("'{}' is no file of this folder, and no path of one", self.name));
            return None;
        }
        // The choice alone overwrites an existing file.
        if self.purpose == FilePurpose::SaveAs && path.exists() && !self.warned {
            self.warned = true;
            return None;
        }
        Some(path)
    }
}

/// Shows the dialog that is open; it and the file, once one is chosen.
pub(crate) fn show_dialog(
    open_dialog: &mut Option<FileDialog>,
    ctx: &Context,
) -> Option<(FileDialog, PathBuf)> {
    let mut dialog = open_dialog.take()?;
    let mut open = true;
    let mut chosen = None;
    Window::new(dialog.purpose.title())
        .id(Sheet::FILE.id())
        .open(&mut open)
        .collapsible(false)
        .default_width(460.0)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| chosen = dialog.show(ui));
    if chosen.is_none() && open && !takes_escape(ctx) {
        *open_dialog = Some(dialog);
        return None;
    }
    Some((dialog, chosen?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::templates::Template;
    use std::sync::mpsc;

    #[test]
    fn the_dialog_of_a_template_begins_with_a_data_file_alone() {
        let template = Template { title: "a volume".into(), text: "" };
        let name =
            |path: &str| FileDialog::new(FilePurpose::Data(template.clone()), Some(Path::new(path))).name;
        assert_eq!([name("scene.toml"), name("wing.vtu")], ["", "wing.vtu"]);
    }

    #[test]
    fn a_file_that_comes_or_changes_wakes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("data.vtk");
        let (sender, woken) = mpsc::channel();
        let watch = FileWatcher::start(BETWEEN / 100, move || _ = sender.send(())).unwrap();
        let know = || watch.knows(FileStamps::from([(path.clone(), stamp(&path))]));
        know();
        std::fs::write(&path, "1").unwrap();
        woken.recv_timeout(60 * BETWEEN).expect("a file that came");
        know();
        while woken.recv_timeout(BETWEEN / 10).is_ok() {}
        std::fs::write(&path, "12").unwrap();
        woken.recv_timeout(60 * BETWEEN).expect("a file that changed");
        drop(watch);
        while woken.recv_timeout(60 * BETWEEN).is_ok() {}
        assert_eq!(woken.recv_timeout(60 * BETWEEN), Err(mpsc::RecvTimeoutError::Disconnected));
    }
}
