//! Numbers relative to data: a share of a range ("25 %") or a percentile by volume ("p90") in place of a number.
//!
//! What they become is found where the data are known; a declaration says of which quantities they may be.

use std::fmt;

/// A number relative to data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relative {
    /// A share of the range, 1 for "100 %": of a value or a place from the least one on, of a width of the range's length.
    Share(f64),
    /// "p90": of 90 % of the volume the value is at most this; 0 to 100.
    Percentile(f64),
}

/// A quantity that numbers are relative to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum ArrayRef {
    /// One that the declaration names: "s", "g", "x".
    Named(&'static str),
    /// An array of the data.
    Array(String),
    /// One per unit of another.
    Per(Box<ArrayRef>, Box<ArrayRef>),
}

impl Relative {
    /// From a text such as "25 %", "-10%", "p90" or "p 99.5"; `None` where it is none.
    pub fn parse(text: &str) -> Option<Relative> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let text = text.trim();
        match (text.strip_suffix('%'), text.strip_prefix('p')) {
            (Some(share), _) => number(share).map(|share| Relative::Share(share / 100.0)),
            (_, Some(percent)) => {
                number(percent).filter(|p| (0.0..=100.0).contains(p)).map(Relative::Percentile)
            }
            _ => None,
        }
    }

    /// The value at a share of a range; its ends exactly at 0 % and 100 %.
    pub fn at_share(share: f64, [low, high]: [f64; 2]) -> f64 {
        low * (1.0 - share) + high * share
    }
}

impl fmt::Display for ArrayRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ArrayRef::Named(name) => f.write_str(name),
            ArrayRef::Array(name) => write!(f, "'{name}'"),
            ArrayRef::Per(one, other) => write!(f, "{one} per unit of {other}"),
        }
    }
}
