//! The process of a plug-in.

use super::messages::{Answer, Request, failed};
use crate::apart;
use crate::crash;
use crate::describe::Declared;
use crate::host::State;
use crate::library;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;

/// Loads the library at `path`, does what the standard input asks for, answers on the standard output, and ends the process.
///
/// What the library itself prints goes to the standard error. Where whoever asked goes away, the process ends.
pub fn serve(path: &Path) -> ! {
    crash::leave();
    // Until the end the output stays open: who listens takes its end for ours.
    let output = own_output();
    let answered = output.and_then(|mut output| answer(path, &mut output).map(|()| output));
    // An error: nobody listens.
    leave_now(i32::from(answered.is_err()))
}

fn answer(path: &Path, mut output: &mut impl Write) -> io::Result<()> {
    let mut input = io::stdin();
    let request = Request::read(&mut input.lock())?;
    std::thread::spawn(move || {
        // Nothing more is said, so this comes back when the other end is closed.
        let _ = io::copy(&mut input.by_ref(), &mut io::sink());
        leave_now(1)
    });
    let (library, filters) = match library::load(path) {
        Ok(loaded) => loaded,
        Err(error) => return failed(&error).write(&mut output),
    };
    let find = |name: &str| filters.iter().find(|filter| filter.declared.kind.name == name).cloned();
    let gone = || io::Error::new(io::ErrorKind::NotFound, "there is no such filter any more");
    match request {
        Request::Describe => {
            let filters: Vec<Declared> = filters.iter().map(|filter| filter.declared.clone()).collect();
            let plugin = [library.plugin.name.clone(), library.plugin.version.clone()];
            Answer::Described(plugin, filters).write(&mut output)
        }
        Request::Do(name, task) => {
            let piece = find(&name).ok_or_else(gone)?;
            let state = Arc::new(State::default());
            let work = {
                let state = state.clone();
                move || task.carry_out(&piece, &state)
            };
            let mut told = 0.0;
            let called = apart::run(work, || {
                let fraction = state.fraction();
                let goes_on = fraction == told || Answer::Progress(fraction).write(&mut output).is_ok();
                told = fraction;
                goes_on
            });
            let (said, outcome) = called.map_err(|_| gone())?;
            Answer::Said(said).write(&mut output)?;
            Answer::Made(outcome).write(&mut output)
        }
    }
}

/// The standard output for answers alone: what else is printed goes to the standard error.
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

/// Ends without what a library wants to do at the end: its functions may still run.
#[cfg(unix)]
fn leave_now(code: i32) -> ! {
    // SAFETY: ends the process.
    unsafe { libc::_exit(code) }
}

#[cfg(not(unix))]
fn leave_now(code: i32) -> ! {
    std::process::exit(code)
}
