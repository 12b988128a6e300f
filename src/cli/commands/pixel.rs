//! `voltet pixel`: what one pixel is made of, cell by cell along its ray.

use super::array_choice::bar_progress;
use super::exit_status::{DONE, show, warn};
use super::pipelines::open;
use crate::Document;
use crate::cli::arguments;
use crate::cli::present::{Bar, print, say};
use crate::core::{Error, Result};
use crate::document::{self, OptionFile};
use crate::graph::Registry;
use crate::io::encode;
use crate::nodes::files;
use std::path::Path;
use voltet_study::pixel::{Pixel, csv, json, pixel as trace, plot, text};

pub fn pixel(arguments: &arguments::Pixel, registry: &Registry) -> Result<u8> {
    let document = match open(&arguments.file, &arguments.set.options, registry) {
        Ok(document) => document,
        Err((error, text)) => return Ok(show(&error, text.as_deref())),
    };
    warn(&document);
    let outcome = dissect(arguments, &document);
    outcome.or_else(|error| Ok(show(&document.locate(error), Some(&document.text))))
}

fn dissect(arguments: &arguments::Pixel, document: &Document) -> Result<u8> {
    let outputs: Vec<(&str, &Path)> =
        [("--csv", &arguments.csv), ("--json", &arguments.json), ("--plot", &arguments.plot)]
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
            .collect();
    let written: Vec<OptionFile> =
        outputs.iter().map(|(option, path)| OptionFile::written(option, path)).collect();
    if let Err((error, text)) = document::refuse_conflicts([document], false, &written) {
        return Ok(show(&error, text));
    }
    document.refuse_missing_data()?;
    arguments.plot.as_deref().map_or(Ok(false), is_png)?;
    outputs.iter().try_for_each(|(_, path)| files::refuse_unwritable(path))?;
    let bar = Bar::new(false);
    let place = [arguments.x, arguments.y];
    let mut session = crate::nodes::session();
    let found = trace(
        &document.graph,
        arguments.node.as_deref(),
        place,
        arguments.sample,
        &mut session,
        (&bar, &bar_progress(&bar)),
    );
    bar.clear();
    let found = found?;
    outputs
        .iter()
        .try_for_each(|(option, path)| files::write_whole(path, &content(&found, option, path)?))?;
    let table = text(&found, arguments.all);
    // What goes to the standard output stands there alone.
    match outputs.iter().any(|(_, path)| files::is_standard_output(path)) {
        true => say(&table),
        false => drop(print(&table)?),
    }
    Ok(DONE)
}

/// Content of the file of an option.
fn content(pixel: &Pixel, option: &str, path: &Path) -> Result<Vec<u8>> {
    Ok(match option {
        "--csv" => csv(pixel).into_bytes(),
        "--json" => format!("{:#}\n", json(pixel)).into_bytes(),
        _ if is_png(path)? => encode::png(&plot(pixel).picture(), [1.0; 3], None)?,
        _ => plot(pixel).svg().into_bytes(),
    })
}

/// True if a plot is written as PNG, false for SVG.
pub(super) fn is_png(path: &Path) -> Result<bool> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("png") => Ok(true),
        Some("svg") => Ok(false),
        None if files::is_stream(&path.to_string_lossy()) => Ok(false),
        _ => Err(Error::usage("the format of the plot is not known")
            .got(format!("--plot {}", path.display()))
            .expected("a path that ends in .svg or .png")),
    }
}
