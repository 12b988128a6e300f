//! Values as people type and read them.

use super::Row;
use super::control::Control;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::value;
use voltet_graph::{Field, LocatedValue, ParameterValue, Parameters, suggest};

/// Value of a text typed for a row: a number as it is, "25 %" and "p90" where valid, several numbers with commas or
/// spaces between, in brackets or not, texts without quotes. Errors say in words what is wrong and what would be right.
pub fn typed(row: &Row, text: &str) -> Result<ParameterValue> {
    let text = text.trim();
    let datum = match &row.control {
        Control::Text | Control::Array | Control::InputFile | Control::OutputFile | Control::Choice(_) => {
            ParameterValue::Text(text.to_string())
        }
        Control::Toggle => match text {
            "on" | "yes" => ParameterValue::Boolean(true),
            "off" | "no" => ParameterValue::Boolean(false),
            other => read(other),
        },
        Control::Integer(_) | Control::Number { .. } => read(text),
        Control::Texts | Control::Arrays => list(text, &|part| ParameterValue::Text(part.to_string())),
        Control::Colour { .. } => match hexadecimal(text) {
            Some(colour) => colour,
            None => list(text, &read),
        },
        Control::Vector { .. } => list(text, &read),
        Control::Rows { .. } | Control::Table | Control::Entries(_) => {
            value(&text.replace(['\r', '\n'], " "))
                .map_or_else(|| ParameterValue::Text(text.to_string()), |v| v.datum)
        }
    };
    // Which gradient filters there are is not in the declaration.
    if let (Control::Choice(words), ParameterValue::Text(text)) = (&row.control, &datum)
        && !words.iter().any(|(word, _)| word == text)
    {
        let error = Error::usage(format!("'{}' does not know this word", row.parameter.name)).got(&datum);
        return Err(error.expected(suggest(text, words.iter().map(|(word, _)| *word))));
    }
    let field = Field {
        name: row.parameter.name.to_string(),
        origin: Default::default(),
        setting: LocatedValue::from(datum.clone()),
    };
    Parameters::check(vec![*row.parameter], &[field], &Default::default(), &[]).map_err(
        |error| match &datum {
            ParameterValue::Text(text)
                if text.contains(',') && text.replace(',', ".").parse::<f64>().is_ok() =>
            {
                Error::usage("a number has a point, not a comma").got(text).expected(text.replace(',', "."))
            }
            _ => error,
        },
    )?;
    Ok(datum)
}

/// A value as it is shown for typing: what [`typed`] reads again.
pub fn to_text(datum: &ParameterValue) -> String {
    match datum {
        ParameterValue::Text(text) => text.clone(),
        ParameterValue::List(list)
            if list.iter().all(|part| part.list().is_none() && part.table().is_none()) =>
        {
            list.iter().map(|part| to_text(&part.datum)).collect::<Vec<_>>().join(", ")
        }
        other => other.to_string(),
    }
}

/// A number dragged to, with so many digits as a step of the drag makes a difference in: 0.30000000000000004 by steps of 0.01
/// is 0.3.
pub fn rounded(x: f64, step: f64) -> f64 {
    if !x.is_finite() || !step.is_finite() || step <= 0.0 {
        return x;
    }
    // A digit more than the step has; f64 has 17 in all.
    let decimals = (1.0 - step.log10()).ceil().clamp(0.0, 17.0) as usize;
    format!("{x:.decimals$}").parse().unwrap_or(x)
}

/// A word as a number or a flag, else as a text.
fn read(text: &str) -> ParameterValue {
    match value(text) {
        Some(LocatedValue {
            datum:
                datum @ (ParameterValue::Integer(_) | ParameterValue::Number(_) | ParameterValue::Boolean(_)),
            ..
        }) => datum,
        Some(LocatedValue { datum: ParameterValue::Text(text), .. }) => ParameterValue::Text(text),
        // ".5" and "1." are no TOML, and numbers all the same.
        _ => text.parse().map_or_else(|_| ParameterValue::Text(text.to_string()), ParameterValue::Number),
    }
}

/// Parts with commas between, or spaces where there is no comma.
fn list(text: &str, part: &dyn Fn(&str) -> ParameterValue) -> ParameterValue {
    if let Some(LocatedValue { datum: datum @ ParameterValue::List(_), .. }) = value(text) {
        return datum;
    }
    let inner = text.strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or(text);
    let is_separator = |c: char| if inner.contains(',') { c == ',' } else { c.is_whitespace() };
    let parts =
        inner.split(is_separator).map(|part| part.trim().trim_matches('"')).filter(|part| !part.is_empty());
    ParameterValue::List(parts.map(|text| LocatedValue::from(part(text))).collect())
}

/// "#ff8000" as linear numbers: the file's colours are linear, screens' are sRGB (IEC 61966-2-1).
fn hexadecimal(text: &str) -> Option<ParameterValue> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let channel = |i: usize| {
        let x = f64::from(u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok()?) / 255.0;
        let linear = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
        Some(LocatedValue::from(ParameterValue::Number(rounded(linear, 1e-4))))
    };
    Some(ParameterValue::List((0..3).map(channel).collect::<Option<_>>()?))
}
