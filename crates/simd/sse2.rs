//! Four lanes: SSE2, which every x86-64 processor has. Its instructions read alike in every function, so that what other
//! sets do in one instruction and SSE2 lacks (blends, unsigned minima, rounding) is written here in a few.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, first, first_mut, inside, parts_inside, sealed,
};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

const WIDTH: usize = 4;

lane_set!(Sse2: WIDTH, F(__m128), U(__m128i), M(__m128), D(__m128d), MD(__m128d));

operator!(F, Add, add, _mm_add_ps);
operator!(F, Sub, sub, _mm_sub_ps);
operator!(F, Mul, mul, _mm_mul_ps);
operator!(F, Div, div, _mm_div_ps);
operator!(U, Add, add, _mm_add_epi32);
operator!(U, Sub, sub, _mm_sub_epi32);
operator!(D, Add, add, _mm_add_pd);
operator!(D, Sub, sub, _mm_sub_pd);
operator!(D, Mul, mul, _mm_mul_pd);
operator!(D, Div, div, _mm_div_pd);

impl Mul for U {
    type Output = U;
    #[inline(always)]
    fn mul(self, other: U) -> U {
        // Lanes 0 and 2, and lanes 1 and 3, each to 64 bits.
        U(on_processor!({
            let even = _mm_mul_epu32(self.0, other.0);
            let odd = _mm_mul_epu32(_mm_srli_epi64::<32>(self.0), _mm_srli_epi64::<32>(other.0));
            _mm_unpacklo_epi32(_mm_shuffle_epi32::<0b10_00>(even), _mm_shuffle_epi32::<0b10_00>(odd))
        }))
    }
}
operator!(F, Neg, _mm_xor_ps, _mm_set1_ps(-0.0));
operator!(D, Neg, _mm_xor_pd, _mm_set1_pd(-0.0));

/// Bits of `yes` where those of the mask are set, else of `no`.
#[inline(always)]
fn blend(mask: __m128i, yes: __m128i, no: __m128i) -> __m128i {
    on_processor!(_mm_or_si128(_mm_and_si128(mask, yes), _mm_andnot_si128(mask, no)))
}

/// Lanes in which a is above b, without signs.
#[inline(always)]
fn above(a: U, b: U) -> __m128i {
    on_processor!({
        let sign = _mm_set1_epi32(i32::MIN);
        _mm_cmpgt_epi32(_mm_xor_si128(a.0, sign), _mm_xor_si128(b.0, sign))
    })
}

