//! What a node's functions are given: its side of the two passes.

use super::builder::{Graph, GraphNode};
use super::cache::{FOR_THE_SESSION, FileStamp, Store};
use super::declaration::PortType;
use super::demand::{Demand, Done};
use super::origins::{Origins, origins, upstream};
use super::session::Observer;
use super::stated::ResolvedPipeline;
use super::value::{CellValues, Revision, StagePayload, TransferFunctionSpec, Value};
use std::any::Any;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use voltet_core::camera::Camera;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::field::Method;
use voltet_core::grid::Grid;
use voltet_core::parameters::Parameters;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// One value for each output, in the order of the declaration.
pub type Outputs = Vec<Value>;

/// The demand pass as one node sees it.
pub struct DemandContext<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    /// What is asked of the node's outputs.
    pub asked: &'a Demand,
    /// What the node says about it.
    pub notes: &'a mut Diagnostics,
    pub(super) node: &'a GraphNode,
    /// For each edge its value, or what stands for it, where known.
    pub(super) early: Vec<Option<Value>>,
    /// For each edge whether that value is known, and does not only stand for one.
    pub(super) is_known: Vec<bool>,
    /// For each edge the type of the output that feeds it.
    pub(super) fed: Vec<PortType>,
    /// For each edge what is asked of it.
    pub(super) asks: Vec<Demand>,
}

impl DemandContext<'_> {
    /// True in an exhaustive session: the node plans all work, needed or not.
    pub fn exhaustive(&self) -> bool {
        self.notes.exhaustive()
    }

    /// The transfer function at an input, or what stands for it where it is made from data; `None` where nothing
    /// is known of it.
    pub fn look(&self, port: &str) -> Option<Arc<TransferFunctionSpec>> {
        let place = self.node.edges(port).ok()?.next()?;
        match &self.early[place] {
            Some(Value::TransferFunction(look)) => Some(look.clone()),
            _ => None,
        }
    }

    /// The transfer function at an input where it is known before any data are.
    pub fn known_look(&self, port: &str) -> Option<Arc<TransferFunctionSpec>> {
        let place = self.node.edges(port).ok()?.next()?;
        self.look(port).filter(|_| self.is_known[place])
    }

    /// The type of the output that feeds an input, the first of several; `None` where nothing does.
    pub fn fed_by(&self, port: &str) -> Result<Option<PortType>> {
        Ok(self.node.edges(port)?.next().map(|edge| self.fed[edge]))
    }

    /// The gradient filter that a parameter names.
    pub fn method(&self) -> Result<&Method> {
        self.node.method()
    }

    /// Asks for something at an input.
    pub fn ask(&mut self, port: &str, demand: &Demand) -> Result<()> {
        for edge in self.node.edges(port)? {
            self.asks[edge].join(demand);
        }
        Ok(())
    }

    /// Asks every input for what is asked of this node.
    pub fn pass_on(&mut self) -> Result<()> {
        self.asks.iter_mut().for_each(|ask| ask.join(self.asked));
        Ok(())
    }
}

/// A node before the run.
pub struct Preparation<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    pub(super) folder: &'a Path,
}

impl Preparation<'_> {
    /// The path that a parameter gives, resolved against the pipeline file's folder; "-" as an output is the standard output.
    pub fn path(&self, name: &str) -> Result<PathBuf> {
        self.parameters.path(name, self.folder)
    }
}

/// Context of a node between the demand pass and the run: it records the work that it will skip.
pub struct PlanContext<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    /// What is asked of its outputs.
    pub demand: &'a Demand,
    /// What it says about it.
    pub notes: &'a mut Diagnostics,
    pub(super) folder: &'a Path,
}

impl PlanContext<'_> {
    /// A path within a parameter, resolved against the pipeline file's folder.
    pub fn resolve(&self, path: &str) -> PathBuf {
        self.folder.join(path)
    }
}

/// One run of a node.
pub struct RunContext<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    /// What is asked of its outputs.
    pub demand: &'a Demand,
    /// What it says about its work.
    pub notes: Diagnostics,
    pub(super) node: &'a GraphNode,
    pub(super) inputs: Vec<(Value, Revision)>,
    pub(super) graph: &'a Graph,
    pub(super) file_stamp: FileStamp,
    pub(super) folder: &'a Path,
    pub(super) store: &'a Store,
    pub(super) progress: NodeProgress<'a>,
    /// The node's place in the graph, and what ran before.
    pub(super) place: usize,
    pub(super) done: &'a [Option<Done>],
    /// Whether the node asked for what led to it: then it runs again where the graph is another.
    pub(super) is_told: Cell<bool>,
    pub(super) may_pass: bool,
    pub(super) is_passing: Cell<bool>,
}

