//! Supervision of a program that shared libraries are loaded into. `_exit`, a system call or another program in its place (`exec`)
//! end a process with any exit code, and nothing within it can refuse that. So the process that the user began waits, and a child
//! goes on with the work. The child states its exit code in memory that both share; an end without that is the last plug-in's.
//!
//! The same memory holds which plug-in ran last: heap damage shows after the call that made it.

use std::cell::UnsafeCell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU32, Ordering};

/// Longest description of the work of a plug-in (bytes).
const MAX_TEXT_BYTES: usize = 4000;

/// Memory that the two processes share.
struct Shared {
    /// The exit code that the program stated, plus 1; 0 before.
    stated: AtomicU32,
    /// Number of plug-in functions that run.
    running: AtomicU32,
    /// True while a thread writes the text.
    busy: AtomicBool,
    /// Bytes of the text; 0 before any plug-in ran.
    length: AtomicU32,
    /// The work that began last: "in the gradient filter 'x' of the plug-in 'y' (path)".
    text: UnsafeCell<[u8; MAX_TEXT_BYTES]>,
}

// SAFETY: the text is written under `busy`; a reader of a text that is being replaced reads bytes of both, which a message survives.
unsafe impl Sync for Shared {}

/// Memory of a program without supervision.
static OWN: Shared = Shared {
    stated: AtomicU32::new(0),
    running: AtomicU32::new(0),
    busy: AtomicBool::new(false),
    length: AtomicU32::new(0),
    text: UnsafeCell::new([0; MAX_TEXT_BYTES]),
};

/// Memory shared with the supervisor; null without one.
static SHARED: AtomicPtr<Shared> = AtomicPtr::new(null_mut());

fn shared() -> &'static Shared {
    // SAFETY: null or a mapping that stays.
    unsafe { SHARED.load(Ordering::Acquire).as_ref() }.unwrap_or(&OWN)
}

impl Shared {
    fn set_text(&self, text: &str) {
        if self.busy.swap(true, Ordering::Acquire) {
            return;
        }
        let length = text.len().min(MAX_TEXT_BYTES);
        self.length.store(0, Ordering::Release);
        // SAFETY: this thread alone writes, and the length is within the text.
        unsafe { std::ptr::copy_nonoverlapping(text.as_ptr(), self.text.get().cast(), length) };
        self.length.store(length as u32, Ordering::Release);
        self.busy.store(false, Ordering::Release);
    }

    /// The text; empty before any plug-in ran. Takes no memory: a handler of a signal may call it.
    fn text(&self) -> &[u8] {
        let length = (self.length.load(Ordering::Acquire) as usize).min(MAX_TEXT_BYTES);
        // SAFETY: the first bytes of the text.
        unsafe { std::slice::from_raw_parts(self.text.get().cast(), length) }
    }
}

/// Notes that work of a plug-in begins; `text`: "in the gradient filter 'x' of the plug-in 'y' (path)".
pub(crate) fn begin_work(text: &str) {
    shared().set_text(text);
    shared().running.fetch_add(1, Ordering::AcqRel);
}

/// Notes that it ended.
pub(crate) fn end_work() {
    shared().running.fetch_sub(1, Ordering::AcqRel);
}

/// The work of a plug-in that began last, as bytes of a text; empty where none ran.
#[cfg_attr(not(unix), expect(dead_code, reason = "nothing is announced there"))]
pub(crate) fn last_work_bytes() -> &'static [u8] {
    shared().text()
}

/// The work of a plug-in in this process that began last, "in the gradient filter 'x' of the plug-in 'y' (path)"; `None` where none
/// ran. Damage to memory shows after the work that made it.
pub fn last_work() -> Option<String> {
    let text = shared().text();
    (!text.is_empty()).then(|| String::from_utf8_lossy(text).into_owned())
}

/// States the exit code with which the program is about to end. An end without it is a plug-in's, where there is a supervisor.
pub fn state_exit(code: u8) {
    shared().stated.store(u32::from(code) + 1, Ordering::Release);
}

/// True if the program stated that it is about to end.
#[cfg_attr(not(unix), expect(dead_code, reason = "nothing is announced there"))]
pub(crate) fn is_exit_stated() -> bool {
    shared().stated.load(Ordering::Acquire) != 0
}

/// Divides the program in two processes: one waits for the other, which returns from here and goes on. Where that ends without
/// [`state_exit`], the waiting one names the plug-in and ends with an exit code that is not 0. Signals that processes send go on to the
/// child; a terminal sends its own to both. Does nothing on other systems than Linux, and the second time.
///
/// # Errors
///
/// - Why the program goes on without supervision, as a clause: it has other threads, or the system gives no process.
pub fn supervise() -> Result<(), String> {
    #[cfg(target_os = "linux")]
    if SHARED.load(Ordering::Acquire).is_null() {
        return linux::supervise();
    }
    Ok(())
}

#[cfg(target_os = "linux")]
mod linux {
    use super::{SHARED, Shared};
    use std::ptr::null_mut;
    use std::sync::atomic::{AtomicI32, Ordering};

    /// Signals that other processes send and that the child takes.
    const FORWARDED: [libc::c_int; 6] =
        [libc::SIGINT, libc::SIGTERM, libc::SIGHUP, libc::SIGQUIT, libc::SIGUSR1, libc::SIGUSR2];

    /// The process that works.
    static CHILD: AtomicI32 = AtomicI32::new(0);