/// Rows and columns exchanged.
#[inline(always)]
fn transposed([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    on_processor!({
        let (ab_low, ab_high) = (_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm_unpacklo_ps(c, d), _mm_unpackhi_ps(c, d));
        [
            _mm_movelh_ps(ab_low, cd_low),
            _mm_movehl_ps(cd_low, ab_low),
            _mm_movelh_ps(ab_high, cd_high),
            _mm_movehl_ps(cd_high, ab_high),
        ]
    })
}

/// Four floats of each lane, part by part.
#[inline(always)]
fn parts(four: impl Fn(usize) -> __m128) -> [F; 4] {
    let [a, b, c, d] = transposed([four(0), four(1), four(2), four(3)]);
    [F(a), F(b), F(c), F(d)]
}

impl Float for F {
    type Lanes = Sse2;
    const FUSED: bool = cfg!(target_feature = "fma");

    #[inline(always)]
    fn mul_add(self, b: F, c: F) -> F {
        // Two roundings where the build has no instruction for it: a fused operation would be a slow library call.
        #[cfg(target_feature = "fma")]
        return F(on_processor!(_mm_fmadd_ps(self.0, b.0, c.0)));
        #[cfg(not(target_feature = "fma"))]
        return self * b + c;
    }
    #[inline(always)]
    fn round(self) -> F {
        // By way of integers, which know no −0; what is no integer of 32 bits has no fraction.
        let nearest = U(on_processor!(_mm_cvtps_epi32(self.0)));
        let beyond = nearest.equal(U::splat(1 << 31));
        let nearest = F::select(beyond, self, nearest.to_float());
        F(on_processor!(_mm_or_ps(nearest.0, _mm_and_ps(self.0, _mm_set1_ps(-0.0)))))
    }
    #[inline(always)]
    fn floor(self) -> F {
        let nearest = self.round();
        F(on_processor!(_mm_sub_ps(nearest.0, _mm_and_ps(self.lt(nearest).0, _mm_set1_ps(1.0)))))
    }
    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        let mut places = [0; WIDTH];
        inside::<Sse2>(index, values.len()).store(&mut places);
        let value = inlined!(|i: usize| {
            // SAFETY: every index lies inside the slice.
            unsafe { *values.get_unchecked(places[i] as usize) }
        });
        F(on_processor!(_mm_setr_ps(value(0), value(1), value(2), value(3))))
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        let mut places = [0; WIDTH];
        parts_inside::<Sse2>(index, values).store(&mut places);
        parts(inlined!(|i| {
            // SAFETY: every index lies inside the slice.
            unsafe { _mm_loadu_ps(values.get_unchecked(places[i] as usize).as_ptr()) }
        }))
    }
    #[inline(always)]
    fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [F; 4] {
        parts(inlined!(|i| awaited.four(i)))
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let mut places = [0; WIDTH];
        inside::<Sse2>(index, values.len()).store(&mut places);
        for (n, [a, b, c, d]) in fours.into_iter().enumerate() {
            for (place, four) in places.into_iter().zip(transposed([a.0, b.0, c.0, d.0])) {
                // SAFETY: every index lies inside the slice, and n below N.
                unsafe {
                    let value: *mut [f32; 4] = values.as_mut_ptr().add(place as usize).cast();
                    _mm_storeu_ps(value.add(n).cast(), four);
                }
            }
        }
    }

    operations! {
        fn splat(value: f32) -> F = _mm_set1_ps(value);
        fn load(values: &[f32]) -> F = _mm_loadu_ps(first::<_, 4>(values).as_ptr());
        fn store(self, values: &mut [f32]) = _mm_storeu_ps(first_mut::<_, 4>(values).as_mut_ptr(), self.0);
        fn min(self, other: F) -> F = _mm_min_ps(self.0, other.0);
        fn max(self, other: F) -> F = _mm_max_ps(self.0, other.0);
        fn abs(self) -> F = _mm_andnot_ps(_mm_set1_ps(-0.0), self.0);
        fn sqrt(self) -> F = _mm_sqrt_ps(self.0);
        fn lt(self, other: F) -> M = _mm_cmplt_ps(self.0, other.0);
        fn le(self, other: F) -> M = _mm_cmple_ps(self.0, other.0);
        fn select(mask: M, yes: F, no: F) -> F =
            _mm_or_ps(_mm_and_ps(mask.0, yes.0), _mm_andnot_ps(mask.0, no.0));
        fn to_bits(self) -> U = _mm_castps_si128(self.0);
        fn from_bits(bits: U) -> F = _mm_castsi128_ps(bits.0);
        fn to_unsigned(self) -> U = _mm_cvttps_epi32(self.0);
    }
}

impl Unsigned for U {
    type Lanes = Sse2;

