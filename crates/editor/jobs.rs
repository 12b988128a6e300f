//! Work on threads of their own, whose results the window takes over in a later frame.

use eframe::egui::Context;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::{Error, Result};
use voltet_graph::Observer;
use voltet_io::memory;

/// A job in progress; cancelled when dropped.
pub(crate) struct Job<T> {
    result: Receiver<Result<T>>,
    observer: Arc<JobObserver>,
}

/// Observer of a job: its progress, and the wish to end it.
struct JobObserver {
    is_cancelled: AtomicBool,
    progress: Mutex<(String, f64)>,
    ctx: Context,
}

impl Observer for JobObserver {
    fn progress(&self, _node: &str, stage: &str, fraction: f64) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = (stage.to_string(), fraction);
        self.ctx.request_repaint();
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

impl<T: Send + 'static> Job<T> {
    /// Begins the work. Errors: no thread can be had.
    pub fn start(
        name: &str,
        ctx: &Context,
        work: impl FnOnce(&dyn Observer) -> Result<T> + Send + 'static,
    ) -> Result<Job<T>> {
        let (sender, result) = channel();
        let observer = Arc::new(JobObserver {
            is_cancelled: AtomicBool::new(false),
            progress: Mutex::default(),
            ctx: ctx.clone(),
        });
        let of_thread = observer.clone();
        let spawned = std::thread::Builder::new().name(name.into()).spawn(move || {
            // The window is shown anew also where the work ends by a panic, which drops the sender.
            let _at_end = RepaintAtEnd(of_thread.ctx.clone());
            // The receiver is gone if the job was cancelled.
            let _ = sender.send(work(&*of_thread));
        });
        spawned.map_err(|error| Error::run("no thread can be had").got(error))?;
        Ok(Job { result, observer })
    }

    /// The result, once there is one; it is given once.
    pub fn result(&self) -> Option<Result<T>> {
        match self.result.try_recv() {
            Err(TryRecvError::Empty) => None,
            Ok(result) => Some(result),
            Err(TryRecvError::Disconnected) => {
                Some(Err(Error::run("the work ended by a mistake of its own")))
            }
        }
    }
}

impl<T> Job<T> {
    /// The stage that the job is at, and how much of it is done (0 … 1).
    pub fn progress(&self) -> (String, f64) {
        self.observer.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub fn cancel(&self) {
        self.observer.is_cancelled.store(true, Ordering::Relaxed);
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.cancel();
    }
}

struct RepaintAtEnd(Context);

impl Drop for RepaintAtEnd {
    fn drop(&mut self) {
        self.0.request_repaint();
    }
}
