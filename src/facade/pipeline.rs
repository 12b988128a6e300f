//! Pipelines: a file or text that is changed, given in-memory grids, and rendered; pictures, figures and reports of its runs.

use super::camera::Camera;
use super::grid::Grid;
use super::pipeline_text::PipelineText;
use super::renderer::Image;
use crate::core::parameters::nearest_first;
use crate::document::{Change, Document};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use voltet_core::camera::Projection;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_document::links;
use voltet_graph::pipeline::{Pipeline as Nodes, locate, parameters};
use voltet_graph::ranks::{OneRank, Ranks};
use voltet_graph::{
    Demand, Graph, LocatedValue, NoObserver, Node, NodeEntry, NodeOverride, Observer, ParameterValue, Port,
    PortType, Registry, ResolvedPipeline, RunReport, Session, SourceSpan, Value, unknown_node,
};
use voltet_io::encode::Source;
use voltet_io::memory;
use voltet_io::provenance::{run_report, whole_report};
use voltet_nodes::VIEW_PARAMETERS;
use voltet_nodes::in_memory_grid::{self, HostGrid};

/// A pipeline that a program changes and renders. Values of nodes that a change does not concern are kept between renders.
pub struct Pipeline {
    /// The nodes, with the text that errors point at.
    pub source: PipelineText,
    registry: Registry,
    session: Session,
    ranks: Arc<dyn Ranks>,
    /// In-memory grids by the name of the node that they replace.
    grids: BTreeMap<String, NodeOverride>,
    last: Option<LastRun>,
}

/// A graph that renders the picture of one node.
pub struct RenderPlan {
    graph: Graph,
    name: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

/// Record of a run, from which a report is made.
pub struct RunRecord {
    path: String,
    stated: ResolvedPipeline,
    /// Without its pictures.
    run: RunReport,
    peak_memory: Option<u64>,
}

impl RunRecord {
    /// The report of the run ([`voltet_io::provenance::whole_report`]); the same whenever it is asked for.
    pub fn to_json(&self) -> serde_json::Value {
        whole_report(vec![run_report(&self.path, &self.run, &self.stated)], self.peak_memory)
    }
}

struct LastRun {
    report: RunReport,
    /// The largest memory of the process until the run ended, bytes.
    peak_memory: Option<u64>,
}

impl LastRun {
    fn ended(report: RunReport) -> LastRun {
        LastRun { report, peak_memory: memory::peak() }
    }
}

/// Sink of a run whose result is for the host program: no file can state its name.
static SINK: Node = Node {
    name: "(the program)",
    summary: "Takes a value for the program.",
    optional_inputs: &[
        Port { name: "image", port_type: PortType::Image, summary: "a picture" },
        Port { name: "report", port_type: PortType::Report, summary: "figures" },
        Port { name: "volume", port_type: PortType::Volume, summary: "a volume" },
        Port { name: "widgets", port_type: PortType::TransferFunction, summary: "widgets, as of a probe" },
    ],
    ..Node::BLANK
};

impl Pipeline {
    /// An empty pipeline of these node types and filters.
    ///
    /// # Errors
    /// - a registry that has nodes of the facade's own.
    pub fn new(registry: Registry) -> Result<Pipeline> {
        let (source, session) = (PipelineText::default(), voltet_nodes::session());
        let (none, grids, ranks) = (Registry::new(), BTreeMap::new(), Arc::new(OneRank));
        let mut pipeline = Pipeline { source, registry: none, session, ranks, grids, last: None };
        pipeline.set_registry(registry)?;
        Ok(pipeline)
    }

    /// Makes it the pipeline of one of several processes that run it together: all of them call the same functions in the same order,
    /// and the first one alone writes files.
    pub fn with_ranks(self, ranks: Arc<dyn Ranks>) -> Pipeline {
        Pipeline { session: voltet_nodes::session().with_ranks(ranks.clone()), ranks, ..self }
    }

