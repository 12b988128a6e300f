//! Dimensions of units, as exponents of the base units of the SI (BIPM, "The International System of Units", 9th edition, 2019).
//!
//! A unit is read for its dimension alone: "kPa" and "bar" have that of "Pa", and no number is converted. Unit texts: symbols with
//! prefixes and powers, `kg/(m s^2)`, `m^2/s^2`, `W/m^2/K`, `m s-1`, `1/s`.

use crate::{Error, Result};
use std::fmt;

/// Base units, in the order of exponents.
const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// Symbols, the exponents of their base units, and true where prefixes stand before them.
const SYMBOLS: &[(&str, [i8; 7], bool)] = &[
    ("m", [0, 1, 0, 0, 0, 0, 0], true),
    ("g", [1, 0, 0, 0, 0, 0, 0], true),
    ("s", [0, 0, 1, 0, 0, 0, 0], true),
    ("A", [0, 0, 0, 1, 0, 0, 0], true),
    ("K", [0, 0, 0, 0, 1, 0, 0], true),
    ("mol", [0, 0, 0, 0, 0, 1, 0], true),
    ("cd", [0, 0, 0, 0, 0, 0, 1], true),
    ("N", [1, 1, -2, 0, 0, 0, 0], true),
    ("Pa", [1, -1, -2, 0, 0, 0, 0], true),
    ("bar", [1, -1, -2, 0, 0, 0, 0], true),
    ("J", [1, 2, -2, 0, 0, 0, 0], true),
    ("W", [1, 2, -3, 0, 0, 0, 0], true),
    ("V", [1, 2, -3, -1, 0, 0, 0], true),
    ("C", [0, 0, 1, 1, 0, 0, 0], true),
    ("T", [1, 0, -2, -1, 0, 0, 0], true),
    ("Hz", [0, 0, -1, 0, 0, 0, 0], true),
    ("min", [0, 0, 1, 0, 0, 0, 0], false),
    ("h", [0, 0, 1, 0, 0, 0, 0], false),
    ("rad", [0; 7], false),
    ("degree", [0; 7], false),
];

const PREFIXES: [&str; 9] = ["G", "M", "k", "h", "c", "m", "µ", "u", "n"];

/// Largest power of a symbol.
const LARGEST_POWER: i32 = 99;

/// Longest text of a unit, bytes: far beyond what is written by hand, and brackets in it are far within the stack.
const MAX_LENGTH: usize = 200;

/// Exponents that differ by no more are equal: thirds of a cube root add up to whole numbers but for rounding.
const ROUNDING: f64 = 1e-9;

/// Exponents of the base units; all 0: a pure number.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dimension([f64; 7]);

impl Dimension {
    /// Reads a unit.
    ///
    /// # Errors
    /// - a symbol that is not known, and a text that is no product of symbols.
    pub fn parse(text: &str) -> Result<Dimension> {
        let mut plain = text.replace(['*', '·'], " ").replace('μ', "µ").replace('⁻', "^-");
        for (raised, digit) in [('²', "2"), ('³', "3"), ('¹', "1"), ('⁴', "4")] {
            plain = plain.replace(&format!("-{raised}"), &format!("-{digit}"));
            plain = plain.replace(raised, &format!("^{digit}"));
        }
        let mut reader = Reader { text, rest: plain.trim() };
        if text.len() > MAX_LENGTH {
            return Err(reader.unreadable());
        }
        let unit = reader.product()?;
        if reader.rest.is_empty() { Ok(unit) } else { Err(reader.unreadable()) }
    }

    /// True for a pure number.
    pub fn is_none(self) -> bool {
        self.is_like(Dimension::default())
    }

    /// True if both have the same exponents.
    pub fn is_like(self, other: Dimension) -> bool {
        self.0.iter().zip(other.0).all(|(a, b)| (a - b).abs() <= ROUNDING)
    }

    /// The dimension of a product with the other's `power`-th power.
    pub fn times(self, other: Dimension, power: f64) -> Dimension {
        Dimension(std::array::from_fn(|i| self.0[i] + power * other.0[i]))
    }

    /// The dimension of a power.
    pub fn raised(self, power: f64) -> Dimension {
        Dimension::default().times(self, power)
    }
}

impl fmt::Display for Dimension {
    /// In base units: "kg/(m s^2)"; "1" for a pure number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = |sign: f64| -> Vec<String> {
            let powers = BASE.iter().zip(self.0).filter(|(_, power)| sign * power > ROUNDING);
            // Six digits are enough for thirds.
            let rounded = |power: f64| (power.abs() * 1e6).round() / 1e6;
            let text = |(symbol, power): (&&str, f64)| match rounded(power) {
                1.0 => symbol.to_string(),
                power => format!("{symbol}^{power}"),
            };
            powers.map(text).collect()
        };
        let (above, below) = (side(1.0), side(-1.0));
        f.write_str(&if above.is_empty() { "1".into() } else { above.join(" ") })?;
        match below.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            more => write!(f, "/({})", more.join(" ")),
        }
    }
}

/// The unit that is read, and what is left of it.
struct Reader<'a, 'b> {
    text: &'b str,
    rest: &'a str,
}

