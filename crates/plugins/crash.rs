//! A crash in a plug-in ends the program: nobody can go on after one. What can be done is to say whose it was.

use std::sync::atomic::{AtomicPtr, Ordering};
use voltet_core::field::Plugin;

/// How a program crashes, in the order of the signals.
const HOW: [&str; 5] = [
    "SIGSEGV, memory that is not there",
    "SIGBUS, memory that is not there",
    "SIGFPE, a division by zero",
    "SIGILL, an unknown instruction",
    "SIGABRT, it gave up, by an exception perhaps",
];

/// What is said if the program crashes now, for each signal.
type Said = [String; HOW.len()];

/// By each plug-in that runs; null where a place is free.
static SAID: [AtomicPtr<Said>; 16] = [const { AtomicPtr::new(std::ptr::null_mut()) }; 16];

/// Runs a part of the plug-in; a crash meanwhile is announced as its. `when`: a clause such as "in the gradient filter 'x'".
///
/// What unwinds out of it, an exception of another language, ends the program a little later: that is announced, too.
pub(crate) fn during<T>(plugin: &Plugin, when: &str, work: impl FnOnce() -> T) -> T {
    install();
    // Each is written in one piece, and begins a line: another thread may be saying in pieces that it crashed, too.
    let said: Said = HOW.map(|how| {
        format!(
            "\nerror: a crash ({how}) {when} of the {plugin}: the program ends\n |\n = help: expected a plug-in that does not crash; \
             --plugin-process runs it in a process of its own, which may\n"
        )
    });
    let own = Box::into_raw(Box::new(said));
    let is_free = |place: &&AtomicPtr<Said>| {
        place.compare_exchange(std::ptr::null_mut(), own, Ordering::SeqCst, Ordering::SeqCst).is_ok()
    };
    let place = SAID.iter().find(is_free);
    let outcome = work();
    if let Some(place) = place {
        place.store(std::ptr::null_mut(), Ordering::SeqCst);
    }
    // SAFETY: made above and taken back once; a handler that reads it still ends the program.
    drop(unsafe { Box::from_raw(own) });
    outcome
}

#[cfg(not(unix))]
fn install() {}

#[cfg(not(unix))]
pub(crate) fn leave() {}

#[cfg(unix)]
pub(crate) use unix::{install, leave};

#[cfg(unix)]
mod unix {
    use super::{HOW, SAID};
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};

    const SIGNALS: [libc::c_int; HOW.len()] =
        [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGABRT];

    /// What was there before, in the order of the signals.
    static FORMER: OnceLock<[libc::sigaction; HOW.len()]> = OnceLock::new();

    static LEFT: AtomicBool = AtomicBool::new(false);

    /// Whether a crash is being announced.
    static SPOKEN: AtomicBool = AtomicBool::new(false);

    /// Crashes are somebody else's to announce: the process is there for one plug-in.
    pub(crate) fn leave() {
        LEFT.store(true, Ordering::Relaxed);
    }

    /// Once for the process.
    pub(crate) fn install() {
        if !LEFT.load(Ordering::Relaxed) {
            FORMER.get_or_init(|| SIGNALS.map(handle));
        }
    }

    /// Gives what was there before.
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
        let said = SAID.iter().map(|place| place.load(Ordering::SeqCst)).find(|said| !said.is_null());
        let place = SIGNALS.iter().position(|known| *known == signal);
        let (Some(said), Some(place)) = (said, place) else {
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
        if SPOKEN.swap(true, Ordering::SeqCst) {
            loop {
                // SAFETY: `pause` may be called from a handler.
                unsafe { libc::pause() };
            }
        }
        // SAFETY: whoever made the texts is in the call that crashed.
        let text = unsafe { &(*said)[place] };
        // SAFETY: `write` and `_exit` may be called from a handler.
        unsafe {
            libc::write(2, text.as_ptr().cast(), text.len());
            libc::_exit(1)
        }
    }
}