    /// Sends a signal on, unless it comes from the terminal, which sends it to the child, too.
    extern "C" fn forward(signal: libc::c_int, sent: *mut libc::siginfo_t, _: *mut libc::c_void) {
        // SAFETY: the system hands over the signal's origin; `kill` may be called from a handler.
        unsafe {
            if (*sent).si_code != libc::SI_KERNEL {
                libc::kill(CHILD.load(Ordering::Relaxed), signal);
            }
        }
    }

    pub(super) fn supervise() -> Result<(), String> {
        let no_process = |error: std::io::Error| format!("the system gives no process for it: {error}");
        match std::fs::read_dir("/proc/self/task").map(|threads| threads.count()) {
            Ok(1) => {}
            // A copy of the process has this thread alone, and what the others hold stays held.
            Ok(_) => return Err("the program has other threads already".into()),
            Err(error) => return Err(format!("its threads cannot be counted in /proc/self/task: {error}")),
        }
        let (read_write, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_SHARED | libc::MAP_ANONYMOUS);
        // SAFETY: a new mapping, zeroed: numbers and bytes. It stays until the process ends. The only thread forks, so that the child has
        // every state of the program. Signals wait meanwhile.
        unsafe {
            let place = libc::mmap(null_mut(), size_of::<Shared>(), read_write, kind, -1, 0);
            if place == libc::MAP_FAILED {
                return Err(no_process(std::io::Error::last_os_error()));
            }
            let mut all: libc::sigset_t = std::mem::zeroed();
            let mut before: libc::sigset_t = std::mem::zeroed();
            libc::sigfillset(&mut all);
            libc::sigprocmask(libc::SIG_SETMASK, &all, &mut before);
            // Where it is ignored, as some parents leave it, ends of children cannot be waited for. The child has it as it was.
            let waitable: libc::sigaction = std::mem::zeroed();
            let mut child_action: libc::sigaction = std::mem::zeroed();
            libc::sigaction(libc::SIGCHLD, &waitable, &mut child_action);
            let parent = libc::getpid();
            let child = libc::fork();
            let failure = std::io::Error::last_os_error();
            if child <= 0 {
                libc::sigaction(libc::SIGCHLD, &child_action, null_mut());
            }
            if child > 0 {
                CHILD.store(child, Ordering::Relaxed);
                FORWARDED.into_iter().for_each(|signal| install(signal));
            }
            if child == 0 {
                // It ends with the process that the user knows, however that ends.
                libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
                if libc::getppid() != parent {
                    libc::_exit(1);
                }
            }
            libc::sigprocmask(libc::SIG_SETMASK, &before, null_mut());
            match child {
                0 => SHARED.store(place.cast(), Ordering::Release),
                1.. => wait(child, &*place.cast::<Shared>()),
                _ => {
                    libc::munmap(place, size_of::<Shared>());
                    return Err(no_process(failure));
                }
            }
            Ok(())
        }
    }

    /// Installs the handler. Where the signal is ignored, as under `nohup`, the child decides.
    unsafe fn install(signal: libc::c_int) {
        // SAFETY: a zeroed sigaction is one without flags.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = forward as extern "C" fn(_, _, _) as libc::sighandler_t;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_RESTART;
            libc::sigaction(signal, &action, null_mut());
        }
    }

    /// Waits for the child and ends as it does.
    fn wait(child: libc::pid_t, shared: &Shared) -> ! {
        let mut status = 0;
        // SAFETY: the own child, and a place for its status.
        while unsafe { libc::waitpid(child, &mut status, 0) } != child {
            let error = std::io::Error::last_os_error();
            if error.kind() != std::io::ErrorKind::Interrupted {
                eprint!(
                    "\nerror: the end of the process that loads plug-ins cannot be waited for: {error}\n"
                );
                // SAFETY: ends the process, and by the signal of a parent's death the child.
                unsafe { libc::_exit(1) }
            }
        }
        if libc::WIFSIGNALED(status) {
            let signal = libc::WTERMSIG(status);
            let is_asked_for = FORWARDED.contains(&signal) || signal == libc::SIGPIPE;
            if !is_asked_for && !shared.text().is_empty() {
                let why = if signal == libc::SIGKILL { " (SIGKILL, for want of memory perhaps)" } else { "" };
                announce(shared, &format!("an end of the program by signal {signal}{why}"));
            }
            // SAFETY: the end that the child had, without a second image of memory.
            unsafe {
                let none = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
                libc::setrlimit(libc::RLIMIT_CORE, &none);
                libc::signal(signal, libc::SIG_DFL);
                libc::raise(signal);
                libc::_exit(128 + signal)
            }
        }
        let ended = libc::WEXITSTATUS(status);
        let code = match shared.stated.load(Ordering::Acquire) {
            0 => {
                announce(shared, &format!("an end of the program with exit code {ended} (_exit, exec)"));
                1
            }
            // A plug-in's last functions may end the process otherwise.
            stated if ended == 0 => stated as i32 - 1,
            _ => ended,
        };
        // SAFETY: ends the process; nothing is buffered in it.
        unsafe { libc::_exit(code) }
    }

    /// Says what ended the program.
    fn announce(shared: &Shared, what: &str) {
        let last = String::from_utf8_lossy(shared.text());
        let work = match shared.running.load(Ordering::Acquire) {
            _ if last.is_empty() => "of which the program knows nothing".into(),
            0 => format!("that the program did not ask for, after work of a plug-in; the last ran {last}"),
            _ => last.into_owned(),
        };
        eprint!(
            "\nerror: {what} {work}\n |\n = help: expected a plug-in that does not end the program; --plugin-process runs it in a \
             process of its own, which may\n"
        );
    }
}
