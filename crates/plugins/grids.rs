//! Grids that plug-ins give: the head with sizes and names, the buffers that are written to, and checks of what was written.

use crate::declaration::MAX_TEXT_BYTES;
use crate::ffi::{
    AddressSpace, CheckResult, Overrun, Process, Sentinel, ValidationError, guarded_vec, remove_guard,
};
use crate::host::CallLabel;
use crate::interface::{ArrayHead, GridBuffers, GridHead, SAME_CELLS, SAME_POINTS, TETRAHEDRA};
use crate::wire::wire;
use rayon::prelude::*;
use std::mem::size_of;
use std::ptr::null_mut;
use voltet_core::glam::DVec3;
use voltet_core::grid::{Association, CellSet, CellType, Cells, code};
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result, counted};

/// Largest numbers of arrays, components and steps.
const MAX_ARRAYS: u32 = 4096;
const MAX_COMPONENTS: u32 = 1024;
const MAX_STEPS: u32 = 1 << 20;

/// Largest number of point numbers of all cells.
const MAX_COUNT: u64 = 1 << 36;

/// `voltet_grid_head`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Head {
    pub flags: u32,
    pub point_count: usize,
    pub cell_count: usize,
    pub connectivity_count: usize,
    pub arrays: Vec<FileArray>,
    pub scalar: Option<String>,
    pub times: Vec<f64>,
    pub format: Option<String>,
}

wire!(fields of Head { flags, point_count, cell_count, connectivity_count, arrays, scalar, times, format });
wire!(fields of FileArray { name, association, component_count });
wire!(variants of Association { 0 = Point, 1 = Cell });

/// Errors: flags beside these.
pub(crate) fn refuse_flags(flags: u32, known: u32) -> CheckResult<()> {
    match flags & !known {
        0 => Ok(()),
        more => Err(format!("its head has flags that do not belong there: {more:#x}")),
    }
}

impl Head {
    /// The head at an address. Counts that a flag leaves out are 0.
    pub fn read(address: *const GridHead) -> CheckResult<Head> {
        let (read, _) = Process.sized::<GridHead>(address as usize)?;
        refuse_flags(read.flags, TETRAHEDRA | SAME_POINTS | SAME_CELLS)?;
        let [same_points, same_cells, tetrahedra] =
            [SAME_POINTS, SAME_CELLS, TETRAHEDRA].map(|flag| read.flags & flag != 0);
        let count = |what: &str, count: u64, max: u64, must_be_none: bool| match count {
            0 => Ok(0),
            count if must_be_none => {
                Err(format!("{what} is {count}, and its flags say that there are none to give"))
            }
            count if count > max => Err(format!("{what} is {count}, at most {max}")),
            count => Ok(count as usize),
        };
        let max_number = u64::from(u32::MAX);
        let point_count = count("point_count", read.point_count, max_number, same_points)?;
        let cell_count = count("cell_count", read.cell_count, max_number, same_cells)?;
        let connectivity_count = read.connectivity_count;
        let connectivity_count =
            count("connectivity_count", connectivity_count, MAX_COUNT, same_cells || tetrahedra)?;
        let head = Head {
            flags: read.flags,
            point_count,
            cell_count,
            connectivity_count,
            arrays: arrays(&read)?,
            scalar: Process.line("the name of its scalar", read.scalar, MAX_TEXT_BYTES)?,
            times: times(&read)?,
            format: Process.line("its format", read.format, MAX_TEXT_BYTES)?,
        };
        match &head.scalar {
            Some(name) if !head.arrays.iter().any(|array| array.name == *name) => {
                Err(format!("its scalar '{name}' is none of its arrays"))
            }
            _ => Ok(head),
        }
    }

    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    pub fn tuples(&self, array: &FileArray) -> usize {
        match array.association {
            Association::Cell => self.cell_count,
            Association::Point => self.point_count,
        }
    }

    pub fn numbers(&self, array: &FileArray) -> usize {
        self.tuples(array) * array.component_count
    }

    /// Memory of the cells (bytes).
    pub fn cell_bytes(&self) -> u64 {
        let cells = self.cell_count as u64;
        match self.has(TETRAHEDRA) {
            true => 16 * cells,
            false => 9 * cells + 4 * self.connectivity_count as u64,
        }
    }

    /// True if no count is beyond what [`Head::read`] accepts.
    pub fn is_within_limits(&self) -> bool {
        let counts = [self.point_count, self.cell_count, self.connectivity_count];
        counts.iter().all(|&count| count as u64 <= MAX_COUNT)
            && self.arrays.iter().all(|array| array.component_count <= MAX_COMPONENTS as usize)
    }
}

