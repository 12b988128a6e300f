//! Values of options: words, numbers, colours and sizes.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// One of several values, each with its name and help.
pub(super) fn one_of<T: Clone + Send + Sync + 'static>(
    words: impl IntoIterator<Item = (T, &'static str, &'static str)>,
) -> impl TypedValueParser<Value = T> {
    let words: Vec<(T, &str, &str)> = words.into_iter().collect();
    let possible = |(_, name, help): &(T, &'static str, &'static str)| {
        let value = PossibleValue::new(*name);
        if help.is_empty() { value } else { value.help(*help) }
    };
    PossibleValuesParser::new(words.iter().map(possible).collect::<Vec<_>>()).map(move |name: String| {
        let found = words.iter().find(|word| word.1 == name);
        found.expect("the parser accepts no other name").0.clone()
    })
}

/// A number from 0 on, as one or as a fraction of two.
pub(super) fn fraction(text: &str) -> Result<f64, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((over, under)) => number(over).zip(number(under)).map(|(over, under)| over / under),
        None => number(text),
    };
    let value = value.filter(|value| *value >= 0.0 && value.is_finite());
    value.ok_or_else(|| "a number of 0 or more, or a fraction such as 1/255".into())
}

/// A linear colour, "0.1,0.2,0.3".
pub(super) fn color(text: &str) -> Result<[f64; 3], String> {
    let channels: Vec<f64> = text.split(',').map(fraction).collect::<Result<_, _>>()?;
    channels.try_into().map_err(|_| "a colour is three numbers with commas, such as 1,1,1".into())
}

/// An amount of memory in bytes, "4GiB" or "500 MB".
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let (number, unit) = text.split_at(text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len()));
    let factor = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1024f64.powi(2),
        "g" | "gib" => 1024f64.powi(3),
        "t" | "tib" => 1024f64.powi(4),
        _ => f64::NAN,
    };
    let bytes = number.trim().parse::<f64>().map_or(f64::NAN, |number| number * factor);
    match bytes >= 1.0 && bytes.is_finite() {
        true => Ok(bytes as u64),
        false => Err("an amount of memory has a unit: 4GiB, 500MB".into()),
    }
}

/// A picture's size, "1024x768".
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let number = |part: &str| part.trim().parse::<u32>().ok().filter(|n| *n > 0);
    let parts = text.split_once(['x', '×']);
    let both = parts.and_then(|(width, height)| Some([number(width)?, number(height)?]));
    both.ok_or_else(|| "a size is WIDTHxHEIGHT in pixels, such as 1024x768".into())
}
