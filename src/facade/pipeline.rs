//! Pipelines: a file or text that is changed, given in-memory grids, and rendered.

use super::camera::Camera;
use super::grid::Grid;
use super::image::Image;
use super::session::{PipelineSource, RenderPlan, Session};
use crate::document::Document;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::camera::Projection;
use voltet_core::grid::Grid as BuiltGrid;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::{Pipeline as Nodes, locate, parameters};
use voltet_graph::{
    Graph, LocatedValue, NoObserver, NodeEntry, Observer, ParameterValue, Registry, SourceSpan, suggest,
};
use voltet_io::encode::Source;
use voltet_io::provenance::whole_report;

/// A pipeline that a program changes and renders. Values of nodes that a change does not concern are kept between renders.
pub struct Pipeline {
    session: Session,
    text: Text,
}

/// Nodes of a pipeline, with the texts that errors point at.
#[derive(Clone, Default)]
struct Text {
    nodes: Nodes,
    folder: PathBuf,
    /// Its text, and the name of it in errors.
    text: String,
    path: PathBuf,
    /// Texts of the nodes whose parameters were set by one.
    node_texts: BTreeMap<String, String>,
}

impl Pipeline {
    /// An empty pipeline of these node types and filters.
    ///
    /// # Errors
    /// - a registry that has nodes of the facade's own.
    pub fn new(registry: Registry) -> Result<Pipeline> {
        Ok(Pipeline { session: Session::new(registry)?, text: Text::default() })
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
        let node_texts = BTreeMap::new();
        self.replace(Text { nodes, folder: folder.into(), text, path: path.into(), node_texts })?;
        self.session.clear_grids();
        Ok(())
    }

    /// Carries out an option `node.parameter=value`, as `--set` does.
    ///
    /// # Errors
    /// - a node or parameter that does not exist, a value that is refused.
    pub fn set(&mut self, option: &str) -> Result<()> {
        let mut text = self.text.clone();
        text.nodes.set(option)?;
        self.replace(text)
    }

    /// Sets parameters of a node; `None` removes one.
    ///
    /// # Errors
    /// As of [`Pipeline::set`].
    pub fn set_parameters(&mut self, node: &str, values: Vec<(&str, Option<ParameterValue>)>) -> Result<()> {
        let mut text = self.text.clone();
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
        let mut text = self.text.clone();
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
        let size = camera.size.map(|side| ParameterValue::Integer(side.into()).into()).to_vec();
        let values = vec![
            ("eye", Some(numbers(&camera.eye.to_array()))),
            ("target", Some(numbers(&camera.target.to_array()))),
            ("up", Some(numbers(&camera.up.to_array()))),
            ("near", Some(ParameterValue::Number(camera.near))),
            ("samples", Some(ParameterValue::Integer(camera.samples.into()))),
            ("size", Some(ParameterValue::List(size))),
            ("fov_y", fov_y),
            ("height", height),
        ];
        self.set_parameters(&name, values)
    }

    /// Replaces the output of a node that reads or makes a grid by a grid in memory.
    ///
    /// # Errors
    /// - no such node;
    /// - those of [`Grid::build`].
    pub fn with_grid(mut self, node: &str, grid: impl Into<Grid>) -> Result<Pipeline> {
        let grid = grid.into().build(None, &NoProgress)?;
        self.set_grid(Some(node), Some(&grid))?;
        Ok(self)
    }

    /// Replaces the output of a node by a grid that is built, or ends that. `node` is `None`: the only one with a grid.
    ///
    /// # Errors
    /// - no such node.
    pub fn set_grid(&mut self, node: Option<&str>, grid: Option<&Arc<BuiltGrid>>) -> Result<()> {
        self.session.set_grid(&self.text, node, grid)
    }

    /// Name of a camera node: the named one, else the only one.
    ///
    /// # Errors
    /// - no such node.
    pub fn camera_node(&self, node: Option<&str>) -> Result<String> {
        self.session.camera(&self.text, node)
    }

