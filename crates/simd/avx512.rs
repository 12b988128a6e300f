//! Sixteen lanes: AVX-512 F, BW, DQ, VL.
//!
//! Why its instructions may run: the crate's head.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, first, first_mut, inside, parts_inside, sealed,
};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

lane_set!(
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
    pub(super) Avx512: 16, F, U, M, D
);
registers!(F(__m512), U(__m512i), M(__mmask16), D(__m512d), MD(__mmask8));

operator!(F, Add, add, _mm512_add_ps);
operator!(F, Sub, sub, _mm512_sub_ps);
operator!(F, Mul, mul, _mm512_mul_ps);
operator!(F, Div, div, _mm512_div_ps);
operator!(U, Add, add, _mm512_add_epi32);
operator!(U, Sub, sub, _mm512_sub_epi32);
operator!(U, Mul, mul, _mm512_mullo_epi32);
operator!(F, Neg, _mm512_xor_ps, _mm512_set1_ps(-0.0));

impl Float for F {
    type Lanes = Avx512;

    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        let index = inside::<Avx512>(index, values.len());
        // SAFETY: every index lies inside the slice and below 2³¹; for the processor see the crate's head.
        F(unsafe { _mm512_i32gather_ps::<4>(index.0, values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        // Bytes: shifted here they cost one instruction in place of one a lane.
        let mut places = [0; 16];
        parts_inside::<Avx512>(index, values).shl::<4>().store(&mut places);
        let quarter = inlined!(|i: usize| {
            // SAFETY: every index lies inside the slice; for the processor see the crate's head.
            unsafe { _mm_loadu_ps(values.as_ptr().byte_add(places[i] as usize).cast()) }
        });
        parts(quarter)
    }
    #[inline(always)]
    fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [F; 4] {
        parts(inlined!(|i| on_processor!(_mm_loadu_ps(awaited.four(i).as_ptr()))))
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let mut places = [0; 16];
        inside::<Avx512>(index, values.len()).store(&mut places);
        let mut put = inlined!(|i: usize, n: usize, quarter: __m128| {
            // SAFETY: every index lies inside the slice, and n below N; for the processor see the crate's head.
            unsafe {
                let value: *mut [f32; 4] = values.as_mut_ptr().add(places[i] as usize).cast();
                _mm_storeu_ps(value.add(n).cast(), quarter);
            }
        });
        let sides: [_; N] = array!(|n| {
            let [a, b, c, d] = fours[n];
            turned([a.0, b.0, c.0, d.0])
        });
        // Places in fours: there are fewer registers than places.
        let mut four = inlined!(|i: usize| {
            for (n, sides) in sides.iter().enumerate() {
                put(i, n, on_processor!(_mm512_castps512_ps128(sides[i])));
                put(i + 4, n, on_processor!(_mm512_extractf32x4_ps::<1>(sides[i])));
                put(i + 8, n, on_processor!(_mm512_extractf32x4_ps::<2>(sides[i])));
                put(i + 12, n, on_processor!(_mm512_extractf32x4_ps::<3>(sides[i])));
            }
        });
        four(0);
        four(1);
        four(2);
        four(3);
    }

    operations! {
        fn splat(value: f32) -> F = _mm512_set1_ps(value);
        fn load(values: &[f32]) -> F = _mm512_loadu_ps(first::<_, 16>(values).as_ptr());
        fn store(self, values: &mut [f32]) =
            _mm512_storeu_ps(first_mut::<_, 16>(values).as_mut_ptr(), self.0);
        fn mul_add(self, b: F, c: F) -> F = _mm512_fmadd_ps(self.0, b.0, c.0);
        fn min(self, other: F) -> F = _mm512_min_ps(self.0, other.0);
        fn max(self, other: F) -> F = _mm512_max_ps(self.0, other.0);
        fn abs(self) -> F = _mm512_abs_ps(self.0);
        fn sqrt(self) -> F = _mm512_sqrt_ps(self.0);
        fn round(self) -> F =
            _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0);
        fn floor(self) -> F = _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0);
        fn lt(self, other: F) -> M = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0);
        fn le(self, other: F) -> M = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0);
        fn select(mask: M, yes: F, no: F) -> F = _mm512_mask_blend_ps(mask.0, no.0, yes.0);
        fn to_bits(self) -> U = _mm512_castps_si512(self.0);
        fn from_bits(bits: U) -> F = _mm512_castsi512_ps(bits.0);
        fn to_unsigned(self) -> U = _mm512_cvttps_epi32(self.0);
        fn permute(self, index: U) -> F = _mm512_permutexvar_ps(index.0, self.0);
    }
}

/// Four floats of each lane, part by part.
#[inline(always)]
fn parts(quarter: impl Fn(usize) -> __m128) -> [F; 4] {
    // Places 0, 4, 8 and 12 side by side, and so on: then each quarter is turned on its own.
    let side = inlined!(|i: usize| {
        on_processor!({
            let low = _mm512_castps128_ps512(quarter(i));
            let low = _mm512_insertf32x4::<1>(low, quarter(i + 4));
            let low = _mm512_insertf32x4::<2>(low, quarter(i + 8));
            _mm512_insertf32x4::<3>(low, quarter(i + 12))
        })
    });
    let parts = turned([side(0), side(1), side(2), side(3)]);
    array!(|c| F(parts[c]))
}

