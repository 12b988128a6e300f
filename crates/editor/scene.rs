//! Read-only view of the editor for the window's parts while a frame is shown.

use crate::arrays::Arrays;
use crate::view::View;
use crate::worker::{Distribution, NodeStatus, PixelProbe, Pixels, Section, Share};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_document::Document;
use voltet_graph::{Node, NodeEntry, PortType, Registry, RunReport};

/// One frame's view of everything.
pub(crate) struct Scene<'a> {
    pub document: &'a Document,
    pub registry: &'a Registry,
    /// The arrays that files hold.
    pub arrays: &'a Arrays,
    pub selection: &'a BTreeSet<String>,
    /// The node whose picture is shown.
    pub shown_node: Option<&'a str>,
    /// View of that picture.
    pub view: Option<View>,
    /// Its size as the document says.
    pub picture_size: Option<[u32; 2]>,
    pub pixels: Option<Pixels>,
    /// Small pictures of other nodes.
    pub previews: BTreeMap<String, Pixels>,
    /// True if a question must be answered first, and other input is blocked.
    pub asks: bool,
    /// The nodes that feed the picture.
    pub nodes: BTreeMap<String, NodeStatus>,
    /// For each output what runs through it.
    pub values: Arc<BTreeMap<String, String>>,
    pub failure: Option<Error>,
    /// Description of the work in progress.
    pub running: Option<String>,
    pub seconds: Option<f64>,
    /// The distribution of what the selected transfer function is drawn with.
    pub distribution: Option<Arc<Distribution>>,
    /// Reason why there is none.
    pub distribution_fault: Option<Error>,
    /// Result of the last probe of the picture.
    pub probed: Option<Arc<PixelProbe>>,
    /// Contribution of the selected widget to the picture, or an error message; `None` while unknown.
    pub share: Option<Result<Share>>,
    /// Section of the data by the plane.
    pub section: Option<Result<Arc<Section>>>,
    /// The last full run.
    pub report: Option<Arc<RunReport>>,
    /// Estimated error of the picture, if requested.
    pub estimate: Option<Result<[f64; 2]>>,
    /// True while the error is being estimated.
    pub is_estimating: bool,
    /// Faults of the document, each with the node that it concerns.
    pub faults: &'a [Error],
    /// The document's nodes by name: looked up for every port and wire of a frame.
    pub entries: HashMap<&'a str, &'a NodeEntry>,
}

impl<'a> Scene<'a> {
    /// The node of that name.
    pub fn entry(&self, name: &str) -> Option<&'a NodeEntry> {
        self.entries.get(name).copied()
    }

    /// True if the document has no nodes.
    pub fn is_empty(&self) -> bool {
        self.document.pipeline().nodes.is_empty() && self.document.is_toml()
    }

    /// The type of a node, where it is known.
    pub fn node_type(&self, entry: &NodeEntry) -> Option<&'static Node> {
        self.registry.find(entry.node_type.text()?).ok()
    }

    /// The names of the nodes that give pictures.
    pub fn pictures(&self) -> Vec<&'a str> {
        pictures(self.document, self.registry)
    }
}

/// The names of the nodes that give pictures, in the order of the document.
pub(crate) fn pictures<'a>(document: &'a Document, registry: &Registry) -> Vec<&'a str> {
    let gives = |node: &&NodeEntry| {
        let node_type = node.node_type.text().and_then(|name| registry.find(name).ok());
        node_type.is_some_and(|node| node.outputs.iter().any(|port| port.port_type == PortType::Image))
    };
    document.pipeline().nodes.iter().filter(gives).map(|node| node.name.as_str()).collect()
}
