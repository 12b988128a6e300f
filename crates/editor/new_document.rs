//! A new document for a data file, made on a thread of its own: first the memory that this takes is found by headers alone, and where more is
//! needed than is free, a question comes before the data are read.

use crate::editor::{Editor, Next};
use crate::files::{FileDialog, ask, free_path, size};
use crate::jobs::Job;
use crate::opening::{LargeData, MIN_BYTES, Make, Making, Need, OpeningResult};
use eframe::egui::Context;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_document::Document;
use voltet_graph::{NodeProgress, Observer};

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
        let free_memory = self.free_memory;
        let made = Job::start("start", ctx, move |observer: &dyn Observer| {
            observer.progress("", "headers", 0.0);
            let found = Need::of_file(&data, free_memory());
            let _ = of_thread.set(found);
            if observer.cancelled() {
                return Err(Error::cancelled());
            }
            if asks && found.exceeds() {
                return Ok(OpeningResult::BeyondMemory(make));
            }
            make(&data, &at, &NodeProgress { observer, node: "" }).map(OpeningResult::Document)
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
            let text = making.words.clone() + &need.text();
            self.say(text);
        }
        let Some(made) = self.made.as_ref().and_then(|made| made.job.result()) else { return };
        let Some(Making { job, path, words, need, revision, dialog }) = self.made.take() else { return };
        // It may have come to its end all the same.
        if job.is_cancelled() {
            return self.say("stopped; what was shown stays");
        }
        match self.check(made) {
            Some(OpeningResult::Document(document)) if self.document.revision() == revision => {
                self.take(document)
            }
            Some(OpeningResult::Document(document)) => {
                self.unless_unsaved(ctx, Next::Take(Box::new(document)))
            }
            Some(OpeningResult::BeyondMemory(make)) => {
                let need = need.get().copied().unwrap_or_default();
                // Another message is none of this.
                self.message = self.message.take().filter(|message| !message.text.starts_with(&words));
                self.large = Some(LargeData { path, need, make, dialog });
            }
            None => self.ask_again(dialog),
        }
    }

    fn says(&self, words: &str) -> bool {
        self.message.as_ref().is_some_and(|message| message.text == words)
    }

    /// Asks about data that need more memory than is free.
    pub(crate) fn offer_large_data(&mut self, ctx: &Context) {
        let Some(LargeData { path, need, .. }) = &self.large else { return };
        let [needed, free] = [need.needed, need.free].map(|bytes| size(bytes.unwrap_or(0)));
        let mut text = format!(
            "Opening {} needs about {needed} of memory to its first picture, and {free} are free.\n\
             A reader (Space in the graph) that names some of its blocks takes less.",
            path.display()
        );
        if need.is_in_pieces {
            let limit = free.replace(' ', "");
            text += &format!(
                "\nIt is in pieces: `voltet run --memory {limit} PIPELINE.toml` draws some of them at a time."
            );
        }
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
