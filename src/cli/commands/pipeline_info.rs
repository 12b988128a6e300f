//! `voltet info` of a pipeline file: findings about its data, without drawing.
//!
//! Writers are left out, and a node of type `bands` is added to each node with a volume and a transfer function as inputs: its demand
//! is all that is read and computed.

use super::exit_status::{DONE, show};
use super::pipelines::open;
use crate::Document;
use crate::cli::arguments::Info;
use crate::cli::present::{self, Bar};
use crate::core::{Error, Result};
use crate::graph::{Graph, LinkEntry, NodeEntry, ParameterValue, PortType, Registry};

pub fn pipeline_info(arguments: &Info, registry: &Registry) -> Result<u8> {
    if arguments.time_step.is_some() || arguments.solution.is_some() {
        let error = Error::usage("--time-step and --solution are for data files, and this is a pipeline");
        return Err(error.expected("the reader's parameters, or --set").in_file(&arguments.data));
    }
    let document = match open(&arguments.data, &arguments.set.options, registry) {
        Ok(document) => document,
        Err((error, text)) => return Ok(show(&error, text.as_deref())),
    };
    let graph = graph(&document, registry)?;
    let bar = Bar::new(false);
    let outcome = crate::nodes::session().run(&graph, &bar);
    bar.clear();
    match outcome {
        Ok(report) => {
            present::say(&present::warnings(&report, graph.warnings.len()));
            present::print(&present::findings(&report))?;
            Ok(DONE)
        }
        Err(error) => Ok(show(&document.locate(error), Some(&document.text))),
    }
}

/// Graph of the nodes that make findings.
fn graph(document: &Document, registry: &Registry) -> Result<Graph> {
    let is_sink = |entry: &NodeEntry| document.graph.node(&entry.name).is_some_and(|n| n.node.is_sink());
    let mut entries: Vec<NodeEntry> =
        document.pipeline.nodes.iter().filter(|entry| !is_sink(entry)).cloned().collect();
    let mut looks: Vec<[&LinkEntry; 2]> = Vec::new();
    for entry in &document.pipeline.nodes {
        let Some(node) = document.graph.node(&entry.name) else { continue };
        let link = |port_type: PortType| {
            let port = node.node.inputs.iter().find(|port| port.port_type == port_type)?;
            entry.inputs.iter().find(|link| link.port == port.name)
        };
        let Some(pair) = link(PortType::Volume).zip(link(PortType::TransferFunction)) else { continue };
        let pair = [pair.0, pair.1];
        if !looks.iter().any(|known| (0..2).all(|k| known[k].source.datum == pair[k].source.datum)) {
            looks.push(pair);
        }
    }
    if looks.is_empty() {
        let error = Error::usage(
            "the pipeline draws no volume by a transfer function, so there is nothing to find out",
        );
        return Err(error.expected("a node that draws, such as type = \"renderer\"").in_file(&document.path));
    }
    for [volume, look] in looks {
        let link = |port: &str, from: &LinkEntry| LinkEntry { port: port.into(), ..from.clone() };
        entries.push(NodeEntry {
            name: free_name(&entries, look.source.text().unwrap_or("look")),
            origin: look.origin.clone(),
            node_type: ParameterValue::Text("bands".into()).into(),
            settings: Vec::new(),
            inputs: vec![link("volume", volume), link("transfer_function", look)],
        });
    }
    Graph::build(&entries, registry, document.graph.folder.clone()).map_err(|error| document.locate(error))
}

/// A name that no node has, for the findings about a transfer function.
fn free_name(entries: &[NodeEntry], look: &str) -> String {
    let mut name = format!("{look} on its data");
    while entries.iter().any(|entry| entry.name == name) {
        name.push('\'');
    }
    name
}
