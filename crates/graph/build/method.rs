//! The parameters of a node and, where one of them names a gradient filter or a registered variant, those of the filter or the variant
//! beside them.

use super::entry::NodeEntry;
use super::registry::Registry;
use crate::api::node::Node;
use voltet_core::Error;
use voltet_core::field::Method;
use voltet_core::parameters::{
    FaultSink, Field, LocatedValue, Parameter, ParameterValue, Parameters, SourceSpan, VariantSchema,
    nearest, suggest,
};

/// Checks what an entry sets: against what the node declares, and what the filter or the variant that it names does. `None` where that
/// is not known; what has faults is not to be used.
pub(super) fn survey(
    entry: &NodeEntry,
    node: &'static Node,
    registry: &Registry,
    fault: FaultSink,
) -> Option<(Parameters, Option<Method>)> {
    let mut settings = entry.settings.clone();
    let chosen = match node.registered_parameter() {
        Some(parameter) => variant(parameter, &mut settings, registry, fault)?,
        None => None,
    };
    let declared = registry.parameters(node, chosen.as_deref());
    let own = |fields: &[Field], fault: FaultSink| {
        let own = Parameters::survey(&declared, fields, &entry.origin, &[], fault);
        match node.registered_parameter() {
            Some(parameter) => {
                own.with_variants(parameter.name, registry.variants(parameter.name).cloned().collect())
            }
            None => own,
        }
    };
    let Some(parameter) = node.method() else { return Some((own(&settings, fault), None)) };
    let given = settings.iter().find(|field| field.name == parameter.name).map(|field| &field.setting);
    let standard = parameter.default.datum().map(Into::into);
    let Some(named) = given.or(standard.as_ref()) else { return Some((own(&settings, fault), None)) };
    let Some(name) = named.text() else {
        let what = format!("'{}' is of the wrong type", parameter.name);
        fault(parameter.name, named.error(what, parameter.parameter_type.describe()));
        return None;
    };
    let filter = match registry.find_filter(name) {
        Ok(filter) => filter,
        Err(error) => {
            fault(parameter.name, named.origin.locate(error));
            return None;
        }
    };
    let kind = filter.declaration();
    let (theirs, rest): (Vec<Field>, Vec<Field>) =
        settings.iter().cloned().partition(|field| declares(kind.parameters, field));
    let (ours, strange): (Vec<Field>, Vec<Field>) =
        rest.into_iter().partition(|field| declares(&declared, field));
    for field in &strange {
        fault(&field.name, field.origin.locate(unknown(field, node, parameter, &kind, registry)));
    }
    // What is missing is missing because of the word.
    let mut is_right = true;
    let theirs = Parameters::survey(kind.parameters, &theirs, &named.origin, &[], &mut |name, error| {
        is_right = false;
        fault(name, error);
    });
    let method = is_right.then(|| Method::new(filter.clone(), theirs.clone()));
    let method = method.and_then(|method| method.map_err(|error| fault(parameter.name, error)).ok());
    let ours = own(&ours, fault);
    Some((ours.and(theirs), Some(method?)))
}

/// The name of the variant that the settings choose, or that is chosen by default; a former name is replaced. `None` where there is no
/// such variant.
fn variant(
    parameter: &Parameter,
    settings: &mut [Field],
    registry: &Registry,
    fault: FaultSink,
) -> Option<Option<String>> {
    let default = parameter.default.datum().map(LocatedValue::from);
    let given =
        settings.iter_mut().find(|field| field.name == parameter.name).map(|field| &mut field.setting);
    let (word, origin) = match given {
        Some(setting) => {
            let alias = setting.text().and_then(|word| registry.alias(parameter.name, word));
            if let Some(alias) = alias {
                setting.datum = ParameterValue::Text(alias.name.into());
            }
            (setting.text().map(String::from), setting.origin.clone())
        }
        None => (default.as_ref().and_then(LocatedValue::text).map(String::from), SourceSpan::Nowhere),
    };
    // A value that is no text is a fault of its own.
    let Some(word) = word else { return Some(None) };
    if registry.variants(parameter.name).any(|variant| variant.schema.name == word) {
        return Some(Some(word));
    }
    let names = registry.variants(parameter.name).map(|variant| variant.schema.name);
    let error = Error::usage(format!("unknown {} '{word}'", parameter.name)).not_among(&word, names);
    fault(parameter.name, origin.locate(error));
    None
}

fn declares(parameters: &[Parameter], field: &Field) -> bool {
    parameters.iter().any(|parameter| parameter.name == field.name)
}

/// The error for a key that neither the node nor the filter has: names those that they have, and the filters that have it.
fn unknown(
    field: &Field,
    node: &Node,
    parameter: &Parameter,
    kind: &VariantSchema,
    registry: &Registry,
) -> Error {
    let own = node.parameters.iter().map(|p| p.name);
    let key = &field.name;
    if nearest(key, own.clone()).is_some() {
        return Error::usage(format!("unknown parameter '{key}'")).not_among(key, own);
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
        .expected(beside + &elsewhere)
}