    /// Width and height of the picture of a node (pixels). `node` is `None`: the only one.
    ///
    /// # Errors
    /// - no such node, or a pipeline that cannot run.
    pub fn size(&self, node: Option<&str>) -> Result<[usize; 2]> {
        self.session.size(&self.text, node)
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

    /// Graph that renders the picture of a node. `node` is `None`: the only one with a picture.
    ///
    /// # Errors
    /// - no such node, or a pipeline that cannot run.
    pub fn render_plan(&self, node: Option<&str>) -> Result<RenderPlan> {
        self.session.render_plan(&self.text, node)
    }

    /// Renders by a plan, and reports progress to an observer, which may cancel.
    ///
    /// # Errors
    /// - those of the nodes, and cancellation.
    pub fn render_with(&mut self, plan: &RenderPlan, observer: &dyn Observer) -> Result<Arc<Picture>> {
        self.session.render(&self.text, plan, observer)
    }

    /// Runs the whole pipeline with its writers, and returns the pictures by node.
    ///
    /// # Errors
    /// - an output that is an input, or another output;
    /// - those of the nodes, and cancellation.
    pub fn run(&mut self, observer: &dyn Observer) -> Result<Vec<(String, Image)>> {
        let graph = self.session.whole_graph(&self.text)?;
        let (path, text, pipeline) =
            (self.text.path.clone(), self.text.text.clone(), self.text.nodes.clone());
        let document = Document { path, text, pipeline, graph, carried: None };
        document.refuse_collisions()?;
        let report = self.session.run(&self.text, &document.graph, observer)?;
        Ok(report.pictures.iter().map(|(name, picture)| (name.clone(), picture.clone().into())).collect())
    }

    /// Report of the last run (JSON); `None` before there was one.
    pub fn report(&self) -> Option<String> {
        let record = self.session.record(&self.text, self.text.nodes.to_string())?;
        Some(format!("{:#}", whole_report(vec![record.to_json()])))
    }

    /// Warnings of the last run; `None` before there was one.
    pub fn warnings(&self) -> Option<&[String]> {
        self.session.last().map(|report| report.warnings.as_slice())
    }

    /// Drops kept values and open devices, as after a panic.
    pub fn reset(&mut self) {
        self.session.reset();
    }

    /// Takes over a changed text if it is sound.
    fn replace(&mut self, text: Text) -> Result<()> {
        match Graph::faults(&text.nodes.nodes, self.session.registry()).into_iter().next() {
            Some(fault) => Err(text.locate(fault.error)),
            None => {
                self.text = text;
                Ok(())
            }
        }
    }
}

impl Text {
    fn node(&mut self, name: &str) -> Result<&mut NodeEntry> {
        let names: Vec<String> = self.nodes.nodes.iter().map(|node| node.name.clone()).collect();
        self.nodes.nodes.iter_mut().find(|node| node.name == name).ok_or_else(|| {
            let error = Error::usage(format!("there is no node '{name}'"));
            error.expected(suggest(name, names.iter().map(String::as_str)))
        })
    }
}

impl PipelineSource for Text {
    fn pipeline(&self) -> &Nodes {
        &self.nodes
    }

    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }

    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    fn locate(&self, error: Error) -> Error {
        let of_node = error.location.node.as_ref().and_then(|name| self.node_texts.get_key_value(name));
        match of_node {
            Some((name, text)) if error.location.span.is_some() => locate(error, text, Path::new(name)),
            _ => locate(error, &self.text, &self.path),
        }
    }
}

/// A list of numbers as the value of a parameter.
fn numbers(values: &[f64]) -> ParameterValue {
    ParameterValue::List(values.iter().map(|&value| ParameterValue::Number(value).into()).collect())
}

/// The setting without its location in a text.
fn without_span(setting: &LocatedValue) -> LocatedValue {
    let datum = match &setting.datum {
        ParameterValue::List(list) => ParameterValue::List(list.iter().map(without_span).collect()),
        other => other.clone(),
    };
    datum.into()
}
