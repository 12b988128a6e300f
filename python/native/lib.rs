//! voltet._native: the native part of the Python module `voltet`.
//!
//! The package's Python files hold the documentation for users and the numpy side of arrays.

mod background;
mod command;
mod declarations;
mod error;
mod filter;
mod frames;
mod grid;
mod measurements;
mod memory;
mod picture_axes;
mod pipeline;
mod reader;
mod state;
mod value;

use pyo3::prelude::*;

/// The program `voltet` reports the end of memory as cargo's does; in any other process of Python nothing changes.
#[global_allocator]
static ALLOCATOR: voltet::ExitOnOutOfMemory = voltet::ExitOnOutOfMemory;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::command::main;
    #[pymodule_export]
    use super::declarations::declarations;
    #[pymodule_export]
    use super::filter::register_filter;
    #[pymodule_export]
    use super::grid::Grid;
    #[pymodule_export]
    use super::measurements::gradient_test;
    #[pymodule_export]
    use super::memory::encode;
    #[pymodule_export]
    use super::pipeline::Pipeline;
    #[pymodule_export]
    use super::pipeline::Report;
    #[pymodule_export]
    use super::reader::register_reader;

    /// The version of the program.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
