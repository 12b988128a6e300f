//! Checks of settings against their declarations: tables, their entries, and each value by its type.

use super::check::{ParameterFault, Parameters};
use super::declaration::{DefaultValue, Parameter, ParameterType, VariantSchema};
use super::nearest::suggest;
use super::range::Range;
use super::setting::{Field, LocatedValue, ParameterValue, SourceSpan};
use crate::{Error, Result};
use std::borrow::Cow;

impl Parameters {
    /// Checks the fields of a table (written at `origin`) against the declarations: unknown and missing names,
    /// types, ranges, also within tables and lists of tables. `also` are keys that the caller has taken.
    pub fn check(
        declared: impl Into<Cow<'static, [Parameter]>>,
        fields: &[Field],
        origin: &SourceSpan,
        also: &[&str],
    ) -> Result<Parameters> {
        let mut faults = Vec::new();
        let parameters = Self::survey(declared, fields, origin, also, &mut faults);
        faults.into_iter().next().map_or(Ok(parameters), |fault| Err(fault.error))
    }

    /// Checks like [`Parameters::check`] and returns every mistake, in the order found. A wrong setting is set nevertheless: parameters
    /// with mistakes are not to be used.
    pub fn survey(
        declared: impl Into<Cow<'static, [Parameter]>>,
        fields: &[Field],
        origin: &SourceSpan,
        also: &[&str],
        faults: &mut Vec<ParameterFault>,
    ) -> Parameters {
        let declared = declared.into();
        let mut settings: Vec<Option<LocatedValue>> = vec![None; declared.len()];
        for field in fields {
            if also.contains(&field.name.as_str()) {
                continue;
            }
            let mut add = |error| faults.push(ParameterFault { parameter: field.name.clone(), error });
            let Some(i) = declared.iter().position(|p| p.name == field.name) else {
                let names = also.iter().copied().chain(declared.iter().map(|p| p.name));
                let error = Error::usage(format!("unknown parameter '{}'", field.name))
                    .expected(suggest(&field.name, names));
                add(field.origin.locate(error));
                continue;
            };
            survey_type(
                &declared[i].parameter_type,
                declared[i].name,
                declared[i].unit,
                &field.setting,
                &mut add,
            );
            settings[i] = Some(field.setting.clone());
        }
        let given: Vec<bool> = settings.iter().map(Option::is_some).collect();
        for (parameter, setting) in declared.iter().zip(&mut settings) {
            if setting.is_some() {
                continue;
            }
            if let DefaultValue::Required = parameter.default {
                let error =
                    Error::usage(format!("the parameter '{}' is missing", parameter.name)).expected(format!(
                        "{} = … ({}): {}",
                        parameter.name,
                        parameter.parameter_type.describe(),
                        parameter.help
                    ));
                faults.push(ParameterFault {
                    parameter: parameter.name.to_string(),
                    error: origin.locate(error),
                });
            }
            *setting = parameter.default.datum().map(LocatedValue::from);
        }
        Parameters { declared, settings, is_set: given, origin: origin.clone(), variants: None }
    }

    /// A list of tables of several kinds: each one's kind and parameters. Empty where not set.
    pub fn kinds(&self, name: &str) -> Result<Vec<(&'static str, Parameters)>> {
        let Some(setting) = self.optional(name) else { return Ok(Vec::new()) };
        let declared = self.parameter_type(name);
        let (Some(ParameterType::Kinds(kinds)), Some(list)) = (declared, setting.list()) else {
            return Err(self.mistyped(name));
        };
        let kind = |setting: &LocatedValue| {
            let mut faults = Vec::new();
            let kind = kind_of(kinds, name, setting, &mut |error| faults.push(error));
            match (kind, faults.into_iter().next()) {
                (Some(kind), None) => Ok(kind),
                (_, fault) => Err(fault.unwrap_or_else(|| self.mistyped(name))),
            }
        };
        list.iter().map(kind).collect()
    }
}

/// The kind of one entry of a list of tables, and its parameters; `None` where it has no kind that is known.
fn kind_of(
    kinds: &'static [VariantSchema],
    name: &str,
    setting: &LocatedValue,
    fault: &mut dyn FnMut(Error),
) -> Option<(&'static str, Parameters)> {
    let names = || kinds.iter().map(|k| k.name);
    let Some(fields) = setting.table() else {
        fault(setting.error(format!("each entry of '{name}' must be a table"), "[[…]] with a kind"));
        return None;
    };
    let Some(kind) = fields.iter().find(|f| f.name == "kind") else {
        let error = Error::usage(format!("an entry of '{name}' has no 'kind'"))
            .expected(format!("kind = one of {}", names().collect::<Vec<_>>().join(", ")));
        fault(setting.origin.locate(error));
        return None;
    };
    let word = kind.setting.text().unwrap_or_default();
    let Some(found) = kinds.iter().find(|k| k.name == word) else {
        fault(kind.setting.error("unknown kind", suggest(word, names())));
        return None;
    };
    let mut faults = Vec::new();
    let parameters = Parameters::survey(found.parameters, fields, &setting.origin, &["kind"], &mut faults);
    faults.into_iter().for_each(|one| fault(one.error));
    Some((found.name, parameters))
}

