//! `voltet convert`: the grid of a data file in another format, by a pipeline of a reader and a `grid-writer`.

use super::shared::{DONE, Outcome, tell};
use crate::Document;
use crate::cli::arguments::Convert;
use crate::cli::present::{Bar, grouped, name, say, warnings};
use crate::core::parameters::suggest;
use crate::core::{Error, Result, agreeing, counted};
use crate::graph::{ParameterValue, Registry, RunReport};
use crate::io::formats::{
    Association, FileArray, Outline, Request, TimeStep, blocks_named, files_beside, outline, quoted_names,
    shortened, steps,
};
use crate::nodes::external_formats;
use crate::nodes::files::{Use, collision, is_standard_output, is_stream, refuse_unwritable};
use crate::series::names::{MarkValues, Varying, path_of};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Name of the pipeline, which is no file.
const CONVERSION: &str = "conversion";

/// Names of the nodes of the pipeline.
const NODES: [&str; 2] = ["grid", "file"];

pub fn convert(arguments: &Convert, registry: &Registry) -> Outcome {
    let request = request(arguments, registry)?;
    let outline = outline(&arguments.data, &request)?;
    let outputs = outputs(arguments, &request, &outline)?;
    let of_steps = arrays_of_steps(arguments, &request, &outline, &outputs)?;
    let mut arrays: Vec<FileArray> = Vec::new();
    for array in of_steps.iter().flatten() {
        if is_new(&arrays, array) {
            arrays.push(array.clone());
        }
    }
    let (written, left): (Vec<&FileArray>, Vec<&FileArray>) =
        arrays.iter().partition(|array| is_named(arguments, array));
    refuse_unknown_arrays(arguments, &arrays)?;
    refuse_losses(arguments, &outputs)?;
    let streams = outputs.iter().any(|output| is_standard_output(&output.path));
    let bar = Bar::new(arguments.quiet);
    let mut ghost_count = 0;
    for (output, own) in outputs.iter().zip(&of_steps) {
        let own: Vec<&FileArray> = own.iter().filter(|array| is_named(arguments, array)).collect();
        let pipeline = pipeline(arguments, &request, &own, output);
        let report = run(&pipeline, registry, &bar);
        bar.clear();
        let report = report.map_err(|error| at_step(error, output, outputs.len()))?;
        ghost_count = ghost_count.max(report.counts.get("cells_ghost").copied().unwrap_or(0));
        if !arguments.quiet {
            say(&warnings(&without_nodes(&report.warnings), 0));
            tell(&summary(&report, output, &outline), streams)?;
        }
    }
    if !arguments.quiet {
        let mut lines = not_written(arguments, &outline, &written, &left, &outputs);
        let lacking = |array: &&&FileArray| of_steps.iter().any(|own| is_new(own, array));
        let some: Vec<&&FileArray> = written.iter().filter(lacking).collect();
        if !some.is_empty() {
            lines.push(format!(
                "arrays that some steps lack: {}",
                quoted_names(some.iter().map(|array| &*array.name))
            ));
        }
        if ghost_count > 0 {
            lines.push(format!(
                "{} of pieces, whose originals are written",
                grouped(ghost_count, "ghost cell")
            ));
        }
        tell(&listed(&lines, outputs.len()), streams)?;
    }
    Ok(DONE)
}

struct Output {
    path: PathBuf,
    /// Number of its time step; `None` where the file is no series.
    step: Option<usize>,
}

fn request(arguments: &Convert, registry: &Registry) -> Result<Request> {
    let time_step = match arguments.time {
        Some(time) => Some(TimeStep::Time(time)),
        None => arguments.step.map(TimeStep::Index),
    };
    let (blocks, solution) = (arguments.blocks.clone(), arguments.solution.clone());
    let request = Request { time_step, blocks, solution, ..Request::default() };
    external_formats::request(request, &arguments.data, registry)
}

/// The arrays of each step that is written: those of a series may differ from step to step.
fn arrays_of_steps(
    arguments: &Convert,
    request: &Request,
    outline: &Outline,
    outputs: &[Output],
) -> Result<Vec<Vec<FileArray>>> {
    let arrays = |output: &Output| match output.step {
        Some(step) if outputs.len() > 1 => {
            let request = Request { time_step: Some(TimeStep::Index(step)), ..request.clone() };
            let outline = crate::io::formats::outline(&arguments.data, &request);
            Ok(outline.map_err(|error| at_step(error, output, outputs.len()))?.arrays)
        }
        _ => Ok(outline.arrays.clone()),
    };
    outputs.iter().map(arrays).collect()
}

