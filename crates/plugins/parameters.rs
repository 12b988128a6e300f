//! Parameters that a plug-in declares, read from the header's structs and checked.

use crate::ffi::{ValidationError, several, values};
use crate::interface;
use crate::text::{MAX_NAME_BYTES, MAX_PARAMETERS, MAX_TEXT_BYTES, identifier, leak, line, required};
use std::ffi::c_char;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range};

/// Longest vector.
pub(crate) const MAX_VECTOR_LENGTH: u32 = 1024;

/// The parameters at an address, and the components of the point array that each names; 0 for parameters that name none.
pub(crate) fn parameters(
    address: *const interface::Parameter,
    count: usize,
) -> Result<(Vec<Parameter>, Vec<u32>), ValidationError> {
    let (mut parameters, mut components) = (Vec::new(), Vec::new());
    let all = several(address, count);
    for (i, read) in all.map_err(|wrong| format!("parameter {wrong}"))?.iter().enumerate() {
        let name = identifier("the name", read.name).map_err(|wrong| format!("parameter {i}: {wrong}"))?;
        let parameter = parameter(read, &name).map_err(|wrong| format!("parameter '{name}': {wrong}"))?;
        parameters.push(parameter);
        let of_array = read.parameter_type == interface::POINT_ARRAY;
        components.push(if of_array { read.length } else { 0 });
    }
    Ok((parameters, components))
}

fn parameter(read: &interface::Parameter, name: &str) -> Result<Parameter, ValidationError> {
    let unit = line("the unit", read.unit, MAX_NAME_BYTES)?.unwrap_or_default();
    let help = required("the help", line("the help", read.help, MAX_TEXT_BYTES)?)?;
    let known = interface::REQUIRED | interface::EXCLUSIVE_MIN | interface::EXCLUSIVE_MAX;
    if read.flags & !known != 0 {
        return Err(format!("'flags' has some that this version does not know: {:#x}", read.flags));
    }
    let required_ = read.flags & interface::REQUIRED != 0;
    let unless_required = |standard| if required_ { DefaultValue::Required } else { standard };
    let (parameter_type, standard) = match read.parameter_type {
        interface::BOOLEAN if read.number == 0.0 || read.number == 1.0 => {
            (ParameterType::Boolean, unless_required(DefaultValue::Boolean(read.number == 1.0)))
        }
        interface::BOOLEAN => return Err(format!("the default is {}, neither 0 nor 1", read.number)),
        interface::INTEGER => {
            let whole = read.number as i64;
            if whole as f64 != read.number && !required_ {
                return Err(format!("the default is {}, no whole number", read.number));
            }
            (ParameterType::Integer(range(read)?), unless_required(DefaultValue::Integer(whole)))
        }
        interface::NUMBER => {
            (ParameterType::Number(range(read)?), unless_required(DefaultValue::Number(read.number)))
        }
        interface::CHOICE => {
            let words = words(read)?;
            let given = line("the default", read.text, MAX_NAME_BYTES)?;
            let standard = match given {
                _ if required_ => DefaultValue::Required,
                Some(word) => DefaultValue::Text(leak(word)),
                None => return Err("there is no default, and it is not required".into()),
            };
            (ParameterType::Choice(words.leak()), standard)
        }
        interface::TEXT => (ParameterType::Text, unless_required(text_or_unset(read)?)),
        interface::POINT_ARRAY if (1..=9).contains(&read.length) => {
            (ParameterType::Text, unless_required(text_or_unset(read)?))
        }
        interface::POINT_ARRAY => {
            return Err(format!("'length' is {}, and a point array has 1 to 9 components", read.length));
        }
        interface::VECTOR if read.length > MAX_VECTOR_LENGTH => {
            return Err(format!("'length' is {}, at most {MAX_VECTOR_LENGTH}", read.length));
        }
        interface::VECTOR => {
            let length = (read.length > 0).then_some(read.length as usize);
            let standard = match read.numbers.is_null() {
                true => unset(read)?,
                false => {
                    let numbers = values(read.numbers, read.length as usize);
                    DefaultValue::Numbers(numbers.map_err(|wrong| format!("'numbers' {wrong}"))?.leak())
                }
            };
            (ParameterType::Numbers(length, range(read)?), unless_required(standard))
        }
        other => return Err(format!("its type is {other}, which this version does not know")),
    };
    Ok(Parameter {
        name: leak(name.into()),
        parameter_type,
        unit: leak(unit),
        default: standard,
        help: leak(help),
    })
}

/// A default text, or what leaving it out means.
fn text_or_unset(read: &interface::Parameter) -> Result<DefaultValue, ValidationError> {
    match line("the default", read.text, MAX_TEXT_BYTES)? {
        Some(text) => Ok(DefaultValue::Text(leak(text))),
        None => unset(read),
    }
}

fn unset(read: &interface::Parameter) -> Result<DefaultValue, ValidationError> {
    if read.flags & interface::REQUIRED != 0 {
        return Ok(DefaultValue::Required);
    }
    match line("'unset'", read.unset, MAX_TEXT_BYTES)?.filter(|text| !text.is_empty()) {
        Some(meaning) => Ok(DefaultValue::Unset(leak(meaning))),
        None => Err("there is no default, and 'unset' does not say what that means".into()),
    }
}

/// The range of numbers; both ends 0: none.
fn range(read: &interface::Parameter) -> Result<Range, ValidationError> {
    let (min, max) = (read.min, read.max);
    if min == 0.0 && max == 0.0 {
        return Ok(Range::ANY);
    }
    let above_min = read.flags & interface::EXCLUSIVE_MIN != 0;
    let below_max = read.flags & interface::EXCLUSIVE_MAX != 0;
    if min.is_nan() || max.is_nan() || min > max || (min == max && (above_min || below_max)) {
        return Err(format!("no number is in its range, from {min} to {max}"));
    }
    Ok(Range { min, max, above_min, below_max, infinite: false })
}

/// The words of a choice with their meanings.
fn words(read: &interface::Parameter) -> Result<Vec<(&'static str, &'static str)>, ValidationError> {
    if !(1..=MAX_PARAMETERS).contains(&read.word_count) {
        return Err(format!("there are {} words, 1 to {MAX_PARAMETERS} can be", read.word_count));
    }
    let list = |what: &str, address: *const *const c_char| {
        values(address, read.word_count as usize).map_err(|wrong| format!("'{what}' {wrong}"))
    };
    let (words, meanings) = (list("words", read.words)?, list("meanings", read.meanings)?);
    let mut found: Vec<(&str, &str)> = Vec::new();
    for (word, meaning) in words.into_iter().zip(meanings) {
        let word = identifier("a word", word)?;
        if found.iter().any(|(known, _)| *known == word) {
            return Err(format!("there are two words '{word}'"));
        }
        let meaning =
            required("the meaning of a word", line("the meaning of a word", meaning, MAX_TEXT_BYTES)?)?;
        found.push((leak(word), leak(meaning)));
    }
    Ok(found)
}
