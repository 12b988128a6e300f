//! A pipeline that a program changes and draws: its nodes, the grids that the program gives, and what its runs leave.

use crate::structs::Camera;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_embed::{Drawing, Scene};
use voltet_graph::pipeline::{Pipeline, locate, parameters};
use voltet_graph::{Graph, LocatedValue, NodeEntry, Observer, ParameterValue, SourceSpan, suggest};
use voltet_io::provenance::{Source, whole_report};

/// The pipeline of a session that has loaded none.
const STANDARD: &str = include_str!("standard.toml");

/// A pipeline and what lives longer than a picture of it.
pub(crate) struct Session {
    runs: voltet_embed::Session,
    stated: Stated,
}

/// What a pipeline states, with the texts that errors point at.
#[derive(Clone, Default)]
struct Stated {
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
        let runs = voltet_embed::Session::new(voltet_nodes::registry()?)?;
        let mut session = Session { runs, stated: Stated::default() };
        session.load(STANDARD.into(), Path::new("the standard pipeline"), Path::new(""))?;
        Ok(session)
    }

    /// Drops what runs left, with the open devices.
    pub fn begin_anew(&mut self) {
        self.runs.begin_anew();
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
        let scene = Stated { pipeline, folder: folder.into(), text, path: path.into(), texts };
        self.take(scene)?;
        self.runs.give_none();
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
        node.origin = SourceSpan::Nowhere;
        node.node_type.origin = SourceSpan::Nowhere;
        for link in &mut node.inputs {
            link.origin = SourceSpan::Nowhere;
            link.source = unplaced(&link.source);
        }
        scene.texts.insert(name.into(), text.into());
        self.take(scene)
    }

    /// Sets all parameters of a camera. `None`: of the only one.
    pub fn set_camera(&mut self, name: Option<&str>, camera: &Camera) -> Result<()> {
        let name = self.runs.camera(&self.stated, name)?;
        let mut scene = self.stated.clone();
        let node = scene.node(&name)?;
        let list = |values: &[f64]| {
            ParameterValue::List(values.iter().map(|&value| ParameterValue::Number(value).into()).collect())
        };
        let up = if camera.up == [0.0; 3] { [0.0, 0.0, 1.0] } else { camera.up };
        let mut set = |name: &str, datum: ParameterValue| node.set(name, &[], datum.into());
        set("eye", list(&camera.eye))?;
        set("target", list(&camera.target))?;
        set("up", list(&up))?;
        set("near", ParameterValue::Number(camera.near_plane))?;
        set("samples", ParameterValue::Integer(i64::from(camera.samples.max(1))))?;
        if camera.pixels != [0, 0] {
            let sides = camera.pixels.map(|side| ParameterValue::Integer(i64::from(side)).into());
            set("size", ParameterValue::List(sides.to_vec()))?;
        }
        node.settings.retain(|field| !["fov_y", "height"].contains(&field.name.as_str()));
        for (name, value) in [("fov_y", camera.fov_y), ("height", camera.height)] {
            if value != 0.0 {
                node.set(name, &[], ParameterValue::Number(value).into())?;
            }
        }
        self.take(scene)
    }

    /// Puts a grid in place of what a node reads or makes, or takes it away. `None`: of the only such node.
    pub fn set_grid(&mut self, name: Option<&str>, grid: Option<&Arc<Grid>>) -> Result<()> {
        self.runs.give(&self.stated, name, grid)
    }

    /// Width and height of the picture of a node, in pixels. `None`: of the only one.
    pub fn size(&self, node: Option<&str>) -> Result<[usize; 2]> {
        self.runs.size(&self.stated, node)
    }

    /// The graph that draws the picture of a node, which `None` leaves to be the only one, with its size.
    pub fn drawing(&self, node: Option<&str>) -> Result<Drawing> {
        self.runs.drawing(&self.stated, node)
    }

    /// Draws.
    pub fn draw(&mut self, drawing: &Drawing, observer: &dyn Observer) -> Result<Arc<Picture>> {
        self.runs.draw(&self.stated, drawing, observer)
    }

    /// The report of the last picture, JSON.
    pub fn report(&self) -> Result<String> {
        let account = self.runs.account(&self.stated, self.stated.pipeline.to_string());
        Ok(format!("{:#}", whole_report(vec![account.ok_or_else(nothing)?.words()])))
    }

    /// The warnings of the last picture, a line each.
    pub fn warnings(&self) -> Result<String> {
        Ok(self.runs.last().ok_or_else(nothing)?.warnings.join("\n"))
    }

    /// Takes what is stated where nothing is wrong with it.
    fn take(&mut self, scene: Stated) -> Result<()> {
        match Graph::faults(&scene.pipeline.nodes, self.runs.registry()).into_iter().next() {
            Some(fault) => Err(scene.locate(fault.error)),
            None => {
                self.stated = scene;
                Ok(())
            }
        }
    }
}

impl Stated {
    fn node(&mut self, name: &str) -> Result<&mut NodeEntry> {
        let names: Vec<String> = self.pipeline.nodes.iter().map(|node| node.name.clone()).collect();
        self.pipeline.nodes.iter_mut().find(|node| node.name == name).ok_or_else(|| {
            let error = Error::usage(format!("there is no node '{name}'"));
            error.expected(suggest(name, names.iter().map(String::as_str)))
        })
    }
}

impl Scene for Stated {
    fn pipeline(&self) -> &Pipeline {
        &self.pipeline
    }

    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }

    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    fn locate(&self, error: Error) -> Error {
        let of_node = error.location.node.as_ref().and_then(|name| self.texts.get_key_value(name));
        match of_node {
            Some((name, text)) if error.location.span.is_some() => locate(error, text, Path::new(name)),
            _ => locate(error, &self.text, &self.path),
        }
    }
}

/// The error where no report is.
fn nothing() -> Error {
    Error::usage("nothing has been drawn").expected("voltet_render before it")
}

/// The same without the place where it was written.
fn unplaced(setting: &LocatedValue) -> LocatedValue {
    let datum = match &setting.datum {
        ParameterValue::List(list) => ParameterValue::List(list.iter().map(unplaced).collect()),
        other => other.clone(),
    };
    datum.into()
}
