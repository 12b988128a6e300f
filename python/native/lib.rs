//! voltet._native: what the Python module `voltet` is made of that is not Python.
//!
//! | file | what |
//! | --- | --- |
//! | `pipeline`, `held` | a pipeline: its text changed, checked, drawn, saved |
//! | `grid` | a grid of lent arrays |
//! | `memory`, `watch` | arrays of Python that are lent, whether they are as they were, and arrays for Python |
//! | `numbers` | what is known at the points of a grid |
//! | `report` | what was done by a run |
//! | `filter` | gradient filters that are Python functions |
//! | `follow` | runs without the interpreter's lock, that Ctrl-C stops |
//! | `study`, `measured` | error against run time; one pixel; gradient filters |
//! | `until` | pictures of rays that end at surfaces of others |
//! | `declared` | what can be stated: node types, filters, widgets |
//! | `value` | values of parameters, from Python and to it |
//! | `error` | errors and panics as exceptions |
//!
//! What is told to users stands in the Python files of the package: docstrings, and numpy's side of arrays.

mod declared;
mod error;
mod filter;
mod follow;
mod grid;
mod held;
mod measured;
mod memory;
mod numbers;
mod pipeline;
mod report;
mod study;
mod until;
mod value;
mod watch;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use super::*;

    #[pymodule_export]
    use super::declared::declarations;
    #[pymodule_export]
    use super::filter::register_filter;
    #[pymodule_export]
    use super::grid::Grid;
    #[pymodule_export]
    use super::measured::gradient_test;
    #[pymodule_export]
    use super::memory::encode;
    #[pymodule_export]
    use super::pipeline::Pipeline;
    #[pymodule_export]
    use super::report::Report;

    /// Adds what the product's crates are without.
    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        voltet_reference::register();
        Ok(())
    }

    /// The version of the program.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
