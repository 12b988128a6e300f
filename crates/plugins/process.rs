//! Plug-ins in a process of their own: a crash ends that, and not the program.
//!
//! The program starts itself again for each piece of work (`voltet plugin-process PATH`, which help does not list), sends the
//! inputs through a pipe, and receives progress, status and output through another. To cancel the work it ends the process. The
//! process loads and calls the library as the program would.

use crate::call::{CallOutput, Outcome, Task};
use crate::declaration::{Declaration, Family};
use crate::file::PluginFile;
use crate::guard;
use crate::host::{CallLabel, CallStatus, State};
use crate::item::{PluginItem, Runner};
use crate::library;
use crate::wire::{Wire, garbled, wire};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Request to the process: hash of the file that it must load, and a task of the item of that name, or `None` for a description of the
/// library.
type Request = (u64, Option<(String, Task)>);

/// Reply of the process. `Progress` is followed by more, and `Status` by `Outcome`.
enum Reply {
    Progress(f64),
    /// Name and version of the plug-in, and its items.
    Described((String, String), Vec<Declaration>),
    /// Error of loading: what, found, expected.
    Failed(String, Option<String>, Option<String>),
    Status(CallStatus),
    Outcome(Outcome),
}

wire!(variants of Reply {
    0 = Progress(fraction),
    1 = Described(plugin, items),
    2 = Failed(what, found, expected),
    3 = Status(status),
    4 = Outcome(outcome)
});

wire!(fields of Declaration { schema, family, checks, components });
wire!(variants of Family {
    0 = GradientFilter { needs },
    1 = Reader { extensions, magic },
    2 = GridFilter { made },
    3 = ImageFilter
});
wire!(fields of VariantSchema { name, summary, parameters });
wire!(fields of Parameter { name, parameter_type, unit, default, help });
wire!(fields of Range { min, max, above_min, below_max, infinite });

// Types and defaults of the parameters that a plug-in can declare.
wire!(variants of ParameterType {
    0 = Boolean,
    1 = Integer(range),
    2 = Number(range),
    3 = Choice(words),
    4 = Numbers(count, range),
    5 = Text,
    6 = ArrayName
});
wire!(variants of DefaultValue {
    0 = Required,
    1 = Unset(meaning),
    2 = Boolean(flag),
    3 = Integer(number),
    4 = Number(number),
    5 = Text(text),
    6 = Numbers(numbers)
});

impl Reply {
    fn from_error(error: &Error) -> Reply {
        Reply::Failed(error.what.clone(), error.got.clone(), error.expected.clone())
    }

    /// Sends it at once.
    fn reply(&self, to: &mut dyn Write) -> io::Result<()> {
        self.send(to)?;
        to.flush()
    }

    /// The next reply; `None` at the end.
    fn receive_next(from: &mut impl BufRead) -> io::Result<Option<Reply>> {
        if from.fill_buf()?.is_empty() {
            return Ok(None);
        }
        match Reply::receive(from)? {
            Reply::Outcome(outcome) if !outcome.is_consistent() => Err(garbled()),
            reply => Ok(Some(reply)),
        }
    }
}

/// Longest time of a description or a check.
const START_TIME_LIMIT: Duration = Duration::from_secs(30);

/// Runner of a library in processes of `program`.
struct Remote {
    program: PathBuf,
    plugin: Plugin,
}

