//! The pipeline file: TOML in, a checked graph out, and back to text.
//!
//! [`Pipeline`] is the document: what a file states, unchecked, with the place of every word, so that each mistake
//! is shown where it stands. [`Pipeline::graph`] checks it against a registry of node types. The table `[editor]` is the
//! node editor's own: it is handed on by [`Pipeline::survey`] and looked at by nothing that runs.

use crate::{
    Field, Graph, LinkEntry, LocatedValue, NodeEntry, ParameterValue, Registry, ResolvedPipeline, SourceSpan,
    suggest, unknown_node,
};
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};
use voltet_core::parameters::key_text;
use voltet_core::{Error, Result};

/// Completes an error about a pipeline file: its path, and line and column for the byte range it points at.
/// Errors about other files are left as they are.
pub fn locate(error: Error, text: &str, path: &std::path::Path) -> Error {
    if error.location.file.is_some() {
        return error;
    }
    placed(error, text).in_file(path)
}

/// Adds line and column to an error that has none and points at a byte range of the text.
fn placed(mut error: Error, text: &str) -> Error {
    match error.location.line_column {
        None => match error.location.span.take() {
            Some(span) => error.at_span(text, span),
            None => error,
        },
        Some(_) => error,
    }
}

/// The format that this program reads and writes.
pub const FORMAT: i64 = 1;

/// A pipeline file as written, unchecked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pipeline {
    /// Title, for people.
    pub title: Option<String>,
    /// The nodes, in the order of the file.
    pub nodes: Vec<NodeEntry>,
}

impl Pipeline {
    /// Checks the document and builds the graph. `folder`: what paths are relative to.
    pub fn graph(&self, registry: &Registry, folder: PathBuf) -> Result<Graph> {
        let mut graph = Graph::build(&self.nodes, registry, folder)?;
        graph.stated = Self::stated(self.to_string(), registry)?;
        Ok(graph)
    }

    /// A text that states a pipeline, with the places of its paths. Errors: it states none.
    pub fn stated(text: String, registry: &Registry) -> Result<ResolvedPipeline> {
        let pipeline = Self::parse(&text)?;
        let graph = Graph::build(&pipeline.nodes, registry, PathBuf::new())?;
        let named = graph.nodes.iter().flat_map(|node| node.parameters.paths());
        Ok(ResolvedPipeline::new(pipeline.title, text, named))
    }
}

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
        let (table, errors) = DeTable::parse_recoverable(text);
        let mut survey = ParsedPipeline { is_toml: errors.is_empty(), ..ParsedPipeline::default() };
        let ParsedPipeline { pipeline, editor, faults, .. } = &mut survey;
        faults.extend(errors.into_iter().map(|error| not_toml(error, text)));
        let (theirs, ours): (Vec<_>, Vec<_>) =
            in_order(table.get_ref()).partition(|(key, _)| key.get_ref() == EDITOR);
        // Nobody who runs the file is told of mistakes in what belongs to the editor.
        let fields = theirs.into_iter().map(|(key, value)| toml_field(key, value, &mut Vec::new()));
        editor.extend(fields.flat_map(|field| field.setting.table().unwrap_or_default().to_vec()));
        let top: Vec<Field> = ours.into_iter().map(|(key, value)| toml_field(key, value, faults)).collect();
        faults.extend(unknown_keys(&top, &["pipeline", "nodes"], "a pipeline file"));
        let find = |name: &str| top.iter().find(|f| f.name == name);
        pipeline.title = read_header(find("pipeline"), faults);
        if let Some(field) = find("nodes") {
            match field.setting.table() {
                None => faults
                    .push(field.setting.error("'nodes' must hold a table for each node", "[nodes.NAME]")),
                Some(entries) => {
                    pipeline.nodes.extend(entries.iter().filter_map(|entry| read_node(entry, faults)))
                }
            }
        }
        if pipeline.nodes.is_empty() && faults.is_empty() {
            let error = Error::usage("the pipeline has no nodes");
            faults.push(error.expected("a table [nodes.NAME] for each node"));
        }
        // Errors carry the byte range only; line and column follow from the text.
        faults.iter_mut().for_each(|fault| *fault = placed(fault.clone(), text));
        survey
    }
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
    faults.extend(unknown_keys(fields, &["format", "title"], "[pipeline]"));
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

fn unknown_keys(fields: &[Field], known: &[&str], place: &str) -> impl Iterator<Item = Error> {
    let unknown = fields.iter().filter(|field| !known.contains(&field.name.as_str()));
    unknown.map(move |field| {
        let what = format!("unknown key '{}' in {place}", field.name);
        field.origin.locate(Error::usage(what).not_among(&field.name, known.iter().copied()))
    })
}

type TomlKey<'i> = Spanned<DeString<'i>>;

fn in_order<'a, 'i>(
    table: &'a DeTable<'i>,
) -> impl Iterator<Item = (&'a TomlKey<'i>, &'a Spanned<DeValue<'i>>)> {
    let mut fields: Vec<_> = table.iter().collect();
    fields.sort_by_key(|(key, _)| key.span().start);
    fields.into_iter()
}

fn toml_fields(table: &DeTable, faults: &mut Vec<Error>) -> Vec<Field> {
    in_order(table).map(|(key, value)| toml_field(key, value, faults)).collect()
}

