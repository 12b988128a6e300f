//! A pipeline that a program changes and draws: its nodes, the grids that the program gives, and what its runs leave.

use crate::structs::Camera;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::graph::{
    Datum, Given, Graph, LinkEntry, Node, NodeEntry, Observer, Origin, Port, PortType, Registry, RunReport,
    Setting, Stated, suggest,
};
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::pipeline::{Pipeline, locate, parameters};
use voltet_core::{Error, Result};
use voltet_document::links::upstream;
use voltet_nodes::given;
use voltet_nodes::provenance::{Source, run_report, whole_report};

/// The pipeline of a session that has loaded none.
const STANDARD: &str = include_str!("standard.toml");

/// What takes the picture: the run is made for it.
static TAKER: Node = Node {
    name: "taker",
    summary: "Takes a picture for the program.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    ..Node::BLANK
};

/// A pipeline and what lives longer than a picture of it.
pub(crate) struct Session {
    registry: Registry,
    runs: voltet_core::graph::Session,
    stated: Scene,
    /// The grids that stand in for nodes' own.
    grids: BTreeMap<String, Given>,
    last: Option<RunReport>,
}

/// What a pipeline states, with the texts that errors point at.
#[derive(Clone, Default)]
struct Scene {
    pipeline: Pipeline,
    folder: PathBuf,
    /// Its text, and what errors call it.
    text: String,
    path: PathBuf,
    /// The texts of nodes whose parameters were set by one.
    texts: BTreeMap<String, String>,
}

impl Session {
    /// With the standard pipeline.
    pub fn new() -> Result<Session> {
        let mut registry = voltet_nodes::registry()?;
        registry.add(&given::NODE)?;
        registry.add(&TAKER)?;
        let runs = voltet_nodes::session();
        let mut session =
            Session { registry, runs, stated: Scene::default(), grids: BTreeMap::new(), last: None };
        session.load(STANDARD.into(), Path::new("the standard pipeline"), Path::new(""))?;
        Ok(session)
    }

    /// Drops what runs left, with the open devices.
    pub fn begin_anew(&mut self) {
        (self.runs, self.last) = (voltet_nodes::session(), None);
    }

    /// Takes a pipeline file, or a picture that carries one.
    pub fn load_file(&mut self, path: &str) -> Result<()> {
        let path = Path::new(path);
        let folder = path.parent().unwrap_or(Path::new(""));
        self.load(Source::read(path)?.text, path, folder)
    }

    /// Takes the text of a pipeline. Grids that stood in for nodes of the former one are gone.
    pub fn load(&mut self, text: String, path: &Path, folder: &Path) -> Result<()> {
        let pipeline = Pipeline::parse(&text).map_err(|error| locate(error, &text, path))?;
        let texts = BTreeMap::new();
        let scene = Scene { pipeline, folder: folder.into(), text, path: path.into(), texts };
        self.take(scene)?;
        self.grids.clear();
        self.runs.forget();
        Ok(())
    }

    /// Carries out an option `node.parameter=value`.
    pub fn set(&mut self, option: &str) -> Result<()> {
        let mut scene = self.stated.clone();
        scene.pipeline.set(option)?;
        self.take(scene)
    }

    /// Gives a node the parameters that a text states, in place of all that it has.
    pub fn set_node(&mut self, name: &str, text: &str) -> Result<()> {
        let own = Path::new(name);
        let settings = parameters(text).map_err(|error| locate(error, text, own).at_node(name))?;
        let mut scene = self.stated.clone();
        let node = scene.node(name)?;
        node.settings = settings;
        // The text that errors point at is another now.
        node.origin = Origin::Nowhere;
        node.node_type.origin = Origin::Nowhere;
        for link in &mut node.inputs {
            link.origin = Origin::Nowhere;
            link.source = unplaced(&link.source);
        }
        scene.texts.insert(name.into(), text.into());
        self.take(scene)
    }

