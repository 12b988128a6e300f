//! .pvd: a series of time steps, each of one or more files.

use super::header::{Appended, Element};
use super::{named, parallel, serial};
use crate::formats::piece::Dataset;
use crate::formats::request::{Request, TimeStep};
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Reads the tables of contents of the files of one step.
pub(super) fn open(source: &Source, root: &Element, request: &Request) -> Result<Dataset> {
    let (time_steps, files) = step(root, request)?;
    let mut dataset = Dataset::default();
    for file in files {
        named::add(source, file, open_step, &mut dataset)?;
    }
    dataset.format = format!("VTK time series of {} steps; {}", time_steps.len(), dataset.format);
    dataset.time_steps = time_steps;
    Ok(dataset)
}

/// The files of the step asked for.
pub(super) fn files_of_step<'a>(root: &'a Element, request: &Request) -> Result<Vec<&'a str>> {
    step(root, request).map(|(_, files)| files)
}

/// The times of all steps, and the files of that asked for.
fn step<'a>(root: &'a Element, request: &Request) -> Result<(Vec<f64>, Vec<&'a str>)> {
    let collection = root.child("Collection").ok_or_else(|| Error::run("the file holds no <Collection>"))?;
    let mut entries = Vec::new();
    for element in collection.children_of("DataSet") {
        let time = element.number::<f64>("timestep")?.unwrap_or(0.0);
        if !time.is_finite() {
            return Err(element.wrong("timestep", "a finite number"));
        }
        entries.push((time, element.required("file")?));
    }
    let mut time_steps: Vec<f64> = entries.iter().map(|entry| entry.0).collect();
    time_steps.sort_by(f64::total_cmp);
    time_steps.dedup();
    let time = choose(&time_steps, request.time_step)?;
    let files = entries.into_iter().filter(|entry| entry.0 == time).map(|entry| entry.1).collect();
    Ok((time_steps, files))
}

/// One file of a step.
fn open_step(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Dataset> {
    match root.required("type")? {
        "Collection" => Err(named::misplaced("Collection")),
        kind if parallel::matches(kind) => parallel::open(&source, root),
        _ => serial::open(source, root, appended),
    }
}

/// The time of the step asked for.
fn choose(time_steps: &[f64], wanted: Option<TimeStep>) -> Result<f64> {
    let (Some(first), Some(last)) = (time_steps.first(), time_steps.last()) else {
        return Err(Error::run("the time series is empty").expected("at least one <DataSet file=\"…\">"));
    };
    match wanted {
        None => Ok(*first),
        Some(TimeStep::Index(index)) => time_steps.get(index).copied().ok_or_else(|| {
            Error::run("the time series has no such step")
                .got(format_args!("step {index}"))
                .expected(format_args!("0 to {}", time_steps.len() - 1))
        }),
        Some(TimeStep::Time(time)) => {
            // The span of the series with a margin for times that were rounded when they were written.
            let margin = 1e-6 * (last - first).abs().max(last.abs());
            if !(first - margin..=last + margin).contains(&time) {
                return Err(Error::run("the time series has no such time")
                    .got(time)
                    .expected(format_args!("{first} to {last}")));
            }
            let distance = |step: &f64| (step - time).abs();
            Ok(time_steps
                .iter()
                .copied()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .unwrap_or(*first))
        }
    }
}
