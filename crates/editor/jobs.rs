//! Work on threads of their own, whose results the window takes over in a later frame; among it the arrays of data files.

use crate::threads;
use crate::worker::{BETWEEN, short_by};
use eframe::egui::Context;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use voltet_core::error::ErrorKind;
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result};
use voltet_document::Document;
use voltet_document::links::upstream;
use voltet_graph::{
    DefaultValue, LocatedValue, Node, NodeEntry, Observer, Parameter, ParameterType, Registry,
};
use voltet_io::formats::{self, Association, FileArray};
use voltet_io::memory;
use voltet_nodes::external_formats;

/// A job in progress; cancelled when dropped.
pub(crate) struct Job<T> {
    result: Receiver<Result<T>>,
    observer: Arc<JobObserver>,
}

struct JobObserver {
    is_cancelled: AtomicBool,
    shown: Mutex<JobProgress>,
    ctx: Context,
}

/// Progress that the window was last woken to show.
#[derive(Default)]
struct JobProgress {
    node: String,
    stage: String,
    fraction: f64,
    at: Option<Instant>,
}

impl Observer for JobObserver {
    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        // One of several threads is enough to show it, and none waits for another.
        let Ok(mut shown) = self.shown.try_lock() else { return };
        let is_new = shown.node != node || shown.stage != stage;
        if !is_new && shown.at.is_some_and(|at| at.elapsed() < BETWEEN) {
            return;
        }
        let at = Some(Instant::now());
        *shown = JobProgress { node: node.into(), stage: stage.into(), fraction, at };
        drop(shown);
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
            shown: Mutex::default(),
            ctx: ctx.clone(),
        });
        let of_thread = observer.clone();
        let spawned = threads::begin(name, move || {
            let found = catch_unwind(AssertUnwindSafe(|| work(&*of_thread)));
            let mistake =
                |_| Err(Error::new(ErrorKind::Panic, "the work panicked, which is a fault of the program"));
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
        let shown = self.observer.shown.lock().unwrap_or_else(PoisonError::into_inner);
        let JobProgress { node, stage, fraction, .. } = &*shown;
        (if node.is_empty() { stage.clone() } else { format!("{node}: {stage}") }, *fraction)
    }

    /// Stops the work and waits for its end.
    pub fn end(self) {
        self.cancel();
        // Without a result the thread has ended, too.
        let _ = self.result.recv();
    }

    pub fn cancel(&self) {
        self.observer.is_cancelled.store(true, Ordering::Relaxed);
    }

    pub fn is_cancelled(&self) -> bool {
        self.observer.is_cancelled.load(Ordering::Relaxed)
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
    /// Place of its values; `None` where it is there at both.
    pub at: Option<Association>,
    /// The node that makes it; `None` of an array of a file.
    pub maker: Option<String>,
}

impl ArrayChoice {
    pub fn is_at(&self, place: Association) -> bool {
        self.at.is_none_or(|own| own == place)
    }

    /// True if it is the array of that name, or a component of it.
    pub fn is_of(&self, array: &str) -> bool {
        let rest = self.name.strip_prefix(array);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
    }
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

/// Data that a reader reads: its file, and what the pipeline states of how that is read.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct DataSource {
    path: PathBuf,
    stated: Vec<(String, String)>,
}

impl DataSource {
    /// `None` of a node that reads no file.
    pub fn of_node(entry: &NodeEntry, folder: &Path, registry: &Registry) -> Option<DataSource> {
        let path = folder.join(path_of(entry).filter(|_| reads(entry, registry))?);
        let stated = external_formats::settings_of(entry);
        let stated = stated.map(|field| (field.name.clone(), field.setting.datum.to_string()));
        Some(DataSource { path, stated: stated.collect() })
    }
}

#[derive(Debug, Clone, Default)]
pub(crate) struct FileArrays {
    pub choices: Vec<ArrayChoice>,
    /// Blocks by their names, with `/` after each group, once all of the file was read.
    pub blocks: Vec<String>,
    /// The array that the reader must name to draw the first by rank.
    pub to_be_named: Option<formats::ArrayChoice>,
    /// True once all of the file was read, or could not be.
    pub is_whole: bool,
}

/// Arrays that reach a node.
#[derive(Debug, Default)]
pub(crate) struct UpstreamArrays {
    pub of_file: Arc<FileArrays>,
    /// Results of nodes.
    results: Vec<ArrayChoice>,
}

impl UpstreamArrays {
    /// Choices of different names: a result takes the place of an array of its name and of that one's components.
    pub fn choices(&self) -> Vec<&ArrayChoice> {
        let mut all: Vec<&ArrayChoice> = self.of_file.choices.iter().collect();
        for result in &self.results {
            all.retain(|array| !array.is_of(&result.name));
            all.push(result);
        }
        all
    }
}

/// Extent to which a file is read for its arrays: their names, or their ranges, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Extent {
    Heads,
    Whole,
}

