//! A session of a host program: pictures and figures of its pipelines, its in-memory grids, and the results that runs leave.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_document::links;
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{
    Demand, Graph, LinkEntry, LocatedValue, Node, NodeEntry, NodeOverride, Observer, ParameterValue, Port,
    PortType, Registry, ResolvedPipeline, RunReport, SourceSpan, Value,
};
use voltet_io::provenance::run_report;
use voltet_nodes::in_memory_grid;

/// A pipeline that a session runs, with the text that its errors point at.
pub trait PipelineSource {
    /// The nodes.
    fn pipeline(&self) -> &Pipeline;
    /// Folder that its paths are relative to.
    fn folder(&self) -> PathBuf;
    /// Its file, or a name for reports.
    fn path(&self) -> PathBuf;
    /// Completes an error with file, line and column.
    fn locate(&self, error: Error) -> Error;
}

/// State that outlives a picture: node types, results that runs share, in-memory grids.
pub struct Session {
    registry: Registry,
    runs: voltet_graph::Session,
    /// In-memory grids by the name of the node that they replace.
    grids: BTreeMap<String, NodeOverride>,
    last: Option<RunReport>,
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
}

/// Sink of a run whose result is for the host program.
static SINK: Node = Node {
    name: "taker",
    summary: "Takes a value for the program.",
    optional_inputs: &[
        Port { name: "image", port_type: PortType::Image, summary: "a picture" },
        Port { name: "report", port_type: PortType::Report, summary: "figures" },
        Port { name: "volume", port_type: PortType::Volume, summary: "a volume" },
        Port { name: "widgets", port_type: PortType::TransferFunction, summary: "widgets, as of a probe" },
    ],
    ..Node::BLANK
};

/// Name of the sink: no file can state it.
const SINK_NAME: &str = "(the program)";

impl RunRecord {
    /// The run's part of a report ([`voltet_io::provenance::whole_report`]).
    pub fn to_json(&self) -> serde_json::Value {
        run_report(&self.path, &self.run, &self.stated)
    }
}

impl Session {
    /// Creates a session with these node types and filters.
    pub fn new(registry: Registry) -> Result<Session> {
        let (runs, grids) = (voltet_nodes::session(), BTreeMap::new());
        let mut session = Session { registry: Registry::new(), runs, grids, last: None };
        session.set_registry(registry)?;
        Ok(session)
    }

    /// Replaces the node types and filters. Results of former runs are dropped, but not open devices: a filter of one name may be
    /// another now.
    pub fn set_registry(&mut self, mut registry: Registry) -> Result<()> {
        registry.add(&in_memory_grid::NODE)?;
        registry.add(&SINK)?;
        self.registry = registry;
        self.runs.forget();
        Ok(())
    }

    /// The node types and filters.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Drops results of runs and the open devices.
    pub fn reset(&mut self) {
        (self.runs, self.last) = (voltet_nodes::session(), None);
    }

    /// Drops the in-memory grids of a pipeline that was replaced, and the results of its runs.
    pub fn clear_grids(&mut self) {
        self.grids.clear();
        self.runs.forget();
    }

    /// Replaces the output of a node by an in-memory grid, or ends that. `name` is `None`: the only node with a grid.
    pub fn set_grid(
        &mut self,
        source: &dyn PipelineSource,
        name: Option<&str>,
        grid: Option<&Arc<Grid>>,
    ) -> Result<()> {
        let name = self.grid_node(source, name)?;
        match grid {
            Some(grid) => self.grids.insert(name, in_memory_grid::grid(grid.clone())),
            None => self.grids.remove(&name),
        };
        // The lender of the former one gets its memory back.
        self.runs.forget();
        Ok(())
    }

    /// Node that an in-memory grid would replace: the named one, else the only one with a grid.
    pub fn grid_node(&self, source: &dyn PipelineSource, name: Option<&str>) -> Result<String> {
        let name = only(name, &self.nodes_with_output(source, PortType::Grid), "grid")?;
        for entry in source.pipeline().nodes.iter().filter(|entry| entry.name == name) {
            in_memory_grid::stand_in(&mut entry.clone(), &self.registry)?;
        }
        Ok(name)
    }

    /// Node of a picture: the named one, else the only one with a picture.
    pub fn picture(&self, source: &dyn PipelineSource, node: Option<&str>) -> Result<String> {
        only(node, &self.nodes_with_output(source, PortType::Image), "picture")
    }

    /// Node of a camera: the named one, else the only one.
    pub fn camera(&self, source: &dyn PipelineSource, node: Option<&str>) -> Result<String> {
        only(node, &self.nodes_with_output(source, PortType::Camera), "camera")
    }

