//! Supervision of a program that shared libraries are loaded into. `_exit`, a system call or another program in its place (`exec`)
//! end a process with any exit code, and nothing within it can refuse that. So the process that the user began waits, and a child
//! goes on with the work. The child states its exit code in memory that both share; an end without that is the last plug-in's.
//!
//! The same memory holds which plug-in ran last: heap damage shows after the call that made it.

use std::cell::UnsafeCell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU32, AtomicU64, Ordering};

/// Longest description of the work of a plug-in (bytes).
const MAX_TEXT_BYTES: usize = 2000;

/// Largest number of works that are known at once.
const MAX_WORK_COUNT: usize = 64;

/// Memory that the two processes share.
struct Shared {
    /// The exit code that the program stated, plus 1; 0 before.
    stated: AtomicU32,
    /// True once a crash is announced.
    announced: AtomicBool,
    /// Number of requests to end that were passed on and not taken yet.
    forwarded: AtomicU32,
    /// True once a second request was passed on.
    is_repeated: AtomicBool,
    /// Number of works that began.
    begun_count: AtomicU64,
    works: [PluginWork; MAX_WORK_COUNT],
}

/// PluginWork of a plug-in, which runs or ran.
pub(crate) struct PluginWork {
    is_running: AtomicBool,
    /// Place in the order in which works began; 0 for none.
    begun: AtomicU64,
    /// Bytes of the text.
    length: AtomicU32,
    /// "in the gradient filter 'x' of the plug-in 'y' (path)".
    text: UnsafeCell<[u8; MAX_TEXT_BYTES]>,
}

// SAFETY: whoever set `is_running` writes the text; a reader of a text that is being replaced reads bytes of both, which a message
// survives.
unsafe impl Sync for PluginWork {}

impl Shared {
    const fn new() -> Shared {
        Shared {
            stated: AtomicU32::new(0),
            announced: AtomicBool::new(false),
            forwarded: AtomicU32::new(0),
            is_repeated: AtomicBool::new(false),
            begun_count: AtomicU64::new(0),
            works: [const {
                PluginWork {
                    is_running: AtomicBool::new(false),
                    begun: AtomicU64::new(0),
                    length: AtomicU32::new(0),
                    text: UnsafeCell::new([0; MAX_TEXT_BYTES]),
                }
            }; MAX_WORK_COUNT],
        }
    }

    /// Lists work that begins, in the place of the one that ended longest ago; `None` where too many run.
    fn begin(&self, text: &str) -> Option<&PluginWork> {
        loop {
            let free = self.works.iter().filter(|work| !work.is_running.load(Ordering::Acquire));
            let work = free.min_by_key(|work| work.begun.load(Ordering::Acquire))?;
            if work.is_running.swap(true, Ordering::AcqRel) {
                continue;
            }
            let length = text.len().min(MAX_TEXT_BYTES);
            work.length.store(0, Ordering::Release);
            // SAFETY: this thread alone writes, and the length is within the text.
            unsafe { std::ptr::copy_nonoverlapping(text.as_ptr(), work.text.get().cast(), length) };
            work.length.store(length as u32, Ordering::Release);
            work.begun.store(self.begun_count.fetch_add(1, Ordering::AcqRel) + 1, Ordering::Release);
            return Some(work);
        }
    }

    fn running(&self) -> impl Iterator<Item = &PluginWork> {
        self.works.iter().filter(|work| work.is_running.load(Ordering::Acquire))
    }

    /// The work that began last, if any did.
    fn last(&self) -> Option<&PluginWork> {
        last(self.works.iter())
    }

    /// Clause that names whose end of the program it may be, in parts: `current`, the work of the thread that ended it, or the only
    /// work that runs, or all that run. `after` precedes the last that ran, where none runs. Takes no memory: a handler of a signal
    /// may call it.
    fn suspects<'a>(&'a self, current: Option<&'a PluginWork>, after: &'static str) -> Clause<'a> {
        let mut clause = Clause::default();
        if let Some(work) = current.or_else(|| last(self.running())) {
            let is_only = current.is_some() || self.running().count() == 1;
            if !is_only {
                clause.push(b"while several plug-ins ran; the last began ");
            }
            clause.push(work.text());
            let others = self.running().filter(|other| !is_only && !std::ptr::eq(*other, work));
            for (place, other) in others.enumerate() {
                clause.push(if place == 0 { b"; also running: " } else { b"; " });
                clause.push(other.text());
            }
        } else if let Some(work) = self.last() {
            clause.push(after.as_bytes());
            clause.push(work.text());
        }
        clause
    }
}