fn arrays(read: &GridHead) -> CheckResult<Vec<FileArray>> {
    if read.array_count > MAX_ARRAYS {
        return Err(format!("array_count is {}, at most {MAX_ARRAYS}", read.array_count));
    }
    let heads = Process.several::<ArrayHead>(read.arrays, read.array_count as usize);
    let heads = heads.map_err(|wrong| format!("array {wrong}"))?;
    let mut arrays: Vec<FileArray> = Vec::new();
    for (i, head) in heads.iter().enumerate() {
        let at = |wrong: ValidationError| format!("array {i}: {wrong}");
        let name = Process.required_line("the name", head.name, MAX_TEXT_BYTES).map_err(at)?;
        if !(1..=MAX_COMPONENTS).contains(&head.component_count) {
            return Err(at(format!(
                "'{name}' has {}, 1 to {MAX_COMPONENTS} can be",
                counted(head.component_count, "component")
            )));
        }
        let association = match head.on_cells {
            0 => Association::Point,
            1 => Association::Cell,
            other => return Err(at(format!("'on_cells' of '{name}' is {other}, neither 0 nor 1"))),
        };
        if arrays.iter().any(|known| known.name == name && known.association == association) {
            return Err(at(format!("there are two of the name '{name}'")));
        }
        let component_count = head.component_count as usize;
        arrays.push(FileArray { name, association, component_count });
    }
    Ok(arrays)
}

fn times(read: &GridHead) -> CheckResult<Vec<f64>> {
    if read.step_count > MAX_STEPS {
        return Err(format!("step_count is {}, at most {MAX_STEPS}", read.step_count));
    }
    if read.step_count == 0 {
        return Ok(Vec::new());
    }
    let times = Process.values::<f64>(read.times, read.step_count as usize);
    let times = times.map_err(|wrong| format!("'times' {wrong}"))?;
    match times.windows(2).position(|pair| pair[0] >= pair[1]) {
        _ if !times.iter().all(|time| time.is_finite()) => Err("a time is not finite".into()),
        Some(i) => Err(format!("times do not ascend: {} after {}", times[i + 1], times[i])),
        None => Ok(times),
    }
}

/// `voltet_grid_buffers`; parts that are `None` or empty are not requested. Of the cells either the tetrahedra are there, or types,
/// offsets and connectivity.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Buffers {
    pub points: Option<Vec<DVec3>>,
    pub tetrahedra: Option<Vec<[u32; 4]>>,
    pub types: Option<Vec<u8>>,
    pub offsets: Option<Vec<i64>>,
    pub connectivity: Option<Vec<u32>>,
    /// One for each array of the head.
    pub arrays: Vec<Option<Vec<f64>>>,
}

wire!(fields of Buffers { points, tetrahedra, types, offsets, connectivity, arrays });

impl Buffers {
    /// Buffers for the requested arrays of a grid, and with `geometry` for its points and cells.
    ///
    /// Errors: they take more than `memory_left` (bytes).
    pub fn new(
        head: &Head,
        geometry: bool,
        requested: &[bool],
        memory_left: Option<u64>,
    ) -> CheckResult<Buffers> {
        let bytes = buffer_bytes(head, geometry, requested);
        if let Some(left) = memory_left.filter(|left| *left < bytes) {
            return Err(format!(
                "memory ends: its grid takes {} MiB, {} MiB are left",
                bytes >> 20,
                left >> 20
            ));
        }
        let [points, cells] = [SAME_POINTS, SAME_CELLS].map(|flag| geometry && !head.has(flag));
        let mixed = cells && !head.has(TETRAHEDRA);
        let array = |(array, &requested)| allocate::<_, f64>(requested, head.numbers(array));
        Ok(Buffers {
            points: allocate::<_, f64>(points, head.point_count)?,
            tetrahedra: allocate::<_, u32>(cells && !mixed, head.cell_count)?,
            types: allocate::<_, u8>(mixed, head.cell_count)?,
            offsets: allocate::<_, i64>(mixed, head.cell_count + 1)?,
            connectivity: allocate::<_, u32>(mixed, head.connectivity_count)?,
            arrays: head.arrays.iter().zip(requested).map(array).collect::<CheckResult<_>>()?,
        })
    }

    /// True if every buffer is as long as the head says.
    pub fn fit(&self, head: &Head) -> bool {
        is_as_long(&self.points, head.point_count)
            && is_as_long(&self.tetrahedra, head.cell_count)
            && is_as_long(&self.types, head.cell_count)
            && is_as_long(&self.offsets, head.cell_count + 1)
            && is_as_long(&self.connectivity, head.connectivity_count)
            && (self.arrays.is_empty() || self.arrays.len() == head.arrays.len())
            && self
                .arrays
                .iter()
                .zip(&head.arrays)
                .all(|(buffer, array)| is_as_long(buffer, head.numbers(array)))
    }

