//! A full run of the document like `voltet run`, which writes files: on a thread and with a session of its own, beside the one of the
//! shown picture.

use eframe::egui::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use voltet_core::{Error, Result};
use voltet_document::Document;
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{Observer, Registry, RunReport};
use voltet_io::memory;

/// A run in progress; cancelled when dropped.
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
    /// Starts a run of the document as it is shown.
    pub fn start(document: &Document, registry: &Registry, ctx: &Context) -> Result<Run> {
        let mut graph = document.pipeline().graph(registry, document.folder())?;
        // Pictures carry the text with its comments.
        graph.stated = Pipeline::stated(document.text().to_string(), registry)?;
        let (sender, outcome) = channel();
        let stops = Arc::new(AtomicBool::new(false));
        let (observer, ctx) = (Stopped(stops.clone()), ctx.clone());
        let work = move || {
            let report = voltet_nodes::session().run(&graph, &observer);
            // The receiver is gone if the run was cancelled.
            let _ = sender.send(report);
            ctx.request_repaint();
        };
        let spawned = std::thread::Builder::new().name("run".into()).spawn(work);
        spawned.map_err(|error| Error::run("no thread can be had").got(error))?;
        Ok(Run { outcome, stops })
    }

    /// The report, once the run has ended.
    pub fn report(&self) -> Option<Result<RunReport>> {
        match self.outcome.try_recv() {
            Err(TryRecvError::Empty) => None,
            Ok(report) => Some(report),
            Err(TryRecvError::Disconnected) => Some(Err(Error::run("the run ended by a mistake of its own"))),
        }
    }
}
