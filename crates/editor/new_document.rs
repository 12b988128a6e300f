//! A new document for a data file, made on a thread of its own.

use crate::editor::{Editor, Making, Next};
use crate::files::{FileDialog, free_path, size};
use crate::jobs::Job;
use eframe::egui::Context;
use std::path::Path;
use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_document::Document;
use voltet_graph::NodeProgress;
use voltet_io::memory;

/// Smallest file whose size is told: smaller ones may list others that hold the data, and none of them fills the memory.
const MIN_BYTES: u64 = 1_000_000;

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
        let (at, path) = (free_path(path), path.to_path_buf());
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let bytes = std::fs::metadata(&path).ok().filter(std::fs::Metadata::is_file).map(|file| file.len());
        let bytes = bytes.filter(|bytes| *bytes >= MIN_BYTES).map(|bytes| format!(" of {}", size(bytes)));
        let free = memory::available().map(|bytes| format!("; {} of memory are free", size(bytes)));
        let [bytes, free] = [bytes, free].map(Option::unwrap_or_default);
        let place = path.display().to_string();
        let made =
            Job::start("start", ctx, move |observer| make(&path, &at, &NodeProgress { observer, node: "" }));
        match self.check(made) {
            Some(job) => {
                self.say(format!("making a pipeline for {name}{bytes} …{free}"));
                self.made = Some(Making { job, path: place, revision: self.document.revision(), dialog });
            }
            None => self.ask_again(dialog),
        }
    }

    pub(crate) fn take_made(&mut self, ctx: &Context) {
        let Some(made) = self.made.as_ref().and_then(|made| made.job.result()) else { return };
        let Some(Making { job, revision, dialog, .. }) = self.made.take() else { return };
        // It may have come to its end all the same.
        if job.is_cancelled() {
            return self.say("stopped; what was shown stays");
        }
        let Some(document) = self.check(made) else { return self.ask_again(dialog) };
        if self.document.revision() == revision {
            self.take(document);
        } else {
            self.unless_unsaved(ctx, Next::Take(Box::new(document)));
        }
    }
}