    /// Addresses of the arrays; valid until the buffers are closed or dropped.
    pub fn array_addresses(&mut self) -> Vec<*mut f64> {
        self.arrays.iter_mut().map(address).collect()
    }

    /// The struct of the header. `addresses`: those of the arrays.
    pub fn header_buffers(&mut self, head: &Head, addresses: &[*mut f64]) -> GridBuffers {
        GridBuffers {
            size: size_of::<GridBuffers>() as u32,
            array_count: addresses.len() as u32,
            point_count: head.point_count as u64,
            cell_count: head.cell_count as u64,
            connectivity_count: head.connectivity_count as u64,
            points: address(&mut self.points),
            tetrahedra: address(&mut self.tetrahedra),
            types: address(&mut self.types),
            offsets: address(&mut self.offsets),
            connectivity_u32: address(&mut self.connectivity),
            arrays: addresses.as_ptr(),
        }
    }

    /// Removes the guards behind the buffers; the first overrun.
    pub fn close(&mut self, head: &Head) -> Option<Overrun> {
        let Head { point_count: points, cell_count: cells, connectivity_count: numbers, .. } = *head;
        let per_tuple = |components: usize, tuples: usize, elements: &str| {
            format!("{} for each of the {}", counted(components, "number"), counted(tuples, elements))
        };
        let one_a_cell = format!("1 for each of the {}", counted(cells, "cell"));
        let found = [
            close::<_, f64>(&mut self.points, points, "the points", per_tuple(3, points, "point")),
            close::<_, u32>(&mut self.tetrahedra, cells, "the tetrahedra", per_tuple(4, cells, "cell")),
            close::<_, u8>(&mut self.types, cells, "the types", one_a_cell),
            close::<_, i64>(&mut self.offsets, cells + 1, "the offsets", format!("{} of them", cells + 1)),
            close::<_, u32>(&mut self.connectivity, numbers, "the connectivity", counted(numbers, "number")),
        ];
        let in_arrays = self.arrays.iter_mut().zip(&head.arrays).map(|(buffer, array)| {
            let elements = if array.association == Association::Cell { "cell" } else { "point" };
            let capacity = per_tuple(array.component_count, head.tuples(array), elements);
            close::<_, f64>(buffer, head.numbers(array), &format!("the array '{}'", array.name), capacity)
        });
        // Every guard is removed, whatever was found before.
        found.into_iter().chain(in_arrays).fold(None, Option::or)
    }
}

/// Buffer of `count` tuples with its guard, where it is requested.
fn allocate<V: bytemuck::Pod, T: Sentinel>(requested: bool, count: usize) -> CheckResult<Option<Vec<V>>> {
    requested.then(|| guarded_vec::<V, T>(count)).transpose()
}

fn is_as_long<V>(buffer: &Option<Vec<V>>, count: usize) -> bool {
    buffer.as_ref().is_none_or(|buffer| buffer.len() == count)
}

/// Address of the numbers of a buffer; null for one that is not requested.
fn address<V, T>(buffer: &mut Option<Vec<V>>) -> *mut T {
    buffer.as_mut().map_or(null_mut(), |buffer| buffer.as_mut_ptr().cast())
}

/// Removes the guard behind `count` tuples of the buffer `name`; an overrun.
fn close<V: bytemuck::Pod, T: Sentinel>(
    buffer: &mut Option<Vec<V>>,
    count: usize,
    name: &str,
    capacity: String,
) -> Option<Overrun> {
    let overran = buffer.as_mut().is_some_and(|buffer| remove_guard::<V, T>(buffer, count));
    overran.then(|| Overrun { buffer: name.into(), capacity })
}

fn buffer_bytes(head: &Head, geometry: bool, requested: &[bool]) -> u64 {
    let geometry = if geometry { 24 * head.point_count as u64 + head.cell_bytes() } else { 0 };
    let arrays = head.arrays.iter().zip(requested).filter(|(_, requested)| **requested);
    arrays.fold(geometry, |sum, (array, _)| sum.saturating_add(8 * head.numbers(array) as u64))
}

/// Numbers in a unit of parallel work.
const CHUNK: usize = 1 << 14;

/// A grid, or the requested parts of it.
pub(crate) struct GridContents {
    pub points: Option<Vec<DVec3>>,
    pub cells: Option<Cells>,
    /// One for each array of the head.
    pub arrays: Vec<Option<Vec<f64>>>,
}