/// Checks one setting against its declared type.
pub(super) fn check_type(
    parameter_type: &ParameterType,
    name: &str,
    unit: &str,
    setting: &LocatedValue,
) -> Result<()> {
    let mut first = None;
    survey_type(parameter_type, name, unit, setting, &mut |error| {
        first.get_or_insert(error);
    });
    first.map_or(Ok(()), Err)
}

/// Checks one value by its type and returns every mistake: a table, or a list of tables, may have several.
fn survey_type(
    parameter_type: &ParameterType,
    name: &str,
    unit: &str,
    setting: &LocatedValue,
    fault: &mut dyn FnMut(Error),
) {
    match (parameter_type, &setting.datum) {
        (ParameterType::Table(declared), ParameterValue::Table(fields)) => {
            let mut faults = Vec::new();
            Parameters::survey(*declared, fields, &setting.origin, &[], &mut faults);
            faults.into_iter().for_each(|one| fault(one.error));
        }
        (ParameterType::Kinds(kinds), ParameterValue::List(list)) => {
            for entry in list {
                kind_of(kinds, name, entry, fault);
            }
        }
        _ => {
            if let Err(error) = check_plain(parameter_type, name, unit, setting) {
                fault(error);
            }
        }
    }
}

/// Checks a setting that has one mistake at most.
fn check_plain(parameter_type: &ParameterType, name: &str, unit: &str, setting: &LocatedValue) -> Result<()> {
    let accepted = || match unit {
        "" => parameter_type.describe(),
        unit => format!("{} ({unit})", parameter_type.describe()),
    };
    let wrong_type = || Err(setting.error(format!("'{name}' is of the wrong type"), accepted()));
    let in_range = |part: &LocatedValue, x: f64, range: &Range| match range.holds(x) {
        true => Ok(()),
        false => Err(part.error(format!("'{name}' is out of range"), accepted())),
    };
    match (parameter_type, &setting.datum) {
        (ParameterType::Boolean, ParameterValue::Boolean(_)) => Ok(()),
        (ParameterType::Integer(range), ParameterValue::Integer(n)) => in_range(setting, *n as f64, range),
        (ParameterType::NumberOr(_, word), ParameterValue::Text(text)) if text == word => Ok(()),
        (
            ParameterType::Number(range) | ParameterType::NumberOr(range, _),
            ParameterValue::Number(_) | ParameterValue::Integer(_),
        ) => in_range(setting, setting.number().unwrap_or(f64::NAN), range),
        (
            ParameterType::Text | ParameterType::GradientFilter | ParameterType::Registered(_),
            ParameterValue::Text(_),
        ) => Ok(()),
        (ParameterType::InputPath | ParameterType::OutputPath, ParameterValue::Text(path)) => {
            match path.is_empty() {
                true => Err(setting.error(format!("'{name}' is empty"), "the path of a file")),
                false => Ok(()),
            }
        }
        (ParameterType::Choice(words), ParameterValue::Text(text)) => match words.iter().any(|w| w.0 == text)
        {
            true => Ok(()),
            false => Err(setting.error(
                format!("'{name}' does not know this word"),
                suggest(text, words.iter().map(|w| w.0)),
            )),
        },
        (ParameterType::Numbers(count, range), ParameterValue::List(list)) => {
            for part in list {
                let Some(x) = part.number() else { return wrong_type() };
                in_range(part, x, range)?;
            }
            match count.is_none_or(|n| n == list.len()) {
                true => Ok(()),
                false => wrong_type(),
            }
        }
        (ParameterType::Integers(count, range), ParameterValue::List(list)) => {
            for part in list {
                let ParameterValue::Integer(n) = part.datum else { return wrong_type() };
                in_range(part, n as f64, range)?;
            }
            if *count == list.len() { Ok(()) } else { wrong_type() }
        }
        (ParameterType::Rows(width), ParameterValue::List(rows)) => {
            for row in rows {
                let Some(numbers) = row.numbers() else { return wrong_type() };
                if width.is_some_and(|n| n != numbers.len()) {
                    return Err(row.error(format!("a row of '{name}' has the wrong length"), accepted()));
                }
                if numbers.iter().any(|x| !x.is_finite()) {
                    return Err(row.error(format!("'{name}' is out of range"), "finite numbers"));
                }
            }
            Ok(())
        }
        (ParameterType::Texts, ParameterValue::List(list)) if list.iter().all(|s| s.text().is_some()) => {
            Ok(())
        }
        (ParameterType::Measured(measured), _) => {
            // 1 is in every range of what may be relative; the others are checked beside it.
            let numbers = measured.replaced(name, setting, &mut |_, _, _| Ok(1.0))?;
            check_type(&measured.plain, name, unit, &numbers).map_err(|error| match error.expected.clone() {
                Some(plain) => error.expected(format!("{plain}, {}", measured.describe())),
                None => error,
            })
        }
        _ => wrong_type(),
    }
}
