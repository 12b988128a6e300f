//! The pipelines of a simulation, and its steps: in each the meshes of the channels take the place of the files that the pipelines read.

use crate::conduit::{Loan, Node};
use crate::lockstep::{Lockstep, caught};
use crate::mesh::{self, FieldSelection};
use crate::piece;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use voltet::nodes::files::is_stream;
use voltet::nodes::in_memory_grid::HostGrid;
use voltet::series::names::{self, MarkValues, Varying};
use voltet::series::{file_names, written};
use voltet::{Pipeline, RunStatus, build_grid, run_in_background, unnamed_scalar};
use voltet_core::error::ErrorKind;
use voltet_core::grid::{CellValues, Options};
use voltet_core::{Error, Result};
use voltet_graph::ranks::Ranks;
use voltet_graph::{Demand, GRADIENT_LAYERS, Graph, GraphNode, MEAN_LAYERS, PortType};

/// Pipelines that a simulation named, and what was seen of its steps.
pub struct Simulation {
    scripts: Vec<Script>,
    step_count: usize,
    ranks: Arc<Lockstep>,
}

struct Script {
    name: String,
    /// As the file states it: names of output files have their marks.
    graph: Graph,
    pipeline: Pipeline,
    sources: Vec<GridSource>,
    /// Steps whose number is no multiple of it are left out.
    interval: usize,
    /// Rings of cells around a piece of a grid that nodes may look at.
    layers: usize,
    /// Warnings that were printed.
    warnings: BTreeSet<String>,
    /// Channel of each source that has one, in the order of the sources.
    channels: Vec<Option<String>>,
    /// The arguments and the text of the pipeline, which are the same on all processes.
    stated: String,
    /// The last file of each name with marks, and its step.
    files: BTreeMap<String, (String, Step)>,
}

/// A node that reads or makes a grid.
struct GridSource {
    node: String,
    selection: FieldSelection,
    cell_values: CellValues,
    /// True if it must find its scalar by itself.
    has_unnamed_scalar: bool,
}

#[derive(Debug, Clone, PartialEq)]
struct Step {
    number: usize,
    time: Option<f64>,
}

impl Simulation {
    /// Loads the pipelines below `catalyst/scripts`. `ranks`: the processes of the simulation, all of which call it together.
    ///
    /// # Errors
    /// - no pipeline, or one that is wrong;
    /// - two pipelines that write one file;
    /// - other pipelines on another process.
    pub fn initialize(parameters: &Node, ranks: Arc<dyn Ranks>) -> Result<Simulation> {
        let ranks = Arc::new(Lockstep::new(ranks));
        let load = || {
            let node = parameters.require("catalyst/scripts")?;
            let scripts = node.children().into_iter().map(|script| Script::load(&script, &ranks));
            let scripts = scripts.collect::<Result<Vec<_>>>()?;
            if scripts.is_empty() {
                let accepted = "catalyst/scripts/NAME = \"scene.toml\"";
                return Err(node.wrong("names no pipeline", "nothing", accepted));
            }
            refuse_conflicts(&scripts)?;
            Ok(scripts)
        };
        let lines = |scripts: &Vec<Script>| {
            let each = scripts.iter().map(|script| format!("script {}\n{}", script.name, script.stated));
            each.collect::<Vec<_>>().join("\n")
        };
        let scripts = ranks.agree_on(caught(load), lines)?;
        Ok(Simulation { scripts, step_count: 0, ranks })
    }

    /// The processes of the simulation.
    pub fn ranks(&self) -> &Lockstep {
        &self.ranks
    }

