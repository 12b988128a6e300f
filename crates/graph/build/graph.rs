//! Builds graphs: finds node types, checks parameters, wires ports, refuses cycles, and finds the order of work.

use super::entry::{Diagnostic, DiagnosticTarget, NodeEntry, unknown_node};
use super::method;
use super::registry::Registry;
use crate::api::context::{Outputs, Preparation, RunContext};
use crate::api::node::{Node, TimeSeries};
use crate::api::origins::ResolvedPipeline;
use crate::api::value::{Edge, PortType, Wiring};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::field::{Method, Plugin};
use voltet_core::parameters::{LocatedValue, Parameters, SourceSpan};
use voltet_core::{Error, Result};

/// A checked graph.
#[derive(Debug, Default)]
pub struct Graph {
    /// The nodes, in the order in which they were stated.
    pub nodes: Vec<GraphNode>,
    /// The nodes that some sink needs, each after everything that feeds it.
    pub order: Vec<usize>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
    /// Warnings: entries that are allowed but hardly intended.
    pub warnings: Vec<Error>,
    /// The text that states it.
    pub stated: ResolvedPipeline,
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
    /// Wires into the required input ports, in the order of [`Node::inputs`]; then those into the optional ones.
    pub inputs: Vec<Edge>,
    /// Its source span.
    pub origin: SourceSpan,
    /// Work that a program does in place of its own.
    pub given: Option<NodeOverride>,
}

impl GraphNode {
    /// Its wires and its gradient filter.
    pub(crate) fn wiring(&self) -> Wiring<'_> {
        Wiring {
            node: &self.name,
            node_type: self.node.name,
            ports: [self.node.inputs, self.node.optional_inputs],
            edges: &self.inputs,
            method: self.method.as_ref(),
        }
    }

    /// True if the node draws or passes on cells, and so may restrict the points where the gradient is read.
    pub(crate) fn draws(&self) -> bool {
        let says = [PortType::TransferFunction, PortType::Cells, PortType::Projection];
        self.node.inputs.iter().any(|port| says.contains(&port.port_type))
    }

    /// True if the node makes a volume of a grid.
    pub(crate) fn makes_volume(&self) -> bool {
        let takes_grid = self.node.inputs.iter().any(|port| port.port_type == PortType::Grid);
        self.gives(PortType::Volume) && takes_grid
    }

    pub(crate) fn gives(&self, wanted: PortType) -> bool {
        self.node.outputs.iter().any(|port| port.port_type == wanted)
    }

    /// Runs the node, or the work that a program does in its place.
    pub(crate) fn run(&self, call: &mut RunContext) -> Result<Outputs> {
        match &self.given {
            Some(given) => given.run(call),
            None => (self.node.run)(call),
        }
        .map_err(|error| self.locate(error))
    }

    /// The plug-in that the node or its gradient filter came from: another one of that name gives something else.
    pub fn plugin(&self) -> Option<&Plugin> {
        self.node.plugin.or_else(|| self.method.as_ref().and_then(Method::plugin))
    }

    /// Adds this node's name and place to an error that has none.
    pub fn locate(&self, error: Error) -> Error {
        let mut error = error.at_node(&self.name);
        // An array that another node names.
        if error.location.node.as_ref() != Some(&self.name) {
            return error;
        }
        // A parameter or an option that an error names is a better place than the node's head.
        let item = error.location.item.clone();
        let named = item.and_then(|item| self.parameters.optional(&item).map(|s| s.origin.clone()));
        if let Some(origin @ SourceSpan::Span(_)) = named {
            error = origin.locate(error);
        }
        if error.location.item.is_some() { error } else { self.origin.locate(error) }
    }
}

