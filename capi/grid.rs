//! A caller's arrays to a grid: by the same steps as a file's, from memory that is lent.

use crate::guard::{null, optional_text, text};
use crate::structs::{Array as GivenArray, GridInfo, GridSource, read, stated_size};
use glam::DVec3;
use rayon::prelude::*;
use std::ffi::{c_int, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::grid::{
    self, Array, CellSet, CellValues, Cells, Grid, Options, Parts, Polyhedron, code, extent,
};
use voltet_core::progress::Silent;
use voltet_core::{Error, Result, Shared};
use voltet_nodes::formats::face_stream;

/// `voltet_grid`.
pub struct GridHandle {
    pub(crate) grid: Arc<Grid>,
    /// Memory that was copied is the caller's promise, too, until the handle goes.
    _lender: Arc<Lender>,
}

/// Whose memory it is: told when nobody needs it any more.
struct Lender {
    release: Option<unsafe extern "C" fn(*mut c_void)>,
    user: *mut c_void,
    /// Not before there is a grid: what fails has taken nothing.
    armed: AtomicBool,
}

// SAFETY: the caller's promise: `release` may be called from any thread.
unsafe impl Send for Lender {}
// SAFETY: as above.
unsafe impl Sync for Lender {}

impl Drop for Lender {
    fn drop(&mut self) {
        if let Some(release) = self.release.filter(|_| *self.armed.get_mut()) {
            // SAFETY: the caller's function with the caller's address, once.
            unsafe { release(self.user) }
        }
    }
}

/// Makes a grid.
///
/// # Safety
/// `source` is null or a struct whose addresses hold as much as its counts say, unchanged until its release.
pub(crate) unsafe fn make(source: *const GridSource) -> Result<GridHandle> {
    // SAFETY: the caller's promise.
    let source = unsafe { read(source) }?;
    let lender =
        Arc::new(Lender { release: source.release, user: source.user, armed: AtomicBool::new(false) });
    let keep: Arc<dyn Send + Sync> = lender.clone();
    // SAFETY: the caller's promise for all of these.
    let grid = unsafe {
        let points: &'static [DVec3] =
            points_of(lent(source.points, product(source.point_count, 3, "points")?, "points")?);
        let mut parts = Parts::new(Shared::lent(points, keep.clone()), cells(&source)?);
        arrays(&source, &keep, &mut parts)?;
        parts.ghost = flags(source.ghost, source.cell_count, "ghost")?;
        parts.degrees = degrees(&source)?;
        let scalar = scalar(&source, &parts)?;
        let subdivision = subdivision(source.subdivision)?;
        let constant = source.constant_cells != 0;
        let cell_values = if constant { CellValues::Constant } else { CellValues::Average };
        let mut grid = grid::build(parts, &Options { subdivision, cell_values, keep_cells: false }, &Silent)?;
        // Such as were ascending already need not stand twice.
        if let Ok(own) = lent(source.tetrahedra, source.cell_count.saturating_mul(4), "tetrahedra") {
            let (own, _) = own.as_chunks::<4>();
            if grid.tetrahedra.as_slice() == own {
                grid.tetrahedra = Shared::lent(own, keep);
            }
        }
        grid.scalar = grid.point_arrays.get(&scalar).map(|array| array.values.clone());
        grid.scalar_name = scalar;
        grid
    };
    lender.armed.store(true, Ordering::Relaxed);
    Ok(GridHandle { grid: Arc::new(grid), _lender: lender })
}

impl GridHandle {
    /// What is known of it.
    pub(crate) fn info(&self, size: usize) -> GridInfo {
        let grid = &self.grid;
        let [low, high] = grid.bounds().unwrap_or_default();
        let arrays = grid.point_arrays.values().map(|array| bytes(&array.values));
        let all = arrays.chain([bytes(&grid.points), bytes(&grid.tetrahedra)]);
        let [bytes_lent, bytes_copied] = all.fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
        GridInfo {
            size,
            point_count: grid.points.len() as u64,
            tetrahedron_count: grid.tetrahedra.len() as u64,
            bytes_lent,
            bytes_copied,
            low: low.into(),
            high: high.into(),
            scalar: grid.scalar.as_ref().and_then(|values| extent::range(values)).unwrap_or([f64::NAN; 2]),
        }
    }
}

/// Bytes that are lent, and that are owned.
fn bytes<T>(values: &Shared<T>) -> [u64; 2] {
    let bytes = size_of_val(values.as_slice()) as u64;
    if values.is_lent() { [bytes, 0] } else { [0, bytes] }
}

/// Pieces along a curved edge; 0 stands for 1.
fn subdivision(pieces: c_int) -> Result<u32> {
    let wrong = |_| {
        let error = Error::usage("subdivision is out of range").found(pieces);
        error.accepted("0 for none, or 1 to 64 pieces")
    };
    u32::try_from(pieces).map(|pieces| pieces.max(1)).map_err(wrong)
}

/// How many numbers a count of tuples means.
fn product(count: usize, each: usize, what: &str) -> Result<usize> {
    let numbers = count.checked_mul(each).filter(|&numbers| numbers <= isize::MAX as usize / 8);
    numbers.ok_or_else(|| {
        Error::usage(format!("the count of {what} is out of range"))
            .found(format!("{count} of {each} numbers"))
            .accepted("what memory can hold")
    })
}

/// A caller's numbers.
///
/// # Safety
/// `values` is null or holds `count` numbers that stay as they are until the grid is released.
unsafe fn lent<T>(values: *const T, count: usize, what: &str) -> Result<&'static [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    if values.is_null() {
        return Err(null(what).found(format!("a null pointer for {count} numbers")));
    }
    if !values.is_aligned() {
        return Err(Error::usage(format!("{what} are at an odd address"))
            .found(format!("{values:p}"))
            .accepted(format!("a multiple of {}", align_of::<T>())));
    }
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(Error::usage(format!("the count of {what} is out of range")).found(count));
    }
    // SAFETY: not null, aligned, of a size that an object can have; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(values, count) })
}

