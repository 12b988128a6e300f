//! [`Pipeline`] to text: what is read back is equal, node by node.

use super::document::{FORMAT, Pipeline};
use crate::{Field, NodeEntry, ParameterValue};
use std::fmt;
use voltet_core::parameters::key_text;

impl fmt::Display for Pipeline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[pipeline]\nformat = {FORMAT}")?;
        if let Some(title) = &self.title {
            writeln!(f, "title = {}", ParameterValue::Text(title.clone()))?;
        }
        self.nodes.iter().try_for_each(|node| write_node(f, node))
    }
}

fn write_node(f: &mut fmt::Formatter<'_>, node: &NodeEntry) -> fmt::Result {
    let name = key_text(&node.name);
    writeln!(f, "\n[nodes.{name}]\ntype = {}", node.node_type.datum)?;
    // Lists of tables follow as tables of their own, after the plain keys, as TOML asks.
    let (tables, plain): (Vec<&Field>, Vec<&Field>) =
        node.settings.iter().partition(|s| is_tables(&s.setting.datum));
    for field in plain {
        writeln!(f, "{} = {}", key_text(&field.name), field.setting.datum)?;
    }
    if !node.inputs.is_empty() {
        let links: Vec<String> = node
            .inputs
            .iter()
            .map(|link| format!("{} = {}", key_text(&link.port), link.source.datum))
            .collect();
        writeln!(f, "inputs = {{ {} }}", links.join(", "))?;
    }
    for field in tables {
        for entry in field.setting.list().unwrap_or_default() {
            writeln!(f, "\n[[nodes.{name}.{}]]", key_text(&field.name))?;
            for key in entry.table().unwrap_or_default() {
                writeln!(f, "{} = {}", key_text(&key.name), key.setting.datum)?;
            }
        }
    }
    Ok(())
}

/// True if a value is a list of tables.
fn is_tables(datum: &ParameterValue) -> bool {
    match datum {
        ParameterValue::List(list) => !list.is_empty() && list.iter().all(|part| part.table().is_some()),
        _ => false,
    }
}
