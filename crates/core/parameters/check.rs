//! Parameters: settings checked against their declarations, with typed getters, the files that they name, and their relative numbers.

use super::declaration::{
    DefaultValue, Parameter, ParameterType, Range, RelativeNumberType, Variant, VariantSchema,
};
use super::relative::{ArrayRef, RelativeNumber};
use super::setting::{Field, LocatedValue, ParameterValue, SourceSpan, differ_in_names, find_setting};
use crate::nearest::suggest;
use crate::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// The parameters of a node or a gradient filter, or of a table within one: each declared name with the value that the file gives or
/// the standard value. Two are equal when their values are.
#[derive(Debug, Clone, Default)]
pub struct Parameters {
    entries: Vec<Entry>,
    /// Location of the table in the file.
    origin: SourceSpan,
    /// The parameter of type [`ParameterType::Registered`], with all variants of it.
    variants: Option<(&'static str, Arc<[Variant]>)>,
}

#[derive(Debug, Clone)]
struct Entry {
    declared: Parameter,
    /// `None` where the file is silent and there is no standard value.
    setting: Option<LocatedValue>,
    /// True if the file sets it.
    is_set: bool,
}

/// Receiver of the mistakes in what a table sets: the parameter, or the unknown key, and the error with its location.
pub type FaultSink<'a> = &'a mut dyn FnMut(&str, Error);

/// Compares values, of entries without their names; the declarations are assumed equal (one node type).
impl PartialEq for Parameters {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Entry, &Entry)| {
            let has_entries = matches!(a.declared.parameter_type, ParameterType::Kinds(_));
            a.setting == b.setting || has_entries && differ_in_names([&a.setting, &b.setting])
        };
        self.entries.len() == other.entries.len() && self.entries.iter().zip(&other.entries).all(same)
    }
}

