//! Eight lanes: NEON, two vectors of four.
//!
//! One vector at a time would meet each branch of a kernel twice as often and leave the multiply-adds waiting for one another;
//! four find no room in 32 registers, and take as many instructions a segment as two.
//!
//! Why its instructions may run: the crate's head.

use super::operations::{Double, Float, Lanes, Mask, Unsigned, inside, parts_inside, sealed};
use std::arch::aarch64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Vectors of four.
const VECTORS: usize = 2;

const WIDTH: usize = 4 * VECTORS;

lane_set!(
    Neon: WIDTH, F([float32x4_t; VECTORS]), U([uint32x4_t; VECTORS]), M([uint32x4_t; VECTORS]),
    D([float64x2_t; VECTORS]), MD([uint64x2_t; VECTORS])
);

/// Both vectors, by instructions upon values.
macro_rules! each {
    (|$i:ident| $vector:expr) => {
        [
            {
                let $i = 0;
                on_processor!($vector)
            },
            {
                let $i = 1;
                on_processor!($vector)
            },
        ]
    };
}

/// Methods whose results are instructions upon each of the two vectors.
macro_rules! operations {
    ($(fn $method:ident $(<const $n:ident: u32>)? ($($operand:tt)*) -> $type:ident = |$i:ident| $result:expr;)*) => {$(
        #[inline(always)]
        fn $method $(<const $n: u32>)? ($($operand)*) -> $type {
            $type(each!(|$i| $result))
        }
    )*};
}

/// An operator by an instruction upon two vectors.
macro_rules! operator {
    ($type:ident, Neg, $intrinsic:ident) => {
        impl Neg for $type {
            type Output = $type;
            operations! { fn neg(self) -> $type = |i| $intrinsic(self.0[i]); }
        }
    };
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = $type;
            operations! { fn $method(self, other: $type) -> $type = |i| $intrinsic(self.0[i], other.0[i]); }
        }
    };
}

operator!(F, Add, add, vaddq_f32);
operator!(F, Sub, sub, vsubq_f32);
operator!(F, Mul, mul, vmulq_f32);
operator!(F, Div, div, vdivq_f32);
operator!(U, Add, add, vaddq_u32);
operator!(U, Sub, sub, vsubq_u32);
operator!(U, Mul, mul, vmulq_u32);
operator!(D, Add, add, vaddq_f64);
operator!(D, Sub, sub, vsubq_f64);
operator!(D, Mul, mul, vmulq_f64);
operator!(D, Div, div, vdivq_f64);
operator!(F, Neg, vnegq_f32);
operator!(D, Neg, vnegq_f64);

/// The places that lanes name, as bytes of all lanes' bytes: what a lookup in them takes.
#[inline(always)]
fn bytes(lanes: uint32x4_t) -> uint8x16_t {
    on_processor!({
        let first = vreinterpretq_u8_u32(vmulq_u32(lanes, vdupq_n_u32(0x0404_0404)));
        vaddq_u8(first, vreinterpretq_u8_u32(vdupq_n_u32(0x0302_0100)))
    })
}

/// The first lanes of a slice, vector by vector.
#[inline(always)]
fn first<T, const N: usize>(values: &[T]) -> &[[T; N]; VECTORS] {
    values[..VECTORS * N].as_chunks().0.try_into().expect("as many values")
}

/// First vectors of a slice, to be written.
#[inline(always)]
fn first_mut<T, const N: usize>(values: &mut [T]) -> &mut [[T; N]; VECTORS] {
    values[..VECTORS * N].as_chunks_mut().0.try_into().expect("as many values")
}

