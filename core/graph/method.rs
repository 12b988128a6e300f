//! The parameters of a node and, where one of them names a gradient filter, those of the filter beside them.

use super::build::NodeEntry;
use super::declaration::Node;
use super::registry::Registry;
use crate::field::Method;
use crate::parameters::{Field, Kind, Parameter, Parameters, nearest, suggest};
use crate::{Error, Result};

/// Checks what an entry sets: against what the node declares, and what the filter that it names does.
pub(super) fn check(
    entry: &NodeEntry,
    node: &'static Node,
    registry: &Registry,
) -> Result<(Parameters, Option<Method>)> {
    let own = |fields: &[Field]| Parameters::check(node.parameters, fields, &entry.origin, &[]);
    let Some(parameter) = node.method() else { return Ok((own(&entry.settings)?, None)) };
    let given = entry.settings.iter().find(|field| field.name == parameter.name).map(|field| &field.setting);
    let standard = parameter.standard.datum().map(Into::into);
    let Some(named) = given.or(standard.as_ref()) else { return Ok((own(&entry.settings)?, None)) };
    let Some(name) = named.text() else {
        let what = format!("'{}' is of the wrong type", parameter.name);
        return Err(named.error(what, parameter.parameter_type.describe()));
    };
    let filter = registry.find_filter(name).map_err(|error| named.origin.blame(error))?;
    let kind = filter.declaration();
    let (theirs, ours): (Vec<Field>, Vec<Field>) =
        entry.settings.iter().cloned().partition(|field| declares(kind.parameters, field));
    if let Some(field) = ours.iter().find(|field| !declares(node.parameters, field)) {
        return Err(field.origin.blame(unknown(field, node, parameter, &kind, registry)));
    }
    // What is missing is missing because of the word.
    let theirs = Parameters::check(kind.parameters, &theirs, &named.origin, &[])?;
    let method = Method::new(filter.clone(), theirs.clone())?;
    Ok((own(&ours)?.and(theirs), Some(method)))
}

fn declares(parameters: &[Parameter], field: &Field) -> bool {
    parameters.iter().any(|parameter| parameter.name == field.name)
}

/// The error for a key that neither the node nor the filter has: names those that they have, and the filters that have it.
fn unknown(field: &Field, node: &Node, parameter: &Parameter, kind: &Kind, registry: &Registry) -> Error {
    let own = node.parameters.iter().map(|p| p.name);
    let key = &field.name;
    if nearest(key, own.clone()).is_some() {
        return Error::usage(format!("unknown parameter '{key}'")).accepted(suggest(key, own));
    }
    let beside = match kind.parameters {
        [] => "no parameter beside it".to_string(),
        parameters => suggest(key, parameters.iter().map(|p| p.name)),
    };
    let having = registry.filters().map(|filter| filter.declaration());
    let having: Vec<String> = having
        .filter(|other| declares(other.parameters, field))
        .map(|other| format!("{} = \"{}\"", parameter.name, other.name))
        .collect();
    let elsewhere = match having.is_empty() {
        true => String::new(),
        false => format!("; {key} goes with {}", having.join(" or ")),
    };
    Error::usage(format!("the {} \"{}\" has no parameter '{key}'", parameter.name, kind.name))
        .accepted(beside + &elsewhere)
}
