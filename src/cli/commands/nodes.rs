//! `voltet nodes`: the reference of node types and gradient filters, made from their declarations.

use super::exit_status::DONE;
use crate::cli::arguments::Nodes;
use crate::cli::present::{filter_markdown, filter_text, node_markdown, node_text, print};
use crate::core::{Error, Result};
use crate::graph::{Registry, VariantSchema, suggest};

pub fn nodes(arguments: &Nodes, registry: &Registry) -> Result<u8> {
    let page = || registry.iter().map(|node| node_markdown(node, registry) + "\n").collect::<String>();
    print(&match (&arguments.name, arguments.markdown) {
        (Some(name), markdown) => one(name, markdown, registry)?,
        (None, true) => format!("# Node types\n\n{}", page()),
        (None, false) => list(registry),
    })?;
    Ok(DONE)
}

fn filters(registry: &Registry) -> impl Iterator<Item = VariantSchema> {
    registry.filters().map(|filter| filter.declaration())
}

/// The node type of that name, or else the gradient filter.
fn one(name: &str, markdown: bool, registry: &Registry) -> Result<String> {
    if let Some(node) = registry.iter().find(|node| node.name == name) {
        return Ok(if markdown { node_markdown(node, registry) } else { node_text(node, registry) });
    }
    match filters(registry).find(|filter| filter.name == name) {
        Some(filter) => Ok(if markdown { filter_markdown(&filter) } else { filter_text(&filter) }),
        None => {
            let names = registry.names().chain(filters(registry).map(|filter| filter.name));
            let error = Error::usage(format!("unknown node type or gradient filter '{name}'"));
            Err(error.expected(suggest(name, names)))
        }
    }
}

/// All of them, a line each.
fn list(registry: &Registry) -> String {
    let nodes: Vec<(&str, &str)> = registry.iter().map(|node| (node.name, node.summary)).collect();
    let filters: Vec<(&str, &str)> = filters(registry).map(|filter| (filter.name, filter.summary)).collect();
    let width = nodes.iter().chain(&filters).map(|(name, _)| name.len()).max().unwrap_or(0);
    let line = |(name, summary): &(&str, &str)| format!("{name:width$}  {summary}\n");
    let naming = registry.iter().filter(|node| node.method().is_some()).map(|node| node.name);
    format!(
        "Node types\n\n{}\nGradient filters, for the parameter method of {}\n\n{}\n\
         voltet nodes NAME shows one with its ports, parameters and an example.\n",
        nodes.iter().map(line).collect::<String>(),
        naming.collect::<Vec<_>>().join(", "),
        filters.iter().map(line).collect::<String>(),
    )
}