    /// Draws the pictures of a step.
    ///
    /// # Errors
    /// - a mesh or field that is wrong, with its channel and path;
    /// - another step, pipelines or channels on another process;
    /// - those of the pipelines. All are run; the first error is given, others are printed.
    pub fn execute(&mut self, parameters: &Node) -> Result<()> {
        let count = self.step_count;
        self.step_count += 1;
        let ranks = self.ranks.clone();
        let is_only = self.scripts.len() == 1;
        let begun = caught(|| self.begin(parameters, count));
        let (step, channels, due) = ranks.agree_on(begun, |(step, _, due)| {
            let channels = |script: &Script| script.channels.iter().flatten().cloned().collect::<Vec<_>>();
            let each = due.iter().map(|own| format!("{}: channels {}", own.name, channels(own).join(", ")));
            [step.to_string()].into_iter().chain(each).collect::<Vec<_>>().join("\n")
        })?;
        let loan: Loan = Arc::new(());
        let mut grids = Grids::build(&due, &channels, &loan, &ranks)?;
        let mut failure: Option<Error> = None;
        for script in due {
            let outcome = ranks.agree(caught(|| script.draw(&step, &grids)));
            script.warn(ranks.rank() == 0);
            let Err(mut error) = outcome else { continue };
            // What is half done on one process is not taken for done on another.
            if error.kind == ErrorKind::Panic || ranks.count() > 1 {
                script.pipeline.reset();
            }
            if failure.is_some() && error.kind != ErrorKind::OtherProcess {
                eprintln!("voltet: {}: {error}", script.name);
            } else if failure.is_none() {
                if !is_only && !matches!(error.kind, ErrorKind::OtherProcess | ErrorKind::Panic) {
                    error.what = format!("{}: {}", script.name, error.what);
                }
                failure = Some(error);
            }
        }
        grids.clear();
        // The simulation changes its memory now.
        let mut returned = Ok(());
        if Arc::strong_count(&loan) > 1 {
            self.scripts.iter_mut().for_each(|script| script.pipeline.reset());
            returned = Err(Error::run("an array of the simulation was still in use after the step"));
        }
        let returned = ranks.agree(returned);
        failure.map_or(returned, Err)
    }

    /// Reads a step, its channels, and finds the pipelines that are due, with their channels. `count`: number of steps before.
    fn begin<'n>(&mut self, parameters: &Node<'n>, count: usize) -> Result<BegunStep<'_, 'n>> {
        let (step, ranks) = (Step::read(parameters, count)?, self.ranks.clone());
        let channels = parameters.require("catalyst/channels")?.children();
        let chosen = self.chosen(parameters)?;
        let is_due = |script: &&mut Script| {
            step.number.is_multiple_of(script.interval)
                && chosen.as_ref().is_none_or(|names| names.contains(&script.name))
        };
        let mut due: Vec<&mut Script> = self.scripts.iter_mut().filter(is_due).collect();
        for script in &mut due {
            script.assign(&channels, &ranks)?;
        }
        Ok((step, channels, due))
    }

    /// Names of the scripts that a step is for; `None`: all.
    fn chosen(&self, parameters: &Node) -> Result<Option<Vec<String>>> {
        let Some(node) = parameters.get("catalyst/state/pipelines") else { return Ok(None) };
        let names = node.texts()?;
        match names.iter().find(|name| self.scripts.iter().all(|script| script.name != **name)) {
            Some(unknown) => {
                let known: Vec<&str> = self.scripts.iter().map(|script| script.name.as_str()).collect();
                Err(node.wrong("names no script", format!("'{unknown}'"), known.join(", ")))
            }
            None => Ok(Some(names)),
        }
    }
}

/// Refuses two pipelines that write one file.
fn refuse_conflicts(scripts: &[Script]) -> Result<()> {
    let mut writers: BTreeMap<PathBuf, &str> = BTreeMap::new();
    for script in scripts {
        for (node, named) in written(&script.graph).filter(|(_, named)| !is_stream(&named.path)) {
            let path = script.graph.folder.join(&named.path);
            let Some(other) = writers.insert(path, &script.name) else { continue };
            let error = Error::usage("two pipelines write one file");
            let found = format!("'{}' of {other} and of {}", named.path, script.name);
            let accepted =
                format!("a file of its own for each, as by the argument {}.{}=…", node.name, named.parameter);
            return Err(error.got(found).expected(accepted));
        }
    }
    Ok(())
}

