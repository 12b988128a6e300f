//! TOML to [`Pipeline`], every key and value with its place.

use super::document::{FORMAT, Pipeline};
use crate::{Field, LinkEntry, LocatedValue, NodeEntry, ParameterValue, SourceSpan, suggest};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};
use voltet_core::{Error, Result};

/// The top-level table that belongs to the node editor: positions, notes, frames. Nothing that runs looks at it.
pub const EDITOR: &str = "editor";

/// All that a text states, as far as it can be read, and all that is wrong with its form.
#[derive(Debug, Clone, Default)]
pub struct ParsedPipeline {
    /// The part that could be read.
    pub pipeline: Pipeline,
    /// The table `[editor]`, where there is one; its own form is checked by the editor alone.
    pub editor: Vec<Field>,
    /// True if the text is TOML at all; what follows the place where it is not may be missing.
    pub is_toml: bool,
    /// Mistakes, in the order in which [`Pipeline::parse`] finds it; with places.
    pub faults: Vec<Error>,
}

impl Pipeline {
    /// Reads the text of a pipeline file. Errors point at the text.
    pub fn parse(text: &str) -> Result<Pipeline> {
        let ParsedPipeline { pipeline, faults, .. } = Self::survey(text);
        faults.into_iter().next().map_or(Ok(pipeline), Err)
    }

    /// Like [`Pipeline::parse`], for a text with mistakes: its readable part, and every mistake.
    pub fn survey(text: &str) -> ParsedPipeline {
        let mut survey = read(text);
        for fault in &mut survey.faults {
            // Errors carry the byte range only; line and column follow from the text.
            if let Some(span) = fault.location.span.take() {
                *fault = fault.clone().at_span(text, span);
            }
        }
        survey
    }
}

fn read(text: &str) -> ParsedPipeline {
    let (table, errors) = DeTable::parse_recoverable(text);
    let mut survey = ParsedPipeline { is_toml: errors.is_empty(), ..ParsedPipeline::default() };
    let ParsedPipeline { pipeline, editor, faults, .. } = &mut survey;
    faults.extend(errors.into_iter().map(|error| not_toml(error, text)));
    let (theirs, ours): (Vec<_>, Vec<_>) =
        in_order(table.get_ref()).partition(|(key, _)| key.get_ref() == EDITOR);
    // Nobody who runs the file is told of mistakes in what belongs to the editor.
    let fields = theirs.into_iter().map(|(key, value)| field(key, value, &mut Vec::new()));
    editor.extend(fields.flat_map(|field| field.setting.table().unwrap_or_default().to_vec()));
    let top: Vec<Field> = ours.into_iter().map(|(key, value)| field(key, value, faults)).collect();
    let known = ["pipeline", "nodes"];
    let unknown = top.iter().filter(|f| !known.contains(&f.name.as_str()));
    faults.extend(unknown.map(|field| unknown_key(field, &known, "a pipeline file")));
    let find = |name: &str| top.iter().find(|f| f.name == name);
    pipeline.title = read_header(find("pipeline"), faults);
    if let Some(field) = find("nodes") {
        match field.setting.table() {
            None => {
                faults.push(field.setting.error("'nodes' must hold a table for each node", "[nodes.NAME]"));
            }
            Some(entries) => {
                pipeline.nodes.extend(entries.iter().filter_map(|entry| read_node(entry, faults)))
            }
        }
    }
    if pipeline.nodes.is_empty() && faults.is_empty() {
        faults.push(Error::usage("the pipeline has no nodes").expected("a table [nodes.NAME] for each node"));
    }
    survey
}

fn not_toml(error: toml::de::Error, text: &str) -> Error {
    let end = text.len();
    let span = error.span().unwrap_or(end..end);
    let what = format!("the file is not valid TOML: {}", error.message().replace('\n', ", "));
    SourceSpan::Span(span).locate(Error::usage(what))
}

/// The table `[pipeline]`: the format, which must be known, and the title.
fn read_header(header: Option<&Field>, faults: &mut Vec<Error>) -> Option<String> {
    let form = format!("[pipeline] with format = {FORMAT}");
    let Some(header) = header else {
        faults.push(Error::usage("the file does not state its format").expected(form));
        return None;
    };
    let Some(fields) = header.setting.table() else {
        faults.push(header.setting.error("'pipeline' must be a table", form));
        return None;
    };
    let known = ["format", "title"];
    let unknown = fields.iter().filter(|f| !known.contains(&f.name.as_str()));
    faults.extend(unknown.map(|field| unknown_key(field, &known, "[pipeline]")));
    let find = |name: &str| fields.iter().find(|f| f.name == name).map(|f| &f.setting);
    match find("format") {
        None => {
            let error = Error::usage("[pipeline] does not state its format");
            faults.push(header.origin.locate(error.expected(format!("format = {FORMAT}"))));
        }
        Some(setting) if setting.datum != ParameterValue::Integer(FORMAT) => {
            faults.push(setting.error("this program does not know the format", FORMAT));
        }
        Some(_) => {}
    }
    let title = find("title")?;
    if title.text().is_none() {
        faults.push(title.error("the title must be text", "title = \"…\""));
    }
    title.text().map(str::to_string)
}

