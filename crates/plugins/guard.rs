//! Guards of loading and calling: a crash in a plug-in, or its call of `exit`, ends the program with a message that names the
//! plug-in, and work runs on a thread that can be given up, since a plug-in that does not return cannot be ended.

use crate::supervisor::{self, PluginWork};
use crate::thread_state::{hold_process_state, release_process_state};
use std::cell::Cell;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;
#[cfg(target_os = "linux")]
use std::sync::atomic::AtomicI32;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use voltet_core::field::Plugin;

/// Descriptions of crashes, in the order of the signals.
#[cfg(unix)]
const CAUSES: [&str; 5] = [
    "SIGSEGV, memory that is not there",
    "SIGBUS, memory that is not there",
    "SIGFPE, a division by zero",
    "SIGILL, an unknown instruction",
    "SIGABRT, it gave up, by an exception perhaps",
];

thread_local! {
    /// The work of a plug-in that this thread runs. A program may exit while a plug-in that was given up runs on another thread.
    static CURRENT: Cell<Option<&'static PluginWork>> = const { Cell::new(None) };
}

/// The work that this thread runs, for parts of it on other threads.
#[derive(Clone, Copy)]
pub(crate) struct Caller(Option<&'static PluginWork>);

impl Caller {
    pub fn current() -> Caller {
        Caller(CURRENT.get())
    }

    /// Runs `work` as part of the caller's.
    pub fn run<T>(self, work: impl FnOnce() -> T) -> T {
        let _outer = CallerGuard(CURRENT.replace(self.0));
        work()
    }
}

/// Puts back the work that a thread ran before.
struct CallerGuard(Option<&'static PluginWork>);

impl Drop for CallerGuard {
    fn drop(&mut self) {
        CURRENT.set(self.0);
    }
}

/// PluginWork of a plug-in, listed while it runs; the state of the process is as before once none runs.
struct Attribution {
    work: Option<&'static PluginWork>,
    is_over: AtomicBool,
}

impl Attribution {
    fn begin(text: &str) -> Attribution {
        hold_process_state();
        Attribution { work: supervisor::begin_work(text), is_over: AtomicBool::new(false) }
    }

    /// Ends it, once.
    fn end(&self) {
        if !self.is_over.swap(true, Ordering::AcqRel) {
            if let Some(work) = self.work {
                work.end();
            }
            release_process_state();
        }
    }
}

impl Drop for Attribution {
    fn drop(&mut self) {
        self.end();
    }
}

/// Like [`run`], of `work` of the plug-in: a crash or a call of `exit` meanwhile is announced as the plug-in's. `when`: a clause such as
/// "in the gradient filter 'x'".
///
/// An exception of another language that unwinds out of it ends the program a little later, and is announced, too.
pub(crate) fn run_attributed<T: Send + 'static>(
    plugin: &Plugin,
    when: &str,
    work: impl FnOnce() -> T + Send + 'static,
    may_go_on: impl FnMut() -> bool,
) -> Result<T, CallFailure> {
    install();
    let attribution = Arc::new(Attribution::begin(&format!("{when} of the {plugin}")));
    let own = attribution.clone();
    let attributed = move || {
        let outcome = Caller(own.work).run(work);
        own.end();
        outcome
    };
    // A thread that the plug-in ended leaves it to this one.
    run(attributed, may_go_on).inspect_err(|failure| {
        if *failure == CallFailure::ThreadEnded {
            attribution.end();
        }
    })
}

#[cfg(not(unix))]
fn install() {}

#[cfg(not(unix))]
pub(crate) fn disable_crash_messages() {}

#[cfg(unix)]
pub(crate) use unix::{disable_crash_messages, install};

#[cfg(unix)]
mod unix {
    use super::{CAUSES, CURRENT};
    use crate::supervisor;
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};

    const SIGNALS: [libc::c_int; CAUSES.len()] =
        [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGABRT];

    /// Earlier handlers, in the order of the signals.
    static FORMER: OnceLock<[libc::sigaction; CAUSES.len()]> = OnceLock::new();

    static DISABLED: AtomicBool = AtomicBool::new(false);

    /// Leaves crashes to the parent process, which announces them.
    pub(crate) fn disable_crash_messages() {
        DISABLED.store(true, Ordering::Relaxed);
    }

    /// Installs the handlers, once for the process.
    pub(crate) fn install() {
        if !DISABLED.load(Ordering::Relaxed) {
            FORMER.get_or_init(|| {
                // SAFETY: the handler calls only what may be called while the program ends. If there is no room for it, exits go
                // unannounced.
                let _ = unsafe { libc::atexit(on_exit) };
                SIGNALS.map(handle)
            });
        }
    }

    /// Installs the handler; returns the earlier one.
    fn handle(signal: libc::c_int) -> libc::sigaction {
        // SAFETY: a zeroed sigaction is one without flags; the handler only calls what may be called from one.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            let mut former: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = on_crash as extern "C" fn(libc::c_int) as libc::sighandler_t;
            action.sa_flags = libc::SA_ONSTACK;
            libc::sigemptyset(&mut action.sa_mask);
            libc::sigaction(signal, &action, &mut former);
            former
        }
    }

    extern "C" fn on_crash(signal: libc::c_int) {
        let place = SIGNALS.iter().position(|known| *known == signal);
        let clause = supervisor::suspects(
            CURRENT.get(),
            "after work of a plug-in, which may have damaged memory; the last ran ",
        );
        let is_running = supervisor::is_work_running();
        if let (Some(place), [_, ..]) = (place, clause.parts()) {
            if !supervisor::announce_crash() {
                let head: [&[u8]; 3] = [b"\nerror: a crash (", CAUSES[place].as_bytes(), b") "];
                write(&head, clause.parts(), if is_running { CRASHES } else { DAMAGES });
                if is_running {
                    end()
                }
            } else if is_running {
                // Threads of one plug-in may crash at once: the first speaks, and ends the program for all.
                loop {
                    // SAFETY: `pause` may be called from a handler.
                    unsafe { libc::pause() };
                }
            }
        }
        // It comes again, and does what it did without us: Rust's message about a stack, an image of memory.
        match place.and_then(|place| FORMER.get().map(|former| &former[place])) {
            // SAFETY: as it was.
            Some(former) => drop(unsafe { libc::sigaction(signal, former, std::ptr::null_mut()) }),
            // SAFETY: as it is without a handler.
            None => drop(unsafe { libc::signal(signal, libc::SIG_DFL) }),
        }
    }

    /// Announces the exit of a program whose plug-in called `exit`.
    extern "C" fn on_exit() {
        // The program itself may end within the call: for want of memory, or by a signal.
        if let Some(work) = CURRENT.get().filter(|_| !supervisor::is_exit_stated()) {
            write(
                &[b"\nerror: a call of exit ".as_slice()],
                supervisor::suspects(Some(work), "").parts(),
                EXITS,
            );
            end()
        }
    }

    /// Ends of messages.
    const CRASHES: &str = ": the program ends\n |\n = help: expected a plug-in that does not crash; --plugin-process runs it in a process of \
                           its own, which may\n";
    const EXITS: &str = ": the program ends\n |\n = help: expected a plug-in that does not end the program; --plugin-process runs it in a \
                         process of its own, which may\n";
    const DAMAGES: &str = "\n |\n = help: expected a plug-in that writes into its own memory alone; --plugin-process runs it in a process of \
                           its own, which it may damage\n";

    /// Writes a message at once, beginning with a new line: another thread may be printing its own crash.
    fn write(head: &[&[u8]], clause: &[&[u8]], help: &str) {
        let mut parts = [libc::iovec { iov_base: std::ptr::null_mut(), iov_len: 0 }; 32];
        let all = head.iter().chain(clause).copied().chain([help.as_bytes()]);
        let count = parts.iter_mut().zip(all).map(|(part, bytes)| {
            *part = libc::iovec { iov_base: bytes.as_ptr().cast_mut().cast(), iov_len: bytes.len() };
        });
        let count = count.count() as libc::c_int;
        // SAFETY: a system call, which may be made in a handler; the parts are texts that stay.
        unsafe { libc::writev(2, parts.as_ptr(), count) };
    }

    fn end() -> ! {
        supervisor::state_exit(1);
        // SAFETY: `_exit` may be called from a handler.
        unsafe { libc::_exit(1) }
    }
}

