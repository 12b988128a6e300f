//! Building a graph: node types found, parameters checked, ports wired, cycles refused, the order of work.

use super::declaration::Node;
use super::method;
use super::registry::Registry;
use super::stated::Stated;
use crate::field::Method;
use crate::parameters::Parameters;
use crate::parameters::suggest;
use crate::parameters::{Field, Origin, Setting};
use crate::{Error, Result};
use std::path::PathBuf;

/// A node as a pipeline file or a program states it, not checked yet.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeEntry {
    /// Its name.
    pub name: String,
    /// Where it was written.
    pub origin: Origin,
    /// The name of its type.
    pub node_type: Setting,
    /// Its parameters.
    pub settings: Vec<Field>,
    /// Its wires.
    pub inputs: Vec<LinkEntry>,
}

impl NodeEntry {
    /// Sets a parameter, or the part of it that `path` leads to.
    pub fn set(&mut self, name: &str, path: &[&str], setting: Setting) -> Result<()> {
        crate::parameters::replace_field(&mut self.settings, name, path, setting)
    }
}

/// A wire as stated: an input port and the node (or `"node.port"`) that feeds it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkEntry {
    /// The input port.
    pub port: String,
    /// Where the port was written.
    pub origin: Origin,
    /// What feeds it.
    pub source: Setting,
}

/// A checked graph.
#[derive(Debug, Default)]
pub struct Graph {
    /// The nodes, in the order in which they were stated.
    pub nodes: Vec<GraphNode>,
    /// The nodes that some sink needs, each after everything that feeds it.
    pub order: Vec<usize>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// What is not wrong but hardly meant.
    pub warnings: Vec<Error>,
    /// The text that states it.
    pub stated: Stated,
}

/// A checked node.
#[derive(Debug)]
pub struct GraphNode {
    /// Its name.
    pub name: String,
    /// Its type.
    pub node: &'static Node,
    /// Its parameters, with those of its gradient filter.
    pub parameters: Parameters,
    /// The gradient filter that one of its parameters names.
    pub method: Option<Method>,
    /// What feeds each input port, in the order of [`Node::inputs`]; then the edges of the optional ones.
    pub inputs: Vec<Edge>,
    /// Where it was written.
    pub origin: Origin,
}

/// What feeds an input.
#[derive(Debug, Clone)]
pub struct Edge {
    /// The input port, by its place in [`Node::all_inputs`].
    pub port: usize,
    /// The node, by its place in [`Graph::nodes`].
    pub node: usize,
    /// Its output.
    pub output: usize,
    /// Where the wire was written.
    pub origin: Origin,
}

impl GraphNode {
    /// The place of an input port.
    pub(super) fn input(&self, port: &str) -> Result<usize> {
        self.node.all_inputs().position(|p| p.name == port).ok_or_else(|| {
            Error::run(format!(
                "the node type '{}' asks for an input '{port}' it does not declare",
                self.node.name
            ))
        })
    }

    /// The gradient filter that one of the node's parameters names.
    pub(super) fn method(&self) -> Result<&Method> {
        self.method.as_ref().ok_or_else(|| {
            Error::run(format!(
                "the node type '{}' asks for a gradient filter and names none",
                self.node.name
            ))
        })
    }

    /// The places in [`GraphNode::inputs`] of what feeds a port.
    pub(super) fn edges(&self, port: &str) -> Result<impl Iterator<Item = usize> + use<'_>> {
        let port = self.input(port)?;
        Ok((0..self.inputs.len()).filter(move |&i| self.inputs[i].port == port))
    }

    /// Adds this node's name and place to an error that has none.
    pub fn blame(&self, error: Error) -> Error {
        let mut error = error.at_node(&self.name);
        // A parameter or an option that an error names is a better place than the node's head.
        let item = error.place.item.clone();
        let named = item.and_then(|item| self.parameters.optional(&item).map(|s| s.origin.clone()));
        if let Some(origin @ Origin::Span(_)) = named {
            error = origin.blame(error);
        }
        if error.place.item.is_some() { error } else { self.origin.blame(error) }
    }
}

