//! A new document for a data file, made on a thread of its own: first the memory that this takes is found by headers alone, and where more is
//! needed than is free, a question comes before the data are read.

use crate::editor::{Editor, Next};
use crate::files::{FileDialog, ask, free_path, size};
use crate::jobs::Job;
use eframe::egui::{Button, Context, ProgressBar, Ui};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_document::Document;
use voltet_graph::{NodeProgress, Observer};
use voltet_io::formats::Request;
use voltet_nodes::drawing::MemoryNeed;

/// Smallest file whose size is told: smaller ones may list others that hold the data, and none of them fills the memory.
const MIN_BYTES: u64 = 1_000_000;

/// Makes a document of the data file, the place where it would be saved, and the progress.
type Make = Box<dyn FnOnce(&Path, &Path, &dyn Progress) -> Result<Document> + Send>;

/// Bytes that opening a file takes, and bytes that are free, as far as they are known.
type Need = (Option<u64>, Option<u64>);

/// Document that is being made for data.
pub(crate) struct Making {
    job: Job<Made>,
    /// The data file.
    path: PathBuf,
    /// Words for it, without its need of memory.
    words: String,
    need: Arc<OnceLock<Need>>,
    /// Revision of the document that was shown when it was asked for.
    revision: u64,
    /// The dialog by which the data were chosen, or would be.
    dialog: FileDialog,
}

/// End of a job.
enum Made {
    Document(Document),
    /// Nothing was read: more memory is needed than is free.
    BeyondMemory(Make),
}

/// Data that need more memory than is free, until a hand says what becomes of them.
pub(crate) struct LargeData {
    path: PathBuf,
    need: Need,
    make: Make,
    dialog: FileDialog,
}

impl Editor {
    /// Makes a document for a data file, on a thread of its own. `make`: of the file, and where the document would be saved.
    pub(crate) fn make(
        &mut self,
        ctx: &Context,
        path: &Path,
        dialog: FileDialog,
        make: impl FnOnce(&Path, &Path, &dyn Progress) -> Result<Document> + Send + 'static,
    ) {
        self.recent.add(path);
        self.begin_making(ctx, path, dialog, Box::new(make), true);
    }

    /// `asks`: true if nothing is read where more memory is needed than is free.
    fn begin_making(&mut self, ctx: &Context, path: &Path, dialog: FileDialog, make: Make, asks: bool) {
        let name = name_of(path);
        let bytes = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file).map(|file| file.len());
        let bytes = bytes.filter(|bytes| *bytes >= MIN_BYTES).map(|bytes| format!(" of {}", size(bytes)));
        let words = format!("making a pipeline for {name}{} …", bytes.unwrap_or_default());
        let need: Arc<OnceLock<Need>> = Arc::default();
        let (at, of_thread, data) = (free_path(path), need.clone(), path.to_path_buf());
        let made = Job::start("start", ctx, move |observer: &dyn Observer| {
            observer.progress("", "headers", 0.0);
            let found = (need_of(&data), observer.memory_left());
            let _ = of_thread.set(found);
            if asks && exceeds(found) {
                return Ok(Made::BeyondMemory(make));
            }
            make(&data, &at, &NodeProgress { observer, node: "" }).map(Made::Document)
        });
        match self.check(made) {
            Some(job) => {
                self.say(words.clone());
                let (path, revision) = (path.to_path_buf(), self.document.revision());
                self.made = Some(Making { job, path, words, need, revision, dialog });
            }
            None => self.ask_again(dialog),
        }
    }

    pub(crate) fn take_made(&mut self, ctx: &Context) {
        let Some(making) = self.made.as_ref() else { return };
        if let Some(need) = making.need.get().filter(|_| self.says(&making.words)) {
            let text = making.words.clone() + &in_words(*need);
            self.say(text);
        }
        let Some(made) = self.made.as_ref().and_then(|made| made.job.result()) else { return };
        let Some(Making { job, path, need, revision, dialog, .. }) = self.made.take() else { return };
        // It may have come to its end all the same.
        if job.is_cancelled() {
            return self.say("stopped; what was shown stays");
        }
        match self.check(made) {
            Some(Made::Document(document)) if self.document.revision() == revision => self.take(document),
            Some(Made::Document(document)) => self.unless_unsaved(ctx, Next::Take(Box::new(document))),
            Some(Made::BeyondMemory(make)) => {
                let need = need.get().copied().unwrap_or_default();
                self.message = None;
                self.large = Some(LargeData { path, need, make, dialog });
            }
            None => self.ask_again(dialog),
        }
    }

    fn says(&self, words: &str) -> bool {
        self.message.as_ref().is_some_and(|(text, _)| text == words)
    }

    /// Asks about data that need more memory than is free.
    pub(crate) fn offer_large_data(&mut self, ctx: &Context) {
        let Some(LargeData { path, need, .. }) = &self.large else { return };
        let [needed, free] = [need.0, need.1].map(|bytes| size(bytes.unwrap_or(0)));
        let text = format!(
            "Opening {} needs about {needed} of memory, and {free} are free.\nA reader (Space in the graph) that names some of the \
             blocks or one array takes less, as do a smaller time step\nor file, and `voltet run --memory {free}`, which draws it in pieces.",
            path.display()
        );
        let Some(is_wanted) = ask(ctx, "Large data", text, &[("Open anyway", true), ("Cancel", false)])
        else {
            return;
        };
        let Some(LargeData { path, make, dialog, .. }) = self.large.take() else { return };
        match is_wanted {
            true => self.begin_making(ctx, &path, dialog, make, false),
            false => self.say(format!("{} was not read", name_of(&path))),
        }
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Bytes that opening a file takes; `None` where headers do not tell, or it is no data: what is wrong with it is said when it is read.
fn need_of(path: &Path) -> Option<u64> {
    let need = MemoryNeed::of_file(path, &Request::default()).ok()?;
    Some(need.opening())
}

fn exceeds((needed, free): Need) -> bool {
    needed.zip(free).is_some_and(|(needed, free)| needed > free)
}

fn in_words((needed, free): Need) -> String {
    let needed =
        needed.filter(|bytes| *bytes >= MIN_BYTES).map(|bytes| format!("; needs about {}", size(bytes)));
    let free = free.map(|bytes| format!("; {} of memory are free", size(bytes)));
    needed.into_iter().chain(free).collect()
}

/// Shows how far the document is that is made for data, and a button that stops that. Returns the path of the data.
pub(crate) fn show_making(made: &Making, ui: &mut Ui) -> String {
    let is_stopping = made.job.is_cancelled();
    let stop = Button::new(if is_stopping { "stopping …" } else { "Stop" }).small();
    if ui.add_enabled(!is_stopping, stop).on_hover_text("what is shown now stays").clicked() {
        made.job.cancel();
    }
    let (stage, fraction) = made.job.progress();
    ui.add(ProgressBar::new(fraction as f32).desired_width(120.0).show_percentage());
    ui.label(stage);
    made.path.display().to_string()
}