/// The items of the library at `path`, which run in processes of `program`.
pub(crate) fn load(file: &PluginFile, program: PathBuf) -> Result<Vec<PluginItem>> {
    let (plugin, path) = (file.plugin(), file.path());
    let start = Instant::now();
    let broken = |how: String| {
        Error::usage("the plug-in cannot be loaded").got(format!("its process {how}")).in_file(path)
    };
    let request = (plugin.fingerprint, None);
    let end = exchange(&program, path, &request, |_| start.elapsed() < START_TIME_LIMIT);
    let replies = match end {
        RequestOutcome::Replied(replies) => replies,
        RequestOutcome::GivenUp => {
            return Err(broken(format!("did not begin within {} s", START_TIME_LIMIT.as_secs())));
        }
        RequestOutcome::Broken(how) => return Err(broken(how)),
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

    fn run(&self, declaration: &Declaration, task: Task, progress: &dyn Progress) -> Result<CallOutput> {
        let label = CallLabel::new(declaration, &self.plugin);
        let broken = |how: String| label.error(&how).expected("a plug-in that answers; the program goes on");
        let (is_check, stage, start) = (matches!(task, Task::Check(_)), task.stage(), Instant::now());
        let request = (self.plugin.fingerprint, Some((declaration.schema.name.into(), task)));
        let may_go_on = |fraction| {
            if is_check {
                return start.elapsed() < START_TIME_LIMIT;
            }
            progress.report(stage, fraction);
            !progress.cancelled()
        };
        let replies = match exchange(&self.program, &self.plugin.path, &request, may_go_on) {
            RequestOutcome::Replied(replies) => replies,
            RequestOutcome::GivenUp if is_check => {
                return Err(label.error("does not come back from checking its parameters"));
            }
            RequestOutcome::GivenUp => return Err(Error::cancelled()),
            RequestOutcome::Broken(how) => return Err(broken(how)),
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

enum RequestOutcome {
    /// With replies, complete or not.
    Replied(Vec<Reply>),
    /// The process was ended because the request was given up.
    GivenUp,
    /// The process failed; a clause such as "crashed with signal 11 (SIGSEGV)".
    Broken(String),
}

/// Sends a request about the library at `path` to a process of `program`. `may_go_on` is called with the completed fraction every
/// few milliseconds; once it is false the process is ended.
fn exchange(
    program: &Path,
    path: &Path,
    request: &Request,
    mut may_go_on: impl FnMut(f64) -> bool,
) -> RequestOutcome {
    let mut command = Command::new(program);
    command.arg("plugin-process").arg(path).stdin(Stdio::piped()).stdout(Stdio::piped());
    #[cfg(unix)]
    // Ctrl-C at a terminal goes to the program alone.
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return RequestOutcome::Broken(format!("cannot be started: {error}")),
    };
    let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        return RequestOutcome::Broken("has no pipes".into());
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
            (true, ..) => RequestOutcome::GivenUp,
            (_, Some(error), Ok(status)) if status.success() => RequestOutcome::Broken(error.to_string()),
            (_, Some(error), Ok(status)) if is_killed(&status) => {
                RequestOutcome::Broken(format!("answered what was not asked: {error}"))
            }
            (_, _, Ok(status)) if status.success() => RequestOutcome::Replied(replies),
            (_, _, Ok(status)) => RequestOutcome::Broken(exit_message(status)),
            (_, _, Err(error)) => RequestOutcome::Broken(format!("cannot be waited for: {error}")),
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

/// Loads the library at `path`, runs the request of the standard input, replies on the standard output, and ends the process.
///
/// Prints of the library go to the standard error. The process ends when its parent does.
pub fn run_child(path: &Path) -> ! {
    guard::disable_crash_messages();
    // The output stays open until the end: the parent takes its end for that of the process.
    let output = own_output();
    let replied = output.and_then(|mut output| reply(path, &mut output).map(|()| output));
    // An error: the parent is gone.
    exit_now(i32::from(replied.is_err()))
}

fn reply(path: &Path, output: &mut dyn Write) -> io::Result<()> {
    let mut input = io::stdin();
    let (fingerprint, request) = Request::receive(&mut input.lock())?;
    std::thread::spawn(move || {
        // No more input comes, so this returns when the other end is closed.
        let _ = io::copy(&mut input.by_ref(), &mut io::sink());
        exit_now(1)
    });
    let loaded = PluginFile::read(path).and_then(|file| match file.plugin().fingerprint == fingerprint {
        true => library::load(&file),
        false => {
            let error = Error::usage("the plug-in is not the one that was described: its file has changed");
            Err(error.expected("the program begun again"))
        }
    });
    let native = match loaded {
        Ok(native) => native,
        Err(error) => return Reply::from_error(&error).reply(output),
    };
    let gone = || io::Error::new(io::ErrorKind::NotFound, "there is no such filter any more");
    match request {
        None => {
            let Plugin { name, version, .. } = native.plugin().clone();
            Reply::Described((name, version), native.declarations()).reply(output)
        }
        Some((name, task)) => {
            let item = native.items.iter().find(|item| item.declaration.schema.name == name);
            let item = item.cloned().ok_or_else(gone)?;
            let state = Arc::new(State::default());
            let work = {
                let state = state.clone();
                move || task.run(&item, &state)
            };
            let mut reported = 0.0;
            let called = guard::run(work, || {
                let fraction = state.fraction();
                let may_go_on = fraction == reported || Reply::Progress(fraction).reply(output).is_ok();
                reported = fraction;
                may_go_on
            });
            let (status, outcome) = called.map_err(|_| gone())?;
            Reply::Status(status).reply(output)?;
            Reply::Outcome(outcome).reply(output)
        }
    }
}

/// The standard output for replies alone: other prints go to the standard error.
#[cfg(unix)]
fn own_output() -> io::Result<impl Write> {
    use std::os::fd::{AsFd, FromRawFd};
    let own = io::stdout().as_fd().try_clone_to_owned()?;
    // SAFETY: both are open; nothing in this process has written to the standard output yet.
    if unsafe { libc::dup2(2, 1) } < 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: the descriptor was just made and belongs to nobody else.
    Ok(unsafe { File::from_raw_fd(std::os::fd::IntoRawFd::into_raw_fd(own)) })
}

#[cfg(not(unix))]
fn own_output() -> io::Result<impl Write> {
    Ok(io::stdout())
}

/// Ends the process without the exit handlers of a library, whose functions may still run.
#[cfg(unix)]
fn exit_now(code: i32) -> ! {
    // SAFETY: ends the process.
    unsafe { libc::_exit(code) }
}

#[cfg(not(unix))]
fn exit_now(code: i32) -> ! {
    std::process::exit(code)
}
