//! Four lanes that every processor runs, by the crate `wide`: SSE2, which each x86-64 has, NEON or WebAssembly's vectors,
//! and arrays elsewhere. It has no block that is unsafe.
//!
//! What `wide` leaves open or does lane by lane (the operand that a minimum takes where one is NaN, unsigned minima, rounding
//! down without SSE4.1) is written here in its other operations.

use super::operations::{Double, Float, Lanes, Mask, Unsigned, array, inside, parts_inside, sealed};
use bytemuck::cast;
use std::ops::{Add, Div, Mul, Neg, Sub};
use wide::{f32x4, f64x2, i32x4, u32x4};

const WIDTH: usize = 4;

/// Four portable lanes.
#[derive(Clone, Copy)]
pub(super) struct Portable;

/// Four floats.
#[derive(Clone, Copy)]
pub(super) struct F(f32x4);

/// Four unsigned integers.
#[derive(Clone, Copy)]
pub(super) struct U(u32x4);

/// Four booleans: all bits of a lane, or none.
#[derive(Clone, Copy)]
pub(super) struct M(f32x4);

/// Two 64-bit floats.
#[derive(Clone, Copy)]
pub(super) struct D(f64x2);

/// Two booleans: all bits of a lane, or none.
#[derive(Clone, Copy)]
pub(super) struct MD(f64x2);

impl sealed::Sealed for Portable {}

impl Lanes for Portable {
    const WIDTH: usize = WIDTH;
    type F = F;
    type U = U;
    type M = M;
    type D = D;
}

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident) => {
        impl $trait for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                $type($trait::$method(self.0, other.0))
            }
        }
    };
}

operator!(F, Add, add);
operator!(F, Sub, sub);
operator!(F, Mul, mul);
operator!(F, Div, div);
operator!(U, Add, add);
operator!(U, Sub, sub);
operator!(U, Mul, mul);
operator!(D, Add, add);
operator!(D, Sub, sub);
operator!(D, Mul, mul);
operator!(D, Div, div);

impl Neg for D {
    type Output = D;
    #[inline(always)]
    fn neg(self) -> D {
        D(-self.0)
    }
}

impl Neg for F {
    type Output = F;
    #[inline(always)]
    fn neg(self) -> F {
        F(-self.0)
    }
}

/// The first lanes of a slice.
#[inline(always)]
fn first<T: Copy, const N: usize>(values: &[T]) -> [T; N] {
    values[..N].try_into().expect("as many values")
}

/// For each lane of `index`, the value it names.
#[inline(always)]
fn pick<T: Copy>(index: U, value: impl Fn(usize) -> T) -> [T; WIDTH] {
    let [a, b, c, d] = index.0.to_array();
    [value(a as usize), value(b as usize), value(c as usize), value(d as usize)]
}

impl Float for F {
    type Lanes = Portable;

