//! Guards of loading and calling: a crash in a plug-in, or its call of `exit`, ends the program with a message that names the
//! plug-in, and work runs on a thread that can be given up, since a plug-in that does not return cannot be ended.

use crate::supervisor;
use crate::thread_state::with_same_folder;
use std::cell::Cell;
use std::panic::AssertUnwindSafe;
use std::ptr::null_mut;
use std::sync::Arc;
#[cfg(target_os = "linux")]
use std::sync::atomic::AtomicI32;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use voltet_core::field::Plugin;

/// Descriptions of crashes, in the order of the signals.
const CAUSES: [&str; 5] = [
    "SIGSEGV, memory that is not there",
    "SIGBUS, memory that is not there",
    "SIGFPE, a division by zero",
    "SIGILL, an unknown instruction",
    "SIGABRT, it gave up, by an exception perhaps",
];

/// Last words of the program about a plug-in.
#[cfg_attr(not(unix), expect(dead_code, reason = "nothing is announced there"))]
struct Messages {
    /// Message of a crash, by each signal.
    crashes: [String; CAUSES.len()],
    /// Message of a call of `exit`.
    exit: String,
}

/// Messages of the plug-ins that run; null where a slot is free.
static MESSAGES: [AtomicPtr<Messages>; 16] = [const { AtomicPtr::new(null_mut()) }; 16];

thread_local! {
    /// Messages of the plug-in that this thread runs; null for none. A program may exit while a plug-in that was given up runs on
    /// another thread.
    static CURRENT: Cell<*mut Messages> = const { Cell::new(null_mut()) };
}

/// The plug-in that this thread runs, for parts of its work on other threads.
#[derive(Clone, Copy)]
pub(crate) struct Caller(*mut Messages);
// SAFETY: the messages are read only, within the call that they are of.
unsafe impl Send for Caller {}
// SAFETY: the same.
unsafe impl Sync for Caller {}

impl Caller {
    /// The caller of this thread.
    pub fn current() -> Caller {
        Caller(CURRENT.get())
    }

    /// Runs `work` as part of the caller's.
    pub fn run<T>(self, work: impl FnOnce() -> T) -> T {
        let outer = CURRENT.replace(self.0);
        let outcome = work();
        CURRENT.set(outer);
        outcome
    }
}

/// Runs `work` of the plug-in; a crash or a call of `exit` meanwhile is announced as the plug-in's. `when`: a clause such as "in the gradient filter
/// 'x'".
///
/// An exception of another language that unwinds out of it ends the program a little later, and is announced, too.
pub(crate) fn attribute<T>(plugin: &Plugin, when: &str, work: impl FnOnce() -> T) -> T {
    install();
    // Written at once, and beginning with a new line: another thread may be printing its own crash.
    let message = |what: &str, expected: &str| {
        format!(
            "\nerror: {what} {when} of the {plugin}: the program ends\n |\n = help: expected a plug-in that {expected}; \
             --plugin-process runs it in a process of its own, which may\n"
        )
    };
    let messages = Messages {
        crashes: CAUSES.map(|how| message(&format!("a crash ({how})"), "does not crash")),
        exit: message("a call of exit", "does not end the program"),
    };
    supervisor::begin_work(&format!("{when} of the {plugin}"));
    let own = Box::into_raw(Box::new(messages));
    let is_free = |place: &&AtomicPtr<Messages>| {
        place.compare_exchange(null_mut(), own, Ordering::SeqCst, Ordering::SeqCst).is_ok()
    };
    let place = MESSAGES.iter().find(is_free);
    let outcome = with_same_folder(|| Caller(own).run(work));
    if let Some(place) = place {
        place.store(null_mut(), Ordering::SeqCst);
    }
    supervisor::end_work();
    // SAFETY: made above and taken back once; a handler that reads it still ends the program.
    drop(unsafe { Box::from_raw(own) });
    outcome
}

#[cfg(not(unix))]
fn install() {}

#[cfg(not(unix))]
pub(crate) fn disable_crash_messages() {}

#[cfg(unix)]
pub(crate) use unix::{disable_crash_messages, install};

#[cfg(unix)]
mod unix {
    use super::{CAUSES, CURRENT, MESSAGES};
    use crate::supervisor;
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};

    const SIGNALS: [libc::c_int; CAUSES.len()] =
        [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGABRT];

    /// Earlier handlers, in the order of the signals.
    static FORMER: OnceLock<[libc::sigaction; CAUSES.len()]> = OnceLock::new();

    static DISABLED: AtomicBool = AtomicBool::new(false);

    /// True once a crash is announced.
    static ANNOUNCED: AtomicBool = AtomicBool::new(false);

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
        let messages =
            MESSAGES.iter().map(|place| place.load(Ordering::SeqCst)).find(|messages| !messages.is_null());
        let place = SIGNALS.iter().position(|known| *known == signal);
        let (Some(messages), Some(place)) = (messages, place) else {
            let last = supervisor::last_work_bytes();
            if let (Some(place), false) = (place, last.is_empty() || ANNOUNCED.swap(true, Ordering::SeqCst)) {
                let (what, after) = (
                    CAUSES[place],
                    ") after work of a plug-in, which may have damaged memory; the last ran ",
                );
                end(&[b"\nerror: a crash (", what.as_bytes(), after.as_bytes(), last, HELP.as_bytes()])
            }
            // It comes again, and does what it did without us.
            match place.and_then(|place| FORMER.get().map(|former| &former[place])) {
                // SAFETY: as it was.
                Some(former) => drop(unsafe { libc::sigaction(signal, former, std::ptr::null_mut()) }),
                // SAFETY: as it is without a handler.
                None => drop(unsafe { libc::signal(signal, libc::SIG_DFL) }),
            }
            return;
        };
        // Threads of one plug-in may crash at once: the first speaks, and ends the program for all.
        if ANNOUNCED.swap(true, Ordering::SeqCst) {
            loop {
                // SAFETY: `pause` may be called from a handler.
                unsafe { libc::pause() };
            }
        }
        // SAFETY: whoever made the texts is in the call that crashed.
        end(&[unsafe { (*messages).crashes[place].as_bytes() }])
    }

    /// Announces the exit of a program whose plug-in called `exit`.
    extern "C" fn on_exit() {
        let messages = CURRENT.get();
        // The program itself may end within the call: for want of memory, or by a signal.
        if !messages.is_null() && !supervisor::is_exit_stated() {
            // SAFETY: whoever made the texts is in the call that exits.
            end(&[unsafe { (*messages).exit.as_bytes() }])
        }
    }

    /// End of the message of a crash after a plug-in ran.
    const HELP: &str = "\n |\n = help: expected a plug-in that writes into its own memory alone; --plugin-process runs it in a process of \
                        its own, which it may damage\n";

    fn end(parts: &[&[u8]]) -> ! {
        supervisor::state_exit(1);
        // SAFETY: `write` and `_exit` may be called from a handler.
        unsafe {
            for part in parts {
                libc::write(2, part.as_ptr().cast(), part.len());
            }
            libc::_exit(1)
        }
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
