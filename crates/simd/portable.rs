//! Four lanes that every processor runs: arrays, operation by operation. It has no block that is unsafe.

use super::operations::{Double, Float, Lanes, Mask, Unsigned, inside, parts_inside, sealed};
use std::ops::{Add, Div, Mul, Neg, Sub};

const WIDTH: usize = 4;

/// True if the build has an instruction that fuses a multiply-add: else it would be a slow library call.
const FUSED: bool = cfg!(any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon")));

lane_set!(Portable: WIDTH, F([f32; WIDTH]), U([u32; WIDTH]), M([bool; WIDTH]), D([f64; 2]), MD([bool; 2]));

/// Lanes by an expression of a lane's number.
macro_rules! each {
    ($type:ident, |$i:ident| $lane:expr) => {
        $type(array!(|$i| $lane))
    };
}

/// Methods whose results are expressions of each lane.
macro_rules! operations {
    ($(fn $method:ident $(<const $n:ident: u32>)? ($($operand:tt)*) -> $type:ident = |$i:ident| $result:expr;)*) => {$(
        #[inline(always)]
        fn $method $(<const $n: u32>)? ($($operand)*) -> $type {
            each!($type, |$i| $result)
        }
    )*};
}

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, |$a:ident, $b:ident| $lane:expr) => {
        impl $trait for $type {
            type Output = $type;
            operations! {
                fn $method(self, other: $type) -> $type = |i| {
                    let ($a, $b) = (self.0[i], other.0[i]);
                    $lane
                };
            }
        }
    };
}

operator!(F, Add, add, |a, b| a + b);
operator!(F, Sub, sub, |a, b| a - b);
operator!(F, Mul, mul, |a, b| a * b);
operator!(F, Div, div, |a, b| a / b);
operator!(U, Add, add, |a, b| a.wrapping_add(b));
operator!(U, Sub, sub, |a, b| a.wrapping_sub(b));
operator!(U, Mul, mul, |a, b| a.wrapping_mul(b));
operator!(D, Add, add, |a, b| a + b);
operator!(D, Sub, sub, |a, b| a - b);
operator!(D, Mul, mul, |a, b| a * b);
operator!(D, Div, div, |a, b| a / b);

impl Neg for D {
    type Output = D;
    operations! { fn neg(self) -> D = |i| -self.0[i]; }
}

impl Neg for F {
    type Output = F;
    operations! { fn neg(self) -> F = |i| -self.0[i]; }
}

/// One bit a lane, lane 0 the lowest.
#[inline(always)]
fn bits<const N: usize>(lanes: [bool; N]) -> u32 {
    let (mut bits, mut i) = (0, 0);
    while i < N {
        bits |= u32::from(lanes[i]) << i;
        i += 1;
    }
    bits
}

impl Float for F {
    type Lanes = Portable;
    const FUSED: bool = FUSED;

    #[inline(always)]
    fn splat(value: f32) -> F {
        F([value; WIDTH])
    }
    #[inline(always)]
    fn load(values: &[f32]) -> F {
        F(values[..WIDTH].try_into().expect("four values"))
    }
    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        values[..WIDTH].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mul_add(self, b: F, c: F) -> F {
        if FUSED { each!(F, |i| self.0[i].mul_add(b.0[i], c.0[i])) } else { self * b + c }
    }
    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        let index = inside::<Portable>(index, values.len());
        each!(F, |i| values[index.0[i] as usize])
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        let index = parts_inside::<Portable>(index, values);
        array!(|c| each!(F, |i| values[index.0[i] as usize][c]))
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let index = inside::<Portable>(index, values.len());
        for (n, parts) in fours.into_iter().enumerate() {
            for (lane, place) in index.0.into_iter().enumerate() {
                values[place as usize][n] = parts.map(|part| part.0[lane]);
            }
        }
    }

    operations! {
        fn abs(self) -> F = |i| self.0[i].abs();
        fn sqrt(self) -> F = |i| self.0[i].sqrt();
        fn round(self) -> F = |i| self.0[i].round_ties_even();
        fn floor(self) -> F = |i| self.0[i].floor();
        fn lt(self, other: F) -> M = |i| self.0[i] < other.0[i];
        fn le(self, other: F) -> M = |i| self.0[i] <= other.0[i];
        fn select(mask: M, yes: F, no: F) -> F = |i| if mask.0[i] { yes.0[i] } else { no.0[i] };
        fn to_bits(self) -> U = |i| self.0[i].to_bits();
        fn from_bits(bits: U) -> F = |i| f32::from_bits(bits.0[i]);
        fn to_unsigned(self) -> U = |i| self.0[i] as u32;
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
        U([0, 1, 2, 3])
    }
    #[inline(always)]
    fn load(values: &[u32]) -> U {
        U(values[..WIDTH].try_into().expect("four values"))
    }
    #[inline(always)]
    fn load_u16(values: &[u16]) -> U {
        let values = &values[..WIDTH];
        each!(U, |i| values[i].into())
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        values[..WIDTH].copy_from_slice(&self.0);
    }

    operations! {
        fn shl<const N: u32>(self) -> U = |i| self.0[i] << N;
        fn shr<const N: u32>(self) -> U = |i| self.0[i] >> N;
        fn and(self, other: U) -> U = |i| self.0[i] & other.0[i];
        fn or(self, other: U) -> U = |i| self.0[i] | other.0[i];
        fn min(self, other: U) -> U = |i| self.0[i].min(other.0[i]);
        fn max(self, other: U) -> U = |i| self.0[i].max(other.0[i]);
        fn test(self, bits: U) -> M = |i| self.0[i] & bits.0[i] != 0;
        fn equal(self, other: U) -> M = |i| self.0[i] == other.0[i];
        fn select(mask: M, yes: U, no: U) -> U = |i| if mask.0[i] { yes.0[i] } else { no.0[i] };
        fn to_float(self) -> F = |i| self.0[i] as i32 as f32;
        fn permute(self, index: U) -> U = |i| self.0[index.0[i] as usize % WIDTH];
    }
}

macro_rules! mask {
    ($type:ident) => {
        impl Mask for $type {
            #[inline(always)]
            fn bits(self) -> u32 {
                bits(self.0)
            }

            operations! {
                fn and(self, other: $type) -> $type = |i| self.0[i] & other.0[i];
                fn or(self, other: $type) -> $type = |i| self.0[i] | other.0[i];
                fn not(self) -> $type = |i| !self.0[i];
            }
        }
    };
}

mask!(M);
mask!(MD);

impl Double for D {
    const COUNT: usize = 2;
    type Mask = MD;

    #[inline(always)]
    fn splat(value: f64) -> D {
        D([value; 2])
    }
    #[inline(always)]
    fn load(values: &[f64]) -> D {
        D(values[..2].try_into().expect("two values"))
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[..2].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        values[..2].copy_from_slice(&self.0.map(|value| value as f32));
    }
    #[inline(always)]
    fn mul_add(self, b: D, c: D) -> D {
        if FUSED { each!(D, |i| self.0[i].mul_add(b.0[i], c.0[i])) } else { self * b + c }
    }

    operations! {
        fn abs(self) -> D = |i| self.0[i].abs();
        fn ceil(self) -> D = |i| self.0[i].ceil();
        fn lt(self, other: D) -> MD = |i| self.0[i] < other.0[i];
        fn le(self, other: D) -> MD = |i| self.0[i] <= other.0[i];
        fn select(mask: MD, yes: D, no: D) -> D = |i| if mask.0[i] { yes.0[i] } else { no.0[i] };
    }
}