    /// Sets all parameters of a camera. `None`: of the only one.
    pub fn set_camera(&mut self, name: Option<&str>, camera: &Camera) -> Result<()> {
        let cameras = self.giving(PortType::Camera);
        let name = only(name, &cameras, "camera")?;
        let mut scene = self.stated.clone();
        let node = scene.node(&name)?;
        let list =
            |values: &[f64]| Datum::List(values.iter().map(|&value| Datum::Number(value).into()).collect());
        let up = if camera.up == [0.0; 3] { [0.0, 0.0, 1.0] } else { camera.up };
        let mut set = |name: &str, datum: Datum| node.set(name, &[], datum.into());
        set("eye", list(&camera.eye))?;
        set("target", list(&camera.target))?;
        set("up", list(&up))?;
        set("near", Datum::Number(camera.near_plane))?;
        set("samples", Datum::Integer(i64::from(camera.samples.max(1))))?;
        if camera.pixels != [0, 0] {
            let sides = camera.pixels.map(|side| Datum::Integer(i64::from(side)).into());
            set("size", Datum::List(sides.to_vec()))?;
        }
        node.settings.retain(|field| !["fov_y", "height"].contains(&field.name.as_str()));
        for (name, value) in [("fov_y", camera.fov_y), ("height", camera.height)] {
            if value != 0.0 {
                node.set(name, &[], Datum::Number(value).into())?;
            }
        }
        self.take(scene)
    }

    /// Puts a grid in place of what a node reads or makes, or takes it away. `None`: of the only such node.
    pub fn set_grid(&mut self, name: Option<&str>, grid: Option<&Arc<Grid>>) -> Result<()> {
        let sources: Vec<String> = self.giving(PortType::Grid);
        let name = only(name, &sources, "grid")?;
        let mut entry = self.stated.clone().node(&name)?.clone();
        given::stand_in(&mut entry, &self.registry)?;
        match grid {
            Some(grid) => self.grids.insert(name, given::grid(grid.clone())),
            None => self.grids.remove(&name),
        };
        // Whoever lent the former one waits for it.
        self.runs.forget();
        Ok(())
    }

    /// Width and height of the picture of a node, in pixels. `None`: of the only one.
    pub fn size(&self, node: Option<&str>) -> Result<[usize; 2]> {
        size_of(&self.graph(&self.picture(node)?)?)
    }

    /// The graph that draws the picture of a node, which `None` leaves to be the only one, with its size.
    pub fn drawing(&self, node: Option<&str>) -> Result<Drawing> {
        let name = self.picture(node)?;
        let graph = self.graph(&name)?;
        Ok(Drawing { size: size_of(&graph)?, graph, name })
    }

    /// Draws.
    pub fn draw(&mut self, drawing: &Drawing, observer: &dyn Observer) -> Result<Arc<Picture>> {
        self.last = None;
        let report = self.runs.run(&drawing.graph, observer).map_err(|error| self.stated.locate(error))?;
        let picture =
            report.pictures.iter().find(|(name, _)| *name == drawing.name).map(|found| found.1.clone());
        let report = self.last.insert(report);
        report.nodes.retain(|node| node.node_type != TAKER.name);
        picture.ok_or_else(|| Error::run("the node that draws gave no picture").at_node(&drawing.name))
    }

    /// The report of the last picture, JSON.
    pub fn report(&self) -> Result<String> {
        let pipeline = self.stated.pipeline.to_string();
        let stated = Pipeline::stated(pipeline.clone(), &self.registry).unwrap_or_else(|_| {
            // It writes nothing, as none need here.
            let mut stated = Stated::default();
            (stated.title, stated.text) = (self.stated.pipeline.title.clone(), pipeline);
            stated
        });
        let path = self.stated.path.display().to_string();
        Ok(format!("{:#}", whole_report(vec![run_report(&path, self.last()?, &stated)])))
    }

    /// The warnings of the last picture, a line each.
    pub fn warnings(&self) -> Result<String> {
        Ok(self.last()?.warnings.join("\n"))
    }

    fn last(&self) -> Result<&RunReport> {
        let nothing = || Error::usage("nothing has been drawn").accepted("voltet_render before it");
        self.last.as_ref().ok_or_else(nothing)
    }

