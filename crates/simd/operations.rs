//! Operations of vector lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};

pub(super) mod sealed {
    /// Seal: only this crate implements lanes.
    pub trait Sealed {}
}

/// Lanes of the widest set.
const MAX_WIDTH: usize = 16;

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

    /// Runs a part of a kernel, a closure marked by [`inlined!`](crate::inlined!), as a function of its own: the time to compile a
    /// function grows faster than its size. `Fn`, since as `FnOnce` it would be called by way of a function without these lanes'
    /// instructions.
    fn call<A, R>(part: impl Fn(A) -> R, argument: A) -> R;
}

/// Lanes of 64-bit floats, [`Double::COUNT`] = `WIDTH / 2` of them.
pub trait Double:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Number of lanes.
    const COUNT: usize;
    /// Booleans.
    type Mask: Mask;

    /// Broadcasts a value to every lane.
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
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger lane; the second operand where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
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

/// [`Float::difference_of_products`] without a fused multiply-add: the roundings of both products from the halves of their factors' digits
/// (Dekker 1971).
#[inline(always)]
fn unfused_difference_of_products<F: Float>(a: F, b: F, c: F, d: F) -> F {
    let halves = inlined!(|x: F| {
        let shifted = x * F::splat(4097.0);
        let high = shifted - (shifted - x);
        (high, x - high)
    });
    let (one, other) = (a * b, c * d);
    let ((ah, al), (bh, bl), (ch, cl), (dh, dl)) = (halves(a), halves(b), halves(c), halves(d));
    let rest = ((ah * bh - one) + ah * bl + al * bh) + al * bl;
    let other_rest = ((ch * dh - other) + ch * dl + cl * dh) + cl * dl;
    (one - other) + (rest - other_rest)
}

/// Lanes of 32-bit floats.
pub trait Float:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The lane set.
    type Lanes: Lanes<F = Self>;

    /// Broadcasts a value to every lane.
    fn splat(value: f32) -> Self;
    /// The first `WIDTH` values of the slice, which must hold as many.
    fn load(values: &[f32]) -> Self;
    /// Writes the lanes to the first `WIDTH` places of the slice, which must hold as many.
    fn store(self, values: &mut [f32]);
    /// self × b + c, fused where the processor can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// True if [`mul_add`](Self::mul_add) is fused.
    const FUSED: bool = true;
    /// self × b − c × d, to the last digits also where the products nearly cancel: two products whose roundings are made good (as Kahan's;
    /// Jeannerod, Louvet and Muller 2013). Exchanged products give the same number with the opposite sign.
    #[inline(always)]
    fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self {
        if !Self::FUSED {
            return unfused_difference_of_products(self, b, c, d);
        }
        let (one, other) = (self * b, c * d);
        (one - other) + (self.mul_add(b, -one) - c.mul_add(d, -other))
    }
    /// The smaller lane; the second operand where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger lane; the second operand where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
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
    #[inline(always)]
    fn permute(self, index: <Self::Lanes as Lanes>::U) -> Self {
        Self::from_bits(self.to_bits().permute(index))
    }
    /// Lane i is `values[index[i]]`. An index past the end would be the caller's mistake: it takes the last value, and
    /// stops a build with debug assertions. The slice must hold something, and at most 2³¹ values.
    fn gather(values: &[f32], index: <Self::Lanes as Lanes>::U) -> Self;
    /// Lane i of part c is `values[index[i]][c]`; indices as for [`Float::gather`], of at most 2²⁸ values.
    fn gather_parts(values: &[[f32; 4]], index: <Self::Lanes as Lanes>::U) -> [Self; 4];
    /// [`Float::gather_parts`] of what was asked for before.
    #[inline(always)]
    fn gather_awaited(awaited: &PrefetchedGather<'_>) -> [Self; 4] {
        Self::gather_parts(awaited.values, awaited.index::<Self::Lanes>())
    }
    /// `values[index[i]][n][c]` becomes lane i of part c of four n; indices as for [`Float::gather`]. Of lanes with one index any
    /// may win.
    fn scatter_parts<const N: usize>(
        fours: [[Self; 4]; N],
        values: &mut [[[f32; 4]; N]],
        index: <Self::Lanes as Lanes>::U,
    );
}

/// Lanes of 32-bit unsigned integers (wrapping).
pub trait Unsigned: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The lane set.
    type Lanes: Lanes<U = Self>;

    /// Broadcasts a value to every lane.
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
    /// Mask of the lanes in which any bit of `bits` is set.
    fn test(self, bits: Self) -> <Self::Lanes as Lanes>::M;
    /// self == other.
    fn equal(self, other: Self) -> <Self::Lanes as Lanes>::M;
    /// `yes` where the mask is set, else `no`.
    fn select(mask: <Self::Lanes as Lanes>::M, yes: Self, no: Self) -> Self;
    /// As floats, taken as two's complement.
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