/// Arrays of each source, with how far it is read; none while it is being read.
type KnownArrays = HashMap<DataSource, (Extent, Arc<FileArrays>)>;

/// Arrays of data files.
#[derive(Default)]
pub(crate) struct Arrays(Arc<Mutex<KnownArrays>>);

impl Arrays {
    /// Number of the files that were asked for.
    #[cfg(test)]
    pub fn asked_count(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// The arrays of the file that feeds a node, and of nodes on the way; empty while they are not known.
    pub fn feeding(
        &self,
        ctx: &Context,
        document: &Document,
        registry: &Registry,
        node: &str,
    ) -> UpstreamArrays {
        let mut arrays = self.given_by(ctx, document, registry, node);
        arrays.results.retain(|result| result.maker.as_deref() != Some(node));
        arrays
    }

    /// The arrays that a node may give: those that feed it, and its own.
    pub fn given_by(
        &self,
        ctx: &Context,
        document: &Document,
        registry: &Registry,
        node: &str,
    ) -> UpstreamArrays {
        let nodes = &document.pipeline().nodes;
        let feeding = upstream(nodes, node);
        let feeding = || nodes.iter().filter(|entry| feeding.contains(&entry.name));
        let reader = feeding().find(|entry| reads(entry, registry));
        let of_file =
            reader.map_or_else(Arc::default, |of| self.of_reader(ctx, document, registry, of, Extent::Whole));
        UpstreamArrays { of_file, results: feeding().filter_map(|entry| result(entry, registry)).collect() }
    }

    /// The arrays of the file that a node reads, as far as that is asked for; empty while they are not known.
    pub fn of_reader(
        &self,
        ctx: &Context,
        document: &Document,
        registry: &Registry,
        reader: &NodeEntry,
        extent: Extent,
    ) -> Arc<FileArrays> {
        let folder = document.folder();
        let Some(source) = DataSource::of_node(reader, &folder, registry) else { return Arc::default() };
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let heads = match known.get(&source) {
            Some((begun, found)) if *begun >= extent => return found.clone(),
            found => found.map(|(_, heads)| heads.clone()),
        };
        let tell = {
            let (known, ctx, source) = (self.0.clone(), ctx.clone(), source.clone());
            move |found: FileArrays| {
                let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
                // What is read further elsewhere says more.
                if known.get(&source).is_none_or(|(begun, _)| *begun <= extent) {
                    known.insert(source.clone(), (extent, Arc::new(found)));
                }
                drop(known);
                ctx.request_repaint();
            }
        };
        let (reader, registry) = (reader.clone(), registry.clone());
        let work = move || read_arrays(&reader, &folder, &registry, extent, tell);
        let begun = match threads::begin("arrays", work) {
            Ok(_) => heads.unwrap_or_default(),
            // Without a thread there are no choices, and the name is typed.
            Err(_) => Arc::new(FileArrays { is_whole: true, ..FileArrays::default() }),
        };
        known.insert(source, (extent, begun.clone()));
        begun
    }
}

/// Names come from the headers at once; ranges take a reading of the file. A file that cannot be read has no arrays to choose from: the
/// run says what is wrong with it.
fn read_arrays(
    reader: &NodeEntry,
    folder: &Path,
    registry: &Registry,
    extent: Extent,
    tell: impl Fn(FileArrays),
) {
    let nothing = || FileArrays { is_whole: true, ..FileArrays::default() };
    let Ok((path, request)) = external_formats::request_of(reader, folder, registry) else {
        return tell(nothing());
    };
    let heads = formats::arrays(&path, &request).unwrap_or_default();
    let of_heads = || heads.iter().flat_map(|head| choices(head, None, None)).collect();
    tell(FileArrays { choices: of_heads(), ..FileArrays::default() });
    if extent == Extent::Heads {
        return;
    }
    tell(match formats::inspect(&path, &request, &NoProgress) {
        Ok(found) => FileArrays {
            choices: found
                .arrays
                .iter()
                .flat_map(|array| choices(&array.head, array.range, array.unit.as_deref()))
                .collect(),
            blocks: found.blocks.iter().map(|block| block.name.clone()).collect(),
            to_be_named: found.to_be_named(request.association),
            is_whole: true,
        },
        Err(_) => FileArrays { choices: of_heads(), ..nothing() },
    });
}

/// The parameter that names the array that a node makes: by a text, or a source by the word for its field.
pub(crate) fn new_array(node: &Node) -> Option<&Parameter> {
    node.parameters.iter().find(|parameter| match parameter.parameter_type {
        ParameterType::NewArrayName => true,
        ParameterType::Choice(_) => parameter.name == "field" && node.inputs.is_empty(),
        _ => false,
    })
}

/// Array that a node makes; `None` of other nodes.
fn result(entry: &NodeEntry, registry: &Registry) -> Option<ArrayChoice> {
    let named_by = new_array(registry.node_type(entry)?)?;
    let usual = match named_by.default {
        DefaultValue::Text(text) => Some(text),
        _ => None,
    };
    let name = entry.setting(named_by.name).and_then(LocatedValue::text).or(usual)?.to_string();
    let is_of_cells = entry.setting("association").and_then(LocatedValue::text) == Some("cell");
    let at = if is_of_cells { None } else { Some(Association::Point) };
    let maker = Some(entry.name.clone());
    Some(ArrayChoice { label: format!("{name}  (computed by {})", entry.name), name, at, maker })
}

fn choices(head: &FileArray, range: Option<[f64; 2]>, unit: Option<&str>) -> Vec<ArrayChoice> {
    let place = if head.association == Association::Cell { "cells" } else { "points" };
    let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
    let range = range.map_or(String::new(), |[low, high]| {
        let number = |x: f64| short_by(x, 1e-2 * (high - low));
        format!(", {} to {}{unit}", number(low), number(high))
    });
    let choice = |name: String, range: &str| ArrayChoice {
        label: format!("{name}  ({place}{range})"),
        name,
        at: Some(head.association),
        maker: None,
    };
    if head.component_count == 1 {
        return vec![choice(head.name.clone(), &range)];
    }
    let all = std::iter::once(choice(format!("{}:magnitude", head.name), &range));
    let parts = (0..head.component_count).map(|i| choice(format!("{}:{i}", head.name), ""));
    all.chain(parts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_job_is_waited_for() {
        let is_tidy = Arc::new(AtomicBool::new(false));
        let of_work = is_tidy.clone();
        let work = move |observer: &dyn Observer| {
            while !observer.cancelled() {
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            std::thread::sleep(std::time::Duration::from_millis(20));
            of_work.store(true, Ordering::SeqCst);
            Ok(())
        };
        Job::start("test", &Context::default(), work).unwrap().end();
        assert!(is_tidy.load(Ordering::SeqCst));
    }
}