    /// Names of the nodes with an output of a type, in the order of the pipeline.
    pub fn nodes_with_output(&self, source: &dyn PipelineSource, port_type: PortType) -> Vec<String> {
        let gives = |entry: &&NodeEntry| {
            let node = entry.node_type.text().and_then(|name| self.registry.find(name).ok());
            node.is_some_and(|node| node.outputs.iter().any(|port| port.port_type == port_type))
        };
        source.pipeline().nodes.iter().filter(gives).map(|entry| entry.name.clone()).collect()
    }

    /// Width and height of the picture of a node (pixels). `node` is `None`: the only one.
    pub fn size(&self, source: &dyn PipelineSource, node: Option<&str>) -> Result<[usize; 2]> {
        size_of(&self.graph_for(source, &self.picture(source, node)?, "image")?)
    }

    /// The graph that renders the picture of a node, with its size. `node` is `None`: the only one.
    pub fn render_plan(&self, source: &dyn PipelineSource, node: Option<&str>) -> Result<RenderPlan> {
        let name = self.picture(source, node)?;
        let graph = self.graph_for(source, &name, "image")?;
        Ok(RenderPlan { size: size_of(&graph)?, graph, name })
    }

    /// Renders a picture.
    pub fn render(
        &mut self,
        source: &dyn PipelineSource,
        plan: &RenderPlan,
        observer: &dyn Observer,
    ) -> Result<Arc<Picture>> {
        let report = self.run(source, &plan.graph, observer)?;
        let picture = report.pictures.iter().find(|(name, _)| *name == plan.name);
        let none = || Error::run("the node that draws gave no picture").at_node(&plan.name);
        picture.map(|found| found.1.clone()).ok_or_else(none)
    }

    /// Renders a picture into memory of the caller's own: the session keeps none of it, so that the same picture is rendered anew the
    /// next time.
    pub fn render_owned(
        &mut self,
        source: &dyn PipelineSource,
        plan: &RenderPlan,
        observer: &dyn Observer,
    ) -> Result<Picture> {
        let picture = self.render(source, plan, observer)?;
        self.runs.release(&picture);
        if let Some(report) = &mut self.last {
            report.pictures.clear();
        }
        Ok(Arc::unwrap_or_clone(picture))
    }

    /// Runs a graph of the pipeline, such as that of [`Session::whole_graph`].
    pub fn run(
        &mut self,
        source: &dyn PipelineSource,
        graph: &Graph,
        observer: &dyn Observer,
    ) -> Result<&RunReport> {
        self.last = None;
        let report = self.runs.run(graph, observer).map_err(|error| source.locate(error))?;
        let report = self.last.insert(report);
        report.nodes.retain(|node| node.node_type != SINK.name);
        Ok(report)
    }

    /// Value at a node's output. `demand`: the parts of it that are computed, if it is a volume.
    pub fn value(
        &mut self,
        source: &dyn PipelineSource,
        (node, port): (&str, &str),
        demand: &Demand,
        observer: &dyn Observer,
    ) -> Result<Value> {
        let graph = self.graph_for(source, node, port)?;
        let sink = graph.nodes.len() - 1;
        let fed = self.runs.feed(&graph, sink, demand, observer).map_err(|error| source.locate(error))?;
        fed.0.into_iter().next().ok_or_else(|| Error::run("the node gave nothing").at_node(node))
    }

    /// Passes the graph of a node's picture, or of the whole pipeline, and the session that holds its inputs, to `work`.
    pub fn with_graph<T>(
        &mut self,
        source: &dyn PipelineSource,
        node: Option<&str>,
        work: impl FnOnce(&Graph, &mut voltet_graph::Session) -> Result<T>,
    ) -> Result<T> {
        let graph = match node {
            Some(node) => self.graph_for(source, node, "image")?,
            None => self.whole_graph(source)?,
        };
        work(&graph, &mut self.runs).map_err(|error| source.locate(error))
    }

    /// Errors of plans, which are made without data, and warnings with their locations.
    pub fn plan(&mut self, source: &dyn PipelineSource, graph: &Graph) -> Result<Vec<Error>> {
        self.runs.plan(graph).map_err(|error| source.locate(error))?;
        Ok(graph.warnings.iter().map(|warning| source.locate(warning.clone())).collect())
    }

    /// The report of the last run; `None` before there was one.
    pub fn last(&self) -> Option<&RunReport> {
        self.last.as_ref()
    }

    /// Record of the last run. `text`: that of the pipeline.
    pub fn record(&self, source: &dyn PipelineSource, text: String) -> Option<RunRecord> {
        let run = RunReport { pictures: Vec::new(), ..self.last.clone()? };
        // It is written to no file, so that the locations of its paths are of no use.
        let stated = ResolvedPipeline::new(source.pipeline().title.clone(), text, std::iter::empty());
        Some(RunRecord { path: source.path().display().to_string(), stated, run })
    }

