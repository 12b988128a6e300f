//! A whole run of the document, as `voltet run` makes it: files are written. On a thread of its own, with a session of its own,
//! so that the picture in the window goes on.

use crate::editor::Editor;
use crate::picture::milliseconds;
use eframe::egui::Context;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use voltet_core::{Error, Result};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{Graph, Observer, RunReport};
use voltet_io::memory;
use voltet_nodes::files::relative_to;

/// A run that is under way; dropped, it stops.
pub(crate) struct Run {
    outcome: Receiver<Result<RunReport>>,
    stops: Arc<AtomicBool>,
}

impl Drop for Run {
    fn drop(&mut self) {
        self.stops.store(true, Ordering::Relaxed);
    }
}

struct Stopped(Arc<AtomicBool>);

impl Observer for Stopped {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

impl Run {
    fn start(graph: Graph, ctx: &Context) -> Result<Run> {
        let (sender, outcome) = channel();
        let stops = Arc::new(AtomicBool::new(false));
        let (observer, ctx) = (Stopped(stops.clone()), ctx.clone());
        let work = move || {
            let report = voltet_nodes::session().run(&graph, &observer);
            // Nobody waits for it any more where it was stopped.
            let _ = sender.send(report);
            ctx.request_repaint();
        };
        let spawned = std::thread::Builder::new().name("run".into()).spawn(work);
        spawned.map_err(|error| Error::run("no thread can be had").got(error))?;
        Ok(Run { outcome, stops })
    }
}

impl Editor {
    /// Begins a run of the document as it is shown; stops the one that is under way.
    pub(crate) fn run(&mut self, ctx: &Context) {
        if self.run.take().is_some() {
            self.message = Some(("the run is stopped; nothing of it is half written".into(), false));
            return;
        }
        let (text, folder) = (self.document.text().to_string(), self.document.folder());
        let graph = self.document.pipeline().graph(&self.registry, folder).and_then(|mut graph| {
            // Pictures carry the text with its comments.
            graph.stated = Pipeline::stated(text, &self.registry)?;
            Ok(graph)
        });
        match graph.and_then(|graph| Run::start(graph, ctx)) {
            Ok(run) => {
                self.run = Some(run);
                self.message = Some(("running; Ctrl+R stops it".into(), false));
            }
            Err(error) => self.complain(&error),
        }
    }

    /// A file as it is named from the document's folder.
    fn named_here(&self, file: &str) -> String {
        relative_to(Path::new(file), &self.document.folder()).display().to_string()
    }

    /// Takes over what a run came to.
    pub(crate) fn take_run(&mut self) {
        let Some(run) = &self.run else { return };
        let outcome = match run.outcome.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(outcome) => outcome,
            Err(TryRecvError::Disconnected) => Err(Error::run("the run ended by a mistake of its own")),
        };
        self.run = None;
        match outcome {
            Ok(report) => {
                let files = match report.files.is_empty() {
                    true => "no files".into(),
                    false => {
                        report.files.iter().map(|file| self.named_here(file)).collect::<Vec<_>>().join(", ")
                    }
                };
                let text = format!("written in {}: {files}", milliseconds(report.seconds));
                self.message = Some((text, false));
            }
            Err(error) => self.complain(&error),
        }
    }
}