    /// Opens a pipeline file, or a picture that carries its pipeline.
    ///
    /// # Errors
    /// - a file that cannot be read;
    /// - a text that states no pipeline of known nodes.
    pub fn open(path: impl AsRef<Path>) -> Result<Pipeline> {
        let mut pipeline = Self::new(voltet_nodes::registry()?)?;
        pipeline.load_file(path)?;
        Ok(pipeline)
    }

    /// Parses the text of a pipeline, whose paths are relative to `folder`.
    ///
    /// # Errors
    /// - a text that states no pipeline of known nodes.
    pub fn parse(text: &str, folder: impl AsRef<Path>) -> Result<Pipeline> {
        let mut pipeline = Self::new(voltet_nodes::registry()?)?;
        pipeline.load(text.into(), Path::new("the pipeline's text"), folder.as_ref())?;
        Ok(pipeline)
    }

    /// Replaces the pipeline by that of a file. Open devices are kept, in-memory grids are dropped.
    ///
    /// # Errors
    /// As of [`Pipeline::open`]; the former pipeline then stays.
    pub fn load_file(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        self.load(Source::read(path)?.text, path, path.parent().unwrap_or(Path::new("")))
    }

    /// Replaces the pipeline by that of a text. `path`: its name in errors.
    ///
    /// # Errors
    /// As of [`Pipeline::parse`]; the former pipeline then stays.
    pub fn load(&mut self, text: String, path: &Path, folder: &Path) -> Result<()> {
        let nodes = Nodes::parse(&text).map_err(|error| locate(error, &text, path))?;
        self.replace(PipelineText::new(nodes, text, path.into(), folder.into()))?;
        self.grids.clear();
        self.session.forget();
        Ok(())
    }

    /// Carries out an option `node.parameter=value`, as `--set` does.
    ///
    /// # Errors
    /// - a node or parameter that does not exist, a value that is refused.
    pub fn set(&mut self, option: &str) -> Result<()> {
        let mut text = self.source.clone();
        text.nodes.set(option)?;
        self.replace(PipelineText { is_changed: true, ..text })
    }

    /// Changes parameters, or parts of them.
    ///
    /// # Errors
    /// As of [`Pipeline::set`].
    pub fn apply(&mut self, changes: &[Change]) -> Result<()> {
        let mut text = self.source.clone();
        changes.iter().try_for_each(|change| change.apply(&mut text.nodes.nodes))?;
        self.replace(PipelineText { is_changed: true, ..text })
    }

    /// Sets parameters of a node; `None` removes one.
    ///
    /// # Errors
    /// As of [`Pipeline::set`].
    pub fn set_parameters(&mut self, node: &str, values: Vec<(&str, Option<ParameterValue>)>) -> Result<()> {
        let mut text = self.source.clone();
        let entry = text.node(node)?;
        for (name, value) in values {
            match value {
                Some(value) => entry.set(name, &[], value.into())?,
                None => entry.settings.retain(|field| field.name != name),
            }
        }
        self.replace(text)
    }

    /// Replaces all parameters of a node by those that a text in TOML states.
    ///
    /// # Errors
    /// As of [`Pipeline::set`], located in the text.
    pub fn set_node(&mut self, name: &str, toml: &str) -> Result<()> {
        let settings =
            parameters(toml).map_err(|error| locate(error, toml, Path::new(name)).at_node(name))?;
        let mut text = self.source.clone();
        let node = text.node(name)?;
        node.settings = settings;
        // The text that errors point at is another now.
        node.origin = SourceSpan::Nowhere;
        node.node_type.origin = SourceSpan::Nowhere;
        for link in &mut node.inputs {
            link.origin = SourceSpan::Nowhere;
            link.source = without_span(&link.source);
        }
        text.node_texts.insert(name.into(), toml.into());
        self.replace(text)
    }

