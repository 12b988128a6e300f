//! Numbers of twice 53 bits, as unevaluated sums of two doubles: for what must be known far better than it can be stored.
//!
//! Dekker, "A floating-point technique for extending the available precision", 1971; sums and quotients as in
//! Hida, Li and Bailey, "Algorithms for quad-double precision floating point arithmetic", 2001. Sums, differences and
//! products are right to a relative 2⁻¹⁰⁴, quotients to 2⁻¹⁰².

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// high + low, |low| at most half a unit in the last place of high.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub(crate) struct Wide {
    high: f64,
    low: f64,
}

impl Wide {
    pub(crate) const ZERO: Wide = Wide { high: 0.0, low: 0.0 };

    /// a − b, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Wide {
        two_sum(a, -b)
    }

    /// The nearest double.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// Its half, exactly.
    pub(crate) fn half(self) -> Wide {
        Wide { high: 0.5 * self.high, low: 0.5 * self.low }
    }

    pub(crate) fn abs(self) -> Wide {
        if self.high < 0.0 { -self } else { self }
    }

    /// The largest whole number that is not above it.
    pub(crate) fn floor(self) -> f64 {
        let floor = self.high.floor();
        if floor == self.high && self.low < 0.0 { floor - 1.0 } else { floor }
    }

    /// The order of numbers; what is no number is before and behind none.
    pub(crate) fn order(self, other: Wide) -> Ordering {
        self.partial_cmp(&other).unwrap_or(Ordering::Equal)
    }
}

impl From<f64> for Wide {
    fn from(high: f64) -> Wide {
        Wide { high, low: 0.0 }
    }
}

impl Neg for Wide {
    type Output = Wide;
    fn neg(self) -> Wide {
        Wide { high: -self.high, low: -self.low }
    }
}

impl Add for Wide {
    type Output = Wide;
    fn add(self, other: Wide) -> Wide {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = quick_two_sum(high.high, high.low + low.high);
        quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Wide {
    type Output = Wide;
    fn sub(self, other: Wide) -> Wide {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Wide;
    fn mul(self, other: Wide) -> Wide {
        let product = two_product(self.high, other.high);
        quick_two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Mul<f64> for Wide {
    type Output = Wide;
    fn mul(self, other: f64) -> Wide {
        let product = two_product(self.high, other);
        quick_two_sum(product.high, product.low + self.low * other)
    }
}

impl Div for Wide {
    type Output = Wide;
    fn div(self, other: Wide) -> Wide {
        let first = self.high / other.high;
        let rest = self - other * first;
        let second = rest.high / other.high;
        let third = (rest - other * second).high / other.high;
        quick_two_sum(first, second) + Wide::from(third)
    }
}

/// a + b, exactly.
fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let from_b = high - a;
    Wide { high, low: (a - (high - from_b)) + (b - from_b) }
}

/// a + b, exactly, where |a| ≥ |b| or a is 0.
fn quick_two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    Wide { high, low: b - (high - a) }
}

/// a · b, exactly where nothing underflows.
fn two_product(a: f64, b: f64) -> Wide {
    let high = a * b;
    Wide { high, low: a.mul_add(b, -high) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1/3 as a double is 1/3 − 2⁻⁵⁴/3; three times the quotient is 1 to 2⁻¹⁰².
    #[test]
    fn a_quotient_has_both_halves() {
        let third = Wide::from(1.0) / Wide::from(3.0);
        assert_eq!((third.high, third.low), (1.0 / 3.0, 2f64.powi(-54) / 3.0));
        let rest = third * 3.0 - Wide::from(1.0);
        assert!(rest.value().abs() <= 2f64.powi(-102), "{rest:?}");
    }

    /// (1 + 2⁻⁶⁰)² = 1 + 2⁻⁵⁹ + 2⁻¹²⁰: what is left of it beside 1 is far under the last bit of a double.
    #[test]
    fn products_and_differences_keep_what_doubles_lose() {
        let near = Wide::from(1.0) + Wide::from(2f64.powi(-60));
        assert_eq!((near * near - Wide::from(1.0)).value(), 2f64.powi(-59));
        assert_eq!((near * 0.5 - Wide::from(0.5)).value(), 2f64.powi(-61));
        assert_eq!(Wide::difference(1.0, 2f64.powi(-70)) - Wide::from(1.0), Wide::from(-2f64.powi(-70)));
    }

    #[test]
    fn floors_and_order_look_at_both_halves() {
        let below = Wide::difference(3.0, 2f64.powi(-70));
        assert_eq!((below.floor(), Wide::from(3.0).floor(), Wide::from(-0.5).floor()), (2.0, 3.0, -1.0));
        assert_eq!(below.order(Wide::from(3.0)), Ordering::Less);
        assert_eq!((-below).abs(), below);
    }
}