/// Three numbers a point.
fn points_of(numbers: &'static [f64]) -> &'static [DVec3] {
    // SAFETY: a DVec3 is three f64 one after the other, aligned as one; `glam` says so by `Pod`.
    unsafe { std::slice::from_raw_parts(numbers.as_ptr().cast(), numbers.len() / 3) }
}

/// # Safety
/// As of [`make`].
unsafe fn arrays(source: &GridSource, keep: &Arc<dyn Send + Sync>, parts: &mut Parts) -> Result<()> {
    if source.array_count == 0 {
        return Err(Error::usage("the grid has no arrays").accepted("at least the scalar that is drawn"));
    }
    // SAFETY: the caller's promise.
    let stride = unsafe { stated_size(source.arrays) }?;
    product(source.array_count, stride, "arrays")?;
    for number in 0..source.array_count {
        // SAFETY: so many structs of the first one's size stand there.
        let array: GivenArray = unsafe { read(source.arrays.byte_add(number * stride)) }?;
        if array.size != stride {
            return Err(Error::usage(format!("array {number} has another size than the first"))
                .found(array.size)
                .accepted(stride));
        }
        // SAFETY: the caller's promise.
        let name = unsafe { text(array.name, &format!("the name of array {number}")) }?;
        let components = array.component_count;
        if name.is_empty() || components == 0 {
            let error = Error::usage(format!(
                "array {number} has no {}",
                if name.is_empty() { "name" } else { "components" }
            ));
            return Err(error.accepted("a name, and at least 1 component"));
        }
        let per_cell = array.on_cells != 0;
        let tuples = if per_cell { source.cell_count } else { source.point_count };
        let count = product(tuples, components, &format!("array '{name}'"))?;
        // SAFETY: the caller's promise.
        let values = unsafe { lent(array.values, count, &format!("array '{name}'")) }?;
        let values = Array { component_count: components, values: Shared::lent(values, keep.clone()) };
        if parts.point_arrays.contains_key(name) || parts.cell_arrays.contains_key(name) {
            return Err(Error::usage("two arrays have the same name").found(format!("'{name}'")));
        }
        let arrays = if per_cell { &mut parts.cell_arrays } else { &mut parts.point_arrays };
        arrays.insert(name.to_string(), values);
    }
    Ok(())
}

/// The name of the array that is drawn.
///
/// # Safety
/// As of [`make`].
unsafe fn scalar(source: &GridSource, parts: &Parts) -> Result<String> {
    let all = || parts.point_arrays.iter().chain(&parts.cell_arrays);
    let scalars: Vec<&str> =
        all().filter(|(_, array)| array.component_count == 1).map(|(name, _)| name.as_str()).collect();
    // SAFETY: the caller's promise.
    let wanted = unsafe { optional_text(source.scalar, "the name of the scalar") }?;
    let accepted = match scalars.is_empty() {
        true => "an array of one component".to_string(),
        false => format!("an array of one component: {}", scalars.join(", ")),
    };
    match wanted {
        Some(name) if scalars.contains(&name) => Ok(name.to_string()),
        Some(name) => {
            let found = match all().find(|(known, _)| *known == name) {
                Some((_, array)) => format!("'{name}' of {} components", array.component_count),
                None => format!("'{name}'"),
            };
            Err(Error::usage("the grid has no such scalar").found(found).accepted(accepted))
        }
        None => match scalars[..] {
            [only] => Ok(only.to_string()),
            _ => Err(Error::usage("the scalar is not named").accepted(accepted)),
        },
    }
}

/// # Safety
/// As of [`make`].
unsafe fn cells(source: &GridSource) -> Result<Cells> {
    let count = source.cell_count;
    match (source.tetrahedra.is_null(), source.types.is_null()) {
        (false, true) => {
            // SAFETY: the caller's promise.
            let numbers = unsafe { lent(source.tetrahedra, product(count, 4, "tetrahedra")?, "tetrahedra") }?;
            Ok(Cells::Tetrahedra(numbers.as_chunks::<4>().0.to_vec()))
        }
        // SAFETY: the caller's promise.
        (true, false) => unsafe { mixed(source) },
        (both, _) => Err(Error::usage("the grid's cells are not stated")
            .found(if both { "neither tetrahedra nor types" } else { "both tetrahedra and types" })
            .accepted("either tetrahedra, or types, offsets and connectivity")),
    }
}

/// # Safety
/// As of [`make`].
unsafe fn mixed(source: &GridSource) -> Result<Cells> {
    let count = source.cell_count;
    let offset_count = count
        .checked_add(1)
        .ok_or_else(|| Error::usage("the count of cells is out of range").found(count))?;
    // SAFETY: the caller's promise.
    let types = unsafe { lent(source.types, count, "types") }?;
    // SAFETY: as before.
    let offsets = unsafe { lent(source.offsets, offset_count, "offsets") }?;
    let total = source.connectivity_count;
    check_offsets(offsets, total)?;
    let connectivity = match (source.connectivity.is_null(), source.connectivity_u32.is_null()) {
        // SAFETY: as before.
        (true, _) => unsafe { lent(source.connectivity_u32, total, "connectivity") }?.to_vec(),
        (false, true) => {
            // SAFETY: as before.
            let wide = unsafe { lent(source.connectivity, total, "connectivity") }?;
            point_numbers(wide, "connectivity")?
        }
        (false, false) => {
            let error = Error::usage("the connectivity is stated twice");
            return Err(error.accepted("connectivity or connectivity_u32, the other null"));
        }
    };
    let plain = types.par_iter().all(|&t| t == code::TETRA)
        && offsets.par_iter().enumerate().all(|(i, &offset)| offset as usize == 4 * i);
    if plain && count > 0 {
        return Ok(Cells::Tetrahedra(connectivity.as_chunks::<4>().0[..count].to_vec()));
    }
    let offsets = offsets.iter().map(|&offset| offset as u64).collect();
    // SAFETY: as before.
    let polyhedra = unsafe { polyhedra(source, types) }?;
    Ok(Cells::Mixed(CellSet { types: types.to_vec(), offsets, connectivity, polyhedra }))
}

/// That offsets begin at 0 or above, never descend, and end within the connectivity.
fn check_offsets(offsets: &[i64], total: usize) -> Result<()> {
    let wrong = |number: usize, accepted: String| {
        let error = Error::usage(format!("offsets[{number}] is wrong")).found(offsets[number]);
        Err(error.accepted(accepted))
    };
    if offsets[0] < 0 {
        return wrong(0, "0 or more".into());
    }
    if let Some(number) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        return wrong(number + 1, format!("at least {}, the one before", offsets[number]));
    }
    match offsets.iter().position(|&offset| offset as u64 > total as u64) {
        Some(number) => wrong(number, format!("at most {total}, the count of the connectivity")),
        None => Ok(()),
    }
}

