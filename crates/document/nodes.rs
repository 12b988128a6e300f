//! Nodes added to a document: node types by kind and by search text, ports that can be joined; copies of nodes, as TOML text, which
//! pastes into a text file as well as into another window.

use crate::document::free_name;
use crate::edit::Edit;
use crate::{Document, links};
use std::collections::BTreeSet;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{Node, NodeEntry, Port, PortType, Registry};

/// A kind of node types, for a menu, in the order in which data runs through them; told from the ports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// Readers and other sources of grids.
    Sources,
    /// Filters of grids and volumes.
    Filters,
    /// Makers of surfaces.
    Surfaces,
    /// Findings about data: statistics, probes.
    Findings,
    /// Transfer functions.
    TransferFunctions,
    /// Cameras.
    Cameras,
    /// Renderers of whole pictures.
    Drawing,
    /// Stages of drawing: culling, sorting, projection, compositing.
    Stages,
    /// Writers of files.
    Writers,
}

impl Group {
    /// The kind of a node type.
    pub fn from_node(node: &Node) -> Group {
        let gives = |wanted: PortType| node.outputs.iter().any(|port| port.port_type == wanted);
        let takes = |wanted: PortType| node.inputs.iter().any(|port| port.port_type == wanted);
        let is_stage = |wanted| gives(wanted) || takes(wanted);
        if node.outputs.is_empty() {
            Group::Writers
        } else if gives(PortType::TransferFunction) {
            Group::TransferFunctions
        } else if gives(PortType::Camera) {
            Group::Cameras
        } else if is_stage(PortType::Cells) || is_stage(PortType::Projection) {
            Group::Stages
        } else if gives(PortType::Surface) {
            Group::Surfaces
        } else if gives(PortType::Report) || node.finds {
            Group::Findings
        } else if gives(PortType::Image) {
            Group::Drawing
        } else if node.inputs.is_empty() {
            Group::Sources
        } else {
            Group::Filters
        }
    }

    /// The name in a menu.
    pub fn name(self) -> &'static str {
        match self {
            Group::Sources => "data",
            Group::Filters => "filters",
            Group::Surfaces => "surfaces",
            Group::TransferFunctions => "transfer functions",
            Group::Cameras => "cameras",
            Group::Drawing => "drawing",
            Group::Stages => "drawing, stage by stage",
            Group::Findings => "findings",
            Group::Writers => "writers",
        }
    }
}

/// A node type and one of its ports.
#[derive(Debug, Clone, Copy)]
pub struct Fitting {
    /// The type.
    pub node: &'static Node,
    /// The port that fits.
    pub port: &'static Port,
}

/// The node types whose name, summary or parameters have all words of a text, the best first: whose name begins with it, whose name has it,
/// whose summary has it, then the rest. All types for an empty text, in the order of the registry.
pub fn search(registry: &Registry, text: &str) -> Vec<&'static Node> {
    let text = text.trim().to_lowercase();
    let words: Vec<&str> = text.split_whitespace().collect();
    let rank = |node: &Node| {
        let summary = node.summary.to_lowercase();
        let spoken = node.name.replace('-', " ");
        let has = |word: &&str| spoken.contains(*word) || node.name.contains(*word);
        let says = |word: &&str| has(word) || summary.contains(*word);
        let states = |word: &&str| node.parameters.iter().any(|parameter| parameter.name.contains(*word));
        match words.iter().all(|word| says(word) || states(word)) {
            true if node.name.starts_with(&text) || spoken.starts_with(&text) => Some(0),
            true if words.iter().all(has) => Some(1),
            true if words.iter().all(says) => Some(2),
            true => Some(3),
            false => None,
        }
    };
    let mut found: Vec<(usize, &'static Node)> =
        registry.iter().filter_map(|node| Some((rank(node)?, node))).collect();
    found.sort_by_key(|(rank, _)| *rank);
    if found.is_empty() {
        let near = voltet_graph::nearest(&text, registry.names());
        return near.and_then(|name| registry.find(name).ok()).into_iter().collect();
    }
    found.into_iter().map(|(_, node)| node).collect()
}

/// The node types that an output of this type can be wired to, each with the input that takes it: one of the very type before
/// others, one that must be fed before one that may be.
pub fn taking(registry: &Registry, output: PortType) -> Vec<Fitting> {
    let exact = |node: &'static Node| node.inputs.iter().find(|port| port.port_type == output);
    let port = |node: &'static Node| {
        exact(node).or_else(|| node.all_inputs().find(|port| output.serves(port.port_type)))
    };
    registry.iter().filter_map(|node| Some(Fitting { node, port: port(node)? })).collect()
}

