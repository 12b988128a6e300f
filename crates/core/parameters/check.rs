//! Parameters: settings that were checked against their declarations, with typed getters.

use super::declaration::{Parameter, ParameterType, Variant};
use super::setting::{Field, LocatedValue, ParameterValue, SourceSpan};
use crate::{Error, Result};
use std::borrow::Cow;
use std::sync::Arc;

/// The parameters of a node or a gradient filter, or of a table within one: each declared name with the value that the file gives or
/// the standard value. Two are equal when their values are.
#[derive(Debug, Clone, Default)]
pub struct Parameters {
    pub(super) declared: Cow<'static, [Parameter]>,
    /// One for each declaration; `None` where the file is silent and there is no standard value.
    pub(super) settings: Vec<Option<LocatedValue>>,
    /// Flags of the parameters that the file sets.
    pub(super) is_set: Vec<bool>,
    /// Location of the table in the file.
    pub(super) origin: SourceSpan,
    /// The parameter of type [`ParameterType::Registered`], with all variants of it.
    pub(super) variants: Option<(&'static str, Arc<[Variant]>)>,
}

/// A mistake in what a table sets.
#[derive(Debug, Clone)]
pub struct ParameterFault {
    /// The parameter, or the unknown key.
    pub parameter: String,
    /// Error, with its location.
    pub error: Error,
}

/// Compares values; the declarations are assumed equal (one node type).
impl PartialEq for Parameters {
    fn eq(&self, other: &Self) -> bool {
        self.settings == other.settings
    }
}

impl Parameters {
    /// For a program: some values by name, the standard values for the rest.
    pub fn from_values(
        declared: impl Into<Cow<'static, [Parameter]>>,
        values: impl IntoIterator<Item = (&'static str, ParameterValue)>,
    ) -> Result<Parameters> {
        let field = |(name, datum): (&str, ParameterValue)| Field {
            name: name.to_string(),
            origin: SourceSpan::Nowhere,
            setting: LocatedValue::from(datum),
        };
        Self::check(declared, &values.into_iter().map(field).collect::<Vec<_>>(), &SourceSpan::Nowhere, &[])
    }

    /// These and others, whose names differ from these: what two declarations ask of one table.
    pub fn and(mut self, others: Parameters) -> Parameters {
        self.declared.to_mut().extend_from_slice(&others.declared);
        self.settings.extend(others.settings);
        self.is_set.extend(others.is_set);
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
            let names: Vec<&str> = variants.iter().map(|variant| variant.schema.name).collect();
            self.error(name, format!("'{word}' is not registered")).expected(names.join(", "))
        })
    }

    /// The declarations with their values (`None`: not set), and whether the file gave them.
    pub fn iter(&self) -> impl Iterator<Item = (&Parameter, Option<&LocatedValue>, bool)> {
        self.declared.iter().zip(&self.settings).zip(&self.is_set).map(|((p, s), g)| (p, s.as_ref(), *g))
    }

    /// These with another value for one, as if the file had given it, or not where it is `None`.
    pub fn with(&self, name: &str, datum: Option<ParameterValue>) -> Parameters {
        let mut changed = self.clone();
        if let Some(i) = self.declared.iter().position(|p| p.name == name) {
            changed.is_set[i] = datum.is_some();
        }
        changed.put(name, datum.map(LocatedValue::from));
        changed
    }

    /// True if the file (or the command line) gave the parameter.
    pub fn is_set(&self, name: &str) -> bool {
        self.declared.iter().position(|p| p.name == name).is_some_and(|i| self.is_set[i])
    }

    /// The setting, if there is one.
    pub fn optional(&self, name: &str) -> Option<&LocatedValue> {
        let i = self.declared.iter().position(|p| p.name == name)?;
        self.settings[i].as_ref()
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

    /// A number.
    pub fn number(&self, name: &str) -> Result<f64> {
        self.get(name)?.number().ok_or_else(|| self.mistyped(name))
    }

    /// A number, where set.
    pub fn optional_number(&self, name: &str) -> Option<f64> {
        self.optional(name)?.number()
    }

    /// A whole number.
    pub fn integer(&self, name: &str) -> Result<i64> {
        match self.get(name)?.datum {
            ParameterValue::Integer(n) => Ok(n),
            _ => Err(self.mistyped(name)),
        }
    }

    /// A flag.
    pub fn flag(&self, name: &str) -> Result<bool> {
        match self.get(name)?.datum {
            ParameterValue::Boolean(flag) => Ok(flag),
            _ => Err(self.mistyped(name)),
        }
    }

    /// Text, a word or a path.
    pub fn text(&self, name: &str) -> Result<&str> {
        self.get(name)?.text().ok_or_else(|| self.mistyped(name))
    }

    /// Several numbers.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        self.get(name)?.numbers().ok_or_else(|| self.mistyped(name))
    }

    /// Exactly `N` numbers.
    pub fn vector<const N: usize>(&self, name: &str) -> Result<[f64; N]> {
        self.numbers(name)?.try_into().map_err(|_| self.mistyped(name))
    }

    /// Rows of numbers.
    pub fn rows(&self, name: &str) -> Result<Vec<Vec<f64>>> {
        let rows = self.get(name)?.list().and_then(|list| list.iter().map(LocatedValue::numbers).collect());
        rows.ok_or_else(|| self.mistyped(name))
    }

    /// Several texts.
    pub fn texts(&self, name: &str) -> Result<Vec<String>> {
        let list = self.get(name)?.list();
        let texts = list.and_then(|list| list.iter().map(|s| s.text().map(str::to_string)).collect());
        texts.ok_or_else(|| self.mistyped(name))
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
        self.declared.iter().find(|p| p.name == name).map(|p| p.parameter_type)
    }

    /// Puts another setting in the place of one.
    pub(super) fn put(&mut self, name: &str, setting: Option<LocatedValue>) {
        if let Some(i) = self.declared.iter().position(|p| p.name == name) {
            self.settings[i] = setting;
        }
    }

    pub(super) fn mistyped(&self, name: &str) -> Error {
        self.error(name, format!("the parameter '{name}' is not of the type that its reader expects"))
    }
}