    /// The graph of the whole pipeline: its writers, and the pictures and probes that feed nothing.
    pub fn whole_graph(&self, source: &dyn PipelineSource) -> Result<Graph> {
        let mut entries = source.pipeline().nodes.clone();
        let feeds = |name: &String| {
            let mut wires = entries.iter().flat_map(|entry| entry.inputs.iter().flat_map(links::sources));
            wires.any(|text| links::source(text, &entries).0 == name)
        };
        // Widgets that are made of no data have no findings.
        let has_inputs = |name: &String| {
            let entry = entries.iter().find(|entry| entry.name == *name);
            let node = entry.and_then(|entry| self.registry.find(entry.node_type.text()?).ok());
            node.is_some_and(|node| !node.inputs.is_empty())
        };
        let mut sink = None;
        for (port, port_type) in [("image", PortType::Image), ("widgets", PortType::TransferFunction)] {
            let mut open = self.nodes_with_output(source, port_type);
            open.retain(|name| !feeds(name) && has_inputs(name));
            if !open.is_empty() {
                let request = self.sink(&entries, port, &open);
                sink.get_or_insert_with(|| NodeEntry { inputs: Vec::new(), ..request.clone() })
                    .inputs
                    .extend(request.inputs);
            }
        }
        entries.extend(sink);
        self.graph(source, entries)
    }

    /// Graph of the nodes that a value depends on, and no others, with the sink.
    fn graph_for(&self, source: &dyn PipelineSource, node: &str, port: &str) -> Result<Graph> {
        let nodes = &source.pipeline().nodes;
        let needed = links::upstream(nodes, node);
        let mut entries: Vec<NodeEntry> =
            nodes.iter().filter(|entry| needed.contains(&entry.name)).cloned().collect();
        entries.push(self.sink(&entries, port, &[node.to_string()]));
        self.graph(source, entries)
    }

    /// Sink of the values of these nodes: of each the first output whose type fits.
    fn sink(&self, entries: &[NodeEntry], port: &str, nodes: &[String]) -> NodeEntry {
        let text = |text: &str| LocatedValue::from(ParameterValue::Text(text.into()));
        let input = SINK.optional_inputs.iter().find(|known| known.name == port);
        let output = |name: &String| {
            let entry = entries.iter().find(|entry| entry.name == *name)?;
            let node = self.registry.find(entry.node_type.text()?).ok()?;
            let mut fitting =
                node.outputs.iter().filter(|o| input.is_some_and(|t| o.port_type.serves(t.port_type)));
            fitting.next().filter(|_| node.outputs.len() > 1)
        };
        let source = |name: &String| match output(name) {
            Some(output) => text(&format!("{name}.{}", output.name)),
            None => text(name),
        };
        NodeEntry {
            name: SINK_NAME.into(),
            origin: SourceSpan::Nowhere,
            node_type: text(SINK.name),
            settings: Vec::new(),
            inputs: vec![LinkEntry {
                port: port.into(),
                origin: SourceSpan::Nowhere,
                source: ParameterValue::List(nodes.iter().map(source).collect()).into(),
            }],
        }
    }

    fn graph(&self, source: &dyn PipelineSource, mut entries: Vec<NodeEntry>) -> Result<Graph> {
        for entry in entries.iter_mut().filter(|entry| self.grids.contains_key(&entry.name)) {
            in_memory_grid::stand_in(entry, &self.registry)?;
        }
        let graph = Graph::build(&entries, &self.registry, source.folder());
        let mut graph = graph.map_err(|error| source.locate(error))?;
        for (name, grid) in &self.grids {
            if graph.nodes.iter().any(|node| node.name == *name) {
                graph.give(name, grid.clone())?;
            }
        }
        Ok(graph)
    }
}

/// The named node, else the only one of `nodes`, which have an output of the kind `what`.
fn only(named: Option<&str>, nodes: &[String], what: &str) -> Result<String> {
    let accepted = || match nodes {
        [] => format!("a pipeline with a node that gives a {what}"),
        names => format!("a node that gives a {what}: {}", names.join(", ")),
    };
    match (named, nodes) {
        (Some(name), _) if nodes.iter().any(|known| known == name) => Ok(name.into()),
        (Some(name), _) => {
            Err(Error::usage(format!("the node '{name}' gives no {what}")).expected(accepted()))
        }
        (None, [one]) => Ok(one.clone()),
        (None, []) => Err(Error::usage(format!("the pipeline has no {what}")).expected(accepted())),
        (None, _) => Err(Error::usage(format!("the pipeline has several nodes that give a {what}"))
            .got("none named")
            .expected(accepted())),
    }
}

/// Size of the camera's picture (pixels).
fn size_of(graph: &Graph) -> Result<[usize; 2]> {
    let gives_camera = |port: &Port| port.port_type == PortType::Camera;
    let camera = graph.nodes.iter().find(|node| node.node.outputs.iter().any(gives_camera));
    let none = || Error::usage("the pipeline has no camera").expected("a node of type \"camera\"");
    let size: [f64; 2] = camera.ok_or_else(none)?.parameters.vector("size")?;
    Ok(size.map(|side| side as usize))
}
