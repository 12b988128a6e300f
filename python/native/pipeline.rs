//! A pipeline: its text changed, checked, drawn, saved.

use crate::error::{exception, guarded};
use crate::filter;
use crate::follow::followed;
use crate::grid::Grid;
use crate::memory::{Lent, array};
use crate::study::{Asked, study};
use crate::until;
use crate::value::{object, settings, table};
use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use voltet_core::graph::{Datum, Demand, NodeEntry, Value};
use voltet_core::picture::Picture;
use voltet_core::pipeline::Pipeline as Nodes;
use voltet_core::{Error, Result};
use voltet_document::{Document, Edit, Fault, Part, Path as Place};
use voltet_embed::{Scene, Session};
use voltet_nodes::provenance::{Provenance, Source, whole_report};

/// A pipeline and what its runs left.
#[pyclass(frozen, module = "voltet._native")]
pub struct Pipeline {
    held: Mutex<Held>,
}

struct Held {
    stated: Stated,
    runs: Session,
    /// The filters that the session knows.
    epoch: u64,
}

/// What is stated, and where it came from.
struct Stated {
    document: Document,
    /// The picture that carries it, in place of a file, and what it says of itself.
    picture: Option<(PathBuf, Provenance)>,
}

impl Scene for Stated {
    fn pipeline(&self) -> &Nodes {
        self.document.pipeline()
    }

    fn folder(&self) -> PathBuf {
        match &self.picture {
            Some((path, _)) => path.parent().unwrap_or(Path::new("")).to_path_buf(),
            None => self.document.folder(),
        }
    }

    fn path(&self) -> PathBuf {
        let file = self.document.path().map(Path::to_path_buf);
        let picture = self.picture.as_ref().map(|picture| picture.0.clone());
        picture.or(file).unwrap_or("a new pipeline".into())
    }

    fn locate(&self, error: Error) -> Error {
        match &self.picture {
            Some((path, _)) => voltet_core::pipeline::locate(error, self.document.text(), path),
            None => self.document.locate(error),
        }
    }
}

impl Held {
    /// Knows the filters that are registered now.
    fn refresh(&mut self) -> Result<()> {
        let epoch = filter::epoch();
        if epoch != self.epoch {
            self.runs.know(filter::registry()?)?;
            self.epoch = epoch;
        }
        Ok(())
    }

    /// Refuses a text that is no pipeline.
    fn sound(&mut self) -> Result<()> {
        self.refresh()?;
        let faults = self.stated.document.faults(self.runs.registry());
        faults.into_iter().find(|fault| fault.node.is_none()).map_or(Ok(()), |fault| Err(fault.error))
    }

    /// Carries out edits; what they leave wrong in the parameters of these nodes undoes them.
    fn edit(&mut self, nodes: &[&str], label: String, edits: &[Edit]) -> Result<()> {
        self.refresh()?;
        let before = self.faults(nodes);
        let document = &mut self.stated.document;
        document.edit_all(label, edits, None).map_err(|error| document.locate(error))?;
        let is_new = |fault: &Fault| !before.iter().any(|known| known.error.what == fault.error.what);
        match self.faults(nodes).into_iter().find(is_new) {
            None => Ok(()),
            Some(fault) => {
                self.stated.document.undo()?;
                Err(fault.error)
            }
        }
    }

    /// What is wrong with nodes, but for their wires, which may lead to nodes that are to come.
    fn faults(&self, nodes: &[&str]) -> Vec<Fault> {
        if nodes.is_empty() {
            return Vec::new();
        }
        let mut faults = self.stated.document.faults(self.runs.registry());
        let wires = |fault: &Fault| {
            matches!(fault.part, Part::Input(_)) || fault.error.what.contains("is not connected")
        };
        faults
            .retain(|fault| fault.node.as_deref().is_some_and(|name| nodes.contains(&name)) && !wires(fault));
        faults
    }

    fn node(&self, name: &str) -> Result<&NodeEntry> {
        let nodes = &self.stated.pipeline().nodes;
        nodes.iter().find(|node| node.name == name).ok_or_else(|| {
            let error = Error::usage(format!("there is no node '{name}'"));
            error.accepted(voltet_core::graph::suggest(name, nodes.iter().map(|node| node.name.as_str())))
        })
    }

    /// The program's own view of the pipeline: what `voltet run` would refuse to write over is refused.
    fn as_run(&mut self) -> Result<voltet::Document> {
        self.sound()?;
        let mut graph = self.runs.whole(&self.stated)?;
        let text = self.stated.document.text().to_string();
        if let Ok(stated) = Nodes::stated(text.clone(), self.runs.registry()) {
            graph.stated = stated;
        }
        let pipeline = self.stated.pipeline().clone();
        let carried = self.stated.picture.as_ref().map(|picture| picture.1.clone());
        let document = voltet::Document { path: self.stated.path(), text, pipeline, graph, carried };
        document.refuse_collisions()?;
        Ok(document)
    }

