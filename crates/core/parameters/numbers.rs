//! The relative numbers among parameters.

use super::check::Parameters;
use super::declaration::{Parameter, ParameterType, RelativeNumberType};
use super::measured::RelativeNumber;
use super::relative::ArrayRef;
use super::setting::{Field, LocatedValue, ParameterValue};
use crate::Result;

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
            measured.replaced(name, setting, &mut |place, part, relative| {
                let quantity = measured.quantity(place, beside);
                let quantity = quantity.unwrap_or(ArrayRef::Array(String::new()));
                find(&RelativeNumber { relative, is: measured.statistic, quantity, setting: part.clone() })
            })
        })
    }

    /// These with each setting replaced whose numbers may be relative.
    pub fn with_settings(&self, change: Change) -> Result<Parameters> {
        let mut changed = self.clone();
        for (name, setting) in changed_of(&self.iter().collect::<Vec<_>>(), change)? {
            changed.put(name, Some(setting));
        }
        Ok(changed)
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

type DeclaredSetting<'a> = (&'a Parameter, Option<&'a LocatedValue>, bool);

fn changed_of(parameters: &[DeclaredSetting], change: Change) -> Result<Vec<(&'static str, LocatedValue)>> {
    let beside = |name: &str| -> Option<LocatedValue> {
        parameters.iter().find(|(p, ..)| p.name == name).and_then(|(_, setting, _)| setting.cloned())
    };
    let mut changed = Vec::new();
    for (parameter, setting, _) in parameters {
        let Some(setting) = setting else { continue };
        match parameter.parameter_type {
            ParameterType::Measured(measured) => {
                changed.push((parameter.name, change(measured, parameter.name, setting, &beside)?));
            }
            ParameterType::Table(declared) => {
                let Some(fields) = setting.table() else { continue };
                let find = |p: &Parameter| fields.iter().find(|f| f.name == p.name).map(|f| &f.setting);
                let own: Vec<DeclaredSetting> = declared.iter().map(|p| (p, find(p), true)).collect();
                let mut fields: Vec<Field> = fields.to_vec();
                for (name, setting) in changed_of(&own, change)? {
                    fields.iter_mut().filter(|f| f.name == name).for_each(|f| f.setting = setting.clone());
                }
                changed.push((
                    parameter.name,
                    LocatedValue { datum: ParameterValue::Table(fields), origin: setting.origin.clone() },
                ));
            }
            _ => {}
        }
    }
    Ok(changed)
}