/// Point numbers in 32 bits.
fn point_numbers(numbers: &[i64], what: &str) -> Result<Vec<u32>> {
    if let Some(place) = numbers.par_iter().position_first(|&number| u32::try_from(number).is_err()) {
        return Err(Error::usage(format!("{what}[{place}] is no number of a point"))
            .found(numbers[place])
            .accepted(format!("0 to {}", u32::MAX)));
    }
    Ok(numbers.par_iter().map(|&number| number as u32).collect())
}

/// The faces of the cells of type 42: at each one's place the number of faces, then each face's count and points.
///
/// # Safety
/// As of [`make`].
unsafe fn polyhedra(source: &GridSource, types: &[u8]) -> Result<Vec<Polyhedron>> {
    let mut polyhedra = Vec::new();
    if !types.contains(&code::POLYHEDRON) {
        return Ok(polyhedra);
    }
    // SAFETY: the caller's promise.
    let (faces, places) = unsafe {
        let faces = lent(source.faces, source.faces_count, "faces")?;
        (point_numbers(faces, "faces")?, lent(source.face_locations, types.len(), "face_locations")?)
    };
    for (number, _) in types.iter().enumerate().filter(|(_, t)| **t == code::POLYHEDRON) {
        let damaged = || {
            Error::usage(format!("the faces of cell {number}, a polyhedron, are damaged"))
                .found(format!("face_locations[{number}] = {} of {} numbers", places[number], faces.len()))
                .accepted(
                    "the place of its number of faces, then each face's count and points, all within faces",
                )
        };
        let own =
            usize::try_from(places[number]).ok().and_then(|place| faces.get(place..)).ok_or_else(damaged)?;
        let faces = face_stream(own, number).map_err(|_| damaged())?;
        polyhedra.push(Polyhedron { cell: number as u32, faces });
    }
    Ok(polyhedra)
}

/// # Safety
/// As of [`make`].
unsafe fn degrees(source: &GridSource) -> Result<Option<Vec<[u8; 3]>>> {
    if source.degrees.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    let degrees = unsafe { lent(source.degrees, product(source.cell_count, 3, "degrees")?, "degrees") }?;
    Ok(Some(degrees.as_chunks::<3>().0.to_vec()))
}

/// # Safety
/// As of [`make`].
unsafe fn flags(flags: *const u8, count: usize, what: &str) -> Result<Option<Vec<bool>>> {
    if flags.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    Ok(Some(unsafe { lent(flags, count, what) }?.iter().map(|&flag| flag != 0).collect()))
}
