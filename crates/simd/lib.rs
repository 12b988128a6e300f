//! voltet-simd: vector lanes, and what is written in them: the 32-bit formulas ([`optics`]) and a sorting network ([`sort`]).
//!
//! Vector lanes are the few operations the kernels are written in, over 16 (AVX-512) or 8 lanes (AVX2 + FMA), or those that
//! every processor has: 4 of SSE2 on x86-64, 8 of NEON on AArch64, arrays of 4 elsewhere.
//!
//! A kernel is one generic function over [`Lanes`], marked `#[inline(always)]`; [`dispatch()`] runs it inside a
//! function that carries the processor features, chosen once at run time. The implementations agree lane
//! by lane (`conformance` holds each to the same model), except that the portable one rounds a fused multiply-add twice where the
//! build has no instruction for it.
//!
//! # Why code cannot run instructions that the processor lacks
//!
//! The methods of the AVX lanes are safe to call and would be undefined on a processor without the features. So their types are
//! private: outside this crate they have no name, there is no function that gives one, and no type that they could be reached from.
//! Code meets them only as the type parameter of [`Kernel::run`], which only [`dispatch()`] fills in, after
//! the processor said that it has the features; and what a processor has, it keeps. [`Lanes`] is sealed, so that unsafe code
//! may rely on what its traits say.
//!
//! Under `cargo miri` the processor is taken to have what the build asks for, so that four lanes are interpreted.

/// Marks a closure `#[inline(always)]`.
///
/// Kernels mark every closure: one has no processor features of its own, so one that is left as a function calls every vector
/// operation.
#[macro_export]
macro_rules! inlined {
    ($closure:expr) => {
        // The attribute is allowed on an argument, not on the value of a `let`.
        $crate::inlined(
            #[inline(always)]
            $closure,
        )
    };
}

/// An array by a closure of the index, marked as by [`inlined!`]; for `std::array::from_fn` and `map`, which mark none.
#[macro_export]
macro_rules! array {
    ($element:expr) => {
        $crate::array(
            #[inline(always)]
            $element,
        )
    };
}

/// Instructions of the lane set.
#[cfg(target_arch = "x86_64")]
macro_rules! on_processor {
    ($instructions:expr) => {{
        // SAFETY: they need a processor that has them, and code over these lanes runs beneath `dispatch` alone, which made sure of
        // it (see the crate's head). Loads and stores take the pointer of an array as long as the vector, and need no alignment.
        unsafe { $instructions }
    }};
}

/// Methods whose results are instructions upon their operands' registers.
#[cfg(target_arch = "x86_64")]
macro_rules! operations {
    ($(fn $method:ident $(<const $n:ident: u32>)? ($($operand:tt)*) $(-> $type:ident)? = $result:expr;)*) => {$(
        #[inline(always)]
        fn $method $(<const $n: u32>)? ($($operand)*) $(-> $type)? {
            $($type)?(on_processor!($result))
        }
    )*};
}

/// Operators by an instruction upon two registers.
#[cfg(target_arch = "x86_64")]
macro_rules! operator {
    ($type:ident, Neg, $intrinsic:ident, $sign:expr) => {
        impl Neg for $type {
            type Output = $type;
            operations! { fn neg(self) -> $type = $intrinsic(self.0, $sign); }
        }
    };
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = $type;
            operations! { fn $method(self, other: $type) -> $type = $intrinsic(self.0, other.0); }
        }
    };
}

/// A lane set: the processor features of its instructions, its width, and the types of its floats, integers, booleans and 64-bit floats.
macro_rules! lane_set {
    ($(#[$features:meta])? $visibility:vis $set:ident: $width:expr, $float:ty, $unsigned:ty, $mask:ty, $double:ty) => {
        #[derive(Clone, Copy)]
        $visibility struct $set;

        impl sealed::Sealed for $set {}

        impl Lanes for $set {
            const WIDTH: usize = $width;
            type F = $float;
            type U = $unsigned;
            type M = $mask;
            type D = $double;

            #[inline(always)]
            fn call<A, R>(part: impl Fn(A) -> R, argument: A) -> R {
                $(#[$features])?
                #[inline(never)]
                unsafe fn outlined<A, R>(part: impl Fn(A) -> R, argument: A) -> R {
                    part(argument)
                }
                // SAFETY: it needs the features of these lanes, as their other methods do (see the crate's head).
                unsafe { outlined(part, argument) }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
macro_rules! registers {
    ($($name:ident($register:ty)),*) => {
        $(
            #[derive(Clone, Copy)]
            pub(super) struct $name($register);
        )*
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
mod operations;
pub mod optics;
mod portable;
pub mod sort;

pub use dispatch::{Kernel, LaneSet, dispatch};
pub use operations::{
    Double, Float, Lanes, Mask, PrefetchedGather, Unsigned, array, inlined, mask_of, prefetch,
};
