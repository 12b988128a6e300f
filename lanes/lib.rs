//! voltet-lanes: vector lanes, and what is written in them: the 32-bit formulas ([`optics`]) and a sorting network ([`sort`]).
//!
//! Vector lanes are the few operations the kernels are written in, over 16 (AVX-512), 8 (AVX2 + FMA) or 4 portable
//! lanes.
//!
//! A kernel is one generic function over [`Lanes`], marked `#[inline(always)]`; [`dispatch`] runs it inside a
//! function that carries the processor features, chosen once at run time. The three implementations agree lane
//! by lane (`tests` compares them), except that the portable one rounds a fused multiply-add twice.
//!
//! # Why code cannot run instructions that the processor lacks
//!
//! The methods of the AVX lanes are safe to call and would be undefined on a processor without the features. So their types
//! are private: outside this crate they have no name, there is no function that gives one, and no type that they could be
//! reached from. Code meets them only as the type parameter of [`Kernel::run`], which only [`dispatch`] fills in, after
//! the processor said that it has the features; and what a processor has, it keeps. [`Lanes`] is sealed, so that unsafe code
//! may rely on what its traits say.
//!
//! Under `cargo miri` the processor is taken to have what the build asks for, so that the portable lanes are interpreted.

/// Instructions upon values.
#[cfg(target_arch = "x86_64")]
macro_rules! on_processor {
    ($instructions:expr) => {{
        // SAFETY: they ask for nothing but a processor that has them, and code over these lanes runs beneath `dispatch`
        // alone, which made sure of it (see the crate's head).
        unsafe { $instructions }
    }};
}

/// Instructions that read or write a whole array through a reference to it.
#[cfg(target_arch = "x86_64")]
macro_rules! on_array {
    ($instructions:expr) => {{
        // SAFETY: the pointer is that of an array as long as the vector, and they ask for no alignment; for the processor
        // as above.
        unsafe { $instructions }
    }};
}

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(test)]
mod conformance;
pub mod limits;
pub mod optics;
mod portable;
pub mod sort;

#[cfg(target_arch = "x86_64")]
use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use avx512::Avx512;
use portable::Portable;
use std::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    /// What only this crate's lanes are.
    pub trait Sealed {}
}

/// A set of vector lanes.
pub trait Lanes: sealed::Sealed + Copy + Send + Sync + 'static {
    /// Number of lanes.
    const WIDTH: usize;
    /// 32-bit floats.
    type F: Float<Lanes = Self>;
    /// 32-bit unsigned integers.
    type U: Unsigned<Lanes = Self>;
    /// Booleans.
    type M: Mask;
    /// 64-bit floats, half as many.
    type D: Double;
}