    /// Sets all parameters of a camera node. `node` is `None`: the only one.
    ///
    /// # Errors
    /// - no such node;
    /// - those of [`Camera::place`].
    pub fn set_camera(&mut self, node: Option<&str>, camera: &Camera) -> Result<()> {
        let name = self.camera_node(node)?;
        let camera = camera.place()?;
        let (fov_y, height) = match camera.projection {
            Projection::Perspective { fov_y } => (Some(ParameterValue::Number(fov_y)), None),
            Projection::Orthographic { height } => (None, Some(ParameterValue::Number(height))),
        };
        let size = camera.size.into_iter().map(|side| ParameterValue::Integer(side.into())).collect();
        let mut values = vec![
            ("eye", Some(camera.eye.to_array().into_iter().collect())),
            ("target", Some(camera.target.to_array().into_iter().collect())),
            ("up", Some(camera.up.to_array().into_iter().collect())),
            ("near", Some(ParameterValue::Number(camera.near))),
            ("samples", Some(ParameterValue::Integer(camera.samples.into()))),
            ("size", Some(size)),
            ("fov_y", fov_y),
            ("height", height),
        ];
        values.extend(VIEW_PARAMETERS.map(|name| (name, None)));
        self.set_parameters(&name, values)
    }

    /// Replaces the output of a node that reads or makes a grid by a grid in memory.
    ///
    /// # Errors
    /// - no such node;
    /// - those of [`Grid::build`].
    pub fn with_grid(mut self, node: &str, grid: impl Into<Grid>) -> Result<Pipeline> {
        let grid = Arc::new(grid.into().in_memory()?);
        self.set_grid(Some(node), Some(&grid))?;
        Ok(self)
    }

    /// Renders the picture of a node; nothing is written.
    ///
    /// # Errors
    /// - no such node;
    /// - those of the nodes.
    pub fn render(&mut self, node: &str) -> Result<Image> {
        let plan = self.render_plan(Some(node))?;
        self.render_with(&plan, &NoObserver).map(Image::from)
    }

    /// Runs the whole pipeline with its writers, and returns the pictures by node.
    ///
    /// # Errors
    /// - an output that is an input, or another output;
    /// - those of the nodes, and cancellation.
    pub fn run(&mut self, observer: &dyn Observer) -> Result<Vec<(String, Image)>> {
        let mut graph = self.whole_graph()?;
        if let Ok(stated) = Nodes::stated(self.source.text(), &self.registry) {
            graph.stated = stated;
        }
        let PipelineText { path, text, nodes: pipeline, .. } = self.source.clone();
        let document = Document { path, text, pipeline, graph, carried: None };
        document.refuse_collisions()?;
        let report = self.run_graph(&document.graph, observer)?;
        Ok(report.pictures.iter().map(|(name, picture)| (name.clone(), picture.clone().into())).collect())
    }

    /// Takes over a changed text if it is sound.
    fn replace(&mut self, text: PipelineText) -> Result<()> {
        match Graph::faults(&text.nodes.nodes, &self.registry, text.folder.clone()).into_iter().next() {
            Some(fault) => Err(text.locate(fault.error)),
            None => {
                self.source = text;
                Ok(())
            }
        }
    }

    /// Replaces the node types and filters. Results of former runs are dropped, but not open devices: a filter of one name may be
    /// another now.
    pub fn set_registry(&mut self, mut registry: Registry) -> Result<()> {
        registry.add(&in_memory_grid::NODE)?;
        registry.add(&SINK)?;
        self.registry = registry;
        self.session.forget();
        Ok(())
    }

    /// The node types and filters.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Drops kept values and open devices, as after a panic.
    pub fn reset(&mut self) {
        (self.session, self.last) = (voltet_nodes::session().with_ranks(self.ranks.clone()), None);
    }

    /// Replaces the output of a node by a grid that is built, or ends that. `node` is `None`: the only one with a grid. Returns the
    /// node's name.
    ///
    /// # Errors
    /// - no such node.
    pub fn set_grid(&mut self, node: Option<&str>, grid: Option<&Arc<HostGrid>>) -> Result<String> {
        self.override_grid(node, grid.map(|grid| in_memory_grid::grid(grid.clone())))
    }