impl Graph {
    /// Checks the entries against the registry and wires them. `folder`: what paths are relative to.
    pub fn build(entries: &[NodeEntry], registry: &Registry, folder: PathBuf) -> Result<Graph> {
        let mut faults = Vec::new();
        let graph = Self::survey(entries, registry, folder, &mut faults);
        if let Some(fault) = faults.into_iter().next() {
            return Err(fault.error);
        }
        let mut graph = graph.unwrap_or_default();
        graph.order_work()?;
        Ok(graph)
    }

    /// Every mistake of the entries: of types, parameters and wires, in the order in which [`Graph::build`] finds the first. That
    /// nothing is written is none of them.
    pub fn faults(entries: &[NodeEntry], registry: &Registry, folder: PathBuf) -> Vec<Diagnostic> {
        let mut faults = Vec::new();
        Self::survey(entries, registry, folder, &mut faults);
        faults
    }

    /// The graph without its order of work; `None` where there are faults.
    fn survey(
        entries: &[NodeEntry],
        registry: &Registry,
        folder: PathBuf,
        faults: &mut Vec<Diagnostic>,
    ) -> Option<Graph> {
        let mut types = Vec::with_capacity(entries.len());
        let mut checked = Vec::with_capacity(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            if entries[..i].iter().any(|e| e.name == entry.name) {
                let error = Error::usage(format!("two nodes are called '{}'", entry.name));
                faults.push(Diagnostic::new(entry, DiagnosticTarget::Node, error));
            }
            let node = find_type(entry, registry, &folder)
                .map_err(|error| faults.push(Diagnostic::new(entry, DiagnosticTarget::Node, error)));
            types.push((entry.name.as_str(), node.ok()));
            checked.push(node.ok().and_then(|node| check(entry, node, registry, faults)));
        }
        let edges: Vec<Vec<Edge>> =
            entries.iter().enumerate().map(|(i, entry)| wires(entry, &types, i, faults)).collect();
        refuse_cycles(entries, &edges, faults);
        if !faults.is_empty() {
            return None;
        }
        let whole = entries.iter().zip(types).zip(checked.into_iter().zip(edges));
        let nodes = whole.map(|((entry, (_, node)), (checked, inputs))| {
            let (parameters, method) = checked?;
            let (name, origin) = (entry.name.clone(), entry.origin.clone());
            Some(GraphNode { name, node: node?, parameters, method, inputs, origin, given: None })
        });
        let nodes = nodes.collect::<Option<Vec<_>>>()?;
        Some(Graph { warnings: alias_notes(entries, &nodes, registry), nodes, folder, ..Graph::default() })
    }

    /// True if a file is of no format that its node reads: a reader from outside may.
    pub fn has_foreign_files(&self) -> bool {
        let is_foreign = |node: &GraphNode| {
            let path = node.parameters.optional("path").and_then(LocatedValue::text);
            path.is_some_and(|path| (node.node.foreign_head)(&self.folder.join(path)).is_some())
        };
        self.nodes.iter().any(is_foreign)
    }

    /// The time series that a node reads, as far as headers tell. Errors: those of its files, with its place.
    pub fn time_series(&self, place: usize) -> Result<TimeSeries> {
        let node = &self.nodes[place];
        let preparation = Preparation { parameters: &node.parameters, folder: &self.folder };
        (node.node.steps)(&preparation).map_err(|error| node.locate(error))
    }

    /// The node of that name.
    pub fn node(&self, name: &str) -> Option<&GraphNode> {
        self.nodes.iter().find(|n| n.name == name)
    }

    /// Lets a program do the work of a node; what the node's type does before a run (files, steps) stays. Errors: there is no
    /// such node.
    pub fn give(&mut self, node: &str, given: NodeOverride) -> Result<()> {
        let Some(place) = self.nodes.iter().position(|known| known.name == node) else {
            return Err(unknown_node(node, self.nodes.iter().map(|node| node.name.as_str())));
        };
        self.nodes[place].given = Some(given);
        Ok(())
    }

