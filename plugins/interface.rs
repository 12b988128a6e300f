//! The structs and constants of `include/voltet_plugin.h`, which says what they mean. A test compares the layout of both.

use std::ffi::{c_char, c_void};

pub const MAJOR: u32 = 1;
pub const MINOR: u32 = 0;
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
pub const ABOVE_LEAST: u32 = 2;
pub const BELOW_MOST: u32 = 4;

pub const NEEDS_NEIGHBOURS: u32 = 1;
pub const NEEDS_CELLS_OF_POINTS: u32 = 2;

pub const GRADIENT_FILTERS: &std::ffi::CStr = c"voltet.gradient-filters/1";

/// The exported symbol.
pub const ENTRY: &str = "voltet_plugin_entry";

// What unwinds out of a plug-in ends the program in a defined way: hence "C-unwind".
pub type LoopBody = unsafe extern "C-unwind" fn(*mut c_void, u64, u64, u32);
pub type Init = unsafe extern "C-unwind" fn(*const c_char, *const Host) -> *const Plugin;
pub type Deinit = unsafe extern "C-unwind" fn();
pub type GetFactory = unsafe extern "C-unwind" fn(*const c_char) -> *const c_void;
pub type FilterCount = unsafe extern "C-unwind" fn() -> u32;
pub type FilterAt = unsafe extern "C-unwind" fn(u32) -> *const GradientFilter;
pub type Check = unsafe extern "C-unwind" fn(*const Values, *const Host) -> i32;
pub type Gradient = unsafe extern "C-unwind" fn(*const Call, *const Host) -> i32;

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
pub struct Parameter {
    pub size: u32,
    pub parameter_type: u32,
    pub name: *const c_char,
    pub unit: *const c_char,
    pub help: *const c_char,
    pub flags: u32,
    pub length: u32,
    pub least: f64,
    pub most: f64,
    pub number: f64,
    pub text: *const c_char,
    pub numbers: *const f64,
    pub unset: *const c_char,
    pub word_count: u32,
    pub reserved: u32,
    pub words: *const *const c_char,
    pub meanings: *const *const c_char,
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
pub struct Call {
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
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct GradientFilter {
    pub size: u32,
    pub needs: u32,
    pub name: *const c_char,
    pub summary: *const c_char,
    pub parameter_count: u32,
    pub reserved: u32,
    pub parameters: *const Parameter,
    pub check: Option<Check>,
    pub gradient: Option<Gradient>,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct GradientFactory {
    pub size: u32,
    pub reserved: u32,
    pub filter_count: Option<FilterCount>,
    pub filter: Option<FilterAt>,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Plugin {
    pub size: u32,
    pub reserved: u32,
    pub name: *const c_char,
    pub version: *const c_char,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Entry {
    pub size: u32,
    pub major: u32,
    pub minor: u32,
    pub patch: u32,
    pub init: Option<Init>,
    pub deinit: Option<Deinit>,
    pub get_factory: Option<GetFactory>,
}