impl<'a> Reader<'a, '_> {
    fn unreadable(&self) -> Error {
        let error = Error::usage("a unit cannot be read").got(format!("'{}'", self.text));
        error.expected("such as \"Pa\", \"m/s^2\" or \"kg/(m s^2)\"; \"1\" for a pure number")
    }

    /// Takes the character if it comes next, and the spaces around it.
    fn takes(&mut self, wanted: char) -> bool {
        let found = self.rest.trim_start().strip_prefix(wanted);
        self.rest = found.map_or(self.rest, str::trim_start);
        found.is_some()
    }

    /// The longest run of such characters.
    fn run(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let (run, rest) = self.rest.split_at(self.rest.find(|c| !belongs(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        run
    }

    /// Factors and divisors. A factor behind a divisor could be meant on either side, and is refused.
    fn product(&mut self) -> Result<Dimension> {
        let mut unit = self.factor()?;
        let mut is_divided = false;
        loop {
            if self.takes('/') {
                is_divided = true;
                unit = unit.times(self.factor()?, -1.0);
                continue;
            }
            self.rest = self.rest.trim_start();
            if self.rest.is_empty() || self.rest.starts_with(')') {
                return Ok(unit);
            }
            if is_divided {
                let error = Error::usage("a unit can be read in two ways").got(format!("'{}'", self.text));
                return Err(error.expected("brackets around a denominator of several, as in \"kg/(m s^2)\""));
            }
            unit = unit.times(self.factor()?, 1.0);
        }
    }

    fn factor(&mut self) -> Result<Dimension> {
        let base = if self.rest.starts_with('(') {
            self.takes('(');
            let inner = self.product()?;
            if !self.takes(')') {
                return Err(self.unreadable());
            }
            inner
        } else if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            let number = self.run(|c| c.is_ascii_digit());
            return if number == "1" { Ok(Dimension::default()) } else { Err(self.unreadable()) };
        } else {
            match self.run(char::is_alphabetic) {
                "" => return Err(self.unreadable()),
                symbol => self.symbol(symbol)?,
            }
        };
        let has_mark = self.takes('^');
        let sign = if self.rest.starts_with('-') { self.run(|c| c == '-') } else { "" };
        let digits = self.run(|c| c.is_ascii_digit());
        if digits.is_empty() && sign.is_empty() && !has_mark {
            return Ok(base);
        }
        let power = format!("{sign}{digits}").parse().ok().filter(|power: &i32| power.abs() <= LARGEST_POWER);
        power.map(|power| base.raised(power.into())).ok_or_else(|| self.unreadable())
    }

    fn symbol(&self, symbol: &str) -> Result<Dimension> {
        let known = |(name, _, is_prefixed): &&(&str, [i8; 7], bool)| {
            let prefix = symbol.strip_suffix(name);
            prefix.is_some_and(|prefix| prefix.is_empty() || *is_prefixed && PREFIXES.contains(&prefix))
        };
        // A symbol of its own before a prefix: "min" is no milli-inch, "cd" no centi-day.
        let own = SYMBOLS.iter().find(|(name, ..)| *name == symbol);
        let found = own.or_else(|| SYMBOLS.iter().find(known));
        let dimension = found.map(|(_, powers, _)| Dimension(powers.map(f64::from)));
        dimension.ok_or_else(|| {
            let error = Error::usage("a unit is not known").got(format!("'{symbol}' in '{}'", self.text));
            error.not_among(symbol, SYMBOLS.iter().map(|entry| entry.0))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_people_write_them() {
        for (text, right) in [
            ("Pa", "kg/(m s^2)"),
            ("kPa", "kg/(m s^2)"),
            ("mbar", "kg/(m s^2)"),
            ("N/m^2", "kg/(m s^2)"),
            ("kg/(m s^2)", "kg/(m s^2)"),
            ("kg m-1 s-2", "kg/(m s^2)"),
            ("kg·m⁻¹·s⁻²", "kg/(m s^2)"),
            ("m²/s²", "m^2/s^2"),
            ("m2/s2", "m^2/s^2"),
            ("W/m^2/K", "kg/(s^3 K)"),
            ("J/(kg K)", "m^2/(s^2 K)"),
            ("(m/s)^2", "m^2/s^2"),
            ("V A", "kg m^2/s^3"),
            ("C T m/s", "kg m/s^2"),
            ("1/s", "1/s"),
            ("Hz", "1/s"),
            ("km/h", "m/s"),
            ("min", "s"),
            ("cd", "cd"),
            ("µm", "m"),
            ("mol / m^3", "mol/m^3"),
            ("degree", "1"),
            ("1", "1"),
            (" m ", "m"),
        ] {
            let unit = Dimension::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(unit.to_string(), right, "{text}");
        }
    }

    #[test]
    fn what_is_no_unit_is_refused() {
        for (text, what) in [
            ("", "cannot be read"),
            ("Pascal", "'Pascal' in 'Pascal'"),
            ("pa", "'Pa'"),
            ("m/", "cannot be read"),
            ("/s", "cannot be read"),
            ("m^", "cannot be read"),
            ("m--2", "cannot be read"),
            ("m^999", "cannot be read"),
            ("(m", "cannot be read"),
            ("m)", "cannot be read"),
            ("kg/m s^2", "two ways"),
            ("kmin", "'min'"),
            ("12", "cannot be read"),
            ("m + s", "cannot be read"),
        ] {
            let error = Dimension::parse(text).unwrap_err().to_string();
            assert!(error.contains(what), "{text}: {error}");
        }
        Dimension::parse(&"(".repeat(100_000)).unwrap_err();
    }

    #[test]
    fn thirds_add_up() {
        let metre = Dimension::parse("m").unwrap();
        let third = metre.raised(1.0 / 3.0);
        assert!(third.times(third, 1.0).times(third, 1.0).is_like(metre) && !third.is_like(metre));
    }
}
