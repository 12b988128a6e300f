//! How the program ends where it should not: by one line and exit code 1, whatever happens.

use crate::nodes::files;
use crate::present::{name, say};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::panic::PanicHookInfo;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The exit code.
pub const FAILED: u8 = 1;

/// Shows a panic, which is a mistake of the program, in one line. With `RUST_BACKTRACE` set it is shown as Rust does, too.
pub fn show_in_one_line() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
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
    format!("error: this is a mistake of the program itself: {}{place}; please report it", name(what))
}

/// A file's path without the folders of the machine that built it: "rayon-1.12.0/src/lib.rs".
fn in_its_crate(file: &str) -> &str {
    let after = |mark: &str, folders: usize| {
        let (_, rest) = file.split_once(mark)?;
        rest.splitn(folders + 1, ['/', '\\']).nth(folders)
    };
    // The folder of a registry's index, the hash of a compiler; else what is within the crate.
    let known = after("registry/src/", 1).or_else(|| after("rustc/", 1));
    let is_absolute = file.starts_with('/') || file.contains(':');
    known.or_else(|| after("/src/", 0)).filter(|_| is_absolute).unwrap_or(file)
}

/// The system's allocator, but where memory ends the program does, by one line and exit code 1 and without what it has begun
/// to write; Rust's own way is an abort. For the `#[global_allocator]` of a program.
pub struct OrEnd;

// SAFETY: every block is the system allocator's own, under the contract that the caller keeps with this one.
unsafe impl GlobalAlloc for OrEnd {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract.
        or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract.
        or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's contract.
        or_end(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(block, layout) }
    }
}

#[inline(always)]
fn or_end(block: *mut u8, size: usize) -> *mut u8 {
    if block.is_null() { memory_ends(size) } else { block }
}

/// Set where the program ends for want of memory.
static ENDS: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Whether it is this thread that ends it. Takes no memory from the heap.
    static ENDS_HERE: Cell<bool> = const { Cell::new(false) };
}

/// How long another thread that wants memory waits for the end. It may hold a lock that the end asks for.
const WAIT: Duration = Duration::from_secs(10);

#[cold]
fn memory_ends(size: usize) -> *mut u8 {
    if ENDS.swap(true, Ordering::Relaxed) {
        if !ENDS_HERE.get() {
            std::thread::sleep(WAIT);
        }
        // The end itself asks for memory, or does not come: Rust's own way is left.
        return std::ptr::null_mut();
    }
    ENDS_HERE.set(true);
    // Written without a block of memory.
    use std::io::Write;
    let _ = writeln!(
        std::io::stderr(),
        "error: memory ends: found no room for {size} bytes more\n |\n = help: expected a smaller grid or picture, or more \
         memory; `voltet info DATA` says how much a grid takes"
    );
    files::end_now(i32::from(FAILED))
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
