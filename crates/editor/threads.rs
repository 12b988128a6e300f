//! Threads that compute. They give way to the one that draws the window, which answers a hand.

use std::thread::{Builder, JoinHandle};

/// Niceness of threads that compute (setpriority(2)): beside the window's, 0, one has a quarter of the time of a processor that both want.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 5;

/// Begins a thread that computes.
pub(crate) fn begin<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> std::io::Result<JoinHandle<T>> {
    Builder::new().name(name.into()).spawn(move || {
        give_way();
        work()
    })
}

/// Has the threads among which work is divided give way.
pub(crate) fn divided_work_gives_way() {
    rayon::spawn_broadcast(|_| give_way());
}

/// Has the calling thread give way. Elsewhere than under Linux niceness is of all the process, the window's thread included.
fn give_way() {
    #[cfg(target_os = "linux")]
    // SAFETY: the call takes numbers alone. A thread may always take a greater niceness; if one keeps its own, the window is slower.
    unsafe {
        libc::setpriority(libc::PRIO_PROCESS, 0, NICENESS);
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn work_gives_way_and_its_caller_does_not() {
        let niceness = || {
            let status = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            // Fields follow the name in brackets; niceness is the 19th (proc_pid_stat(5)).
            let after = status.rsplit_once(") ").unwrap().1;
            after.split(' ').nth(16).unwrap().parse::<i32>().unwrap()
        };
        let own = niceness();
        assert_eq!(begin("work", niceness).unwrap().join().unwrap(), NICENESS);
        assert_eq!(niceness(), own);
    }
}
