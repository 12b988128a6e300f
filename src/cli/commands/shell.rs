//! `voltet completions` and `voltet man`: what a shell and `man` know of the program, made from the declarations of its arguments.

use super::shared::{DONE, Outcome};
use crate::cli::arguments::{Arguments, Completions, Manual};
use crate::cli::present::say;
use crate::core::{Error, counted};
use crate::nodes::files::{standard_output, write_whole};
use clap::{Command, CommandFactory};
use clap_mangen::Man;

pub fn completions(arguments: &Completions) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "voltet", &mut script);
    standard_output(&script)?;
    Ok(DONE)
}

pub fn manual(arguments: &Manual) -> Outcome {
    let folder = &arguments.folder;
    let failed = |error: std::io::Error| Error::run("the pages cannot be written").got(error).in_file(folder);
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let commands: Vec<&Command> = std::iter::once(&program).chain(shown).collect();
    for command in &commands {
        let page = Man::new((*command).clone());
        let mut text = Vec::new();
        page.render(&mut text).map_err(failed)?;
        write_whole(&folder.join(page.get_filename()), &text)?;
    }
    say(&format!("{} in {}\n", counted(commands.len() as u64, "page"), folder.display()));
    Ok(DONE)
}
