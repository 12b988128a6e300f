//! `voltet explain`: what will run, on which engine, what is left out and why. Reads no data.

use super::{DONE, open, registry, show, warn};
use crate::arguments::Explain;
use voltet::Document;
use voltet::core::Result;
use voltet::core::graph::{Demand, Graph, GraphNode, Plan, PortType};

pub fn explain(arguments: &Explain) -> Result<u8> {
    let document = match open(&arguments.file, &arguments.set.options, &registry()?) {
        Ok(document) => document,
        Err((error, text)) => return Ok(show(&error, text.as_deref())),
    };
    warn(&document);
    match voltet::nodes::session().plan(&document.graph) {
        Ok(plan) => {
            print!("{}", explained(&document, &plan));
            Ok(DONE)
        }
        Err(error) => Ok(show(&document.locate(error), Some(&document.text))),
    }
}

/// The plan in words.
fn explained(document: &Document, plan: &Plan) -> String {
    let graph = &document.graph;
    let mut text = format!("{}", document.path.display());
    if let Some(title) = &document.pipeline.title {
        text += &format!(": {title}");
    }
    text += "\n\nRuns, in this order:\n";
    let width = |part: fn(&GraphNode) -> &str| {
        graph.order.iter().map(|&i| part(&graph.nodes[i]).chars().count()).max().unwrap_or(0)
    };
    let (names, types) = (width(|n| &n.name), width(|n| n.node.name));
    for &i in &graph.order {
        let node = &graph.nodes[i];
        let mut parts: Vec<String> = Vec::new();
        let given = node.parameters.iter().filter(|(p, _, given)| *given && p.name != "widgets");
        parts.extend(given.filter_map(|(p, s, _)| Some(format!("{} = {}", p.name, s?.datum))));
        parts.extend(asked(node, &plan.demands[i]));
        let line = format!("  {:names$}  {:types$}  {}", node.name, node.node.name, parts.join("; "));
        text += line.trim_end();
        text += "\n";
    }
    let engines =
        graph.order.iter().filter_map(|&i| Some((&graph.nodes[i].name, plan.notes[i].engine.as_ref()?)));
    for (name, (engine, why)) in engines {
        text += &format!("\nEngine of '{name}': {engine} ({why})\n");
    }
    let left_out: Vec<String> = (graph.order.iter())
        .flat_map(|&i| plan.notes[i].left_out.iter().map(move |left| (&graph.nodes[i].name, left)))
        .map(|(name, (what, why))| format!("  {name}: no {what}: {why}\n"))
        .collect();
    if left_out.is_empty() {
        text += "\nNothing is left out before the data is known.\n";
    } else {
        text += &format!("\nLeft out:\n{}", left_out.concat());
    }
    if waves(graph) {
        text += "Whether bands are finer than the cells is known with the data: `voltet info` of this file says it.\n";
    }
    text += "Cells that no widget touches or that lie outside the view are culled as the data is known.\n";
    text
}

/// Whether some transfer function has bands.
fn waves(graph: &Graph) -> bool {
    let mut kinds =
        graph.order.iter().flat_map(|&i| graph.nodes[i].parameters.kinds("widgets").unwrap_or_default());
    kinds.any(|(kind, _)| kind.ends_with("-wave"))
}

/// What is asked of a node, where that says more than its type.
fn asked(node: &GraphNode, demand: &Demand) -> Option<String> {
    let first = node.node.outputs.first()?.port_type;
    let mut asked: Vec<String> = Vec::new();
    if first == PortType::Grid || first == PortType::Volume {
        asked.extend(demand.arrays.iter().map(|name| format!("array \"{name}\"")));
        asked.extend(demand.cell_arrays.iter().map(|name| format!("cell array \"{name}\"")));
    }
    if first == PortType::Volume {
        asked.extend(demand.gradient_magnitude.then(|| "gradient magnitude".to_string()));
        asked.extend(demand.gradient.then(|| "gradient vectors".to_string()));
    }
    (!asked.is_empty()).then(|| format!("asked for {}", asked.join(", ")))
}
