//! Wires as pipeline files state them: `"node"` or `"node.port"`, one or a list.

use std::collections::BTreeSet;
use voltet_core::Result;
use voltet_graph::{Field, LinkEntry, LocatedValue, NodeEntry, ParameterValue, unknown_node};

/// The node of a name. Errors: there is none.
pub fn node<'a>(nodes: &'a [NodeEntry], name: &str) -> Result<&'a NodeEntry> {
    let unknown = || unknown_node(name, nodes.iter().map(|node| node.name.as_str()));
    nodes.iter().find(|node| node.name == name).ok_or_else(unknown)
}

/// The node that a source names, and its output where it names one: a whole text that is a node's name means that node.
pub fn source<'a>(text: &'a str, nodes: &[NodeEntry]) -> (&'a str, Option<&'a str>) {
    let is_node = |name: &str| nodes.iter().any(|node| node.name == name);
    match text.rsplit_once('.') {
        Some((node, port)) if !is_node(text) => (node, Some(port)),
        _ => (text, None),
    }
}

/// Sources of an input, wire by wire, as the file writes them.
pub fn sources(link: &LinkEntry) -> impl Iterator<Item = &str> {
    link.source.list().unwrap_or(std::slice::from_ref(&link.source)).iter().filter_map(LocatedValue::text)
}

/// Wires of a node after a change of each wire (its input and its source), where they differ; invalid entries stay.
pub(crate) fn changed(node: &NodeEntry, change: impl Fn(&str, &str) -> Option<String>) -> Option<Vec<Field>> {
    let one = |port: &str, setting: &LocatedValue| match setting.text() {
        Some(text) => change(port, text).map(LocatedValue::from),
        None => Some(setting.clone()),
    };
    let all = |link: &LinkEntry| {
        let setting = match link.source.list() {
            None => one(&link.port, &link.source)?,
            Some(list) => {
                let kept: Vec<LocatedValue> = list.iter().filter_map(|part| one(&link.port, part)).collect();
                if kept.is_empty() && !list.is_empty() {
                    return None;
                }
                ParameterValue::List(kept).into()
            }
        };
        Some(Field { name: link.port.clone(), origin: link.origin.clone(), setting })
    };
    let fields: Vec<Field> = node.inputs.iter().filter_map(all).collect();
    let same = fields.len() == node.inputs.len()
        && fields.iter().zip(&node.inputs).all(|(field, link)| field.setting == link.source);
    (!same).then_some(fields)
}

/// The names of the nodes that feed one, and its own. Wires that lead nowhere are passed over.
pub fn upstream(nodes: &[NodeEntry], name: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::from([name.to_string()]);
    let mut open = vec![name];
    while let Some(name) = open.pop() {
        let entry = nodes.iter().find(|node| node.name == name);
        for text in entry.iter().flat_map(|entry| entry.inputs.iter().flat_map(sources)) {
            let feeding = source(text, nodes).0;
            if found.insert(feeding.to_string()) {
                open.push(feeding);
            }
        }
    }
    found
}

/// The nodes that feed one, and it, in the order of the document.
pub fn feeding(nodes: &[NodeEntry], name: &str) -> Vec<NodeEntry> {
    let names = upstream(nodes, name);
    nodes.iter().filter(|node| names.contains(&node.name)).cloned().collect()
}
