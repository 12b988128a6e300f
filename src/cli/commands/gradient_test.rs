//! `voltet gradient-test`: how right a gradient filter is and what it costs, beside others.

use super::shared::{DONE, FAILED, Outcome, Outputs, show, with_bar};
use super::study::option;
use crate::cli::arguments;
use crate::cli::present::{Level, say, shown};
use crate::core::grid::Grid;
use crate::core::progress::Progress;
use crate::core::{Error, Result};
use crate::graph::Registry;
use crate::graph::pipeline::field;
use crate::io::formats::{self, Request};
use crate::nodes::external_formats;
use std::path::Path;
use voltet_study::gradient_test::{TestOptions, gradient_test as measure, methods, page, plot, text};

pub fn gradient_test(arguments: &arguments::GradientTest, registry: &Registry) -> Outcome {
    let wish = TestOptions {
        levels: arguments.levels.clone(),
        timed: arguments.timed,
        rounds: arguments.rounds,
        hold_to: arguments.hold_to.iter().copied().flatten().collect(),
        order: arguments.order,
        boundary_order: arguments.boundary_order,
        linear_error: arguments.linear_error,
    };
    wish.check(option)?;
    let fields = arguments.options.iter().map(|option| field(option)).collect::<Result<Vec<_>>>()?;
    let methods = methods(&arguments.name, &fields, arguments.beside.as_deref(), registry)?;
    let options = [("--html", &arguments.html), ("--json", &arguments.json), ("--plot", &arguments.plot)];
    let outputs = Outputs::check(options, None)?;
    let found = with_bar(arguments.quiet, |_, progress| {
        let data = arguments.data.as_deref().map(|path| grid(path, registry, progress)).transpose()?;
        measure(&methods, &wish, data.as_ref(), progress)
    })?;
    let content = |option: &str| match option {
        "--html" => Ok(page(&found, &plot(&found).svg())),
        "--json" => {
            let object = serde_json::to_string_pretty(&found);
            let object = object.map_err(|error| Error::run(error.to_string()))?;
            Ok(format!("{object}\n"))
        }
        _ => Ok(plot(&found).svg()),
    };
    let table = if arguments.quiet { String::new() } else { text(&found) };
    outputs.write(content, &table)?;
    for one in found.requirements.iter().filter(|one| arguments.quiet && !one.holds) {
        let what = format!("the gradient filter '{}' does not hold: {}", arguments.name, one.what);
        show(&Error::run(what).got(&one.found).into());
    }
    for one in found.warnings.iter().filter(|_| arguments.quiet) {
        let what = format!("the gradient filter '{}' does not hold: {}", arguments.name, one.what);
        say(&shown(&Error::run(what).got(&one.found), None, Level::WARNING));
    }
    // A filter that breaks what it is held to.
    Ok(if found.passed() { DONE } else { FAILED })
}

/// The grid of a data file, without arrays.
fn grid(path: &Path, registry: &Registry, progress: &dyn Progress) -> Result<Grid> {
    let request = Request { without_scalar: true, ..Request::default() };
    formats::read(path, &external_formats::request(request, path, registry)?, progress)
}
