//! Contexts of a node's functions in the two passes of a run.

use super::demand::Demand;
use super::observer::NodeProgress;
use super::origins::{Origins, ResolvedPipeline};
use super::parts::{GridPart, SweptParts};
use super::ranks::{self, Ranks};
use super::value::{CellValues, PortType, Revision, StagePayload, TransferFunctionSpec, Value, Wiring};
use std::any::{Any, TypeId};
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
use voltet_core::picture_parts::PictureParts;
use voltet_core::progress::Progress;
use voltet_core::surface::Surface;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// One value for each output, in the order of the declaration.
pub type Outputs = Vec<Value>;

/// Context of a node in the demand pass.
pub struct DemandContext<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    /// Demand on the node's outputs.
    pub asked: &'a Demand,
    /// Diagnostics of the node's planning.
    pub notes: &'a mut Diagnostics,
    pub(crate) wiring: Wiring<'a>,
    /// Value of each edge, or its stand-in, where known.
    pub(crate) early: Vec<Option<Value>>,
    /// True for each edge whose value is known and no stand-in.
    pub(crate) is_known: Vec<bool>,
    /// Type of the output that feeds each edge.
    pub(crate) fed: Vec<PortType>,
    /// Demand on each edge.
    pub(crate) asks: Vec<Option<Demand>>,
}

impl DemandContext<'_> {
    /// True in an exhaustive session: the node plans all work, needed or not.
    pub fn exhaustive(&self) -> bool {
        self.notes.exhaustive()
    }

    /// The transfer function at an input, or its stand-in where it is made from data; `None` where nothing
    /// is known of it.
    pub fn look(&self, port: &str) -> Option<Arc<TransferFunctionSpec>> {
        let place = self.wiring.edges(port).ok()?.next()?;
        match &self.early[place] {
            Some(Value::TransferFunction(look)) => Some(look.clone()),
            _ => None,
        }
    }

    /// The transfer function at an input where it is known before any data are.
    pub fn known_look(&self, port: &str) -> Option<Arc<TransferFunctionSpec>> {
        let place = self.wiring.edges(port).ok()?.next()?;
        self.look(port).filter(|_| self.is_known[place])
    }

    /// The type of the output that feeds an input, the first of several; `None` where nothing does.
    pub fn fed_by(&self, port: &str) -> Result<Option<PortType>> {
        Ok(self.wiring.edges(port)?.next().map(|edge| self.fed[edge]))
    }

    /// The gradient filter that a parameter names.
    pub fn method(&self) -> Result<&Method> {
        self.wiring.method()
    }

    /// Adds a demand on an input.
    pub fn ask(&mut self, port: &str, demand: &Demand) -> Result<()> {
        for edge in self.wiring.edges(port)? {
            demand.add_to(&mut self.asks[edge]);
        }
        Ok(())
    }

    /// Passes the demand on this node on to every input, and requests the scalar.
    pub fn pass_on(&mut self) -> Result<()> {
        let demand = Demand { without_scalar: false, ..self.asked.clone() };
        self.asks.iter_mut().for_each(|ask| demand.add_to(ask));
        Ok(())
    }
}

/// A node before the run.
pub struct Preparation<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    pub(crate) folder: &'a Path,
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
    /// Demand on its outputs.
    pub demand: &'a Demand,
    /// Diagnostics of its planning.
    pub notes: &'a mut Diagnostics,
    pub(crate) folder: &'a Path,
}

impl PlanContext<'_> {
    /// A path within a parameter, resolved against the pipeline file's folder.
    pub fn resolve(&self, path: &str) -> PathBuf {
        self.folder.join(path)
    }
}

/// A value that a session keeps for its nodes.
pub(crate) type RetainedValue = Arc<dyn Any + Send + Sync>;

/// The revision of what is made from no output, and stays as long as the session. Outputs count from 1.
pub(crate) const FOR_THE_SESSION: Revision = Revision(0);

