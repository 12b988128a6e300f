//! Memory that a plug-in writes to: filled with numbers that no computation gives, and with a guard behind it, so that missing
//! numbers and writes beyond the end show.

use crate::ffi::CheckResult;
use std::mem::size_of;

/// Tuples of the guard behind a buffer: a filter that miscounts by a few is found.
pub(crate) const GUARD_COUNT: usize = 64;

/// Marker of a gradient that was not written: a NaN with digits that no computation gives.
pub(crate) const UNSET: f64 = f64::from_bits(0x7ff7_766f_6c74_6574);

/// Write beyond the end of a buffer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Overrun {
    /// Name of the buffer: "the gradient".
    pub buffer: String,
    /// Numbers to write: "3 numbers for each of the 64 points".
    pub capacity: String,
}

crate::wire::wire!(fields of Overrun { buffer, capacity });

impl Overrun {
    /// Overrun of the gradient at `point_count` points.
    pub fn gradient(point_count: usize) -> Overrun {
        let capacity = format!("3 numbers for each of the {point_count} points");
        Overrun { buffer: "the gradient".into(), capacity }
    }
}

/// Number type with a marker value, which stands where nothing was written.
pub(crate) trait Sentinel: bytemuck::Pod + Send + Sync {
    /// The marker.
    const UNSET: Self;

    /// True if this number is the marker, bit by bit.
    fn is_unset(&self) -> bool {
        bytemuck::bytes_of(self) == bytemuck::bytes_of(&Self::UNSET)
    }
}

macro_rules! sentinels {
    ($($number:ty = $unset:expr),*) => {$(
        impl Sentinel for $number {
            const UNSET: $number = $unset;
        }
    )*};
}

sentinels!(u8 = u8::MAX, u32 = u32::MAX, i64 = i64::MIN, f32 = f32::from_bits(0x7fd6_6f6c), f64 = UNSET);

/// Buffer of `count` tuples of numbers and the guard, all unset.
pub(crate) fn guarded_vec<V: bytemuck::Pod, T: Sentinel>(count: usize) -> CheckResult<Vec<V>> {
    let mut tuples = Vec::<V>::new();
    let total = count + GUARD_COUNT;
    tuples
        .try_reserve_exact(total)
        .map_err(|_| format!("there is no memory for {total} tuples of {} bytes", size_of::<V>()))?;
    let mut unset = [V::zeroed()];
    bytemuck::cast_slice_mut::<V, T>(&mut unset).fill(T::UNSET);
    tuples.resize(total, unset[0]);
    Ok(tuples)
}

/// Removes the guard behind `count` tuples; true if it was written to.
pub(crate) fn remove_guard<V: bytemuck::Pod, T: Sentinel>(tuples: &mut Vec<V>, count: usize) -> bool {
    let overran = !bytemuck::cast_slice::<V, T>(&tuples[count..]).iter().all(T::is_unset);
    tuples.truncate(count);
    overran
}