impl Graph {
    /// Checks the entries against the registry and wires them. `folder`: what paths are relative to.
    pub fn build(entries: &[NodeEntry], registry: &Registry, folder: PathBuf) -> Result<Graph> {
        let mut nodes = Vec::with_capacity(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            let blame = |error: Error| entry.origin.blame(error.at_node(&entry.name));
            if entries[..i].iter().any(|e| e.name == entry.name) {
                return Err(blame(Error::usage(format!("two nodes are called '{}'", entry.name))));
            }
            let node = find_type(entry, registry).map_err(blame)?;
            let (parameters, method) = method::check(entry, node, registry).map_err(blame)?;
            (node.check)(&parameters).map_err(blame)?;
            let inputs = Vec::new();
            nodes.push(GraphNode {
                name: entry.name.clone(),
                node,
                parameters,
                method,
                inputs,
                origin: entry.origin.clone(),
            });
        }
        for (i, entry) in entries.iter().enumerate() {
            let edges = wire(entry, &nodes, i).map_err(|e| entry.origin.blame(e.at_node(&entry.name)))?;
            nodes[i].inputs = edges;
        }
        let mut graph = Graph { nodes, folder, ..Graph::default() };
        graph.refuse_cycles()?;
        graph.order_work()?;
        Ok(graph)
    }

    /// The node of that name.
    pub fn node(&self, name: &str) -> Option<&GraphNode> {
        self.nodes.iter().find(|n| n.name == name)
    }

    /// Depth-first from every node; an edge back into the path is a cycle, which is named.
    fn refuse_cycles(&self) -> Result<()> {
        let mut done = vec![false; self.nodes.len()];
        for start in 0..self.nodes.len() {
            // The path from the start, each node with the next of its inputs to follow.
            let mut path: Vec<(usize, usize)> = vec![(start, 0)];
            while let Some(&mut (i, ref mut next)) = path.last_mut() {
                if done[i] || *next == self.nodes[i].inputs.len() {
                    done[i] = true;
                    path.pop();
                    continue;
                }
                let edge = &self.nodes[i].inputs[*next];
                *next += 1;
                if let Some(first) = path.iter().position(|&(n, _)| n == edge.node) {
                    // Data runs against the path: the last node on it feeds the one before.
                    let mut names: Vec<&str> =
                        path[first..].iter().rev().map(|&(n, _)| self.nodes[n].name.as_str()).collect();
                    names.push(names[0]);
                    let error = Error::usage("the graph has a cycle")
                        .found(names.join(" → "))
                        .accepted("inputs that lead back to sources")
                        .at_node(&self.nodes[i].name);
                    return Err(edge.origin.blame(error));
                }
                path.push((edge.node, 0));
            }
        }
        Ok(())
    }

    /// The order of work, from the sinks; warns of nodes that no sink needs.
    fn order_work(&mut self) -> Result<()> {
        let sinks = (0..self.nodes.len()).filter(|&i| self.nodes[i].node.is_sink());
        let mut placed = vec![false; self.nodes.len()];
        let mut order = Vec::new();
        for sink in sinks {
            let mut path = vec![(sink, 0)];
            while let Some(&mut (i, ref mut next)) = path.last_mut() {
                if !placed[i] && *next < self.nodes[i].inputs.len() {
                    let feeding = self.nodes[i].inputs[*next].node;
                    *next += 1;
                    path.push((feeding, 0));
                    continue;
                }
                if !std::mem::replace(&mut placed[i], true) {
                    order.push(i);
                }
                path.pop();
            }
        }
        if order.is_empty() {
            return Err(Error::usage("the pipeline writes nothing")
                .accepted("at least one node that writes a file, such as type = \"image-writer\""));
        }
        for (i, node) in self.nodes.iter().enumerate().filter(|(i, _)| !placed[*i]) {
            debug_assert!(!order.contains(&i));
            let warning = Error::usage(format!(
                "the node '{}' is not used: nothing that is written needs it",
                node.name
            ));
            self.warnings.push(node.origin.blame(warning));
        }
        self.order = order;
        Ok(())
    }
}

/// The node type that an entry names.
fn find_type(entry: &NodeEntry, registry: &Registry) -> Result<&'static Node> {
    let Some(name) = entry.node_type.text() else {
        return Err(entry.node_type.error("'type' must be the name of a node type", "a text"));
    };
    registry.find(name).map_err(|error| entry.node_type.origin.blame(error))
}