    /// The order of work, from the sinks; warns of nodes that no sink needs.
    fn order_work(&mut self) -> Result<()> {
        let sinks = (0..self.nodes.len()).filter(|&i| self.nodes[i].node.is_sink());
        let edges: Vec<&[Edge]> = self.nodes.iter().map(|node| node.inputs.as_slice()).collect();
        let order = depth_first(&edges, sinks, |_, _| {});
        if order.is_empty() {
            return Err(Error::usage("the pipeline writes nothing")
                .expected("at least one node that writes a file, such as type = \"image-writer\""));
        }
        for (_, node) in self.nodes.iter().enumerate().filter(|(i, _)| !order.contains(i)) {
            let warning = Error::usage(format!(
                "the node '{}' is not used: nothing that is written needs it",
                node.name
            ));
            self.warnings.push(node.origin.locate(warning));
        }
        self.order = order;
        Ok(())
    }
}

/// Checks the settings of an entry, each and all together.
fn check(
    entry: &NodeEntry,
    node: &'static Node,
    registry: &Registry,
    faults: &mut Vec<Diagnostic>,
) -> Option<(Parameters, Option<Method>)> {
    let before = faults.len();
    let surveyed = method::survey(entry, node, registry, &mut |name, error| {
        faults.push(Diagnostic::new(entry, DiagnosticTarget::Parameter(name.to_string()), error));
    });
    let checked = surveyed.filter(|_| faults.len() == before)?;
    if let Err(error) = (node.check)(&checked.0) {
        faults.push(Diagnostic::new(entry, DiagnosticTarget::Node, error));
    }
    Some(checked)
}

/// A note for each former name of a variant.
fn alias_notes(entries: &[NodeEntry], nodes: &[GraphNode], registry: &Registry) -> Vec<Error> {
    let note = |(entry, node): (&NodeEntry, &GraphNode)| {
        let parameter = node.node.registered_parameter()?;
        let setting = &entry.settings.iter().find(|field| field.name == parameter.name)?.setting;
        let alias = registry.alias(parameter.name, setting.text()?)?;
        let what = format!("the {} '{}' is now called '{}'", parameter.name, alias.alias, alias.name);
        Some(setting.origin.locate(Error::usage(what)))
    };
    entries.iter().zip(nodes).filter_map(note).collect()
}

/// The node type that an entry names, or that of the format from outside that its file is of.
fn find_type(entry: &NodeEntry, registry: &Registry, folder: &Path) -> Result<&'static Node> {
    let Some(name) = entry.node_type.text() else {
        return Err(entry.node_type.error("'type' must be the name of a node type", "a text"));
    };
    let node = registry.find(name).map_err(|error| entry.node_type.origin.locate(error))?;
    Ok(foreign_reader(entry, node, registry, folder).unwrap_or(node))
}

/// The node of the format from outside that the file of an entry is of, if `node` reads files, but none of this format. Parameters
/// that `node` lacks need the name of the other: whether they are known must not depend on a file.
fn foreign_reader(
    entry: &NodeEntry,
    node: &Node,
    registry: &Registry,
    folder: &Path,
) -> Option<&'static Node> {
    let mut readers = registry.readers().peekable();
    // Without readers no file is opened.
    readers.peek()?;
    entry.settings.iter().all(|field| node.parameter(&field.name).is_some()).then_some(())?;
    let path = folder.join(entry.setting("path")?.text()?);
    let head = (node.foreign_head)(&path)?;
    readers.find(|(_, reader)| reader.matches(&head, &path)).map(|(node, _)| node)
}

/// Refuses edges back into a path, and names their cycles. Each is found once.
fn refuse_cycles(entries: &[NodeEntry], edges: &[Vec<Edge>], faults: &mut Vec<Diagnostic>) {
    let edges: Vec<&[Edge]> = edges.iter().map(Vec::as_slice).collect();
    depth_first(&edges, 0..entries.len(), |path, edge| {
        // Data runs against the path: the last node on it feeds the one before.
        let names = path.iter().rev().chain(path.last()).map(|&(n, _)| entries[n].name.as_str());
        let error = Error::usage("the graph has a cycle")
            .got(names.collect::<Vec<_>>().join(" → "))
            .expected("inputs that lead back to sources");
        let entry = &entries[path[path.len() - 1].0];
        let error = edge.origin.locate(error.at_node(&entry.name));
        faults.push(Diagnostic::new(entry, DiagnosticTarget::Input(edge.name.to_string()), error));
    });
}