/// A step, its channels, and the pipelines that are due.
type BegunStep<'s, 'n> = (Step, Vec<Node<'n>>, Vec<&'s mut Script>);

impl Step {
    /// Number and time of a step; its number is `count` where the simulation states none.
    fn read(parameters: &Node, count: usize) -> Result<Step> {
        let state = |name: &str| parameters.get(&format!("catalyst/state/{name}"));
        let number = match state("timestep").or_else(|| state("cycle")) {
            Some(node) => node.count()?,
            None => count,
        };
        let time = state("time").map(|node| node.number()).transpose()?;
        Ok(Step { number, time })
    }
}

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "step {}", self.number)?;
        self.time.map_or(Ok(()), |time| write!(f, ", time {time}"))
    }
}

impl Script {
    /// Loads a pipeline: a file's path, or `filename` with `args`.
    fn load(node: &Node, ranks: &Arc<Lockstep>) -> Result<Script> {
        let (path, arguments) = match node.get("filename") {
            Some(path) => (path.text()?, node.get("args")),
            None => (node.text()?, None),
        };
        let texts = arguments.as_ref().map(Node::texts).transpose()?.unwrap_or_default();
        let mut pipeline = Pipeline::open(&path)?.with_ranks(ranks.clone());
        let mut interval = 1;
        let list = arguments.as_ref().unwrap_or(node);
        for text in &texts {
            match text.strip_prefix("every=").map(str::parse::<usize>) {
                Some(Ok(number @ 1..)) => interval = number,
                Some(_) => return Err(list.wrong("states no interval", text, "every=N with N from 1")),
                None => pipeline.set(text).map_err(|error| error.at_item(list.path()))?,
            }
        }
        let graph = pipeline.whole_graph()?;
        let demands = pipeline.with_graph(None, |graph, session| Ok(session.plan(graph)?.demands))?;
        let mut sources = Vec::new();
        for (node, demand) in graph.nodes.iter().zip(&demands) {
            let gives_grid = matches!(node.node.outputs, [port] if port.port_type == PortType::Grid);
            if gives_grid && node.inputs.is_empty() {
                sources.push(GridSource::new(node, demand)?);
            }
        }
        if sources.is_empty() {
            let error = Error::usage("the pipeline reads no grid").in_file(&path);
            return Err(error.expected("a node of type \"reader\", in whose place the mesh of a channel is"));
        }
        let filters = graph.nodes.iter().filter(|node| node.method.is_some()).count();
        let layers = MEAN_LAYERS + filters * GRADIENT_LAYERS;
        let stated = format!("every={interval}\n{}", pipeline.text());
        let (name, warnings, files) = (node.name().into(), BTreeSet::new(), BTreeMap::new());
        let channels = vec![None; sources.len()];
        Ok(Script { name, graph, pipeline, sources, interval, layers, warnings, channels, stated, files })
    }

    /// Finds the channel of each source: that of the same name, or of one source and one channel each the other's.
    fn assign(&mut self, channels: &[Node], ranks: &Lockstep) -> Result<()> {
        let has = |name: &str| channels.iter().any(|channel| channel.name() == name);
        let named = |source: &GridSource| Some(source.node.clone()).filter(|name| has(name));
        let found: Vec<Option<String>> = match (&self.sources[..], channels) {
            ([_], [only]) => vec![Some(only.name().into())],
            (sources, _) => sources.iter().map(named).collect(),
        };
        // A channel of the steps before is missed, others may be new.
        let known = self.channels.iter().cloned();
        let found: Vec<_> = known.zip(found).map(|(known, found)| known.or(found)).collect();
        if found.iter().all(Option::is_none) {
            let list = |names: Vec<&str>| names.join(", ");
            let nodes = list(self.sources.iter().map(|source| source.node.as_str()).collect());
            let names = list(channels.iter().map(Node::name).collect());
            let error =
                Error::usage(format!("no channel has the name of a node of the pipeline '{}'", self.name));
            return Err(error.got(format!("channels {names}; nodes {nodes}")).expected("equal names"));
        }
        let fed: Vec<&str> = found.iter().flatten().map(String::as_str).collect();
        if ranks.count() > 1 && fed.len() > 1 {
            let what = format!("the pipeline '{}' takes several channels of several processes", self.name);
            return Err(Error::usage(what).got(fed.join(", ")).expected("a pipeline for each channel"));
        }
        self.channels = found;
        Ok(())
    }

