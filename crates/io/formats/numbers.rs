//! Number types of files, their conversion to the types that grids hold, and numbers as text.

use rayon::prelude::*;
use voltet_core::{Error, Result};

/// Type of the numbers of an array in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    /// Eight values a byte, the first in the highest bit.
    Bit,
}

impl NumberType {
    /// Bits of one value.
    fn bits(self) -> u64 {
        TYPES[self as usize].1
    }

    /// Bytes of one value; `None` for bits.
    pub fn size(self) -> Option<usize> {
        (self != Self::Bit).then(|| (self.bits() / 8) as usize)
    }

    /// Bytes that `count` values take; `None` on overflow.
    pub fn byte_count(self, count: u64) -> Option<u64> {
        if self == Self::Bit { Some(count.div_ceil(8)) } else { count.checked_mul(self.bits() / 8) }
    }

    /// True if the type holds whole numbers.
    pub fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The name shown to people, as the XML formats write it.
    pub fn name(self) -> &'static str {
        TYPES[self as usize].2
    }

    /// The type that the XML formats call `name`.
    pub fn from_xml(name: &str) -> Option<Self> {
        TYPES.iter().find(|known| known.2 == name).map(|known| known.0)
    }

    /// The type that legacy files call `name`.
    pub fn from_legacy(name: &str) -> Option<Self> {
        let name = name.to_ascii_lowercase();
        TYPES.iter().find(|known| known.3.contains(&name.as_str())).map(|known| known.0)
    }
}

/// The types in their order: bits of a value, name in the XML formats, names in legacy files.
const TYPES: [(NumberType, u64, &str, &[&str]); 11] = [
    (NumberType::I8, 8, "Int8", &["char", "signed_char", "vtktypeint8"]),
    (NumberType::U8, 8, "UInt8", &["unsigned_char", "vtktypeuint8"]),
    (NumberType::I16, 16, "Int16", &["short", "vtktypeint16"]),
    (NumberType::U16, 16, "UInt16", &["unsigned_short", "vtktypeuint16"]),
    // Legacy files hold the program's own index type as 32 bits.
    (NumberType::I32, 32, "Int32", &["int", "vtkidtype", "vtktypeint32"]),
    (NumberType::U32, 32, "UInt32", &["unsigned_int", "vtktypeuint32"]),
    (NumberType::I64, 64, "Int64", &["long", "long_long", "vtktypeint64", "__int64"]),
    (
        NumberType::U64,
        64,
        "UInt64",
        &["unsigned_long", "unsigned_long_long", "vtktypeuint64", "unsigned___int64"],
    ),
    (NumberType::F32, 32, "Float32", &["float"]),
    (NumberType::F64, 64, "Float64", &["double"]),
    (NumberType::Bit, 1, "Bit", &["bit"]),
];

/// Byte order of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// A type that grids hold.
pub(super) trait Target: Copy + Default + Send + Sync + 'static {
    /// Valid values of the type, for messages.
    const ACCEPTED: &'static str;
    /// The value, and whether it could be represented.
    fn from_f64(value: f64) -> (Self, bool);
    /// The value, and whether it could be represented.
    fn from_i64(value: i64) -> (Self, bool);
    /// The value, and whether it could be represented.
    fn from_u64(value: u64) -> (Self, bool);
    /// The values of a computed array, whatever can be represented.
    fn all_from(values: Vec<f64>) -> Vec<Self> {
        values.into_iter().map(|value| Self::from_f64(value).0).collect()
    }
}

impl Target for f64 {
    const ACCEPTED: &'static str = "a number";
    #[inline]
    fn from_f64(value: f64) -> (Self, bool) {
        (value, true)
    }
    #[inline]
    fn from_i64(value: i64) -> (Self, bool) {
        (value as f64, true)
    }
    #[inline]
    fn from_u64(value: u64) -> (Self, bool) {
        (value as f64, true)
    }
    fn all_from(values: Vec<f64>) -> Vec<Self> {
        values
    }
}

macro_rules! integer_target {
    ($type:ty, $accepted:literal) => {
        impl Target for $type {
            const ACCEPTED: &'static str = $accepted;
            #[inline]
            fn from_f64(value: f64) -> (Self, bool) {
                (value as $type, value as $type as f64 == value)
            }
            #[inline]
            fn from_i64(value: i64) -> (Self, bool) {
                (value as $type, <$type>::try_from(value).is_ok())
            }
            #[inline]
            fn from_u64(value: u64) -> (Self, bool) {
                (value as $type, <$type>::try_from(value).is_ok())
            }
        }
    };
}

integer_target!(u8, "a whole number from 0 to 255");
integer_target!(u32, "a whole number from 0 to 4294967295");
integer_target!(u64, "a whole number, not negative");
integer_target!(i64, "a whole number");

