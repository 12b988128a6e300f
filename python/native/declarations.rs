//! Declarations of nodes, filters and widgets, for help, signatures and stubs: those that pipelines are checked against.

use crate::error::guarded;
use crate::filter::registry;
use pyo3::prelude::*;
use serde_json::{Value, json};
use voltet_core::parameters::DefaultValue;
use voltet_graph::{Node, Parameter, ParameterType, Port, Registry, VariantSchema};

/// Node types, gradient filters and kinds of widgets with ports and parameters, as JSON.
#[pyfunction]
pub fn declarations(py: Python<'_>) -> PyResult<String> {
    let registry = guarded(py, registry)?;
    let nodes: Vec<Value> = registry.iter().map(|of| node(of, &registry)).collect();
    let filters: Vec<Value> = registry.filters().map(|filter| kind(&filter.declaration())).collect();
    Ok(json!({ "nodes": nodes, "filters": filters }).to_string())
}

fn node(node: &'static Node, registry: &Registry) -> Value {
    let declared = registry.parameters(node, None);
    let parameter = |parameter: &Parameter| match parameter.parameter_type {
        ParameterType::Registered(_) => {
            let names = registry.variants(parameter.name).map(|variant| variant.schema.name);
            described(parameter, literal(names))
        }
        _ => self::parameter(parameter),
    };
    json!({
        "name": node.name,
        "summary": node.summary,
        "inputs": node.inputs.iter().map(port).collect::<Vec<_>>(),
        "optional_inputs": node.optional_inputs.iter().map(port).collect::<Vec<_>>(),
        "outputs": node.outputs.iter().map(port).collect::<Vec<_>>(),
        "parameters": declared.iter().map(parameter).collect::<Vec<_>>(),
    })
}

fn port(port: &Port) -> Value {
    json!({ "name": port.name, "type": port.port_type.name(), "summary": port.summary })
}

fn kind(kind: &VariantSchema) -> Value {
    let parameters: Vec<Value> = kind.parameters.iter().map(parameter).collect();
    json!({ "name": kind.name, "summary": kind.summary, "parameters": parameters })
}

fn parameter(parameter: &Parameter) -> Value {
    described(parameter, form(&parameter.parameter_type))
}

/// A parameter with what Python takes for it.
fn described(parameter: &Parameter, form: String) -> Value {
    let kinds = match parameter.parameter_type {
        ParameterType::Kinds(kinds) => kinds.iter().map(kind).collect(),
        _ => Vec::new(),
    };
    json!({
        "name": parameter.name,
        "type": parameter.parameter_type.describe(),
        "form": form,
        "unit": parameter.unit,
        "required": matches!(parameter.default, DefaultValue::Required),
        "default": parameter.default.to_string(),
        "help": parameter.help,
        "kinds": kinds,
    })
}

/// The annotation of one of some words.
fn literal(words: impl Iterator<Item = &'static str>) -> String {
    format!("Literal[{}]", words.map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", "))
}

/// Python's annotation of a parameter's type.
fn form(parameter_type: &ParameterType) -> String {
    match parameter_type {
        ParameterType::Boolean => "bool".into(),
        ParameterType::Integer(_) => "int".into(),
        ParameterType::IntegerOr(..) => "int | str".into(),
        ParameterType::Number(_) => "float".into(),
        ParameterType::NumberOr(..) => "float | str".into(),
        ParameterType::Text
        | ParameterType::ArrayName
        | ParameterType::NewArrayName
        | ParameterType::Expression
        | ParameterType::GradientFilter
        | ParameterType::Registered(_) => "str".into(),
        ParameterType::Choice(words) => literal(words.iter().map(|(word, _)| *word)),
        ParameterType::Color(_) => "Sequence[float] | str".into(),
        ParameterType::RowsOr(..) => "str | Sequence[Sequence[float]]".into(),
        ParameterType::InputPath | ParameterType::OutputPath | ParameterType::ChoiceOrPath(..) => {
            "str | PathLike[str]".into()
        }
        ParameterType::Numbers(..) => "Sequence[float]".into(),
        ParameterType::Integers(..) => "Sequence[int]".into(),
        ParameterType::Rows(_) => "Sequence[Sequence[float]]".into(),
        ParameterType::Texts | ParameterType::ArrayNames => "Sequence[str]".into(),
        ParameterType::Table(_) => "Mapping[str, Any]".into(),
        ParameterType::Kinds(_) => "Sequence[Mapping[str, Any]]".into(),
        ParameterType::Measured(measured) => match form(&measured.plain).as_str() {
            "Sequence[float]" => "Sequence[float | str]".into(),
            "Sequence[Sequence[float]]" => "Sequence[Sequence[float | str]]".into(),
            plain if plain.contains("str") => plain.into(),
            plain => format!("{plain} | str"),
        },
    }
}