impl Float for F {
    type Lanes = Neon;

    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        let [a, b]: &mut [[f32; 4]; VECTORS] = first_mut(values);
        on_processor!(vst1q_f32(a.as_mut_ptr(), self.0[0]));
        on_processor!(vst1q_f32(b.as_mut_ptr(), self.0[1]))
    }
    #[inline(always)]
    fn gather(values: &[f32], index: U) -> F {
        let mut places = [0; WIDTH];
        inside::<Neon>(index, values.len()).store(&mut places);
        let value = inlined!(|lane: usize| {
            // SAFETY: every index lies inside the slice.
            unsafe { *values.get_unchecked(places[lane] as usize) }
        });
        F::load(&[value(0), value(1), value(2), value(3), value(4), value(5), value(6), value(7)])
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U) -> [F; 4] {
        let mut places = [0; WIDTH];
        parts_inside::<Neon>(index, values).store(&mut places);
        let four = inlined!(|lane: usize| {
            // SAFETY: every index lies inside the slice.
            unsafe { vld1q_f32(values.get_unchecked(places[lane] as usize).as_ptr()) }
        });
        let [a, b, c, d] = turned([four(0), four(1), four(2), four(3)]);
        let [e, f, g, h] = turned([four(4), four(5), four(6), four(7)]);
        [F([a, e]), F([b, f]), F([c, g]), F([d, h])]
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[F; 4]; N], values: &mut [[[f32; 4]; N]], index: U) {
        let mut places = [0; WIDTH];
        inside::<Neon>(index, values.len()).store(&mut places);
        let mut put = inlined!(|lane: usize, n: usize, four: float32x4_t| {
            // SAFETY: every index lies inside the slice.
            unsafe { vst1q_f32(values.get_unchecked_mut(places[lane] as usize)[n].as_mut_ptr(), four) }
        });
        for (n, [a, b, c, d]) in fours.into_iter().enumerate() {
            for half in 0..2 {
                let sides = turned([a.0[half], b.0[half], c.0[half], d.0[half]]);
                for (i, side) in sides.into_iter().enumerate() {
                    put(half * 4 + i, n, side);
                }
            }
        }
    }

    operations! {
        fn splat(value: f32) -> F = |_i| vdupq_n_f32(value);
        fn load(values: &[f32]) -> F = |i| vld1q_f32(first::<_, 4>(values)[i].as_ptr());
        fn mul_add(self, b: F, c: F) -> F = |i| vfmaq_f32(c.0[i], self.0[i], b.0[i]);
        fn abs(self) -> F = |i| vabsq_f32(self.0[i]);
        fn sqrt(self) -> F = |i| vsqrtq_f32(self.0[i]);
        fn round(self) -> F = |i| vrndnq_f32(self.0[i]);
        fn floor(self) -> F = |i| vrndmq_f32(self.0[i]);
        fn lt(self, other: F) -> M = |i| vcltq_f32(self.0[i], other.0[i]);
        fn le(self, other: F) -> M = |i| vcleq_f32(self.0[i], other.0[i]);
        fn select(mask: M, yes: F, no: F) -> F = |i| vbslq_f32(mask.0[i], yes.0[i], no.0[i]);
        fn to_bits(self) -> U = |i| vreinterpretq_u32_f32(self.0[i]);
        fn from_bits(bits: U) -> F = |i| vreinterpretq_f32_u32(bits.0[i]);
        fn to_unsigned(self) -> U = |i| vcvtq_u32_f32(self.0[i]);
    }
}

/// Rows and columns exchanged.
#[inline(always)]
fn turned([a, b, c, d]: [float32x4_t; 4]) -> [float32x4_t; 4] {
    on_processor!({
        // The even and the odd places of two rows in turn, as pairs.
        let (ab_even, ab_odd) =
            (vreinterpretq_f64_f32(vtrn1q_f32(a, b)), vreinterpretq_f64_f32(vtrn2q_f32(a, b)));
        let (cd_even, cd_odd) =
            (vreinterpretq_f64_f32(vtrn1q_f32(c, d)), vreinterpretq_f64_f32(vtrn2q_f32(c, d)));
        [
            vreinterpretq_f32_f64(vtrn1q_f64(ab_even, cd_even)),
            vreinterpretq_f32_f64(vtrn1q_f64(ab_odd, cd_odd)),
            vreinterpretq_f32_f64(vtrn2q_f64(ab_even, cd_even)),
            vreinterpretq_f32_f64(vtrn2q_f64(ab_odd, cd_odd)),
        ]
    })
}

impl Unsigned for U {
    type Lanes = Neon;

    #[inline(always)]
    fn iota() -> U {
        U::load(&[0, 1, 2, 3, 4, 5, 6, 7])
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        let [a, b]: &mut [[u32; 4]; VECTORS] = first_mut(values);
        on_processor!(vst1q_u32(a.as_mut_ptr(), self.0[0]));
        on_processor!(vst1q_u32(b.as_mut_ptr(), self.0[1]))
    }
    #[inline(always)]
    fn permute(self, index: U) -> U {
        let places = [bytes(index.0[0]), bytes(index.0[1])];
        on_processor!({
            let lanes = uint8x16x2_t(vreinterpretq_u8_u32(self.0[0]), vreinterpretq_u8_u32(self.0[1]));
            U([
                vreinterpretq_u32_u8(vqtbl2q_u8(lanes, places[0])),
                vreinterpretq_u32_u8(vqtbl2q_u8(lanes, places[1])),
            ])
        })
    }

