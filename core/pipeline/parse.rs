//! TOML to [`Pipeline`], every key and value with its place.

use super::document::{FORMAT, Pipeline};
use crate::graph::{Datum, Field, LinkEntry, NodeEntry, Origin, Setting, suggest};
use crate::{Error, Result};
use toml::de::{DeTable, DeValue};

impl Pipeline {
    /// Reads the text of a pipeline file. Errors point at the text.
    pub fn parse(text: &str) -> Result<Pipeline> {
        read(text).map_err(|mut error| {
            // Errors carry the byte range only; line and column follow from the text.
            match error.place.span.take() {
                Some(span) => error.at_span(text, span),
                None => error,
            }
        })
    }
}

fn read(text: &str) -> Result<Pipeline> {
    let table = DeTable::parse(text).map_err(|error| {
        let end = text.len();
        let span = error.span().unwrap_or(end..end);
        Origin::Span(span).blame(Error::usage(format!(
            "the file is not valid TOML: {}",
            error.message().replace('\n', ", ")
        )))
    })?;
    let top = fields(table.get_ref())?;
    let known = ["pipeline", "nodes"];
    if let Some(field) = top.iter().find(|f| !known.contains(&f.name.as_str())) {
        return Err(unknown_key(field, &known, "a pipeline file"));
    }
    let find = |name: &str| top.iter().find(|f| f.name == name);
    let title = read_header(find("pipeline"))?;
    let mut nodes = Vec::new();
    if let Some(field) = find("nodes") {
        let Some(entries) = field.setting.table() else {
            return Err(field.setting.error("'nodes' must hold a table for each node", "[nodes.NAME]"));
        };
        for entry in entries {
            nodes.push(read_node(entry).map_err(|e| entry.origin.blame(e.at_node(&entry.name)))?);
        }
    }
    if nodes.is_empty() {
        return Err(Error::usage("the pipeline has no nodes").accepted("a table [nodes.NAME] for each node"));
    }
    Ok(Pipeline { title, nodes })
}

/// The table `[pipeline]`: the format, which must be known, and the title.
fn read_header(header: Option<&Field>) -> Result<Option<String>> {
    let form = format!("[pipeline] with format = {FORMAT}");
    let Some(header) = header else {
        return Err(Error::usage("the file does not state its format").accepted(form));
    };
    let Some(fields) = header.setting.table() else {
        return Err(header.setting.error("'pipeline' must be a table", form));
    };
    let known = ["format", "title"];
    if let Some(field) = fields.iter().find(|f| !known.contains(&f.name.as_str())) {
        return Err(unknown_key(field, &known, "[pipeline]"));
    }
    let find = |name: &str| fields.iter().find(|f| f.name == name).map(|f| &f.setting);
    match find("format") {
        None => {
            let error = Error::usage("[pipeline] does not state its format");
            return Err(header.origin.blame(error.accepted(format!("format = {FORMAT}"))));
        }
        Some(setting) if setting.datum != Datum::Integer(FORMAT) => {
            return Err(setting.error("this program does not know the format", FORMAT));
        }
        Some(_) => {}
    }
    match find("title") {
        None => Ok(None),
        Some(title) => match title.text() {
            Some(text) => Ok(Some(text.to_string())),
            None => Err(title.error("the title must be text", "title = \"…\"")),
        },
    }
}

/// One table `[nodes.NAME]`.
fn read_node(entry: &Field) -> Result<NodeEntry> {
    let Some(fields) = entry.setting.table() else {
        return Err(entry.setting.error("a node must be a table", format!("[nodes.{}]", entry.name)));
    };
    let Some(node_type) = fields.iter().find(|f| f.name == "type") else {
        let error = Error::usage(format!("the node '{}' has no type", entry.name));
        return Err(error.accepted("type = \"…\"; `voltet nodes` lists the types"));
    };
    let mut inputs = Vec::new();
    if let Some(field) = fields.iter().find(|f| f.name == "inputs") {
        let Some(links) = field.setting.table() else {
            return Err(field.setting.error("'inputs' must be a table", "inputs = { port = \"node\" }"));
        };
        inputs.extend(links.iter().map(|link| LinkEntry {
            port: link.name.clone(),
            origin: link.origin.clone(),
            source: link.setting.clone(),
        }));
    }
    let settings = fields.iter().filter(|f| f.name != "type" && f.name != "inputs").cloned().collect();
    Ok(NodeEntry {
        name: entry.name.clone(),
        origin: entry.origin.clone(),
        node_type: node_type.setting.clone(),
        settings,
        inputs,
    })
}

fn unknown_key(field: &Field, known: &[&str], place: &str) -> Error {
    let what = format!("unknown key '{}' in {place}", field.name);
    field.origin.blame(Error::usage(what).accepted(suggest(&field.name, known.iter().copied())))
}

/// The keys of a table in the order of the file.
fn fields(table: &DeTable) -> Result<Vec<Field>> {
    let mut fields = Vec::with_capacity(table.len());
    for (key, value) in table {
        fields.push((
            key.span().start,
            Field {
                name: key.get_ref().to_string(),
                origin: Origin::Span(key.span()),
                setting: setting(value.get_ref(), value.span())?,
            },
        ));
    }
    fields.sort_by_key(|(start, _)| *start);
    Ok(fields.into_iter().map(|(_, field)| field).collect())
}

/// A TOML value as a setting.
fn setting(value: &DeValue, span: std::ops::Range<usize>) -> Result<Setting> {
    let origin = Origin::Span(span);
    let unfit = |text: &str, accepted: &str| {
        Err(origin.blame(Error::usage("this value cannot be used").found(text).accepted(accepted)))
    };
    let datum = match value {
        DeValue::String(text) => Datum::Text(text.to_string()),
        DeValue::Boolean(flag) => Datum::Boolean(*flag),
        DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
            Ok(n) => Datum::Integer(n),
            Err(_) => return unfit(n.as_str(), "a whole number of at most 64 bits"),
        },
        DeValue::Float(x) => match x.as_str().parse::<f64>() {
            Ok(number) if number.is_infinite() && !x.as_str().contains("inf") => {
                return unfit(x.as_str(), "a number of at most 1.8e308");
            }
            Ok(number) => Datum::Number(number),
            Err(_) => return unfit(x.as_str(), "a number"),
        },
        DeValue::Datetime(date) => {
            return unfit(&date.to_string(), "a number, text, list or table; not a date");
        }
        DeValue::Array(array) => {
            let parts = array.iter().map(|part| setting(part.get_ref(), part.span()));
            Datum::List(parts.collect::<Result<_>>()?)
        }
        DeValue::Table(table) => Datum::Table(fields(table)?),
    };
    Ok(Setting { datum, origin })
}

/// Text read as one TOML value; `None` where it is none.
pub(super) fn value(text: &str) -> Option<Setting> {
    // One line only: what follows a line break would be read as further keys.
    if text.contains('\n') {
        return None;
    }
    let document = format!("value = {text}");
    let table = DeTable::parse(&document).ok()?;
    match fields(table.get_ref()).ok()?.as_slice() {
        [field] if field.name == "value" => Some(field.setting.clone()),
        _ => None,
    }
}
