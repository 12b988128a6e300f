//! Resolves the wires of a node: inputs to outputs of the other nodes.

use super::diagnostic::{Diagnostic, DiagnosticTarget};
use super::entry::NodeEntry;
use crate::api::node::Node;
use crate::api::wiring::Edge;
use voltet_core::parameters::{LocatedValue, suggest};
use voltet_core::{Error, Result};

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
                .expected(suggest(&link.port, node.all_inputs().map(|p| p.name)));
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
        let accepted = format!(
            "inputs = {{ {} = \"…\" }}, the name of a node that gives {}",
            port.name,
            port.port_type.with_article()
        );
        fault(port.name, error.expected(accepted));
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
        return Err(Error::usage(format!("there is no node '{name}'"))
            .expected(suggest(name, types.iter().map(|(name, _)| *name))));
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
                .expected(suggest(port, outputs.iter().map(|o| o.name)))),
        },
    }
}