    operations! {
        fn splat(value: u32) -> U = |_i| vdupq_n_u32(value);
        fn load(values: &[u32]) -> U = |i| vld1q_u32(first::<_, 4>(values)[i].as_ptr());
        fn load_u16(values: &[u16]) -> U = |i| vmovl_u16(vld1_u16(first::<_, 4>(values)[i].as_ptr()));
        fn shl<const N: u32>(self) -> U = |i| vshlq_u32(self.0[i], vdupq_n_s32(N as i32));
        fn shr<const N: u32>(self) -> U = |i| vshlq_u32(self.0[i], vdupq_n_s32(-(N as i32)));
        fn and(self, other: U) -> U = |i| vandq_u32(self.0[i], other.0[i]);
        fn or(self, other: U) -> U = |i| vorrq_u32(self.0[i], other.0[i]);
        fn min(self, other: U) -> U = |i| vminq_u32(self.0[i], other.0[i]);
        fn max(self, other: U) -> U = |i| vmaxq_u32(self.0[i], other.0[i]);
        fn test(self, bits: U) -> M = |i| vtstq_u32(self.0[i], bits.0[i]);
        fn equal(self, other: U) -> M = |i| vceqq_u32(self.0[i], other.0[i]);
        fn select(mask: M, yes: U, no: U) -> U = |i| vbslq_u32(mask.0[i], yes.0[i], no.0[i]);
        fn to_float(self) -> F = |i| vcvtq_f32_s32(vreinterpretq_s32_u32(self.0[i]));
    }
}

impl Mask for M {
    #[inline(always)]
    fn bits(self) -> u32 {
        const BITS: [u16; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
        let bits = on_processor!(vld1q_u16(BITS.as_ptr()));
        on_processor!({
            let halves = vcombine_u16(vmovn_u32(self.0[0]), vmovn_u32(self.0[1]));
            u32::from(vaddvq_u16(vandq_u16(halves, bits)))
        })
    }
    #[inline(always)]
    fn any(self) -> bool {
        on_processor!(vmaxvq_u32(vorrq_u32(self.0[0], self.0[1])) != 0)
    }

    operations! {
        fn and(self, other: M) -> M = |i| vandq_u32(self.0[i], other.0[i]);
        fn or(self, other: M) -> M = |i| vorrq_u32(self.0[i], other.0[i]);
        fn not(self) -> M = |i| vmvnq_u32(self.0[i]);
    }
}

impl Double for D {
    const COUNT: usize = WIDTH / 2;
    type Mask = MD;

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        let [a, b]: &mut [[f64; 2]; VECTORS] = first_mut(values);
        on_processor!(vst1q_f64(a.as_mut_ptr(), self.0[0]));
        on_processor!(vst1q_f64(b.as_mut_ptr(), self.0[1]))
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        let [a, b]: &mut [[f32; 2]; VECTORS] = first_mut(values);
        on_processor!(vst1_f32(a.as_mut_ptr(), vcvt_f32_f64(self.0[0])));
        on_processor!(vst1_f32(b.as_mut_ptr(), vcvt_f32_f64(self.0[1])))
    }

    operations! {
        fn splat(value: f64) -> D = |_i| vdupq_n_f64(value);
        fn load(values: &[f64]) -> D = |i| vld1q_f64(first::<_, 2>(values)[i].as_ptr());
        fn mul_add(self, b: D, c: D) -> D = |i| vfmaq_f64(c.0[i], self.0[i], b.0[i]);
        fn abs(self) -> D = |i| vabsq_f64(self.0[i]);
        fn ceil(self) -> D = |i| vrndpq_f64(self.0[i]);
        fn lt(self, other: D) -> MD = |i| vcltq_f64(self.0[i], other.0[i]);
        fn le(self, other: D) -> MD = |i| vcleq_f64(self.0[i], other.0[i]);
        fn select(mask: MD, yes: D, no: D) -> D = |i| vbslq_f64(mask.0[i], yes.0[i], no.0[i]);
    }
}

impl Mask for MD {
    #[inline(always)]
    fn bits(self) -> u32 {
        on_processor!({
            // The upper half of a lane is as its lower.
            let lanes = vcombine_u32(vmovn_u64(self.0[0]), vmovn_u64(self.0[1]));
            let bits =
                vreinterpretq_u32_u64(vcombine_u64(vcreate_u64(1 | 2 << 32), vcreate_u64(4 | 8 << 32)));
            vaddvq_u32(vandq_u32(lanes, bits))
        })
    }

    operations! {
        fn and(self, other: MD) -> MD = |i| vandq_u64(self.0[i], other.0[i]);
        fn or(self, other: MD) -> MD = |i| vorrq_u64(self.0[i], other.0[i]);
        fn not(self) -> MD = |i| vreinterpretq_u64_u32(vmvnq_u32(vreinterpretq_u32_u64(self.0[i])));
    }
}