/// The nodes that these starts lead to against the edges, each after everything that feeds it. `on_cycle` is given a path, each of
/// its nodes with the next of its edges to follow, and the edge from its end back to its begin.
fn depth_first(
    edges: &[&[Edge]],
    starts: impl Iterator<Item = usize>,
    mut on_cycle: impl FnMut(&[(usize, usize)], &Edge),
) -> Vec<usize> {
    let (mut done, mut order) = (vec![false; edges.len()], Vec::new());
    for start in starts {
        let mut path = vec![(start, 0)];
        while let Some(&mut (i, ref mut next)) = path.last_mut() {
            if done[i] || *next == edges[i].len() {
                if !std::mem::replace(&mut done[i], true) {
                    order.push(i);
                }
                path.pop();
                continue;
            }
            let edge = &edges[i][*next];
            *next += 1;
            match path.iter().position(|&(n, _)| n == edge.node) {
                Some(first) => on_cycle(&path[first..], edge),
                None => path.push((edge.node, 0)),
            }
        }
    }
    order
}

/// Work that a program does in place of a node's own. Clones are the same work: a session uses its former outputs again.
#[derive(Clone)]
pub struct NodeOverride {
    work: Arc<OverrideFn>,
    /// True if each process gives a piece of its own of one grid.
    pub(crate) is_piece: bool,
}

type OverrideFn = dyn Fn(&mut RunContext) -> Result<Outputs> + Send + Sync;

impl NodeOverride {
    /// One value for each output that the node declares, for what is asked of it ([`RunContext::demand`]).
    pub fn new(work: impl Fn(&mut RunContext) -> Result<Outputs> + Send + Sync + 'static) -> NodeOverride {
        NodeOverride { work: Arc::new(work), is_piece: false }
    }

    /// Lets each of several processes give a piece of its own of one grid: the work is that for a part.
    pub fn in_pieces(self) -> NodeOverride {
        NodeOverride { is_piece: true, ..self }
    }

    pub(crate) fn run(&self, call: &mut RunContext) -> Result<Outputs> {
        (self.work)(call)
    }
}

impl PartialEq for NodeOverride {
    fn eq(&self, other: &NodeOverride) -> bool {
        Arc::ptr_eq(&self.work, &other.work)
    }
}

impl std::fmt::Debug for NodeOverride {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("NodeOverride")
    }
}

/// Nodes by name; an unknown type is `None`.
type Types<'a> = [(&'a str, Option<&'static Node>)];

/// The wires of one entry: every input of the node type fed once, by an output of a type that serves it; then the
/// optional inputs, each fed by any number of them. What is wrong is left out, and so are wires from nodes of unknown types.
pub(super) fn wires(
    entry: &NodeEntry,
    types: &Types,
    place: usize,
    faults: &mut Vec<Diagnostic>,
) -> Vec<Edge> {
    let Some(node) = types[place].1 else { return Vec::new() };
    let mut fault = |port: &str, error| {
        faults.push(Diagnostic::new(entry, DiagnosticTarget::Input(port.to_string()), error))
    };
    let required = node.inputs.len();
    let mut edges: Vec<Option<Edge>> = vec![None; required];
    for link in &entry.inputs {
        let Some(port) = node.all_inputs().position(|p| p.name == link.port) else {
            let error = Error::usage(format!("the node type '{}' has no input '{}'", node.name, link.port))
                .not_among(&link.port, node.all_inputs().map(|p| p.name));
            fault(&link.port, link.origin.locate(error));
            continue;
        };
        let sources = match link.source.list() {
            Some(list) if port >= required => list,
            _ => std::slice::from_ref(&link.source),
        };
        for source in sources {
            match edge(source, node, port, types) {
                Ok(edge) => match edges.get_mut(port).filter(|_| port < required) {
                    Some(slot) => *slot = edge,
                    None => edges.push(edge),
                },
                Err(error) => fault(&link.port, error),
            }
        }
    }
    for port in node.inputs.iter().filter(|port| !entry.inputs.iter().any(|link| link.port == port.name)) {
        let error = Error::usage(format!("the input '{}' is not wired", port.name));
        let or = format!(", a node that gives {}", port.port_type.with_article());
        fault(port.name, error.needs_input(port.name, &or));
    }
    edges.into_iter().flatten().collect()
}