/// The node types that can feed an input of this type, each with the first output that does.
pub fn giving(registry: &Registry, input: PortType) -> Vec<Fitting> {
    let port = |node: &'static Node| node.outputs.iter().find(|port| port.port_type.serves(input));
    registry.iter().filter_map(|node| Some(Fitting { node, port: port(node)? })).collect()
}

impl Document {
    /// The type of a node, where the registry knows it.
    pub fn node_type(&self, registry: &Registry, node: &str) -> Option<&'static Node> {
        let entry = self.pipeline().nodes.iter().find(|entry| entry.name == node)?;
        registry.node_type(entry)
    }

    /// The edit that adds a node of a type at a place of the graph view, named after its type.
    pub fn adding(&self, node: &Node, at: [f64; 2]) -> Edit {
        let name = self.free_name(&node.name.replace('-', "_"));
        Edit::AddNode { name, node_type: node.name.to_string(), settings: Vec::new(), at: Some(at) }
    }

    /// Edit that wires an output to an input. Errors say why not: the wrong type, a circle, or joined
    /// already.
    pub fn join(&self, registry: &Registry, from: (&str, &str), to: (&str, &str)) -> Result<Edit> {
        let nodes = &self.pipeline().nodes;
        let known = |node: &str| {
            let error = || Error::usage(format!("the type of the node '{node}' is not known"));
            self.node_type(registry, node).ok_or_else(error)
        };
        let (giving, taking) = (known(from.0)?, known(to.0)?);
        let missing =
            |node: &str, port: &str| Error::usage(format!("the node '{node}' has no port '{port}'"));
        let output =
            giving.outputs.iter().find(|port| port.name == from.1).ok_or_else(|| missing(from.0, from.1))?;
        let input = taking.all_inputs().find(|port| port.name == to.1).ok_or_else(|| missing(to.0, to.1))?;
        if !output.port_type.serves(input.port_type) {
            let what = format!("'{}' takes {}", input.name, input.port_type.with_article());
            return Err(Error::usage(what).got(output.port_type.with_article()));
        }
        if links::upstream(nodes, from.0).contains(to.0) {
            let error = Error::usage(format!("'{}' would feed itself", to.0));
            return Err(error.got(self.node_path(to.0, from.0).join(" → ")));
        }
        let text = match giving.outputs.len() {
            1 => from.0.to_string(),
            _ => format!("{}.{}", from.0, from.1),
        };
        if text != from.0 && nodes.iter().any(|node| node.name == text) {
            let error =
                Error::usage(format!("a node is called '{text}', which is how this output would be named"));
            return Err(error.expected("another name for that node"));
        }
        let beside = taking.optional_inputs.iter().any(|port| port.name == to.1);
        let link = nodes.iter().find(|node| node.name == to.0);
        let link = link.and_then(|node| node.inputs.iter().find(|link| link.port == to.1));
        let same = |text: &str| {
            let (node, port) = links::source(text, nodes);
            node == from.0 && port.is_none_or(|port| port == from.1)
        };
        if link.into_iter().flat_map(links::sources).any(same) {
            return Err(Error::usage("these are joined already"));
        }
        let (node, port) = (to.0.to_string(), to.1.to_string());
        Ok(Edit::Connect { node, port, source: text, beside })
    }

    /// The nodes on a way along wires from one node to another, and back to the first.
    fn node_path(&self, from: &str, to: &str) -> Vec<String> {
        let nodes = &self.pipeline().nodes;
        let mut names = vec![from.to_string()];
        let mut at = to.to_string();
        let mut back = vec![at.clone()];
        while at != from {
            let entry = nodes.iter().find(|node| node.name == at);
            let feeding = entry.iter().flat_map(|node| node.inputs.iter().flat_map(links::sources));
            let mut feeding = feeding.map(|text| links::source(text, nodes).0);
            let next = feeding
                .find(|name| !back.iter().any(|b| b == name) && links::upstream(nodes, name).contains(from));
            match next {
                Some(next) => at = next.to_string(),
                None => break,
            }
            back.push(at.clone());
        }
        names.extend(back.into_iter().rev().skip_while(|name| name == from));
        names.push(from.to_string());
        names
    }
}

/// From a node to its copy, in points.
const ASIDE: f64 = 30.0;

impl Document {
    /// Nodes as text, in the order of the file and with the comments that belong to them.
    pub fn copy(&self, names: &[String]) -> String {
        let nodes = self.pipeline().nodes.iter().filter(|node| names.contains(&node.name));
        let mut texts: Vec<String> = Vec::new();
        for node in nodes {
            let written = self.syntax.lines_of(&self.text, &["nodes", &node.name].into());
            texts.push(written.unwrap_or_else(|| plain(node)).replace("\r\n", "\n"));
        }
        texts.join("\n")
    }

