//! `voltet pixel`: what one pixel is made of, cell by cell along its ray.

use super::shared::{DONE, Outcome, Outputs, open_file, with_bar};
use crate::cli::arguments;
use crate::cli::present::{say, warnings};
use crate::graph::Registry;
use voltet_study::pixel::{csv, json, pixel as trace, plot, text};

pub fn pixel(arguments: &arguments::Pixel, registry: &Registry) -> Outcome {
    let document = open_file(&arguments.file, registry, false)?;
    let options = [("--csv", &arguments.csv), ("--json", &arguments.json), ("--plot", &arguments.plot)];
    let outputs = Outputs::check(options, Some(&document))?;
    let (node, place) = (arguments.node.as_deref(), [arguments.x, arguments.y]);
    let mut session = crate::nodes::session();
    let found = with_bar(false, |bar, progress| {
        trace(&document.graph, node, place, arguments.sample, &mut session, (bar, progress))
    });
    let found = found.map_err(|error| document.failure(error))?;
    say(&warnings(&found.warnings, document.graph.warnings.len()));
    let content = |option: &str| {
        Ok(match option {
            "--csv" => csv(&found),
            "--json" => format!("{:#}\n", json(&found)),
            _ => plot(&found).svg(),
        })
    };
    outputs.write(content, &text(&found, arguments.all))?;
    Ok(DONE)
}
