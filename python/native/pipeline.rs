//! A pipeline: its text changed, checked, drawn, saved.

use crate::error::{exception, guarded};
use crate::follow::{followed, followed_beside};
use crate::grid::Grid;
use crate::held::Held;
use crate::measured::{Shown, shown};
use crate::memory::{Lent, array, handed_over};
use crate::numbers::at_given_points;
use crate::report::Report;
use crate::study::{Asked, study};
use crate::until;
use crate::value::{object, settings, table};
use crate::watch::{Piece, any_changed};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_document::{Edit, Path as Place};
use voltet_embed::Scene;
use voltet_graph::{Demand, Value};
use voltet_study::pixel::pixel as trace;

/// A pipeline and what its runs left.
#[pyclass(frozen, module = "voltet._native")]
pub struct Pipeline {
    held: Mutex<Held>,
}

impl Pipeline {
    fn held(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Held>> {
        match self.held.try_lock() {
            Ok(held) => Ok(held),
            Err(TryLockError::Poisoned(poisoned)) => {
                // What a panic left half done is of no use.
                let mut held = poisoned.into_inner();
                held.runs.begin_anew();
                self.held.clear_poison();
                Ok(held)
            }
            Err(TryLockError::WouldBlock) => {
                let error =
                    Error::usage("the pipeline is in use: by another thread, or by the call that calls back");
                Err(exception(py, &error.expected("one call at a time; a Pipeline for each thread")))
            }
        }
    }

    fn with<T>(&self, py: Python<'_>, work: impl FnOnce(&mut Held) -> Result<T>) -> PyResult<T> {
        let mut held = self.held(py)?;
        guarded(py, || work(&mut held))
    }

    /// The same for work that may be long.
    fn long<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<&Py<PyAny>>,
        work: impl FnOnce(&mut Held, &dyn voltet_graph::Observer) -> Result<T> + Send,
    ) -> PyResult<T> {
        let mut held = self.held(py)?;
        let held = &mut *held;
        followed(py, progress, |observer| work(held, observer))
    }
}

/// A picture as a float32 array, height × width × 4.
fn picture<'py>(py: Python<'py>, picture: &Picture) -> PyResult<Bound<'py, PyAny>> {
    array(py, "f4", &picture.rgba, &[picture.height, picture.width, 4])
}

#[pymethods]
impl Pipeline {
    /// From a file, or a picture that carries one; from a text; or empty.
    #[new]
    #[pyo3(signature = (path, text))]
    fn new(py: Python<'_>, path: Option<PathBuf>, text: Option<String>) -> PyResult<Pipeline> {
        let held = guarded(py, || Held::open(path, text));
        Ok(Pipeline { held: Mutex::new(held?) })
    }

