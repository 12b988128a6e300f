//! Memory that a plug-in writes to: allocated once sizes are known, filled with what nobody writes, some more behind it.

use super::head::Head;
use crate::foreign::Wrong;
use crate::interface::{GridBuffers, SAME_CELLS, SAME_POINTS, TETRAHEDRA};
use crate::outcome::{Beyond, UNSET};
use crate::work::BEYOND;
use std::mem::size_of;
use voltet_core::glam::DVec3;

/// A number with a value that nobody computes, which stands where nothing was written.
pub(crate) trait Fresh: bytemuck::Pod + PartialEq + Send + Sync {
    /// That value.
    const UNSET: Self;

    /// Whether it is that one.
    fn is_unset(&self) -> bool;
}

impl Fresh for f64 {
    const UNSET: f64 = UNSET;

    fn is_unset(&self) -> bool {
        self.to_bits() == UNSET.to_bits()
    }
}

impl Fresh for f32 {
    const UNSET: f32 = f32::from_bits(0x7fd6_6f6c);

    fn is_unset(&self) -> bool {
        self.to_bits() == Self::UNSET.to_bits()
    }
}

macro_rules! whole {
    ($($number:ty = $unset:expr),*) => {$(
        impl Fresh for $number {
            const UNSET: $number = $unset;

            fn is_unset(&self) -> bool {
                *self == Self::UNSET
            }
        }
    )*};
}

whole!(u8 = u8::MAX, u32 = u32::MAX, i64 = i64::MIN);

/// So many tuples of numbers, and [`BEYOND`] more.
pub(crate) fn fresh<V: bytemuck::Pod, T: Fresh>(count: usize) -> Result<Vec<V>, Wrong> {
    let mut tuples = Vec::<V>::new();
    let whole = count + BEYOND;
    tuples
        .try_reserve_exact(whole)
        .map_err(|_| format!("there is no memory for {whole} tuples of {} bytes", size_of::<V>()))?;
    let mut unset = [V::zeroed()];
    bytemuck::cast_slice_mut::<V, T>(&mut unset).fill(T::UNSET);
    tuples.resize(whole, unset[0]);
    Ok(tuples)
}

/// Takes off what lies behind so many tuples; whether something was written there.
pub(crate) fn overran<V: bytemuck::Pod, T: Fresh>(tuples: &mut Vec<V>, count: usize) -> bool {
    let overran = !bytemuck::cast_slice::<V, T>(&tuples[count..]).iter().all(T::is_unset);
    tuples.truncate(count);
    overran
}

/// `voltet_grid_buffers`: what is `None` or empty is not asked for.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Buffers {
    pub points: Option<Vec<DVec3>>,
    pub tetrahedra: Option<Vec<[u32; 4]>>,
    pub cells: Option<Mixed>,
    /// One an array of the head.
    pub arrays: Vec<Option<Vec<f64>>>,
}

/// Cells of any types.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Mixed {
    pub types: Vec<u8>,
    pub offsets: Vec<i64>,
    pub connectivity: Vec<u32>,
}

impl Buffers {
    /// Memory for a grid of that size: `geometry`: points and cells; `wanted`: for each array whether it is.
    ///
    /// Errors: more than is left.
    pub fn new(head: &Head, geometry: bool, wanted: &[bool], left: Option<u64>) -> Result<Buffers, Wrong> {
        let bytes = bytes(head, geometry, wanted);
        if let Some(left) = left.filter(|left| *left < bytes) {
            let mebibytes = |bytes: u64| bytes >> 20;
            return Err(format!(
                "memory ends: its grid takes {} MiB, {} MiB are left",
                mebibytes(bytes),
                mebibytes(left)
            ));
        }
        let mut buffers = Buffers::default();
        if geometry && !head.is(SAME_POINTS) {
            buffers.points = Some(fresh::<_, f64>(head.point_count)?);
        }
        if geometry && !head.is(SAME_CELLS) {
            match head.is(TETRAHEDRA) {
                true => buffers.tetrahedra = Some(fresh::<_, u32>(head.cell_count)?),
                false => {
                    buffers.cells = Some(Mixed {
                        types: fresh::<_, u8>(head.cell_count)?,
                        offsets: fresh::<_, i64>(head.cell_count + 1)?,
                        connectivity: fresh::<_, u32>(head.connectivity_count)?,
                    });
                }
            }
        }
        for (array, wanted) in head.arrays.iter().zip(wanted) {
            buffers.arrays.push(if *wanted { Some(fresh::<_, f64>(head.numbers(array))?) } else { None });
        }
        Ok(buffers)
    }

