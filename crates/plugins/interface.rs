//! The structs and constants of `include/voltet_plugin.h`, which says what they mean. A test compares the layout of both. Structs that
//! a module in the sandbox has, too, are generic over the address space, which decides how wide a pointer is.

use crate::ffi::{AddressSpace, Process, Sized32};
use std::ffi::{CStr, c_char, c_void};

pub const MAJOR: u32 = 1;
pub const MINOR: u32 = 2;
pub const PATCH: u32 = 0;

pub const OK: i32 = 0;
pub const CANCELLED: i32 = 1;
pub const ERROR: i32 = 2;

pub const BOOLEAN: u32 = 1;
pub const INTEGER: u32 = 2;
pub const NUMBER: u32 = 3;
pub const CHOICE: u32 = 4;
pub const TEXT: u32 = 5;
pub const VECTOR: u32 = 6;
pub const POINT_ARRAY: u32 = 7;

pub const REQUIRED: u32 = 1;
pub const EXCLUSIVE_MIN: u32 = 2;
pub const EXCLUSIVE_MAX: u32 = 4;

pub const NEEDS_NEIGHBOURS: u32 = 1;
pub const NEEDS_CELLS_OF_POINTS: u32 = 2;
pub const NEEDS_BOUNDARY: u32 = 4;
pub const NEEDS_SECOND_RINGS: u32 = 8;

pub const TETRAHEDRA: u32 = 1;
pub const SAME_POINTS: u32 = 2;
pub const SAME_CELLS: u32 = 4;

pub const GRADIENT_FILTERS: &CStr = c"voltet.gradient-filters/1";
pub const READERS: &CStr = c"voltet.readers/1";
pub const GRID_FILTERS: &CStr = c"voltet.grid-filters/1";
pub const IMAGE_FILTERS: &CStr = c"voltet.image-filters/1";

/// The exported symbol.
pub const ENTRY: &str = "voltet_plugin_entry";

// What unwinds out of a plug-in ends the program in a defined way: hence "C-unwind".
pub type LoopBody = unsafe extern "C-unwind" fn(*mut c_void, u64, u64, u32);
pub type Init = unsafe extern "C-unwind" fn(*const c_char, *const Host) -> *const Plugin;
pub type Deinit = unsafe extern "C-unwind" fn();
pub type GetFactory = unsafe extern "C-unwind" fn(*const c_char) -> *const c_void;
pub type Count = unsafe extern "C-unwind" fn() -> u32;
pub type At = unsafe extern "C-unwind" fn(u32) -> *const c_void;
pub type Check = unsafe extern "C-unwind" fn(*const Values, *const Host) -> i32;
pub type Gradient = unsafe extern "C-unwind" fn(*const GradientCall, *const Host) -> i32;
pub type Read = unsafe extern "C-unwind" fn(*const Reading, *const Host) -> i32;
pub type FilterGrid = unsafe extern "C-unwind" fn(*const GridCall, *const Host) -> i32;
pub type FilterImage = unsafe extern "C-unwind" fn(*const ImageCall, *const Host) -> i32;
pub type DescribeGrid = unsafe extern "C-unwind" fn(*const Reading, *const GridHead) -> i32;
pub type BeginGrid = unsafe extern "C-unwind" fn(*const GridCall, *const GridHead, *mut GridBuffers) -> i32;