    /// Like [`Pipeline::set_grid`], by this process's piece of a grid that all processes hold together; `None`: it holds nothing of it.
    /// Around its cells it has ghosts, such of other pieces.
    ///
    /// # Errors
    /// - no such node.
    pub fn set_piece(&mut self, node: &str, piece: Option<Arc<HostGrid>>) -> Result<()> {
        self.override_grid(Some(node), Some(in_memory_grid::piece(piece))).map(drop)
    }

    fn override_grid(&mut self, node: Option<&str>, work: Option<NodeOverride>) -> Result<String> {
        let name = self.only(node, PortType::Grid, "grid")?;
        for entry in self.source.nodes.nodes.iter().filter(|entry| entry.name == name) {
            in_memory_grid::stand_in(&mut entry.clone(), &self.registry)?;
        }
        match work {
            Some(work) => self.grids.insert(name.clone(), work),
            None => self.grids.remove(&name),
        };
        // The owner of the former one's arrays gets them back.
        self.session.forget();
        Ok(name)
    }

    /// Node of a picture: the named one, else the only one with a picture that no other node makes another picture of, as `annotation`
    /// does.
    ///
    /// # Errors
    /// - no such node.
    pub fn picture_node(&self, node: Option<&str>) -> Result<String> {
        let pictures = self.nodes_with_output(PortType::Image);
        let entries = self.source.nodes.nodes.iter().filter(|entry| pictures.contains(&entry.name));
        let sources: Vec<&str> =
            entries.flat_map(|entry| &entry.inputs).filter_map(|link| link.source.text()).collect();
        let is_taken = |name: &String| {
            sources.iter().any(|source| {
                source.strip_prefix(name.as_str()).is_some_and(|rest| matches!(rest, "" | ".image"))
            })
        };
        let last: Vec<&String> = pictures.iter().filter(|name| !is_taken(name)).collect();
        let only = if let [last] = last[..] { Some(last.as_str()) } else { None };
        self.only(node.or(only), PortType::Image, "picture")
    }

    /// Node of a camera: the named one, else the only one.
    ///
    /// # Errors
    /// - no such node.
    pub fn camera_node(&self, node: Option<&str>) -> Result<String> {
        self.only(node, PortType::Camera, "camera")
    }

    /// The named node, else the only one with an output of a type, which messages call `what`.
    fn only(&self, named: Option<&str>, port_type: PortType, what: &str) -> Result<String> {
        let nodes = self.nodes_with_output(port_type);
        let accepted = match &nodes[..] {
            [] => format!("a pipeline with a node that gives a {what}"),
            names => {
                let names = nearest_first(named.unwrap_or_default(), names.iter().map(String::as_str));
                format!("a node that gives a {what}: {}", names.join(", "))
            }
        };
        let error = match (named, &nodes[..]) {
            (Some(name), _) if nodes.iter().any(|known| known == name) => return Ok(name.into()),
            (None, [one]) => return Ok(one.clone()),
            (Some(name), _) => Error::usage(format!("the node '{name}' gives no {what}")),
            (None, []) => Error::usage(format!("the pipeline has no {what}")),
            (None, _) => {
                let what = format!("the pipeline has several nodes that give a {what}");
                Error::usage(what).got("none named")
            }
        };
        Err(error.expected(accepted))
    }

    /// Names of the nodes with an output of a type, in the order of the pipeline.
    fn nodes_with_output(&self, port_type: PortType) -> Vec<String> {
        let names = self.source.nodes.nodes.iter().map(|entry| entry.name.clone());
        let gives = |node: &Node| node.outputs.iter().any(|port| port.port_type == port_type);
        names.filter(|name| self.node_type(name).is_some_and(gives)).collect()
    }

    /// The graph that renders the picture of a node, with its size. `node` is `None`: the only one with a picture.
    ///
    /// # Errors
    /// - no such node, or a pipeline that cannot run.
    pub fn render_plan(&self, node: Option<&str>) -> Result<RenderPlan> {
        let name = self.picture_node(node)?;
        let graph = self.graph_for(&name, "image")?;
        Ok(RenderPlan { size: size_of(&graph)?, graph, name })
    }