/// Rows and columns exchanged within each quarter.
#[inline(always)]
fn turned([a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
    on_processor!({
        let (ab_low, ab_high) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        let (ab_low, ab_high) = (_mm512_castps_pd(ab_low), _mm512_castps_pd(ab_high));
        let (cd_low, cd_high) = (_mm512_castps_pd(cd_low), _mm512_castps_pd(cd_high));
        [
            _mm512_castpd_ps(_mm512_unpacklo_pd(ab_low, cd_low)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(ab_low, cd_low)),
            _mm512_castpd_ps(_mm512_unpacklo_pd(ab_high, cd_high)),
            _mm512_castpd_ps(_mm512_unpackhi_pd(ab_high, cd_high)),
        ]
    })
}

impl Unsigned for U {
    type Lanes = Avx512;

    operations! {
        fn splat(value: u32) -> U = _mm512_set1_epi32(value as i32);
        fn iota() -> U = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        fn load(values: &[u32]) -> U = _mm512_loadu_si512(first::<_, 16>(values).as_ptr().cast());
        fn load_u16(values: &[u16]) -> U =
            _mm512_cvtepu16_epi32(_mm256_loadu_si256(first::<_, 16>(values).as_ptr().cast()));
        fn store(self, values: &mut [u32]) =
            _mm512_storeu_si512(first_mut::<_, 16>(values).as_mut_ptr().cast(), self.0);
        fn shl<const N: u32>(self) -> U = _mm512_slli_epi32::<N>(self.0);
        fn shr<const N: u32>(self) -> U = _mm512_srli_epi32::<N>(self.0);
        fn and(self, other: U) -> U = _mm512_and_si512(self.0, other.0);
        fn or(self, other: U) -> U = _mm512_or_si512(self.0, other.0);
        fn min(self, other: U) -> U = _mm512_min_epu32(self.0, other.0);
        fn max(self, other: U) -> U = _mm512_max_epu32(self.0, other.0);
        fn test(self, bits: U) -> M = _mm512_test_epi32_mask(self.0, bits.0);
        fn equal(self, other: U) -> M = _mm512_cmpeq_epi32_mask(self.0, other.0);
        fn select(mask: M, yes: U, no: U) -> U = _mm512_mask_blend_epi32(mask.0, no.0, yes.0);
        fn to_float(self) -> F = _mm512_cvtepi32_ps(self.0);
        fn permute(self, index: U) -> U = _mm512_permutexvar_epi32(index.0, self.0);
    }
}

/// Masks whose register is a number of one bit a lane.
macro_rules! mask {
    ($type:ident) => {
        impl Mask for $type {
            #[inline(always)]
            fn and(self, other: $type) -> $type {
                $type(self.0 & other.0)
            }
            #[inline(always)]
            fn or(self, other: $type) -> $type {
                $type(self.0 | other.0)
            }
            #[inline(always)]
            fn not(self) -> $type {
                $type(!self.0)
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                self.0.into()
            }
        }
    };
}

mask!(M);
mask!(MD);

operator!(D, Add, add, _mm512_add_pd);
operator!(D, Sub, sub, _mm512_sub_pd);
operator!(D, Mul, mul, _mm512_mul_pd);
operator!(D, Div, div, _mm512_div_pd);
operator!(D, Neg, _mm512_xor_pd, _mm512_set1_pd(-0.0));

impl Double for D {
    const COUNT: usize = 8;
    type Mask = MD;

    operations! {
        fn splat(value: f64) -> D = _mm512_set1_pd(value);
        fn load(values: &[f64]) -> D = _mm512_loadu_pd(first::<_, 8>(values).as_ptr());
        fn store(self, values: &mut [f64]) = _mm512_storeu_pd(first_mut::<_, 8>(values).as_mut_ptr(), self.0);
        fn store_f32(self, values: &mut [f32]) =
            _mm256_storeu_ps(first_mut::<_, 8>(values).as_mut_ptr(), _mm512_cvtpd_ps(self.0));
        fn mul_add(self, b: D, c: D) -> D = _mm512_fmadd_pd(self.0, b.0, c.0);
        fn min(self, other: D) -> D = _mm512_min_pd(self.0, other.0);
        fn max(self, other: D) -> D = _mm512_max_pd(self.0, other.0);
        fn abs(self) -> D = _mm512_abs_pd(self.0);
        fn ceil(self) -> D = _mm512_roundscale_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0);
        fn lt(self, other: D) -> MD = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0);
        fn le(self, other: D) -> MD = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0);
        fn select(mask: MD, yes: D, no: D) -> D = _mm512_mask_blend_pd(mask.0, no.0, yes.0);
    }
}