    #[inline(always)]
    fn min(self, other: U) -> U {
        U(blend(above(other, self), self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: U) -> U {
        U(blend(above(other, self), other.0, self.0))
    }
    #[inline(always)]
    fn test(self, bits: U) -> M {
        self.and(bits).equal(U::splat(0)).not()
    }
    #[inline(always)]
    fn select(mask: M, yes: U, no: U) -> U {
        U(blend(on_processor!(_mm_castps_si128(mask.0)), yes.0, no.0))
    }
    #[inline(always)]
    fn permute(self, index: U) -> U {
        let (mut lanes, mut places) = ([0; WIDTH], [0; WIDTH]);
        self.store(&mut lanes);
        index.store(&mut places);
        let lane = inlined!(|i: usize| lanes[places[i] as usize % WIDTH] as i32);
        U(on_processor!(_mm_setr_epi32(lane(0), lane(1), lane(2), lane(3))))
    }

    operations! {
        fn splat(value: u32) -> U = _mm_set1_epi32(value as i32);
        fn iota() -> U = _mm_setr_epi32(0, 1, 2, 3);
        fn load(values: &[u32]) -> U = _mm_loadu_si128(first::<_, 4>(values).as_ptr().cast());
        fn load_u16(values: &[u16]) -> U =
            _mm_unpacklo_epi16(_mm_loadl_epi64(first::<_, 4>(values).as_ptr().cast()), _mm_setzero_si128());
        fn store(self, values: &mut [u32]) =
            _mm_storeu_si128(first_mut::<_, 4>(values).as_mut_ptr().cast(), self.0);
        fn shl<const N: u32>(self) -> U = _mm_sll_epi32(self.0, _mm_cvtsi32_si128(N as i32));
        fn shr<const N: u32>(self) -> U = _mm_srl_epi32(self.0, _mm_cvtsi32_si128(N as i32));
        fn and(self, other: U) -> U = _mm_and_si128(self.0, other.0);
        fn or(self, other: U) -> U = _mm_or_si128(self.0, other.0);
        fn equal(self, other: U) -> M = _mm_castsi128_ps(_mm_cmpeq_epi32(self.0, other.0));
        fn to_float(self) -> F = _mm_cvtepi32_ps(self.0);
    }
}

impl Mask for M {
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm_movemask_ps(self.0))) as u32
    }

    operations! {
        fn and(self, other: M) -> M = _mm_and_ps(self.0, other.0);
        fn or(self, other: M) -> M = _mm_or_ps(self.0, other.0);
        fn not(self) -> M = _mm_xor_ps(self.0, _mm_castsi128_ps(_mm_set1_epi32(-1)));
    }
}

impl Double for D {
    const COUNT: usize = 2;
    type Mask = MD;

    #[inline(always)]
    fn mul_add(self, b: D, c: D) -> D {
        #[cfg(target_feature = "fma")]
        return D(on_processor!(_mm_fmadd_pd(self.0, b.0, c.0)));
        #[cfg(not(target_feature = "fma"))]
        return self * b + c;
    }
    #[inline(always)]
    fn ceil(self) -> D {
        // From 2⁵² on no number has a fraction, and a sum with 2⁵² rounds it away.
        let whole = D::splat((1u64 << 52) as f64);
        let sign = on_processor!(_mm_and_pd(self.0, _mm_set1_pd(-0.0)));
        let nearest = D(on_processor!(_mm_or_pd((self.abs() + whole - whole).0, sign)));
        let nearest = D::select(self.abs().lt(whole), nearest, self);
        let up = nearest + D(on_processor!(_mm_and_pd(nearest.lt(self).0, _mm_set1_pd(1.0))));
        // −0 stays, and −0.5 becomes it.
        D(on_processor!(_mm_or_pd(up.0, sign)))
    }

    operations! {
        fn splat(value: f64) -> D = _mm_set1_pd(value);
        fn load(values: &[f64]) -> D = _mm_loadu_pd(first::<_, 2>(values).as_ptr());
        fn store(self, values: &mut [f64]) = _mm_storeu_pd(first_mut::<_, 2>(values).as_mut_ptr(), self.0);
        fn store_f32(self, values: &mut [f32]) =
            _mm_storel_epi64(
                first_mut::<_, 2>(values).as_mut_ptr().cast(),
                _mm_castps_si128(_mm_cvtpd_ps(self.0))
            );
        fn min(self, other: D) -> D = _mm_min_pd(self.0, other.0);
        fn max(self, other: D) -> D = _mm_max_pd(self.0, other.0);
        fn abs(self) -> D = _mm_andnot_pd(_mm_set1_pd(-0.0), self.0);
        fn lt(self, other: D) -> MD = _mm_cmplt_pd(self.0, other.0);
        fn le(self, other: D) -> MD = _mm_cmple_pd(self.0, other.0);
        fn select(mask: MD, yes: D, no: D) -> D =
            _mm_or_pd(_mm_and_pd(mask.0, yes.0), _mm_andnot_pd(mask.0, no.0));
    }
}

impl Mask for MD {
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm_movemask_pd(self.0))) as u32
    }

    operations! {
        fn and(self, other: MD) -> MD = _mm_and_pd(self.0, other.0);
        fn or(self, other: MD) -> MD = _mm_or_pd(self.0, other.0);
        fn not(self) -> MD = _mm_xor_pd(self.0, _mm_castsi128_pd(_mm_set1_epi32(-1)));
    }
}
