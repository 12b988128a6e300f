//! `voltet nodes`: the reference of node types, made from their declarations.

use super::DONE;
use crate::arguments::Nodes;
use crate::core::Result;
use crate::core::graph::{Node, Registry};
use crate::present::{node_markdown, node_text};

pub fn nodes(arguments: &Nodes, registry: &Registry) -> Result<u8> {
    let shown: Vec<&Node> = match &arguments.name {
        Some(name) => vec![registry.find(name)?],
        None => registry.iter().collect(),
    };
    if arguments.markdown {
        println!("# Node types\n");
        shown.iter().for_each(|node| println!("{}", node_markdown(node)));
    } else if arguments.name.is_some() {
        shown.iter().for_each(|node| print!("{}", node_text(node)));
    } else {
        let width = shown.iter().map(|node| node.name.len()).max().unwrap_or(0);
        shown.iter().for_each(|node| println!("{:width$}  {}", node.name, node.summary));
        println!("\nvoltet nodes NAME shows one with its ports, parameters and an example.");
    }
    Ok(DONE)
}