    /// The text.
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |held| Ok(held.stated.document.text().to_string()))
    }

    /// The file, or the picture that it came from.
    fn path(&self, py: Python<'_>) -> PyResult<Option<PathBuf>> {
        self.with(py, |held| {
            let file = held.stated.document.path().map(Path::to_path_buf);
            Ok(held.stated.picture.as_ref().map(|picture| picture.0.clone()).or(file))
        })
    }

    fn title(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.with(py, |held| Ok(held.stated.pipeline().title.clone()))
    }

    fn set_title(&self, py: Python<'_>, title: Option<String>) -> PyResult<()> {
        let edit = Edit::Title(title);
        self.with(py, |held| held.edit(&[], edit.label(), std::slice::from_ref(&edit)))
    }

    /// The names of the nodes.
    fn nodes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |held| Ok(held.stated.pipeline().nodes.iter().map(|node| node.name.clone()).collect()))
    }

    /// A node's type, parameters and wires as they are stated.
    fn node<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(String, Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let node = self.with(py, |held| held.node(name).cloned())?;
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
        self.with(py, |held| held.edit(&[&name], label, &edits))
    }

    /// Takes a node out, with its wires.
    fn remove(&self, py: Python<'_>, name: String) -> PyResult<()> {
        self.with(py, |held| {
            held.node(&name)?;
            let edit = Edit::RemoveNodes(vec![name]);
            held.edit(&[], edit.label(), std::slice::from_ref(&edit))
        })
    }

    /// Gives a node another name; wires follow.
    fn rename(&self, py: Python<'_>, node: String, to: String) -> PyResult<()> {
        let edit = Edit::Rename { node, to };
        self.with(py, |held| held.edit(&[], edit.label(), std::slice::from_ref(&edit)))
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
        self.with(py, |held| {
            let Some(first) = edits.first() else { return Ok(()) };
            values.iter().try_for_each(|(node, ..)| held.node(node).map(drop))?;
            let nodes: BTreeSet<&str> = values.iter().map(|(node, ..)| node.as_str()).collect();
            held.edit(&nodes.into_iter().collect::<Vec<_>>(), first.label(), &edits)
        })
    }

    /// Wires an input to these sources, in place of what feeds it; to none: takes its wires out.
    fn connect(&self, py: Python<'_>, node: String, port: String, sources: Vec<String>) -> PyResult<()> {
        let edits = match sources.is_empty() {
            true => vec![Edit::Disconnect { node: node.clone(), port, source: None }],
            false => wires(&node, &port, sources).collect(),
        };
        self.with(py, |held| {
            held.node(&node)?;
            held.edit(&[], edits[0].label(), &edits)
        })
    }

    /// Takes the last change back; false where there is none.
    fn undo(&self, py: Python<'_>) -> PyResult<bool> {
        self.with(py, |held| held.stated.document.undo())
    }

    /// Saves the text: see [`Held::save`].
    fn save(
        &self,
        py: Python<'_>,
        path: Option<PathBuf>,
        readers: Vec<(String, String, String)>,
    ) -> PyResult<PathBuf> {
        self.with(py, |held| held.save(path, readers))
    }

    /// Gives a grid in place of what a node reads, or takes it away: the node's name.
    fn give(&self, py: Python<'_>, node: Option<&str>, grid: Option<&Bound<'_, Grid>>) -> PyResult<String> {
        let grid = grid.map(|grid| grid.get().grid.clone());
        self.with(py, |held| {
            held.sound()?;
            let name = held.runs.grid_node(&held.stated, node)?;
            held.runs.give(&held.stated, Some(&name), grid.as_ref())?;
            Ok(name)
        })
    }

    /// Checks names, types, ranges, wires, outputs and integrators, without data: the warnings.
    fn check(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |held| {
            let document = held.as_run()?;
            let Held { runs, stated, .. } = held;
            let mut warnings = runs.plan(stated, &document.graph)?;
            warnings.extend(document.changed_data().into_iter().chain(document.changed_plugins()));
            Ok(warnings.iter().map(Error::to_string).collect())
        })
    }

    /// Width and height of a node's picture.
    fn size(&self, py: Python<'_>, node: Option<&str>) -> PyResult<[usize; 2]> {
        self.with(py, |held| {
            held.sound()?;
            held.runs.size(&held.stated, node)
        })
    }

    /// Draws the picture of a node, and writes nothing: the array and the report. While it draws, the arrays of `watched` are
    /// looked at, which the grids were made of: None where one is not as it was.
    fn render<'py>(
        &self,
        py: Python<'py>,
        node: Option<&str>,
        progress: Option<Py<PyAny>>,
        watched: Vec<Bound<'py, Grid>>,
    ) -> PyResult<Option<(Bound<'py, PyAny>, Report)>> {
        let pieces: Vec<Piece<'_>> = watched.iter().flat_map(|grid| grid.get().pieces()).collect();
        let (mut open, mut changed) = (pieces.iter(), false);
        let mut look = open.by_ref().map(|piece| {
            changed |= piece.is_changed();
            changed
        });
        let mut held = self.held(py)?;
        let held = &mut *held;
        let drawn = followed_beside(py, progress.as_ref(), &mut look, |observer| {
            held.sound()?;
            let Held { runs, stated, .. } = held;
            let drawing = runs.drawing(stated, node)?;
            let drawn = runs.hand_over(stated, &drawing, observer)?;
            Ok((drawn, held.account()))
        })?;
        if changed || py.detach(|| any_changed(open.as_slice())) {
            return Ok(None);
        }
        let (drawn, account) = drawn?;
        Ok(Some((handed_over(py, drawn)?, Report::new(account))))
    }

    /// Draws the picture of a node with rays that end at these depths (one a pixel, row 0 at the top).
    fn render_until<'py>(
        &self,
        py: Python<'py>,
        node: &str,
        ends: &Bound<'py, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let ends: Lent<f32> = Lent::of("ends", ends)?;
        // A copy: whoever lent them may write them meanwhile.
        let ends = ends.values().to_vec();
        let drawn = self.long(py, progress.as_ref(), |held, observer| {
            held.sound()?;
            let Held { runs, stated, .. } = held;
            runs.with_graph(stated, node, |graph, session| until::draw(graph, session, node, &ends, observer))
        })?;
        handed_over(py, drawn)
    }

    /// Runs all of it, as `voltet run` does: pictures by node, and the report.
    fn run<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Report)> {
        let (pictures, account) = self.long(py, progress.as_ref(), |held, observer| {
            let document = held.as_run()?;
            document.refuse_missing_data()?;
            let Held { runs, stated, .. } = held;
            let pictures: Vec<(String, Arc<Picture>)> =
                runs.run(stated, &document.graph, observer)?.pictures.clone();
            Ok((pictures, held.account()))
        })?;
        let images = PyDict::new(py);
        for (name, drawn) in pictures {
            images.set_item(name, picture(py, &drawn)?)?;
        }
        Ok((images, Report::new(account)))
    }

    /// The figures that a node gives, as JSON.
    fn figures(&self, py: Python<'_>, node: &str, progress: Option<Py<PyAny>>) -> PyResult<String> {
        self.long(py, progress.as_ref(), |held, observer| {
            held.sound()?;
            let Held { runs, stated, .. } = held;
            match runs.value(stated, (node, "report"), &Demand::default(), observer)? {
                Value::Report(text) => Ok(text.to_string()),
                _ => Err(Error::usage("the node gives no figures").at_node(node)),
            }
        })
    }

    /// What a node computed at the points of the grid as it was given: the scalar, g where asked for, and ∇s where asked for; NaN at
    /// points of no cell.
    fn volume<'py>(
        &self,
        py: Python<'py>,
        node: &str,
        magnitude: bool,
        gradient: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = self.long(py, progress.as_ref(), |held, observer| {
            held.sound()?;
            let Held { runs, stated, .. } = held;
            let asked =
                Demand { gradient_magnitude: magnitude, gradient, file_cells: true, ..Demand::default() };
            let value = runs.value(stated, (node, "volume"), &asked, observer)?;
            let none = || Error::usage("the node gives no volume").at_node(node);
            value.volume().ok_or_else(none)?
        })?;
        at_given_points(py, &found, magnitude, gradient)
    }

    /// What a pixel is made of.
    #[pyo3(signature = (x, y, node, sample, all, progress))]
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
    ) -> PyResult<Shown> {
        self.long(py, progress.as_ref(), |held, observer| {
            held.sound()?;
            let Held { runs, stated, .. } = held;
            let told = until::Told { observer, node: "pixel" };
            let found = runs.with_whole(stated, |graph, session| {
                trace(graph, node, [x, y], sample, session, (observer, &told))
            })?;
            Ok(shown(&found, all))
        })
    }

    /// Error against run time of every setting: the study as JSON, and the reference picture.
    #[pyo3(signature = (node, only, engine, adapter, frames, patience, max_error, output, progress))]
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
        let asked = Asked { node, only, engine: engine.into(), adapter, frames, patience, max_error, output };
        let (text, reference) = self.long(py, progress.as_ref(), |held, observer| {
            let document = held.as_run()?;
            let title = document.pipeline.title.clone().unwrap_or_default();
            study(&document.graph, &title, &asked, observer).map_err(|error| held.stated.locate(error))
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
