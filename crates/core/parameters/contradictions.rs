//! Declarations that contradict themselves.

use super::declaration::{Parameter, ParameterType};
use super::fit::check_type;
use super::setting::LocatedValue;
use crate::{Error, Result};

/// The first name that occurs twice.
pub fn repeated<'a>(names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut seen = Vec::new();
    for name in names {
        if seen.contains(&name) {
            return Some(name);
        }
        seen.push(name);
    }
    None
}

/// Refuses declarations that contradict themselves, also within tables: names must differ, from those `taken` too, help
/// must be there, and a standard value must be one that a file could give. `of`: whose they are, for the message.
pub fn refuse_contradictions(of: &str, parameters: &[Parameter], taken: &[&str]) -> Result<()> {
    if let Some(twice) = repeated(parameters.iter().map(|p| p.name).chain(taken.iter().copied())) {
        return Err(Error::usage(format!("{of} declares '{twice}' twice")));
    }
    for Parameter { name, parameter_type, unit, default: standard, help } in parameters {
        if name.is_empty() || help.is_empty() {
            return Err(Error::usage(format!("the parameter '{name}' of {of} has no name or no help")));
        }
        if let Some(datum) = standard.datum() {
            check_type(parameter_type, name, unit, &LocatedValue::from(datum)).map_err(|error| Error {
                what: format!("of the standard value of {of}, {}", error.what),
                ..error
            })?;
        }
        match parameter_type {
            ParameterType::Table(fields) => refuse_contradictions(of, fields, &[])?,
            ParameterType::Kinds(kinds) => {
                kinds.iter().try_for_each(|kind| refuse_contradictions(of, kind.parameters, &["kind"]))?;
            }
            _ => {}
        }
    }
    Ok(())
}