fn is_new(among: &[FileArray], array: &FileArray) -> bool {
    !among.iter().any(|known| known.name == array.name && known.association == array.association)
}

/// An error at the step of one of several outputs.
fn at_step(error: Error, output: &Output, count: usize) -> Error {
    match output.step {
        Some(step) if count > 1 => error.at_item(format!("time step {step}")),
        _ => error,
    }
}

fn is_named(arguments: &Convert, array: &FileArray) -> bool {
    arguments.arrays.as_ref().is_none_or(|names| names.contains(&array.name))
}

fn refuse_unknown_arrays(arguments: &Convert, arrays: &[FileArray]) -> Result<()> {
    let is_there = |name: &String| arrays.iter().any(|array| array.name == *name);
    let Some(unknown) = arguments.arrays.iter().flatten().find(|name| !is_there(name)) else { return Ok(()) };
    let error = Error::usage("the file has no such array").got(format!("--arrays {unknown}"));
    let names: Vec<&str> = arrays.iter().map(|array| array.name.as_str()).collect();
    let expected = if names.is_empty() { "a file with arrays".into() } else { suggest(unknown, names) };
    Err(error.expected(expected).in_file(&arguments.data))
}

/// The files to write, one a step.
fn outputs(arguments: &Convert, request: &Request, outline: &Outline) -> Result<Vec<Output>> {
    let count = outline.time_steps.len();
    let numbers = match &arguments.steps {
        None if count == 0 => vec![None],
        None => vec![Some(steps(&arguments.data, request)?.1)],
        Some(selection) => {
            let numbers = selection.numbers(count.max(1)).map_err(|error| error.in_file(&arguments.data))?;
            numbers.into_iter().map(|step| (count > 0).then_some(step)).collect()
        }
    };
    let varying: Vec<Varying> = (numbers.len() > 1).then_some(Varying::Step).into_iter().collect();
    let stem = arguments.data.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let output = |(frame, step): (usize, Option<usize>)| {
        let time = step.and_then(|step| outline.time_steps.get(step).copied());
        let marks =
            MarkValues { frame, step: step.unwrap_or(0), time, stem: stem.clone(), ..MarkValues::default() };
        let path = path_of(&arguments.output.to_string_lossy(), &marks, &varying)?;
        Ok(Output { path: PathBuf::from(path), step })
    };
    numbers.into_iter().enumerate().map(output).collect()
}

/// Refuses, before any work, files that are there, or are read, or cannot be written.
fn refuse_losses(arguments: &Convert, outputs: &[Output]) -> Result<()> {
    let data = &arguments.data;
    let read = std::iter::once(data.clone()).chain(arguments.solution.clone()).chain(files_beside(data));
    let written = outputs.iter().map(|output| Use { path: output.path.clone(), written: true });
    let uses: Vec<Use> = written.chain(read.map(|path| Use { path, written: false })).collect();
    if let Some([writer, _]) = collision(&uses) {
        let error = Error::usage("the file would be written over data that are read");
        let found = name(&uses[writer].path.to_string_lossy());
        return Err(error.got(found).expected("another path for the file to write"));
    }
    for Output { path, .. } in outputs {
        refuse_unwritable(path)?;
        let text = path.to_string_lossy();
        if path.exists() && !is_stream(&text) && !arguments.force {
            let error = Error::usage("the file is there already").got(name(&text));
            return Err(error.expected("--force to write over it, or another path"));
        }
    }
    Ok(())
}

fn pipeline(arguments: &Convert, request: &Request, arrays: &[&FileArray], output: &Output) -> String {
    let text = |text: &str| ParameterValue::Text(text.into()).to_string();
    let path = |path: &Path| text(&path.to_string_lossy());
    let list = |texts: &mut dyn Iterator<Item = &str>| {
        texts.map(|text| ParameterValue::Text(text.into())).collect::<ParameterValue>().to_string()
    };
    let names = |association: Association| {
        let own = arrays.iter().filter(|array| array.association == association);
        list(&mut own.map(|array| array.name.as_str()))
    };
    let mut reader = format!("type = \"{}\"\npath = {}\n", request.node_type(), path(&arguments.data));
    if !arguments.blocks.is_empty() {
        let _ = writeln!(reader, "blocks = {}", list(&mut arguments.blocks.iter().map(String::as_str)));
    }
    match (arguments.time, output.step.or(arguments.step)) {
        (Some(time), _) => reader += &format!("time = {time:?}\n"),
        (None, Some(step)) => reader += &format!("time_step = {step}\n"),
        (None, None) => {}
    }
    reader.extend(arguments.solution.iter().map(|solution| format!("solution = {}\n", path(solution))));
    let [grid, file] = NODES;
    format!(
        "[pipeline]\nformat = 1\n\n[nodes.{grid}]\n{reader}\n[nodes.{file}]\ntype = \"grid-writer\"\npath = {}\ncells = \"file\"\n\
         arrays = []\npoint_arrays = {}\ncell_arrays = {}\ninputs = {{ volume = \"{grid}\" }}\n",
        path(&output.path),
        names(Association::Point),
        names(Association::Cell)
    )
}