/// Lanes of 64-bit floats, [`Double::COUNT`] = `WIDTH / 2` of them.
pub trait Double:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Number of lanes.
    const COUNT: usize;
    /// Booleans.
    type Mask: Mask;

    /// The same value in every lane.
    fn splat(value: f64) -> Self;
    /// The first `COUNT` values of the slice, which must hold as many.
    fn load(values: &[f64]) -> Self;
    /// Writes the lanes to the first `COUNT` places of the slice, which must hold as many.
    fn store(self, values: &mut [f64]);
    /// Writes the lanes, rounded to 32 bits, to the first `COUNT` places of the slice.
    fn store_f32(self, values: &mut [f32]);
    /// self × b + c, fused where the processor can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The smaller lane; the second operand where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger lane; the second operand where either is NaN.
    fn max(self, other: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Smallest integer not below.
    fn ceil(self) -> Self;
    /// self < other (false for NaN).
    fn lt(self, other: Self) -> Self::Mask;
    /// self ≤ other (false for NaN).
    fn le(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
}

/// Lanes of 32-bit floats.
pub trait Float:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The lane set.
    type Lanes: Lanes<F = Self>;

    /// The same value in every lane.
    fn splat(value: f32) -> Self;
    /// The first `WIDTH` values of the slice, which must hold as many.
    fn load(values: &[f32]) -> Self;
    /// Writes the lanes to the first `WIDTH` places of the slice, which must hold as many.
    fn store(self, values: &mut [f32]);
    /// self × b + c, fused where the processor can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The smaller lane; the second operand where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger lane; the second operand where either is NaN.
    fn max(self, other: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Nearest integer, ties to even.
    fn round(self) -> Self;
    /// Nearest integer towards −∞.
    fn floor(self) -> Self;
    /// self < other (false for NaN).
    fn lt(self, other: Self) -> <Self::Lanes as Lanes>::M;
    /// self ≤ other (false for NaN).
    fn le(self, other: Self) -> <Self::Lanes as Lanes>::M;
    /// `yes` where the mask is set, else `no`.
    fn select(mask: <Self::Lanes as Lanes>::M, yes: Self, no: Self) -> Self;
    /// The bits of the floats.
    fn to_bits(self) -> <Self::Lanes as Lanes>::U;
    /// Floats from their bits.
    fn from_bits(bits: <Self::Lanes as Lanes>::U) -> Self;
    /// Truncated to an integer; values must lie in 0 … 2³¹ − 1.
    fn to_unsigned(self) -> <Self::Lanes as Lanes>::U;
    /// Lane i is `self[index[i]]`; indices must be below `WIDTH`.
    fn permute(self, index: <Self::Lanes as Lanes>::U) -> Self;
    /// Lane i is `values[index[i]]`. An index past the end would be the caller's mistake: it takes the last value, and
    /// stops a build with debug assertions. The slice must hold something, and at most 2³¹ values.
    fn gather(values: &[f32], index: <Self::Lanes as Lanes>::U) -> Self;
}

/// Lanes of 32-bit unsigned integers (wrapping).
pub trait Unsigned: Copy + Add<Output = Self> + Sub<Output = Self> {
    /// The lane set.
    type Lanes: Lanes<U = Self>;

    /// The same value in every lane.
    fn splat(value: u32) -> Self;
    /// 0, 1, 2, …
    fn iota() -> Self;
    /// The first `WIDTH` values of the slice, which must hold as many.
    fn load(values: &[u32]) -> Self;
    /// The first `WIDTH` values of the slice, widened.
    fn load_u16(values: &[u16]) -> Self;
    /// Writes the lanes to the first `WIDTH` places of the slice, which must hold as many.
    fn store(self, values: &mut [u32]);
    /// Bitwise and.
    fn and(self, other: Self) -> Self;
    /// Bitwise or.
    fn or(self, other: Self) -> Self;
    /// Shifted left by a constant.
    fn shl<const N: u32>(self) -> Self;
    /// Shifted right by a constant, zeros in.
    fn shr<const N: u32>(self) -> Self;
    /// The smaller lane.
    fn min(self, other: Self) -> Self;
    /// The larger lane.
    fn max(self, other: Self) -> Self;
    /// Whether any bit of `bits` is set.
    fn test(self, bits: Self) -> <Self::Lanes as Lanes>::M;
    /// self == other.
    fn equal(self, other: Self) -> <Self::Lanes as Lanes>::M;
    /// `yes` where the mask is set, else `no`.
    fn select(mask: <Self::Lanes as Lanes>::M, yes: Self, no: Self) -> Self;
    /// As floats; values above 2³¹ − 1 are not supported.
    fn to_float(self) -> <Self::Lanes as Lanes>::F;
    /// Lane i is `self[index[i]]`; indices must be below `WIDTH`.
    fn permute(self, index: Self) -> Self;
}

/// Lanes of booleans.
pub trait Mask: Copy {
    /// Both.
    fn and(self, other: Self) -> Self;
    /// Either.
    fn or(self, other: Self) -> Self;
    /// The opposite.
    fn not(self) -> Self;
    /// One bit a lane, lane 0 the lowest.
    fn bits(self) -> u32;
    /// True if any lane is set.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// Indices into a slice of so many values, none past the end: what a gather may follow.
#[inline(always)]
fn inside<L: Lanes>(index: L::U, length: usize) -> L::U {
    assert!(0 < length && length <= 1 << 31, "a gather from {length} values");
    let last = L::U::splat((length - 1) as u32);
    let inside = index.min(last);
    debug_assert!(!inside.equal(index).not().any(), "a gather past {length} values");
    inside
}

/// Takes a closure marked `#[inline(always)]` (the attribute is allowed on an argument, not on the value of a
/// `let`).
#[inline(always)]
pub fn inlined<F>(closure: F) -> F {
    closure
}

/// An array made element by element.
///
/// Kernels use this, not `std::array::from_fn` or `map`, and mark every closure `#[inline(always)]`: a closure
/// has no processor features of its own, so one that is left as a function calls every vector operation.
#[inline(always)]
pub fn array<T: Copy, const N: usize>(mut element: impl FnMut(usize) -> T) -> [T; N] {
    let mut out = [element(0); N];
    for (i, out) in out.iter_mut().enumerate().skip(1) {
        *out = element(i);
    }
    out
}

/// Work that can run on any lane set.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// Runs on the lanes `L`. Mark the implementation `#[inline(always)]`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// A lane set by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneSet {
    /// 16 lanes: AVX-512 F, BW, DQ, VL.
    Avx512,
    /// 8 lanes: AVX2 and FMA (and the bit operations that came with them).
    Avx2,
    /// 4 lanes in plain Rust.
    Portable,
}

impl LaneSet {
    /// The widest set this processor has. `VOLTET_LANES` = `avx512`, `avx2` or `portable` narrows it (to compare
    /// the paths); a set that the processor lacks is never chosen.
    pub fn detect() -> LaneSet {
        static DETECTED: std::sync::OnceLock<LaneSet> = std::sync::OnceLock::new();
        *DETECTED.get_or_init(|| {
            let asked = std::env::var("VOLTET_LANES").unwrap_or_default();
            let at_most = match asked.as_str() {
                "portable" => return LaneSet::Portable,
                "avx2" => LaneSet::Avx2,
                _ => LaneSet::Avx512,
            };
            if at_most == LaneSet::Avx512 && LaneSet::Avx512.is_supported() {
                LaneSet::Avx512
            } else if LaneSet::Avx2.is_supported() {
                LaneSet::Avx2
            } else {
                LaneSet::Portable
            }
        })
    }

    /// Whether this processor has the set.
    pub fn is_supported(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            match self {
                LaneSet::Avx512 => {
                    is_x86_feature_detected!("avx512f")
                        && is_x86_feature_detected!("avx512bw")
                        && is_x86_feature_detected!("avx512dq")
                        && is_x86_feature_detected!("avx512vl")
                        && LaneSet::Avx2.is_supported()
                }
                LaneSet::Avx2 => {
                    is_x86_feature_detected!("avx2")
                        && is_x86_feature_detected!("fma")
                        && is_x86_feature_detected!("popcnt")
                        && is_x86_feature_detected!("bmi1")
                        && is_x86_feature_detected!("bmi2")
                        && is_x86_feature_detected!("lzcnt")
                }
                LaneSet::Portable => true,
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == LaneSet::Portable
        }
    }

    /// What [`dispatch`] runs when it is asked for this set: the portable one stands in for one that the processor lacks.
    fn or_portable(self) -> LaneSet {
        if self.is_supported() { self } else { LaneSet::Portable }
    }

    /// Lanes of 32-bit floats that a kernel has which is dispatched on this set.
    pub fn width(self) -> usize {
        match self.or_portable() {
            LaneSet::Avx512 => 16,
            LaneSet::Avx2 => 8,
            LaneSet::Portable => 4,
        }
    }

    /// The name as `VOLTET_LANES` takes it.
    pub fn name(self) -> &'static str {
        match self {
            LaneSet::Avx512 => "avx512",
            LaneSet::Avx2 => "avx2",
            LaneSet::Portable => "portable",
        }
    }
}

/// Runs a kernel on a lane set; one that the processor lacks is replaced by the portable set.
pub fn dispatch<K: Kernel>(lanes: LaneSet, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
        fn avx512<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<Avx512>()
        }
        #[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,lzcnt")]
        fn avx2<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<Avx2>()
        }
        match lanes.or_portable() {
            // SAFETY: the features were just found on this processor.
            LaneSet::Avx512 => return unsafe { avx512(kernel) },
            // SAFETY: the features were just found on this processor.
            LaneSet::Avx2 => return unsafe { avx2(kernel) },
            LaneSet::Portable => {}
        }
    }
    let _ = lanes;
    kernel.run::<Portable>()
}