    /// Adds the nodes that a text states, as one step, and gives their names here: those that are taken get a number. Wires among
    /// them stay, and those from nodes that are here. `at`: the upper left corner of the new ones. Errors: the text states no
    /// nodes.
    pub fn paste(&mut self, text: &str, at: [f64; 2]) -> Result<Vec<String>> {
        let pasted = Document::from_text(text.replace("\r\n", "\n"), None);
        let nodes = &pasted.pipeline().nodes;
        if nodes.is_empty() || !pasted.is_toml() {
            let error = Error::usage("the text has no nodes to paste");
            return Err(error.expected("TOML with a table [nodes.NAME] for each node"));
        }
        // As they lie here, where they are from here.
        let is_from_here =
            nodes.iter().all(|node| self.pipeline().nodes.iter().any(|here| here.name == node.name));
        let source: &Document = if is_from_here { self } else { &pasted };
        let places: Vec<[f64; 2]> = nodes.iter().map(|node| source.position(&node.name)).collect();
        let corner = [0, 1].map(|axis| places.iter().map(|place| place[axis]).fold(f64::INFINITY, f64::min));
        let places: Vec<[f64; 2]> =
            places.iter().map(|p| [p[0] - corner[0] + at[0], p[1] - corner[1] + at[1]]).collect();
        self.add_copies(pasted, &places, "paste")
    }

    /// Adds copies of nodes beside them, as one step, and gives their names. Wires from nodes that are not copied feed the copies,
    /// too.
    pub fn duplicate(&mut self, names: &[String]) -> Result<Vec<String>> {
        names.iter().try_for_each(|name| links::node(&self.pipeline().nodes, name).map(drop))?;
        let copied = Document::from_text(self.copy(names), None);
        let places: Vec<[f64; 2]> =
            copied.pipeline().nodes.iter().map(|node| self.position(&node.name).map(|x| x + ASIDE)).collect();
        self.add_copies(copied, &places, "duplicate")
    }

    fn add_copies(&mut self, mut copies: Document, places: &[[f64; 2]], label: &str) -> Result<Vec<String>> {
        let names: Vec<String> = copies.pipeline().nodes.iter().map(|node| node.name.clone()).collect();
        let here: BTreeSet<String> = self.pipeline().nodes.iter().map(|node| node.name.clone()).collect();
        // Wires from what is nowhere go.
        for node in copies.pipeline().nodes.clone() {
            for link in &node.inputs {
                for text in links::sources(link) {
                    let among =
                        names.iter().any(|name| name == links::source(text, &copies.pipeline().nodes).0);
                    let outside = here.contains(links::source(text, &self.pipeline().nodes).0);
                    if !among && !outside {
                        let (node, port) = (node.name.clone(), link.port.clone());
                        copies.edit(&Edit::Disconnect { node, port, source: Some(text.to_string()) })?;
                    }
                }
            }
        }
        let mut taken = here;
        taken.extend(names.iter().cloned());
        let mut fresh = Vec::with_capacity(names.len());
        for name in &names {
            let is_taken = self.pipeline().nodes.iter().any(|node| node.name == *name);
            let to = if is_taken { free_name(name, &|name| taken.contains(name)) } else { name.clone() };
            if to != *name {
                copies.edit(&Edit::Rename { node: name.clone(), to: to.clone() })?;
                taken.insert(to.clone());
            }
            fresh.push(to);
        }
        let moved = Edit::MoveNodes(fresh.iter().cloned().zip(places.iter().copied()).collect());
        let mut edits: Vec<Edit> = if self.has_nodes_in_place() {
            // Where all nodes stand in one value, headers cannot follow.
            copies.pipeline().nodes.iter().flat_map(added).collect()
        } else {
            vec![Edit::AddLines(copies.copy(&fresh))]
        };
        edits.push(moved);
        self.edit_all(label.to_string(), &edits, None)?;
        Ok(fresh)
    }

    /// True if all nodes are one value: `nodes = { … }`.
    fn has_nodes_in_place(&self) -> bool {
        self.syntax.sections[0].assignments.iter().any(|a| a.keys.len() == 1 && a.keys[0].name == "nodes")
    }
}

fn added(node: &NodeEntry) -> Vec<Edit> {
    let node_type = node.node_type.text().unwrap_or_default().to_string();
    let mut edits =
        vec![Edit::AddNode { name: node.name.clone(), node_type, settings: node.settings.clone(), at: None }];
    for link in &node.inputs {
        edits.extend(links::sources(link).map(|source| Edit::Connect {
            node: node.name.clone(),
            port: link.port.clone(),
            source: source.to_string(),
            beside: link.source.list().is_some(),
        }));
    }
    edits
}

/// A node as a text of its own, without comments.
fn plain(node: &NodeEntry) -> String {
    let pipeline = Pipeline { title: None, nodes: vec![node.clone()] }.to_string();
    let from = pipeline.find("[nodes.").unwrap_or(0);
    pipeline[from..].to_string()
}
