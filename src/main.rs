//! The program: parses the command line and hands over.

mod arguments;
mod commands;
mod present;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    commands::dispatch(arguments::Arguments::parse())
}
