//! `voltet gradient-test`: how right a gradient filter is and what it costs, beside others.

use super::array_choice::bar_progress;
use super::exit_status::{DONE, show};
use crate::cli::arguments;
use crate::cli::present::{Bar, print, say};
use crate::core::{Error, Result};
use crate::document::{self, OptionFile};
use crate::graph::Registry;
use crate::graph::pipeline::field;
use crate::io::encode;
use crate::nodes::files;
use std::path::Path;
use voltet_study::gradient_test::{
    GradientTest, TestOptions, gradient_test as measure, methods, page, plot, text,
};

/// The filter breaks what it is held to.
const BROKEN: u8 = 1;

pub fn gradient_test(arguments: &arguments::GradientTest, registry: &Registry) -> Result<u8> {
    let wish = wish(arguments)?;
    let fields = arguments.options.iter().map(|option| field(option)).collect::<Result<Vec<_>>>()?;
    let methods = methods(&arguments.name, &fields, arguments.beside.as_deref(), registry)?;
    let outputs: Vec<(&str, &Path)> =
        [("--html", &arguments.html), ("--json", &arguments.json), ("--plot", &arguments.plot)]
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
            .collect();
    let written: Vec<OptionFile> =
        outputs.iter().map(|(option, path)| OptionFile::written(option, path)).collect();
    if let Err((error, text)) = document::refuse_conflicts([], false, &written) {
        return Ok(show(&error, text));
    }
    arguments.plot.as_deref().map_or(Ok(false), super::pixel::is_png)?;
    outputs.iter().try_for_each(|(_, path)| files::refuse_unwritable(path))?;
    let bar = Bar::new(arguments.quiet);
    let found = measure(&methods, &wish, &bar_progress(&bar));
    bar.clear();
    let found = found?;
    outputs
        .iter()
        .try_for_each(|(option, path)| files::write_whole(path, &content(&found, option, path)?))?;
    let table = text(&found);
    // What goes to the standard output stands there alone.
    match outputs.iter().any(|(_, path)| files::is_standard_output(path)) {
        _ if arguments.quiet => found.requirements.iter().filter(|one| !one.holds).for_each(|one| {
            let what = format!("the gradient filter '{}' does not hold: {}", arguments.name, one.what);
            show(&Error::run(what).got(&one.found), None);
        }),
        true => say(&table),
        false => drop(print(&table)?),
    }
    Ok(if found.passed() { DONE } else { BROKEN })
}

/// Content of the file of an option.
fn content(found: &GradientTest, option: &str, path: &Path) -> Result<Vec<u8>> {
    Ok(match option {
        "--html" => page(found, &plot(found).svg()).into_bytes(),
        "--json" => {
            let object =
                serde_json::to_string_pretty(found).map_err(|error| Error::run(error.to_string()))?;
            format!("{object}\n").into_bytes()
        }
        _ if super::pixel::is_png(path)? => encode::png(&plot(found).picture(), [1.0; 3], None)?,
        _ => plot(found).svg().into_bytes(),
    })
}

fn wish(arguments: &arguments::GradientTest) -> Result<TestOptions> {
    let wish = TestOptions {
        levels: arguments.levels.clone(),
        timed: arguments.timed,
        rounds: arguments.rounds,
        hold_to: arguments.hold_to.iter().copied().flatten().collect(),
        order: arguments.order,
        linear_error: arguments.linear_error,
    };
    wish.check(super::study::option)?;
    Ok(wish)
}
