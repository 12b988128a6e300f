//! Layout of a PLOT3D file, inferred from its length.
//!
//! The format has no magic and no version: a grid count that may be missing, dimensions, then planes of numbers in
//! single or double precision, of either byte order, with or without the length marks that Fortran puts round each
//! record, or as text. Each choice gives another length for the same dimensions, so the length of the file tells.
//! Source: PLOT3D User's Manual (Walatka, Buning, Pierce, Elson; NASA TM 101067, 1990), chapter 8; choices as in
//! vtkMultiBlockPLOT3DReader.

use crate::formats::contents::{Encoding, Meter, Stored};
use crate::formats::numbers;
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// More grids than any file holds.
const GREATEST_GRID_COUNT: u64 = 1 << 16;

/// One component of one grid.
#[derive(Clone)]
pub(super) enum Plane {
    /// Bytes of the file.
    Stored(Stored),
    /// Parsed from text: all numbers of the file, the first of the plane, their count.
    Text(Arc<Vec<f64>>, usize, usize),
}

impl Plane {
    /// Reads the values.
    pub fn load(&self, meter: &Meter) -> Result<Vec<f64>> {
        match self {
            Plane::Stored(stored) => stored.load(meter),
            Plane::Text(values, first, count) => Ok(values[*first..first + count].to_vec()),
        }
    }
}

/// Kind of file: grid, solution or function.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// x, y, z and perhaps the blanking flags.
    Grid,
    /// Four numbers on the flow, then density, three momenta, energy.
    Solution,
}

/// A grid of the file: dimensions and planes.
pub(super) struct Block {
    pub dimensions: [u64; 3],
    pub planes: Vec<Plane>,
    /// The last plane holds blanking flags.
    pub has_blanking: bool,
}

/// One way to write a binary file.
#[derive(Clone, Copy)]
struct Layout {
    order: ByteOrder,
    /// Fortran's length marks.
    marks: bool,
    /// A count of grids stands first.
    counted: bool,
    double: bool,
    blanking: bool,
}

/// Reads the dimensions and finds the planes; also how the file is written, for people.
pub(super) fn blocks(source: &Arc<Source>, role: Role) -> Result<(Vec<Block>, String)> {
    let head = source.head(4096)?;
    if head.iter().all(|&b| b.is_ascii_whitespace() || b.is_ascii_digit() || b"+-.,eEdD".contains(&b)) {
        return text(source, role);
    }
    for marks in [true, false] {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            for counted in [false, true] {
                for (double, blanking) in [(false, false), (false, true), (true, false), (true, true)] {
                    let layout = Layout { order, marks, counted, double, blanking };
                    if (role == Role::Grid || !blanking)
                        && let Some(blocks) = layout.read(source, role)
                    {
                        return Ok((blocks, layout.describe()));
                    }
                }
            }
        }
    }
    Err(Error::run("this is no PLOT3D file, or a damaged one")
        .got(format_args!("a length of {} bytes, which fits no way of writing one", source.len()))
        .expected("three-dimensional grids, single or double precision, either byte order, with or without record marks"))
}

impl Layout {
    fn describe(self) -> String {
        format!(
            "{}, {} precision{}{}",
            if self.order == ByteOrder::Little { "little-endian" } else { "big-endian" },
            if self.double { "double" } else { "single" },
            if self.marks { ", record marks" } else { "" },
            if self.blanking { ", blanking" } else { "" },
        )
    }

    fn words(self, source: &Source, at: u64, count: u64) -> Option<Vec<u64>> {
        let bytes = source.check(at, count * 4).ok().and_then(|()| source.read(at, count * 4).ok())?;
        let mut words = vec![0_u64; count as usize];
        numbers::convert(NumberType::U32, self.order, &bytes, &mut words).ok()?;
        Some(words)
    }

    /// The planes, if the file is written in this way.
    fn read(self, source: &Arc<Source>, role: Role) -> Option<Vec<Block>> {
        let mut at = 0;
        let mut grid_count = 1;
        if self.counted {
            let [count] = self.record(source, &mut at, 1)?[..] else { return None };
            grid_count = count;
        }
        if !(1..=GREATEST_GRID_COUNT).contains(&grid_count) {
            return None;
        }
        let dimensions = self.record(source, &mut at, 3 * grid_count)?;
        let mut blocks = Vec::new();
        for &dimensions in dimensions.as_chunks::<3>().0 {
            let block = self.block(source, role, dimensions, &mut at)?;
            blocks.push(block);
        }
        (at == source.len()).then_some(blocks)
    }

