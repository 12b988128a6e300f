//! The large arrays of grids and volumes: shared, never changed, owned or lent.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// Numbers that several owners share and that nobody changes: a vector, or memory that somebody lends. Cloning shares.
pub struct SharedSlice<T: 'static> {
    owned: Arc<Vec<T>>,
    /// In its place, where it is there.
    lent: Option<(&'static [T], Arc<dyn Send + Sync>)>,
}

impl<T> SharedSlice<T> {
    /// Memory that somebody else owns, shared without being copied. `keep` is dropped with the last owner: what it stands for
    /// (a call-back, a reference count) may then take the memory back. That the memory outlives it is the caller's promise, who
    /// made a slice without end of it.
    pub fn from_borrowed(values: &'static [T], keep: Arc<dyn Send + Sync>) -> SharedSlice<T> {
        SharedSlice { owned: Arc::default(), lent: Some((values, keep)) }
    }

    /// The numbers.
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        match &self.lent {
            None => &self.owned,
            Some((values, _)) => values,
        }
    }

    /// The numbers to change: those of a vector that nobody else holds as they are, a copy otherwise.
    pub fn make_mut(&mut self) -> &mut Vec<T>
    where
        T: Clone,
    {
        if let Some((values, _)) = self.lent.take() {
            self.owned = Arc::new(values.to_vec());
        }
        Arc::make_mut(&mut self.owned)
    }

    /// True if the memory is somebody else's.
    pub fn is_lent(&self) -> bool {
        self.lent.is_some()
    }

    /// True if both are the same memory.
    pub fn is(&self, other: &SharedSlice<T>) -> bool {
        std::ptr::eq(self.as_slice(), other.as_slice())
    }
}

impl<T> Deref for SharedSlice<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        self.as_slice()
    }
}

impl<T> Clone for SharedSlice<T> {
    fn clone(&self) -> Self {
        SharedSlice { owned: self.owned.clone(), lent: self.lent.clone() }
    }
}

impl<T> Default for SharedSlice<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: fmt::Debug> fmt::Debug for SharedSlice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_slice().fmt(f)
    }
}

impl<T: PartialEq> PartialEq for SharedSlice<T> {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl<T: PartialEq> PartialEq<Vec<T>> for SharedSlice<T> {
    fn eq(&self, other: &Vec<T>) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl<T: Serialize> Serialize for SharedSlice<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.as_slice().serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for SharedSlice<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(SharedSlice::from)
    }
}

impl<T> From<Vec<T>> for SharedSlice<T> {
    fn from(values: Vec<T>) -> Self {
        SharedSlice { owned: Arc::new(values), lent: None }
    }
}

impl From<Vec<[f64; 3]>> for SharedSlice<glam::DVec3> {
    fn from(points: Vec<[f64; 3]>) -> Self {
        points.into_iter().map(glam::DVec3::from).collect()
    }
}

impl From<&[[f64; 3]]> for SharedSlice<glam::DVec3> {
    fn from(points: &[[f64; 3]]) -> Self {
        points.to_vec().into()
    }
}

impl<T> From<Arc<Vec<T>>> for SharedSlice<T> {
    fn from(values: Arc<Vec<T>>) -> Self {
        SharedSlice { owned: values, lent: None }
    }
}

impl<T> FromIterator<T> for SharedSlice<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Vec::from_iter(values).into()
    }
}

impl<'a, T> IntoIterator for &'a SharedSlice<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.as_slice().iter()
    }
}

/// Hash of bytes: four sums side by side, each step of which is a bijection, so that a change in one word of 8 bytes always shows.
pub fn hash_of_bytes(bytes: &[u8]) -> u64 {
    let mix = |sum: u64, word: u64| (sum.rotate_left(29) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let (groups, rest) = bytes.as_chunks::<32>();
    let mut sums = [bytes.len() as u64; 4];
    for group in groups {
        let (words, _) = group.as_chunks::<8>();
        sums.iter_mut().zip(words).for_each(|(sum, word)| *sum = mix(*sum, u64::from_le_bytes(*word)));
    }
    let mut last = [0; 32];
    last[..rest.len()].copy_from_slice(rest);
    let (words, _) = last.as_chunks::<8>();
    sums.iter_mut().zip(words).for_each(|(sum, word)| *sum = mix(*sum, u64::from_le_bytes(*word)));
    sums.into_iter().fold(0, mix)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    struct ReturnedBuffer(Arc<AtomicBool>);

    impl Drop for ReturnedBuffer {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    #[test]
    fn lent_memory_is_given_back_by_the_last_owner_and_never_copied() {
        static NUMBERS: [f64; 3] = [1.0, 2.0, 3.0];
        let back = Arc::new(AtomicBool::new(false));
        let first = SharedSlice::from_borrowed(&NUMBERS, Arc::new(ReturnedBuffer(back.clone())));
        let second = first.clone();
        assert!(first.is(&second) && std::ptr::eq(first.as_ptr(), NUMBERS.as_ptr()));
        drop(first);
        assert!(!back.load(Ordering::Relaxed));
        assert_eq!(second.iter().sum::<f64>(), 6.0);
        drop(second);
        assert!(back.load(Ordering::Relaxed));
    }

    #[test]
    fn changing_copies_what_somebody_else_holds() {
        static NUMBERS: [u32; 2] = [7, 8];
        let mut lent = SharedSlice::from_borrowed(&NUMBERS, Arc::new(()));
        lent.make_mut().push(9);
        assert_eq!((&*lent, NUMBERS), (&[7, 8, 9][..], [7, 8]));
        let other = lent.clone();
        lent.make_mut()[0] = 1;
        assert_eq!((&*lent, &*other), (&[1, 8, 9][..], &[7, 8, 9][..]));
        let at = lent.as_ptr();
        lent.make_mut()[0] = 2;
        assert!(std::ptr::eq(at, lent.as_ptr()), "nobody else held it");
    }

    #[test]
    fn equal_numbers_are_equal_whoever_owns_them() {
        static NUMBERS: [u32; 2] = [7, 8];
        let lent = SharedSlice::from_borrowed(&NUMBERS, Arc::new(()));
        let owned = SharedSlice::from(vec![7, 8]);
        assert_eq!(lent, owned);
        assert!(!lent.is(&owned) && owned.is(&owned.clone()));
    }
}