#[repr(C)]
pub struct Host {
    pub size: u32,
    pub major: u32,
    pub minor: u32,
    pub patch: u32,
    pub thread_count: u32,
    pub reserved: u32,
    pub program: *const c_char,
    pub context: *mut c_void,
    pub progress: unsafe extern "C-unwind" fn(*const Host, f64),
    pub cancelled: unsafe extern "C-unwind" fn(*const Host) -> i32,
    pub error: unsafe extern "C-unwind" fn(*const Host, *const c_char),
    pub fallback: unsafe extern "C-unwind" fn(*const Host, *const c_char, u64),
    pub parallel_for:
        unsafe extern "C-unwind" fn(*const Host, u64, u64, Option<LoopBody>, *mut c_void) -> i32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Parameter<A: AddressSpace = Process> {
    pub size: u32,
    pub parameter_type: u32,
    pub name: A::Address,
    pub unit: A::Address,
    pub help: A::Address,
    pub flags: u32,
    pub length: u32,
    pub min: f64,
    pub max: f64,
    pub number: f64,
    pub text: A::Address,
    pub numbers: A::Address,
    pub unset: A::Address,
    pub word_count: u32,
    pub reserved: u32,
    pub words: A::Address,
    pub meanings: A::Address,
}

#[repr(C)]
pub struct Values {
    pub size: u32,
    pub count: u32,
    pub integers: *const i64,
    pub numbers: *const f64,
    pub texts: *const *const c_char,
    pub vectors: *const *const f64,
    pub lengths: *const u32,
}

#[repr(C)]
pub struct GradientCall {
    pub size: u32,
    pub reserved: u32,
    pub point_count: u64,
    pub cell_count: u64,
    pub points: *const f64,
    pub cells: *const u32,
    pub neighbour_starts: *const u64,
    pub neighbours: *const u32,
    pub cell_starts: *const u64,
    pub cells_of_points: *const u32,
    pub scalar: *const f64,
    pub arrays: *const *const f64,
    pub values: *const Values,
    pub gradient: *mut f64,
    pub at_boundary: *const u8,
    pub second_ring_starts: *const u64,
    pub second_rings: *const u32,
}

/// Fields that the descriptions of all items begin with.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Item<A: AddressSpace = Process> {
    pub size: u32,
    /// `needs` of a gradient filter, else reserved.
    pub needs: u32,
    pub name: A::Address,
    pub summary: A::Address,
    pub parameter_count: u32,
    /// `extension_count` of a reader, `made_count` of a grid filter, else reserved.
    pub name_count: u32,
    pub parameters: A::Address,
    pub check: A::Function<Check>,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct GradientFilter<A: AddressSpace = Process> {
    pub item: Item<A>,
    pub gradient: A::Function<Gradient>,
}

/// A factory of any kind: they are alike but for what the descriptions are.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Factory<A: AddressSpace = Process> {
    pub size: u32,
    pub reserved: u32,
    pub count: A::Function<Count>,
    pub at: A::Function<At>,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct ArrayHead {
    pub size: u32,
    pub component_count: u32,
    pub name: usize,
    pub on_cells: u32,
    pub reserved: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridHead {
    pub size: u32,
    pub flags: u32,
    pub point_count: u64,
    pub cell_count: u64,
    pub connectivity_count: u64,
    pub array_count: u32,
    pub step_count: u32,
    pub arrays: usize,
    pub scalar: usize,
    pub times: usize,
    pub format: usize,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridBuffers {
    pub size: u32,
    pub array_count: u32,
    pub point_count: u64,
    pub cell_count: u64,
    pub connectivity_count: u64,
    pub points: *mut f64,
    pub tetrahedra: *mut u32,
    pub types: *mut u8,
    pub offsets: *mut i64,
    pub connectivity_u32: *mut u32,
    pub arrays: *const *mut f64,
}

#[repr(C)]
pub struct Reading {
    pub size: u32,
    pub reserved: u32,
    pub path: *const c_char,
    pub step: u64,
    pub values: *const Values,
    pub describe: Option<DescribeGrid>,
    pub buffers: *const GridBuffers,
    pub context: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Reader {
    pub item: Item,
    pub inspect: Option<Read>,
    pub read: Option<Read>,
    pub extensions: usize,
    pub magic: usize,
    pub magic_length: u32,
    pub reserved: u32,
}

#[repr(C)]
pub struct GivenArray {
    pub size: u32,
    pub component_count: u32,
    pub name: *const c_char,
    pub values: *const f64,
}

#[repr(C)]
pub struct GridCall {
    pub size: u32,
    pub array_count: u32,
    pub point_count: u64,
    pub cell_count: u64,
    pub points: *const f64,
    pub tetrahedra: *const u32,
    pub carried: *const GivenArray,
    pub scalar: *const c_char,
    pub arrays: *const *const f64,
    pub values: *const Values,
    pub begin: BeginGrid,
    pub context: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridFilter {
    pub item: Item,
    pub filter: Option<FilterGrid>,
    pub made: usize,
}

#[repr(C)]
pub struct ImageCall {
    pub size: u32,
    pub reserved: u32,
    pub width: u64,
    pub height: u64,
    pub rgba: *const f32,
    pub values: *const Values,
    pub filtered: *mut f32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct ImageFilter {
    pub item: Item,
    pub filter: Option<FilterImage>,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Plugin<A: AddressSpace = Process> {
    pub size: u32,
    pub reserved: u32,
    pub name: A::Address,
    pub version: A::Address,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Entry<A: AddressSpace = Process> {
    pub size: u32,
    pub major: u32,
    pub minor: u32,
    pub patch: u32,
    pub init: A::Function<Init>,
    pub deinit: A::Function<Deinit>,
    pub get_factory: A::Function<GetFactory>,
}

macro_rules! sized32 {
    ($([$($space:ident)?] $kind:ident $name:literal)*) => {
        // SAFETY: numbers, raw pointers, optional functions.
        $(unsafe impl$(<$space: AddressSpace>)? Sized32 for $kind$(<$space>)? {
            const NAME: &'static str = $name;
        })*
    };
}

sized32! {
    [A] Entry "voltet_entry"
    [A] Plugin "voltet_plugin"
    [A] Factory "a factory"
    [A] GradientFilter "voltet_gradient_filter"
    [A] Parameter "voltet_parameter"
    [] Reader "voltet_reader"
    [] GridFilter "voltet_grid_filter"
    [] ImageFilter "voltet_image_filter"
    [] GridHead "voltet_grid_head"
    [] ArrayHead "voltet_array_head"
    [] GridBuffers "voltet_grid_buffers"
}
