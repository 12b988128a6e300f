//! The program: parses the command line and hands over.

mod arguments;
mod commands;
mod present;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    quieten_drivers();
    commands::dispatch(arguments::Arguments::parse())
}

/// Keeps Mesa's choice of a device from asking a window system that is not there: it complains on standard error.
fn quieten_drivers() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // Safety: no other thread runs yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