fn toml_field(key: &TomlKey, value: &Spanned<DeValue>, faults: &mut Vec<Error>) -> Field {
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
        DeValue::Table(table) => ParameterValue::Table(toml_fields(table, faults)),
    };
    LocatedValue { datum, origin }
}

/// The parameters of one node as TOML text, without the node's head: what stands below `[nodes.NAME]`, lists of tables as
/// `[[widgets]]`. Errors point at the text.
pub fn parameters(text: &str) -> Result<Vec<Field>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    let mut faults: Vec<Error> = errors.into_iter().map(|error| not_toml(error, text)).collect();
    let fields = toml_fields(table.get_ref(), &mut faults);
    faults.extend(fields.iter().filter(|field| matches!(&*field.name, "type" | "inputs")).map(|field| {
        let what = format!("'{}' is no parameter", field.name);
        field.origin.locate(Error::usage(what).expected("parameters alone: type and wires stay"))
    }));
    faults.into_iter().next().map_or(Ok(fields), |fault| Err(placed(fault, text)))
}

/// Text read as one TOML value; `None` where it is none.
pub fn value(text: &str) -> Option<LocatedValue> {
    let document = format!("value = {text}");
    let table = DeTable::parse(&document).ok()?;
    let mut faults = Vec::new();
    let fields = toml_fields(table.get_ref(), &mut faults);
    match fields.as_slice() {
        [field] if field.name == "value" && faults.is_empty() => Some(field.setting.clone()),
        _ => None,
    }
}

impl Pipeline {
    /// Form of an option, as far as `path` says what it means.
    fn option_form(&self, path: &str) -> String {
        let name = path.trim().split('.').next().unwrap_or_default();
        match self.nodes.iter().find(|node| node.name == name) {
            Some(NodeEntry { node_type, .. }) => {
                let node_type = node_type.text().unwrap_or("TYPE");
                format!("{name}.PARAMETER=value; `voltet nodes {node_type}` shows the parameters")
            }
            None => {
                let known = suggest(name, self.nodes.iter().map(|node| node.name.as_str()));
                format!("NODE.PARAMETER=value, where NODE is {known}")
            }
        }
    }

    /// Carries out an option `node.param=value`: the value is read as TOML, or taken as text where it is none.
    /// Parts of lists and tables are reached by further points (`look.widgets.0.extinction=2`).
    pub fn set(&mut self, option: &str) -> Result<()> {
        let shown: Arc<str> = format!("--set {option}").into();
        let blame = |error: Error| SourceSpan::Option(shown.clone()).locate(error);
        let Some((path, value)) = option.split_once('=') else {
            return Err(blame(Error::usage("the option has no '='").expected(self.option_form(option))));
        };
        let form = self.option_form(path);
        let keys: Vec<&str> = path.trim().split('.').collect();
        let (Some((&name, keys)), false) = (keys.split_first(), keys.iter().any(|k| k.is_empty())) else {
            return Err(blame(Error::usage("the option names no parameter").expected(form)));
        };
        let Some((&first, rest)) = keys.split_first() else {
            return Err(blame(Error::usage("the option names no parameter").got(path).expected(form)));
        };
        let names: Vec<String> = self.nodes.iter().map(|n| n.name.clone()).collect();
        let Some(node) = self.nodes.iter_mut().find(|n| n.name == name) else {
            return Err(blame(unknown_node(name, names.iter().map(String::as_str))));
        };
        let setting = given(value, &shown);
        if matches!(first, "type" | "inputs") {
            return Err(blame(
                Error::usage(format!("'{first}' cannot be set from the command line"))
                    .expected(format!("the name of a parameter: {form}")),
            ));
        }
        node.set(first, rest, setting).map_err(blame)
    }
}

/// The setting of an option `name=value` where no node need be named: the value is read as TOML, or taken as text where it is
/// none.
pub fn field(option: &str) -> Result<Field> {
    let shown: Arc<str> = format!("--set {option}").into();
    match option.split_once('=').map(|(name, value)| (name.trim(), value)) {
        Some((name, value)) if !name.is_empty() => Ok(Field {
            name: name.into(),
            origin: SourceSpan::Option(shown.clone()),
            setting: given(value, &shown),
        }),
        _ => {
            let error = Error::usage("the option sets no parameter").expected("name=value");
            Err(SourceSpan::Option(shown).locate(error))
        }
    }
}

fn given(text: &str, shown: &Arc<str>) -> LocatedValue {
    let text = text.trim();
    let mut setting = value(text).unwrap_or_else(|| ParameterValue::Text(text.into()).into());
    mark(&mut setting, &SourceSpan::Option(shown.clone()));
    setting
}

/// Gives a setting and all its parts one origin.
fn mark(setting: &mut LocatedValue, origin: &SourceSpan) {
    setting.origin = origin.clone();
    match &mut setting.datum {
        ParameterValue::List(list) => list.iter_mut().for_each(|part| mark(part, origin)),
        ParameterValue::Table(fields) => fields.iter_mut().for_each(|field| {
            field.origin = origin.clone();
            mark(&mut field.setting, origin);
        }),
        _ => {}
    }
}

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

fn is_tables(datum: &ParameterValue) -> bool {
    matches!(datum, ParameterValue::List(list) if !list.is_empty() && list.iter().all(|part| part.table().is_some()))
}

#[cfg(test)]
mod tests;