/// The last of them to begin.
fn last<'a>(works: impl Iterator<Item = &'a PluginWork>) -> Option<&'a PluginWork> {
    works
        .filter(|work| work.begun.load(Ordering::Acquire) > 0)
        .max_by_key(|work| work.begun.load(Ordering::Acquire))
}

impl PluginWork {
    /// Its description. Takes no memory.
    fn text(&self) -> &[u8] {
        let length = (self.length.load(Ordering::Acquire) as usize).min(MAX_TEXT_BYTES);
        // SAFETY: the first bytes of the text.
        unsafe { std::slice::from_raw_parts(self.text.get().cast(), length) }
    }

    /// Notes that it ended.
    pub fn end(&self) {
        self.is_running.store(false, Ordering::Release);
    }
}

/// Largest number of parts of a clause; more plug-ins are left out.
const MAX_PART_COUNT: usize = 20;

/// Parts of a clause, without memory of the heap.
#[derive(Default)]
pub(crate) struct Clause<'a> {
    parts: [&'a [u8]; MAX_PART_COUNT],
    count: usize,
}

impl<'a> Clause<'a> {
    fn push(&mut self, part: &'a [u8]) {
        if let Some(place) = self.parts.get_mut(self.count) {
            *place = part;
            self.count += 1;
        }
    }

    pub fn parts(&self) -> &[&'a [u8]] {
        &self.parts[..self.count]
    }
}

/// Memory of a program without supervision.
static OWN: Shared = Shared::new();

/// Memory shared with the supervisor; null without one.
static SHARED: AtomicPtr<Shared> = AtomicPtr::new(null_mut());

fn shared() -> &'static Shared {
    // SAFETY: null or a mapping that stays.
    unsafe { SHARED.load(Ordering::Acquire).as_ref() }.unwrap_or(&OWN)
}

/// Lists work of a plug-in that begins, until [`PluginWork::end`]; `text`: "in the gradient filter 'x' of the plug-in 'y' (path)".
pub(crate) fn begin_work(text: &str) -> Option<&'static PluginWork> {
    shared().begin(text)
}

/// Names whose end of the program it may be; see `Shared::suspects`. Empty where no plug-in ran.
#[cfg(unix)]
pub(crate) fn suspects(current: Option<&'static PluginWork>, after: &'static str) -> Clause<'static> {
    shared().suspects(current, after)
}

/// True if work of a plug-in runs.
#[cfg(unix)]
pub(crate) fn is_work_running() -> bool {
    shared().running().next().is_some()
}

/// Notes that a crash is announced; true if one was already.
#[cfg(unix)]
pub(crate) fn announce_crash() -> bool {
    shared().announced.swap(true, Ordering::SeqCst)
}

/// The work of a plug-in in this process that began last, "in the gradient filter 'x' of the plug-in 'y' (path)"; `None` where none
/// ran. Damage to memory shows after the work that made it.
pub fn last_work() -> Option<String> {
    shared().last().map(|work| String::from_utf8_lossy(work.text()).into_owned())
}

/// A request to end the program, by a signal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum EndRequest {
    /// To this process.
    Direct,
    /// Passed on by the supervisor: what all processes of a job got is the same request as the direct one.
    Forwarded,
    /// A second request, passed on by the supervisor.
    ForwardedAgain,
}

/// Takes the request of a signal that came.
pub fn take_end_request() -> EndRequest {
    let less = |count: u32| count.checked_sub(1);
    let taken = shared().forwarded.fetch_update(Ordering::AcqRel, Ordering::Acquire, less);
    match taken.is_ok() {
        true if shared().is_repeated.load(Ordering::Acquire) => EndRequest::ForwardedAgain,
        true => EndRequest::Forwarded,
        false => EndRequest::Direct,
    }
}

/// States the exit code with which the program is about to end. An end without it is a plug-in's, where there is a supervisor.
pub fn state_exit(code: u8) {
    shared().stated.store(u32::from(code) + 1, Ordering::Release);
}

