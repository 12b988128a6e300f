//! Four lanes in plain Rust: what every processor runs.

use super::{Double, Float, Lanes, Mask, Unsigned};
use std::ops::{Add, Div, Mul, Neg, Sub};

const WIDTH: usize = 4;

/// Four portable lanes.
#[derive(Clone, Copy)]
pub struct Portable;

/// Four floats.
#[derive(Clone, Copy)]
pub struct F([f32; WIDTH]);

/// Four unsigned integers.
#[derive(Clone, Copy)]
pub struct U([u32; WIDTH]);

/// Four booleans.
#[derive(Clone, Copy)]
pub struct M([bool; WIDTH]);

/// Two 64-bit floats.
#[derive(Clone, Copy)]
pub struct D([f64; 2]);

/// Two booleans.
#[derive(Clone, Copy)]
pub struct MD([bool; 2]);

impl Lanes for Portable {
    const WIDTH: usize = WIDTH;
    const NATIVE: bool = false;
    type F = F;
    type U = U;
    type M = M;
    type D = D;
}

#[inline(always)]
fn each<T: Copy + Default, const N: usize>(f: impl Fn(usize) -> T) -> [T; N] {
    let mut out = [T::default(); N];
    for (i, o) in out.iter_mut().enumerate() {
        *o = f(i);
    }
    out
}

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $apply:expr) => {
        impl $trait for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                $type(each(|i| $apply(self.0[i], other.0[i])))
            }
        }
    };
}

operator!(F, Add, add, |a: f32, b: f32| a + b);
operator!(F, Sub, sub, |a: f32, b: f32| a - b);
operator!(F, Mul, mul, |a: f32, b: f32| a * b);
operator!(F, Div, div, |a: f32, b: f32| a / b);
operator!(U, Add, add, u32::wrapping_add);
operator!(U, Sub, sub, u32::wrapping_sub);

operator!(D, Add, add, |a: f64, b: f64| a + b);
operator!(D, Sub, sub, |a: f64, b: f64| a - b);
operator!(D, Mul, mul, |a: f64, b: f64| a * b);
operator!(D, Div, div, |a: f64, b: f64| a / b);

impl Neg for D {
    type Output = D;
    #[inline(always)]
    fn neg(self) -> D {
        D(each(|i| -self.0[i]))
    }
}

impl Neg for F {
    type Output = F;
    #[inline(always)]
    fn neg(self) -> F {
        F(each(|i| -self.0[i]))
    }
}

impl Float for F {
    type Lanes = Portable;

