//! Buffers of a grid that a plug-in writes to, allocated once its sizes are known.

use super::head::Head;
use crate::ffi::ValidationError;
use crate::interface::{GridBuffers, SAME_CELLS, SAME_POINTS, TETRAHEDRA};
use crate::sentinel::{Overrun, Sentinel, guarded_vec, remove_guard};
use crate::wire::wire;
use std::mem::size_of;
use std::ptr::null_mut;
use voltet_core::glam::DVec3;

/// `voltet_grid_buffers`; parts that are `None` or empty are not requested.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Buffers {
    pub points: Option<Vec<DVec3>>,
    pub tetrahedra: Option<Vec<[u32; 4]>>,
    pub cells: Option<MixedCells>,
    /// One for each array of the head.
    pub arrays: Vec<Option<Vec<f64>>>,
}

/// Cells of any types.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct MixedCells {
    pub types: Vec<u8>,
    pub offsets: Vec<i64>,
    pub connectivity: Vec<u32>,
}

wire!(struct Buffers { points, tetrahedra, cells, arrays });
wire!(struct MixedCells { types, offsets, connectivity });

impl Buffers {
    /// Buffers for the requested arrays of a grid, and with `geometry` for its points and cells.
    ///
    /// Errors: they take more than `memory_left` (bytes).
    pub fn new(
        head: &Head,
        geometry: bool,
        requested: &[bool],
        memory_left: Option<u64>,
    ) -> Result<Buffers, ValidationError> {
        let bytes = buffer_bytes(head, geometry, requested);
        if let Some(left) = memory_left.filter(|left| *left < bytes) {
            return Err(format!(
                "memory ends: its grid takes {} MiB, {} MiB are left",
                bytes >> 20,
                left >> 20
            ));
        }
        let mut buffers = Buffers::default();
        if geometry && !head.has(SAME_POINTS) {
            buffers.points = Some(guarded_vec::<_, f64>(head.point_count)?);
        }
        if geometry && !head.has(SAME_CELLS) {
            match head.has(TETRAHEDRA) {
                true => buffers.tetrahedra = Some(guarded_vec::<_, u32>(head.cell_count)?),
                false => {
                    buffers.cells = Some(MixedCells {
                        types: guarded_vec::<_, u8>(head.cell_count)?,
                        offsets: guarded_vec::<_, i64>(head.cell_count + 1)?,
                        connectivity: guarded_vec::<_, u32>(head.connectivity_count)?,
                    });
                }
            }
        }
        for (array, &requested) in head.arrays.iter().zip(requested) {
            let buffer = requested.then(|| guarded_vec::<_, f64>(head.numbers(array)));
            buffers.arrays.push(buffer.transpose()?);
        }
        Ok(buffers)
    }

    /// True if every buffer is as long as the head says.
    pub fn fit(&self, head: &Head) -> bool {
        let is_right = |cells: &MixedCells| {
            [cells.types.len(), cells.offsets.len(), cells.connectivity.len()]
                == [head.cell_count, head.cell_count + 1, head.connectivity_count]
        };
        self.points.as_ref().is_none_or(|points| points.len() == head.point_count)
            && self.tetrahedra.as_ref().is_none_or(|tetrahedra| tetrahedra.len() == head.cell_count)
            && self.cells.as_ref().is_none_or(is_right)
            && (self.arrays.is_empty() || self.arrays.len() == head.arrays.len())
            && self.arrays.iter().zip(&head.arrays).all(|(buffer, array)| {
                buffer.as_ref().is_none_or(|buffer| buffer.len() == head.numbers(array))
            })
    }

    /// Addresses of the arrays; valid until the buffers are closed or dropped.
    pub fn array_addresses(&mut self) -> Vec<*mut f64> {
        let address = |array: &mut Option<Vec<f64>>| array.as_mut().map_or(null_mut(), |a| a.as_mut_ptr());
        self.arrays.iter_mut().map(address).collect()
    }