    #[inline(always)]
    fn splat(value: f32) -> F {
        F(f32x4::splat(value))
    }
    #[inline(always)]
    fn load(values: &[f32]) -> F {
        F(f32x4::new(first(values)))
    }
    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        values[..WIDTH].copy_from_slice(&self.0.to_array());
    }
    #[inline(always)]
    fn mul_add(self, b: F, c: F) -> F {
        // Two roundings where the build has no instruction for it: a fused operation would be a slow library call.
        F(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn min(self, other: F) -> F {
        if cfg!(target_feature = "sse2") {
            // MINPS, which takes the second operand where either is NaN.
            F(self.0.fast_min(other.0))
        } else {
            F::select(self.lt(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: F) -> F {
        if cfg!(target_feature = "sse2") {
            F(self.0.fast_max(other.0))
        } else {
            F::select(other.lt(self), self, other)
        }
    }
    #[inline(always)]
    fn abs(self) -> F {
        F(self.0.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> F {
        F(self.0.sqrt())
    }
    #[inline(always)]
    fn round(self) -> F {
        // By way of integers, which know no −0.
        F(self.0.round_ties_even() | (self.0 & f32x4::splat(-0.0)))
    }
    #[inline(always)]
    fn floor(self) -> F {
        let nearest = self.round().0;
        F(nearest - (self.0.simd_lt(nearest) & f32x4::splat(1.0)))
    }
    #[inline(always)]
    fn lt(self, other: F) -> M {
        M(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: F) -> M {
        M(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn select(mask: M, yes: F, no: F) -> F {
        F(mask.0.bitselect(yes.0, no.0))
    }
    #[inline(always)]
    fn to_bits(self) -> U {
        U(cast(self.0))
    }
    #[inline(always)]
    fn from_bits(bits: U) -> F {
        F(cast(bits.0))
    }
    #[inline(always)]
    fn to_unsigned(self) -> U {
        U(cast(self.0.fast_trunc_int()))
    }
    #[inline(always)]
    fn permute(self, index: U) -> F {
        let lanes = self.0.to_array();
        F(f32x4::new(pick(
            index,
            #[inline(always)]
            |i| lanes[i % WIDTH],
        )))
    }
    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        F(f32x4::new(pick(
            inside::<Portable>(index, values.len()),
            #[inline(always)]
            |i| values[i],
        )))
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        let index = parts_inside::<Portable>(index, values);
        array(
            #[inline(always)]
            |c| {
                F(f32x4::new(pick(
                    index,
                    #[inline(always)]
                    |i| values[i][c],
                )))
            },
        )
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let mut places = [0; 4];
        inside::<Portable>(index, values.len()).store(&mut places);
        for (n, parts) in fours.into_iter().enumerate() {
            let parts = parts.map(|part| part.0.to_array());
            for (lane, place) in places.into_iter().enumerate() {
                values[place as usize][n] = parts.map(|part| part[lane]);
            }
        }
    }
}

impl Unsigned for U {
    type Lanes = Portable;

    #[inline(always)]
    fn splat(value: u32) -> U {
        U(u32x4::splat(value))
    }
    #[inline(always)]
    fn iota() -> U {
        U(u32x4::new([0, 1, 2, 3]))
    }
    #[inline(always)]
    fn load(values: &[u32]) -> U {
        U(u32x4::new(first(values)))
    }
    #[inline(always)]
    fn load_u16(values: &[u16]) -> U {
        let [a, b, c, d] = first(values);
        U(u32x4::new([u32::from(a), u32::from(b), u32::from(c), u32::from(d)]))
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        values[..WIDTH].copy_from_slice(&self.0.to_array());
    }
    #[inline(always)]
    fn and(self, other: U) -> U {
        U(self.0 & other.0)
    }
    #[inline(always)]
    fn or(self, other: U) -> U {
        U(self.0 | other.0)
    }
    #[inline(always)]
    fn shl<const N: u32>(self) -> U {
        U(self.0 << N)
    }
    #[inline(always)]
    fn shr<const N: u32>(self) -> U {
        U(self.0 >> N)
    }
    #[inline(always)]
    fn min(self, other: U) -> U {
        U(other.0.simd_gt(self.0).bitselect(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: U) -> U {
        U(other.0.simd_gt(self.0).bitselect(other.0, self.0))
    }
    #[inline(always)]
    fn test(self, bits: U) -> M {
        self.and(bits).equal(U::splat(0)).not()
    }
    #[inline(always)]
    fn equal(self, other: U) -> M {
        M(cast(self.0.simd_eq(other.0)))
    }
    #[inline(always)]
    fn select(mask: M, yes: U, no: U) -> U {
        U(cast::<f32x4, u32x4>(mask.0).bitselect(yes.0, no.0))
    }
    #[inline(always)]
    fn to_float(self) -> F {
        F(f32x4::from_i32x4(cast::<u32x4, i32x4>(self.0)))
    }
    #[inline(always)]
    fn permute(self, index: U) -> U {
        let lanes = self.0.to_array();
        U(u32x4::new(pick(
            index,
            #[inline(always)]
            |i| lanes[i % WIDTH],
        )))
    }
}

impl Mask for M {
    #[inline(always)]
    fn and(self, other: M) -> M {
        M(self.0 & other.0)
    }
    #[inline(always)]
    fn or(self, other: M) -> M {
        M(self.0 | other.0)
    }
    #[inline(always)]
    fn not(self) -> M {
        M(!self.0)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bitmask()
    }
}

impl Double for D {
    const COUNT: usize = 2;
    type Mask = MD;

    #[inline(always)]
    fn splat(value: f64) -> D {
        D(f64x2::splat(value))
    }
    #[inline(always)]
    fn load(values: &[f64]) -> D {
        D(f64x2::new(first(values)))
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[..2].copy_from_slice(&self.0.to_array());
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        let [a, b] = self.0.to_array();
        values[..2].copy_from_slice(&[a as f32, b as f32]);
    }
    #[inline(always)]
    fn mul_add(self, b: D, c: D) -> D {
        D(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn min(self, other: D) -> D {
        if cfg!(target_feature = "sse2") {
            // MINPD, as above.
            D(self.0.fast_min(other.0))
        } else {
            D::select(self.lt(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: D) -> D {
        if cfg!(target_feature = "sse2") {
            D(self.0.fast_max(other.0))
        } else {
            D::select(other.lt(self), self, other)
        }
    }
    #[inline(always)]
    fn abs(self) -> D {
        D(self.0.abs())
    }
    #[inline(always)]
    fn ceil(self) -> D {
        let nearest = self.0.round_ties_even();
        let up = nearest + (nearest.simd_lt(self.0) & f64x2::splat(1.0));
        // −0 stays, and −0.5 becomes it.
        D(up | (self.0 & f64x2::splat(-0.0)))
    }
    #[inline(always)]
    fn lt(self, other: D) -> MD {
        MD(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: D) -> MD {
        MD(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn select(mask: MD, yes: D, no: D) -> D {
        D(mask.0.bitselect(yes.0, no.0))
    }
}

impl Mask for MD {
    #[inline(always)]
    fn and(self, other: MD) -> MD {
        MD(self.0 & other.0)
    }
    #[inline(always)]
    fn or(self, other: MD) -> MD {
        MD(self.0 | other.0)
    }
    #[inline(always)]
    fn not(self) -> MD {
        MD(!self.0)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bitmask()
    }
}