/// Stack that the interface promises (bytes).
const STACK: usize = 64 << 20;

/// Interval between two calls of `may_go_on`.
const INTERVAL: Duration = Duration::from_millis(10);

/// Reason for which a call has no result.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum CallFailure {
    /// It was given up, and still runs.
    GivenUp,
    /// The system has no thread for it, or the thread panicked, and printed why.
    NoThread,
    /// The plug-in ended the thread by a system call.
    ThreadEnded,
}

/// Runs `work` on a new thread, and gives it up once `may_go_on`, called every few milliseconds, is false. Changes to the thread's
/// state (the rounding of numbers, for example) end with it.
pub(crate) fn run<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    mut may_go_on: impl FnMut() -> bool,
) -> Result<T, CallFailure> {
    let (sender, receiver) = channel();
    let thread = std::thread::Builder::new().name("plug-in".into()).stack_size(STACK);
    let number = Arc::new(ThreadNumber::default());
    let own_number = number.clone();
    let spawned = thread.spawn(move || {
        own_number.set();
        // An exception of another language ends the program here, before the receiver could take the thread for ended.
        if let Ok(outcome) = std::panic::catch_unwind(AssertUnwindSafe(work)) {
            // The receiver may have given up.
            let _ = sender.send(outcome);
        }
    });
    spawned.map_err(|_| CallFailure::NoThread)?;
    // A thread of the pool must go on with the pool's work, which may be that of the plug-in.
    let is_in_pool = rayon::current_thread_index().is_some();
    loop {
        let worked = is_in_pool && rayon::yield_now() == Some(rayon::Yield::Executed);
        match receiver.recv_timeout(if worked { Duration::ZERO } else { INTERVAL }) {
            Ok(outcome) => return Ok(outcome),
            Err(RecvTimeoutError::Disconnected) => return Err(CallFailure::NoThread),
            Err(RecvTimeoutError::Timeout) if number.is_gone() => {
                return receiver.try_recv().map_err(|_| CallFailure::ThreadEnded);
            }
            Err(RecvTimeoutError::Timeout) if may_go_on() => {}
            Err(RecvTimeoutError::Timeout) => return Err(CallFailure::GivenUp),
        }
    }
}

/// Number of a thread in the system; 0 before it began.
#[derive(Default)]
struct ThreadNumber(#[cfg(target_os = "linux")] AtomicI32);

#[cfg(target_os = "linux")]
impl ThreadNumber {
    /// Takes that of this thread.
    fn set(&self) {
        // SAFETY: reads a number of this thread.
        self.0.store(unsafe { libc::gettid() }, Ordering::Release);
    }

    /// True if the thread began and is no more.
    fn is_gone(&self) -> bool {
        let number = self.0.load(Ordering::Acquire);
        // SAFETY: signal 0 is none: the system only looks for the thread.
        number != 0 && unsafe { libc::syscall(libc::SYS_tgkill, libc::getpid(), number, 0) } != 0
    }
}

#[cfg(not(target_os = "linux"))]
impl ThreadNumber {
    fn set(&self) {}

    fn is_gone(&self) -> bool {
        false
    }
}
