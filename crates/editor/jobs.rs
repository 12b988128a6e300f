//! Work on threads of their own, whose results the window takes over in a later frame; among it the arrays of data files.

use crate::worker::short_by;
use eframe::egui::Context;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result};
use voltet_document::Document;
use voltet_document::links::upstream;
use voltet_graph::{LocatedValue, NodeEntry, Observer, Registry};
use voltet_io::formats::{self, Association, Request};
use voltet_io::memory;
use voltet_nodes::external_formats;

/// A job in progress; cancelled when dropped.
pub(crate) struct Job<T> {
    result: Receiver<Result<T>>,
    observer: Arc<JobObserver>,
}

struct JobObserver {
    is_cancelled: AtomicBool,
    progress: Mutex<(String, f64)>,
    ctx: Context,
}

impl Observer for JobObserver {
    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        let stage = if node.is_empty() { stage.to_string() } else { format!("{node}: {stage}") };
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = (stage, fraction);
        self.ctx.request_repaint();
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

impl<T> Job<T> {
    /// Begins the work. Errors: no thread can be started.
    pub fn start(
        name: &str,
        ctx: &Context,
        work: impl FnOnce(&dyn Observer) -> Result<T> + Send + 'static,
    ) -> Result<Job<T>>
    where
        T: Send + 'static,
    {
        let (sender, result) = channel();
        let observer = Arc::new(JobObserver {
            is_cancelled: AtomicBool::new(false),
            progress: Mutex::default(),
            ctx: ctx.clone(),
        });
        let of_thread = observer.clone();
        let spawned = std::thread::Builder::new().name(name.into()).spawn(move || {
            let found = catch_unwind(AssertUnwindSafe(|| work(&*of_thread)));
            let mistake = |_| Err(Error::run("the work panicked, which is a fault of the program"));
            // The receiver is gone if the job was cancelled.
            let _ = sender.send(found.unwrap_or_else(mistake));
            of_thread.ctx.request_repaint();
        });
        spawned.map_err(|error| Error::run("no thread can be started").got(error))?;
        Ok(Job { result, observer })
    }

    /// The result, once there is one; it is given once.
    pub fn result(&self) -> Option<Result<T>> {
        self.result.try_recv().ok()
    }

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

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ArrayChoice {
    /// As a file names it.
    pub name: String,
    /// With what it is and its range.
    pub label: String,
}

pub(crate) fn reads(entry: &NodeEntry, registry: &Registry) -> bool {
    let name = entry.node_type.text();
    let of_others = |name| registry.find(name).is_ok_and(|node| node.reader.is_some());
    name == Some("reader") || name.is_some_and(of_others)
}

/// The file of a node that reads one, as it is named there.
pub(crate) fn path_of(entry: &NodeEntry) -> Option<&str> {
    entry.setting("path").and_then(LocatedValue::text)
}

/// Arrays of a data file.
#[derive(Debug, Default)]
pub(crate) struct FileArrays {
    pub choices: Vec<ArrayChoice>,
    /// Blocks by their names, with `/` after each group, once all of the file was read.
    pub blocks: Vec<String>,
    /// Once all of the file was read: the array to draw that a reader must name, since there are several and the file marks none.
    pub first: Option<Option<formats::ArrayChoice>>,
}

/// Arrays of data files; none while a file is being read.
#[derive(Default)]
pub(crate) struct Arrays(Arc<Mutex<HashMap<PathBuf, Arc<FileArrays>>>>);

impl Arrays {
    /// The arrays of the file that feeds a node; empty while they are not known.
    pub fn feeding(
        &self,
        ctx: &Context,
        document: &Document,
        registry: &Registry,
        node: &str,
    ) -> Arc<FileArrays> {
        let nodes = &document.pipeline().nodes;
        let feeding = upstream(nodes, node);
        let reader =
            nodes.iter().filter(|entry| feeding.contains(&entry.name)).find(|entry| reads(entry, registry));
        let Some(path) = reader.and_then(path_of) else { return Arc::default() };
        let path = document.folder().join(path);
        let registry = registry.clone();
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let begin = || {
            let (known, ctx, path) = (self.0.clone(), ctx.clone(), path.clone());
            // Without a thread there are no choices, and the name is typed.
            let _ = std::thread::Builder::new().name("arrays".into()).spawn(move || {
                let tell = |found: FileArrays| {
                    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
                    known.insert(path.clone(), Arc::new(found));
                    drop(known);
                    ctx.request_repaint();
                };
                // Names come from the headers at once; ranges take a reading of the file.
                // A file that cannot be read has no arrays to choose from; the run says what is wrong with it.
                let Ok(request) = external_formats::request(Request::default(), &path, &registry) else {
                    return;
                };
                let heads = formats::arrays(&path, &request).unwrap_or_default();
                let of_heads = heads.iter().flat_map(|head| choices(head, None)).collect();
                tell(FileArrays { choices: of_heads, ..FileArrays::default() });
                if let Ok(found) = formats::inspect(&path, &request, &NoProgress) {
                    let arrays = found.arrays.iter();
                    let choices = arrays.flat_map(|array| choices(&array.head, array.range)).collect();
                    let is_open = found.active_scalars.is_none() && found.quantities().nth(1).is_some();
                    let first = found.first_quantity().filter(|_| is_open);
                    let blocks = found.blocks.iter().map(|block| block.name.clone()).collect();
                    tell(FileArrays { choices, blocks, first: Some(first) });
                }
            });
            Arc::default()
        };
        known.entry(path.clone()).or_insert_with(begin).clone()
    }
}

fn choices(head: &voltet_core::reading::FileArray, range: Option<[f64; 2]>) -> Vec<ArrayChoice> {
    let place = if head.association == Association::Cell { "cells" } else { "points" };
    let range = range.map_or(String::new(), |[low, high]| {
        let number = |x: f64| short_by(x, 1e-2 * (high - low));
        format!(", {} to {}", number(low), number(high))
    });
    let choice = |name: String, range: &str| ArrayChoice { label: format!("{name}  ({place}{range})"), name };
    if head.component_count == 1 {
        return vec![choice(head.name.clone(), &range)];
    }
    let all = std::iter::once(choice(format!("{}:magnitude", head.name), &range));
    let parts = (0..head.component_count).map(|i| choice(format!("{}:{i}", head.name), ""));
    all.chain(parts).collect()
}
