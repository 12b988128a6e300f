//! Options of the command line that change what a file states.

use super::document::Pipeline;
use super::parse;
use crate::graph::{Datum, Origin, Setting, suggest};
use crate::{Error, Result};
use std::sync::Arc;

impl Pipeline {
    /// Carries out an option `node.param=value`: the value is read as TOML, or taken as text where it is none.
    /// Parts of lists and tables are reached by further points (`look.widgets.0.extinction=2`).
    pub fn set(&mut self, option: &str) -> Result<()> {
        let shown: Arc<str> = format!("--set {option}").into();
        let blame = |error: Error| Origin::Option(shown.clone()).blame(error);
        let form = "node.parameter=value";
        let Some((path, value)) = option.split_once('=') else {
            return Err(blame(Error::usage("the option has no '='").accepted(form)));
        };
        let keys: Vec<&str> = path.trim().split('.').collect();
        let (Some((&name, keys)), false) = (keys.split_first(), keys.iter().any(|k| k.is_empty())) else {
            return Err(blame(Error::usage("the option names no parameter").accepted(form)));
        };
        let Some((&first, rest)) = keys.split_first() else {
            return Err(blame(Error::usage("the option names no parameter").found(path).accepted(form)));
        };
        let names: Vec<String> = self.nodes.iter().map(|n| n.name.clone()).collect();
        let Some(node) = self.nodes.iter_mut().find(|n| n.name == name) else {
            let known = suggest(name, names.iter().map(String::as_str));
            return Err(blame(Error::usage(format!("there is no node '{name}'")).accepted(known)));
        };
        let mut setting =
            parse::value(value.trim()).unwrap_or_else(|| Datum::Text(value.trim().into()).into());
        mark(&mut setting, &Origin::Option(shown.clone()));
        if matches!(first, "type" | "inputs") {
            return Err(blame(
                Error::usage(format!("'{first}' cannot be set from the command line"))
                    .accepted("the name of a parameter"),
            ));
        }
        node.set(first, rest, setting).map_err(blame)
    }
}

/// Gives a setting and all its parts one origin.
fn mark(setting: &mut Setting, origin: &Origin) {
    setting.origin = origin.clone();
    match &mut setting.datum {
        Datum::List(list) => list.iter_mut().for_each(|part| mark(part, origin)),
        Datum::Table(fields) => fields.iter_mut().for_each(|field| {
            field.origin = origin.clone();
            mark(&mut field.setting, origin);
        }),
        _ => {}
    }
}
