//! Options of the command line carried out in the text of a pipeline file: comments and what is not asked for stay.

use toml_edit::{DocumentMut, Item, TableLike, Value};
use voltet_core::Result;
use voltet_core::graph::{Registry, Stated};
use voltet_core::pipeline::Pipeline;

/// The text that states `pipeline`, which `options` (`node.param=value`) made of `text`. Where they cannot be written into it,
/// a plain text that states the same.
pub fn stated(text: &str, options: &[String], pipeline: &Pipeline, registry: &Registry) -> Result<Stated> {
    let written = match options.is_empty() {
        true => Some(text.to_string()),
        false => {
            written(text, options).filter(|text| Pipeline::parse(text).is_ok_and(|read| read == *pipeline))
        }
    };
    Pipeline::stated(written.unwrap_or_else(|| pipeline.to_string()), registry)
}

fn written(text: &str, options: &[String]) -> Option<String> {
    let mut document: DocumentMut = text.parse().ok()?;
    for option in options {
        let (path, value) = option.split_once('=')?;
        let mut keys = path.trim().split('.');
        let node = document.get_mut("nodes")?.as_table_like_mut()?.get_mut(keys.next()?)?;
        let value = value.trim();
        let value = value.parse::<Value>().unwrap_or_else(|_| Value::from(value));
        set(node.as_table_like_mut()?, &keys.collect::<Vec<_>>(), value)?;
    }
    Some(document.to_string())
}

/// Sets what keys lead to in a table, and makes keys that are not there.
fn set(table: &mut dyn TableLike, keys: &[&str], value: Value) -> Option<()> {
    let (first, rest) = keys.split_first()?;
    if rest.is_empty() {
        match table.get_mut(first).and_then(Item::as_value_mut) {
            Some(there) => replace(there, value),
            None => drop(table.insert(first, Item::Value(value))),
        }
        return Some(());
    }
    if table.get(first).is_none() {
        table.insert(first, Item::Value(Value::InlineTable(Default::default())));
    }
    match table.get_mut(first)? {
        Item::ArrayOfTables(tables) => {
            let (number, rest) = rest.split_first()?;
            set(tables.get_mut(number.parse().ok()?)?, rest, value)
        }
        Item::Value(within) => set_within(within, rest, value),
        within => set(within.as_table_like_mut()?, rest, value),
    }
}

/// Sets what keys and numbers lead to in a value.
fn set_within(there: &mut Value, keys: &[&str], value: Value) -> Option<()> {
    match (there, keys) {
        (there, []) => {
            replace(there, value);
            Some(())
        }
        (Value::Array(list), [number, rest @ ..]) => {
            set_within(list.get_mut(number.parse().ok()?)?, rest, value)
        }
        (Value::InlineTable(table), keys) => set(table, keys, value),
        _ => None,
    }
}

/// The spaces and comments around a value that is there stay.
fn replace(there: &mut Value, mut value: Value) {
    *value.decor_mut() = there.decor().clone();
    *there = value;
}
