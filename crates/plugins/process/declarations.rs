//! Declarations of items in messages.

use crate::declaration::{Declaration, Family};
use crate::wire::{Reader, Writer};
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};

/// Appends a declaration.
pub(super) fn write_declaration(body: &mut Writer, declaration: &Declaration) {
    body.text(declaration.schema.name);
    body.text(declaration.schema.summary);
    match declaration.family {
        Family::GradientFilter { needs } => {
            body.number(0);
            body.number(u64::from(needs));
        }
        Family::Reader { extensions, magic } => {
            body.number(1);
            write_texts(body, extensions);
            body.bytes(magic);
        }
        Family::GridFilter { made } => {
            body.number(2);
            write_texts(body, made);
        }
        Family::ImageFilter => body.number(3),
    }
    body.number(u64::from(declaration.checks));
    body.count(declaration.schema.parameters.len());
    for (parameter, &components) in declaration.schema.parameters.iter().zip(&declaration.components) {
        [parameter.name, parameter.unit, parameter.help].into_iter().for_each(|text| body.text(text));
        body.number(u64::from(components));
        write_type(body, &parameter.parameter_type);
        write_default(body, &parameter.default);
    }
}

/// A declaration from a message, whose texts and lists live as long as the program; `None` where the bytes are none.
pub(super) fn read_declaration(reader: &mut Reader) -> Option<Declaration> {
    let (name, summary) = (reader.text()?, reader.text()?);
    let family = match reader.number()? {
        0 => Family::GradientFilter { needs: reader.number()? as u32 },
        1 => Family::Reader { extensions: read_texts(reader)?, magic: reader.bytes()?.to_vec().leak() },
        2 => Family::GridFilter { made: read_texts(reader)? },
        3 => Family::ImageFilter,
        _ => return None,
    };
    let checks = reader.number()? == 1;
    let mut components = Vec::new();
    let parameters = reader.list(|reader| {
        let [name, unit, help] = [reader.text()?, reader.text()?, reader.text()?];
        components.push(reader.number()? as u32);
        let parameter_type = read_type(reader)?;
        let standard = read_default(reader)?;
        Some(Parameter {
            name: name.leak(),
            unit: unit.leak(),
            help: help.leak(),
            parameter_type,
            default: standard,
        })
    })?;
    let schema = VariantSchema { name: name.leak(), summary: summary.leak(), parameters: parameters.leak() };
    Some(Declaration { schema, family, checks, components })
}

fn write_texts(body: &mut Writer, texts: &[&str]) {
    body.list(texts, |body, text| body.text(text));
}

fn read_texts(reader: &mut Reader) -> Option<&'static [&'static str]> {
    let texts: Vec<&str> = reader.list(|reader| Some(&*reader.text()?.leak()))?;
    Some(texts.leak())
}

fn write_range(body: &mut Writer, range: &Range) {
    body.float(range.min);
    body.float(range.max);
    body.number(u64::from(range.above_min));
    body.number(u64::from(range.below_max));
}

fn read_range(reader: &mut Reader) -> Option<Range> {
    let (min, max) = (reader.float()?, reader.float()?);
    let (above_min, below_max) = (reader.number()? == 1, reader.number()? == 1);
    Some(Range { min, max, above_min, below_max, infinite: false })
}

/// Appends a type that [`crate::declaration`] gives.
fn write_type(body: &mut Writer, parameter_type: &ParameterType) {
    match parameter_type {
        ParameterType::Boolean => body.number(0),
        ParameterType::Integer(range) => {
            body.number(1);
            write_range(body, range);
        }
        ParameterType::Number(range) => {
            body.number(2);
            write_range(body, range);
        }
        ParameterType::Choice(words) => {
            body.number(3);
            body.list(words, |body, (word, meaning)| {
                body.text(word);
                body.text(meaning);
            });
        }
        ParameterType::Numbers(count, range) => {
            body.number(4);
            body.optional(*count, Writer::count);
            write_range(body, range);
        }
        _ => body.number(5),
    }
}

fn read_type(reader: &mut Reader) -> Option<ParameterType> {
    Some(match reader.number()? {
        0 => ParameterType::Boolean,
        1 => ParameterType::Integer(read_range(reader)?),
        2 => ParameterType::Number(read_range(reader)?),
        3 => {
            let words = reader.list(|reader| {
                let (word, meaning): (&str, &str) = (reader.text()?.leak(), reader.text()?.leak());
                Some((word, meaning))
            });
            ParameterType::Choice(words?.leak())
        }
        4 => ParameterType::Numbers(reader.optional(Reader::length)?, read_range(reader)?),
        5 => ParameterType::Text,
        _ => return None,
    })
}

/// Appends a default that [`crate::declaration`] gives.
fn write_default(body: &mut Writer, standard: &DefaultValue) {
    match *standard {
        DefaultValue::Unset(meaning) => {
            body.number(1);
            body.text(meaning);
        }
        DefaultValue::Boolean(flag) => {
            body.number(2);
            body.number(u64::from(flag));
        }
        DefaultValue::Integer(n) => {
            body.number(3);
            body.number(n as u64);
        }
        DefaultValue::Number(x) => {
            body.number(4);
            body.float(x);
        }
        DefaultValue::Text(text) => {
            body.number(5);
            body.text(text);
        }
        DefaultValue::Numbers(xs) => {
            body.number(6);
            body.floats(xs);
        }
        DefaultValue::Required | DefaultValue::Integers(_) => body.number(0),
    }
}

fn read_default(reader: &mut Reader) -> Option<DefaultValue> {
    Some(match reader.number()? {
        0 => DefaultValue::Required,
        1 => DefaultValue::Unset(reader.text()?.leak()),
        2 => DefaultValue::Boolean(reader.number()? == 1),
        3 => DefaultValue::Integer(reader.number()? as i64),
        4 => DefaultValue::Number(reader.float()?),
        5 => DefaultValue::Text(reader.text()?.leak()),
        6 => DefaultValue::Numbers(reader.floats()?.leak()),
        _ => return None,
    })
}
