//! One request to the process of a plug-in: the program's side.

use super::messages::{Reply, Request};
use std::io::{BufReader, BufWriter};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Interval between two calls of `may_go_on`.
const INTERVAL: Duration = Duration::from_millis(10);

/// Ends of a request.
pub(super) enum End {
    /// With replies, complete or not.
    Replied(Vec<Reply>),
    /// The process was ended because the request was given up.
    GivenUp,
    /// The process failed; a clause such as "crashed with signal 11 (SIGSEGV)".
    Broken(String),
}

/// Sends a request about the library at `path` to a process of `program`. `may_go_on` is called with the completed fraction every
/// few milliseconds; once it is false the process is ended.
pub(super) fn exchange(
    program: &Path,
    path: &Path,
    request: &Request,
    mut may_go_on: impl FnMut(f64) -> bool,
) -> End {
    let mut command = Command::new(program);
    command.arg("plugin-process").arg(path).stdin(Stdio::piped()).stdout(Stdio::piped());
    #[cfg(unix)]
    // Ctrl-C at a terminal goes to the program alone.
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return End::Broken(format!("cannot be started: {error}")),
    };
    let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        return End::Broken("has no pipes".into());
    };
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        // This end of the pipe stays open until all replies are here: the process ends when it is closed. A failed write shows in the
        // process's end.
        let sender_thread = scope.spawn(move || {
            let mut input = BufWriter::new(input);
            let _ = request.write(&mut input);
            input
        });
        scope.spawn(move || {
            let mut output = BufReader::new(output);
            loop {
                let reply = Reply::read(&mut output);
                let is_last = !matches!(reply, Ok(Some(_)));
                if sender.send(reply).is_err() || is_last {
                    return;
                }
            }
        });
        let (mut replies, mut fraction, mut garbled, mut given_up) = (Vec::new(), 0.0, None, false);
        loop {
            match receiver.recv_timeout(INTERVAL) {
                Ok(Ok(Some(Reply::Progress(done)))) => fraction = done,
                Ok(Ok(Some(reply))) => replies.push(reply),
                Ok(Ok(None)) => break,
                Ok(Err(error)) => {
                    garbled = Some(error);
                    break;
                }
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {
                    // A process that it started may hold the pipes open.
                    if matches!(child.try_wait(), Ok(Some(_))) {
                        kill(&mut child);
                    }
                }
            }
            if !given_up && !may_go_on(fraction) {
                given_up = true;
                kill(&mut child);
            }
        }
        if garbled.is_some() {
            kill(&mut child);
        }
        // All replies are here; the process may still end by itself.
        drop(sender_thread.join());
        let status = child.wait();
        match (given_up, garbled, status) {
            (true, ..) => End::GivenUp,
            (_, Some(error), Ok(status)) if status.success() => End::Broken(error.to_string()),
            (_, Some(error), Ok(status)) if is_killed(&status) => {
                End::Broken(format!("answered what was not asked: {error}"))
            }
            (_, _, Ok(status)) if status.success() => End::Replied(replies),
            (_, _, Ok(status)) => End::Broken(exit_message(status)),
            (_, _, Err(error)) => End::Broken(format!("cannot be waited for: {error}")),
        }
    })
}

#[cfg(unix)]
fn kill(child: &mut Child) {
    // SAFETY: the group that the process was begun with: itself, and what it began.
    unsafe { libc::kill(-(child.id() as libc::pid_t), libc::SIGKILL) };
}

#[cfg(not(unix))]
fn kill(child: &mut Child) {
    let _ = child.kill();
}

#[cfg(unix)]
fn is_killed(status: &ExitStatus) -> bool {
    std::os::unix::process::ExitStatusExt::signal(status) == Some(libc::SIGKILL)
}

#[cfg(not(unix))]
fn is_killed(_: &ExitStatus) -> bool {
    false
}

fn exit_message(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let name = match signal {
            libc::SIGSEGV => " (SIGSEGV)",
            libc::SIGBUS => " (SIGBUS)",
            libc::SIGFPE => " (SIGFPE)",
            libc::SIGILL => " (SIGILL)",
            libc::SIGABRT => " (SIGABRT)",
            libc::SIGKILL => " (SIGKILL: ended from outside, for want of memory perhaps)",
            libc::SIGTRAP => " (SIGTRAP)",
            _ => "",
        };
        return format!("crashed with signal {signal}{name}");
    }
    match status.code() {
        Some(code) => format!("ended with exit code {code} before it answered"),
        None => "ended before it answered".into(),
    }
}
