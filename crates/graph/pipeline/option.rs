//! Options of the command line that change what a file states.

use super::document::Pipeline;
use super::parse;
use crate::{Field, LocatedValue, ParameterValue, SourceSpan, suggest};
use std::sync::Arc;
use voltet_core::{Error, Result};

impl Pipeline {
    /// Carries out an option `node.param=value`: the value is read as TOML, or taken as text where it is none.
    /// Parts of lists and tables are reached by further points (`look.widgets.0.extinction=2`).
    pub fn set(&mut self, option: &str) -> Result<()> {
        let shown: Arc<str> = format!("--set {option}").into();
        let blame = |error: Error| SourceSpan::Option(shown.clone()).locate(error);
        let form = "node.parameter=value";
        let Some((path, value)) = option.split_once('=') else {
            return Err(blame(Error::usage("the option has no '='").expected(form)));
        };
        let keys: Vec<&str> = path.trim().split('.').collect();
        let (Some((&name, keys)), false) = (keys.split_first(), keys.iter().any(|k| k.is_empty())) else {
            return Err(blame(Error::usage("the option names no parameter").expected(form)));
        };
        let Some((&first, rest)) = keys.split_first() else {
            return Err(blame(Error::usage("the option names no parameter").got(path).expected(form)));
        };
        let names: Vec<String> = self.nodes.iter().map(|n| n.name.clone()).collect();
        let Some(node) = self.nodes.iter_mut().find(|n| n.name == name) else {
            let known = suggest(name, names.iter().map(String::as_str));
            return Err(blame(Error::usage(format!("there is no node '{name}'")).expected(known)));
        };
        let setting = given(value, &shown);
        if matches!(first, "type" | "inputs") {
            return Err(blame(
                Error::usage(format!("'{first}' cannot be set from the command line"))
                    .expected("the name of a parameter"),
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

/// The value that an option gives.
fn given(value: &str, shown: &Arc<str>) -> LocatedValue {
    let value = value.trim();
    let mut setting = parse::value(value).unwrap_or_else(|| ParameterValue::Text(value.into()).into());
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
