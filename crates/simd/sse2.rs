//! Four lanes: SSE2, which every x86-64 processor has. Its instructions read alike in every function, so that what other
//! sets do in one instruction and SSE2 lacks (blends, unsigned minima, rounding) is written here in a few.

use super::operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, inlined, inside, parts_inside, sealed,
};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

const WIDTH: usize = 4;

/// Four SSE2 lanes.
#[derive(Clone, Copy)]
pub(super) struct Sse2;

/// Four floats.
#[derive(Clone, Copy)]
pub(super) struct F(__m128);

/// Four unsigned integers.
#[derive(Clone, Copy)]
pub(super) struct U(__m128i);

/// Four booleans: all bits of a lane, or none.
#[derive(Clone, Copy)]
pub(super) struct M(__m128);

/// Two 64-bit floats.
#[derive(Clone, Copy)]
pub(super) struct D(__m128d);

/// Two booleans: all bits of a lane, or none.
#[derive(Clone, Copy)]
pub(super) struct MD(__m128d);

impl sealed::Sealed for Sse2 {}

impl Lanes for Sse2 {
    const WIDTH: usize = WIDTH;
    type F = F;
    type U = U;
    type M = M;
    type D = D;
}

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

impl Neg for F {
    type Output = F;
    #[inline(always)]
    fn neg(self) -> F {
        F(on_processor!(_mm_xor_ps(self.0, _mm_set1_ps(-0.0))))
    }
}

impl Neg for D {
    type Output = D;
    #[inline(always)]
    fn neg(self) -> D {
        D(on_processor!(_mm_xor_pd(self.0, _mm_set1_pd(-0.0))))
    }
}

/// An array at the start of a slice.
#[inline(always)]
fn first<T, const N: usize>(values: &[T]) -> &[T; N] {
    values[..N].try_into().expect("as many values")
}