    /// Renders by a plan, and reports progress to an observer, which may cancel.
    ///
    /// # Errors
    /// - those of the nodes, and cancellation.
    pub fn render_with(&mut self, plan: &RenderPlan, observer: &dyn Observer) -> Result<Arc<Picture>> {
        let report = self.run_graph(&plan.graph, observer)?;
        let picture = report.pictures.iter().find(|(name, _)| *name == plan.name);
        let none = || Error::run("the node that draws gave no picture").at_node(&plan.name);
        picture.map(|found| found.1.clone()).ok_or_else(none)
    }

    /// Like [`Pipeline::render_with`], into memory of the caller's own: none of it is kept, so that the same picture is rendered anew
    /// the next time.
    pub fn render_owned(&mut self, plan: &RenderPlan, observer: &dyn Observer) -> Result<Picture> {
        let picture = self.render_with(plan, observer)?;
        self.session.release(&picture);
        if let Some(last) = &mut self.last {
            last.report.pictures.clear();
        }
        Ok(Arc::unwrap_or_clone(picture))
    }

    /// Runs a graph of the pipeline, such as that of [`Pipeline::whole_graph`].
    pub fn run_graph(&mut self, graph: &Graph, observer: &dyn Observer) -> Result<&RunReport> {
        self.last = None;
        let report = self.session.run(graph, observer).map_err(|error| self.source.locate(error))?;
        let report = &mut self.last.insert(LastRun::ended(report)).report;
        report.nodes.retain(|node| node.node_type != SINK.name);
        Ok(report)
    }

    /// Value at a node's output. `demand`: the parts of it that are computed, if it is a volume.
    pub fn value(
        &mut self,
        (node, port): (&str, &str),
        demand: &Demand,
        observer: &dyn Observer,
    ) -> Result<Value> {
        let graph = self.graph_for(node, port)?;
        let sink = graph.nodes.len() - 1;
        let fed = self.session.feed(&graph, sink, demand, observer);
        let (values, report) = fed.map_err(|error| self.source.locate(error))?;
        self.last = Some(LastRun::ended(report));
        values.into_iter().next().ok_or_else(|| Error::run("the node gave nothing").at_node(node))
    }

    /// Passes the graph of a node's picture, or of the whole pipeline, and the session, to `work`.
    pub fn with_graph<T>(
        &mut self,
        node: Option<&str>,
        work: impl FnOnce(&Graph, &mut Session) -> Result<T>,
    ) -> Result<T> {
        let graph = match node {
            Some(node) => self.graph_for(node, "image")?,
            None => self.whole_graph()?,
        };
        work(&graph, &mut self.session).map_err(|error| self.source.locate(error))
    }

    /// Plans a graph without data: its warnings, with their locations.
    ///
    /// # Errors
    /// - those that the plan finds.
    pub fn plan(&mut self, graph: &Graph) -> Result<Vec<Error>> {
        self.session.plan(graph).map_err(|error| self.source.locate(error))?;
        Ok(graph.warnings.iter().map(|warning| self.source.locate(warning.clone())).collect())
    }

    /// Record of the last run; `None` before there was one.
    pub fn record(&self) -> Option<RunRecord> {
        let last = self.last.as_ref()?;
        let run = RunReport { pictures: Vec::new(), ..last.report.clone() };
        let title = self.source.nodes.title.clone();
        // It is written to no file, so that the locations of its paths are of no use.
        let stated = ResolvedPipeline::new(title, self.source.text(), std::iter::empty());
        Some(RunRecord {
            path: self.source.path.display().to_string(),
            stated,
            run,
            peak_memory: last.peak_memory,
        })
    }

    /// Report of the last run (JSON); `None` before there was one.
    pub fn report(&self) -> Option<String> {
        Some(format!("{:#}", self.record()?.to_json()))
    }

    /// The text that states the pipeline, with what was changed.
    pub fn text(&self) -> String {
        self.source.text()
    }

