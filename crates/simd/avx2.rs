//! Eight lanes: AVX2 and FMA.
//!
//! Why its instructions may run: the crate's head.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, inlined, inside, parts_inside, sealed,
};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight AVX2 lanes.
#[derive(Clone, Copy)]
pub(super) struct Avx2;

/// Eight floats.
#[derive(Clone, Copy)]
pub(super) struct F(__m256);

/// Eight unsigned integers.
#[derive(Clone, Copy)]
pub(super) struct U(__m256i);

/// Eight booleans.
#[derive(Clone, Copy)]
pub(super) struct M(__m256);

impl sealed::Sealed for Avx2 {}

impl Lanes for Avx2 {
    const WIDTH: usize = 8;
    type F = F;
    type U = U;
    type M = M;
    type D = D;
}

/// Four 64-bit floats.
#[derive(Clone, Copy)]
pub(super) struct D(__m256d);

/// Four booleans.
#[derive(Clone, Copy)]
pub(super) struct MD(__m256d);

operator!(F, Add, add, _mm256_add_ps);
operator!(F, Sub, sub, _mm256_sub_ps);
operator!(F, Mul, mul, _mm256_mul_ps);
operator!(F, Div, div, _mm256_div_ps);
operator!(U, Add, add, _mm256_add_epi32);
operator!(U, Sub, sub, _mm256_sub_epi32);
operator!(U, Mul, mul, _mm256_mullo_epi32);

impl Neg for F {
    type Output = F;
    #[inline(always)]
    fn neg(self) -> F {
        F(on_processor!(_mm256_xor_ps(self.0, _mm256_set1_ps(-0.0))))
    }
}

impl Float for F {
    type Lanes = Avx2;

