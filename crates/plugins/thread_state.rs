//! State of the thread and the process that a plug-in's function may change and that others would compute with: how the thread rounds
//! (and whether it flushes tiny numbers to zero), and the current folder.

use std::sync::{Mutex, PoisonError};

/// Runs `work`; how the thread rounds is as before afterwards.
pub(crate) fn with_same_rounding<T>(work: impl FnOnce() -> T) -> T {
    let before = rounding();
    let outcome = work();
    set_rounding(before);
    outcome
}

/// Number of calls that run, and the current folder before the first of them.
static HELD: Mutex<(usize, Option<Folder>)> = Mutex::new((0, None));

/// Notes that a call begins: the current folder is as before once none runs. Calls may overlap, and a process has one folder.
pub(crate) fn hold_folder() {
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    if held.0 == 0 {
        held.1 = Some(Folder::current());
    }
    held.0 += 1;
}

/// Notes that it ended.
pub(crate) fn release_folder() {
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    held.0 -= 1;
    if held.0 == 0
        && let Some(folder) = held.1.take()
    {
        folder.enter();
    }
}

/// MXCSR: its control bits without the flags of what happened.
#[cfg(target_arch = "x86_64")]
fn rounding() -> u64 {
    let mut state = 0u32;
    // SAFETY: stores the register there.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &mut state, options(nostack, preserves_flags)) };
    u64::from(state)
}

#[cfg(target_arch = "x86_64")]
fn set_rounding(before: u64) {
    let before = before as u32;
    // SAFETY: a value that the register had.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &before, options(nostack, preserves_flags)) };
}

/// FPCR.
#[cfg(target_arch = "aarch64")]
fn rounding() -> u64 {
    let state: u64;
    // SAFETY: reads the register.
    unsafe { std::arch::asm!("mrs {}, fpcr", out(reg) state, options(nomem, nostack, preserves_flags)) };
    state
}

#[cfg(target_arch = "aarch64")]
fn set_rounding(before: u64) {
    // SAFETY: a value that the register had.
    unsafe { std::arch::asm!("msr fpcr, {}", in(reg) before, options(nomem, nostack, preserves_flags)) };
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn rounding() -> u64 {
    0
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn set_rounding(_: u64) {}

/// A folder, whatever its path is by now; `None` where it cannot be opened.
struct Folder(#[cfg(unix)] Option<std::fs::File>);

#[cfg(unix)]
impl Folder {
    fn current() -> Folder {
        use std::os::unix::fs::OpenOptionsExt;
        // A folder that may be entered and not be listed is opened, too.
        #[cfg(target_os = "linux")]
        let flags = libc::O_PATH | libc::O_DIRECTORY | libc::O_CLOEXEC;
        #[cfg(not(target_os = "linux"))]
        let flags = libc::O_DIRECTORY | libc::O_CLOEXEC;
        Folder(std::fs::OpenOptions::new().read(true).custom_flags(flags).open(".").ok())
    }

    fn enter(&self) {
        use std::os::fd::AsRawFd;
        if let Some(folder) = &self.0 {
            // SAFETY: an open descriptor. If it fails the folder stays as it is.
            let _ = unsafe { libc::fchdir(folder.as_raw_fd()) };
        }
    }
}

#[cfg(not(unix))]
impl Folder {
    fn current() -> Folder {
        Folder()
    }

    fn enter(&self) {}
}