    /// The sources that have a channel, each with its name.
    fn fed(&self) -> impl Iterator<Item = (&GridSource, &str)> {
        let both = self.sources.iter().zip(&self.channels);
        both.filter_map(|(source, channel)| Some((source, channel.as_deref()?)))
    }

    /// Prints warnings of the last step that are new.
    fn warn(&mut self, is_shown: bool) {
        for warning in self.pipeline.warnings().unwrap_or_default() {
            if is_shown && self.warnings.insert(warning.clone()) {
                eprintln!("voltet: {}: {warning}", self.name);
            }
        }
    }

    /// Notes the files that a step writes. Errors: one that the step before has written.
    fn note_files(&mut self, step: &Step, marks: &MarkValues) -> Result<()> {
        for (node, named) in written(&self.graph).filter(|(_, named)| !is_stream(&named.path)) {
            let path = names::path_of(&named.path, marks, &[Varying::Step])?;
            let known = self.files.insert(named.path, (path.clone(), step.clone()));
            if let Some((_, other)) = known.filter(|(known, other)| *known == path && other != step) {
                let error = Error::usage("two steps would be written to one file");
                let error = error.got(format!("'{path}' of {other} and of {step}")).at_node(&node.name);
                return Err(error.expected("{step} in its name, or {time} with more decimals"));
            }
        }
        Ok(())
    }

    /// Draws the pictures of a step, and lets go of the grids.
    fn draw(&mut self, step: &Step, grids: &Grids) -> Result<()> {
        let marks =
            MarkValues { frame: step.number, step: step.number, time: step.time, ..MarkValues::default() };
        let given: Vec<(String, GivenGrid)> = self
            .fed()
            .map(|(source, channel)| Ok((source.node.clone(), grids.get(source, channel)?.clone())))
            .collect::<Result<_>>()?;
        let changes = file_names(&self.graph, &marks, &[Varying::Step])?;
        self.note_files(step, &marks)?;
        self.pipeline.apply(&changes)?;
        let pipeline = &mut self.pipeline;
        let outcome = caught(|| {
            for (node, grid) in &given {
                match grid {
                    GivenGrid::Whole(grid) => pipeline.set_grid(Some(node), Some(grid)).map(drop)?,
                    GivenGrid::Piece(piece) => pipeline.set_piece(node, piece.clone())?,
                }
            }
            let stops: Option<fn(&RunStatus) -> bool> = None;
            run_in_background(|observer| pipeline.run(observer).map(drop), stops, &mut std::iter::empty())
        });
        for (node, _) in &given {
            pipeline.set_grid(Some(node), None)?;
        }
        outcome
    }
}

impl GridSource {
    fn new(node: &GraphNode, demand: &Demand) -> Result<GridSource> {
        let p = &node.parameters;
        for name in ["blocks", "displacement", "between_steps"] {
            if node.node.parameter(name).is_some() && p.is_set(name) {
                let error = p.error(name, "the parameter is for files, not for the mesh of a simulation");
                return Err(node.locate(error.expected("none")));
            }
        }
        let cell_values = match p.optional("cell_values").and_then(|value| value.text()) {
            Some("constant") => CellValues::Constant,
            _ => CellValues::Average,
        };
        let scalar = p.optional("scalar").and_then(|name| name.text()).map(str::to_string);
        let has_unnamed_scalar = scalar.is_none() && !demand.without_scalar;
        let scalar = scalar.filter(|_| !demand.without_scalar);
        let selection = FieldSelection {
            named: demand.arrays.named.iter().cloned().chain(scalar).collect(),
            optional: demand.arrays.optional.clone(),
            cells: demand.cell_arrays.named.clone(),
            is_all: demand.arrays.and_all_others || has_unnamed_scalar,
        };
        Ok(GridSource { node: node.name.clone(), selection, cell_values, has_unnamed_scalar })
    }
}

