//! A pipeline: its text changed, checked, drawn, saved; and the report of a run, which is made when it is read.

use crate::background::{run_long, run_with_side_work};
use crate::error::{exception, guarded, is_forked, refuse_freeing};
use crate::frames::{FrameEntry, FrameWords, entries, frames};
use crate::grid::Grid;
use crate::measurements::{Rendition, study_options};
use crate::memory::{Lent, Piece, any_changed, array, handed_over, in_caller_order, is_changed};
use crate::picture_axes::picture_axes;
use crate::state::State;
use crate::value::{object, settings, table};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use std::collections::BTreeSet;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use voltet::{RunRecord, render_to_depth};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_document::{Edit, Path as Place};
use voltet_graph::{Demand, NodeProgress, Value};
use voltet_io::provenance::whole_report;
use voltet_study::pixel::{self, pixel as trace};
use voltet_study::work_precision::{Subject, cache_folder, json, measure};

/// A pipeline, and the results that its runs left.
#[pyclass(frozen, module = "voltet._native")]
pub struct Pipeline {
    state: ManuallyDrop<Mutex<State>>,
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        if !is_forked() {
            // SAFETY: nobody uses it after this, and it is dropped once.
            unsafe { ManuallyDrop::drop(&mut self.state) }
        }
    }
}

impl Pipeline {
    fn state(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, State>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            Err(TryLockError::Poisoned(poisoned)) => {
                // Half-done work is dropped.
                let mut state = poisoned.into_inner();
                state.pipeline.reset();
                self.state.clear_poison();
                Ok(state)
            }
            Err(TryLockError::WouldBlock) => {
                let error =
                    Error::usage("the pipeline is in use: by another thread, or by the call that calls back");
                Err(exception(py, &error.expected("one call at a time; a Pipeline for each thread")))
            }
        }
    }

    fn with<T>(&self, py: Python<'_>, work: impl FnOnce(&mut State) -> Result<T>) -> PyResult<T> {
        let mut state = self.state(py)?;
        guarded(py, || work(&mut state))
    }

    /// Like [`Pipeline::with`], for long work of a text that is a pipeline. Its result comes with the warnings of the run, which
    /// Python shows.
    fn long<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<&Py<PyAny>>,
        work: impl FnOnce(&mut State, &dyn voltet_graph::Observer) -> Result<(T, Vec<String>)> + Send,
    ) -> PyResult<T> {
        let mut guard = self.state(py)?;
        let state = &mut *guard;
        let (done, warnings) = run_long(py, progress, |observer| {
            state.check_text()?;
            work(state, observer)
        })?;
        drop(guard);
        show(py, warnings)?;
        Ok(done)
    }
}

/// Shows warnings as Python does, which may make exceptions of them.
fn show(py: Python<'_>, warnings: Vec<String>) -> PyResult<()> {
    static SHOW: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    if !warnings.is_empty() {
        SHOW.import(py, "voltet._errors", "warn")?.call1((warnings,))?;
    }
    Ok(())
}

/// Warnings of the last run.
fn warnings(state: &State) -> Vec<String> {
    state.pipeline.warnings().unwrap_or_default().to_vec()
}

/// A picture as a float32 array, height × width × 4.
fn picture<'py>(py: Python<'py>, picture: &Picture) -> PyResult<Bound<'py, PyAny>> {
    array(py, "f4", &picture.rgba, &[picture.height, picture.width, 4])
}

#[pymethods]
impl Pipeline {
    /// From a file, or a picture that carries one; from a text, of a file or picture (`is_picture`) where a path is given; or empty.
    #[new]
    #[pyo3(signature = (path, text, is_picture = false))]
    fn new(
        py: Python<'_>,
        path: Option<PathBuf>,
        text: Option<String>,
        is_picture: bool,
    ) -> PyResult<Pipeline> {
        let state = guarded(py, || State::open(path, text, is_picture));
        Ok(Pipeline { state: ManuallyDrop::new(Mutex::new(state?)) })
    }

