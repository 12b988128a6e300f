//! Lanes that count what they compute: any set of lanes with a counter beside it. Only in builds with the feature `counting`,
//! for what is asked for by [`count`].
//!
//! Counted are additions, differences, products, quotients, square roots and multiply-adds of floats, each as one a lane, also on
//! lanes whose result nobody looks at; a lane of 64 bits counts as two. Minima, comparisons, choices and integers are not, nor is
//! arithmetic without lanes.

use crate::operations::{Double, Float, Lanes, Unsigned, array, sealed};
use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

static IS_ON: AtomicBool = AtomicBool::new(false);
static COUNTED: AtomicU64 = AtomicU64::new(0);

thread_local! {
    /// Operations of the current kernel.
    static HERE: Cell<u64> = const { Cell::new(0) };
}

/// Does some work, and counts what the kernels of all threads compute meanwhile.
pub fn count<R>(work: impl FnOnce() -> R) -> (R, u64) {
    COUNTED.store(0, Relaxed);
    IS_ON.store(true, Relaxed);
    let done = work();
    IS_ON.store(false, Relaxed);
    (done, COUNTED.load(Relaxed))
}

/// True if kernels shall count.
pub(super) fn is_on() -> bool {
    IS_ON.load(Relaxed)
}

/// A kernel of this thread has ended.
pub(super) fn end() {
    COUNTED.fetch_add(HERE.take(), Relaxed);
}

/// One operation upon a vector of `L`.
#[inline(always)]
fn one<L: Lanes>() {
    HERE.set(HERE.get() + L::WIDTH as u64);
}

/// The lanes `L`, counted.
#[derive(Clone, Copy)]
pub(super) struct Counted<L>(PhantomData<L>);

/// 32-bit floats.
#[derive(Clone, Copy)]
pub(super) struct F<L: Lanes>(L::F);

/// 32-bit unsigned integers.
#[derive(Clone, Copy)]
pub(super) struct U<L: Lanes>(L::U);

/// 64-bit floats.
#[derive(Clone, Copy)]
pub(super) struct D<L: Lanes>(L::D);

impl<L> sealed::Sealed for Counted<L> {}

impl<L: Lanes> Lanes for Counted<L> {
    const WIDTH: usize = L::WIDTH;
    type F = F<L>;
    type U = U<L>;
    type M = L::M;
    type D = D<L>;
}

macro_rules! operators {
    ($type:ident: $($trait:ident $method:ident),*) => {$(
        impl<L: Lanes> $trait for $type<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                one::<L>();
                $type(self.0.$method(other.0))
            }
        }
    )*};
}

operators!(F: Add add, Sub sub, Mul mul, Div div);
operators!(D: Add add, Sub sub, Mul mul, Div div);

macro_rules! integer_operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<L: Lanes> $trait for U<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                U(self.0.$method(other.0))
            }
        }
    )*};
}

integer_operators!(Add add, Sub sub, Mul mul);

/// Forwards operations that are not counted.
macro_rules! passed_on {
    ($type:ident: $($method:ident($($other:ident),*)),*) => {$(
        #[inline(always)]
        fn $method(self $(, $other: Self)*) -> Self {
            $type(self.0.$method($($other.0),*))
        }
    )*};
}

impl<L: Lanes> Neg for F<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        F(-self.0)
    }
}

impl<L: Lanes> Neg for D<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        D(-self.0)
    }
}

impl<L: Lanes> Float for F<L> {
    type Lanes = Counted<L>;

    passed_on!(F: min(other), max(other), abs(), round(), floor());

    #[inline(always)]
    fn splat(value: f32) -> Self {
        F(L::F::splat(value))
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        F(L::F::load(values))
    }
    #[inline(always)]
    fn store(self, values: &mut [f32]) {
        self.0.store(values);
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        one::<L>();
        F(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        one::<L>();
        F(self.0.sqrt())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> L::M {
        self.0.lt(other.0)
    }
    #[inline(always)]
    fn le(self, other: Self) -> L::M {
        self.0.le(other.0)
    }
    #[inline(always)]
    fn select(mask: L::M, yes: Self, no: Self) -> Self {
        F(L::F::select(mask, yes.0, no.0))
    }
    #[inline(always)]
    fn to_bits(self) -> U<L> {
        U(self.0.to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: U<L>) -> Self {
        F(L::F::from_bits(bits.0))
    }
    #[inline(always)]
    fn to_unsigned(self) -> U<L> {
        U(self.0.to_unsigned())
    }
    #[inline(always)]
    fn permute(self, index: U<L>) -> Self {
        F(self.0.permute(index.0))
    }
    #[inline(always)]
    fn gather(values: &[f32], index: U<L>) -> Self {
        F(L::F::gather(values, index.0))
    }
    #[inline(always)]
    fn gather_parts(values: &[[f32; 4]], index: U<L>) -> [Self; 4] {
        let [a, b, c, d] = L::F::gather_parts(values, index.0);
        [F(a), F(b), F(c), F(d)]
    }
    #[inline(always)]
    fn scatter_parts<const N: usize>(fours: [[Self; 4]; N], values: &mut [[[f32; 4]; N]], index: U<L>) {
        let fours = array(
            #[inline(always)]
            |n| {
                let [a, b, c, d] = fours[n];
                [a.0, b.0, c.0, d.0]
            },
        );
        L::F::scatter_parts(fours, values, index.0);
    }
}

impl<L: Lanes> Unsigned for U<L> {
    type Lanes = Counted<L>;

    passed_on!(U: and(other), or(other), min(other), max(other), permute(index));

    #[inline(always)]
    fn splat(value: u32) -> Self {
        U(L::U::splat(value))
    }
    #[inline(always)]
    fn iota() -> Self {
        U(L::U::iota())
    }
    #[inline(always)]
    fn load(values: &[u32]) -> Self {
        U(L::U::load(values))
    }
    #[inline(always)]
    fn load_u16(values: &[u16]) -> Self {
        U(L::U::load_u16(values))
    }
    #[inline(always)]
    fn store(self, values: &mut [u32]) {
        self.0.store(values);
    }
    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        U(self.0.shl::<N>())
    }
    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        U(self.0.shr::<N>())
    }
    #[inline(always)]
    fn test(self, bits: Self) -> L::M {
        self.0.test(bits.0)
    }
    #[inline(always)]
    fn equal(self, other: Self) -> L::M {
        self.0.equal(other.0)
    }
    #[inline(always)]
    fn select(mask: L::M, yes: Self, no: Self) -> Self {
        U(L::U::select(mask, yes.0, no.0))
    }
    #[inline(always)]
    fn to_float(self) -> F<L> {
        F(self.0.to_float())
    }
}

impl<L: Lanes> Double for D<L> {
    const COUNT: usize = L::D::COUNT;
    type Mask = <L::D as Double>::Mask;

    passed_on!(D: min(other), max(other), abs(), ceil());

    #[inline(always)]
    fn splat(value: f64) -> Self {
        D(L::D::splat(value))
    }
    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        D(L::D::load(values))
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        self.0.store(values);
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        self.0.store_f32(values);
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        one::<L>();
        D(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.0.lt(other.0)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.0.le(other.0)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        D(L::D::select(mask, yes.0, no.0))
    }
}

#[cfg(test)]
mod tests;
