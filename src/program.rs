//! The program: parses the command line and hands over.

use crate::core::Result;
use crate::graph::Registry;
use crate::{arguments::Arguments, commands, mistake};
use clap::Parser;
use std::panic::AssertUnwindSafe;
use std::process::ExitCode;

/// The program `voltet` with these nodes and filters: carries out the command line of the process, writes what the command
/// has to say, and gives the exit code. An error of the registry is shown as those of a command are.
///
/// ```no_run
/// # fn program() -> std::process::ExitCode {
/// voltet::run(voltet::registry())
/// # }
/// ```
pub fn run(registry: Result<Registry>) -> ExitCode {
    quieten_drivers();
    mistake::show_in_one_line();
    // A panic was shown where it happened.
    std::panic::catch_unwind(AssertUnwindSafe(|| match Arguments::try_parse() {
        Ok(arguments) => commands::dispatch(&arguments, registry),
        Err(answer) => ExitCode::from(commands::answer(&answer)),
    }))
    .unwrap_or(ExitCode::from(mistake::FAILED))
}

/// Keeps Mesa's choice of a device from asking a window system that is not there: it complains on standard error. Where
/// other threads run already, it may complain.
fn quieten_drivers() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() && is_alone() {
        // Safety: no other thread runs, so none reads the environment meanwhile.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Whether this is the only thread of the process, as Linux lists them.
fn is_alone() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}

/// The registry of the program: the nodes, gradient filters and integrators that ship, and the integrators for studies.
pub fn registry() -> Result<Registry> {
    let mut registry = crate::nodes::registry()?;
    voltet_integrators::register(&mut registry)?;
    Ok(registry)
}