    #[inline(always)]
    fn splat(value: f32) -> F {
        F([value; WIDTH])
    }
    #[inline(always)]
    fn load(values: &[f32]) -> F {
        F(each(|i| values[i]))
    }
    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        values[..WIDTH].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mul_add(self, b: F, c: F) -> F {
        // Two roundings: a fused operation without the instruction is a slow library call.
        F(each(|i| self.0[i] * b.0[i] + c.0[i]))
    }
    #[inline(always)]
    fn min(self, other: F) -> F {
        F(each(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn max(self, other: F) -> F {
        F(each(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn abs(self) -> F {
        F(each(|i| self.0[i].abs()))
    }
    #[inline(always)]
    fn sqrt(self) -> F {
        F(each(|i| self.0[i].sqrt()))
    }
    #[inline(always)]
    fn round(self) -> F {
        F(each(|i| self.0[i].round_ties_even()))
    }
    #[inline(always)]
    fn floor(self) -> F {
        F(each(|i| self.0[i].floor()))
    }
    #[inline(always)]
    fn lt(self, other: F) -> M {
        M(each(|i| self.0[i] < other.0[i]))
    }
    #[inline(always)]
    fn le(self, other: F) -> M {
        M(each(|i| self.0[i] <= other.0[i]))
    }
    #[inline(always)]
    fn select(mask: M, yes: F, no: F) -> F {
        F(each(|i| if mask.0[i] { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn to_bits(self) -> U {
        U(each(|i| self.0[i].to_bits()))
    }
    #[inline(always)]
    fn from_bits(bits: U) -> F {
        F(each(|i| f32::from_bits(bits.0[i])))
    }
    #[inline(always)]
    fn to_unsigned(self) -> U {
        U(each(|i| self.0[i] as i32 as u32))
    }
    #[inline(always)]
    fn permute(self, index: U) -> F {
        F(each(|i| self.0[index.0[i] as usize % WIDTH]))
    }
    #[inline(always)]
    unsafe fn gather(values: &[f32], index: U) -> F {
        F(each(|i| values[index.0[i] as usize]))
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        self.0.iter().sum()
    }
    #[inline(always)]
    fn smallest(self) -> f32 {
        self.0.iter().copied().fold(f32::INFINITY, f32::min)
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        self.0.iter().copied().fold(f32::NEG_INFINITY, f32::max)
    }
}

impl Unsigned for U {
    type Lanes = Portable;

    #[inline(always)]
    fn splat(value: u32) -> U {
        U([value; WIDTH])
    }
    #[inline(always)]
    fn iota() -> U {
        U(each(|i| i as u32))
    }
    #[inline(always)]
    fn load(values: &[u32]) -> U {
        U(each(|i| values[i]))
    }
    #[inline(always)]
    fn load_u16(values: &[u16]) -> U {
        U(each(|i| u32::from(values[i])))
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        values[..WIDTH].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn and(self, other: U) -> U {
        U(each(|i| self.0[i] & other.0[i]))
    }
    #[inline(always)]
    fn or(self, other: U) -> U {
        U(each(|i| self.0[i] | other.0[i]))
    }
    #[inline(always)]
    fn shl<const N: u32>(self) -> U {
        U(each(|i| self.0[i] << N))
    }
    #[inline(always)]
    fn shr<const N: u32>(self) -> U {
        U(each(|i| self.0[i] >> N))
    }
    #[inline(always)]
    fn min(self, other: U) -> U {
        U(each(|i| self.0[i].min(other.0[i])))
    }
    #[inline(always)]
    fn max(self, other: U) -> U {
        U(each(|i| self.0[i].max(other.0[i])))
    }
    #[inline(always)]
    fn test(self, bits: U) -> M {
        M(each(|i| self.0[i] & bits.0[i] != 0))
    }
    #[inline(always)]
    fn equal(self, other: U) -> M {
        M(each(|i| self.0[i] == other.0[i]))
    }
    #[inline(always)]
    fn select(mask: M, yes: U, no: U) -> U {
        U(each(|i| if mask.0[i] { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn to_float(self) -> F {
        F(each(|i| self.0[i] as i32 as f32))
    }
    #[inline(always)]
    fn permute(self, index: U) -> U {
        U(each(|i| self.0[index.0[i] as usize % WIDTH]))
    }
}

impl Mask for M {
    #[inline(always)]
    fn and(self, other: M) -> M {
        M(each(|i| self.0[i] & other.0[i]))
    }
    #[inline(always)]
    fn or(self, other: M) -> M {
        M(each(|i| self.0[i] | other.0[i]))
    }
    #[inline(always)]
    fn not(self) -> M {
        M(each(|i| !self.0[i]))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.iter().enumerate().fold(0, |bits, (i, &set)| bits | (u32::from(set) << i))
    }
}

impl Double for D {
    const COUNT: usize = 2;
    type Mask = MD;

    #[inline(always)]
    fn splat(value: f64) -> D {
        D([value; 2])
    }
    #[inline(always)]
    fn load(values: &[f64]) -> D {
        D(each(|i| values[i]))
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[..2].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        values[..2].copy_from_slice(&self.0.map(|x| x as f32));
    }
    #[inline(always)]
    fn mul_add(self, b: D, c: D) -> D {
        D(each(|i| self.0[i] * b.0[i] + c.0[i]))
    }
    #[inline(always)]
    fn min(self, other: D) -> D {
        D(each(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn max(self, other: D) -> D {
        D(each(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn abs(self) -> D {
        D(each(|i| self.0[i].abs()))
    }
    #[inline(always)]
    fn ceil(self) -> D {
        D(each(|i| self.0[i].ceil()))
    }
    #[inline(always)]
    fn lt(self, other: D) -> MD {
        MD(each(|i| self.0[i] < other.0[i]))
    }
    #[inline(always)]
    fn le(self, other: D) -> MD {
        MD(each(|i| self.0[i] <= other.0[i]))
    }
    #[inline(always)]
    fn select(mask: MD, yes: D, no: D) -> D {
        D(each(|i| if mask.0[i] { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn store_i32(self, values: &mut [i32]) {
        values[..2].copy_from_slice(&self.0.map(|x| x as i32));
    }
}

impl Mask for MD {
    #[inline(always)]
    fn and(self, other: MD) -> MD {
        MD(each(|i| self.0[i] & other.0[i]))
    }
    #[inline(always)]
    fn or(self, other: MD) -> MD {
        MD(each(|i| self.0[i] | other.0[i]))
    }
    #[inline(always)]
    fn not(self) -> MD {
        MD(each(|i| !self.0[i]))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.iter().enumerate().fold(0, |bits, (i, &set)| bits | (u32::from(set) << i))
    }
}
