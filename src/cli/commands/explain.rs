//! `voltet explain`: what will run, on which engine, what is left out and why; reads headers of data files. `voltet check`: parses,
//! type-checks and plans; reads no file but the pipelines.

use super::shared::{DONE, Outcome, open_all, open_file, show, warn};
use crate::Document;
use crate::cli::arguments::{Explain, Files};
use crate::cli::present::{name, print};
use crate::core::counted;
use crate::document::{LocatedError, refuse_conflicts};
use crate::graph::{Demand, Graph, GraphNode, Plan, PortType, Registry, SkippedWork};

pub fn check(arguments: &Files, registry: &Registry) -> Outcome {
    let (documents, mut code) = open_all(arguments, &[], registry);
    let planned = |document: &Document| -> Result<(), LocatedError> {
        refuse_conflicts([document], true, &[])?;
        crate::nodes::session().plan(&document.graph).map_err(|error| document.failure(error))?;
        let path = name(&document.path.to_string_lossy());
        print(&format!("{path}: in order, {}\n", counted(document.graph.nodes.len(), "node")))?;
        Ok(())
    };
    for document in &documents {
        warn(document);
        code = planned(document).map_or_else(|failure| code.max(show(&failure)), |()| code);
    }
    Ok(code)
}

pub fn explain(arguments: &Explain, registry: &Registry) -> Outcome {
    let document = open_file(&arguments.file, registry, false)?;
    // What is carried in a picture names that picture as its output, and nothing is written here.
    refuse_conflicts([&document], document.carried.is_none(), &[])?;
    let mut session = crate::nodes::session();
    if arguments.exhaustive {
        session = session.exhaustive();
    }
    let mut plan = session.plan(&document.graph).map_err(|error| document.failure(error))?;
    let unknown = plan.foresee(&document.graph);
    print(&explained(&document, &plan, &unknown, arguments.exhaustive))?;
    Ok(DONE)
}

fn explained(document: &Document, plan: &Plan, unknown: &[usize], exhaustive: bool) -> String {
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
        .flat_map(|&i| plan.notes[i].skipped.iter().map(move |left| (&graph.nodes[i].name, left)))
        .map(|(name, SkippedWork { what, why, saving, .. })| {
            let saving = saving.map(|saving| format!(" (saves {saving})")).unwrap_or_default();
            format!("  {name}: no {what}: {why}{saving}\n")
        })
        .collect();
    match (left_out.is_empty(), exhaustive) {
        (_, true) => text += "\nNothing is left out, needed or not; the picture is the same.\n",
        (true, false) => text += "\nNothing is left out before the data is known.\n",
        (false, false) => text += &format!("\nLeft out:\n{}", left_out.concat()),
    }
    for name in unknown.iter().map(|&i| &graph.nodes[i].name) {
        text +=
            &format!("Which arrays of its file '{name}' does not read is known once the file is there.\n");
    }
    if waves(graph) {
        text += "Whether bands are finer than the cells is known with the data: `voltet info` of this file says it.\n";
    }
    if graph.order.iter().any(|&i| !graph.nodes[i].parameters.relative_numbers().is_empty()) {
        text += "Numbers relative to data are known with the data: a run says what they become, and `voltet info` of this file those of widgets.\n";
    }
    if !exhaustive {
        text += "Left out once the data is known: cells and widgets that no value touches (or the asking, where a sample says \
                 that it would not pay), cells out of view or under a pixel's reach. `voltet run --exhaustive` does everything, and says what that costs.\n";
    }
    text
}

/// True if some transfer function has bands.
fn waves(graph: &Graph) -> bool {
    let mut kinds =
        graph.order.iter().flat_map(|&i| graph.nodes[i].parameters.kinds("widgets").unwrap_or_default());
    kinds.any(|(kind, _)| kind.ends_with("-wave"))
}

/// Request to a node, where it says more than the node's type.
fn asked(node: &GraphNode, demand: &Demand) -> Option<String> {
    let first = node.node.outputs.first()?.port_type;
    let mut asked: Vec<String> = Vec::new();
    if first == PortType::Grid || first == PortType::Volume {
        asked.extend(demand.arrays.named.iter().map(|name| format!("array \"{name}\"")));
        asked.extend(demand.cell_arrays.named.iter().map(|name| format!("cell array \"{name}\"")));
        asked.extend(demand.arrays.and_all_others.then(|| "every array".to_string()));
    }
    if first == PortType::Volume {
        asked.extend(demand.gradient_magnitude.then(|| "gradient magnitude".to_string()));
        asked.extend(demand.gradient.then(|| "gradient vectors".to_string()));
    }
    (!asked.is_empty()).then(|| format!("asked for {}", asked.join(", ")))
}