/// Converts the first `to.len()` values of `bytes`. An error holds the index of the first value that the target
/// cannot represent.
///
/// # Panics
/// If `bytes` is shorter than the values need: the caller has checked the length.
pub(super) fn convert<T: Target>(
    number_type: NumberType,
    order: ByteOrder,
    bytes: &[u8],
    to: &mut [T],
) -> std::result::Result<(), usize> {
    macro_rules! pass {
        ($type:ty, $wide:ty, $from:ident) => {{
            const SIZE: usize = size_of::<$type>();
            let bytes = &bytes[..to.len() * SIZE];
            let mut all_good = true;
            let value = |from: &[u8; SIZE]| {
                T::$from(<$wide>::from(match order {
                    ByteOrder::Little => <$type>::from_le_bytes(*from),
                    ByteOrder::Big => <$type>::from_be_bytes(*from),
                }))
            };
            let chunks = bytes.as_chunks::<SIZE>().0;
            for (to, from) in to.iter_mut().zip(chunks) {
                let (value, good) = value(from);
                *to = value;
                all_good &= good;
            }
            match all_good {
                true => Ok(()),
                false => Err(chunks.iter().position(|from| !value(from).1).unwrap_or(0)),
            }
        }};
    }
    match number_type {
        NumberType::I8 => pass!(i8, i64, from_i64),
        NumberType::U8 => pass!(u8, u64, from_u64),
        NumberType::I16 => pass!(i16, i64, from_i64),
        NumberType::U16 => pass!(u16, u64, from_u64),
        NumberType::I32 => pass!(i32, i64, from_i64),
        NumberType::U32 => pass!(u32, u64, from_u64),
        NumberType::I64 => pass!(i64, i64, from_i64),
        NumberType::U64 => pass!(u64, u64, from_u64),
        NumberType::F32 => pass!(f32, f64, from_f64),
        NumberType::F64 => pass!(f64, f64, from_f64),
        NumberType::Bit => {
            for (index, to) in to.iter_mut().enumerate() {
                *to = T::from_u64(u64::from(bytes[index / 8] >> (7 - index % 8) & 1)).0;
            }
            Ok(())
        }
    }
}

/// One word of text as a value of `number_type`.
pub(super) fn parse<T: Target>(number_type: NumberType, word: &[u8]) -> Result<T> {
    let wrong = || {
        Error::run("a number is damaged")
            .got(format_args!("'{}'", String::from_utf8_lossy(&word[..word.len().min(40)])))
            .expected(if number_type.is_integer() { T::ACCEPTED } else { "a number" })
    };
    let text = std::str::from_utf8(word).map_err(|_| wrong())?;
    let (value, good) = if number_type.is_integer() {
        match text.parse::<i64>() {
            // Signed characters are written as unsigned ones by some writers of text.
            Ok(value @ 128..=255) if number_type == NumberType::I8 => T::from_i64(value - 256),
            Ok(value) => T::from_i64(value),
            Err(_) => T::from_u64(text.parse::<u64>().map_err(|_| wrong())?),
        }
    } else {
        T::from_f64(parse_float(text).ok_or_else(wrong)?)
    };
    if good { Ok(value) } else { Err(wrong()) }
}

/// A floating-point number, with the forms of NaN and infinity that C libraries print (`-nan(ind)`, `1.#INF`) and
/// Fortran's exponent (`1.0D+00`).
fn parse_float(text: &str) -> Option<f64> {
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let (negative, rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let lower = rest.to_ascii_lowercase();
    let value = match lower.as_str() {
        text if ["nan", "1.#ind", "1.#qnan", "1.#snan"].iter().any(|nan| text.starts_with(nan)) => f64::NAN,
        text if text.starts_with("1.#inf") => f64::INFINITY,
        text if text.contains('d') => text.replacen('d', "e", 1).parse().ok()?,
        _ => return None,
    };
    Some(if negative { -value } else { value })
}

/// Bytes of text that one task parses.
const PART: usize = 1 << 18;

/// The words of a text, in order.
pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty())
}

/// All numbers of a text.
pub(super) fn numbers<T: Target>(number_type: NumberType, text: &[u8]) -> Result<Vec<T>> {
    let parts: Vec<Vec<T>> = parts(text)
        .into_par_iter()
        .map(|part| words(part).map(|word| parse(number_type, word)).collect())
        .collect::<Result<_>>()?;
    Ok(match <[Vec<T>; 1]>::try_from(parts) {
        Ok([only]) => only,
        Err(parts) => parts.concat(),
    })
}

/// Cuts a text at white space into parts of about [`PART`] bytes.
fn parts(mut text: &[u8]) -> Vec<&[u8]> {
    let mut parts = Vec::new();
    while text.len() > PART {
        let cut = text[PART..].iter().position(u8::is_ascii_whitespace).map_or(text.len(), |at| PART + at);
        let (part, rest) = text.split_at(cut);
        parts.push(part);
        text = rest;
    }
    parts.push(text);
    parts
}
