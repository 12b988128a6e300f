//! Pictures and figures of a pipeline that a program states: the grids that it gives, and what its runs leave.

use crate::graphs::TAKER;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{
    Demand, Graph, NodeEntry, NodeOverride, Observer, Port, PortType, Registry, ResolvedPipeline, RunReport,
    Value,
};
use voltet_io::provenance::run_report;
use voltet_nodes::given;

/// What a program states.
pub trait Scene {
    /// The nodes.
    fn pipeline(&self) -> &Pipeline;
    /// What its paths are relative to.
    fn folder(&self) -> PathBuf;
    /// What it came from, for reports.
    fn path(&self) -> PathBuf;
    /// Completes an error with the text that it points at, its line and its column.
    fn locate(&self, error: Error) -> Error;
}

/// What lives longer than a picture.
pub struct Session {
    pub(crate) registry: Registry,
    runs: voltet_graph::Session,
    /// The grids that stand in for nodes' own.
    pub(crate) grids: BTreeMap<String, NodeOverride>,
    last: Option<RunReport>,
}

/// What draws one picture.
pub struct Drawing {
    graph: Graph,
    name: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

/// What a run did, kept to be put into words when it is asked for.
pub struct Account {
    path: String,
    stated: ResolvedPipeline,
    /// Without its pictures.
    run: RunReport,
}

impl Account {
    /// What is said of the run in a report ([`voltet_io::provenance::whole_report`]).
    pub fn words(&self) -> serde_json::Value {
        run_report(&self.path, &self.run, &self.stated)
    }
}

impl Session {
    /// With these node types and filters, and those that a program needs.
    pub fn new(registry: Registry) -> Result<Session> {
        let (runs, grids) = (voltet_nodes::session(), BTreeMap::new());
        let mut session = Session { registry: Registry::new(), runs, grids, last: None };
        session.know(registry)?;
        Ok(session)
    }

    /// Other node types and filters. What runs left is gone, but for open devices: filters of one name may be others now.
    pub fn know(&mut self, mut registry: Registry) -> Result<()> {
        registry.add(&given::NODE)?;
        registry.add(&TAKER)?;
        self.registry = registry;
        self.runs.forget();
        Ok(())
    }

    /// The node types and filters.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Drops what runs left, with the open devices.
    pub fn begin_anew(&mut self) {
        (self.runs, self.last) = (voltet_nodes::session(), None);
    }

    /// Drops the grids, which belong to a pipeline that is no more, and what runs left of it.
    pub fn give_none(&mut self) {
        self.grids.clear();
        self.runs.forget();
    }

    /// Puts a grid in place of what a node reads or makes, or takes it away. `None`: of the only such node.
    pub fn give(&mut self, scene: &dyn Scene, name: Option<&str>, grid: Option<&Arc<Grid>>) -> Result<()> {
        let name = self.grid_node(scene, name)?;
        match grid {
            Some(grid) => self.grids.insert(name, given::grid(grid.clone())),
            None => self.grids.remove(&name),
        };
        // Whoever lent the former one waits for it.
        self.runs.forget();
        Ok(())
    }

    /// The node that a grid would stand in for: the one that is named, else the only one that gives a grid.
    pub fn grid_node(&self, scene: &dyn Scene, name: Option<&str>) -> Result<String> {
        let name = only(name, &self.giving(scene, PortType::Grid), "grid")?;
        for entry in scene.pipeline().nodes.iter().filter(|entry| entry.name == name) {
            given::stand_in(&mut entry.clone(), &self.registry)?;
        }
        Ok(name)
    }

    /// The node of a picture: the one that is named, else the only one that gives one.
    pub fn picture(&self, scene: &dyn Scene, node: Option<&str>) -> Result<String> {
        only(node, &self.giving(scene, PortType::Image), "picture")
    }

    /// The node of a camera: the one that is named, else the only one.
    pub fn camera(&self, scene: &dyn Scene, node: Option<&str>) -> Result<String> {
        only(node, &self.giving(scene, PortType::Camera), "camera")
    }

    /// The names of the nodes that give something, in the order of the pipeline.
    pub fn giving(&self, scene: &dyn Scene, wanted: PortType) -> Vec<String> {
        let gives = |entry: &&NodeEntry| {
            let node = entry.node_type.text().and_then(|name| self.registry.find(name).ok());
            node.is_some_and(|node| node.outputs.iter().any(|port| port.port_type == wanted))
        };
        scene.pipeline().nodes.iter().filter(gives).map(|entry| entry.name.clone()).collect()
    }

    /// Width and height of the picture of a node, in pixels. `None`: of the only one.
    pub fn size(&self, scene: &dyn Scene, node: Option<&str>) -> Result<[usize; 2]> {
        size_of(&self.graph_for(scene, &self.picture(scene, node)?, "image")?)
    }

    /// The graph that draws the picture of a node, which `None` leaves to be the only one, with its size.
    pub fn drawing(&self, scene: &dyn Scene, node: Option<&str>) -> Result<Drawing> {
        let name = self.picture(scene, node)?;
        let graph = self.graph_for(scene, &name, "image")?;
        Ok(Drawing { size: size_of(&graph)?, graph, name })
    }