    /// Warnings of the last run; `None` before there was one.
    pub fn warnings(&self) -> Option<&[String]> {
        self.last.as_ref().map(|last| last.report.warnings.as_slice())
    }

    /// The graph of the whole pipeline: its writers, and the pictures and probes that feed nothing.
    pub fn whole_graph(&self) -> Result<Graph> {
        let mut entries = self.source.nodes.nodes.clone();
        let feeds = |name: &String| {
            let mut wires = entries.iter().flat_map(|entry| entry.inputs.iter().flat_map(links::sources));
            wires.any(|text| links::source(text, &entries).0 == name)
        };
        // A transfer function without inputs says nothing about data.
        let has_inputs = |name: &String| self.node_type(name).is_some_and(|node| !node.inputs.is_empty());
        let mut fed = Vec::new();
        for (port, port_type) in [("image", PortType::Image), ("widgets", PortType::TransferFunction)] {
            let given = self.nodes_with_output(port_type).into_iter();
            let open = given.filter(|name| !feeds(name) && has_inputs(name));
            fed.extend(open.map(|name| (port, self.output(&name, port))));
        }
        if !fed.is_empty() {
            entries.push(NodeEntry::of_program(&SINK, Vec::new(), fed));
        }
        self.graph(entries)
    }

    /// Graph of the nodes that a value depends on, and no others, with the sink.
    fn graph_for(&self, node: &str, port: &str) -> Result<Graph> {
        let names = || self.source.nodes.nodes.iter().map(|entry| entry.name.as_str());
        // The sink's own wire would be refused in its name.
        if !names().any(|known| known == node) {
            return Err(unknown_node(node, names()));
        }
        let mut entries = links::feeding(&self.source.nodes.nodes, node);
        entries.push(NodeEntry::of_program(&SINK, Vec::new(), [(port, self.output(node, port))]));
        self.graph(entries)
    }

    /// Output of a node for a port of the sink: the first whose type fits.
    fn output(&self, name: &str, port: &str) -> String {
        let input = SINK.optional_inputs.iter().find(|known| known.name == port);
        let fits = |o: &&Port| input.is_some_and(|input| o.port_type.serves(input.port_type));
        let node = self.node_type(name).filter(|node| node.outputs.len() > 1);
        match node.and_then(|node| node.outputs.iter().find(fits)) {
            Some(output) => format!("{name}.{}", output.name),
            None => name.into(),
        }
    }

    fn node_type(&self, name: &str) -> Option<&'static Node> {
        let entry = self.source.nodes.nodes.iter().find(|entry| entry.name == name)?;
        self.registry.node_type(entry)
    }

    fn graph(&self, mut entries: Vec<NodeEntry>) -> Result<Graph> {
        for entry in entries.iter_mut().filter(|entry| self.grids.contains_key(&entry.name)) {
            in_memory_grid::stand_in(entry, &self.registry)?;
        }
        let graph = Graph::build(&entries, &self.registry, self.source.folder.clone());
        let mut graph = graph.map_err(|error| self.source.locate(error))?;
        for (name, grid) in &self.grids {
            if graph.nodes.iter().any(|node| node.name == *name) {
                graph.give(name, grid.clone())?;
            }
        }
        Ok(graph)
    }
}

/// The setting without its location in a text.
fn without_span(setting: &LocatedValue) -> LocatedValue {
    let datum = match &setting.datum {
        ParameterValue::List(list) => ParameterValue::List(list.iter().map(without_span).collect()),
        other => other.clone(),
    };
    datum.into()
}

/// Size of the camera's picture (pixels).
fn size_of(graph: &Graph) -> Result<[usize; 2]> {
    let gives_camera = |port: &Port| port.port_type == PortType::Camera;
    let camera = graph.nodes.iter().find(|node| node.node.outputs.iter().any(gives_camera));
    let none = || Error::usage("the pipeline has no camera").expected("a node of type \"camera\"");
    let size: [f64; 2] = camera.ok_or_else(none)?.parameters.vector("size")?;
    Ok(size.map(|side| side as usize))
}