    #[inline(always)]
    fn splat(value: f32) -> F {
        F(on_processor!(_mm256_set1_ps(value)))
    }
    #[inline(always)]
    fn load(values: &[f32]) -> F {
        let values: &[f32; 8] = values[..8].try_into().expect("eight values");
        F(on_array!(_mm256_loadu_ps(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        let values: &mut [f32; 8] = (&mut values[..8]).try_into().expect("eight values");
        on_array!(_mm256_storeu_ps(values.as_mut_ptr(), self.0))
    }
    #[inline(always)]
    fn mul_add(self, b: F, c: F) -> F {
        F(on_processor!(_mm256_fmadd_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn min(self, other: F) -> F {
        F(on_processor!(_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: F) -> F {
        F(on_processor!(_mm256_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> F {
        F(on_processor!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> F {
        F(on_processor!(_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn round(self) -> F {
        F(on_processor!(_mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> F {
        F(on_processor!(_mm256_round_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn lt(self, other: F) -> M {
        M(on_processor!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: F) -> M {
        M(on_processor!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: M, yes: F, no: F) -> F {
        F(on_processor!(_mm256_blendv_ps(no.0, yes.0, mask.0)))
    }
    #[inline(always)]
    fn to_bits(self) -> U {
        U(on_processor!(_mm256_castps_si256(self.0)))
    }
    #[inline(always)]
    fn from_bits(bits: U) -> F {
        F(on_processor!(_mm256_castsi256_ps(bits.0)))
    }
    #[inline(always)]
    fn to_unsigned(self) -> U {
        U(on_processor!(_mm256_cvttps_epi32(self.0)))
    }
    #[inline(always)]
    fn permute(self, index: U) -> F {
        F(on_processor!(_mm256_permutevar8x32_ps(self.0, index.0)))
    }
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
        let half = inlined(
            #[inline(always)]
            |i: usize| {
                // SAFETY: every index lies inside the slice; for the processor see the crate's head.
                unsafe { _mm_loadu_ps(values.as_ptr().byte_add(places[i] as usize).cast()) }
            },
        );
        parts(half)
    }
    #[inline(always)]
    fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [F; 4] {
        parts(
            #[inline(always)]
            |i| awaited.four(i),
        )
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let mut places = [0; 8];
        inside::<Avx2>(index, values.len()).store(&mut places);
        let mut put = inlined(
            #[inline(always)]
            |i: usize, n: usize, half: __m128| {
                // SAFETY: every index lies inside the slice, and n below N; for the processor see the crate's head.
                unsafe {
                    let value: *mut [f32; 4] = values.as_mut_ptr().add(places[i] as usize).cast();
                    _mm_storeu_ps(value.add(n).cast(), half);
                }
            },
        );
        for (n, [a, b, c, d]) in fours.into_iter().enumerate() {
            for (i, side) in turned([a.0, b.0, c.0, d.0]).into_iter().enumerate() {
                put(i, n, on_processor!(_mm256_castps256_ps128(side)));
                put(i + 4, n, on_processor!(_mm256_extractf128_ps::<1>(side)));
            }
        }
    }
}

/// Four floats of each lane, part by part.
#[inline(always)]
fn parts(half: impl Fn(usize) -> __m128) -> [F; 4] {
    // Places 0 and 4 side by side, and so on: then each half is turned on its own.
    let side = inlined(
        #[inline(always)]
        |i: usize| on_processor!(_mm256_set_m128(half(i + 4), half(i))),
    );
    turned([side(0), side(1), side(2), side(3)]).map(F)
}

/// Rows and columns exchanged within each half.
#[inline(always)]
fn turned([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    on_processor!({
        let (ab_low, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        let pair = [ab_low, cd_low, ab_high, cd_high].map(
            #[inline(always)]
            |x| _mm256_castps_pd(x),
        );
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(pair[0], pair[1])),
            _mm256_castpd_ps(_mm256_unpackhi_pd(pair[0], pair[1])),
            _mm256_castpd_ps(_mm256_unpacklo_pd(pair[2], pair[3])),
            _mm256_castpd_ps(_mm256_unpackhi_pd(pair[2], pair[3])),
        ]
    })
}

impl Unsigned for U {
    type Lanes = Avx2;

    #[inline(always)]
    fn splat(value: u32) -> U {
        U(on_processor!(_mm256_set1_epi32(value as i32)))
    }
    #[inline(always)]
    fn iota() -> U {
        U(on_processor!(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)))
    }
    #[inline(always)]
    fn load(values: &[u32]) -> U {
        let values: &[u32; 8] = values[..8].try_into().expect("eight values");
        U(on_array!(_mm256_loadu_si256(values.as_ptr().cast())))
    }
    #[inline(always)]
    fn load_u16(values: &[u16]) -> U {
        let values: &[u16; 8] = values[..8].try_into().expect("eight values");
        U(on_array!(_mm256_cvtepu16_epi32(_mm_loadu_si128(values.as_ptr().cast()))))
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        let values: &mut [u32; 8] = (&mut values[..8]).try_into().expect("eight values");
        on_array!(_mm256_storeu_si256(values.as_mut_ptr().cast(), self.0))
    }
    #[inline(always)]
    fn and(self, other: U) -> U {
        U(on_processor!(_mm256_and_si256(self.0, other.0)))
    }
    #[inline(always)]
    fn or(self, other: U) -> U {
        U(on_processor!(_mm256_or_si256(self.0, other.0)))
    }
    #[inline(always)]
    fn shl<const N: u32>(self) -> U {
        U(on_processor!(_mm256_sll_epi32(self.0, _mm_cvtsi32_si128(N as i32))))
    }
    #[inline(always)]
    fn shr<const N: u32>(self) -> U {
        U(on_processor!(_mm256_srl_epi32(self.0, _mm_cvtsi32_si128(N as i32))))
    }
    #[inline(always)]
    fn min(self, other: U) -> U {
        U(on_processor!(_mm256_min_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: U) -> U {
        U(on_processor!(_mm256_max_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn test(self, bits: U) -> M {
        let none =
            on_processor!(_mm256_cmpeq_epi32(_mm256_and_si256(self.0, bits.0), _mm256_setzero_si256()));
        M(on_processor!(_mm256_castsi256_ps(none))).not()
    }
    #[inline(always)]
    fn equal(self, other: U) -> M {
        M(on_processor!(_mm256_castsi256_ps(_mm256_cmpeq_epi32(self.0, other.0))))
    }
    #[inline(always)]
    fn select(mask: M, yes: U, no: U) -> U {
        U(on_processor!(_mm256_castps_si256(_mm256_blendv_ps(
            _mm256_castsi256_ps(no.0),
            _mm256_castsi256_ps(yes.0),
            mask.0,
        ))))
    }
    #[inline(always)]
    fn to_float(self) -> F {
        F(on_processor!(_mm256_cvtepi32_ps(self.0)))
    }
    #[inline(always)]
    fn permute(self, index: U) -> U {
        U(on_processor!(_mm256_permutevar8x32_epi32(self.0, index.0)))
    }
}

impl Mask for M {
    #[inline(always)]
    fn and(self, other: M) -> M {
        M(on_processor!(_mm256_and_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn or(self, other: M) -> M {
        M(on_processor!(_mm256_or_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn not(self) -> M {
        M(on_processor!(_mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm256_movemask_ps(self.0))) as u32
    }
}

operator!(D, Add, add, _mm256_add_pd);
operator!(D, Sub, sub, _mm256_sub_pd);
operator!(D, Mul, mul, _mm256_mul_pd);
operator!(D, Div, div, _mm256_div_pd);

impl Neg for D {
    type Output = D;
    #[inline(always)]
    fn neg(self) -> D {
        D(on_processor!(_mm256_xor_pd(self.0, _mm256_set1_pd(-0.0))))
    }
}

impl Double for D {
    const COUNT: usize = 4;
    type Mask = MD;

    #[inline(always)]
    fn splat(value: f64) -> D {
        D(on_processor!(_mm256_set1_pd(value)))
    }
    #[inline(always)]
    fn load(values: &[f64]) -> D {
        let values: &[f64; 4] = values[..4].try_into().expect("four values");
        D(on_array!(_mm256_loadu_pd(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        let values: &mut [f64; 4] = (&mut values[..4]).try_into().expect("four values");
        on_array!(_mm256_storeu_pd(values.as_mut_ptr(), self.0))
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        let values: &mut [f32; 4] = (&mut values[..4]).try_into().expect("four values");
        on_array!(_mm_storeu_ps(values.as_mut_ptr(), _mm256_cvtpd_ps(self.0)))
    }
    #[inline(always)]
    fn mul_add(self, b: D, c: D) -> D {
        D(on_processor!(_mm256_fmadd_pd(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn min(self, other: D) -> D {
        D(on_processor!(_mm256_min_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: D) -> D {
        D(on_processor!(_mm256_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> D {
        D(on_processor!(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> D {
        D(on_processor!(_mm256_round_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn lt(self, other: D) -> MD {
        MD(on_processor!(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: D) -> MD {
        MD(on_processor!(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: MD, yes: D, no: D) -> D {
        D(on_processor!(_mm256_blendv_pd(no.0, yes.0, mask.0)))
    }
}

impl Mask for MD {
    #[inline(always)]
    fn and(self, other: MD) -> MD {
        MD(on_processor!(_mm256_and_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn or(self, other: MD) -> MD {
        MD(on_processor!(_mm256_or_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn not(self) -> MD {
        MD(on_processor!(_mm256_xor_pd(self.0, _mm256_castsi256_pd(_mm256_set1_epi32(-1)))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm256_movemask_pd(self.0))) as u32
    }
}
