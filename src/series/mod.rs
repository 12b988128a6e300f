//! Frames: the pictures that one pipeline states for time steps, data files and values of parameters.
//!
//! A frame is the pipeline with some parameters set, so that it is drawn as if the file said so, and its picture carries that.
//!
//! | module | what |
//! | --- | --- |
//! | [`steps`] | selections of time steps |
//! | [`names`] | names of the files of frames |

pub mod names;
pub mod steps;

use crate::document::{Change, Document};
use names::{Marks, Varying};
use std::fmt::Write;
use steps::{StepSelection, TimeSelection};
use voltet_core::{Error, Result};
use voltet_graph::{Graph, GraphNode, NamedPath, ParameterValue};

/// Parameters of a reader that name its step.
const TIME_STEP: &str = "time_step";
const TIME: &str = "time";

/// Selection of the frames of a pipeline.
#[derive(Debug, Clone, Default)]
pub struct FrameSelection {
    /// Steps of the time series; `None`: the one that the file names.
    pub steps: Option<Steps>,
}

/// Selection of time steps.
#[derive(Debug, Clone, PartialEq)]
pub enum Steps {
    /// By number.
    Numbers(StepSelection),
    /// By time.
    Times(TimeSelection),
}

/// One picture of several.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Values of the marks in its names.
    pub marks: Marks,
    /// Quantities in which the frames differ.
    pub varying: Vec<Varying>,
    /// Changes of the pipeline that make the frame.
    pub changes: Vec<Change>,
}

impl Frame {
    /// Words that tell it from the others: "step 7, time 0.35".
    pub fn label(&self) -> String {
        let mut label = String::new();
        for kind in &self.varying {
            let comma = if label.is_empty() { "" } else { ", " };
            let Marks { frame, step, time, stem, sweep } = &self.marks;
            // Writing into a text does not fail.
            let _ = match kind {
                Varying::File => write!(label, "{comma}{}", stem.as_deref().unwrap_or_default()),
                Varying::Step => match time {
                    Some(time) => write!(label, "{comma}step {step}, time {time}"),
                    None => write!(label, "{comma}step {step}"),
                },
                Varying::Sweep => write!(label, "{comma}values {sweep}"),
                Varying::Turn => write!(label, "{comma}frame {frame}"),
            };
        }
        label
    }
}

/// Time series that the readers of a pipeline read together.
struct Series {
    /// Names of the nodes that read it, and whether each names its step by a time.
    readers: Vec<(String, bool)>,
    /// Number of the step that the pipeline names.
    own: usize,
    times: Vec<f64>,
}

impl Series {
    /// The series of the nodes that some output needs. Files are opened, headers alone.
    fn of(graph: &Graph) -> Result<Series> {
        let mut series = Series { readers: Vec::new(), own: 0, times: Vec::new() };
        let mut first: Option<(&str, usize)> = None;
        for &place in &graph.order {
            let node = &graph.nodes[place];
            let found = graph.time_series(place)?;
            if found.times.is_empty() || found.steps.len() < 2 {
                series.times =
                    if series.times.is_empty() { found.times } else { std::mem::take(&mut series.times) };
                continue;
            }
            match first {
                None => (series.own, series.times) = (found.own, found.times),
                Some((other, count)) if count != found.steps.len() => {
                    let error = Error::usage("two time series have different numbers of steps");
                    let counts = format!("{count} of '{other}' and {} of '{}'", found.steps.len(), node.name);
                    return Err(node.locate(error.got(counts).expected("series of the same length")));
                }
                Some(_) => {}
            }
            first = first.or(Some((&node.name, found.steps.len())));
            series.readers.push((node.name.clone(), node.parameters.is_set(TIME)));
        }
        Ok(series)
    }

    /// Number of steps, 1 where there is no series.
    fn count(&self) -> usize {
        if self.readers.is_empty() { 1 } else { self.times.len() }
    }

    /// Changes that let every reader read a step.
    fn at(&self, step: usize) -> Vec<Change> {
        let mut changes = Vec::new();
        for (node, names_time) in &self.readers {
            if *names_time {
                changes.push(Change::unset(node, TIME));
            }
            changes.push(Change::set(node, TIME_STEP, ParameterValue::Integer(step as i64)));
        }
        changes
    }
}

/// The frames of a pipeline; one without changes where nothing asks for more.
///
/// # Errors
/// - steps or times that the data do not have, series of different lengths, a name that several frames would have.
pub fn frames(document: &Document, selection: &FrameSelection) -> Result<Vec<Frame>> {
    let graph = &document.graph;
    let steps = selection
        .steps
        .clone()
        .or_else(|| reads_all_steps(graph).then(|| Steps::Numbers(StepSelection::all())));
    let has_marks = written(graph).any(|(_, named)| names::has_marks(&named.path));
    if steps.is_none() && !has_marks {
        return Ok(vec![Frame::default()]);
    }
    let looks_at_data =
        steps.is_some() || written(graph).any(|(_, named)| names::names(&named.path, &["step", "time"]));
    let series = if looks_at_data { Some(Series::of(graph)?) } else { None };
    let numbers = match (&steps, &series) {
        (Some(Steps::Numbers(steps)), Some(series)) => steps.numbers(series.count())?,
        (Some(Steps::Times(times)), Some(series)) => times.numbers(&series.times)?,
        _ => vec![series.as_ref().map_or(0, |series| series.own)],
    };
    let varying: Vec<Varying> = (numbers.len() > 1).then_some(Varying::Step).into_iter().collect();
    let mut frames = Vec::new();
    for step in numbers {
        let time = series.as_ref().and_then(|series| series.times.get(step).copied());
        let marks = Marks { frame: frames.len(), step, time, stem: stem(graph), ..Marks::default() };
        let changes = match (&series, &steps) {
            (Some(series), Some(_)) => series.at(step),
            _ => Vec::new(),
        };
        let mut frame = Frame { marks, varying: varying.clone(), changes };
        name(graph, &mut frame)?;
        frames.push(frame);
    }
    Ok(frames)
}

/// Names the files that a frame writes.
fn name(graph: &Graph, frame: &mut Frame) -> Result<()> {
    for (node, named) in written(graph) {
        let path = names::path_of(&named.path, &frame.marks, &frame.varying)
            .map_err(|error| node.parameters.locate(&named.parameter, error))
            .map_err(|error| node.locate(error))?;
        if path != named.path {
            frame.changes.push(Change::set(&node.name, &named.parameter, ParameterValue::Text(path)));
        }
    }
    Ok(())
}

/// The files that nodes write, each with its node.
fn written(graph: &Graph) -> impl Iterator<Item = (&GraphNode, NamedPath)> {
    graph.nodes.iter().flat_map(|node| {
        let written = node.parameters.paths().into_iter().filter(|named| named.written);
        written.map(move |named| (node, named))
    })
}

/// Name of the first data file without folder and ending.
fn stem(graph: &Graph) -> Option<String> {
    let readers = graph.order.iter().map(|&place| &graph.nodes[place]);
    let path = readers.filter(|node| node.node.parameter(TIME_STEP).is_some()).find_map(|node| {
        node.parameters.paths().into_iter().find(|named| !named.written && named.parameter == "path")
    })?;
    Some(std::path::Path::new(&path.path).file_stem()?.to_string_lossy().into_owned())
}

/// True if a reader names every step in place of one.
fn reads_all_steps(graph: &Graph) -> bool {
    let nodes = graph.order.iter().map(|&place| &graph.nodes[place]);
    let mut steps = nodes.filter_map(|node| node.parameters.optional(TIME_STEP));
    steps.any(|step| step.text().is_some())
}
