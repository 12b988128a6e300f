//! The commands, one file each: a function that gives the exit code, or the error that ends it.

mod check;
mod explain;
mod findings;
mod info;
mod nodes;
mod outcome;
mod pipelines;
mod run;
mod stability;
mod study;
mod time;

use crate::arguments::{Arguments, Command};
use crate::core::Result;
use crate::core::graph::Registry;
use outcome::show;
use std::process::ExitCode;

/// Carries out the command, shows its error if there is one, and gives the exit code.
pub fn dispatch(arguments: &Arguments, registry: Result<Registry>) -> ExitCode {
    let outcome = registry.and_then(|registry| carry_out(&arguments.command, &registry));
    ExitCode::from(outcome.unwrap_or_else(|error| show(&error, None)))
}

fn carry_out(command: &Command, registry: &Registry) -> Result<u8> {
    match command {
        Command::Run(arguments) => run::run(arguments, registry),
        Command::Check(arguments) => check::check(arguments, registry),
        Command::Explain(arguments) => explain::explain(arguments, registry),
        Command::Nodes(arguments) => nodes::nodes(arguments, registry),
        Command::Info(arguments) => info::info(arguments, registry),
        Command::Stability(arguments) => stability::stability(arguments),
        Command::Study(arguments) => study::study(arguments, registry),
        Command::Time(arguments) => time::time(arguments, registry),
    }
}