    /// Draws.
    pub fn draw(
        &mut self,
        scene: &dyn Scene,
        drawing: &Drawing,
        observer: &dyn Observer,
    ) -> Result<Arc<Picture>> {
        let report = self.run(scene, &drawing.graph, observer)?;
        let picture = report.pictures.iter().find(|(name, _)| *name == drawing.name);
        let none = || Error::run("the node that draws gave no picture").at_node(&drawing.name);
        picture.map(|found| found.1.clone()).ok_or_else(none)
    }

    /// Draws, and hands the picture over: nothing here keeps it, so that the same one is drawn anew when it is asked for again.
    pub fn hand_over(
        &mut self,
        scene: &dyn Scene,
        drawing: &Drawing,
        observer: &dyn Observer,
    ) -> Result<Picture> {
        let picture = self.draw(scene, drawing, observer)?;
        self.runs.release(&picture);
        if let Some(report) = &mut self.last {
            report.pictures.clear();
        }
        Ok(Arc::unwrap_or_clone(picture))
    }

    /// Runs a graph of the pipeline, such as that of [`Session::whole`].
    pub fn run(&mut self, scene: &dyn Scene, graph: &Graph, observer: &dyn Observer) -> Result<&RunReport> {
        self.last = None;
        let report = self.runs.run(graph, observer).map_err(|error| scene.locate(error))?;
        let report = self.last.insert(report);
        report.nodes.retain(|node| node.node_type != TAKER.name);
        Ok(report)
    }

    /// What a node's output of a type carries. `asked`: what is asked of it, if it is a volume.
    pub fn value(
        &mut self,
        scene: &dyn Scene,
        (node, port): (&str, &str),
        asked: &Demand,
        observer: &dyn Observer,
    ) -> Result<Value> {
        let graph = self.graph_for(scene, node, port)?;
        let taker = graph.nodes.len() - 1;
        let fed = self.runs.feed(&graph, taker, asked, observer).map_err(|error| scene.locate(error))?;
        fed.0.into_iter().next().ok_or_else(|| Error::run("the node gave nothing").at_node(node))
    }

    /// Gives the graph of a node's picture, with what keeps the values that feed it, to work that no node does.
    pub fn with_graph<T>(
        &mut self,
        scene: &dyn Scene,
        node: &str,
        work: impl FnOnce(&Graph, &mut voltet_graph::Session) -> Result<T>,
    ) -> Result<T> {
        let graph = self.graph_for(scene, node, "image")?;
        work(&graph, &mut self.runs).map_err(|error| scene.locate(error))
    }

    /// The same with the graph of the whole pipeline.
    pub fn with_whole<T>(
        &mut self,
        scene: &dyn Scene,
        work: impl FnOnce(&Graph, &mut voltet_graph::Session) -> Result<T>,
    ) -> Result<T> {
        let graph = self.whole(scene)?;
        work(&graph, &mut self.runs).map_err(|error| scene.locate(error))
    }

    /// What plans say without data: errors, and warnings with their places.
    pub fn plan(&mut self, scene: &dyn Scene, graph: &Graph) -> Result<Vec<Error>> {
        self.runs.plan(graph).map_err(|error| scene.locate(error))?;
        Ok(graph.warnings.iter().map(|warning| scene.locate(warning.clone())).collect())
    }

    /// The report of the last run; `None` before there was one.
    pub fn last(&self) -> Option<&RunReport> {
        self.last.as_ref()
    }

    /// An account of the last run. `text`: what states the pipeline.
    pub fn account(&self, scene: &dyn Scene, text: String) -> Option<Account> {
        let run = RunReport { pictures: Vec::new(), ..self.last.clone()? };
        // No file is written by it, so that the places of its paths are of no use.
        let stated = ResolvedPipeline::new(scene.pipeline().title.clone(), text, std::iter::empty());
        Some(Account { path: scene.path().display().to_string(), stated, run })
    }
}

/// The node that is meant: the one that is named, else the only one that gives what is wanted.
fn only(named: Option<&str>, giving: &[String], what: &str) -> Result<String> {
    let accepted = || match giving {
        [] => format!("a pipeline with a node that gives a {what}"),
        names => format!("a node that gives a {what}: {}", names.join(", ")),
    };
    match (named, giving) {
        (Some(name), _) if giving.iter().any(|known| known == name) => Ok(name.into()),
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

/// The size that the camera states.
fn size_of(graph: &Graph) -> Result<[usize; 2]> {
    let gives_camera = |port: &Port| port.port_type == PortType::Camera;
    let camera = graph.nodes.iter().find(|node| node.node.outputs.iter().any(gives_camera));
    let none = || Error::usage("the pipeline has no camera").expected("a node of type \"camera\"");
    let size: [f64; 2] = camera.ok_or_else(none)?.parameters.vector("size")?;
    Ok(size.map(|side| side as usize))
}
