//! State of the thread and the process that a plug-in's function may change and that others would compute with: how the thread rounds
//! (and whether it flushes tiny numbers to zero); the current folder, the permissions of new files (umask) and the limits of
//! resources of the process.

use std::sync::{Mutex, PoisonError};

/// Runs `work`; how the thread rounds is as before afterwards.
pub(crate) fn with_same_rounding<T>(work: impl FnOnce() -> T) -> T {
    let before = rounding();
    let outcome = work();
    set_rounding(before);
    outcome
}

/// Number of calls that run, and the state of the process before the first of them.
static HELD: Mutex<(usize, Option<ProcessState>)> = Mutex::new((0, None));

/// Notes that a call begins: the state of the process is as before once none runs. Calls may overlap, and a process has one state.
pub(crate) fn hold_process_state() {
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    if held.0 == 0 {
        held.1 = Some(ProcessState::current());
    }
    held.0 += 1;
}

/// Notes that it ended.
pub(crate) fn release_process_state() {
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    held.0 -= 1;
    if held.0 == 0
        && let Some(state) = held.1.take()
    {
        state.set();
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

/// Number of kinds of limits on Linux, which are numbered from 0.
#[cfg(target_os = "linux")]
const LIMIT_COUNT: usize = 16;

/// State of the process that the files which it names and makes depend on.
struct ProcessState {
    /// The current folder, whatever its path is by now; `None` where it cannot be opened.
    #[cfg(unix)]
    folder: Option<std::fs::File>,
    /// Permissions that new files do not get; `None` where they cannot be read.
    #[cfg(target_os = "linux")]
    umask: Option<libc::mode_t>,
    /// Limits of resources, in the order of their kinds; `None` for those that the system does not have.
    #[cfg(target_os = "linux")]
    limits: [Option<libc::rlimit>; LIMIT_COUNT],
}

#[cfg(unix)]
impl ProcessState {
    fn current() -> ProcessState {
        use std::os::unix::fs::OpenOptionsExt;
        // A folder that may be entered and not be listed is opened, too.
        #[cfg(target_os = "linux")]
        let flags = libc::O_PATH | libc::O_DIRECTORY | libc::O_CLOEXEC;
        #[cfg(not(target_os = "linux"))]
        let flags = libc::O_DIRECTORY | libc::O_CLOEXEC;
        ProcessState {
            folder: std::fs::OpenOptions::new().read(true).custom_flags(flags).open(".").ok(),
            #[cfg(target_os = "linux")]
            umask: umask(),
            #[cfg(target_os = "linux")]
            limits: std::array::from_fn(limit),
        }
    }

    /// Puts it back. What cannot be put back stays as it is: a limit that was lowered for good, for instance.
    fn set(&self) {
        use std::os::fd::AsRawFd;
        if let Some(folder) = &self.folder {
            // SAFETY: an open descriptor.
            let _ = unsafe { libc::fchdir(folder.as_raw_fd()) };
        }
        #[cfg(target_os = "linux")]
        {
            if let Some(umask) = self.umask {
                // SAFETY: cannot fail.
                unsafe { libc::umask(umask) };
            }
            for (kind, before) in self.limits.iter().enumerate() {
                let Some(before) = before else { continue };
                if limit(kind)
                    .is_some_and(|now| (now.rlim_cur, now.rlim_max) != (before.rlim_cur, before.rlim_max))
                {
                    // SAFETY: reads the limit.
                    let _ = unsafe { libc::setrlimit(kind as _, before) };
                }
            }
        }
    }
}

#[cfg(target_os = "linux")]
fn limit(kind: usize) -> Option<libc::rlimit> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: a place for the limit.
    (unsafe { libc::getrlimit(kind as _, &mut limit) } == 0).then_some(limit)
}

/// Permissions that new files do not get. A call for it would set it, for files of other threads, too.
#[cfg(target_os = "linux")]
fn umask() -> Option<libc::mode_t> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let digits = status.lines().find_map(|line| line.strip_prefix("Umask:"))?;
    libc::mode_t::from_str_radix(digits.trim(), 8).ok()
}

#[cfg(not(unix))]
impl ProcessState {
    fn current() -> ProcessState {
        ProcessState {}
    }

    fn set(&self) {}
}