impl Parameters {
    /// For a program: some values by name, the standard values for the rest.
    pub fn from_values(
        declared: &[Parameter],
        values: impl IntoIterator<Item = (&'static str, ParameterValue)>,
    ) -> Result<Parameters> {
        let fields: Vec<Field> = values.into_iter().map(|(name, datum)| Field::new(name, datum)).collect();
        Self::check(declared, &fields, &SourceSpan::Nowhere, &[])
    }

    /// These and others, whose names differ from these: what two declarations ask of one table.
    pub fn and(mut self, others: Parameters) -> Parameters {
        self.entries.extend(others.entries);
        self
    }

    /// These with the variants that are registered for a parameter.
    pub fn with_variants(self, name: &'static str, variants: Arc<[Variant]>) -> Parameters {
        Parameters { variants: Some((name, variants)), ..self }
    }

    /// All variants that are registered for a parameter, in the order of registration.
    pub fn variants(&self, name: &str) -> &[Variant] {
        self.variants.as_ref().filter(|(parameter, _)| *parameter == name).map_or(&[], |(_, all)| all)
    }

    /// The variant that a parameter names.
    pub fn variant(&self, name: &str) -> Result<&Variant> {
        let word = self.text(name)?;
        let variants = self.variants(name);
        variants.iter().find(|variant| variant.schema.name == word).ok_or_else(|| {
            let names = variants.iter().map(|variant| variant.schema.name);
            self.error(name, format!("'{word}' is not registered")).not_among(word, names)
        })
    }

    /// The declarations with their values (`None`: not set), and whether the file gave them.
    pub fn iter(&self) -> impl Iterator<Item = (&Parameter, Option<&LocatedValue>, bool)> {
        self.entries.iter().map(|entry| (&entry.declared, entry.setting.as_ref(), entry.is_set))
    }

    fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.declared.name == name)
    }

    /// These with another value for one, as if the file had given it, or not where it is `None`.
    pub fn with(&self, name: &str, datum: Option<ParameterValue>) -> Parameters {
        let mut changed = self.clone();
        for entry in changed.entries.iter_mut().filter(|entry| entry.declared.name == name) {
            entry.is_set = datum.is_some();
            entry.setting = datum.clone().map(LocatedValue::from);
        }
        changed
    }

    /// True if the file (or the command line) gave the parameter.
    pub fn is_set(&self, name: &str) -> bool {
        self.entry(name).is_some_and(|entry| entry.is_set)
    }

    /// The setting, if there is one.
    pub fn optional(&self, name: &str) -> Option<&LocatedValue> {
        self.entry(name)?.setting.as_ref()
    }

    /// The setting; an error when it is neither given nor has a standard value.
    pub fn get(&self, name: &str) -> Result<&LocatedValue> {
        self.optional(name).ok_or_else(|| {
            self.origin.locate(Error::usage(format!("the parameter '{name}' is needed here and is not set")))
        })
    }

    /// An error about a parameter, at its place.
    pub fn error(&self, name: &str, what: impl Into<String>) -> Error {
        self.locate(name, Error::usage(what))
    }

    /// Adds the place of a parameter to an error or, where it was not given, the place of the table.
    pub fn locate(&self, name: &str, error: Error) -> Error {
        match self.optional(name).filter(|_| self.is_set(name)) {
            Some(setting) => setting.origin.locate(error),
            None => self.origin.locate(error),
        }
    }

    /// The setting as what `read` makes of it. Errors: it is neither given nor has a standard value, or is of another type.
    fn typed<'a, T>(&'a self, name: &str, read: impl FnOnce(&'a LocatedValue) -> Option<T>) -> Result<T> {
        read(self.get(name)?).ok_or_else(|| self.mistyped(name))
    }

    /// A number.
    pub fn number(&self, name: &str) -> Result<f64> {
        self.typed(name, LocatedValue::number)
    }

    /// A number, where set.
    pub fn optional_number(&self, name: &str) -> Option<f64> {
        self.optional(name)?.number()
    }

    /// A whole number.
    pub fn integer(&self, name: &str) -> Result<i64> {
        let ParameterValue::Integer(n) = self.get(name)?.datum else { return Err(self.mistyped(name)) };
        Ok(n)
    }

    /// A flag.
    pub fn flag(&self, name: &str) -> Result<bool> {
        let ParameterValue::Boolean(flag) = self.get(name)?.datum else { return Err(self.mistyped(name)) };
        Ok(flag)
    }

    /// Text, a word or a path.
    pub fn text(&self, name: &str) -> Result<&str> {
        self.typed(name, LocatedValue::text)
    }

    /// Several numbers.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        self.typed(name, LocatedValue::numbers)
    }

    /// Exactly `N` numbers.
    pub fn vector<const N: usize>(&self, name: &str) -> Result<[f64; N]> {
        self.typed(name, LocatedValue::array)
    }

    /// A colour in linear RGB.
    pub fn color(&self, name: &str) -> Result<[f64; 3]> {
        self.typed(name, LocatedValue::color)
    }

    /// A colour in linear RGB, where set.
    pub fn optional_color(&self, name: &str) -> Result<Option<[f64; 3]>> {
        self.optional(name).map(|_| self.color(name)).transpose()
    }

    /// Rows of numbers.
    pub fn rows(&self, name: &str) -> Result<Vec<Vec<f64>>> {
        self.typed(name, |setting| setting.list()?.iter().map(LocatedValue::numbers).collect())
    }

    /// Several texts.
    pub fn texts(&self, name: &str) -> Result<Vec<String>> {
        self.typed(name, |setting| setting.list()?.iter().map(|s| s.text().map(str::to_string)).collect())
    }

    /// A table within, where set, with the standard values of its own keys.
    pub fn table(&self, name: &str) -> Result<Option<Parameters>> {
        let Some(setting) = self.optional(name) else { return Ok(None) };
        match (self.parameter_type(name), setting.table()) {
            (Some(ParameterType::Table(declared)), Some(fields)) => {
                Parameters::check(declared, fields, &setting.origin, &[]).map(Some)
            }
            _ => Err(self.mistyped(name)),
        }
    }

    pub(super) fn parameter_type(&self, name: &str) -> Option<ParameterType> {
        self.entry(name).map(|entry| entry.declared.parameter_type)
    }

    fn mistyped(&self, name: &str) -> Error {
        self.error(name, format!("the parameter '{name}' is not of the type that its reader expects"))
    }

    /// Checks the fields of a table (written at `origin`) against the declarations: unknown and missing names,
    /// types, ranges, also within tables and lists of tables. `also` are keys that the caller has taken.
    pub fn check(
        declared: &[Parameter],
        fields: &[Field],
        origin: &SourceSpan,
        also: &[&str],
    ) -> Result<Parameters> {
        let mut first = None;
        let parameters = Self::survey(declared, fields, origin, also, &mut |_, error| {
            first.get_or_insert(error);
        });
        first.map_or(Ok(parameters), Err)
    }

    /// Checks like [`Parameters::check`] and reports every mistake, in the order found. A wrong setting is set nevertheless: parameters
    /// with mistakes are not to be used.
    pub fn survey(
        declared: &[Parameter],
        fields: &[Field],
        origin: &SourceSpan,
        also: &[&str],
        fault: FaultSink,
    ) -> Parameters {
        let unset = |&declared: &Parameter| Entry { declared, setting: None, is_set: false };
        let mut entries: Vec<Entry> = declared.iter().map(unset).collect();
        for field in fields.iter().filter(|field| !also.contains(&field.name.as_str())) {
            if let Some(entry) = entries.iter_mut().find(|entry| entry.declared.name == field.name) {
                survey_type(&entry.declared, &field.setting, &mut |error| fault(&field.name, error));
                (entry.setting, entry.is_set) = (Some(field.setting.clone()), true);
            } else {
                let names: Vec<&str> = also.iter().copied().chain(declared.iter().map(|p| p.name)).collect();
                let expected = match names.is_empty() {
                    true => "no parameter: there are none".into(),
                    false => suggest(&field.name, names),
                };
                let error = Error::usage(format!("unknown parameter '{}'", field.name)).expected(expected);
                fault(&field.name, field.origin.locate(error));
            }
        }
        for Entry { declared, setting, .. } in entries.iter_mut().filter(|entry| !entry.is_set) {
            let Parameter { name, parameter_type, default, help, .. } = declared;
            if let DefaultValue::Required = default {
                let error = Error::usage(format!("the parameter '{name}' is missing"))
                    .expected(format!("{name} = … ({}): {help}", parameter_type.describe()));
                fault(name, origin.locate(error));
            }
            *setting = default.datum().map(LocatedValue::from);
        }
        Parameters { entries, origin: origin.clone(), variants: None }
    }

    /// A list of tables of several kinds: each one's kind and parameters. Empty where not set.
    pub fn kinds(&self, name: &str) -> Result<Vec<(&'static str, Parameters)>> {
        let Some(setting) = self.optional(name) else { return Ok(Vec::new()) };
        let declared = self.parameter_type(name);
        let (Some(ParameterType::Kinds(kinds)), Some(list)) = (declared, setting.list()) else {
            return Err(self.mistyped(name));
        };
        let kind = |setting: &LocatedValue| {
            let mut first = None;
            let kind = kind_of(kinds, name, setting, &mut |error| _ = first.get_or_insert(error));
            match (kind, first) {
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
    let Some(kind) = find_setting(fields, "kind") else {
        let error = Error::usage(format!("an entry of '{name}' has no 'kind'"))
            .expected(format!("kind = one of {}", names().collect::<Vec<_>>().join(", ")));
        fault(setting.origin.locate(error));
        return None;
    };
    let word = kind.text().unwrap_or_default();
    let Some(found) = kinds.iter().find(|k| k.name == word) else {
        fault(kind.error("unknown kind", suggest(word, names())));
        return None;
    };
    let on_fault: FaultSink = &mut |_, error| fault(error);
    Some((found.name, Parameters::survey(found.parameters, fields, &setting.origin, &["kind"], on_fault)))
}

fn check_type(parameter: &Parameter, setting: &LocatedValue) -> Result<()> {
    let mut first = None;
    survey_type(parameter, setting, &mut |error| _ = first.get_or_insert(error));
    first.map_or(Ok(()), Err)
}

/// Checks one value by its type and reports every mistake: a table, or a list of tables, may have several.
fn survey_type(parameter: &Parameter, setting: &LocatedValue, fault: &mut dyn FnMut(Error)) {
    match (parameter.parameter_type, &setting.datum) {
        (ParameterType::Table(declared), ParameterValue::Table(fields)) => {
            Parameters::survey(declared, fields, &setting.origin, &[], &mut |_, error| fault(error));
        }
        (ParameterType::Kinds(kinds), ParameterValue::List(list)) => {
            for entry in list {
                kind_of(kinds, parameter.name, entry, fault);
            }
        }
        _ => check_plain(parameter, setting).unwrap_or_else(fault),
    }
}

/// Checks a setting that has one mistake at most.
fn check_plain(parameter: &Parameter, setting: &LocatedValue) -> Result<()> {
    let Parameter { name, parameter_type, unit, .. } = parameter;
    let accepted = || match *unit {
        "" => parameter_type.describe(),
        unit => format!("{} ({unit})", parameter_type.describe()),
    };
    let wrong_type = || Err(setting.error(format!("'{name}' is of the wrong type"), accepted()));
    let check =
        |is_right: bool, part: &LocatedValue, what: &str, accepted: &dyn Fn() -> String| match is_right {
            true => Ok(()),
            false => Err(part.error(format!("'{name}' {what}"), accepted())),
        };
    let in_range = |part: &LocatedValue, x: f64, range: &Range| {
        check(range.holds(x), part, "is out of range", &accepted)
    };
    match (parameter_type, &setting.datum) {
        (ParameterType::Boolean, ParameterValue::Boolean(_)) => Ok(()),
        (ParameterType::Integer(range) | ParameterType::IntegerOr(range, _), ParameterValue::Integer(n)) => {
            in_range(setting, *n as f64, range)
        }
        (
            ParameterType::IntegerOr(_, word) | ParameterType::NumberOr(_, word),
            ParameterValue::Text(text),
        ) if text == word => Ok(()),
        (
            ParameterType::Number(range) | ParameterType::NumberOr(range, _),
            ParameterValue::Number(_) | ParameterValue::Integer(_),
        ) => in_range(setting, setting.number().unwrap_or(f64::NAN), range),
        (
            ParameterType::Text
            | ParameterType::ArrayName
            | ParameterType::NewArrayName
            | ParameterType::Expression
            | ParameterType::GradientFilter
            | ParameterType::Registered(_),
            ParameterValue::Text(_),
        ) => Ok(()),
        (ParameterType::InputPath | ParameterType::OutputPath, ParameterValue::Text(path)) => {
            check(!path.is_empty(), setting, "is empty", &|| "the path of a file".into())
        }
        (ParameterType::Choice(words), ParameterValue::Text(text)) => {
            let words = || words.iter().map(|word| word.0);
            let is_known = words().any(|word| word == text);
            check(is_known, setting, "does not know this word", &|| suggest(text, words()))
        }
        (ParameterType::RowsOr(_, words), ParameterValue::Text(text)) => {
            let words = || words.iter().map(|word| word.0);
            let accepted = || format!("{}, or a list of rows", suggest(text, words()));
            check(words().any(|word| word == text), setting, "does not know this word", &accepted)
        }
        (ParameterType::ChoiceOrPath(words, endings), ParameterValue::Text(text)) => {
            let words = || words.iter().map(|word| word.0);
            let ending = Path::new(text).extension().and_then(|ending| ending.to_str());
            let is_file =
                ending.is_some_and(|own| endings.iter().any(|known| known.eq_ignore_ascii_case(own)));
            let accepted = || format!("{}, or a file .{}", suggest(text, words()), endings.join(" or ."));
            check(is_file || words().any(|word| word == text), setting, "does not know this name", &accepted)
        }
        (ParameterType::Color(_), ParameterValue::Text(_)) => {
            check(setting.color().is_some(), setting, "is not a colour", &accepted)
        }
        (ParameterType::Color(range), ParameterValue::List(_)) => {
            let plain = Parameter { parameter_type: ParameterType::Numbers(Some(3), *range), ..*parameter };
            check_plain(&plain, setting).map_err(|error| error.expected(accepted()))
        }
        (ParameterType::RowsOr(width, _), ParameterValue::List(_)) => check_plain(
            &Parameter { parameter_type: ParameterType::Rows(Some(*width)), ..*parameter },
            setting,
        ),
        (ParameterType::Numbers(count, range), ParameterValue::List(list)) => {
            for part in list {
                let Some(x) = part.number() else { return wrong_type() };
                in_range(part, x, range)?;
            }
            if count.is_none_or(|n| n == list.len()) { Ok(()) } else { wrong_type() }
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
        (ParameterType::Texts | ParameterType::ArrayNames, ParameterValue::List(list))
            if list.iter().all(|s| s.text().is_some()) =>
        {
            Ok(())
        }
        (ParameterType::Measured(measured), _) => {
            // 1 is in every range of what may be relative; the others are checked beside it.
            let numbers = measured.replaced(name, setting, 0, &mut |_, _, _| Ok(1.0))?;
            let plain = Parameter { parameter_type: measured.plain, ..*parameter };
            check_type(&plain, &numbers).map_err(|error| match error.expected.clone() {
                Some(plain) => error.expected(format!("{plain}, {}", measured.describe())),
                None => error,
            })
        }
        _ => wrong_type(),
    }
}

impl Parameters {
    /// The relative numbers among these, also within tables, in their order.
    pub fn relative_numbers(&self) -> Vec<RelativeNumber> {
        let mut found = Vec::new();
        // What is written was checked, so nothing here is an error.
        let collected = self.with_numbers(&mut |number| {
            found.push(number.clone());
            Ok(1.0)
        });
        debug_assert!(collected.is_ok());
        found
    }

    /// These with each relative number replaced by what `find` says.
    pub fn with_numbers(&self, find: &mut dyn FnMut(&RelativeNumber) -> Result<f64>) -> Result<Parameters> {
        self.with_settings(&mut |measured, name, setting, beside| {
            measured.replaced(name, setting, 0, &mut |place, part, relative| {
                let quantity = measured.quantity(place, beside);
                let quantity = quantity.unwrap_or(ArrayRef::Array(String::new()));
                find(&RelativeNumber { relative, is: measured.statistic, quantity, setting: part.clone() })
            })
        })
    }

    /// These with each setting replaced whose numbers may be relative.
    pub fn with_settings(&self, change: Change) -> Result<Parameters> {
        let mut changed = self.clone();
        let beside = |name: &str| self.optional(name).cloned();
        for Entry { declared, setting, .. } in &mut changed.entries {
            let Some(setting) = setting else { continue };
            match (declared.parameter_type, &mut setting.datum) {
                (ParameterType::Measured(measured), _) => {
                    *setting = change(measured, declared.name, setting, &beside)?;
                }
                (ParameterType::Table(declared), ParameterValue::Table(fields)) => {
                    let own = Parameters::survey(declared, fields, &setting.origin, &[], &mut |_, _| {});
                    own.with_settings(change)?.put_into(fields);
                }
                (ParameterType::Kinds(kinds), ParameterValue::List(list)) => {
                    for entry in list {
                        let kind = kind_of(kinds, declared.name, entry, &mut |_| {});
                        if let (Some((_, own)), ParameterValue::Table(fields)) = (kind, &mut entry.datum) {
                            own.with_settings(change)?.put_into(fields);
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(changed)
    }

    /// Puts the settings whose numbers may be relative, and those of tables, into the table that they are of; standard values, too.
    fn put_into(self, fields: &mut Vec<Field>) {
        for Entry { declared, setting, .. } in self.entries {
            let Some(setting) = setting else { continue };
            match fields.iter_mut().find(|field| field.name == declared.name) {
                Some(field) => field.setting = setting,
                None if matches!(declared.parameter_type, ParameterType::Measured(_)) => {
                    fields.push(Field::new(declared.name, setting));
                }
                None => {}
            }
        }
    }
}

/// Changes a setting of a type whose numbers may be relative: given the type, the parameter's name, the setting, and what
/// stands beside it.
pub type Change<'a> = &'a mut dyn FnMut(
    &RelativeNumberType,
    &str,
    &LocatedValue,
    &dyn Fn(&str) -> Option<LocatedValue>,
) -> Result<LocatedValue>;

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
    for parameter in parameters {
        let Parameter { name, parameter_type, default, help, .. } = parameter;
        if name.is_empty() || help.is_empty() {
            return Err(Error::usage(format!("the parameter '{name}' of {of} has no name or no help")));
        }
        if let Some(datum) = default.datum() {
            check_type(parameter, &LocatedValue::from(datum)).map_err(|error| Error {
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