/// Services of a session to a node that it runs. Those with the name of a function of [`RunContext`] are for that.
pub(crate) trait RunServices {
    /// Origins of the values at the node's inputs.
    fn origins(&self) -> Origins;
    /// The value kept under a key, made if there is none.
    fn get_or_make(&self, key: (Revision, TypeId), make: Make) -> Result<RetainedValue>;
    fn step_count(&self, edge: usize) -> Result<usize>;
    fn each_step(
        &self,
        edge: usize,
        demand: &Demand,
        steps: Option<&[usize]>,
        of_step: &mut dyn FnMut(usize, Value) -> Result<()>,
    ) -> Result<()>;
    fn keep_over_steps(
        &self,
        edge: usize,
        demand: &Demand,
        value_type: TypeId,
        make: Make,
    ) -> Result<RetainedValue>;
    /// The part of the grid that the node runs for.
    fn part(&self) -> Option<&GridPart>;
    /// Has the nodes that read parts prepare for it, the first time that it is called.
    fn begin_parts(&self) -> Result<()>;
    /// The numbers of the parts, in the order in which they are best taken.
    fn parts(&self) -> Vec<usize>;
    /// Notes that all parts were gone through.
    fn end_parts(&self);
    fn swept_parts(&self, edge: usize) -> Option<SweptParts>;
    /// Runs what feeds the node for a part, and hands the services and the values at its inputs to `of_part`. Nothing where the part
    /// has no cells.
    fn with_part(&self, part: usize, of_part: &mut PartCallback) -> Result<()>;
    fn keep_for_parts(&self, value_type: TypeId, make: Make) -> Result<RetainedValue>;
    fn set_diagonal(&self, diagonal: f64);
    /// The processes of the run.
    fn ranks(&self) -> &dyn Ranks;
}

/// Work on a part, with its services and the values at the node's inputs.
pub(crate) type PartCallback<'a> = dyn FnMut(&dyn RunServices, Vec<(Value, Revision)>) -> Result<()> + 'a;

/// Work that makes a value to be kept.
pub(crate) type Make<'a> = Box<dyn FnOnce() -> Result<RetainedValue> + 'a>;

fn boxed<'a, T: Send + Sync + 'static>(make: impl FnOnce() -> Result<T> + 'a) -> Make<'a> {
    Box::new(|| Ok(Arc::new(make()?)))
}

fn typed<T: Send + Sync + 'static>(kept: RetainedValue) -> Result<Arc<T>> {
    kept.downcast().map_err(|_| Error::run("a kept value is of another type"))
}

/// Value of a kind that an input carries; an error where it is of another kind.
macro_rules! of_kind {
    ($context:ident, $port:ident, $value:expr, $kind:ident) => {
        match $value {
            Value::$kind(value) => Ok(value.clone()),
            _ => Err($context.miswired($port, PortType::$kind)),
        }
    };
}

/// Context of one run of a node.
pub struct RunContext<'a> {
    /// The node's parameters.
    pub parameters: &'a Parameters,
    /// Demand on its outputs.
    pub demand: &'a Demand,
    /// Diagnostics of its work.
    pub notes: Diagnostics,
    pub(crate) wiring: Wiring<'a>,
    pub(crate) inputs: Vec<(Value, Revision)>,
    pub(crate) folder: &'a Path,
    pub(crate) stated: &'a ResolvedPipeline,
    pub(crate) progress: NodeProgress<'a>,
    pub(crate) services: &'a dyn RunServices,
    /// True once the node read its origins or the pipeline: then it runs again where the graph is another.
    pub(crate) reads_pipeline: Cell<bool>,
    pub(crate) allows_preview: bool,
    pub(crate) is_preview: Cell<bool>,
}

