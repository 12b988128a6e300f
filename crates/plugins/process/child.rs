//! Side of the process that a plug-in runs in.

use super::messages::{Reply, Request};
use crate::crash;
use crate::host::State;
use crate::library;
use crate::watchdog;
use crate::wire::Wire;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;

/// Loads the library at `path`, runs the request of the standard input, replies on the standard output, and ends the process.
///
/// Prints of the library go to the standard error. The process ends when its parent does.
pub fn run_child(path: &Path) -> ! {
    crash::disable();
    // The output stays open until the end: the parent takes its end for that of the process.
    let output = own_output();
    let replied = output.and_then(|mut output| reply(path, &mut output).map(|()| output));
    // An error: the parent is gone.
    exit_now(i32::from(replied.is_err()))
}

fn reply(path: &Path, output: &mut dyn Write) -> io::Result<()> {
    let mut input = io::stdin();
    let request = Request::receive(&mut input.lock())?;
    std::thread::spawn(move || {
        // No more input comes, so this returns when the other end is closed.
        let _ = io::copy(&mut input.by_ref(), &mut io::sink());
        exit_now(1)
    });
    let (library, items) = match library::load(path) {
        Ok(loaded) => loaded,
        Err(error) => return Reply::from_error(&error).reply(output),
    };
    let find = |name: &str| items.iter().find(|item| item.declaration.schema.name == name).cloned();
    let gone = || io::Error::new(io::ErrorKind::NotFound, "there is no such filter any more");
    match request {
        Request::Describe => {
            let declarations = items.iter().map(|item| item.declaration.clone()).collect();
            let plugin = (library.plugin.name.clone(), library.plugin.version.clone());
            Reply::Described(plugin, declarations).reply(output)
        }
        Request::Run(name, task) => {
            let item = find(&name).ok_or_else(gone)?;
            let state = Arc::new(State::default());
            let work = {
                let state = state.clone();
                move || task.run(&item, &state)
            };
            let mut reported = 0.0;
            let called = watchdog::run(work, || {
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
