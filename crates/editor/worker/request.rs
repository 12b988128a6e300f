//! Request to the worker: nodes as a document states them, and the output to show.

use super::preview_observer::{NAME, entry, feeding};
use std::collections::BTreeSet;
use std::path::PathBuf;
use voltet_core::Result;
use voltet_document::links::upstream;
use voltet_graph::{Graph, LocatedValue, Node, NodeEntry, ParameterValue, Registry};

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
        let size = self.size.or_else(|| self.upstream().iter().find_map(|name| self.camera_size(name)));
        size.map_or(786_432.0, |[width, height]| f64::from(width) * f64::from(height))
    }

    fn camera_size(&self, name: &str) -> Option<[u32; 2]> {
        let node = self.nodes.iter().find(|node| node.name == name && is_camera(node))?;
        size_of(node)
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
        let mut looked_at = Vec::new();
        for node in &mut nodes {
            if is_camera(node) {
                resize(node, self.size, divisor)?;
            }
            let node_type = node.node_type.text().and_then(|name| registry.find(name).ok());
            if let Some(node_type) = node_type.filter(|_| !node.name.contains('.')) {
                looked_at.extend(outputs(node, node_type));
            }
        }
        nodes.push(entry(NAME, looked_at.into_iter()));
        Graph::build(&nodes, registry, self.folder.clone())
    }
}

/// The outputs of a node, each with the port of its type at the node that looks on.
fn outputs(entry: &NodeEntry, node: &'static Node) -> Vec<(String, String)> {
    let output = |port: &voltet_graph::Port| {
        (port.port_type.name().to_string(), format!("{}.{}", entry.name, port.name))
    };
    node.outputs.iter().map(output).collect()
}

fn is_camera(node: &NodeEntry) -> bool {
    node.node_type.text() == Some(CAMERA)
}

/// Width and height that a camera node states.
pub(crate) fn size_of(node: &NodeEntry) -> Option<[u32; 2]> {
    let field = node.settings.iter().find(|field| field.name == SIZE);
    let Some(field) = field else { return Some([1024, 768]) };
    match field.setting.numbers()?[..] {
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
    let sides = whole
        .map(|side| LocatedValue::from(ParameterValue::Integer(i64::from(side.div_ceil(divisor).max(1)))));
    node.set(SIZE, &[], ParameterValue::List(sides.to_vec()).into())?;
    if divisor > 1 && node.settings.iter().any(|field| field.name == SAMPLES) {
        node.set(SAMPLES, &[], ParameterValue::Integer(1).into())?;
    }
    Ok(())
}
