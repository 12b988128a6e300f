//! The program `voltet` in the interpreter's process.

use pyo3::prelude::*;
use std::ffi::OsString;
use std::io::Write;

/// Carries out a command line (the file that starts the program, then arguments) once in a process: the exit code.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| {
        let exit_code = voltet::run_command_line(words, voltet::registry());
        // The interpreter ends the process, and knows nothing of this buffer.
        let _ = std::io::stdout().flush();
        exit_code
    })
}