    /// Reads a record of 32-bit words.
    fn record(self, source: &Source, at: &mut u64, count: u64) -> Option<Vec<u64>> {
        self.mark(source, at, count * 4)?;
        let words = self.words(source, *at, count)?;
        *at += count * 4;
        self.mark(source, at, count * 4)?;
        Some(words)
    }

    /// Steps over a mark, which must hold the length of the record.
    fn mark(self, source: &Source, at: &mut u64, len: u64) -> Option<()> {
        if self.marks {
            let [found] = self.words(source, *at, 1)?[..] else { return None };
            // Records of 4 GB and more have marks that cannot hold their length.
            if found != len && len <= u64::from(u32::MAX / 2) {
                return None;
            }
            *at += 4;
        }
        Some(())
    }

    fn block(self, source: &Arc<Source>, role: Role, dimensions: [u64; 3], at: &mut u64) -> Option<Block> {
        if dimensions.iter().any(|n| !(1..=1 << 31).contains(n)) {
            return None;
        }
        let count = dimensions[0].checked_mul(dimensions[1])?.checked_mul(dimensions[2])?;
        let number_type = if self.double { NumberType::F64 } else { NumberType::F32 };
        let plane_len = number_type.byte_count(count).filter(|&len| len <= source.len())?;
        if role == Role::Solution {
            let len = number_type.byte_count(4)?;
            self.mark(source, at, len)?;
            *at += len;
            self.mark(source, at, len)?;
        }
        let plane_count = if role == Role::Grid { 3 } else { 5 };
        let len = plane_len * plane_count + if self.blanking { count * 4 } else { 0 };
        self.mark(source, at, len)?;
        let mut planes = Vec::new();
        let mut plane = |number_type: NumberType, at: u64| {
            planes.push(Plane::Stored(Stored {
                source: source.clone(),
                name: if role == Role::Grid { "grid" } else { "solution" }.to_owned(),
                number_type,
                order: self.order,
                component_count: 1,
                tuple_count: Some(count),
                encoding: Encoding::Bytes(at),
            }));
        };
        for index in 0..plane_count {
            plane(number_type, *at + index * plane_len);
        }
        if self.blanking {
            plane(NumberType::I32, *at + plane_count * plane_len);
        }
        *at += len;
        if *at > source.len() {
            return None;
        }
        self.mark(source, at, len)?;
        Some(Block { dimensions, planes, has_blanking: self.blanking })
    }
}

/// A file of text: the same order of numbers, told by their count.
fn text(source: &Arc<Source>, role: Role) -> Result<(Vec<Block>, String)> {
    let mut bytes = source.read(0, source.len())?;
    bytes.iter_mut().filter(|byte| **byte == b',').for_each(|byte| *byte = b' ');
    let values: Arc<Vec<f64>> = Arc::new(numbers::numbers(NumberType::F64, &bytes)?);
    for counted in [false, true] {
        for blanking in [false, true] {
            if (role == Role::Grid || !blanking)
                && let Some(blocks) = text_blocks(&values, role, counted, blanking)
            {
                return Ok((blocks, format!("ASCII{}", if blanking { ", blanking" } else { "" })));
            }
        }
    }
    Err(Error::run("this is no PLOT3D file, or a damaged one")
        .got(format_args!("{} numbers, which fits no way of writing one", values.len()))
        .expected("three-dimensional grids as text"))
}

fn text_blocks(values: &Arc<Vec<f64>>, role: Role, counted: bool, blanking: bool) -> Option<Vec<Block>> {
    let whole = |index: usize| {
        values
            .get(index)
            .copied()
            .filter(|v| (1.0..=2147483648.0).contains(v) && v.fract() == 0.0)
            .map(|v| v as usize)
    };
    let grid_count = if counted { whole(0)? } else { 1 };
    let mut at = usize::from(counted) + grid_count.checked_mul(3).filter(|&n| n < values.len())?;
    let mut blocks = Vec::new();
    for grid in 0..grid_count {
        let first = usize::from(counted) + 3 * grid;
        let dimensions = [whole(first)?, whole(first + 1)?, whole(first + 2)?];
        let count = dimensions[0].checked_mul(dimensions[1])?.checked_mul(dimensions[2])?;
        at += if role == Role::Solution { 4 } else { 0 };
        let plane_count = if role == Role::Grid { 3 } else { 5 } + usize::from(blanking);
        let end = count.checked_mul(plane_count)?.checked_add(at).filter(|&end| end <= values.len())?;
        let planes =
            (0..plane_count).map(|plane| Plane::Text(values.clone(), at + plane * count, count)).collect();
        blocks.push(Block { dimensions: dimensions.map(|n| n as u64), planes, has_blanking: blanking });
        at = end;
    }
    (at == values.len()).then_some(blocks)
}