/// An array at the start of a slice.
#[inline(always)]
pub(super) fn first<T, const N: usize>(values: &[T]) -> &[T; N] {
    values[..N].try_into().expect("as many values")
}

/// An array at the start of a slice, to be written.
#[inline(always)]
pub(super) fn first_mut<T, const N: usize>(values: &mut [T]) -> &mut [T; N] {
    (&mut values[..N]).try_into().expect("as many values")
}

/// Indices into a slice of so many values, none past the end: what a gather may follow.
#[inline(always)]
pub(super) fn inside<L: Lanes>(index: L::U, length: usize) -> L::U {
    assert!(0 < length && length <= 1 << 31, "a gather from {length} values");
    let last = L::U::splat((length - 1) as u32);
    let inside = index.min(last);
    debug_assert!(!inside.equal(index).not().any(), "a gather past {length} values");
    inside
}

/// Indices into a slice of fours, none past the end and none whose bytes 32 bits do not count.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn parts_inside<L: Lanes>(index: L::U, values: &[[f32; 4]]) -> L::U {
    last_of_parts(values);
    inside::<L>(index, values.len())
}

/// The number of the last of a slice of fours whose bytes 32 bits count.
#[inline(always)]
fn last_of_parts(values: &[[f32; 4]]) -> u32 {
    assert!(!values.is_empty() && values.len() <= 1 << 28, "a gather from {} fours", values.len());
    (values.len() - 1) as u32
}

/// Prefetched gather: an index whose data are fetched now and read later ([`Float::gather_awaited`]).
#[repr(align(64))]
pub struct PrefetchedGather<'a> {
    /// Places in bytes, each of a value.
    bytes: [u32; MAX_WIDTH],
    values: &'a [[f32; 4]],
}

impl<'a> PrefetchedGather<'a> {
    /// The first of some values, of which there is one at least.
    #[inline(always)]
    pub fn first(values: &'a [[f32; 4]]) -> Self {
        last_of_parts(values);
        PrefetchedGather { bytes: [0; MAX_WIDTH], values }
    }

    /// Asks for `values[index[i]]` in place of what was asked for before; for the last one where an index is past the end. There are
    /// at most 2²⁸ values.
    #[inline(always)]
    pub fn ask<L: Lanes>(&mut self, index: L::U) {
        let last = last_of_parts(self.values);
        index.min(L::U::splat(last)).shl::<4>().store(&mut self.bytes);
        // Read from memory a place is one operation, taken out of a vector two.
        std::hint::black_box(&mut self.bytes);
        for &place in &self.bytes[..L::WIDTH] {
            prefetch(self.values.as_ptr().wrapping_byte_add(place as usize));
        }
    }

    /// Index of the gather.
    #[inline(always)]
    pub fn index<L: Lanes>(&self) -> L::U {
        L::U::load(&self.bytes).shr::<4>()
    }

    /// The values of lane `i`.
    #[inline(always)]
    pub(super) fn four(&self, i: usize) -> &[f32; 4] {
        // SAFETY: places are those of values: of the first, or cut off at the last by `ask`.
        unsafe { &*self.values.as_ptr().byte_add(self.bytes[i] as usize) }
    }
}

/// Asks for a cache line before it is needed.
#[inline(always)]
pub fn prefetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing; any address is allowed.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(at.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
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
    let mut i = 1;
    // Adapters of iterators are functions where a build inlines little.
    while i < N {
        out[i] = element(i);
        i += 1;
    }
    out
}

/// Mask with the lanes of some bits.
#[inline(always)]
pub fn mask_of<L: Lanes>(bits: u32) -> L::M {
    // 2^lane by its float bits, so that no variable shift is needed.
    let power = L::F::from_bits((L::U::iota() + L::U::splat(127)).shl::<23>()).to_unsigned();
    power.test(L::U::splat(bits))
}

/// One lane of 64 bits, a plain number: so that a rule that is written over lanes decides about a single cell too.
impl Double for f64 {
    const COUNT: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn load(values: &[f64]) -> f64 {
        values[0]
    }
    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[0] = self;
    }
    #[inline(always)]
    fn store_f32(self, values: &mut [f32]) {
        values[0] = self as f32;
    }
    #[inline(always)]
    fn mul_add(self, b: f64, c: f64) -> f64 {
        f64::mul_add(self, b, c)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn ceil(self) -> f64 {
        f64::ceil(self)
    }
    #[inline(always)]
    fn lt(self, other: f64) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: f64) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
}

impl Mask for bool {
    #[inline(always)]
    fn and(self, other: bool) -> bool {
        self && other
    }
    #[inline(always)]
    fn or(self, other: bool) -> bool {
        self || other
    }
    #[inline(always)]
    fn not(self) -> bool {
        !self
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.into()
    }
}
