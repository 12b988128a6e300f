//! A new document for a data file, made on a thread of its own.

use crate::editor::{Editor, Making, Next};
use crate::files::{FileDialog, free_path};
use crate::jobs::Job;
use crate::worker::short_by;
use eframe::egui::Context;
use std::path::Path;
use voltet_core::Result;
use voltet_core::error::ErrorKind;
use voltet_core::progress::Progress;
use voltet_document::Document;
use voltet_graph::NodeProgress;
use voltet_io::memory;

impl Editor {
    /// Makes a document for a data file, on a thread of its own. `make`: of the file, and where the document would be saved.
    pub(crate) fn make(
        &mut self,
        ctx: &Context,
        path: &Path,
        dialog: Option<FileDialog>,
        make: impl FnOnce(&Path, &Path, &dyn Progress) -> Result<Document> + Send + 'static,
    ) {
        self.recent.add(path);
        let (at, path) = (free_path(path), path.to_path_buf());
        let gigabytes = |bytes: u64| format!("{} GB", short_by(1e-9 * bytes as f64, 0.01));
        let size = std::fs::metadata(&path).map(|file| format!(", {}", gigabytes(file.len())));
        let free = memory::available().map(|bytes| format!("; {} of memory are free", gigabytes(bytes)));
        let words = format!("{}{}{}", path.display(), size.unwrap_or_default(), free.unwrap_or_default());
        let name = path.display().to_string();
        let made =
            Job::start("start", ctx, move |observer| make(&path, &at, &NodeProgress { observer, node: "" }));
        match self.check(made) {
            Some(job) => {
                self.say(format!("making a pipeline for {name} …"));
                self.made = Some(Making { job, words, revision: self.document.revision(), dialog });
            }
            None => self.ask_again(dialog),
        }
    }

    pub(crate) fn take_made(&mut self, ctx: &Context) {
        let Some(made) = self.made.as_ref().and_then(|made| made.job.result()) else { return };
        let Some(Making { revision, dialog, .. }) = self.made.take() else { return };
        if made.as_ref().is_err_and(|error| error.kind == ErrorKind::Cancelled) {
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
