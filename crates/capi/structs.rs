//! Structs of `include/voltet.h`, field by field, and reading them from a caller. `tests/c` compares sizes and offsets.
#![allow(missing_docs)]

use crate::guard::null;
use std::ffi::{c_char, c_int, c_void};
use voltet_core::{Error, Result, counted};

/// `voltet_array`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Array {
    pub size: usize,
    pub name: *const c_char,
    pub values: *const f64,
    pub component_count: usize,
    pub on_cells: c_int,
}

/// `voltet_grid_source`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridSource {
    pub size: usize,
    pub point_count: usize,
    pub points: *const f64,
    pub array_count: usize,
    pub arrays: *const Array,
    pub scalar: *const c_char,
    pub cell_count: usize,
    pub tetrahedra: *const u32,
    pub types: *const u8,
    pub offsets: *const i64,
    pub connectivity: *const i64,
    pub connectivity_u32: *const u32,
    pub connectivity_count: usize,
    pub faces: *const i64,
    pub face_locations: *const i64,
    pub faces_count: usize,
    pub degrees: *const u8,
    pub ghost: *const u8,
    pub subdivision: c_int,
    pub constant_cells: c_int,
    pub release: Option<unsafe extern "C" fn(*mut c_void)>,
    pub user: *mut c_void,
    pub global_ids: *const i64,
    pub further_pieces: *const GridSource,
    pub further_piece_count: usize,
}

/// `voltet_grid_info`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridInfo {
    pub size: usize,
    pub point_count: u64,
    pub tetrahedron_count: u64,
    pub bytes_lent: u64,
    pub bytes_copied: u64,
    pub low: [f64; 3],
    pub high: [f64; 3],
    pub scalar: [f64; 2],
}

/// `voltet_camera`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Camera {
    pub size: usize,
    pub eye: [f64; 3],
    pub target: [f64; 3],
    pub up: [f64; 3],
    pub fov_y: f64,
    pub height: f64,
    pub near_plane: f64,
    pub pixels: [u32; 2],
    pub samples: u32,
}

/// `voltet_image`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Image {
    pub size: usize,
    pub width: usize,
    pub height: usize,
    pub rgba: *mut f32,
    pub rgba_stride: usize,
    pub srgb: *mut u8,
    pub srgb_stride: usize,
    pub background: [f64; 3],
}

/// `voltet_follow`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Follow {
    pub size: usize,
    pub user: *mut c_void,
    pub progress: Option<unsafe extern "C" fn(*mut c_void, *const c_char, *const c_char, f64)>,
    pub cancelled: Option<unsafe extern "C" fn(*mut c_void) -> c_int>,
}

/// A struct of a caller: all its fields are numbers and addresses, for which zero bytes are values.
///
/// # Safety
/// All bytes are values of the type, and its first field is the size.
pub(crate) unsafe trait Sized0: Copy {
    /// Its name in the header.
    const NAME: &'static str;
}

macro_rules! sized {
    ($($name:ident $header_name:literal)*) => {
        // SAFETY: the fields above.
        $(unsafe impl Sized0 for $name {
            const NAME: &'static str = $header_name;
        })*
    };
}

sized! {
    Array "voltet_array"
    GridSource "voltet_grid_source"
    GridInfo "voltet_grid_info"
    Camera "voltet_camera"
    Image "voltet_image"
    Follow "voltet_follow"
}

/// Largest size of a struct of any version (bytes): a larger one is memory that was not set.
const MAX_SIZE: usize = 4096;

/// The size that a caller's struct states, if it can be one.
///
/// # Safety
/// `from` is null or holds a size.
pub(crate) unsafe fn stated_size<T: Sized0>(from: *const T) -> Result<usize> {
    if from.is_null() {
        return Err(null(T::NAME));
    }
    // SAFETY: the caller's promise; structs of C may stand anywhere.
    let size = unsafe { from.cast::<usize>().read_unaligned() };
    if !(size_of::<T>()..=MAX_SIZE).contains(&size) {
        return Err(Error::usage(format!("the size of a {} is wrong", T::NAME)).got(size).expected(format!(
            "size = sizeof({}), {} here",
            T::NAME,
            size_of::<T>()
        )));
    }
    Ok(size)
}

/// A caller's struct. Fields that a newer header has must be 0, as this library does not know them.
///
/// # Safety
/// `from` is null or holds as many bytes as its size says.
pub(crate) unsafe fn read<T: Sized0>(from: *const T) -> Result<T> {
    // SAFETY: the caller's promise.
    let size = unsafe { stated_size(from) }?;
    // SAFETY: so many bytes are there.
    let newer = unsafe { std::slice::from_raw_parts(from.cast::<u8>(), size) };
    if newer[size_of::<T>()..].iter().any(|&byte| byte != 0) {
        return Err(Error::usage(format!("a {} has fields that this library does not know", T::NAME))
            .got(counted(size, "byte"))
            .expected(format!("0 in all beyond {} bytes, or a newer library", size_of::<T>())));
    }
    // SAFETY: it is all there, and any bytes are values of it.
    Ok(unsafe { from.read_unaligned() })
}
