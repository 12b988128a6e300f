//! Documents that are being made for data files, the memory that this takes, and how far they are.

use crate::files::{FileDialog, size};
use crate::jobs::Job;
use crate::theme::Help;
use eframe::egui::{Button, ProgressBar, Ui};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_document::Document;
use voltet_io::formats::Request;
use voltet_nodes::drawing::MemoryNeed;

/// Smallest file whose size is told: smaller ones may list others that hold the data, and none of them fills the memory.
pub(crate) const MIN_BYTES: u64 = 1_000_000;

/// Makes a document of the data file, the place where it would be saved, and the progress.
pub(crate) type Make = Box<dyn FnOnce(&Path, &Path, &dyn Progress) -> Result<Document> + Send>;

/// Memory that opening a file takes to its first picture, as far as it is known.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Need {
    /// Bytes; `None` where headers do not tell, or it is no data: what is wrong with it is said when it is read.
    pub needed: Option<u64>,
    /// Bytes that are free; `None` where the system does not tell.
    pub free: Option<u64>,
    /// True if the file holds several pieces, which can be drawn some at a time.
    pub is_in_pieces: bool,
}

/// Document that is being made for data.
pub(crate) struct Making {
    pub job: Job<OpeningResult>,
    /// The data file.
    pub path: PathBuf,
    /// Words for it, without its need of memory.
    pub words: String,
    pub need: Arc<OnceLock<Need>>,
    /// Revision of the document that was shown when it was asked for.
    pub revision: u64,
    /// The dialog by which the data were chosen, or would be.
    pub dialog: FileDialog,
}

/// End of a job.
pub(crate) enum OpeningResult {
    Document(Document),
    /// Nothing was read: more memory is needed than is free.
    BeyondMemory(Make),
}

/// Data that need more memory than is free, until a hand says what becomes of them.
pub(crate) struct LargeData {
    pub path: PathBuf,
    pub need: Need,
    pub make: Make,
    pub dialog: FileDialog,
}

impl Need {
    /// Need of a file, of which nothing but the headers is read.
    pub fn of_file(path: &Path, free: Option<u64>) -> Need {
        let found = MemoryNeed::of_file(path, &Request::default()).ok();
        let is_in_pieces = found.is_some_and(|need| need.piece_count() > 1);
        Need { needed: found.map(|need| need.opening()), free, is_in_pieces }
    }

    pub fn exceeds(&self) -> bool {
        self.needed.zip(self.free).is_some_and(|(needed, free)| needed > free)
    }

    pub fn text(&self) -> String {
        let needed = self.needed.map(|bytes| format!("; needs about {}", size(bytes)));
        let free = self.free.map(|bytes| format!("; {} of memory are free", size(bytes)));
        needed.into_iter().chain(free).collect()
    }
}

/// Shows how far the document is that is made for data, and a button that stops that. Returns the path of the data.
pub(crate) fn show_making(made: &Making, ui: &mut Ui) -> String {
    let is_stopping = made.job.is_cancelled();
    let stop = Button::new(if is_stopping { "stopping …" } else { "Stop" }).small();
    if ui.add_enabled(!is_stopping, stop).help("what is shown now stays").clicked() {
        made.job.cancel();
    }
    let (stage, fraction) = made.job.progress();
    ui.add(ProgressBar::new(fraction as f32).desired_width(120.0).show_percentage());
    ui.label(stage);
    made.path.display().to_string()
}