impl RunContext<'_> {
    /// Origins of the values at the inputs.
    pub fn origins(&self) -> Origins {
        self.reads_pipeline.set(true);
        self.services.origins()
    }

    /// The text that states the graph, and the folder that its paths are relative to.
    pub fn stated(&self) -> (&ResolvedPipeline, &Path) {
        self.reads_pipeline.set(true);
        (self.stated, self.folder)
    }

    /// True in an exhaustive session: the node does all work, needed or not; its outputs mean the same.
    pub fn exhaustive(&self) -> bool {
        self.notes.exhaustive()
    }

    /// True if the outputs may be of a preview: others of the same graph with other parameters follow at once, and rounding may
    /// depend on what was made before ([`Session::run_preview`](crate::Session::run_preview)).
    pub fn allows_preview(&self) -> bool {
        self.allows_preview
    }

    /// Marks the outputs as those of a preview: no later run reuses them, nor outputs made from them.
    pub fn mark_preview(&self) {
        self.is_preview.set(true);
    }

    /// Receiver of progress; it reports whether the run should stop.
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

    /// Does a part of the work and records its time (seconds) under the stage's name.
    pub fn stage<T>(&mut self, name: &str, work: impl FnOnce(&dyn Progress) -> Result<T>) -> Result<T> {
        let start = Instant::now();
        let outcome = work(&self.progress);
        self.notes.stages.push((name.to_string(), start.elapsed().as_secs_f64()));
        outcome
    }

    /// The gradient filter that a parameter names.
    pub fn method(&self) -> Result<&Method> {
        self.wiring.method()
    }

    /// The revision of what an input carries: the key for values to [`RunContext::keep`].
    pub fn revision(&self, port: &str) -> Result<Revision> {
        Ok(self.input(port)?.1)
    }

    /// A value made from the content with this revision, made again only when it is no longer kept.
    pub fn keep<T: Send + Sync + 'static>(
        &self,
        revision: Revision,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        if self.exhaustive() {
            return Ok(Arc::new(make()?));
        }
        self.get_or_make(revision, make)
    }

    /// A value made from no input (an open device), kept as long as the session.
    pub fn keep_for_session<T: Send + Sync + 'static>(
        &self,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        self.get_or_make(FOR_THE_SESSION, make)
    }

    fn get_or_make<T: Send + Sync + 'static>(
        &self,
        revision: Revision,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        typed(self.services.get_or_make((revision, TypeId::of::<T>()), boxed(make))?)
    }

    /// The number of steps of the time series that feeds an input; 1 where none does.
    pub fn step_count(&self, port: &str) -> Result<usize> {
        self.services.step_count(self.edge(port)?)
    }

    /// Gives the value of an input at each step of the time series that feeds it to `of_step`, one after the other. The nodes
    /// upstream run for each step, for this demand alone, and no output of theirs is kept. `steps`: their numbers; `None`: all.
    ///
    /// Errors: those of the nodes, with the step; series of different lengths.
    pub fn each_step(
        &self,
        port: &str,
        demand: &Demand,
        steps: Option<&[usize]>,
        of_step: &mut dyn FnMut(usize, Value) -> Result<()>,
    ) -> Result<()> {
        self.services.each_step(self.edge(port)?, demand, steps, of_step)
    }

    /// A value made over all steps of the time series that feeds an input; kept as long as the session, by its origins.
    pub fn keep_over_steps<T: Send + Sync + 'static>(
        &self,
        port: &str,
        demand: &Demand,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        if self.exhaustive() {
            return Ok(Arc::new(make()?));
        }
        typed(self.services.keep_over_steps(self.edge(port)?, demand, TypeId::of::<T>(), boxed(make))?)
    }

    /// The part of a grid that the node runs for; `None` where it runs for the whole.
    pub fn part(&self) -> Option<&GridPart> {
        self.services.part()
    }

    /// True if an input is of a grid in parts: [`RunContext::each_part`] gives their values.
    pub fn is_in_parts(&self) -> bool {
        self.inputs.iter().any(|(value, _)| matches!(value, Value::InParts(_)))
    }

    /// Number of parts of this process.
    pub fn part_count(&self) -> usize {
        self.services.parts().len()
    }

    /// Runs what feeds the node for each part of the grid, one after the other, and hands `of_part` the context with the values of the
    /// part at its inputs. Counts and warnings of all parts are put together.
    ///
    /// # Errors
    /// - those of the nodes and of `of_part`; no part has cells to draw.
    pub fn each_part(&mut self, of_part: &mut dyn FnMut(&mut RunContext) -> Result<()>) -> Result<()> {
        self.services.begin_parts()?;
        let order = self.services.parts();
        let (mut notes, mut is_empty) = (Diagnostics::new(self.exhaustive()), true);
        for (place, &part) in order.iter().enumerate() {
            self.progress.check_cancelled()?;
            self.progress
                .report(&format!("part {} of {}", place + 1, order.len()), place as f64 / order.len() as f64);
            self.services.with_part(part, &mut |services, inputs| {
                is_empty = false;
                let mut own = RunContext {
                    parameters: self.parameters,
                    demand: self.demand,
                    notes: Diagnostics::new(self.exhaustive()),
                    wiring: self.wiring,
                    inputs,
                    folder: self.folder,
                    stated: self.stated,
                    progress: NodeProgress { ..self.progress },
                    services,
                    reads_pipeline: Cell::new(false),
                    allows_preview: false,
                    is_preview: Cell::new(false),
                };
                of_part(&mut own)?;
                notes.add_part(own.notes);
                Ok(())
            })?;
        }
        self.notes.add_part(notes);
        self.services.end_parts();
        let others = self.gather(&[f64::from(u8::from(!is_empty))])?;
        if others.iter().flatten().all(|has_cells| *has_cells == 0.0) {
            return Err(Error::run("there is nothing to draw")
                .got("no part in which a cell is left")
                .expected("at least one three-dimensional cell that no threshold leaves out"));
        }
        Ok(())
    }

    /// Findings about the parts of this process at an input; `None` until all parts were gone through, on every process alike.
    ///
    /// # Errors
    /// - nothing is wired to the input.
    pub fn swept_parts(&self, port: &str) -> Result<Option<SweptParts>> {
        Ok(self.services.swept_parts(self.edge(port)?))
    }

    /// The processes that run the graph together, each with its own parts of the grid.
    pub fn ranks(&self) -> &dyn Ranks {
        self.services.ranks()
    }

    /// The numbers that each process gives, in order. All of them call it, each with as many numbers as it likes.
    ///
    /// # Errors
    /// - another process ended.
    pub fn gather(&self, own: &[f64]) -> Result<Vec<Vec<f64>>> {
        let ranks = self.ranks();
        let all = ranks.exchange(vec![ranks::to_bytes(own); ranks.count()])?;
        all.iter().map(|bytes| ranks::from_bytes(bytes)).collect()
    }

    /// Says what the diagonal of a grid in parts is, by which a transfer function without a unit distance is drawn: pictures carry it.
    pub fn set_diagonal(&self, diagonal: f64) {
        self.services.set_diagonal(diagonal);
    }

    /// A value that serves the node for all parts of a grid in this run.
    pub fn keep_for_parts<T: Send + Sync + 'static>(
        &self,
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        typed(self.services.keep_for_parts(TypeId::of::<T>(), boxed(make))?)
    }

    fn edge(&self, port: &str) -> Result<usize> {
        let mut edges = self.wiring.edges(port)?;
        match (edges.next(), edges.next()) {
            (Some(edge), None) => Ok(edge),
            (None, _) => Err(Error::run(format!("the node looks at its input '{port}', which is not wired"))),
            (Some(_), Some(_)) => {
                Err(Error::usage(format!("several outputs feed the input '{port}'")).expected("one output"))
            }
        }
    }

    /// The grid at an input.
    pub fn grid(&self, port: &str) -> Result<Arc<Grid>> {
        of_kind!(self, port, self.value(port)?, Grid)
    }

    /// The volume at an input. A grid counts as one without gradient.
    pub fn volume(&self, port: &str) -> Result<Arc<Volume>> {
        self.value(port)?.volume().unwrap_or_else(|| Err(self.miswired(port, PortType::Volume)))
    }

    /// The transfer function at an input, as the pipeline states it.
    pub fn look(&self, port: &str) -> Result<Arc<TransferFunctionSpec>> {
        of_kind!(self, port, self.value(port)?, TransferFunction)
    }

    /// True if something feeds an input.
    pub fn is_wired(&self, port: &str) -> Result<bool> {
        Ok(self.wiring.edges(port)?.next().is_some())
    }

    /// The transfer functions at an optional input.
    pub fn looks(&self, port: &str) -> Result<Vec<Arc<TransferFunctionSpec>>> {
        let look = |edge: usize| of_kind!(self, port, &self.inputs[edge].0, TransferFunction);
        self.wiring.edges(port)?.map(look).collect()
    }

    /// The camera at an input.
    pub fn camera(&self, port: &str) -> Result<Arc<Camera>> {
        of_kind!(self, port, self.value(port)?, Camera)
    }

    /// The cells at an input, as the engine of type `T` prepared them.
    pub fn cells<T: Any + Send + Sync>(&self, port: &str) -> Result<Arc<T>> {
        self.prepared(port, of_kind!(self, port, self.value(port)?, Cells)?)
    }

    /// The projection at an input, as the engine of type `T` prepared it.
    pub fn projection<T: Any + Send + Sync>(&self, port: &str) -> Result<Arc<T>> {
        self.prepared(port, of_kind!(self, port, self.value(port)?, Projection)?)
    }

    fn prepared<T: Any + Send + Sync>(&self, port: &str, value: StagePayload) -> Result<Arc<T>> {
        value.downcast().map_err(|_| {
            Error::usage("the stages of a picture belong to different engines")
                .got(format!("port \"{port}\" of {}", self.wiring.node))
                .expected("cull, sort, project and composite nodes of one engine")
        })
    }

    /// The picture at an input.
    pub fn image(&self, port: &str) -> Result<Arc<Picture>> {
        self.value(port)?.picture().cloned().ok_or_else(|| self.miswired(port, PortType::Image))
    }

    /// The picture at an input with what belongs to it.
    pub fn picture_parts(&self, port: &str) -> Result<PictureParts> {
        match self.value(port)? {
            Value::PictureParts(parts) => Ok(PictureParts::clone(parts)),
            _ => Ok(self.image(port)?.into()),
        }
    }

    /// The cells at an optional input, as the engine of type `T` prepared them; `None` where it is not wired.
    pub fn optional_cells<T: Any + Send + Sync>(&self, port: &str) -> Result<Option<Arc<T>>> {
        self.is_wired(port)?.then(|| self.cells(port)).transpose()
    }

    /// The numbers of tetrahedra at an optional input.
    pub fn cell_values(&self, port: &str) -> Result<Vec<Arc<CellValues>>> {
        let values = |edge: usize| of_kind!(self, port, &self.inputs[edge].0, CellValues);
        self.wiring.edges(port)?.map(values).collect()
    }

    /// The surfaces at an optional input.
    pub fn surfaces(&self, port: &str) -> Result<Vec<Arc<Surface>>> {
        let surface = |edge: usize| of_kind!(self, port, &self.inputs[edge].0, Surface);
        self.wiring.edges(port)?.map(surface).collect()
    }

    /// The figures at an input, JSON text.
    pub fn report(&self, port: &str) -> Result<Arc<str>> {
        of_kind!(self, port, self.value(port)?, Report)
    }

    fn value(&self, port: &str) -> Result<&Value> {
        match &self.input(port)?.0 {
            Value::InParts(_) => {
                let what = "the node needs the whole grid at once, which is read in parts (--memory)";
                Err(Error::usage(what).got(format!("its input '{port}'")).expected("a larger --memory"))
            }
            value => Ok(value),
        }
    }

    fn input(&self, port: &str) -> Result<&(Value, Revision)> {
        Ok(&self.inputs[self.edge(port)?])
    }

    fn miswired(&self, port: &str, wanted: PortType) -> Error {
        let found = self.value(port).map_or("nothing", |value| value.port_type().name());
        Error::usage(format!("the node asks its input '{port}' for another type than it declares"))
            .got(found)
            .expected(wanted.name())
    }
}
