//! The process of the program: its threads, its exit codes, its end.

use crate::core::{Error, Result};
use crate::nodes::files;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;

/// The exit code of a run that failed.
pub const FAILED: u8 = 1;

/// The command line of a program around this one.
static GIVEN: OnceLock<Vec<OsString>> = OnceLock::new();

/// Takes the command line of a program around this one in place of the process's own: the file to start it by, then arguments. The
/// first one holds.
pub fn give_command_line(words: Vec<OsString>) {
    let _ = GIVEN.set(words);
}

/// The command line: the program, then its arguments.
pub fn command_line() -> &'static [OsString] {
    static OWN: OnceLock<Vec<OsString>> = OnceLock::new();
    GIVEN.get().unwrap_or_else(|| OWN.get_or_init(|| std::env::args_os().collect()))
}

/// The file that starts this program. Errors: the system does not say.
pub fn own_program() -> Result<PathBuf> {
    if let Some(program) = GIVEN.get().and_then(|words| words.first()) {
        return Ok(program.into());
    }
    std::env::current_exe().map_err(|error| {
        Error::run("the program does not find its own file, which --plugin-process starts").got(error)
    })
}

/// Ends the program at once with exit code 1, and removes what it has begun to write.
pub fn end_now() -> ! {
    voltet_plugins::state_exit(FAILED);
    files::end_now(i32::from(FAILED))
}

/// True if this is the only thread of the process, as Linux lists them.
pub fn is_single_threaded() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}