    /// The text.
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |state| Ok(state.document.text().to_string()))
    }

    /// True if it came from a picture that carries it.
    fn is_picture(&self, py: Python<'_>) -> PyResult<bool> {
        self.with(py, |state| Ok(state.picture.is_some()))
    }

    /// The file, or the picture that it came from.
    fn path(&self, py: Python<'_>) -> PyResult<Option<PathBuf>> {
        self.with(py, |state| Ok(state.path().map(Path::to_path_buf)))
    }

    fn title(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.with(py, |state| Ok(state.document.pipeline().title.clone()))
    }

    fn set_title(&self, py: Python<'_>, title: Option<String>) -> PyResult<()> {
        let edit = Edit::Title(title);
        self.with(py, |state| state.edit(&[], edit.label(), std::slice::from_ref(&edit)))
    }

    /// The names of the nodes.
    fn nodes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |state| {
            Ok(state.document.pipeline().nodes.iter().map(|node| node.name.clone()).collect())
        })
    }

    /// A node's type, parameters and wires as they are stated.
    fn node<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(String, Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let node = self.with(py, |state| state.node(name).cloned())?;
        let inputs = PyDict::new(py);
        for link in &node.inputs {
            inputs.set_item(&link.port, object(py, &link.source.datum)?)?;
        }
        let node_type = node.node_type.text().unwrap_or_default().to_string();
        Ok((node_type, table(py, &node.settings)?, inputs))
    }

    /// Adds a node with parameters and wires.
    fn add(
        &self,
        py: Python<'_>,
        name: String,
        node_type: String,
        parameters: &Bound<'_, PyDict>,
        inputs: Vec<(String, Vec<String>)>,
    ) -> PyResult<()> {
        let settings = settings(parameters)?;
        let add = Edit::AddNode { name: name.clone(), node_type, settings, at: None };
        let label = add.label();
        let wires = inputs.into_iter().flat_map(|(port, sources)| wires(&name, &port, sources));
        let edits: Vec<Edit> = std::iter::once(add).chain(wires).collect();
        self.with(py, |state| state.edit(&[&name], label, &edits))
    }

    /// Takes a node out, with its wires.
    fn remove(&self, py: Python<'_>, name: String) -> PyResult<()> {
        self.with(py, |state| {
            state.node(&name)?;
            let edit = Edit::RemoveNodes(vec![name]);
            state.edit(&[], edit.label(), std::slice::from_ref(&edit))
        })
    }

    /// Gives a node another name; wires follow.
    fn rename(&self, py: Python<'_>, node: String, to: String) -> PyResult<()> {
        let edit = Edit::Rename { node, to };
        self.with(py, |state| state.edit(&[], edit.label(), std::slice::from_ref(&edit)))
    }

    /// Sets parameters or parts of them, such as `widgets.0.centre`, in one step; None takes them out.
    fn set(&self, py: Python<'_>, values: Vec<(String, String, Bound<'_, PyAny>)>) -> PyResult<()> {
        let mut edits = Vec::new();
        for (node, path, value) in &values {
            let place = Place::from(path.as_str());
            edits.push(match value.is_none() {
                true => Edit::Unset { node: node.clone(), path: place },
                false => Edit::Set { node: node.clone(), path: place, value: crate::value::datum(value)? },
            });
        }
        self.with(py, |state| {
            let Some(first) = edits.first() else { return Ok(()) };
            values.iter().try_for_each(|(node, ..)| state.node(node).map(drop))?;
            let nodes: BTreeSet<&str> = values.iter().map(|(node, ..)| node.as_str()).collect();
            state.edit(&nodes.into_iter().collect::<Vec<_>>(), first.label(), &edits)
        })
    }

    /// Wires an input to these sources, in place of what feeds it; to none: takes its wires out.
    fn connect(&self, py: Python<'_>, node: String, port: String, sources: Vec<String>) -> PyResult<()> {
        let edits = match sources.is_empty() {
            true => vec![Edit::Disconnect { node: node.clone(), port, source: None }],
            false => wires(&node, &port, sources).collect(),
        };
        self.with(py, |state| {
            state.node(&node)?;
            state.edit(&[], edits[0].label(), &edits)
        })
    }

    /// Takes the last change back; false where there is none.
    fn undo(&self, py: Python<'_>) -> PyResult<bool> {
        self.with(py, |state| Ok(state.document.undo()))
    }

    /// Saves the text: see [`State::save`].
    fn save(
        &self,
        py: Python<'_>,
        path: Option<PathBuf>,
        readers: Vec<(String, String, String)>,
    ) -> PyResult<PathBuf> {
        self.with(py, |state| state.save(path, readers))
    }

    /// Gives a grid in place of what a node reads, or takes it away: the node's name.
    fn give(&self, py: Python<'_>, node: Option<&str>, grid: Option<&Bound<'_, Grid>>) -> PyResult<String> {
        let grid = grid.map(|grid| grid.get().grid.clone());
        self.with(py, |state| {
            // The former grid is freed, on a device, too.
            refuse_freeing()?;
            state.check_text()?;
            state.pipeline.set_grid(node, grid.as_ref())
        })
    }

    /// Checks names, types, ranges, wires, outputs and integrators, without data: the warnings.
    fn check(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |state| {
            let document = state.document()?;
            let mut warnings = state.pipeline.plan(&document.graph)?;
            warnings.extend(document.changed_data().into_iter().chain(document.changed_plugins()));
            Ok(warnings.iter().map(Error::to_string).collect())
        })
    }

    /// Width and height of a node's picture.
    fn size(&self, py: Python<'_>, node: Option<&str>) -> PyResult<[usize; 2]> {
        self.with(py, |state| {
            state.check_text()?;
            Ok(state.pipeline.render_plan(node)?.size)
        })
    }

    /// Renders the picture of a node, and writes nothing: the array and the report. Meanwhile the arrays of `watched`, which the
    /// grids were built from, are compared with what they were: None where one has changed.
    fn render<'py>(
        &self,
        py: Python<'py>,
        node: Option<&str>,
        progress: Option<Py<PyAny>>,
        watched: Vec<Bound<'py, Grid>>,
    ) -> PyResult<Option<(Bound<'py, PyAny>, Report)>> {
        let pieces: Vec<Piece<'_>> = watched.iter().flat_map(|grid| grid.get().pieces()).collect();
        let (mut open, mut changed) = (pieces.iter(), false);
        let mut side_work = open.by_ref().map(|piece| {
            changed |= is_changed(piece);
            changed
        });
        let mut guard = self.state(py)?;
        let state = &mut *guard;
        let drawn = run_with_side_work(py, progress.as_ref(), &mut side_work, |observer| {
            state.check_text()?;
            let plan = state.pipeline.render_plan(node)?;
            let drawn = state.pipeline.render_owned(&plan, observer)?;
            Ok((drawn, state.pipeline.record(), warnings(state)))
        })?;
        drop(guard);
        if changed || py.detach(|| any_changed(open.as_slice())) {
            return Ok(None);
        }
        let (drawn, record, warnings) = drawn?;
        show(py, warnings)?;
        Ok(Some((handed_over(py, drawn)?, Report(record))))
    }

    /// Renders the picture of a node with rays that end at these depths (one a pixel, row 0 at the top).
    fn render_until<'py>(
        &self,
        py: Python<'py>,
        node: &str,
        ends: &Bound<'py, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let ends: Lent<f32> = Lent::borrow("ends", ends)?;
        // A copy: the owner may write them meanwhile.
        let ends = ends.values().to_vec();
        let drawn = self.long(py, progress.as_ref(), |state, observer| {
            state.pipeline.with_graph(Some(node), |graph, session| {
                let Subject { scene, warnings, .. } =
                    Subject::gather(graph, Some(node), false, session, observer)?;
                Ok((render_to_depth(&scene, &ends, &NodeProgress { observer, node })?, warnings))
            })
        })?;
        handed_over(py, drawn)
    }

    /// The plane of the picture's camera and the scale of its colours (JSON).
    fn picture_axes(&self, py: Python<'_>, node: Option<&str>) -> PyResult<String> {
        self.long(py, None, |state, observer| {
            let picture = state.pipeline.picture_node(node)?;
            state.pipeline.with_graph(Some(&picture), |graph, session| {
                let subject = Subject::gather(graph, None, false, session, observer)?;
                Ok((picture_axes(&subject.scene)?.to_string(), subject.warnings))
            })
        })
    }

    /// The frames of a series: label, step, time and changes of the pipeline.
    fn frames<'py>(&self, py: Python<'py>, words: FrameWords<'py>) -> PyResult<Vec<FrameEntry<'py>>> {
        let selection = words.selection(py)?;
        let found = self.with(py, |state| frames(state, &selection))?;
        entries(py, found)
    }

    /// Runs all of it, as `voltet run` does: pictures by node, and the report.
    fn run<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Report)> {
        let (pictures, record) = self.long(py, progress.as_ref(), |state, observer| {
            let document = state.document()?;
            document.refuse_missing_data()?;
            let pictures: Vec<(String, Arc<Picture>)> =
                state.pipeline.run_graph(&document.graph, observer)?.pictures.clone();
            Ok(((pictures, state.pipeline.record()), warnings(state)))
        })?;
        let images = PyDict::new(py);
        for (name, drawn) in pictures {
            images.set_item(name, picture(py, &drawn)?)?;
        }
        Ok((images, Report(record)))
    }

    /// Figures of a node (JSON).
    fn figures(&self, py: Python<'_>, node: &str, progress: Option<Py<PyAny>>) -> PyResult<String> {
        self.long(py, progress.as_ref(), |state, observer| {
            match state.pipeline.value((node, "report"), &Demand::default(), observer)? {
                Value::Report(text) => Ok((text.to_string(), warnings(state))),
                _ => Err(Error::usage("the node gives no figures").at_node(node)),
            }
        })
    }

    /// Values at the points of the grid in the caller's order: the scalar, and g and ∇s on request; NaN at points of no cell.
    fn volume<'py>(
        &self,
        py: Python<'py>,
        node: &str,
        magnitude: bool,
        gradient: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = self.long(py, progress.as_ref(), |state, observer| {
            let asked =
                Demand { gradient_magnitude: magnitude, gradient, file_cells: true, ..Demand::default() };
            let value = state.pipeline.value((node, "volume"), &asked, observer)?;
            let none = || Error::usage("the node gives no volume").at_node(node);
            Ok((value.volume().ok_or_else(none)??, warnings(state)))
        })?;
        in_caller_order(py, &found, magnitude, gradient)
    }

    /// Cells along the ray of a pixel.
    #[allow(clippy::too_many_arguments)]
    fn pixel(
        &self,
        py: Python<'_>,
        x: i64,
        y: i64,
        node: Option<&str>,
        sample: u32,
        all: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Rendition> {
        self.long(py, progress.as_ref(), |state, observer| {
            let progress = NodeProgress { observer, node: "pixel" };
            let found = state.pipeline.with_graph(None, |graph, session| {
                trace(graph, node, [x, y], sample, session, (observer, &progress))
            })?;
            let shown =
                (pixel::json(&found).to_string(), pixel::text(&found, all), pixel::plot(&found).svg());
            Ok((shown, found.warnings))
        })
    }

    /// Error against run time of every setting: the study as JSON, and the reference picture.
    #[allow(clippy::too_many_arguments)]
    fn study<'py>(
        &self,
        py: Python<'py>,
        node: Option<String>,
        only: Vec<String>,
        engine: &str,
        adapter: Option<String>,
        frames: usize,
        patience: f64,
        max_error: Option<f64>,
        output: Option<PathBuf>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(String, Bound<'py, PyAny>)> {
        let options = guarded(py, || study_options(only, engine, adapter, frames, patience, max_error))?;
        let (text, reference) = self.long(py, progress.as_ref(), |state, observer| {
            let document = state.document()?;
            let title = document.pipeline.title.clone().unwrap_or_default();
            let subject = (&document.graph, node.as_deref(), &*title);
            let followed: (_, &dyn Progress) = (observer, &NodeProgress { observer, node: "study" });
            let (study, _) = measure(subject, options, output.as_deref(), &cache_folder(), followed)
                .map_err(|error| state.pipeline.source.locate(error))?;
            if study.stopped() && observer.cancelled() {
                return Err(Error::cancelled());
            }
            Ok(((json(&study, &title).to_string(), study.reference.picture), study.subject.warnings))
        })?;
        Ok((text, handed_over(py, reference)?))
    }
}

/// The edits that wire an input to these sources, in place of what fed it.
fn wires(node: &str, port: &str, sources: Vec<String>) -> impl Iterator<Item = Edit> + use<> {
    let (node, port) = (node.to_string(), port.to_string());
    sources.into_iter().enumerate().map(move |(i, source)| Edit::Connect {
        node: node.clone(),
        port: port.clone(),
        source,
        beside: i > 0,
    })
}

/// Report of a run.
#[pyclass(frozen, module = "voltet._native")]
pub struct Report(Option<RunRecord>);

#[pymethods]
impl Report {
    /// The report of `voltet run --report` (JSON).
    fn json(&self) -> String {
        self.0.as_ref().map_or_else(|| whole_report(Vec::new(), None), RunRecord::to_json).to_string()
    }
}
