//! State of the thread and the process that a plug-in's function may change and that others would compute with: how the thread rounds
//! (and whether it flushes tiny numbers to zero), and the current folder.

/// Runs `work`; how the thread rounds is as before afterwards.
pub(crate) fn with_same_rounding<T>(work: impl FnOnce() -> T) -> T {
    let before = rounding();
    let outcome = work();
    set_rounding(before);
    outcome
}

/// Runs `work`; the current folder is as before afterwards.
pub(crate) fn with_same_folder<T>(work: impl FnOnce() -> T) -> T {
    let before = Folder::current();
    let outcome = work();
    before.enter();
    outcome
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
        Folder(std::fs::File::open(".").ok())
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
