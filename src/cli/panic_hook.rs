//! Panics and the end of memory: one line on standard error, and exit code 1.

use crate::cli::present::{hold_back, name, say};
use crate::cli::process::end_now;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::panic::PanicHookInfo;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// True once a command line runs in this process, which is then its own to end.
static RUNS_COMMAND_LINE: AtomicBool = AtomicBool::new(false);

/// Installs a panic hook that shows a panic, which is a defect of the program, in one line. With `RUST_BACKTRACE` set Rust's own
/// message follows. From now on [`ExitOnOutOfMemory`] ends the process.
pub fn install() {
    RUNS_COMMAND_LINE.store(true, Ordering::Relaxed);
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        hold_back(false);
        say(&one_line(panic));
        if std::env::var_os("RUST_BACKTRACE").is_some_and(|value| value != "0") {
            usual(panic);
        }
    }));
}

fn one_line(panic: &PanicHookInfo) -> String {
    let payload = panic.payload();
    let text = payload.downcast_ref::<&str>().copied();
    let what = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    let place = panic.location().map_or(String::new(), |place| {
        format!(" ({}:{}, version {})", in_its_crate(place.file()), place.line(), env!("CARGO_PKG_VERSION"))
    });
    let advice = match voltet_plugins::last_work() {
        Some(work) => format!(
            "unless a plug-in has damaged its memory, please report it; the last ran {}, and --plugin-process keeps it apart",
            name(&work)
        ),
        None => "please report it".into(),
    };
    format!("error: this is a mistake of the program itself: {}{place}; {advice}", name(what))
}

/// A file's path without the folders of the machine that built it: "rayon-1.12.0/src/lib.rs".
fn in_its_crate(file: &str) -> &str {
    let after = |mark: &str, folders: usize| {
        let (_, rest) = file.split_once(mark)?;
        rest.splitn(folders + 1, ['/', '\\']).nth(folders)
    };
    // The folder of a registry's index, the hash of a compiler; else what is within the crate.
    let relative = after("registry/src/", 1).or_else(|| after("rustc/", 1));
    let is_absolute = file.starts_with('/') || file.contains(':');
    relative.or_else(|| after("/src/", 0)).filter(|_| is_absolute).unwrap_or(file)
}

/// The system's allocator, with another end: where memory is exhausted, the program exits by one line and exit code 1 and leaves
/// no half-written file. For the `#[global_allocator]` of a program. Outside of [`run`](crate::run) and
/// [`run_command_line`](crate::run_command_line), as where Python has loaded a library, Rust's own way is left, which is an abort.
pub struct ExitOnOutOfMemory;

// SAFETY: every block is the system allocator's own, under the contract that the caller keeps with this one.
unsafe impl GlobalAlloc for ExitOnOutOfMemory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's contract.
        checked(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(block, layout) }
    }
}

#[inline(always)]
fn checked(block: *mut u8, size: usize) -> *mut u8 {
    if block.is_null() && RUNS_COMMAND_LINE.load(Ordering::Relaxed) {
        exit_out_of_memory(size)
    } else {
        block
    }
}

/// True once some thread ends the program for want of memory.
static ENDING: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// True on the thread that ends it. Takes no memory from the heap.
    static ENDING_HERE: Cell<bool> = const { Cell::new(false) };
}

/// Time that another thread without memory waits for the exit. It may hold a lock that the exit takes.
const EXIT_TIMEOUT: Duration = Duration::from_secs(10);

#[cold]
fn exit_out_of_memory(size: usize) -> *mut u8 {
    if ENDING.swap(true, Ordering::Relaxed) {
        if !ENDING_HERE.get() {
            std::thread::sleep(EXIT_TIMEOUT);
        }
        // The exit itself takes memory, or does not come: Rust's own way is left.
        return std::ptr::null_mut();
    }
    ENDING_HERE.set(true);
    // Written without a block of memory.
    use std::io::Write;
    let _ = writeln!(
        std::io::stderr(),
        "error: memory ends: found no room for {size} bytes more\n |\n = help: expected a smaller grid or picture, or more \
         memory; `voltet info DATA` says how much a grid takes"
    );
    end_now()
}

#[cfg(test)]
mod tests {
    use super::in_its_crate;

    #[test]
    fn no_folder_of_the_builder_is_shown() {
        for (file, shown) in [
            (
                "/home/me/.cargo/registry/src/index.example-1949/exr-1.74.0/src/meta.rs",
                "exr-1.74.0/src/meta.rs",
            ),
            ("/rustc/59807616e1/library/core/src/option.rs", "library/core/src/option.rs"),
            ("core/grid/build.rs", "core/grid/build.rs"),
            ("/home/me/voltet/src/lib.rs", "lib.rs"),
        ] {
            assert_eq!(in_its_crate(file), shown);
        }
    }
}
