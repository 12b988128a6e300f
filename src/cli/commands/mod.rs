//! The commands, one file each: a function that returns the exit code, or an error.

mod blocks;
mod convert;
mod diff;
#[cfg(feature = "editor")]
mod edit;
mod explain;
mod first_view;
mod gradient_test;
mod info;
mod nodes;
#[cfg(feature = "papers")]
mod papers;
mod pixel;
mod plugins;
mod run;
mod shared;
mod shell;
mod stability;
mod start;
mod study;
mod time;

use super::arguments::{Arguments, Command, Inputs};
use super::present::print;
use super::process::command_line;
use crate::Document;
use crate::core::{Error, Result, counted};
use crate::graph::Registry;
use crate::io::{formats, memory};
use crate::lanes::LaneSet;
use crate::nodes::files;
use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue};
use shared::{DONE, Outcome, WRONG, show};
use std::error::Error as _;
use std::io::ErrorKind;
use std::path::PathBuf;

/// Carries out the command, shows its error if there is one, and gives the exit code. What the environment asks for is looked
/// at first.
pub fn dispatch(arguments: &Arguments, registry: Result<Registry>) -> u8 {
    let registry = LaneSet::detect().and(registry).and_then(|registry| match arguments.command.inputs() {
        Some(inputs) => plugins::with(registry, inputs.plugins, |known| is_sufficient(&inputs, known)),
        None => Ok(registry),
    });
    let outcome = registry.map_err(Into::into).and_then(|known| run_command(&arguments.command, &known));
    outcome.unwrap_or_else(|failure| show(&failure))
}

/// True if the registry suffices for the command: then the user's file of plug-ins is not read, and none of their code runs.
/// Pipelines must open, data files be of a format that ships. A command without files lists what there is.
fn is_sufficient(inputs: &Inputs, registry: &Registry) -> bool {
    let is_plain = |data: &PathBuf| info::is_picture(data) || formats::foreign_head(data).is_none();
    // A pipe can be read once.
    let opens = |file: &PathBuf| {
        file.is_file()
            && Document::open(file, inputs.options, registry).is_ok_and(|own| !own.graph.has_foreign_files())
    };
    let has_files = !(inputs.pipelines.is_empty() && inputs.data.is_empty());
    has_files && inputs.pipelines.iter().all(opens) && inputs.data.iter().all(is_plain)
}

/// Carries out `help NAME` where that is no command but a node type or a gradient filter; `None` for other command lines.
pub fn help_of_node(registry: &Result<Registry>) -> Option<u8> {
    let mut words = command_line().iter().skip(1).filter_map(|word| word.to_str());
    let name = words.next().filter(|word| *word == "help").and_then(|_| words.next())?;
    let text = nodes::one(name, false, registry.as_ref().ok()?).ok()?;
    Some(print(&text).map_or_else(|error| show(&error.into()), |_| DONE))
}

/// Shows clap's answer to the command line, help or an error, and returns the exit code.
pub fn answer(answer: &clap::Error, registry: &Result<Registry>) -> u8 {
    if let Some(ContextValue::String(name)) = answer.get(ContextKind::InvalidSubcommand) {
        return show(&unknown_command(name, registry).into());
    }
    if let (Some(expected), Some(ContextValue::String(option)), Some(ContextValue::String(found))) =
        (number(answer), answer.get(ContextKind::InvalidArg), answer.get(ContextKind::InvalidValue))
    {
        let error = Error::usage(format!("the value of {option} is no such number"));
        return show(&error.got(format_args!("'{found}'")).expected(expected).into());
    }
    let wanted = u8::try_from(answer.exit_code()).unwrap_or(WRONG);
    match answer.print() {
        Err(error) if !answer.use_stderr() && error.kind() != ErrorKind::BrokenPipe => {
            show(&files::unwritable_output(&error).into())
        }
        _ => wanted,
    }
}

