//! Plug-ins in a process of their own: a crash ends that, and not the program.
//!
//! The program starts itself again for each piece of work (`voltet plugin-process PATH`, which help does not list), sends the
//! inputs through a pipe, and receives progress, status and output through another. To cancel the work it ends the process. The
//! process loads and calls the library as the program would.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `messages` | requests and replies |
//! | `child` | side of the process |

mod child;
mod messages;

pub use child::run_child;

use crate::declaration::Declaration;
use crate::library::read_file;
use crate::runner::{PluginItem, Runner};
use crate::status::{CallLabel, CallStatus};
use crate::task::{CheckTask, Outcome, Task};
use crate::wire::Wire;
use messages::{Reply, Request};
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Longest time of a description or a check.
const START_TIME_LIMIT: Duration = Duration::from_secs(30);

/// Runner of a library in processes of `program`.
struct Remote {
    program: PathBuf,
    plugin: Plugin,
}

/// The items of the library at `path`, which run in processes of `program`.
pub(crate) fn load(path: &Path, program: PathBuf) -> Result<Vec<PluginItem>> {
    let (plugin, _) = read_file(path)?;
    let start = Instant::now();
    let broken = |how: String| {
        Error::usage("the plug-in cannot be loaded").got(format!("its process {how}")).in_file(path)
    };
    let end = exchange(&program, path, &Request::Describe, |_| start.elapsed() < START_TIME_LIMIT);
    let replies = match end {
        End::Replied(replies) => replies,
        End::GivenUp => return Err(broken(format!("did not begin within {} s", START_TIME_LIMIT.as_secs()))),
        End::Broken(how) => return Err(broken(how)),
    };
    let ((name, version), declarations) = match replies.into_iter().next() {
        Some(Reply::Described(names, declarations)) => (names, declarations),
        Some(Reply::Failed(what, got, expected)) => return Err(failed(what, got, expected, path)),
        Some(Reply::Status(_) | Reply::Outcome(_) | Reply::Progress(_)) | None => {
            return Err(broken("did not describe it".into()));
        }
    };
    let plugin = Plugin { name, version, ..plugin };
    Ok(PluginItem::list(Arc::new(Remote { program, plugin }), declarations))
}

impl Runner for Remote {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(
        &self,
        declaration: &Declaration,
        task: Box<dyn Task>,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)> {
        let label = CallLabel::new(declaration, &self.plugin);
        let (now, _) = read_file(&self.plugin.path)?;
        if now.fingerprint != self.plugin.fingerprint {
            let error = label.error("is not the one that was described: its file has changed");
            return Err(error.expected("the program begun again"));
        }
        let broken = |how: String| label.error(&how).expected("a plug-in that answers; the program goes on");
        let (is_check, stage, start) =
            (task.kind().tag == CheckTask::KIND.tag, task.kind().stage, Instant::now());
        let request = Request::Run(declaration.schema.name.into(), task);
        let may_go_on = |fraction| {
            if is_check {
                return start.elapsed() < START_TIME_LIMIT;
            }
            progress.report(stage, fraction);
            !progress.cancelled()
        };
        let replies = match exchange(&self.program, &self.plugin.path, &request, may_go_on) {
            End::Replied(replies) => replies,
            End::GivenUp if is_check => {
                return Err(label.error("does not come back from checking its parameters"));
            }
            End::GivenUp => return Err(Error::cancelled()),
            End::Broken(how) => return Err(broken(how)),
        };
        let mut replies = replies.into_iter();
        match (replies.next(), replies.next()) {
            (Some(Reply::Status(status)), Some(Reply::Outcome(outcome))) => Ok((status, outcome)),
            (Some(Reply::Failed(what, got, expected)), _) => {
                Err(failed(what, got, expected, &self.plugin.path))
            }
            _ => Err(broken("did not answer".into())),
        }
    }
}

/// The error of [`Reply::from_error`].
fn failed(what: String, got: Option<String>, expected: Option<String>, path: &Path) -> Error {
    Error { got, expected, ..Error::usage(what) }.in_file(path)
}

/// Interval between two calls of `may_go_on`.
const INTERVAL: Duration = Duration::from_millis(10);

/// Ends of a request.
enum End {
    /// With replies, complete or not.
    Replied(Vec<Reply>),
    /// The process was ended because the request was given up.
    GivenUp,
    /// The process failed; a clause such as "crashed with signal 11 (SIGSEGV)".
    Broken(String),
}

/// Sends a request about the library at `path` to a process of `program`. `may_go_on` is called with the completed fraction every
/// few milliseconds; once it is false the process is ended.
fn exchange(program: &Path, path: &Path, request: &Request, mut may_go_on: impl FnMut(f64) -> bool) -> End {
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
            let _ = request.send(&mut input).and_then(|()| input.flush());
            input
        });
        scope.spawn(move || {
            let mut output = BufReader::new(output);
            loop {
                let reply = Reply::receive_next(&mut output);
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