/// Grid of a channel on this process.
#[derive(Clone)]
enum GivenGrid {
    Whole(Arc<HostGrid>),
    /// A piece of one that several processes hold; `None`: this one holds nothing of it.
    Piece(Option<Arc<HostGrid>>),
}

/// Grids of a step, by their channels; those with values constant in cells by themselves.
struct Grids(BTreeMap<(String, bool), GivenGrid>);

impl Grids {
    /// Builds each grid once, with the fields that all pipelines use. All processes call it together.
    fn build(scripts: &[&mut Script], channels: &[Node], loan: &Loan, ranks: &Lockstep) -> Result<Grids> {
        let mut selections: BTreeMap<(String, bool), FieldSelection> = BTreeMap::new();
        for (source, channel) in scripts.iter().flat_map(|script| script.fed()) {
            selections.entry(key(source, channel)).or_default().join(&source.selection);
        }
        let layers = scripts.iter().map(|script| script.layers).max().unwrap_or(0);
        let mut grids = Grids(BTreeMap::new());
        for ((name, is_constant), selection) in selections {
            let cell_values = if is_constant { CellValues::Constant } else { CellValues::Average };
            let options = Options { cell_values, ..Options::default() };
            let find = || {
                let channel = channels.iter().find(|channel| channel.name() == name).ok_or_else(|| {
                    let names: Vec<&str> = channels.iter().map(Node::name).collect();
                    let error = Error::usage(format!("catalyst/channels/{name} is missing in this step"));
                    error.got(names.join(", ")).expected("the channels of the steps before")
                })?;
                Ok((channel, mesh::read(channel, &selection, loan)?))
            };
            let (channel, mut mesh) = ranks.agree(caught(find))?;
            let build = || {
                piece::number_blocks(&mut mesh, ranks)?;
                match ranks.count() {
                    1 if mesh.pieces.is_empty() => {
                        let nothing = channel.require("data")?.wrong("holds no domain", "nothing", "a mesh");
                        Err(mesh.refusal.unwrap_or(nothing))
                    }
                    // Joined by the fields of all pipelines, as several processes do it.
                    1 => {
                        let whole = voltet_core::grid::join(mesh.pieces)?;
                        Ok(GivenGrid::Whole(Arc::new(build_grid(vec![whole], None, &options)?)))
                    }
                    _ => Ok(GivenGrid::Piece(piece::build(mesh, layers, &options, ranks)?.map(Arc::new))),
                }
            };
            let grid = ranks.agree(caught(build)).map_err(|error| error.at_item(channel.path()))?;
            grids.0.insert((name, is_constant), grid);
        }
        Ok(grids)
    }

    fn get(&self, source: &GridSource, channel: &str) -> Result<&GivenGrid> {
        let found = self.0.get(&key(source, channel));
        let given = found.ok_or_else(|| Error::run(format!("the channel '{channel}' has no grid")))?;
        let grid = match given {
            GivenGrid::Whole(grid) => Some(grid),
            GivenGrid::Piece(grid) => grid.as_ref(),
        };
        match grid.map(|grid| grid.whole()) {
            Some(grid) if source.has_unnamed_scalar && grid.scalar.is_none() => {
                Err(unnamed_scalar(grid).at_node(&source.node))
            }
            _ => Ok(given),
        }
    }

    /// Lets go of the grids.
    fn clear(&mut self) {
        self.0.clear();
    }
}

fn key(source: &GridSource, channel: &str) -> (String, bool) {
    (channel.into(), source.cell_values == CellValues::Constant)
}
