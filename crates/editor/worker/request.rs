//! Requests to the worker: nodes as a document states them, and the output to show.

use super::query::QueryRun;
use super::values;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_document::links::{self, upstream};
use voltet_graph::{Demand, Field, Graph, Node, NodeEntry, ParameterValue, Registry, RunReport, Value};

/// The node type that says where a picture is seen from, and its parameters that coarse pictures change.
const CAMERA: &str = "camera";
const SIZE: &str = "size";
const SAMPLES: &str = "samples";

/// A picture that is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderRequest {
    /// The nodes of the document; those that do not feed the picture are of no account, even broken.
    pub nodes: Vec<NodeEntry>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// The node whose picture it is.
    pub node: String,
    /// The full picture's width and height; `None`: as the camera says.
    pub size: Option<[u32; 2]>,
    /// Linear RGB behind it.
    pub background: [f64; 3],
    /// True if a picture of fewer pixels is shown while the full one is drawn.
    pub coarse_first: bool,
}

impl RenderRequest {
    /// The names of the nodes that feed the picture, and its own.
    pub fn upstream(&self) -> BTreeSet<String> {
        upstream(&self.nodes, &self.node)
    }

    /// The nodes that say where it is seen from.
    pub(super) fn cameras(&self) -> Vec<NodeEntry> {
        let names = self.upstream();
        self.nodes.iter().filter(|node| is_camera(node) && names.contains(&node.name)).cloned().collect()
    }

    /// Pixels of the full picture, as far as the document says.
    pub(super) fn pixels(&self) -> f64 {
        let size = self.size.or_else(|| self.cameras().iter().find_map(size_of));
        size.map_or(786_432.0, |[width, height]| f64::from(width) * f64::from(height))
    }

    /// By how much the sides of the picture are divided where so many pixels are enough.
    pub(super) fn divisor_for(&self, enough: f64) -> u32 {
        (self.pixels() / enough).sqrt().ceil().max(1.0) as u32
    }

    /// True if the node takes negligible time: the rest of a run is drawing.
    pub(super) fn is_cheap(&self, name: &str) -> bool {
        const QUICK: [&str; 8] =
            [CAMERA, "transfer-function", "cull", "sort", "project", "composite", "renderer", "gpu-renderer"];
        let node = self.nodes.iter().find(|node| node.name == name);
        node.is_none_or(|node| node.node_type.text().is_some_and(|text| QUICK.contains(&text)))
    }

    /// The graph that makes the picture and nothing else; `divisor`: by how much its sides are divided.
    pub(super) fn graph(&self, registry: &Registry, divisor: u32) -> Result<Graph> {
        let mut nodes = feeding(&self.nodes, &self.node)?;
        let mut outputs = Vec::new();
        for node in &mut nodes {
            if is_camera(node) {
                resize(node, self.size, divisor)?;
            }
            let node_type = node.node_type.text().and_then(|name| registry.find(name).ok());
            if let Some(node_type) = node_type.filter(|_| !node.name.contains('.')) {
                // Each with the input of its type.
                outputs.extend(
                    node_type.outputs.iter().map(|port| {
                        (port.port_type.name().to_string(), format!("{}.{}", node.name, port.name))
                    }),
                );
            }
        }
        nodes.push(values::entry(&values::NODE, Vec::new(), outputs));
        Graph::build(&nodes, registry, self.folder.clone())
    }

    /// The picture that a run gave.
    pub(super) fn picture_of(&self, report: &RunReport) -> Result<Arc<Picture>> {
        let picture = report.pictures.iter().rev().find(|(node, _)| *node == self.node);
        picture.map(|(_, picture)| picture.clone()).ok_or_else(|| self.no_picture())
    }

    pub(super) fn no_picture(&self) -> Error {
        Error::run("the node gives no picture").at_node(&self.node)
    }
}

/// The nodes that feed one, and it; in the order of the document.
pub(super) fn feeding(nodes: &[NodeEntry], name: &str) -> Result<Vec<NodeEntry>> {
    match links::feeding(nodes, name) {
        none if none.is_empty() => {
            Err(Error::usage(format!("there is no node '{name}' to show the picture of")))
        }
        nodes => Ok(nodes),
    }
}

/// An output of a document's nodes that gives a volume.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VolumeSource {
    /// Nodes of the document, as of [`RenderRequest::nodes`].
    pub nodes: Vec<NodeEntry>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// `"node"` or `"node.port"`.
    pub output: String,
}

impl VolumeSource {
    /// The nodes that feed the volume and other outputs, each a port's name and `"node.port"`, to a node of the worker's, which is
    /// the last one.
    pub(super) fn nodes(
        &self,
        node: &Node,
        settings: Vec<Field>,
        others: Vec<(String, String)>,
    ) -> Result<Vec<NodeEntry>> {
        let fed: Vec<_> =
            std::iter::once(("volume".to_string(), self.output.clone())).chain(others).collect();
        let mut nodes: Vec<NodeEntry> = Vec::new();
        for (_, source) in &fed {
            for node in feeding(&self.nodes, links::source(source, &self.nodes).0)? {
                if !nodes.iter().any(|known| known.name == node.name) {
                    nodes.push(node);
                }
            }
        }
        nodes.push(values::entry(node, settings, fed));
        Ok(nodes)
    }

    /// The values that feed the last of the nodes, with *g* where there is a gradient.
    pub(super) fn feed(&self, run: &mut QueryRun, nodes: &[NodeEntry]) -> Result<Vec<Value>> {
        let graph = Graph::build(nodes, run.registry, self.folder.clone())?;
        let of_volumes = Demand { gradient_magnitude: true, ..Demand::default() };
        run.session.inputs(&graph, graph.nodes.len() - 1, &of_volumes, run.observer)
    }

    /// The volume with arrays, and with *g* where what feeds it has a gradient.
    pub(super) fn volume(&self, run: &mut QueryRun, arrays: &[&String]) -> Result<Arc<Volume>> {
        let arrays: ParameterValue = arrays.iter().map(|name| name.as_str()).collect();
        let nodes = self.nodes(&values::NODE, vec![Field::new(values::ARRAYS, arrays)], Vec::new())?;
        let found = self.feed(run, &nodes)?;
        let none = || Error::run("the node gives no volume").at_node(&self.output);
        found.first().and_then(Value::volume).ok_or_else(none)?
    }
}

fn is_camera(node: &NodeEntry) -> bool {
    node.node_type.text() == Some(CAMERA)
}

/// Width and height that a camera node states.
pub(crate) fn size_of(node: &NodeEntry) -> Option<[u32; 2]> {
    let Some(stated) = node.setting(SIZE) else { return Some([1024, 768]) };
    match stated.array()? {
        [width, height] if width >= 1.0 && height >= 1.0 => Some([width as u32, height as u32]),
        _ => None,
    }
}

/// Gives a camera fewer pixels. A size that is wrong is left for the checker to find.
fn resize(node: &mut NodeEntry, size: Option<[u32; 2]>, divisor: u32) -> Result<()> {
    let Some(own) = size_of(node) else { return Ok(()) };
    let whole = size.unwrap_or(own);
    if whole == own && divisor == 1 {
        return Ok(());
    }
    let side = |side: u32| ParameterValue::Integer(i64::from(side.div_ceil(divisor).max(1)));
    node.set(SIZE, &[], whole.map(side).into_iter().collect::<ParameterValue>().into())?;
    if divisor > 1 && node.setting(SAMPLES).is_some() {
        node.set(SAMPLES, &[], ParameterValue::Integer(1).into())?;
    }
    Ok(())
}
