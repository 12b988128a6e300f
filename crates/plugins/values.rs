//! What the parameters are set to, as the interface hands it over.

use crate::describe::Declared;
use crate::interface;
use crate::process::wire::{Reader, Writer};
use std::ffi::{CString, c_char};
use std::mem::size_of;
use std::sync::Arc;
use voltet_core::grid::{Array, Grid};
use voltet_core::parameters::{LocatedValue, ParameterType, ParameterValue, Parameters};
use voltet_core::{Error, Result};

/// The values of a filter's parameters, in the order of its declarations.
#[derive(Clone, Default)]
pub(crate) struct Owned {
    integers: Vec<i64>,
    numbers: Vec<f64>,
    texts: Vec<Option<CString>>,
    vectors: Vec<Option<Vec<f64>>>,
}

/// What they are, one a parameter.
#[cfg(feature = "wasm")]
pub(crate) struct Parts<'a> {
    pub integers: &'a [i64],
    pub numbers: &'a [f64],
    pub texts: &'a [Option<CString>],
    pub vectors: &'a [Option<Vec<f64>>],
}

/// The same as pointers; valid as long as the values.
pub(crate) struct Pointers {
    texts: Vec<*const c_char>,
    vectors: Vec<*const f64>,
    lengths: Vec<u32>,
}

impl Owned {
    /// Errors: a text with a 0 character.
    pub fn new(declared: &Declared, parameters: &Parameters) -> Result<Owned> {
        let mut owned = Owned::default();
        for parameter in declared.kind.parameters {
            let setting = parameters.optional(parameter.name);
            let text = setting.and_then(LocatedValue::text);
            let integer = match (parameter.parameter_type, setting.map(|setting| &setting.datum)) {
                (ParameterType::Boolean, Some(ParameterValue::Boolean(flag))) => i64::from(*flag),
                (ParameterType::Integer(_), Some(ParameterValue::Integer(n))) => *n,
                (ParameterType::Choice(words), _) => {
                    words.iter().position(|(word, _)| Some(*word) == text).unwrap_or(0) as i64
                }
                _ => 0,
            };
            owned.integers.push(integer);
            owned.numbers.push(setting.and_then(LocatedValue::number).unwrap_or(0.0));
            let text = text.map(CString::new).transpose().map_err(|_| {
                let error = Error::usage(format!("'{}' has a character 0", parameter.name));
                parameters.locate(parameter.name, error.expected("text without it"))
            })?;
            owned.texts.push(text);
            owned.vectors.push(setting.and_then(LocatedValue::numbers));
        }
        Ok(owned)
    }

    #[cfg(feature = "wasm")]
    pub fn parts(&self) -> Parts<'_> {
        let Owned { integers, numbers, texts, vectors } = self;
        Parts { integers, numbers, texts, vectors }
    }

    /// Into a message.
    pub fn write(&self, to: &mut Writer) {
        to.number(self.integers.len() as u64);
        for (i, (integer, number)) in self.integers.iter().zip(&self.numbers).enumerate() {
            to.number(*integer as u64);
            to.float(*number);
            to.optional(self.texts[i].as_ref(), |to, text| to.bytes(text.as_bytes()));
            to.optional(self.vectors[i].as_ref(), |to, vector| to.floats(vector));
        }
    }

    /// From a message; `None` where it is none.
    pub fn read(from: &mut Reader) -> Option<Owned> {
        let mut owned = Owned::default();
        for _ in 0..from.count()? {
            owned.integers.push(from.number()? as i64);
            owned.numbers.push(from.float()?);
            owned.texts.push(from.optional(|from| CString::new(from.bytes()?).ok())?);
            owned.vectors.push(from.optional(Reader::floats)?);
        }
        Some(owned)
    }

    pub fn pointers(&self) -> Pointers {
        Pointers {
            texts: self
                .texts
                .iter()
                .map(|text| text.as_ref().map_or(std::ptr::null(), |t| t.as_ptr()))
                .collect(),
            vectors: self
                .vectors
                .iter()
                .map(|v| v.as_ref().map_or(std::ptr::null(), |v| v.as_ptr()))
                .collect(),
            lengths: self.vectors.iter().map(|v| v.as_ref().map_or(0, |v| v.len() as u32)).collect(),
        }
    }

    pub fn by(&self, pointers: &Pointers) -> interface::Values {
        interface::Values {
            size: size_of::<interface::Values>() as u32,
            count: self.integers.len() as u32,
            integers: self.integers.as_ptr(),
            numbers: self.numbers.as_ptr(),
            texts: pointers.texts.as_ptr(),
            vectors: pointers.vectors.as_ptr(),
            lengths: pointers.lengths.as_ptr(),
        }
    }
}

/// The names of the point arrays that the parameters name.
pub(crate) fn array_names(declared: &Declared, parameters: &Parameters) -> Vec<String> {
    named(declared, parameters).into_iter().flatten().map(|(name, ..)| name).collect()
}

/// The point array that each parameter names.
///
/// Errors: one that is not there, or has another number of components.
pub(crate) fn arrays(
    declared: &Declared,
    parameters: &Parameters,
    grid: &Grid,
) -> Result<Vec<Option<Arc<Array>>>> {
    let found = named(declared, parameters).into_iter().map(|named| {
        let Some((name, parameter, components)) = named else { return Ok(None) };
        let there = grid.point_array(&name, components as usize);
        there.map_err(|error| parameters.locate(parameter, error).at_item(parameter))?;
        Ok(grid.point_arrays.get(&name).cloned())
    });
    found.collect()
}

/// Where the values of each array are, for the plug-in to read; valid as long as the arrays.
pub(crate) fn array_pointers(arrays: &[Option<Arc<Array>>]) -> Vec<*const f64> {
    arrays
        .iter()
        .map(|array| array.as_ref().map_or(std::ptr::null(), |array| array.values.as_ptr()))
        .collect()
}

/// For each parameter the array that it names, its own name, and the number of components.
fn named<'a>(declared: &'a Declared, parameters: &Parameters) -> Vec<Option<(String, &'a str, u32)>> {
    let of = |(parameter, &components): (&'a voltet_core::parameters::Parameter, &u32)| {
        let name =
            parameters.optional(parameter.name).and_then(LocatedValue::text).filter(|_| components > 0)?;
        Some((name.to_string(), parameter.name, components))
    };
    declared.kind.parameters.iter().zip(&declared.components).map(of).collect()
}
