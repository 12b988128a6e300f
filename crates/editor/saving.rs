//! The document and its file: opened or made for data, saved, changed by another program, taken away, recovered after a crash.

use crate::actions::{Command, FilePurpose};
use crate::editor::Editor;
use crate::file_dialog::{FileDialog, ask};
use crate::files::{Disk, Recover, begun, free_path, is_pipeline};
use crate::graph::GraphView;
use crate::jobs::Job;
use crate::parameters::ParameterPanel;
use crate::transfer::TransferPanel;
use eframe::egui::Context;
use std::path::Path;
use std::time::{Duration, Instant};
use voltet_document::{Document, Recovery};
use voltet_nodes::files::{folder, refuse_unwritable};

/// Shortest interval between two copies of unsaved work.
const BETWEEN: Duration = Duration::from_secs(2);

impl Editor {
    /// Opens a pipeline file, or makes a pipeline for another file, on a thread of its own.
    pub(crate) fn open_any(&mut self, ctx: &Context, path: &Path) {
        if is_pipeline(path) {
            match Document::open(path) {
                Ok(document) => {
                    self.recent.add(path);
                    self.take(document);
                }
                Err(error) => self.complain(&error),
            }
            return;
        }
        self.recent.add(path);
        let at = free_path(path);
        let (start, path) = (self.start.clone(), path.to_path_buf());
        let name = path.display().to_string();
        match Job::start("start", ctx, move |_| begun(start(&path, &at)?, &at)) {
            Ok(made) => {
                self.message = Some((format!("making a pipeline for {name} …"), false));
                self.made = Some(made);
            }
            Err(error) => self.complain(&error),
        }
    }

    /// Takes over a pipeline that was made.
    pub(crate) fn take_made(&mut self) {
        let Some(made) = self.made.as_ref().and_then(Job::result) else { return };
        self.made = None;
        match made {
            Ok(document) => self.take(document),
            Err(error) => self.complain(&error),
        }
    }

    /// Saves the document in its own file, or asks for one; and asks where another program wrote it meanwhile.
    pub(crate) fn save(&mut self) {
        let Some(path) = self.document.path().map(Path::to_path_buf) else {
            self.file_dialog = Some(FileDialog::new(FilePurpose::SaveAs, None));
            return;
        };
        if self.document.changed_on_disk() {
            self.disk.is_changed = true;
            return;
        }
        self.save_as(&path);
    }

    /// Takes over another program's changes of the file, or overwrites them.
    pub(crate) fn settle_with_disk(&mut self, takes_over: bool) {
        let outcome = if takes_over { self.document.reload() } else { self.document.save_over() };
        self.disk = Disk::default();
        if let Err(error) = outcome {
            self.complain(&error);
        }
    }

    pub(crate) fn save_as(&mut self, path: &Path) {
        let mut path = path.to_path_buf();
        if path.extension().is_none() {
            path.set_extension("toml");
        }
        if let Err(error) = refuse_unwritable(&path) {
            self.complain(&error);
            return;
        }
        let follow = self.document.following_to(&self.registry, folder(&path));
        let paths = match follow.len() {
            0 => String::new(),
            1 => "; a path in it leads to the same file from there".into(),
            count => format!("; {count} paths in it lead to the same files from there"),
        };
        if !follow.is_empty() {
            self.edit("paths that lead from the new folder".into(), &follow);
        }
        match self.document.save_as(&path) {
            Ok(()) => {
                self.recent.add(&path);
                self.message = Some((format!("saved: {}{paths}", path.display()), false));
            }
            Err(error) => self.complain(&error),
        }
    }

    /// Carries out what takes the document away, or asks first.
    pub(crate) fn unless_unsaved(&mut self, ctx: &Context, command: Command) {
        match self.document.is_saved() {
            true => self.go_on(ctx, command),
            false => self.unsaved = Some(command),
        }
    }

    /// Carries it out.
    pub(crate) fn go_on(&mut self, ctx: &Context, command: Command) {
        match (command, self.begin_with.take()) {
            (Command::New, _) => self.take(Document::new()),
            (Command::Open, Some(path)) => self.open_any(ctx, &path),
            (Command::Open, None) => {
                self.file_dialog = Some(FileDialog::new(FilePurpose::Open, self.document.path()))
            }
            _ => self.ends = true,
        }
    }

    /// Another document in place of this one.
    pub(crate) fn take(&mut self, document: Document) {
        self.document = document;
        self.run = None;
        self.recover.forget();
        self.begin();
        self.disk = Disk::default();
        self.shown_node = None;
        (self.asked, self.previews_of) = (None, None);
        self.worker.forget_previews();
        // Revisions count from the beginning of each document.
        self.faults = (None, Vec::new());
        self.parameters = ParameterPanel::default();
        self.message = None;
        self.graph = GraphView::default();
        self.transfer = TransferPanel::default();
    }

    /// Keeps work from now on in a place.
    pub(crate) fn keep_in(&mut self, place: Recovery) {
        self.recover = Recover::at(place);
    }

    /// Keeps the work as it is now; true where there is more to keep a little later.
    pub(crate) fn keep(&mut self, ctx: &Context) {
        let Some(place) = &self.recover.place else { return };
        if self.document.is_saved() {
            // What is saved is not offered again, however the window ends.
            if let (Some(_), Some(keeper)) = (self.recover.kept.take(), &mut self.recover.keeper) {
                let _ = keeper.give_up();
            }
            return;
        }
        if let Some(kept) = self.recover.kept.filter(|kept| kept.elapsed() < BETWEEN) {
            ctx.request_repaint_after(BETWEEN - kept.elapsed().min(BETWEEN));
            return;
        }
        if self.recover.keeper.is_none() {
            // Without a folder to write to, work is not kept; saving says why.
            self.recover.keeper = place.keeper(&self.document).ok();
        }
        let document = &self.document;
        let outcome = self.recover.keeper.as_mut().map(|keeper| keeper.follow(document));
        self.recover.kept = Some(Instant::now());
        if let Some(Err(error)) = outcome {
            self.complain(&error);
        }
    }

    /// Offers what was left behind.
    pub(crate) fn offer_left_behind(&mut self, ctx: &Context) {
        let Some(left) = self.recover.left.first() else { return };
        let name = left.path.as_ref().map_or("a new pipeline".into(), |path| path.display().to_string());
        let text = format!("A window ended without saving what was done in {name}.");
        let answers = [("Open it", 0), ("Throw it away", 1), ("Later", 2)];
        let Some(answer) = ask(ctx, "Work that was not saved", text, &answers) else { return };
        let left = self.recover.left.remove(0);
        match answer {
            0 => {
                let document = left.document();
                self.take(document);
                // Kept anew under this window's name before it goes.
                self.recover.kept = None;
                self.keep(ctx);
                let _ = left.give_up();
            }
            1 => {
                let _ = left.give_up();
            }
            _ => self.recover.left.clear(),
        }
    }
}