    fn report(&self) -> String {
        let text = self.stated.document.text().to_string();
        whole_report(self.runs.report(&self.stated, text).into_iter().collect()).to_string()
    }
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
                Err(exception(py, &error.accepted("one call at a time; a Pipeline for each thread")))
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
        work: impl FnOnce(&mut Held, &dyn voltet_core::graph::Observer) -> Result<T> + Send,
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
        let empty = path.is_none() && text.is_none();
        let held = guarded(py, || {
            let (document, picture) = match (path, text) {
                (Some(path), None) => {
                    let source = Source::read(&path)?;
                    match source.carried {
                        Some(carried) => (Document::from_text(source.text, None), Some((path, carried))),
                        None => (Document::open(&path)?, None),
                    }
                }
                (path, Some(text)) => (Document::from_text(text, path), None),
                (None, None) => (Document::new(), None),
            };
            let epoch = filter::epoch();
            let runs = Session::new(filter::registry()?)?;
            let mut held = Held { stated: Stated { document, picture }, runs, epoch };
            // Nodes are to come.
            if !empty {
                held.sound()?;
            }
            Ok(held)
        });
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

    /// Saves the text; what it reads is found from the new file, too. `readers`: nodes that a program gives grids to, each with the
    /// file that holds its grid and the scalar: they read it from there.
    fn save(
        &self,
        py: Python<'_>,
        path: Option<PathBuf>,
        readers: Vec<(String, String, String)>,
    ) -> PyResult<PathBuf> {
        self.with(py, |held| {
            held.sound()?;
            let own = held.stated.document.path().map(Path::to_path_buf);
            let nowhere = || Error::usage("the pipeline has no file yet").accepted("a path to save it to");
            let to = path.or(own).ok_or_else(nowhere)?;
            if let Some((picture, _)) = held.stated.picture.take() {
                // From now on it is a file's, which was in the picture's folder.
                let text = held.stated.document.text().to_string();
                held.stated.document = Document::from_text(text, Some(picture));
            }
            let mut edits = Vec::new();
            for (name, file, scalar) in readers {
                let stated = &held.node(&name)?.settings;
                let gone = stated.iter().filter(|field| field.name != "scalar");
                edits.extend(
                    gone.map(|field| Edit::Unset { node: name.clone(), path: Place::from([&*field.name]) }),
                );
                for (key, value) in [("type", "reader".to_string()), ("path", file), ("scalar", scalar)] {
                    edits.push(Edit::set(&name, [key], Datum::Text(value)));
                }
            }
            let folder = to.parent().unwrap_or(Path::new(""));
            edits.extend(held.stated.document.following_to(held.runs.registry(), folder));
            if !edits.is_empty() {
                let document = &mut held.stated.document;
                document
                    .edit_all("save elsewhere".into(), &edits, None)
                    .map_err(|error| document.locate(error))?;
            }
            held.stated.document.save_as(&to)?;
            Ok(to)
        })
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

    /// Draws the picture of a node, and writes nothing: the array and the report.
    fn render<'py>(
        &self,
        py: Python<'py>,
        node: Option<&str>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, String)> {
        let (drawn, report) = self.long(py, progress.as_ref(), |held, observer| {
            held.sound()?;
            let Held { runs, stated, .. } = held;
            let drawing = runs.drawing(stated, node)?;
            let drawn = runs.draw(stated, &drawing, observer)?;
            Ok((drawn, held.report()))
        })?;
        Ok((picture(py, &drawn)?, report))
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
        picture(py, &drawn)
    }

    /// Runs all of it, as `voltet run` does: pictures by node, and the report.
    fn run<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, String)> {
        let (pictures, report) = self.long(py, progress.as_ref(), |held, observer| {
            let document = held.as_run()?;
            document.refuse_missing_data()?;
            let Held { runs, stated, .. } = held;
            let pictures: Vec<(String, Arc<Picture>)> =
                runs.run(stated, &document.graph, observer)?.pictures.clone();
            Ok((pictures, held.report()))
        })?;
        let images = PyDict::new(py);
        for (name, drawn) in pictures {
            images.set_item(name, picture(py, &drawn)?)?;
        }
        Ok((images, report))
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
        let grid = &*found.grid;
        let place = |point: usize| match &grid.file_cells {
            Some(cells) => cells.grid_point(point),
            None => Some(point),
        };
        let count = grid.file_cells.as_ref().map_or(grid.points.len(), |cells| cells.points.len());
        let numbers = |values: &[f64]| -> Vec<f64> {
            (0..count).map(|point| place(point).map_or(f64::NAN, |p| values[p])).collect()
        };
        let arrays = PyDict::new(py);
        arrays.set_item("scalar", array(py, "f8", &numbers(&found.scalar), &[count])?)?;
        if let Some(g) = found.gradient_magnitude.as_ref().filter(|_| magnitude) {
            arrays.set_item("gradient_magnitude", array(py, "f8", &numbers(g), &[count])?)?;
        }
        if let Some(vectors) = found.gradient.as_ref().filter(|_| gradient) {
            let all: Vec<DVec3> =
                (0..count).map(|point| place(point).map_or(DVec3::NAN, |p| vectors[p])).collect();
            arrays.set_item("gradient", array(py, "f8", &all, &[count, 3])?)?;
        }
        arrays.set_item("scalar_name", &grid.scalar_name)?;
        Ok(arrays)
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
        Ok((text, picture(py, &reference)?))
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
