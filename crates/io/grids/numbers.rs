//! Numbers of the arrays of a file: where they lie in memory, and the type that they are written with, least significant byte first.

use rayon::prelude::*;
use std::borrow::Cow;
use std::io::{self, Write};
use std::ops::Range;

/// Numbers that are written at a time.
const PART: usize = 1 << 15;

/// Bits of a written quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 32 where that keeps every value of the array, else 64.
    Lossless,
    /// 32, rounded.
    Single,
    /// 64.
    Double,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum WrittenType {
    U8,
    I32,
    I64,
    F32,
    F64,
}

impl WrittenType {
    pub fn size(self) -> usize {
        match self {
            WrittenType::U8 => 1,
            WrittenType::I32 | WrittenType::F32 => 4,
            WrittenType::I64 | WrittenType::F64 => 8,
        }
    }
}

/// Numbers as they lie in memory.
enum Source<'a> {
    Flags(Cow<'a, [u8]>),
    Indices(Cow<'a, [u32]>),
    Offsets(Cow<'a, [u64]>),
    Signed(Cow<'a, [i64]>),
    Quantities(Cow<'a, [f64]>),
}

pub(super) struct Numbers<'a> {
    source: Source<'a>,
    pub number_type: WrittenType,
}

impl<'a> Numbers<'a> {
    /// Numbers of 8 bits.
    pub fn flags(flags: impl Into<Cow<'a, [u8]>>) -> Self {
        Numbers { source: Source::Flags(flags.into()), number_type: WrittenType::U8 }
    }

    /// Numbers of points or cells; in 32 bits where `narrow`, which they must fit.
    pub fn indices(indices: impl Into<Cow<'a, [u32]>>, narrow: bool) -> Self {
        Numbers { source: Source::Indices(indices.into()), number_type: integer(narrow) }
    }

    /// Offsets; in 32 bits where `narrow`, which they must fit.
    pub fn offsets(offsets: impl Into<Cow<'a, [u64]>>, narrow: bool) -> Self {
        Numbers { source: Source::Offsets(offsets.into()), number_type: integer(narrow) }
    }

    /// Numbers with a sign, in 64 bits.
    pub fn signed(numbers: impl Into<Cow<'a, [i64]>>) -> Self {
        Numbers { source: Source::Signed(numbers.into()), number_type: WrittenType::I64 }
    }

    /// Quantities, in the bits of a precision.
    pub fn quantities(values: impl Into<Cow<'a, [f64]>>, precision: Precision) -> Self {
        let values = values.into();
        let is_single = |x: &f64| x.is_nan() || f64::from(*x as f32) == *x;
        let number_type = match precision {
            Precision::Single => WrittenType::F32,
            Precision::Double => WrittenType::F64,
            Precision::Lossless if values.par_iter().with_min_len(PART).all(is_single) => WrittenType::F32,
            Precision::Lossless => WrittenType::F64,
        };
        Numbers { source: Source::Quantities(values), number_type }
    }

    pub fn count(&self) -> usize {
        match &self.source {
            Source::Flags(numbers) => numbers.len(),
            Source::Indices(numbers) => numbers.len(),
            Source::Offsets(numbers) => numbers.len(),
            Source::Signed(numbers) => numbers.len(),
            Source::Quantities(numbers) => numbers.len(),
        }
    }

    pub fn byte_count(&self) -> u64 {
        self.count() as u64 * self.number_type.size() as u64
    }

    pub fn append(&self, range: Range<usize>, bytes: &mut Vec<u8>) {
        use WrittenType::{F32, I32};
        match (&self.source, self.number_type) {
            (Source::Flags(numbers), _) => bytes.extend_from_slice(&numbers[range]),
            (Source::Indices(numbers), I32) => put(&numbers[range], bytes, u32::to_le_bytes),
            (Source::Indices(numbers), _) => put(&numbers[range], bytes, |x| u64::from(x).to_le_bytes()),
            (Source::Offsets(numbers), I32) => put(&numbers[range], bytes, |x| (x as u32).to_le_bytes()),
            (Source::Offsets(numbers), _) => put(&numbers[range], bytes, u64::to_le_bytes),
            (Source::Signed(numbers), _) => put(&numbers[range], bytes, i64::to_le_bytes),
            (Source::Quantities(numbers), F32) => put(&numbers[range], bytes, |x| (x as f32).to_le_bytes()),
            (Source::Quantities(numbers), _) => put(&numbers[range], bytes, f64::to_le_bytes),
        }
    }

    /// Writes all numbers, a part at a time.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let (mut part, count) = (Vec::new(), self.count());
        for start in (0..count).step_by(PART) {
            part.clear();
            self.append(start..count.min(start + PART), &mut part);
            out.write_all(&part)?;
        }
        Ok(())
    }
}

fn integer(narrow: bool) -> WrittenType {
    if narrow { WrittenType::I32 } else { WrittenType::I64 }
}

/// Appends numbers, each as `N` bytes.
fn put<T: Copy, const N: usize>(numbers: &[T], bytes: &mut Vec<u8>, encode: impl Fn(T) -> [u8; N]) {
    let start = bytes.len();
    bytes.resize(start + N * numbers.len(), 0);
    let places = bytes[start..].as_chunks_mut().0;
    places.iter_mut().zip(numbers).for_each(|(place, &number)| *place = encode(number));
}
