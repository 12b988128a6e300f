//! voltet-simd: vector lanes, and what is written in them: the 32-bit formulas ([`optics`]) and a sorting network ([`sort`]).
//!
//! Vector lanes are the few operations the kernels are written in, over 16 (AVX-512), 8 (AVX2 + FMA, NEON) or 4 lanes, which
//! every processor has: SSE2 on x86-64, arrays elsewhere.
//!
//! A kernel is one generic function over [`Lanes`], marked `#[inline(always)]`; [`dispatch()`] runs it inside a
//! function that carries the processor features, chosen once at run time. The implementations agree lane
//! by lane (`conformance` holds each to the same model), except that the portable one rounds a fused multiply-add twice where the
//! build has no instruction for it.
//!
//! # Why code cannot run instructions that the processor lacks
//!
//! The methods of the AVX lanes are safe to call and would be undefined on a processor without the features (NEON is in every
//! AArch64 processor that the standard library is made for, and SSE2 in every x86-64). So their types are private: outside this crate they have no name, there is no function that gives one, and no type that they could be
//! reached from. Code meets them only as the type parameter of [`Kernel::run`], which only [`dispatch()`] fills in, after
//! the processor said that it has the features; and what a processor has, it keeps. [`Lanes`] is sealed, so that unsafe code
//! may rely on what its traits say.
//!
//! Under `cargo miri` the processor is taken to have what the build asks for, so that four lanes are interpreted.

/// Instructions upon values.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
macro_rules! on_processor {
    ($instructions:expr) => {{
        // SAFETY: they ask for nothing but a processor that has them, and code over these lanes runs beneath `dispatch`
        // alone, which made sure of it (see the crate's head).
        unsafe { $instructions }
    }};
}

/// Instructions that read or write a whole array through a reference to it.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
macro_rules! on_array {
    ($instructions:expr) => {{
        // SAFETY: the pointer is that of an array as long as the vector, and they ask for no alignment; for the processor
        // as above.
        unsafe { $instructions }
    }};
}

/// An operator by an instruction upon two vectors.
#[cfg(target_arch = "x86_64")]
macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                $type(on_processor!($intrinsic(self.0, other.0)))
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(test)]
mod conformance;
mod dispatch;
pub mod limits;
#[cfg(all(target_arch = "aarch64", target_endian = "little"))]
mod neon;
mod operations;
pub mod optics;
#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable;
mod single;
pub mod sort;
#[cfg(target_arch = "x86_64")]
mod sse2;

pub use dispatch::{Kernel, LaneSet, dispatch};
pub use operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, array, inlined, mask_of, prefetch,
};

#[cfg(not(target_arch = "x86_64"))]
use portable::Portable as FourLanes;
#[cfg(target_arch = "x86_64")]
use sse2::Sse2 as FourLanes;
