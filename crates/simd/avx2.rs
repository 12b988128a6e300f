//! Eight lanes: AVX2 and FMA.
//!
//! Why its instructions may run: the crate's head.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, first, first_mut, inside, parts_inside, sealed,
};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

lane_set!(
    #[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
    pub(super) Avx2: 8, F, U, M, D
);
registers!(F(__m256), U(__m256i), M(__m256), D(__m256d), MD(__m256d));

operator!(F, Add, add, _mm256_add_ps);
operator!(F, Sub, sub, _mm256_sub_ps);
operator!(F, Mul, mul, _mm256_mul_ps);
operator!(F, Div, div, _mm256_div_ps);
operator!(U, Add, add, _mm256_add_epi32);
operator!(U, Sub, sub, _mm256_sub_epi32);
operator!(U, Mul, mul, _mm256_mullo_epi32);
operator!(F, Neg, _mm256_xor_ps, _mm256_set1_ps(-0.0));

impl Float for F {
    type Lanes = Avx2;

    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        let index = inside::<Avx2>(index, values.len());
        // SAFETY: every index lies inside the slice and below 2³¹; for the processor see the crate's head.
        F(unsafe { _mm256_i32gather_ps::<4>(values.as_ptr(), index.0) })
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        // Bytes: shifted here they cost one instruction in place of one a lane.
        let mut places = [0; 8];
        parts_inside::<Avx2>(index, values).shl::<4>().store(&mut places);
        // Read from memory a place is one operation, taken out of a vector two or three.
        std::hint::black_box(&mut places);
        let half = inlined!(|i: usize| {
            // SAFETY: every index lies inside the slice; for the processor see the crate's head.
            unsafe { _mm_loadu_ps(values.as_ptr().byte_add(places[i] as usize).cast()) }
        });
        parts(half)
    }
    #[inline(always)]
    fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [F; 4] {
        parts(inlined!(|i| on_processor!(_mm_loadu_ps(awaited.four(i).as_ptr()))))
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let mut places = [0; 8];
        inside::<Avx2>(index, values.len()).store(&mut places);
        let mut put = inlined!(|i: usize, n: usize, half: __m128| {
            // SAFETY: every index lies inside the slice, and n below N; for the processor see the crate's head.
            unsafe {
                let value: *mut [f32; 4] = values.as_mut_ptr().add(places[i] as usize).cast();
                _mm_storeu_ps(value.add(n).cast(), half);
            }
        });
        for (n, [a, b, c, d]) in fours.into_iter().enumerate() {
            for (i, side) in turned([a.0, b.0, c.0, d.0]).into_iter().enumerate() {
                put(i, n, on_processor!(_mm256_castps256_ps128(side)));
                put(i + 4, n, on_processor!(_mm256_extractf128_ps::<1>(side)));
            }
        }
    }

    operations! {
        fn splat(value: f32) -> F = _mm256_set1_ps(value);
        fn load(values: &[f32]) -> F = _mm256_loadu_ps(first::<_, 8>(values).as_ptr());
        fn store(self, values: &mut [f32]) = _mm256_storeu_ps(first_mut::<_, 8>(values).as_mut_ptr(), self.0);
        fn mul_add(self, b: F, c: F) -> F = _mm256_fmadd_ps(self.0, b.0, c.0);
        fn min(self, other: F) -> F = _mm256_min_ps(self.0, other.0);
        fn max(self, other: F) -> F = _mm256_max_ps(self.0, other.0);
        fn abs(self) -> F = _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0);
        fn sqrt(self) -> F = _mm256_sqrt_ps(self.0);
        fn round(self) -> F = _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0);
        fn floor(self) -> F = _mm256_round_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0);
        fn lt(self, other: F) -> M = _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0);
        fn le(self, other: F) -> M = _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0);
        fn select(mask: M, yes: F, no: F) -> F = _mm256_blendv_ps(no.0, yes.0, mask.0);
        fn to_bits(self) -> U = _mm256_castps_si256(self.0);
        fn from_bits(bits: U) -> F = _mm256_castsi256_ps(bits.0);
        fn to_unsigned(self) -> U = _mm256_cvttps_epi32(self.0);
        fn permute(self, index: U) -> F = _mm256_permutevar8x32_ps(self.0, index.0);
    }
}

/// Four floats of each lane, part by part.
#[inline(always)]
fn parts(half: impl Fn(usize) -> __m128) -> [F; 4] {
    // Places 0 and 4 side by side, and so on: then each half is turned on its own.
    let side = inlined!(|i: usize| on_processor!(_mm256_set_m128(half(i + 4), half(i))));
    let parts = turned([side(0), side(1), side(2), side(3)]);
    array!(|c| F(parts[c]))
}