/// An array at the start of a slice, to be written.
#[inline(always)]
fn first_mut<T, const N: usize>(values: &mut [T]) -> &mut [T; N] {
    (&mut values[..N]).try_into().expect("as many values")
}

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

    #[inline(always)]
    fn splat(value: f32) -> F {
        F(on_processor!(_mm_set1_ps(value)))
    }
    #[inline(always)]
    fn load(values: &[f32]) -> F {
        let values: &[f32; 4] = first(values);
        F(on_array!(_mm_loadu_ps(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        let values: &mut [f32; 4] = first_mut(values);
        on_array!(_mm_storeu_ps(values.as_mut_ptr(), self.0))
    }
    #[inline(always)]
    fn mul_add(self, b: F, c: F) -> F {
        // Two roundings where the build has no instruction for it: a fused operation would be a slow library call.
        #[cfg(target_feature = "fma")]
        return F(on_processor!(_mm_fmadd_ps(self.0, b.0, c.0)));
        #[cfg(not(target_feature = "fma"))]
        return self * b + c;
    }
    #[inline(always)]
    fn min(self, other: F) -> F {
        F(on_processor!(_mm_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: F) -> F {
        F(on_processor!(_mm_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> F {
        F(on_processor!(_mm_andnot_ps(_mm_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> F {
        F(on_processor!(_mm_sqrt_ps(self.0)))
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
    fn lt(self, other: F) -> M {
        M(on_processor!(_mm_cmplt_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: F) -> M {
        M(on_processor!(_mm_cmple_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: M, yes: F, no: F) -> F {
        F(on_processor!(_mm_or_ps(_mm_and_ps(mask.0, yes.0), _mm_andnot_ps(mask.0, no.0))))
    }
    #[inline(always)]
    fn to_bits(self) -> U {
        U(on_processor!(_mm_castps_si128(self.0)))
    }
    #[inline(always)]
    fn from_bits(bits: U) -> F {
        F(on_processor!(_mm_castsi128_ps(bits.0)))
    }
    #[inline(always)]
    fn to_unsigned(self) -> U {
        U(on_processor!(_mm_cvttps_epi32(self.0)))
    }
    #[inline(always)]
    fn permute(self, index: U) -> F {
        F::from_bits(self.to_bits().permute(index))
    }
    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        let mut places = [0; WIDTH];
        inside::<Sse2>(index, values.len()).store(&mut places);
        let value = inlined(
            #[inline(always)]
            |i: usize| {
                // SAFETY: every index lies inside the slice.
                unsafe { *values.get_unchecked(places[i] as usize) }
            },
        );
        F(on_processor!(_mm_setr_ps(value(0), value(1), value(2), value(3))))
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        let mut places = [0; WIDTH];
        parts_inside::<Sse2>(index, values).store(&mut places);
        parts(
            #[inline(always)]
            |i| {
                // SAFETY: every index lies inside the slice.
                unsafe { _mm_loadu_ps(values.get_unchecked(places[i] as usize).as_ptr()) }
            },
        )
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
}

impl Unsigned for U {
    type Lanes = Sse2;

    #[inline(always)]
    fn splat(value: u32) -> U {
        U(on_processor!(_mm_set1_epi32(value as i32)))
    }
    #[inline(always)]
    fn iota() -> U {
        U(on_processor!(_mm_setr_epi32(0, 1, 2, 3)))
    }
    #[inline(always)]
    fn load(values: &[u32]) -> U {
        let values: &[u32; 4] = first(values);
        U(on_array!(_mm_loadu_si128(values.as_ptr().cast())))
    }
    #[inline(always)]
    fn load_u16(values: &[u16]) -> U {
        let values: &[u16; 4] = first(values);
        U(on_array!(_mm_unpacklo_epi16(_mm_loadl_epi64(values.as_ptr().cast()), _mm_setzero_si128())))
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        let values: &mut [u32; 4] = first_mut(values);
        on_array!(_mm_storeu_si128(values.as_mut_ptr().cast(), self.0))
    }
    #[inline(always)]
    fn and(self, other: U) -> U {
        U(on_processor!(_mm_and_si128(self.0, other.0)))
    }
    #[inline(always)]
    fn or(self, other: U) -> U {
        U(on_processor!(_mm_or_si128(self.0, other.0)))
    }
    #[inline(always)]
    fn shl<const N: u32>(self) -> U {
        U(on_processor!(_mm_sll_epi32(self.0, _mm_cvtsi32_si128(N as i32))))
    }
    #[inline(always)]
    fn shr<const N: u32>(self) -> U {
        U(on_processor!(_mm_srl_epi32(self.0, _mm_cvtsi32_si128(N as i32))))
    }
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
    fn equal(self, other: U) -> M {
        M(on_processor!(_mm_castsi128_ps(_mm_cmpeq_epi32(self.0, other.0))))
    }
    #[inline(always)]
    fn select(mask: M, yes: U, no: U) -> U {
        U(blend(on_processor!(_mm_castps_si128(mask.0)), yes.0, no.0))
    }
    #[inline(always)]
    fn to_float(self) -> F {
        F(on_processor!(_mm_cvtepi32_ps(self.0)))
    }
    #[inline(always)]
    fn permute(self, index: U) -> U {
        let (mut lanes, mut places) = ([0; WIDTH], [0; WIDTH]);
        self.store(&mut lanes);
        index.store(&mut places);
        let lane = inlined(
            #[inline(always)]
            |i: usize| lanes[places[i] as usize % WIDTH] as i32,
        );
        U(on_processor!(_mm_setr_epi32(lane(0), lane(1), lane(2), lane(3))))
    }
}

impl Mask for M {
    #[inline(always)]
    fn and(self, other: M) -> M {
        M(on_processor!(_mm_and_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn or(self, other: M) -> M {
        M(on_processor!(_mm_or_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn not(self) -> M {
        M(on_processor!(_mm_xor_ps(self.0, _mm_castsi128_ps(_mm_set1_epi32(-1)))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm_movemask_ps(self.0))) as u32
    }
}

impl Double for D {
    const COUNT: usize = 2;
    type Mask = MD;

    #[inline(always)]
    fn splat(value: f64) -> D {
        D(on_processor!(_mm_set1_pd(value)))
    }
    #[inline(always)]
    fn load(values: &[f64]) -> D {
        let values: &[f64; 2] = first(values);
        D(on_array!(_mm_loadu_pd(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        let values: &mut [f64; 2] = first_mut(values);
        on_array!(_mm_storeu_pd(values.as_mut_ptr(), self.0))
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        let values: &mut [f32; 2] = first_mut(values);
        on_array!(_mm_storel_epi64(values.as_mut_ptr().cast(), _mm_castps_si128(_mm_cvtpd_ps(self.0))))
    }
    #[inline(always)]
    fn mul_add(self, b: D, c: D) -> D {
        #[cfg(target_feature = "fma")]
        return D(on_processor!(_mm_fmadd_pd(self.0, b.0, c.0)));
        #[cfg(not(target_feature = "fma"))]
        return self * b + c;
    }
    #[inline(always)]
    fn min(self, other: D) -> D {
        D(on_processor!(_mm_min_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: D) -> D {
        D(on_processor!(_mm_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> D {
        D(on_processor!(_mm_andnot_pd(_mm_set1_pd(-0.0), self.0)))
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
    #[inline(always)]
    fn lt(self, other: D) -> MD {
        MD(on_processor!(_mm_cmplt_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: D) -> MD {
        MD(on_processor!(_mm_cmple_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: MD, yes: D, no: D) -> D {
        D(on_processor!(_mm_or_pd(_mm_and_pd(mask.0, yes.0), _mm_andnot_pd(mask.0, no.0))))
    }
}

impl Mask for MD {
    #[inline(always)]
    fn and(self, other: MD) -> MD {
        MD(on_processor!(_mm_and_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn or(self, other: MD) -> MD {
        MD(on_processor!(_mm_or_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn not(self) -> MD {
        MD(on_processor!(_mm_xor_pd(self.0, _mm_castsi128_pd(_mm_set1_epi32(-1)))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        (on_processor!(_mm_movemask_pd(self.0))) as u32
    }
}