/// One wire, from the output that `written` names to an input port; `None` from a node of an unknown type.
fn edge(written: &LocatedValue, node: &Node, port: usize, types: &Types) -> Result<Option<Edge>> {
    let Some(text) = written.text() else {
        let accepted = match port < node.inputs.len() {
            true => "\"node\" or \"node.port\"",
            false => "\"node\" or \"node.port\", or a list of them",
        };
        return Err(written.error("an input must name the node that feeds it", accepted));
    };
    let found = source(text, types).map_err(|error| written.origin.locate(error))?;
    let Some((feeding, giving, output)) = found else { return Ok(None) };
    let found = giving.outputs[output].port_type;
    let Some(taken) = node.all_inputs().nth(port) else {
        return Err(Error::run("a wire leads to an input that is not declared"));
    };
    let wanted = taken.port_type;
    if !found.serves(wanted) {
        let gives = |node: &Node| node.outputs.iter().any(|output| output.port_type.serves(wanted));
        let giving = types.iter().filter(|(_, node)| node.is_some_and(gives));
        let names: Vec<&str> = giving.map(|(name, _)| *name).collect();
        let remedy = match names.is_empty() {
            true => format!("{}, which no node here gives", wanted.with_article()),
            false => format!("{}, which these nodes give: {}", wanted.with_article(), names.join(", ")),
        };
        let what = format!("the input '{}' is wired to the wrong type", taken.name);
        let error =
            Error::usage(what).got(format!("{} from '{text}'", found.with_article())).expected(remedy);
        return Err(written.origin.locate(error));
    }
    Ok(Some(Edge { port, name: taken.name, node: feeding, output, origin: written.origin.clone() }))
}

/// The node and the output that `"node"` or `"node.port"` means; `None` of a node of an unknown type.
fn source(text: &str, types: &Types) -> Result<Option<(usize, &'static Node, usize)>> {
    let whole = types.iter().position(|(name, _)| *name == text);
    let (name, port) = match (whole, text.rsplit_once('.')) {
        (None, Some((name, port))) => (name, Some(port)),
        _ => (text, None),
    };
    let Some(i) = types.iter().position(|(known, _)| *known == name) else {
        return Err(unknown_node(name, types.iter().map(|(name, _)| *name)));
    };
    let Some(node) = types[i].1 else { return Ok(None) };
    let outputs = node.outputs;
    match (port, outputs.len()) {
        (_, 0) => Err(Error::usage(format!("the node '{name}' has no output"))),
        (None, 1) => Ok(Some((i, node, 0))),
        (None, _) => Err(Error::usage(format!("the node '{name}' has several outputs")).expected(
            outputs.iter().map(|o| format!("\"{name}.{}\"", o.name)).collect::<Vec<_>>().join(" or "),
        )),
        (Some(port), _) => match outputs.iter().position(|o| o.name == port) {
            Some(output) => Ok(Some((i, node, output))),
            None => Err(Error::usage(format!("the node '{name}' has no output '{port}'"))
                .not_among(port, outputs.iter().map(|o| o.name))),
        },
    }
}
