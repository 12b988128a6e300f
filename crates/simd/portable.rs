//! Four lanes that every processor runs: vectors of the crate `wide`, chosen by the build. They are SSE2 on x86-64, NEON on AArch64, and
//! arrays elsewhere.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, first, first_mut, inside, sealed,
};
use wide::{f32x4, f64x2, u32x4};

const WIDTH: usize = 4;

lane_set!(pub Portable: WIDTH, f32x4, u32x4, f32x4, f64x2);

/// Methods of an expression each.
macro_rules! operations {
    ($(fn $method:ident $(<const $n:ident: u32>)? ($($operand:tt)*) $(-> $result:ty)? = $value:expr;)*) => {$(
        #[inline(always)]
        fn $method $(<const $n: u32>)? ($($operand)*) $(-> $result)? {
            $value
        }
    )*};
}

/// The values that an index names.
#[inline(always)]
fn gathered<T: Copy>(values: &[T], index: u32x4) -> [T; WIDTH] {
    let places = inside::<Portable>(index, values.len()).to_array();
    // SAFETY: every index lies inside the slice.
    array!(|i| unsafe { *values.get_unchecked(places[i] as usize) })
}

/// Four floats of each lane, part by part.
#[inline(always)]
fn parts(fours: [[f32; 4]; WIDTH]) -> [f32x4; 4] {
    f32x4::transpose(array!(|i| f32x4::new(fours[i])))
}

impl Float for f32x4 {
    type Lanes = Portable;
    // Where the build has the instruction; else `wide` multiplies and adds.
    const FUSED: bool =
        cfg!(any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon")));

    #[inline(always)]
    fn floor(self) -> f32x4 {
        // `wide` calls a function a lane where the build has no instruction.
        let nearest = Float::round(self);
        nearest - (self.simd_lt(nearest) & f32x4::ONE)
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[f32x4; 4]; N], values: &mut [[[f32; 4]; N]], index: u32x4) {
        let places = inside::<Portable>(index, values.len()).to_array();
        for (n, parts) in fours.into_iter().enumerate() {
            for (place, four) in places.into_iter().zip(f32x4::transpose(parts)) {
                // SAFETY: every index lies inside the slice.
                let value = unsafe { values.get_unchecked_mut(place as usize) };
                value[n] = four.to_array();
            }
        }
    }

    // The processor's, as the trait says; those of other processors differ for NaN.
    #[cfg(target_arch = "x86_64")]
    operations! {
        fn min(self, other: f32x4) -> f32x4 = self.fast_min(other);
        fn max(self, other: f32x4) -> f32x4 = self.fast_max(other);
    }
    operations! {
        fn splat(value: f32) -> f32x4 = f32x4::splat(value);
        fn load(values: &[f32]) -> f32x4 = f32x4::new(*first(values));
        fn store(self, values: &mut [f32]) = *first_mut(values) = self.to_array();
        fn mul_add(self, b: f32x4, c: f32x4) -> f32x4 = self.mul_add(b, c);
        fn abs(self) -> f32x4 = self.abs();
        fn sqrt(self) -> f32x4 = self.sqrt();
        // The sign of what is rounded to 0.
        fn round(self) -> f32x4 = self.round_ties_even() | (self & f32x4::splat(-0.0));
        fn lt(self, other: f32x4) -> f32x4 = self.simd_lt(other);
        fn le(self, other: f32x4) -> f32x4 = self.simd_le(other);
        fn select(mask: f32x4, yes: f32x4, no: f32x4) -> f32x4 = mask.select(yes, no);
        fn to_bits(self) -> u32x4 = self.to_bits();
        fn from_bits(bits: u32x4) -> f32x4 = f32x4::from_bits(bits);
        fn to_unsigned(self) -> u32x4 = self.fast_trunc_int().cast_unsigned();
        fn gather(values: &[f32], index: u32x4) -> f32x4 = f32x4::new(gathered(values, index));
        fn gather_parts(values: &[[f32; 4]], index: u32x4) -> [f32x4; 4] = parts(gathered(values, index));
        fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [f32x4; 4] = parts(array!(|i| *awaited.four(i)));
    }
}

impl Unsigned for u32x4 {
    type Lanes = Portable;

    #[inline(always)]
    fn load_u16(values: &[u16]) -> u32x4 {
        let values: &[u16; WIDTH] = first(values);
        u32x4::new(array!(|i| values[i].into()))
    }

    operations! {
        fn splat(value: u32) -> u32x4 = u32x4::splat(value);
        fn iota() -> u32x4 = u32x4::new([0, 1, 2, 3]);
        fn load(values: &[u32]) -> u32x4 = u32x4::new(*first(values));
        fn store(self, values: &mut [u32]) = *first_mut(values) = self.to_array();
        fn shl<const N: u32>(self) -> u32x4 = self << N;
        fn shr<const N: u32>(self) -> u32x4 = self >> N;
        fn and(self, other: u32x4) -> u32x4 = self & other;
        fn or(self, other: u32x4) -> u32x4 = self | other;
        // `wide` compares lane by lane where the build has no instruction.
        fn min(self, other: u32x4) -> u32x4 = self.simd_lt(other).select(self, other);
        fn max(self, other: u32x4) -> u32x4 = self.simd_lt(other).select(other, self);
        fn test(self, bits: u32x4) -> f32x4 = !Unsigned::equal(self & bits, u32x4::ZERO);
        fn equal(self, other: u32x4) -> f32x4 = f32x4::from_bits(self.simd_eq(other));
        fn select(mask: f32x4, yes: u32x4, no: u32x4) -> u32x4 = mask.select(yes, no);
        fn to_float(self) -> f32x4 = self.cast_signed().round_float();
        fn permute(self, index: u32x4) -> u32x4 = self.shuffle_wrapping(index);
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

mask!(f32x4);
mask!(f64x2);

impl Double for f64x2 {
    const COUNT: usize = 2;
    type Mask = f64x2;

    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        let lanes = self.to_array();
        *first_mut(values) = [lanes[0] as f32, lanes[1] as f32];
    }
    #[inline(always)]
    fn ceil(self) -> f64x2 {
        let nearest = self.round_ties_even();
        // −0 stays, and −0.5 becomes it.
        (nearest + (nearest.simd_lt(self) & f64x2::ONE)) | (self & f64x2::splat(-0.0))
    }

    #[cfg(target_arch = "x86_64")]
    operations! {
        fn min(self, other: f64x2) -> f64x2 = self.fast_min(other);
        fn max(self, other: f64x2) -> f64x2 = self.fast_max(other);
    }
    operations! {
        fn splat(value: f64) -> f64x2 = f64x2::splat(value);
        fn load(values: &[f64]) -> f64x2 = f64x2::new(*first(values));
        fn store(self, values: &mut [f64]) = *first_mut(values) = self.to_array();
        fn mul_add(self, b: f64x2, c: f64x2) -> f64x2 = self.mul_add(b, c);
        fn abs(self) -> f64x2 = self.abs();
        fn lt(self, other: f64x2) -> f64x2 = self.simd_lt(other);
        fn le(self, other: f64x2) -> f64x2 = self.simd_le(other);
        fn select(mask: f64x2, yes: f64x2, no: f64x2) -> f64x2 = mask.select(yes, no);
    }
}