/// One table `[nodes.NAME]`; a node without a type is of the type "".
fn read_node(entry: &Field, faults: &mut Vec<Error>) -> Option<NodeEntry> {
    let mut fault = |error: Error| faults.push(entry.origin.locate(error.at_node(&entry.name)));
    let Some(fields) = entry.setting.table() else {
        fault(entry.setting.error("a node must be a table", format!("[nodes.{}]", entry.name)));
        return None;
    };
    let node_type =
        fields.iter().find(|f| f.name == "type").map(|f| f.setting.clone()).unwrap_or_else(|| {
            let error = Error::usage(format!("the node '{}' has no type", entry.name));
            fault(error.expected("type = \"…\"; `voltet nodes` lists the types"));
            LocatedValue { datum: ParameterValue::Text(String::new()), origin: entry.origin.clone() }
        });
    let mut inputs = Vec::new();
    if let Some(field) = fields.iter().find(|f| f.name == "inputs") {
        match field.setting.table() {
            Some(links) => inputs.extend(links.iter().map(|link| LinkEntry {
                port: link.name.clone(),
                origin: link.origin.clone(),
                source: link.setting.clone(),
            })),
            None => fault(field.setting.error("'inputs' must be a table", "inputs = { port = \"node\" }")),
        }
    }
    let settings = fields.iter().filter(|f| f.name != "type" && f.name != "inputs").cloned().collect();
    Some(NodeEntry { name: entry.name.clone(), origin: entry.origin.clone(), node_type, settings, inputs })
}

fn unknown_key(field: &Field, known: &[&str], place: &str) -> Error {
    let what = format!("unknown key '{}' in {place}", field.name);
    field.origin.locate(Error::usage(what).expected(suggest(&field.name, known.iter().copied())))
}

type TomlKey<'i> = Spanned<DeString<'i>>;

/// The keys of a table in the order of the file.
fn in_order<'a, 'i>(
    table: &'a DeTable<'i>,
) -> impl Iterator<Item = (&'a TomlKey<'i>, &'a Spanned<DeValue<'i>>)> {
    let mut fields: Vec<_> = table.iter().collect();
    fields.sort_by_key(|(key, _)| key.span().start);
    fields.into_iter()
}

fn field(key: &TomlKey, value: &Spanned<DeValue>, faults: &mut Vec<Error>) -> Field {
    Field {
        name: key.get_ref().to_string(),
        origin: SourceSpan::Span(key.span()),
        setting: setting(value.get_ref(), value.span(), faults),
    }
}

/// A TOML value as a setting; one that can be none as the text that stands there.
fn setting(value: &DeValue, span: std::ops::Range<usize>, faults: &mut Vec<Error>) -> LocatedValue {
    let origin = SourceSpan::Span(span);
    let mut unfit = |text: &str, accepted: &str| {
        let error = Error::usage("this value cannot be used").got(text).expected(accepted);
        faults.push(origin.locate(error));
        ParameterValue::Text(text.to_string())
    };
    let datum = match value {
        DeValue::String(text) => ParameterValue::Text(text.to_string()),
        DeValue::Boolean(flag) => ParameterValue::Boolean(*flag),
        DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
            Ok(n) => ParameterValue::Integer(n),
            Err(_) => unfit(n.as_str(), "a whole number of at most 64 bits"),
        },
        DeValue::Float(x) => match x.as_str().parse::<f64>() {
            Ok(number) if number.is_infinite() && !x.as_str().contains("inf") => {
                unfit(x.as_str(), "a number of at most 1.8e308")
            }
            Ok(number) => ParameterValue::Number(number),
            Err(_) => unfit(x.as_str(), "a number"),
        },
        DeValue::Datetime(date) => unfit(&date.to_string(), "a number, text, list or table; not a date"),
        DeValue::Array(array) => ParameterValue::List(
            array.iter().map(|part| setting(part.get_ref(), part.span(), faults)).collect(),
        ),
        DeValue::Table(table) => {
            ParameterValue::Table(in_order(table).map(|(key, value)| field(key, value, faults)).collect())
        }
    };
    LocatedValue { datum, origin }
}

/// The parameters of one node as TOML text, without the node's head: what stands below `[nodes.NAME]`, lists of tables as
/// `[[widgets]]`. Errors point at the text.
pub fn parameters(text: &str) -> Result<Vec<Field>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    let mut faults: Vec<Error> = errors.into_iter().map(|error| not_toml(error, text)).collect();
    let fields: Vec<Field> =
        in_order(table.get_ref()).map(|(key, value)| field(key, value, &mut faults)).collect();
    faults.extend(fields.iter().filter(|field| matches!(&*field.name, "type" | "inputs")).map(|field| {
        let what = format!("'{}' is no parameter", field.name);
        field.origin.locate(Error::usage(what).expected("parameters alone: type and wires stay"))
    }));
    match faults.into_iter().next() {
        None => Ok(fields),
        Some(mut fault) => Err(match fault.location.span.take() {
            Some(span) => fault.at_span(text, span),
            None => fault,
        }),
    }
}

/// Text read as one TOML value; `None` where it is none.
pub fn value(text: &str) -> Option<LocatedValue> {
    // One line only: what follows a line break would be read as further keys.
    if text.contains('\n') {
        return None;
    }
    let document = format!("value = {text}");
    let table = DeTable::parse(&document).ok()?;
    let mut faults = Vec::new();
    let fields: Vec<Field> =
        in_order(table.get_ref()).map(|(key, value)| field(key, value, &mut faults)).collect();
    match fields.as_slice() {
        [field] if field.name == "value" && faults.is_empty() => Some(field.setting.clone()),
        _ => None,
    }
}
