//! Lanes that every processor runs: vectors of the crate `wide`, chosen by the build. They are four lanes of SSE2 on x86-64, eight of
//! NEON on AArch64, and arrays of four elsewhere.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, first, first_mut, inside, sealed,
};
use wide::f32x4;
#[cfg(not(target_arch = "aarch64"))]
use wide::{f32x4 as F, f64x2 as D, u32x4 as U};
// Vectors of four would run through each kernel twice as often, which takes a tenth more instructions a segment.
#[cfg(target_arch = "aarch64")]
use wide::{f32x8 as F, f64x4 as D, u32x8 as U};

/// Number of vectors of four floats in one [`F`].
const VECTORS: usize = size_of::<F>() / size_of::<f32x4>();

const WIDTH: usize = 4 * VECTORS;

lane_set!(pub Portable: WIDTH, F, U, F, D);

/// Methods of an expression each.
macro_rules! operations {
    ($(fn $method:ident $(<const $n:ident: u32>)? ($($operand:tt)*) $(-> $result:ty)? = $value:expr;)*) => {$(
        #[inline(always)]
        fn $method $(<const $n: u32>)? ($($operand)*) $(-> $result)? {
            $value
        }
    )*};
}

#[inline(always)]
fn gathered<T: Copy>(values: &[T], index: U) -> [T; WIDTH] {
    let places = inside::<Portable>(index, values.len()).to_array();
    // SAFETY: `inside` makes an index past the end the last one, and refuses an empty slice.
    array!(|i| unsafe { *values.get_unchecked(places[i] as usize) })
}

/// Four floats of each lane, transposed to four vectors.
#[inline(always)]
fn parts(fours: [[f32; 4]; WIDTH]) -> [F; 4] {
    let turned: [[f32x4; 4]; VECTORS] =
        array!(|v| f32x4::transpose(array!(|i| f32x4::new(fours[4 * v + i]))));
    array!(|c| bytemuck::cast::<[f32x4; VECTORS], F>(array!(|v| turned[v][c])))
}

impl Float for F {
    type Lanes = Portable;
    // Where the build has the instruction; else `wide` multiplies and adds.
    const FUSED: bool =
        cfg!(any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon")));

    #[inline(always)]
    fn floor(self) -> F {
        // `wide` calls a function a lane where the build has no instruction.
        let nearest = Float::round(self);
        nearest - (self.simd_lt(nearest) & F::ONE)
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let places = inside::<Portable>(index, values.len()).to_array();
        for (n, parts) in fours.into_iter().enumerate() {
            let vectors: [[f32x4; VECTORS]; 4] = array!(|c| bytemuck::cast(parts[c]));
            let turned: [[f32x4; 4]; VECTORS] = array!(|v| f32x4::transpose(array!(|c| vectors[c][v])));
            for (place, four) in places.into_iter().zip(turned.as_flattened()) {
                // SAFETY: `inside` makes an index past the end the last one, and refuses an empty slice.
                let value = unsafe { values.get_unchecked_mut(place as usize) };
                value[n] = four.to_array();
            }
        }
    }

    // `minps` and `maxps`, which give the second operand for NaN as the trait asks; elsewhere the trait's own form does.
    #[cfg(target_arch = "x86_64")]
    operations! {
        fn min(self, other: F) -> F = self.fast_min(other);
        fn max(self, other: F) -> F = self.fast_max(other);
    }
    operations! {
        fn splat(value: f32) -> F = F::splat(value);
        fn load(values: &[f32]) -> F = F::new(*first(values));
        fn store(self, values: &mut [f32]) = *first_mut(values) = self.to_array();
        fn mul_add(self, b: F, c: F) -> F = self.mul_add(b, c);
        fn abs(self) -> F = self.abs();
        fn sqrt(self) -> F = self.sqrt();
        // With the sign that a result of 0 had before.
        fn round(self) -> F = self.round_ties_even() | (self & F::splat(-0.0));
        fn lt(self, other: F) -> F = self.simd_lt(other);
        fn le(self, other: F) -> F = self.simd_le(other);
        fn select(mask: F, yes: F, no: F) -> F = mask.select(yes, no);
        fn to_bits(self) -> U = self.to_bits();
        fn from_bits(bits: U) -> F = F::from_bits(bits);
        fn to_unsigned(self) -> U = self.fast_trunc_int().cast_unsigned();
        fn gather(values: &[f32], index: U) -> F = F::new(gathered(values, index));
        fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] = parts(gathered(values, index));
        fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [F; 4] = parts(array!(|i| *awaited.four(i)));
    }
}

impl Unsigned for U {
    type Lanes = Portable;

    #[inline(always)]
    fn load_u16(values: &[u16]) -> U {
        let values: &[u16; WIDTH] = first(values);
        U::new(array!(|i| values[i].into()))
    }

    operations! {
        fn splat(value: u32) -> U = U::splat(value);
        fn iota() -> U = U::new(array!(|i| i as u32));
        fn load(values: &[u32]) -> U = U::new(*first(values));
        fn store(self, values: &mut [u32]) = *first_mut(values) = self.to_array();
        fn shl<const N: u32>(self) -> U = self << N;
        fn shr<const N: u32>(self) -> U = self >> N;
        fn and(self, other: U) -> U = self & other;
        fn or(self, other: U) -> U = self | other;
        // `wide` compares lane by lane where the build has no instruction.
        fn min(self, other: U) -> U = self.simd_lt(other).select(self, other);
        fn max(self, other: U) -> U = self.simd_lt(other).select(other, self);
        fn test(self, bits: U) -> F = !Unsigned::equal(self & bits, U::ZERO);
        fn equal(self, other: U) -> F = F::from_bits(self.simd_eq(other));
        fn select(mask: F, yes: U, no: U) -> U = mask.select(yes, no);
        fn to_float(self) -> F = self.cast_signed().round_float();
        fn permute(self, index: U) -> U = self.shuffle_wrapping(index);
    }
}

macro_rules! mask {
    ($type:ident) => {
        impl Mask for $type {
            operations! {
                fn and(self, other: $type) -> $type = self & other;
                fn or(self, other: $type) -> $type = self | other;
                fn not(self) -> $type = !self;
                fn bits(self) -> u32 = self.to_bitmask();
            }
        }
    };
}

mask!(F);
mask!(D);

impl Double for D {
    const COUNT: usize = WIDTH / 2;
    type Mask = D;

    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        let lanes = self.to_array();
        let rounded: [f32; WIDTH / 2] = array!(|i| lanes[i] as f32);
        *first_mut(values) = rounded;
    }
    #[inline(always)]
    fn ceil(self) -> D {
        let nearest = self.round_ties_even();
        // −0 stays, and −0.5 becomes it.
        (nearest + (nearest.simd_lt(self) & D::ONE)) | (self & D::splat(-0.0))
    }

    #[cfg(target_arch = "x86_64")]
    operations! {
        fn min(self, other: D) -> D = self.fast_min(other);
        fn max(self, other: D) -> D = self.fast_max(other);
    }
    operations! {
        fn splat(value: f64) -> D = D::splat(value);
        fn load(values: &[f64]) -> D = D::new(*first(values));
        fn store(self, values: &mut [f64]) = *first_mut(values) = self.to_array();
        fn mul_add(self, b: D, c: D) -> D = self.mul_add(b, c);
        fn abs(self) -> D = self.abs();
        fn lt(self, other: D) -> D = self.simd_lt(other);
        fn le(self, other: D) -> D = self.simd_le(other);
        fn select(mask: D, yes: D, no: D) -> D = mask.select(yes, no);
    }
}
