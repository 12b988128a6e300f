//! One piece of work of the process of a plug-in, as the program sees it.

use super::messages::{Answer, Request};
use std::io::{BufReader, BufWriter};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often the one who waits looks around.
const PAUSE: Duration = Duration::from_millis(10);

/// How it ended.
pub(super) enum End {
    /// With answers, all that were promised or not.
    Answered(Vec<Answer>),
    /// It was given up, and ended.
    GivenUp,
    /// It did not end well; a clause such as "crashed with signal 11 (SIGSEGV)".
    Broken(String),
}

/// Has `program` ask the library at `path`, while `waits` says so, which is asked every few milliseconds and told what part is
/// done.
pub(super) fn hold(
    program: &Path,
    path: &Path,
    request: &Request,
    mut waits: impl FnMut(f64) -> bool,
) -> End {
    let mut command = Command::new(program);
    command.arg("plugin-process").arg(path).stdin(Stdio::piped()).stdout(Stdio::piped());
    #[cfg(unix)]
    // Ctrl-C at a terminal is the program's to hear.
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
        // Its end of the pipe stays open until all is heard: the process ends when it is closed. What cannot be written shows in
        // how the process ends.
        let asking = scope.spawn(move || {
            let mut input = BufWriter::new(input);
            let _ = request.write(&mut input);
            input
        });
        scope.spawn(move || {
            let mut output = BufReader::new(output);
            loop {
                let answer = Answer::read(&mut output);
                let is_last = !matches!(answer, Ok(Some(_)));
                if sender.send(answer).is_err() || is_last {
                    return;
                }
            }
        });
        let (mut answers, mut fraction, mut garbled, mut given_up) = (Vec::new(), 0.0, None, false);
        loop {
            match receiver.recv_timeout(PAUSE) {
                Ok(Ok(Some(Answer::Progress(done)))) => fraction = done,
                Ok(Ok(Some(answer))) => answers.push(answer),
                Ok(Ok(None)) => break,
                Ok(Err(error)) => {
                    garbled = Some(error);
                    break;
                }
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {
                    // What it began itself may hold the pipes open.
                    if matches!(child.try_wait(), Ok(Some(_))) {
                        kill(&mut child);
                    }
                }
            }
            if !given_up && !waits(fraction) {
                given_up = true;
                kill(&mut child);
            }
        }
        if garbled.is_some() {
            kill(&mut child);
        }
        // It has said all; it may still want to end by itself.
        drop(asking.join());
        let status = child.wait();
        match (given_up, garbled, status) {
            (true, ..) => End::GivenUp,
            (_, Some(error), Ok(status)) if status.success() => End::Broken(error.to_string()),
            (_, Some(error), Ok(status)) if is_killed(&status) => {
                End::Broken(format!("answered what was not asked: {error}"))
            }
            (_, _, Ok(status)) if status.success() => End::Answered(answers),
            (_, _, Ok(status)) => End::Broken(in_words(status)),
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

fn in_words(status: ExitStatus) -> String {
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
