//! Numbers of 32 and 64 bits, so that a printed formula is written once.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A float.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Rounded to it.
    fn round(x: f64) -> Self;
    /// Widened.
    fn wide(self) -> f64;
    /// e^x.
    fn exp(self) -> Self;
    /// √x.
    fn sqrt(self) -> Self;
    /// erf x.
    fn erf(self) -> Self;
    /// cos x.
    fn cos(self) -> Self;
}

impl Real for f64 {
    fn round(x: f64) -> Self {
        x
    }
    fn wide(self) -> f64 {
        self
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn erf(self) -> Self {
        libm::erf(self)
    }
    fn cos(self) -> Self {
        f64::cos(self)
    }
}

/// Functions are rounded from 64 bits: no implementation in 32 bits does better.
impl Real for f32 {
    fn round(x: f64) -> Self {
        x as f32
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn exp(self) -> Self {
        f64::from(self).exp() as f32
    }
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    fn erf(self) -> Self {
        libm::erf(f64::from(self)) as f32
    }
    fn cos(self) -> Self {
        f64::from(self).cos() as f32
    }
}

/// ∫ f over [from, to] by Simpson's rule on many steps, in the precision of `T`: as good as any table could be filled.
pub fn integral<T: Real>(from: T, to: T, f: impl Fn(T) -> T) -> T {
    const STEPS: usize = 4096;
    // Values and their sum in 64 bits, so that what is seen is the formula's own cancellation and overflow.
    let step = (to.wide() - from.wide()) / STEPS as f64;
    let at = |i: usize| f(T::round(from.wide() + step * i as f64)).wide();
    let inner: f64 = (1..STEPS).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * at(i)).sum();
    T::round((at(0) + inner + at(STEPS)) * step / 3.0)
}