impl Buffers {
    /// The contents of the buffers. `point_count`: points that cells may name.
    ///
    /// Errors: a number that was not written; an invalid cell.
    pub fn validate(self, head: &Head, point_count: usize, label: CallLabel) -> Result<GridContents> {
        if let Some(points) = &self.points {
            refuse_unset::<f64>(bytemuck::cast_slice(points), 3, "the positions of points", label)?;
        }
        let cells = match (self.tetrahedra, self.types, self.offsets, self.connectivity) {
            (Some(tetrahedra), ..) => {
                refuse_unset::<u32>(tetrahedra.as_flattened(), 4, "the tetrahedra", label)?;
                refuse_out_of_range(tetrahedra.as_flattened(), point_count, "tetrahedra", label)?;
                Some(Cells::Tetrahedra(tetrahedra.into()))
            }
            (None, Some(types), Some(offsets), Some(connectivity)) => {
                Some(Cells::Mixed(mixed_cells(types, offsets, connectivity, point_count, label)?))
            }
            _ => None,
        };
        for (buffer, array) in self.arrays.iter().zip(&head.arrays) {
            if let Some(buffer) = buffer {
                let name = format!("the array '{}'", array.name);
                refuse_unset(buffer, array.component_count, &name, label)?;
            }
        }
        Ok(GridContents { points: self.points, cells, arrays: self.arrays })
    }
}

/// Errors: a number that was not written.
fn refuse_unset<T: Sentinel>(numbers: &[T], components: usize, what: &str, label: CallLabel) -> Result<()> {
    let Some(first) = numbers.par_iter().with_min_len(CHUNK).position_first(T::is_unset) else {
        return Ok(());
    };
    let missing = numbers.par_iter().with_min_len(CHUNK).filter(|number| number.is_unset()).count();
    let tuple = first / components;
    let found =
        format!("{missing} of {} unset, the first of tuple {tuple}", counted(numbers.len(), "number"));
    Err(label.error(&format!("did not write all of {what}")).got(found).expected("every number"))
}

/// Errors: a point number that is too large.
fn refuse_out_of_range(numbers: &[u32], point_count: usize, what: &str, label: CallLabel) -> Result<()> {
    let is_wrong = |&number: &u32| number as usize >= point_count;
    match numbers.par_iter().with_min_len(CHUNK).position_first(is_wrong) {
        None => Ok(()),
        Some(i) => Err(out_of_range(label, &format!("{what}[{i}]"), numbers[i])
            .expected(format!("a point number below {point_count}"))),
    }
}

fn out_of_range(label: CallLabel, what: &str, found: impl std::fmt::Display) -> Error {
    label.error(&format!("gave a number that is out of range: {what}")).got(found)
}

fn mixed_cells(
    types: Vec<u8>,
    offsets: Vec<i64>,
    connectivity: Vec<u32>,
    point_count: usize,
    label: CallLabel,
) -> Result<CellSet> {
    refuse_unset(&types, 1, "the types", label)?;
    refuse_unset(&offsets, 1, "the offsets", label)?;
    refuse_unset(&connectivity, 1, "the connectivity", label)?;
    let is_wrong = |&cell: &u8| cell == code::POLYHEDRON || CellType::from_code(cell).is_none();
    if let Some(i) = types.par_iter().with_min_len(CHUNK).position_first(is_wrong) {
        let error = out_of_range(label, &format!("types[{i}]"), types[i]);
        return Err(error.expected("a code of VTK's cells, polyhedra (42) excepted"));
    }
    let correction = |i: usize| match i {
        0 => (offsets[0] != 0).then(|| "0".to_string()),
        i if offsets[i] < offsets[i - 1] => Some(format!("at least {}, the one before", offsets[i - 1])),
        i if i + 1 == offsets.len() && offsets[i] != connectivity.len() as i64 => {
            Some(format!("{}, the count of the connectivity", connectivity.len()))
        }
        _ => None,
    };
    if let Some((i, expected)) = (0..offsets.len()).find_map(|i| Some((i, correction(i)?))) {
        return Err(out_of_range(label, &format!("offsets[{i}]"), offsets[i]).expected(expected));
    }
    let is_wrong = |i: &usize| {
        let expected = CellType::from_code(types[*i]).and_then(|cell| cell.point_count);
        expected.is_some_and(|expected| offsets[i + 1] - offsets[*i] != i64::from(expected))
    };
    if let Some(i) = (0..types.len()).into_par_iter().with_min_len(CHUNK).find_first(is_wrong) {
        let cell = CellType::from_code(types[i]).and_then(|cell| Some((cell.name, cell.point_count?)));
        let (name, expected) = cell.unwrap_or_default();
        let error = label.error(&format!("gave cell {i}, a {name}, another number of points than it has"));
        return Err(error.got(offsets[i + 1] - offsets[i]).expected(expected));
    }
    refuse_out_of_range(&connectivity, point_count, "connectivity_u32", label)?;
    let offsets = offsets.into_iter().map(|offset| offset as u64).collect();
    Ok(CellSet { types, offsets, connectivity, polyhedra: Vec::new() })
}
