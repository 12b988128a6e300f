//! Number types of files, their conversion to the types that grids hold, and numbers as text.

use rayon::prelude::*;
use voltet_core::parallel::all_or_first;
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// That of this machine.
    pub const NATIVE: ByteOrder =
        if cfg!(target_endian = "little") { ByteOrder::Little } else { ByteOrder::Big };
}

/// A type that grids hold.
pub(super) trait Target: bytemuck::Pod + Default + Send + Sync {
    /// The type of numbers in files that it is.
    const OWN: NumberType;
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
    const OWN: NumberType = NumberType::F64;
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
    ($type:ty, $own:ident, $accepted:literal) => {
        impl Target for $type {
            const OWN: NumberType = NumberType::$own;
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

integer_target!(u8, U8, "a whole number from 0 to 255");
integer_target!(u32, U32, "a whole number from 0 to 4294967295");
integer_target!(u64, U64, "a whole number, not negative");
integer_target!(i64, I64, "a whole number");

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
#[inline]
pub(super) fn parse<T: Target>(number_type: NumberType, word: &[u8]) -> Result<T> {
    let short = match number_type {
        NumberType::F32 | NumberType::F64 => short_float(word).map(T::from_f64),
        NumberType::I8 => None,
        _ => short_integer(word).map(T::from_i64),
    };
    match short {
        Some((value, true)) => Ok(value),
        _ => parse_any(number_type, word),
    }
}

/// True for a sign before a negative number, and what follows it.
#[inline]
fn signed(word: &[u8]) -> (bool, &[u8]) {
    match word {
        [b'-', digits @ ..] => (true, digits),
        _ => (false, word),
    }
}

/// A whole number of few digits.
#[inline]
fn short_integer(word: &[u8]) -> Option<i64> {
    let (is_negative, digits) = signed(word);
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0_i64;
    for byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    Some(if is_negative { -value } else { value })
}

/// Powers of ten that 64-bit floats hold exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];
/// Letters of a number that may have digits enough for one operation.
const SHORT: usize = 22;

/// A number whose digits make a whole number below 2^53: a product or quotient of two floats that are exact is rounded once (Clinger,
/// How to read floating point numbers accurately, 1990).
#[inline]
fn short_float(word: &[u8]) -> Option<f64> {
    let (is_negative, digits) = signed(word);
    if digits.len() > SHORT {
        return None;
    }
    let (mut value, mut count, mut place, mut point) = (0_u64, 0, 0, None);
    while let Some(&byte) = digits.get(place) {
        let digit = byte.wrapping_sub(b'0');
        if digit <= 9 {
            value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
            count += 1;
        } else if byte == b'.' && point.is_none() {
            point = Some(count);
        } else {
            break;
        }
        place += 1;
    }
    // Nineteen digits cannot leave 64 bits.
    if count == 0 || count > 19 || value > 1 << 53 {
        return None;
    }
    let exponent = match digits.get(place) {
        None => 0,
        Some(b'e' | b'E') => {
            let own = match &digits[place + 1..] {
                [b'+', b'-', ..] => return None,
                [b'+', rest @ ..] | rest => short_integer(rest)?,
            };
            i32::try_from(own).ok().filter(|own| own.abs() < 1000)?
        }
        Some(_) => return None,
    };
    let power = exponent - point.map_or(0, |point| count - point);
    let size = *POWERS.get(power.unsigned_abs() as usize)?;
    let value = if power < 0 { value as f64 / size } else { value as f64 * size };
    Some(if is_negative { -value } else { value })
}

fn parse_any<T: Target>(number_type: NumberType, word: &[u8]) -> Result<T> {
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
/// Fortran's exponents (`1.0D+00`, of three digits `1.0+100`).
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
        text => {
            let sign = text.rfind(['+', '-']).filter(|&sign| sign > 0 && text.len() == sign + 4)?;
            let is_digit = |byte: &u8| byte.is_ascii_digit();
            let is_number = text[..sign].ends_with(|end: char| end.is_ascii_digit() || end == '.');
            if !(is_number && text.as_bytes()[sign + 1..].iter().all(is_digit)) {
                return None;
            }
            format!("{}e{}", &text[..sign], &text[sign..]).parse().ok()?
        }
    };
    Some(if negative { -value } else { value })
}

/// Bytes of text that one task parses.
const PART: usize = 1 << 18;

pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty())
}

pub(super) fn numbers<T: Target>(number_type: NumberType, text: &[u8]) -> Result<Vec<T>> {
    let of_part = |part| words(part).map(|word| parse(number_type, word)).collect();
    let parts: Vec<Vec<T>> = all_or_first(parts(text).into_par_iter().map(of_part))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_of_few_digits_are_those_of_the_standard_library() {
        let mut state = 1_u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % below
        };
        let mut short = 0;
        for _ in 0..200_000 {
            let digits = random(1 << 31) * random(1 << 24) / (1 + random(1 << 22));
            let mut word = digits.to_string();
            word.insert((random(word.len() as u64 + 1)) as usize, '.');
            for (chance, before, after) in [(2, "-", ""), (3, "", "e-05"), (5, "", "E+12"), (7, "", "e3")] {
                if random(chance) == 0 {
                    word = format!("{before}{word}{after}");
                }
            }
            let found = short_float(word.as_bytes());
            short += usize::from(found.is_some());
            assert!(
                found.is_none_or(|found| Ok(found.to_bits()) == word.parse::<f64>().map(f64::to_bits)),
                "{word}"
            );
        }
        assert!(short > 50_000, "{short}");
        for word in [
            "",
            "-",
            ".",
            "+-1",
            "1.2.3",
            "1e",
            "1e+",
            "1e+-5",
            "e5",
            "--1",
            "1e2e3",
            "1x",
            "9007199254740993",
            "1e23",
        ] {
            assert_eq!(short_float(word.as_bytes()), None, "{word}");
        }
        assert_eq!(
            (short_float(b"-0"), short_float(b"-0.").map(f64::is_sign_negative)),
            (Some(-0.0), Some(true))
        );
    }

    #[test]
    fn whole_numbers_stay_within_their_type() {
        assert_eq!(parse::<u32>(NumberType::I64, b"4294967295").ok(), Some(u32::MAX));
        assert_eq!(parse::<u64>(NumberType::U64, b"18446744073709551615").ok(), Some(u64::MAX));
        assert_eq!(parse::<i64>(NumberType::I64, b"-9223372036854775808").ok(), Some(i64::MIN));
        assert_eq!(parse::<i64>(NumberType::I8, b"255").ok(), Some(-1));
        for (word, value) in [("3.5+000", 3.5), ("-1.25-101", -1.25e-101), ("2.+003", 2e3)] {
            assert_eq!(parse::<f64>(NumberType::F64, word.as_bytes()).ok(), Some(value), "{word}");
        }
        for word in ["3.5+00", "e+003", "3.5e+1+003", "3.5+0x3", "1+2+003"] {
            assert!(parse::<f64>(NumberType::F64, word.as_bytes()).is_err(), "{word}");
        }
        for word in ["4294967296", "-1", "", "-", "1.0", "1-2"] {
            assert!(parse::<u32>(NumberType::I64, word.as_bytes()).is_err(), "{word}");
        }
    }
}
