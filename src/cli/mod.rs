//! The command line: parses it, carries out the command, and gives the exit code.
//!
//! | module | responsibility |
//! | --- | --- |
//! | `arguments` | options of every command |
//! | `commands` | one file a command |
//! | `panic_hook` | panics and the end of memory in one line |
//! | `present` | messages, progress bars and reports for people |
//! | `process` | threads, exit codes and the end of the process |
//! | `ranks` | processes of one run, by MPI |

mod arguments;
mod commands;
mod panic_hook;
mod present;
mod process;
mod ranks;

pub use panic_hook::ExitOnOutOfMemory;

use crate::core::Result;
use crate::graph::Registry;
use arguments::Arguments;
use clap::Parser;
use process::{FAILED, command_line, is_single_threaded};
use std::ffi::OsString;
use std::panic::AssertUnwindSafe;
use std::process::ExitCode;

/// Runs the program `voltet` with these nodes and filters: carries out the command line of the process, writes the command's
/// output, and returns the exit code. An error of the registry is shown like those of a command.
///
/// ```no_run
/// # fn program() -> std::process::ExitCode {
/// voltet::run(voltet::registry())
/// # }
/// ```
pub fn run(registry: Result<Registry>) -> ExitCode {
    ExitCode::from(exit_code(registry))
}

/// Like [`run`], within a process of another program, such as an interpreter's: with this command line (the file that starts the
/// program, then its arguments), to the exit code. Once in a process.
pub fn run_command_line(words: Vec<OsString>, registry: Result<Registry>) -> u8 {
    process::give_command_line(words);
    exit_code(registry)
}

fn exit_code(registry: Result<Registry>) -> u8 {
    quieten_drivers();
    panic_hook::install();
    // A panic was shown where it happened.
    let ended =
        std::panic::catch_unwind(AssertUnwindSafe(|| match Arguments::try_parse_from(command_line()) {
            Ok(arguments) => {
                note_former_options();
                commands::dispatch(&arguments, registry)
            }
            Err(answer) => {
                commands::help_of_node(&registry).unwrap_or_else(|| commands::answer(&answer, &registry))
            }
        }));
    let exit_code = ended.unwrap_or(FAILED);
    voltet_plugins::state_exit(exit_code);
    exit_code
}

/// The registry of the program: the nodes, gradient filters and integrators that ship, the reference integrator and those for studies.
///
/// Errors: declarations that contradict each other.
pub fn registry() -> Result<Registry> {
    let mut registry = crate::nodes::registry()?;
    voltet_reference::register(&mut registry)?;
    voltet_integrators::register(&mut registry)?;
    Ok(registry)
}

/// Former names of options, each with the present one; the parser takes both.
const FORMER_OPTIONS: [(&str, &str); 1] = [("--no-leave-out", "--exhaustive")];

/// Prints a note for each option that was given by its former name.
fn note_former_options() {
    for (former, present) in FORMER_OPTIONS {
        if command_line().iter().any(|argument| argument == former) {
            present::say(&format!("note: {former} is now called {present}\n"));
        }
    }
}

/// Disables Mesa's device-selection layer where there is no window system: it prints a complaint on standard error. Does
/// nothing where other threads run already.
fn quieten_drivers() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() && is_single_threaded() {
        // Safety: no other thread runs, so none reads the environment meanwhile.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