    /// The struct of the header. `addresses`: those of the arrays.
    pub fn header_buffers(&mut self, head: &Head, addresses: &[*mut f64]) -> GridBuffers {
        let (types, offsets, connectivity_u32) = match &mut self.cells {
            Some(MixedCells { types, offsets, connectivity }) => {
                (types.as_mut_ptr(), offsets.as_mut_ptr(), connectivity.as_mut_ptr())
            }
            None => (null_mut(), null_mut(), null_mut()),
        };
        GridBuffers {
            size: size_of::<GridBuffers>() as u32,
            array_count: addresses.len() as u32,
            point_count: head.point_count as u64,
            cell_count: head.cell_count as u64,
            connectivity_count: head.connectivity_count as u64,
            points: self.points.as_mut().map_or(null_mut(), |points| points.as_mut_ptr().cast()),
            tetrahedra: self.tetrahedra.as_mut().map_or(null_mut(), |cells| cells.as_mut_ptr().cast()),
            types,
            offsets,
            connectivity_u32,
            arrays: addresses.as_ptr(),
        }
    }

    /// Removes the guards behind the buffers; the first overrun.
    pub fn close(&mut self, head: &Head) -> Option<Overrun> {
        let (points, cells, connectivity_count) =
            (head.point_count, head.cell_count, head.connectivity_count);
        let mut overrun = None;
        if let Some(points_) = &mut self.points {
            close::<_, f64>(points_, points, &mut overrun, || {
                ("the points".into(), per_tuple(3, points, "points"))
            });
        }
        if let Some(tetrahedra) = &mut self.tetrahedra {
            close::<_, u32>(tetrahedra, cells, &mut overrun, || {
                ("the tetrahedra".into(), per_tuple(4, cells, "cells"))
            });
        }
        if let Some(MixedCells { types, offsets, connectivity }) = &mut self.cells {
            close::<_, u8>(types, cells, &mut overrun, || {
                ("the types".into(), format!("1 for each of the {cells} cells"))
            });
            close::<_, i64>(offsets, cells + 1, &mut overrun, || {
                ("the offsets".into(), format!("{} of them", cells + 1))
            });
            close::<_, u32>(connectivity, connectivity_count, &mut overrun, || {
                ("the connectivity".into(), format!("{connectivity_count} numbers"))
            });
        }
        for (buffer, array) in self.arrays.iter_mut().zip(&head.arrays) {
            let Some(buffer) = buffer else { continue };
            close::<_, f64>(buffer, head.numbers(array), &mut overrun, || {
                let elements = if array.on_cells { "cells" } else { "points" };
                let capacity = per_tuple(array.component_count, head.tuples(array), elements);
                (format!("the array '{}'", array.name), capacity)
            });
        }
        overrun
    }
}

/// Removes the guard behind `count` tuples, and records an overrun unless there was one.
fn close<V: bytemuck::Pod, T: Sentinel>(
    buffer: &mut Vec<V>,
    count: usize,
    overrun: &mut Option<Overrun>,
    describe: impl FnOnce() -> (String, String),
) {
    if remove_guard::<V, T>(buffer, count) {
        overrun.get_or_insert_with(|| {
            let (buffer, capacity) = describe();
            Overrun { buffer, capacity }
        });
    }
}

fn per_tuple(components: usize, tuples: usize, elements: &str) -> String {
    format!("{components} numbers for each of the {tuples} {elements}")
}

fn buffer_bytes(head: &Head, geometry: bool, requested: &[bool]) -> u64 {
    let geometry = if geometry { 24 * head.point_count as u64 + head.cell_bytes() } else { 0 };
    let arrays = head.arrays.iter().zip(requested).filter(|(_, requested)| **requested);
    arrays.fold(geometry, |sum, (array, _)| sum.saturating_add(8 * head.numbers(array) as u64))
}