/// Runs a pipeline that nobody wrote: its errors show no place in it.
fn run(pipeline: &str, registry: &Registry, bar: &Bar) -> Result<RunReport> {
    // Paths are relative to the working folder.
    let document = Document::from_text(Path::new(CONVERSION), pipeline.into(), &[], registry);
    let outcome = document.and_then(|document| crate::nodes::session().run(&document.graph, bar));
    outcome.map_err(|mut error| {
        (error.location.span, error.location.line_column, error.location.node) = (None, None, None);
        error.location.file.take_if(|file| file.as_str() == CONVERSION);
        error
    })
}

/// Warnings without the names of the nodes that gave them.
fn without_nodes(warnings: &[String]) -> Vec<String> {
    let stripped = |warning: &String| {
        let found = NODES.iter().find_map(|node| warning.strip_prefix(node)?.strip_prefix(": "));
        found.unwrap_or(warning).to_owned()
    };
    warnings.iter().map(stripped).collect()
}

/// A line about a written file.
fn summary(report: &RunReport, output: &Output, outline: &Outline) -> String {
    let count = |what: &str| report.counts.get(what).copied().unwrap_or(0);
    let [points, cells, arrays] = ["points_written", "cells_written", "arrays_written"].map(count);
    let time = output.step.and_then(|step| Some((step, outline.time_steps.get(step)?)));
    let time = time.map(|(step, time)| format!("step {step}, time {time}, ")).unwrap_or_default();
    format!(
        "{}: {time}{}, {}, {}, {:.2} s\n",
        name(&report.files.join(", ")),
        grouped(points, "point"),
        grouped(cells, "cell"),
        grouped(arrays, "array"),
        report.seconds
    )
}

/// A list of what the written files do not hold; nothing where they hold everything.
fn listed(lines: &[String], file_count: usize) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let lines: String = lines.iter().map(|line| format!("  {}\n", name(line))).collect();
    format!("not in {}\n{lines}", agreeing(&file_count, "the new file", "the new files"))
}

/// Lines about contents of the data file that the written files do not hold.
fn not_written(
    arguments: &Convert,
    outline: &Outline,
    written: &[&FileArray],
    left: &[&FileArray],
    outputs: &[Output],
) -> Vec<String> {
    let mut lines = Vec::new();
    if !left.is_empty() {
        let (arrays, names) =
            (counted(left.len(), "array"), quoted_names(left.iter().map(|array| &*array.name)));
        lines.push(format!("{arrays} not named by --arrays: {names}"));
    }
    if let Ok(selected) = blocks_named(&outline.blocks, &arguments.blocks)
        && !arguments.blocks.is_empty()
    {
        let all = outline.blocks.iter().zip(selected);
        let out: Vec<&str> = all.filter(|(_, is_in)| !is_in).map(|(name, _)| name.as_str()).collect();
        if !out.is_empty() {
            lines.push(format!(
                "{} not named by --blocks: {}",
                counted(out.len(), "block"),
                quoted_names(out)
            ));
        }
    }
    if !outline.blocks.is_empty() {
        let numbered: Vec<String> =
            outline.blocks.iter().enumerate().map(|(number, name)| format!("{number} is '{name}'")).collect();
        let has_numbers = written.iter().any(|array| array.name == crate::io::formats::BLOCK);
        let held = if has_numbers { "; the cell array 'block' holds their numbers" } else { "" };
        lines.push(format!("names of blocks{held}: {}", shortened(&numbered)));
    }
    lines.extend(outline.notes.iter().cloned());
    let whole = written.iter().map(|array| &*array.name).filter(|name| outline.whole_arrays.contains(*name));
    let whole: Vec<&str> = whole.filter(|name| *name != crate::io::formats::BLOCK).collect();
    if !whole.is_empty() {
        let are = agreeing(&whole.len(), "is written as a float", "are written as floats");
        lines.push(format!("types of whole numbers: {} {are}", quoted_names(whole)));
    }
    let (steps, out) =
        (outline.time_steps.len(), outputs.iter().filter(|output| output.step.is_some()).count());
    if out < steps {
        lines.push(format!(
            "{} of {}: --steps all writes them all",
            counted(steps - out, "time step"),
            steps
        ));
    }
    lines
}