/// True if the program stated that it is about to end.
#[cfg(unix)]
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
    use std::sync::atomic::{AtomicI32, AtomicPtr, AtomicU64, Ordering};
    use voltet_core::error::system_words;

    /// Signals that other processes send and that the child takes.
    const FORWARDED: [libc::c_int; 8] = [
        libc::SIGINT,
        libc::SIGTERM,
        libc::SIGHUP,
        libc::SIGQUIT,
        libc::SIGUSR1,
        libc::SIGUSR2,
        libc::SIGTSTP,
        libc::SIGCONT,
    ];

    /// Signals that ask for an end.
    const REQUESTS: [libc::c_int; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

    /// Bytes of memory that cannot be written, before and after what the processes share: pages of any size.
    const GUARD_BYTES: usize = 1 << 16;

    /// The process that works.
    static CHILD: AtomicI32 = AtomicI32::new(0);

    /// The memory shared with it.
    static PLACE: AtomicPtr<Shared> = AtomicPtr::new(null_mut());

    /// Time within which requests are one (ms): `timeout` signals a process, then its group. The time is that of their arrival here, where
    /// nothing else is done.
    const SAME_REQUEST_MS: u64 = 100;

    /// Time of the last request (ms); 0 for none.
    static REQUESTED: AtomicU64 = AtomicU64::new(0);

    /// Time since the system began (ms).
    fn now() -> u64 {
        // SAFETY: `clock_gettime` may be called from a handler; a zeroed time is one.
        let time = unsafe {
            let mut time: libc::timespec = std::mem::zeroed();
            libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut time);
            time
        };
        time.tv_sec as u64 * 1000 + time.tv_nsec as u64 / 1_000_000
    }

    /// Sends a signal on, unless it comes from the terminal, which sends it to the child, too.
    extern "C" fn forward(signal: libc::c_int, sent: *mut libc::siginfo_t, _: *mut libc::c_void) {
        // SAFETY: the system hands over the signal's origin; `kill` may be called from a handler.
        unsafe {
            if (*sent).si_code == libc::SI_KERNEL {
                return;
            }
            if let (Some(shared), true) = (PLACE.load(Ordering::Acquire).as_ref(), REQUESTS.contains(&signal))
            {
                let (now, before) = (now(), REQUESTED.load(Ordering::Relaxed));
                if before > 0 && now > before + SAME_REQUEST_MS {
                    shared.is_repeated.store(true, Ordering::Release);
                }
                REQUESTED.store(now, Ordering::Relaxed);
                shared.forwarded.fetch_add(1, Ordering::AcqRel);
            }
            libc::kill(CHILD.load(Ordering::Relaxed), signal);
        }
    }

    pub(super) fn supervise() -> Result<(), String> {
        let no_process =
            |error: std::io::Error| format!("the system gives no process for it: {}", system_words(&error));
        match std::fs::read_dir("/proc/self/task").map(|threads| threads.count()) {
            Ok(1) => {}
            // A copy of the process has this thread alone, and what the others hold stays held.
            Ok(_) => return Err("the program has other threads already".into()),
            Err(error) => {
                let error = system_words(&error);
                return Err(format!("its threads cannot be counted in /proc/self/task: {error}"));
            }
        }
        let (read_write, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_SHARED | libc::MAP_ANONYMOUS);
        // SAFETY: a new mapping, zeroed: numbers and bytes. It stays until the process ends. The only thread forks, so that the child has
        // every state of the program. Signals wait meanwhile.
        unsafe {
            // Pages that cannot be written lie before and after it: an overrun of other memory ends there.
            let length = size_of::<Shared>().next_multiple_of(GUARD_BYTES) + 2 * GUARD_BYTES;
            let guarded = libc::mmap(null_mut(), length, libc::PROT_NONE, kind, -1, 0);
            if guarded == libc::MAP_FAILED {
                return Err(no_process(std::io::Error::last_os_error()));
            }
            let place = guarded.byte_add(GUARD_BYTES);
            if libc::mprotect(place, size_of::<Shared>(), read_write) != 0 {
                let failure = std::io::Error::last_os_error();
                libc::munmap(guarded, length);
                return Err(no_process(failure));
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
                PLACE.store(place.cast(), Ordering::Release);
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
                    libc::munmap(guarded, length);
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
        loop {
            // SAFETY: the own child, and a place for its status.
            let found = unsafe { libc::waitpid(child, &mut status, libc::WUNTRACED) };
            let error = std::io::Error::last_os_error();
            if found == child {
                if !libc::WIFSTOPPED(status) {
                    break;
                }
                // The shell sees that the job stopped; a signal to go on is passed on.
                // SAFETY: stops this process.
                unsafe { libc::raise(libc::SIGSTOP) };
                continue;
            }
            if error.kind() != std::io::ErrorKind::Interrupted {
                let error = system_words(&error);
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
            if !is_asked_for && shared.last().is_some() && !shared.announced.load(Ordering::Acquire) {
                let (why, help) = match signal {
                    libc::SIGKILL => (
                        " (SIGKILL, for want of memory perhaps)",
                        "expected more memory, or a smaller grid or picture",
                    ),
                    libc::SIGXCPU => {
                        (" (SIGXCPU)", "expected a larger limit of processor time (`ulimit -t`)")
                    }
                    libc::SIGXFSZ => {
                        (" (SIGXFSZ)", "expected a larger limit of the size of files (`ulimit -f`)")
                    }
                    _ => ("", ENDLESS),
                };
                announce(shared, &format!("an end of the program by signal {signal}{why}"), help);
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
                announce(
                    shared,
                    &format!("an end of the program with exit code {ended} (_exit, exec)"),
                    ENDLESS,
                );
                1
            }
            // A plug-in's last functions may end the process otherwise.
            stated if ended == 0 => stated as i32 - 1,
            _ => ended,
        };
        // SAFETY: ends the process; nothing is buffered in it.
        unsafe { libc::_exit(code) }
    }

    /// Help where a plug-in may have ended the program.
    const ENDLESS: &str = "expected a plug-in that does not end the program; --plugin-process runs it in a process of its own, which may";

    /// Says what ended the program.
    fn announce(shared: &Shared, what: &str, help: &str) {
        let clause =
            shared.suspects(None, "that the program did not ask for, after work of a plug-in; the last ran ");
        let whose = match clause.parts() {
            [] => "of which the program knows nothing".into(),
            parts => String::from_utf8_lossy(&parts.concat()).into_owned(),
        };
        eprint!("\nerror: {what} {whose}\n |\n = help: {help}\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clause(shared: &Shared, current: Option<&PluginWork>) -> String {
        String::from_utf8(shared.suspects(current, "after ").parts().concat()).unwrap_or_default()
    }

    #[test]
    fn a_plugin_is_named_alone_only_if_it_runs_alone() {
        let shared = Shared::new();
        assert_eq!(clause(&shared, None), "");
        let [a, b] = ["in a", "in b"].map(|text| shared.begin(text));
        let (Some(a), Some(b)) = (a, b) else { panic!("no room") };
        assert_eq!(
            clause(&shared, None),
            "while several plug-ins ran; the last began in b; also running: in a"
        );
        assert_eq!(clause(&shared, Some(a)), "in a", "the thread's own");
        b.end();
        assert_eq!(clause(&shared, None), "in a");
        a.end();
        assert_eq!(clause(&shared, None), "after in b", "the last to begin");
    }

    /// More than there is room for at once, and more after another.
    #[test]
    fn works_without_room_are_not_listed_and_the_last_one_stays_known() {
        let shared = Shared::new();
        for place in 0..3 * MAX_WORK_COUNT {
            let Some(work) = shared.begin(&format!("in {place}")) else { panic!("no room") };
            work.end();
            assert_eq!(clause(&shared, None), format!("after in {place}"));
        }
        let works = [(); MAX_WORK_COUNT].map(|()| shared.begin(&"x".repeat(2 * MAX_TEXT_BYTES)));
        assert!(works.iter().all(Option::is_some) && shared.begin("in one more").is_none());
        assert!(shared.suspects(None, "").parts().len() <= MAX_PART_COUNT);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_program_with_other_threads_is_not_divided() {
        let (sender, receiver) = std::sync::mpsc::channel::<()>();
        let other = std::thread::spawn(move || receiver.recv());
        let refused = supervise();
        drop(sender);
        assert!(other.join().is_ok_and(|ended| ended.is_err()));
        assert_eq!(refused, Err("the program has other threads already".into()));
    }
}
