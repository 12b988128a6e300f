//! The reference of a node type, as text and as Markdown, from its declaration.

use crate::core::graph::{Node, Parameter, ParameterType, Port};

/// Type, unit and standard value of a parameter: "number above 0, degrees; default 30.0".
fn kind(parameter: &Parameter) -> String {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
    let standard = match parameter.standard {
        crate::core::graph::Standard::Required => "required".to_string(),
        other => format!("default: {other}"),
    };
    format!("{}{unit}; {standard}", parameter.parameter_type.describe())
}

/// The reference of one node type, for a terminal.
pub fn node_text(node: &Node) -> String {
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
        node.parameters.iter().for_each(|parameter| text += &parameter_text(parameter, "  "));
    }
    let example = node.example.trim_end().replace('\n', "\n  ").replace("\n  \n", "\n\n");
    text + &format!("\nExample:\n\n  {example}\n")
}

fn parameter_text(parameter: &Parameter, indent: &str) -> String {
    let mut text =
        format!("{indent}{} ({})\n{indent}    {}\n", parameter.name, kind(parameter), parameter.help);
    let deeper = format!("{indent}    ");
    match parameter.parameter_type {
        ParameterType::Choice(words) => {
            for (word, meaning) in words {
                text += &format!("{deeper}{word}: {meaning}\n");
            }
        }
        ParameterType::Table(fields) => {
            fields.iter().for_each(|field| text += &parameter_text(field, &deeper));
        }
        ParameterType::Kinds(kinds) => {
            for kind in kinds {
                text += &format!("{deeper}kind = \"{}\": {}\n", kind.name, kind.summary);
                let inner = format!("{deeper}    ");
                kind.parameters.iter().for_each(|field| text += &parameter_text(field, &inner));
            }
        }
        _ => {}
    }
    text
}

/// The reference of one node type as Markdown.
pub fn node_markdown(node: &Node) -> String {
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
            _ => {}
        }
    }
    text
}

fn parameters_markdown(title: &str, parameters: &[Parameter]) -> String {
    let mut text = format!("\n| {title} | type; default | |\n| --- | --- | --- |\n");
    for parameter in parameters {
        let escape = |text: &str| text.replace('|', "\\|");
        text += &format!(
            "| `{}` | {} | {} |\n",
            parameter.name,
            escape(&kind(parameter)),
            escape(parameter.help)
        );
    }
    text
}