/// Rows and columns exchanged within each half.
#[inline(always)]
fn turned([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    on_processor!({
        let (ab_low, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        let (ab_low, ab_high) = (_mm256_castps_pd(ab_low), _mm256_castps_pd(ab_high));
        let (cd_low, cd_high) = (_mm256_castps_pd(cd_low), _mm256_castps_pd(cd_high));
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(ab_low, cd_low)),
            _mm256_castpd_ps(_mm256_unpackhi_pd(ab_low, cd_low)),
            _mm256_castpd_ps(_mm256_unpacklo_pd(ab_high, cd_high)),
            _mm256_castpd_ps(_mm256_unpackhi_pd(ab_high, cd_high)),
        ]
    })
}

impl Unsigned for U {
    type Lanes = Avx2;

    #[inline(always)]
    fn test(self, bits: U) -> M {
        let none =
            on_processor!(_mm256_cmpeq_epi32(_mm256_and_si256(self.0, bits.0), _mm256_setzero_si256()));
        M(on_processor!(_mm256_castsi256_ps(none))).not()
    }

    operations! {
        fn splat(value: u32) -> U = _mm256_set1_epi32(value as i32);
        fn iota() -> U = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        fn load(values: &[u32]) -> U = _mm256_loadu_si256(first::<_, 8>(values).as_ptr().cast());
        fn load_u16(values: &[u16]) -> U =
            _mm256_cvtepu16_epi32(_mm_loadu_si128(first::<_, 8>(values).as_ptr().cast()));
        fn store(self, values: &mut [u32]) =
            _mm256_storeu_si256(first_mut::<_, 8>(values).as_mut_ptr().cast(), self.0);
        fn shl<const N: u32>(self) -> U = _mm256_sll_epi32(self.0, _mm_cvtsi32_si128(N as i32));
        fn shr<const N: u32>(self) -> U = _mm256_srl_epi32(self.0, _mm_cvtsi32_si128(N as i32));
        fn and(self, other: U) -> U = _mm256_and_si256(self.0, other.0);
        fn or(self, other: U) -> U = _mm256_or_si256(self.0, other.0);
        fn min(self, other: U) -> U = _mm256_min_epu32(self.0, other.0);
        fn max(self, other: U) -> U = _mm256_max_epu32(self.0, other.0);
        fn equal(self, other: U) -> M = _mm256_castsi256_ps(_mm256_cmpeq_epi32(self.0, other.0));
        fn select(mask: M, yes: U, no: U) -> U =
            _mm256_castps_si256(
                _mm256_blendv_ps(_mm256_castsi256_ps(no.0), _mm256_castsi256_ps(yes.0), mask.0)
            );
        fn to_float(self) -> F = _mm256_cvtepi32_ps(self.0);
        fn permute(self, index: U) -> U = _mm256_permutevar8x32_epi32(self.0, index.0);
    }
}

impl Mask for M {
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm256_movemask_ps(self.0))) as u32
    }

    operations! {
        fn and(self, other: M) -> M = _mm256_and_ps(self.0, other.0);
        fn or(self, other: M) -> M = _mm256_or_ps(self.0, other.0);
        fn not(self) -> M = _mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
    }
}

operator!(D, Add, add, _mm256_add_pd);
operator!(D, Sub, sub, _mm256_sub_pd);
operator!(D, Mul, mul, _mm256_mul_pd);
operator!(D, Div, div, _mm256_div_pd);
operator!(D, Neg, _mm256_xor_pd, _mm256_set1_pd(-0.0));

impl Double for D {
    const COUNT: usize = 4;
    type Mask = MD;

    operations! {
        fn splat(value: f64) -> D = _mm256_set1_pd(value);
        fn load(values: &[f64]) -> D = _mm256_loadu_pd(first::<_, 4>(values).as_ptr());
        fn store(self, values: &mut [f64]) = _mm256_storeu_pd(first_mut::<_, 4>(values).as_mut_ptr(), self.0);
        fn store_f32(self, values: &mut [f32]) =
            _mm_storeu_ps(first_mut::<_, 4>(values).as_mut_ptr(), _mm256_cvtpd_ps(self.0));
        fn mul_add(self, b: D, c: D) -> D = _mm256_fmadd_pd(self.0, b.0, c.0);
        fn min(self, other: D) -> D = _mm256_min_pd(self.0, other.0);
        fn max(self, other: D) -> D = _mm256_max_pd(self.0, other.0);
        fn abs(self) -> D = _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0);
        fn ceil(self) -> D = _mm256_round_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0);
        fn lt(self, other: D) -> MD = _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0);
        fn le(self, other: D) -> MD = _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0);
        fn select(mask: MD, yes: D, no: D) -> D = _mm256_blendv_pd(no.0, yes.0, mask.0);
    }
}

impl Mask for MD {
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm256_movemask_pd(self.0))) as u32
    }

    operations! {
        fn and(self, other: MD) -> MD = _mm256_and_pd(self.0, other.0);
        fn or(self, other: MD) -> MD = _mm256_or_pd(self.0, other.0);
        fn not(self) -> MD = _mm256_xor_pd(self.0, _mm256_castsi256_pd(_mm256_set1_epi32(-1)));
    }
}
