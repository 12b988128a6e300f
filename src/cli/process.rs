//! The process of the program: its threads, its exit codes, its end.

use crate::nodes::files;

/// The exit code of a run that failed.
pub const FAILED: u8 = 1;

/// Ends the program at once with exit code 1, and removes what it has begun to write.
pub fn end_now() -> ! {
    voltet_plugins::state_exit(FAILED);
    files::end_now(i32::from(FAILED))
}

/// True if this is the only thread of the process, as Linux lists them.
pub fn is_single_threaded() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}
