//! Inputs of a call: values of the parameters, and the arrays that they name.

use crate::declaration::Declaration;
use crate::inputs::Inputs;
use crate::interface;
use crate::wire::{Wire, wire};
use std::ffi::{CString, c_char};
use std::io::{self, Read, Write};
use std::mem::size_of;
use std::sync::Arc;
use voltet_core::grid::{Array, Grid};
use voltet_core::parameters::{LocatedValue, Parameter, ParameterType, ParameterValue, Parameters};
use voltet_core::{Error, Result};

/// The values of a filter's parameters, in the order of its declarations: one of each type a parameter.
#[derive(Clone, Default)]
pub(crate) struct ParameterValues {
    pub integers: Vec<i64>,
    pub numbers: Vec<f64>,
    pub texts: Vec<Option<CString>>,
    pub vectors: Vec<Option<Vec<f64>>>,
}

wire!(fields of ParameterValues { integers, numbers, texts, vectors });
wire!(fields of Array { component_count, values });

/// Points and tetrahedra alone.
impl Wire for Grid {
    fn send(&self, to: &mut dyn Write) -> io::Result<()> {
        self.points.send(to)?;
        self.tetrahedra.send(to)
    }

    fn receive(from: &mut dyn Read) -> io::Result<Self> {
        let (points, tetrahedra) = (Wire::receive(from)?, Wire::receive(from)?);
        Ok(Grid { points, tetrahedra, ..Grid::default() })
    }
}

/// Pointers of the header's struct to values; valid as long as these.
pub(crate) struct ValuePointers {
    texts: Vec<*const c_char>,
    vectors: Vec<*const f64>,
    lengths: Vec<u32>,
}

impl ParameterValues {
    /// Errors: a text with a 0 character.
    pub fn new(declaration: &Declaration, parameters: &Parameters) -> Result<ParameterValues> {
        let mut values = ParameterValues::default();
        for parameter in declaration.schema.parameters {
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
            values.integers.push(integer);
            values.numbers.push(setting.and_then(LocatedValue::number).unwrap_or(0.0));
            let text = text.map(CString::new).transpose().map_err(|_| {
                let error = Error::usage(format!("'{}' has a character 0", parameter.name));
                parameters.locate(parameter.name, error.expected("text without it"))
            })?;
            values.texts.push(text);
            values.vectors.push(setting.and_then(LocatedValue::numbers));
        }
        Ok(values)
    }

    pub fn pointers(&self) -> ValuePointers {
        use std::ptr::null;
        let texts = self.texts.iter().map(|text| text.as_ref().map_or(null(), |text| text.as_ptr()));
        let vectors = self.vectors.iter().map(|vector| vector.as_ref().map_or(null(), |v| v.as_ptr()));
        let lengths = self.vectors.iter().map(|vector| vector.as_ref().map_or(0, |v| v.len() as u32));
        ValuePointers { texts: texts.collect(), vectors: vectors.collect(), lengths: lengths.collect() }
    }

    pub fn inputs(&self) -> Inputs {
        const NAME: &str = "the values of its parameters";
        let mut inputs = Inputs::default();
        inputs.add(NAME, &self.integers);
        inputs.add(NAME, &self.numbers);
        self.texts.iter().flatten().for_each(|text| inputs.add(NAME, text.as_bytes_with_nul()));
        self.vectors.iter().flatten().for_each(|vector| inputs.add(NAME, vector));
        inputs
    }

    /// The struct of the header; valid as long as the values and the pointers.
    pub fn header_values(&self, pointers: &ValuePointers) -> interface::Values {
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

/// Point arrays that parameters name: one a parameter, `None` for parameters that name none.
pub(crate) type NamedArrays = Vec<Option<Arc<Array>>>;

/// Names of the point arrays that the parameters name.
pub(crate) fn array_names(declaration: &Declaration, parameters: &Parameters) -> Vec<String> {
    let references = array_references(declaration, parameters);
    references.into_iter().flatten().map(|(name, ..)| name).collect()
}

/// Point arrays that the parameters name.
///
/// Errors: one that is not there, or has another number of components.
pub(crate) fn named_arrays(
    declaration: &Declaration,
    parameters: &Parameters,
    grid: &Grid,
) -> Result<NamedArrays> {
    let find = |reference: Option<(String, &str, u32)>| {
        let Some((name, parameter, components)) = reference else { return Ok(None) };
        let array = grid.point_array(&name, components as usize);
        array.map_err(|error| parameters.locate(parameter, error).at_item(parameter))?;
        Ok(grid.point_arrays.get(&name).cloned())
    };
    array_references(declaration, parameters).into_iter().map(find).collect()
}

pub(crate) fn add_arrays(inputs: &mut Inputs, arrays: &[Option<Arc<Array>>]) {
    arrays
        .iter()
        .flatten()
        .for_each(|array| inputs.add("the arrays that its parameters name", &array.values));
}

/// Addresses of the values of each array; valid as long as the arrays.
pub(crate) fn array_pointers(arrays: &[Option<Arc<Array>>]) -> Vec<*const f64> {
    let address = |array: &Option<Arc<Array>>| array.as_ref().map_or(std::ptr::null(), |a| a.values.as_ptr());
    arrays.iter().map(address).collect()
}

/// For each parameter the name of its array, its own name, and the number of components.
fn array_references<'a>(
    declaration: &'a Declaration,
    parameters: &Parameters,
) -> Vec<Option<(String, &'a str, u32)>> {
    let reference = |(parameter, &components): (&'a Parameter, &u32)| {
        let name = parameters.optional(parameter.name).and_then(LocatedValue::text);
        Some((name.filter(|_| components > 0)?.to_string(), parameter.name, components))
    };
    declaration.schema.parameters.iter().zip(&declaration.components).map(reference).collect()
}