impl RunContext<'_> {
    /// What the values at the inputs were made from.
    pub fn origins(&self) -> Origins {
        self.is_told.set(true);
        origins(self.graph, &upstream(self.graph, self.place), self.done, self.file_stamp)
    }

    /// The text that states the graph, and the folder that its paths are relative to.
    pub fn stated(&self) -> (&ResolvedPipeline, &Path) {
        self.is_told.set(true);
        (&self.graph.stated, self.folder)
    }

    /// True in an exhaustive session: the node does all work, needed or not; its outputs mean the same.
    pub fn exhaustive(&self) -> bool {
        self.notes.exhaustive()
    }

    /// Whether the outputs may be passing ones: others of the same graph with other parameters follow at once, and rounding may
    /// depend on what was made before ([`Session::run_passing`](super::Session::run_passing)).
    pub fn allows_preview(&self) -> bool {
        self.may_pass
    }

    /// Says that the outputs are passing ones: no later run takes them, nor what is made from them.
    pub fn mark_preview(&self) {
        self.is_passing.set(true);
    }

    /// Where progress goes, and whether to stop.
    pub fn progress(&self) -> &dyn Progress {
        &self.progress
    }

    /// The path that a parameter gives, resolved against the pipeline file's folder; "-" as an output is the standard output.
    pub fn path(&self, name: &str) -> Result<PathBuf> {
        self.parameters.path(name, self.folder)
    }

    /// A path within a parameter, resolved against the pipeline file's folder.
    pub fn resolve(&self, path: &str) -> PathBuf {
        self.folder.join(path)
    }

    /// Does a part of the work and keeps its seconds under the stage's name.
    pub fn stage<T>(&mut self, name: &str, work: impl FnOnce(&dyn Progress) -> Result<T>) -> Result<T> {
        let start = Instant::now();
        let outcome = work(&self.progress);
        self.notes.stages.push((name.to_string(), start.elapsed().as_secs_f64()));
        outcome
    }

    /// The gradient filter that a parameter names.
    pub fn method(&self) -> Result<&Method> {
        self.node.method()
    }

    /// The revision of what an input carries: the key for things to [`Call::keep`].
    pub fn revision(&self, port: &str) -> Result<Revision> {
        Ok(self.input(port)?.1)
    }

    /// Something made from the content with this revision, made again only when it is not there any more.
    pub fn keep<T: Send + Sync + 'static>(
        &self,
        revision: Revision,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        if self.exhaustive() {
            return Ok(Arc::new(make()?));
        }
        self.store.get_or_make(revision, make)
    }

    /// Something that is made from no input (an open device) and stays as long as the session.
    pub fn keep_for_session<T: Send + Sync + 'static>(
        &self,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        self.store.get_or_make(FOR_THE_SESSION, make)
    }

    /// The grid at an input.
    pub fn grid(&self, port: &str) -> Result<Arc<Grid>> {
        match self.value(port)? {
            Value::Grid(grid) => Ok(grid.clone()),
            other => Err(self.miswired(port, PortType::Grid, other)),
        }
    }

    /// The volume at an input. A grid counts as one without gradient.
    pub fn volume(&self, port: &str) -> Result<Arc<Volume>> {
        let value = self.value(port)?;
        value.volume().unwrap_or_else(|| Err(self.miswired(port, PortType::Volume, value)))
    }

    /// The transfer function at an input, as the pipeline states it.
    pub fn look(&self, port: &str) -> Result<Arc<TransferFunctionSpec>> {
        match self.value(port)? {
            Value::TransferFunction(look) => Ok(look.clone()),
            other => Err(self.miswired(port, PortType::TransferFunction, other)),
        }
    }

    /// Whether something feeds an input.
    pub fn is_wired(&self, port: &str) -> Result<bool> {
        Ok(self.node.edges(port)?.next().is_some())
    }

    /// The transfer functions at an optional input.
    pub fn looks(&self, port: &str) -> Result<Vec<Arc<TransferFunctionSpec>>> {
        let look = |edge: usize| match &self.inputs[edge].0 {
            Value::TransferFunction(look) => Ok(look.clone()),
            other => Err(self.miswired(port, PortType::TransferFunction, other)),
        };
        self.node.edges(port)?.map(look).collect()
    }

    /// The camera at an input.
    pub fn camera(&self, port: &str) -> Result<Arc<Camera>> {
        match self.value(port)? {
            Value::Camera(camera) => Ok(camera.clone()),
            other => Err(self.miswired(port, PortType::Camera, other)),
        }
    }

    /// The cells at an input, as the engine of type `T` prepared them.
    pub fn cells<T: Any + Send + Sync>(&self, port: &str) -> Result<Arc<T>> {
        match self.value(port)? {
            Value::Cells(cells) => self.prepared(port, cells),
            other => Err(self.miswired(port, PortType::Cells, other)),
        }
    }

    /// The projection at an input, as the engine of type `T` prepared it.
    pub fn projection<T: Any + Send + Sync>(&self, port: &str) -> Result<Arc<T>> {
        match self.value(port)? {
            Value::Projection(projection) => self.prepared(port, projection),
            other => Err(self.miswired(port, PortType::Projection, other)),
        }
    }

    fn prepared<T: Any + Send + Sync>(&self, port: &str, value: &StagePayload) -> Result<Arc<T>> {
        value.clone().downcast().map_err(|_| {
            Error::usage("the stages of a picture belong to different engines")
                .got(format!("port \"{port}\" of {}", self.node.name))
                .expected("cull, sort, project and composite nodes of one engine")
        })
    }

    /// The picture at an input.
    pub fn image(&self, port: &str) -> Result<Arc<Picture>> {
        match self.value(port)? {
            Value::Image(picture) => Ok(picture.clone()),
            other => Err(self.miswired(port, PortType::Image, other)),
        }
    }

    /// The cells at an optional input, as the engine of type `T` prepared them; `None` where it is not wired.
    pub fn optional_cells<T: Any + Send + Sync>(&self, port: &str) -> Result<Option<Arc<T>>> {
        self.is_wired(port)?.then(|| self.cells(port)).transpose()
    }

    /// The numbers of tetrahedra at an optional input.
    pub fn cell_values(&self, port: &str) -> Result<Vec<Arc<CellValues>>> {
        let values = |edge: usize| match &self.inputs[edge].0 {
            Value::CellValues(values) => Ok(values.clone()),
            other => Err(self.miswired(port, PortType::CellValues, other)),
        };
        self.node.edges(port)?.map(values).collect()
    }

    /// The figures at an input, JSON text.
    pub fn report(&self, port: &str) -> Result<Arc<str>> {
        match self.value(port)? {
            Value::Report(report) => Ok(report.clone()),
            other => Err(self.miswired(port, PortType::Report, other)),
        }
    }

    fn value(&self, port: &str) -> Result<&Value> {
        Ok(&self.input(port)?.0)
    }

    /// What feeds a port, and its revision.
    fn input(&self, port: &str) -> Result<&(Value, Revision)> {
        let mut edges = self.node.edges(port)?;
        let none = || Error::run(format!("the node looks at its input '{port}', which is not wired"));
        edges.next().and_then(|edge| self.inputs.get(edge)).ok_or_else(none)
    }

    fn miswired(&self, port: &str, wanted: PortType, found: &Value) -> Error {
        Error::usage(format!("the node asks its input '{port}' for another type than it declares"))
            .got(found.port_type().name())
            .expected(wanted.name())
    }
}

/// A volume that has no gradient: what a grid is worth on its own.
pub(super) fn volume_without_gradient(grid: &Arc<Grid>) -> Result<Volume> {
    let scalar = grid.scalar.clone().ok_or_else(|| {
        Error::usage("the grid carries no scalar to draw").expected("scalar = \"…\" at the reader")
    })?;
    Ok(Volume { grid: grid.clone(), scalar, gradient: None, gradient_magnitude: None })
}

/// Hands the progress of one node on to the observer of the run.
pub(super) struct NodeProgress<'a> {
    pub(super) observer: &'a dyn Observer,
    pub(super) node: &'a str,
}

impl Progress for NodeProgress<'_> {
    fn report(&self, stage: &str, fraction: f64) {
        self.observer.progress(self.node, stage, fraction);
    }

    fn cancelled(&self) -> bool {
        self.observer.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.observer.memory_left()
    }
}