/// The wires of one entry: every input of the node type fed once, by an output of a type that serves it; then the
/// optional inputs, each fed by any number of them.
fn wire(entry: &NodeEntry, nodes: &[GraphNode], place: usize) -> Result<Vec<Edge>> {
    let node = nodes[place].node;
    let required = node.inputs.len();
    let mut edges: Vec<Option<Edge>> = vec![None; required];
    for link in &entry.inputs {
        let Some(port) = node.all_inputs().position(|p| p.name == link.port) else {
            let error = Error::usage(format!("the node type '{}' has no input '{}'", node.name, link.port))
                .accepted(suggest(&link.port, node.all_inputs().map(|p| p.name)));
            return Err(link.origin.blame(error));
        };
        let sources = match link.source.list() {
            Some(list) if port >= required => list,
            _ => std::slice::from_ref(&link.source),
        };
        for source in sources {
            let edge = edge(source, node, port, nodes)?;
            match edges.get_mut(port).filter(|_| port < required) {
                Some(slot) => *slot = Some(edge),
                None => edges.push(Some(edge)),
            }
        }
    }
    let missing = |port: usize| {
        let port = &node.inputs[port];
        Error::usage(format!("the input '{}' is not wired", port.name)).accepted(format!(
            "inputs = {{ {} = \"…\" }}, the name of a node that gives {}",
            port.name,
            port.port_type.with_article()
        ))
    };
    edges.into_iter().enumerate().map(|(port, edge)| edge.ok_or_else(|| missing(port))).collect()
}

/// One wire, from the output that `written` names to an input port.
fn edge(written: &Setting, node: &Node, port: usize, nodes: &[GraphNode]) -> Result<Edge> {
    let Some(text) = written.text() else {
        let accepted = match port < node.inputs.len() {
            true => "\"node\" or \"node.port\"",
            false => "\"node\" or \"node.port\", or a list of them",
        };
        return Err(written.error("an input must name the node that feeds it", accepted));
    };
    let (feeding, output) = source(text, nodes).map_err(|error| written.origin.blame(error))?;
    let found = nodes[feeding].node.outputs[output].port_type;
    let Some(taken) = node.all_inputs().nth(port) else {
        return Err(Error::run("a wire leads to an input that is not declared"));
    };
    let wanted = taken.port_type;
    if !found.serves(wanted) {
        let giving = nodes.iter().filter(|n| n.node.outputs.iter().any(|o| o.port_type.serves(wanted)));
        let names: Vec<&str> = giving.map(|n| n.name.as_str()).collect();
        let remedy = match names.is_empty() {
            true => format!("{}, which no node here gives", wanted.with_article()),
            false => format!("{}, which these nodes give: {}", wanted.with_article(), names.join(", ")),
        };
        let what = format!("the input '{}' is wired to the wrong type", taken.name);
        let error =
            Error::usage(what).found(format!("{} from '{text}'", found.with_article())).accepted(remedy);
        return Err(written.origin.blame(error));
    }
    Ok(Edge { port, node: feeding, output, origin: written.origin.clone() })
}

/// The node and the output that `"node"` or `"node.port"` means.
fn source(text: &str, nodes: &[GraphNode]) -> Result<(usize, usize)> {
    let whole = nodes.iter().position(|n| n.name == text);
    let (name, port) = match (whole, text.rsplit_once('.')) {
        (None, Some((name, port))) => (name, Some(port)),
        _ => (text, None),
    };
    let Some(i) = nodes.iter().position(|n| n.name == name) else {
        return Err(Error::usage(format!("there is no node '{name}'"))
            .accepted(suggest(name, nodes.iter().map(|n| n.name.as_str()))));
    };
    let outputs = nodes[i].node.outputs;
    match (port, outputs.len()) {
        (_, 0) => Err(Error::usage(format!("the node '{name}' has no output"))),
        (None, 1) => Ok((i, 0)),
        (None, _) => Err(Error::usage(format!("the node '{name}' has several outputs")).accepted(
            outputs.iter().map(|o| format!("\"{name}.{}\"", o.name)).collect::<Vec<_>>().join(" or "),
        )),
        (Some(port), _) => match outputs.iter().position(|o| o.name == port) {
            Some(output) => Ok((i, output)),
            None => Err(Error::usage(format!("the node '{name}' has no output '{port}'"))
                .accepted(suggest(port, outputs.iter().map(|o| o.name)))),
        },
    }
}