    /// Where the arrays go; valid as long as this is neither moved into nor out of.
    pub fn places(&mut self) -> Vec<*mut f64> {
        let place =
            |array: &mut Option<Vec<f64>>| array.as_mut().map_or(std::ptr::null_mut(), |a| a.as_mut_ptr());
        self.arrays.iter_mut().map(place).collect()
    }

    /// As the plug-in sees them. `places`: of the arrays.
    pub fn interface(&mut self, head: &Head, places: &[*mut f64]) -> GridBuffers {
        use std::ptr::null_mut;
        let (types, offsets, connectivity_u32) = match &mut self.cells {
            Some(Mixed { types, offsets, connectivity }) => {
                (types.as_mut_ptr(), offsets.as_mut_ptr(), connectivity.as_mut_ptr())
            }
            None => (null_mut(), null_mut(), null_mut()),
        };
        GridBuffers {
            size: size_of::<GridBuffers>() as u32,
            array_count: places.len() as u32,
            point_count: head.point_count as u64,
            cell_count: head.cell_count as u64,
            connectivity_count: head.connectivity_count as u64,
            points: self.points.as_mut().map_or(null_mut(), |points| points.as_mut_ptr().cast()),
            tetrahedra: self.tetrahedra.as_mut().map_or(null_mut(), |cells| cells.as_mut_ptr().cast()),
            types,
            offsets,
            connectivity_u32,
            arrays: places.as_ptr(),
        }
    }

    /// Takes off what lies behind; where something was written that was not to be.
    pub fn close(&mut self, head: &Head) -> Option<Beyond> {
        let mut beyond = None;
        let mut note = |overran: bool, what: String, accepted: String| {
            if overran {
                beyond.get_or_insert(Beyond { what, accepted });
            }
        };
        let (points, cells) = (head.point_count, head.cell_count);
        if let Some(own) = &mut self.points {
            note(
                overran::<_, f64>(own, points),
                "the points".into(),
                format!("3 numbers for each of the {points} points"),
            );
        }
        if let Some(own) = &mut self.tetrahedra {
            let accepted = format!("4 numbers for each of the {cells} cells");
            note(overran::<_, u32>(own, cells), "the tetrahedra".into(), accepted);
        }
        if let Some(Mixed { types, offsets, connectivity }) = &mut self.cells {
            note(
                overran::<_, u8>(types, cells),
                "the types".into(),
                format!("1 for each of the {cells} cells"),
            );
            note(
                overran::<_, i64>(offsets, cells + 1),
                "the offsets".into(),
                format!("{} of them", cells + 1),
            );
            let count = head.connectivity_count;
            note(
                overran::<_, u32>(connectivity, count),
                "the connectivity".into(),
                format!("{count} numbers"),
            );
        }
        for (own, array) in self.arrays.iter_mut().zip(&head.arrays) {
            let Some(own) = own else { continue };
            let (tuples, of) = (head.tuples(array), if array.on_cells { "cells" } else { "points" });
            let accepted = format!("{} numbers for each of the {tuples} {of}", array.component_count);
            note(
                overran::<_, f64>(own, head.numbers(array)),
                format!("the array '{}'", array.name),
                accepted,
            );
        }
        beyond
    }
}

fn bytes(head: &Head, geometry: bool, wanted: &[bool]) -> u64 {
    let geometry = if geometry { 24 * head.point_count as u64 + head.cell_bytes() } else { 0 };
    let arrays = head.arrays.iter().zip(wanted).filter(|(_, wanted)| **wanted);
    arrays.fold(geometry, |sum, (array, _)| sum.saturating_add(8 * head.numbers(array) as u64))
}