/// The numbers among which a value should have been, where that is the error.
fn number(answer: &clap::Error) -> Option<&'static str> {
    let source = answer.source()?;
    let is_whole = source.is::<std::num::ParseIntError>() || source.is::<std::num::TryFromIntError>();
    is_whole
        .then_some("a whole number")
        .or_else(|| source.is::<std::num::ParseFloatError>().then_some("a number such as 0.5 or 1e-3"))
}

/// The error for a command that there is not, or a name that `help` does not know.
fn unknown_command(name: &str, registry: &Result<Registry>) -> Error {
    let commands = Arguments::command();
    let shown = commands.get_subcommands().filter(|command| !command.is_hide_set());
    let mut names: Vec<&str> = shown.map(|command| command.get_name()).collect();
    let is_help = command_line().get(1).is_some_and(|word| word == "help");
    let what = match registry {
        Ok(registry) if is_help => {
            nodes::names(registry).for_each(|name| names.push(name));
            "command, node type or gradient filter"
        }
        _ => "command",
    };
    Error::usage(format!("unknown {what} '{name}'")).not_among(name, names)
}

/// Starts the worker threads while there is memory for them: later their failure would look like a defect of the program. A
/// program around this one may have started them.
fn begin_threads() -> Result<()> {
    let none = |why: &dyn std::fmt::Display| {
        let wish =
            "more memory, a higher limit of processes, or fewer threads by the variable RAYON_NUM_THREADS";
        Err(Error::run("no threads can be had to work with").got(why).expected(wish))
    };
    // Not tried where it is known before: those that have begun would meet the end of memory, too, each in its own way.
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|count| count.parse::<u64>().ok());
    if let (Some(count), Some(left)) = (asked, memory::address_space())
        && left < count.saturating_mul(STACK)
    {
        let (stack, left) = (STACK >> 20, left >> 20);
        return none(&format!(
            "{} with stacks of {stack} MiB each, {left} MiB are left",
            counted(count, "thread")
        ));
    }
    let begun = rayon::ThreadPoolBuilder::new().build_global();
    match begun.as_ref().err().and_then(|error| error.source()) {
        Some(why) => none(&why),
        None => Ok(()),
    }
}

/// Stack of a thread (bytes), as the standard library reserves it.
const STACK: u64 = 2 << 20;

fn run_command(command: &Command, registry: &Registry) -> Outcome {
    // These list, or do what a plug-in does.
    if !matches!(command, Command::Nodes(_) | Command::PluginProcess { .. }) {
        begin_threads()?;
    }
    match command {
        Command::Run(arguments) => run::run(arguments, registry),
        Command::Check(arguments) => explain::check(arguments, registry),
        Command::Explain(arguments) => explain::explain(arguments, registry),
        Command::Nodes(arguments) => nodes::nodes(arguments, registry),
        Command::Info(arguments) => info::info(arguments, registry),
        Command::Start(arguments) => start::start(arguments, registry),
        Command::Convert(arguments) => convert::convert(arguments, registry),
        #[cfg(feature = "editor")]
        Command::Edit(arguments) => edit::edit(arguments, registry),
        #[cfg(not(feature = "editor"))]
        Command::Edit(_) => {
            let error = Error::usage("this program was built without the node editor");
            Err(error.expected("one built by `cargo build --release --features editor`").into())
        }
        Command::Pixel(arguments) => pixel::pixel(arguments, registry),
        Command::Diff(arguments) => diff::diff(arguments),
        Command::Stability(arguments) => stability::stability(arguments),
        Command::Study(arguments) => study::study(arguments, registry),
        Command::Time(arguments) => time::time(arguments, registry),
        #[cfg(feature = "papers")]
        Command::Papers(arguments) => papers::papers(arguments, registry),
        Command::GradientTest(arguments) => gradient_test::gradient_test(arguments, registry),
        Command::Completions(arguments) => shell::completions(arguments),
        Command::Man(arguments) => shell::manual(arguments),
        Command::PluginProcess { path } => voltet_plugins::run_child(path),
    }
}
