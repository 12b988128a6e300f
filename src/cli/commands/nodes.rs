//! `voltet nodes`: the reference of node types and gradient filters, as text and as Markdown, made from their declarations.

use super::shared::{DONE, Outcome};
use crate::cli::arguments::Nodes;
use crate::cli::present::print;
use crate::core::{Error, Result};
use crate::graph::{DefaultValue, Node, Parameter, ParameterType, Port, Registry, VariantSchema};

pub fn nodes(arguments: &Nodes, registry: &Registry) -> Outcome {
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

/// Names of all node types and gradient filters.
pub(super) fn names(registry: &Registry) -> impl Iterator<Item = &'static str> {
    registry.names().chain(filters(registry).map(|filter| filter.name))
}

/// The node type of that name, or else the gradient filter.
pub(super) fn one(name: &str, markdown: bool, registry: &Registry) -> Result<String> {
    if let Some(node) = registry.iter().find(|node| node.name == name) {
        return Ok(if markdown { node_markdown(node, registry) } else { node_text(node, registry) });
    }
    match filters(registry).find(|filter| filter.name == name) {
        Some(filter) => Ok(if markdown { filter_markdown(&filter) } else { filter_text(&filter) }),
        None => {
            let error = Error::usage(format!("unknown node type or gradient filter '{name}'"));
            Err(error.not_among(name, names(registry)))
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

/// Type, unit and standard value of a parameter: "number above 0, degrees; default 30.0".
fn kind(parameter: &Parameter) -> String {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
    let standard = match parameter.default {
        DefaultValue::Required => "required".to_string(),
        other => format!("default: {other}"),
    };
    format!("{}{unit}; {standard}", parameter.parameter_type.describe())
}

/// The declarations of what a parameter may name: gradient filters, or the variants that are registered for it.
fn variants(parameter: &Parameter, registry: &Registry) -> Vec<VariantSchema> {
    match parameter.parameter_type {
        ParameterType::GradientFilter => registry.filters().map(|filter| filter.declaration()).collect(),
        ParameterType::Registered(_) => {
            registry.variants(parameter.name).map(|variant| variant.schema).collect()
        }
        _ => Vec::new(),
    }
}

/// The reference of one gradient filter, for a terminal.
fn filter_text(kind: &VariantSchema) -> String {
    let mut text =
        format!("{}\n\n{}\n\nA gradient filter: method = \"{}\"\n", kind.name, kind.summary, kind.name);
    if !kind.parameters.is_empty() {
        text += "\nParameters, beside method:\n";
        kind.parameters.iter().for_each(|parameter| text += &parameter_text(parameter, "  ", &[]));
    }
    text
}

/// The reference of one gradient filter as Markdown.
fn filter_markdown(kind: &VariantSchema) -> String {
    let mut text =
        format!("## {}\n\n{}\n\nA gradient filter: `method = \"{}\"`.\n", kind.name, kind.summary, kind.name);
    if !kind.parameters.is_empty() {
        text += &parameters_markdown("key beside `method`", kind.parameters);
    }
    text
}

/// The reference of one node type, for a terminal.
fn node_text(node: &Node, registry: &Registry) -> String {
    let mut text = format!("{}\n\n{}\n", node.name, node.summary);
    let kinds =
        [("Inputs", node.inputs), ("Optional inputs", node.optional_inputs), ("Outputs", node.outputs)];
    for (title, ports) in kinds {
        if !ports.is_empty() {
            text += &format!("\n{title}:\n");
            let width = ports.iter().map(|p| p.name.len()).max().unwrap_or(0);
            let line = |port: &Port| {
                format!("  {:width$}  {}: {}\n", port.name, port.port_type.name(), port.summary)
            };
            text.extend(ports.iter().map(line));
        }
    }
    if !node.parameters.is_empty() {
        text += "\nParameters:\n";
        for parameter in node.parameters {
            text += &parameter_text(parameter, "  ", &variants(parameter, registry));
        }
    }
    let example = node.example.trim_end().replace('\n', "\n  ").replace("\n  \n", "\n\n");
    text + &format!("\nExample:\n\n  {example}\n")
}

/// `named`: the declarations of what the parameter may name.
fn parameter_text(parameter: &Parameter, indent: &str, named: &[VariantSchema]) -> String {
    let mut text =
        format!("{indent}{} ({})\n{indent}    {}\n", parameter.name, kind(parameter), parameter.help);
    let deeper = format!("{indent}    ");
    let kinds_text = |key: &str, kinds: &[VariantSchema]| {
        let inner = format!("{deeper}    ");
        let kind_text = |kind: &VariantSchema| {
            let fields = kind.parameters.iter().map(|field| parameter_text(field, &inner, &[]));
            format!("{deeper}{key} = \"{}\": {}\n", kind.name, kind.summary) + &fields.collect::<String>()
        };
        kinds.iter().map(kind_text).collect::<String>()
    };
    for (word, meaning) in parameter.parameter_type.words() {
        text += &format!("{deeper}{word}: {meaning}\n");
    }
    match parameter.parameter_type {
        ParameterType::Table(fields) => {
            fields.iter().for_each(|field| text += &parameter_text(field, &deeper, &[]));
        }
        ParameterType::Kinds(kinds) => text += &kinds_text("kind", kinds),
        ParameterType::GradientFilter | ParameterType::Registered(_) => {
            text += &kinds_text(parameter.name, named);
        }
        _ => {}
    }
    text
}

/// The reference of one node type as Markdown.
fn node_markdown(node: &Node, registry: &Registry) -> String {
    let mut text = format!("## {}\n\n{}\n", node.name, node.summary);
    let kinds = [("input", node.inputs), ("optional input", node.optional_inputs), ("output", node.outputs)];
    for (title, ports) in kinds {
        if !ports.is_empty() {
            text += &format!("\n| {title} | type | |\n| --- | --- | --- |\n");
            for port in ports {
                text += &format!("| `{}` | {} | {} |\n", port.name, port.port_type.name(), port.summary);
            }
        }
    }
    if !node.parameters.is_empty() {
        text += &parameters_markdown("parameter", node.parameters);
    }
    for parameter in node.parameters {
        match parameter.parameter_type {
            ParameterType::Table(fields) => {
                text += &format!("\nKeys of `{}`:\n", parameter.name);
                text += &parameters_markdown("key", fields);
            }
            ParameterType::Kinds(kinds) => {
                for kind in kinds {
                    text += &format!("\n`{}` of kind `{}`: {}\n", parameter.name, kind.name, kind.summary);
                    text += &parameters_markdown("key", kind.parameters);
                }
            }
            ParameterType::GradientFilter | ParameterType::Registered(_) => {
                let all = variants(parameter, registry);
                let title = match parameter.parameter_type {
                    ParameterType::GradientFilter => "gradient filter",
                    _ => parameter.name,
                };
                text += &format!("\n| {title} | |\n| --- | --- |\n");
                text.extend(all.iter().map(|kind| format!("| `{}` | {} |\n", kind.name, kind.summary)));
                for kind in all.iter().filter(|kind| !kind.parameters.is_empty()) {
                    text += &format!("\nKeys beside `{} = \"{}\"`:\n", parameter.name, kind.name);
                    text += &parameters_markdown("key", kind.parameters);
                }
            }
            _ => {}
        }
    }
    text
}

/// Meaning of each word of a choice, a line of the table's cell each.
fn meanings(parameter: &Parameter) -> String {
    let words = parameter.parameter_type.words().iter();
    words.map(|(word, meaning)| format!("<br>`{word}`: {meaning}")).collect()
}

fn parameters_markdown(title: &str, parameters: &[Parameter]) -> String {
    let mut text = format!("\n| {title} | type; default | |\n| --- | --- | --- |\n");
    for parameter in parameters {
        let escape = |text: &str| text.replace('|', "\\|");
        text += &format!(
            "| `{}` | {} | {} |\n",
            parameter.name,
            escape(&kind(parameter)),
            escape(&(parameter.help.to_string() + &meanings(parameter)))
        );
    }
    text
}