    /// Takes what is stated where nothing is wrong with it.
    fn take(&mut self, scene: Scene) -> Result<()> {
        match Graph::faults(&scene.pipeline.nodes, &self.registry).into_iter().next() {
            Some(fault) => Err(scene.locate(fault.error)),
            None => {
                self.stated = scene;
                Ok(())
            }
        }
    }

    /// The names of the nodes that give something, in the order of the pipeline.
    fn giving(&self, wanted: PortType) -> Vec<String> {
        let gives = |entry: &&NodeEntry| {
            let node = entry.node_type.text().and_then(|name| self.registry.find(name).ok());
            node.is_some_and(|node| node.outputs.iter().any(|port| port.port_type == wanted))
        };
        self.stated.pipeline.nodes.iter().filter(gives).map(|entry| entry.name.clone()).collect()
    }

    fn picture(&self, node: Option<&str>) -> Result<String> {
        only(node, &self.giving(PortType::Image), "picture")
    }

    /// The nodes that a picture needs, and no others.
    fn graph(&self, picture: &str) -> Result<Graph> {
        let nodes = &self.stated.pipeline.nodes;
        let needed = upstream(nodes, picture);
        let mut entries: Vec<NodeEntry> =
            nodes.iter().filter(|entry| needed.contains(&entry.name)).cloned().collect();
        for entry in entries.iter_mut().filter(|entry| self.grids.contains_key(&entry.name)) {
            given::stand_in(entry, &self.registry)?;
        }
        let text = |text: &str| Setting::from(Datum::Text(text.into()));
        entries.push(NodeEntry {
            name: "(the program)".into(),
            origin: Origin::Nowhere,
            node_type: text(TAKER.name),
            settings: Vec::new(),
            inputs: vec![LinkEntry { port: "image".into(), origin: Origin::Nowhere, source: text(picture) }],
        });
        let graph = Graph::build(&entries, &self.registry, self.stated.folder.clone());
        let mut graph = graph.map_err(|error| self.stated.locate(error))?;
        for (name, given) in self.grids.iter().filter(|(name, _)| needed.contains(*name)) {
            graph.give(name, given.clone())?;
        }
        Ok(graph)
    }
}

/// What draws one picture.
pub(crate) struct Drawing {
    graph: Graph,
    name: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

impl Scene {
    fn node(&mut self, name: &str) -> Result<&mut NodeEntry> {
        let names: Vec<String> = self.pipeline.nodes.iter().map(|node| node.name.clone()).collect();
        self.pipeline.nodes.iter_mut().find(|node| node.name == name).ok_or_else(|| {
            let error = Error::usage(format!("there is no node '{name}'"));
            error.accepted(suggest(name, names.iter().map(String::as_str)))
        })
    }

    /// Completes an error with the text that it points at, its line and its column.
    fn locate(&self, error: Error) -> Error {
        let of_node = error.place.node.as_ref().and_then(|name| self.texts.get_key_value(name));
        match of_node {
            Some((name, text)) if error.place.span.is_some() => locate(error, text, Path::new(name)),
            _ => locate(error, &self.text, &self.path),
        }
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
            Err(Error::usage(format!("the node '{name}' gives no {what}")).accepted(accepted()))
        }
        (None, [one]) => Ok(one.clone()),
        (None, []) => Err(Error::usage(format!("the pipeline has no {what}")).accepted(accepted())),
        (None, _) => Err(Error::usage(format!("the pipeline has several nodes that give a {what}"))
            .found("none named")
            .accepted(accepted())),
    }
}

/// The size that the camera states.
fn size_of(graph: &Graph) -> Result<[usize; 2]> {
    let gives_camera = |port: &Port| port.port_type == PortType::Camera;
    let camera = graph.nodes.iter().find(|node| node.node.outputs.iter().any(gives_camera));
    let none = || Error::usage("the pipeline has no camera").accepted("a node of type \"camera\"");
    let size: [f64; 2] = camera.ok_or_else(none)?.parameters.vector("size")?;
    Ok(size.map(|side| side as usize))
}

/// The same without the place where it was written.
fn unplaced(setting: &Setting) -> Setting {
    let datum = match &setting.datum {
        Datum::List(list) => Datum::List(list.iter().map(unplaced).collect()),
        other => other.clone(),
    };
    datum.into()
}
