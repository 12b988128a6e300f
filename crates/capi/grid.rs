//! Arrays of a caller to a grid, by the same steps as a file's, from borrowed memory.

use crate::guard::{null, optional_text, text};
use crate::structs::{Array as GivenArray, GridInfo, GridSource, read, stated_size};
use std::ffi::{c_int, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet::nodes::in_memory_grid::HostGrid;
use voltet::{CellArrays, PointNumbers, add_array, borrowed_piece, build_grid, unnamed_scalar};
use voltet_core::grid::{Array, CellValues, Options, RawGrid, extent};
use voltet_core::{Error, Result, SharedSlice, counted};

/// `voltet_grid`.
pub struct GridHandle {
    pub(crate) grid: Arc<HostGrid>,
    /// Memory that was copied is bound by the caller's promise, too, until the handle is dropped.
    _lender: Arc<Lender>,
}

/// Owner of the memory, whose function `release` is called after the last use.
struct Lender {
    release: Option<unsafe extern "C" fn(*mut c_void)>,
    user: *mut c_void,
    /// True once there is a grid: a call that fails keeps no memory.
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

/// Builds a grid.
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
    let (pieces, scalar) = unsafe {
        let mut pieces = vec![piece(&source, &keep)?];
        for number in 0..source.further_piece_count {
            let further = source.further_pieces.byte_add(number * source.size);
            pieces.push(piece(&read(further)?, &keep)?);
        }
        (pieces, optional_text(source.scalar, "the name of the scalar")?)
    };
    let options = Options {
        subdivision: subdivision(source.subdivision)?,
        cell_values: match source.constant_cells {
            0 => CellValues::Average,
            _ => CellValues::Constant,
        },
        ..Options::default()
    };
    let grid = build_grid(pieces, scalar, &options)?;
    if grid.whole().scalar.is_none() {
        return Err(unnamed_scalar(grid.whole()));
    }
    lender.armed.store(true, Ordering::Relaxed);
    Ok(GridHandle { grid: Arc::new(grid), _lender: lender })
}

impl GridHandle {
    /// Counts, bounds and bytes.
    pub(crate) fn info(&self, size: usize) -> GridInfo {
        let grid = self.grid.whole();
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

/// Borrowed and owned bytes.
fn bytes<T>(values: &SharedSlice<T>) -> [u64; 2] {
    let bytes = size_of_val(values.as_slice()) as u64;
    if values.is_lent() { [bytes, 0] } else { [0, bytes] }
}

/// Pieces along a curved edge; 0 stands for 1.
fn subdivision(pieces: c_int) -> Result<u32> {
    let wrong = |_| {
        let error = Error::usage("subdivision is out of range").got(pieces);
        error.expected("0 for none, or 1 to 64 pieces")
    };
    u32::try_from(pieces).map(|pieces| pieces.max(1)).map_err(wrong)
}

/// Number of values of a count of tuples.
fn product(count: usize, each: usize, what: &str) -> Result<usize> {
    let numbers = count.checked_mul(each).filter(|&numbers| numbers <= isize::MAX as usize / 8);
    numbers.ok_or_else(|| {
        Error::usage(format!("the count of {what} is out of range"))
            .got(format!("{count} of {}", counted(each, "number")))
            .expected("what memory can hold")
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
        return Err(null(what).got(format!("a null pointer for {}", counted(count, "number"))));
    }
    if !values.is_aligned() {
        return Err(Error::usage(format!("{what} are at an odd address"))
            .got(format!("{values:p}"))
            .expected(format!("a multiple of {}", align_of::<T>())));
    }
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(Error::usage(format!("the count of {what} is out of range")).got(count));
    }
    // SAFETY: not null, aligned, of a size that an object can have; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(values, count) })
}

/// # Safety
/// As of [`make`].
unsafe fn piece(source: &GridSource, keep: &Arc<dyn Send + Sync>) -> Result<RawGrid> {
    // SAFETY: the caller's promise for all of these.
    unsafe {
        let points = lent(source.points, product(source.point_count, 3, "points")?, "points")?;
        let mut piece = borrowed_piece(points, cells(source)?, keep)?;
        add_arrays(&mut piece, source, keep)?;
        piece.ghost = optional(source.ghost, source.cell_count, "ghost")?.map(<[u8]>::to_vec);
        piece.global_ids =
            optional(source.global_ids, source.point_count, "global_ids")?.map(<[i64]>::to_vec);
        let degrees = optional(source.degrees, product(source.cell_count, 3, "degrees")?, "degrees")?;
        piece.degrees = degrees.map(|degrees| degrees.as_chunks::<3>().0.to_vec());
        Ok(piece)
    }
}

/// # Safety
/// As of [`make`].
unsafe fn add_arrays(piece: &mut RawGrid, source: &GridSource, keep: &Arc<dyn Send + Sync>) -> Result<()> {
    if source.array_count == 0 {
        return Err(Error::usage("the grid has no arrays").expected("at least the scalar that is drawn"));
    }
    // SAFETY: the caller's promise.
    let stride = unsafe { stated_size(source.arrays) }?;
    product(source.array_count, stride, "arrays")?;
    for number in 0..source.array_count {
        // SAFETY: so many structs of the first one's size stand there.
        let array: GivenArray = unsafe { read(source.arrays.byte_add(number * stride)) }?;
        if array.size != stride {
            return Err(Error::usage(format!("array {number} has another size than the first"))
                .got(array.size)
                .expected(stride));
        }
        // SAFETY: the caller's promise.
        let name = unsafe { text(array.name, &format!("the name of array {number}")) }?;
        let components = array.component_count;
        if name.is_empty() || components == 0 {
            let error = Error::usage(format!(
                "array {number} has no {}",
                if name.is_empty() { "name" } else { "components" }
            ));
            return Err(error.expected("a name, and at least 1 component"));
        }
        let per_cell = array.on_cells != 0;
        let tuples = if per_cell { source.cell_count } else { source.point_count };
        let count = product(tuples, components, &format!("array '{name}'"))?;
        // SAFETY: the caller's promise.
        let values = unsafe { lent(array.values, count, &format!("array '{name}'")) }?;
        let values = SharedSlice::from_borrowed(values, keep.clone());
        add_array(piece, name, Array { component_count: components, values }, per_cell)?;
    }
    Ok(())
}

/// # Safety
/// As of [`make`].
unsafe fn cells(source: &GridSource) -> Result<CellArrays<'static>> {
    let count = source.cell_count;
    match (source.tetrahedra.is_null(), source.types.is_null()) {
        (false, true) => {
            // SAFETY: the caller's promise.
            let numbers = unsafe { lent(source.tetrahedra, product(count, 4, "tetrahedra")?, "tetrahedra") }?;
            Ok(CellArrays::Tetrahedra(numbers))
        }
        // SAFETY: the caller's promise.
        (true, false) => unsafe { mixed(source) },
        (both, _) => Err(Error::usage("the grid's cells are not stated")
            .got(if both { "neither tetrahedra nor types" } else { "both tetrahedra and types" })
            .expected("either tetrahedra, or types, offsets and connectivity")),
    }
}

/// # Safety
/// As of [`make`].
unsafe fn mixed(source: &GridSource) -> Result<CellArrays<'static>> {
    let count = source.cell_count;
    let offset_count =
        count.checked_add(1).ok_or_else(|| Error::usage("the count of cells is out of range").got(count))?;
    let total = source.connectivity_count;
    let connectivity = match (source.connectivity.is_null(), source.connectivity_u32.is_null()) {
        // SAFETY: the caller's promise.
        (true, _) => PointNumbers::U32(unsafe { lent(source.connectivity_u32, total, "connectivity") }?),
        // SAFETY: as before.
        (false, true) => PointNumbers::I64(unsafe { lent(source.connectivity, total, "connectivity") }?),
        (false, false) => {
            let error = Error::usage("the connectivity is stated twice");
            return Err(error.expected("connectivity or connectivity_u32, the other null"));
        }
    };
    // SAFETY: as before.
    unsafe {
        Ok(CellArrays::Mixed {
            types: lent(source.types, count, "types")?,
            offsets: lent(source.offsets, offset_count, "offsets")?,
            connectivity,
            faces: lent(source.faces, source.faces_count, "faces")?,
            face_locations: match source.face_locations.is_null() {
                true => &[],
                false => lent(source.face_locations, count, "face_locations")?,
            },
        })
    }
}

/// # Safety
/// As of [`make`].
unsafe fn optional<T>(values: *const T, count: usize, what: &str) -> Result<Option<&'static [T]>> {
    if values.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe { lent(values, count, what) }.map(Some)
}
