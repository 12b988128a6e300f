//! Frames: the pictures that one pipeline states for time steps, data files and values of parameters.
//!
//! A frame is the pipeline with some parameters set, so that it is drawn as if the file said so, and its picture carries that.
//!
//! | module | what |
//! | --- | --- |
//! | [`steps`] | selections of time steps |
//! | [`selection`] | selections of frames: steps, files, values, parts |
//! | [`files`] | names of files with `*` |
//! | [`names`] | names of the files of frames |

pub mod files;
pub mod names;
pub mod selection;
pub mod steps;

use crate::document::{Change, Document};
use names::{MarkValues, Varying};
use selection::{FrameSelection, Sweep};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use steps::StepSelection;
use voltet_core::{Error, Result};
use voltet_document::Series;
use voltet_document::series::{self, TIME, TIME_STEP};
use voltet_graph::{Edge, Graph, GraphNode, NamedPath, ParameterValue, Port, PortType, Registry};
use voltet_nodes::files::relative_to;
use voltet_nodes::relative::RELATIVE_TO;

/// The input to whose data numbers are relative.
const VOLUME: &str = "volume";

/// Parameter of a transfer function that may be left to the data.
const UNIT: &str = "unit_distance";

/// Type of the node that finds a widget in data.
const PROBE: &str = "probe";

/// Parameter of a camera that is its place on its way.
const PHASE: &str = "phase";

/// One picture of several.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Values of the marks in its names.
    pub marks: MarkValues,
    /// Quantities in which the frames differ.
    pub varying: Vec<Varying>,
    /// Values of the parameters that are swept: "centre = [60.8, 0.0]".
    pub values: String,
    /// Changes of the pipeline that make the frame.
    pub changes: Vec<Change>,
}

impl Frame {
    /// Words that tell it from the others: "step 7, time 0.35".
    pub fn label(&self) -> String {
        let mut label = String::new();
        for kind in &self.varying {
            let comma = if label.is_empty() { "" } else { ", " };
            let MarkValues { frame, step, time, stem, .. } = &self.marks;
            // Writing into a text does not fail.
            let _ = match kind {
                Varying::File => write!(label, "{comma}{}", stem.as_deref().unwrap_or_default()),
                Varying::Step => match time {
                    Some(time) => write!(label, "{comma}step {step}, time {time}"),
                    None => write!(label, "{comma}step {step}"),
                },
                Varying::Sweep => write!(label, "{comma}{}", self.values),
                Varying::Turn => write!(label, "{comma}frame {frame}"),
            };
        }
        label
    }
}

/// The frames of a pipeline; one without changes where nothing asks for more.
///
/// # Errors
/// - files, steps or times that there are not, series of different lengths;
/// - a way of the camera that no camera has, a name that cannot be made.
pub fn frames(document: &Document, selection: &FrameSelection, registry: &Registry) -> Result<Vec<Frame>> {
    let graph = &document.graph;
    let mut frames = Vec::new();
    let stems = files::stems(&selection.data_files);
    for (number, file) in data_files(graph, selection)?.into_iter().enumerate() {
        let own;
        let graph = match &file {
            Some(change) => {
                own = document.changed(std::slice::from_ref(change), registry)?;
                &own.graph
            }
            None => graph,
        };
        for mut frame in step_frames(graph, selection)? {
            frame.changes.splice(..0, file.iter().cloned());
            if let Some(stem) = stems.get(number) {
                frame.marks.stem = Some(stem.clone());
            }
            frames.push(frame);
        }
    }
    refuse_sweeps(graph, &selection.sweeps)?;
    let mut frames = swept(frames, &selection.sweeps)?;
    turn(graph, &mut frames, selection.turn_count)?;
    let varying = varying(&frames);
    for (number, frame) in frames.iter_mut().enumerate() {
        frame.marks.frame = number;
        frame.varying.clone_from(&varying);
        frame.changes.extend(file_names(graph, &frame.marks, &frame.varying)?);
    }
    if let Some(part) = selection.part {
        frames = frames.into_iter().skip(part.number - 1).step_by(part.count).collect();
    }
    Ok(frames)
}

/// The data files, each as a change of the reader; `None` where the pipeline names its own.
fn data_files(graph: &Graph, selection: &FrameSelection) -> Result<Vec<Option<Change>>> {
    if selection.data_files.is_empty() {
        return Ok(vec![None]);
    }
    let readers: Vec<&GraphNode> = readers(graph).collect();
    let [reader] = readers[..] else {
        let names: Vec<&str> = readers.iter().map(|node| node.name.as_str()).collect();
        let error = Error::usage("files are given for the reader, of which there must be one");
        let found = if names.is_empty() { "none".to_string() } else { names.join(", ") };
        return Err(error.got(found).expected("a pipeline with one node that reads a data file"));
    };
    let change = |path: &PathBuf| {
        let path = relative_to(path, &graph.folder).to_string_lossy().into_owned();
        Some(Change::set(&reader.name, "path", ParameterValue::Text(path)))
    };
    Ok(selection.data_files.iter().map(change).collect())
}

/// The frames of one data file: a frame for each step.
fn step_frames(graph: &Graph, selection: &FrameSelection) -> Result<Vec<Frame>> {
    let reads_all = readers(graph)
        .filter_map(|node| node.parameters.optional(TIME_STEP))
        .any(|step| step.text().is_some());
    let all = || selection::Steps::Numbers(StepSelection::all());
    let steps = selection.steps.clone().or_else(|| reads_all.then(all));
    let names_steps = written(graph).any(|(_, named)| names::names(&named.path, &["step", "time"]));
    // Without need no file is opened before the run.
    let series = match steps.is_some() || names_steps || selection.ranges.is_some() {
        true => Series::from_graph(graph)?,
        false => Series::default(),
    };
    // Each step with the time where values lie between steps.
    let at_step = |numbers: Vec<usize>| numbers.into_iter().map(|step| (step, None)).collect();
    let numbers: Vec<(usize, Option<f64>)> = match &steps {
        Some(selection::Steps::Numbers(steps)) => at_step(steps.numbers(series.count())?),
        Some(selection::Steps::Times(times)) if series.is_interpolated => {
            times.times(&series.times)?.into_iter().map(|(step, time)| (step, Some(time))).collect()
        }
        Some(selection::Steps::Times(times)) => at_step(times.numbers(&series.times)?),
        None => vec![(series.own, None)],
    };
    let ranges = match (selection.ranges, &steps) {
        (Some(ranges), _) => range_changes(graph, ranges.word(), true),
        (None, Some(_)) if !series.is_none() && !series.has_fixed => range_changes(graph, "sample", false),
        _ => Vec::new(),
    };
    let frame = |(step, between): (usize, Option<f64>)| {
        let time = between.or(series.times.get(step).copied());
        let mut changes = match between {
            Some(time) => series.at_time(time),
            None if steps.is_some() => series.at(step),
            None => Vec::new(),
        };
        changes.extend(ranges.iter().cloned());
        Frame {
            marks: MarkValues { step, time, stem: stem(graph), ..MarkValues::default() },
            changes,
            ..Frame::default()
        }
    };
    Ok(numbers.into_iter().map(frame).collect())
}

/// Changes that let numbers be relative to steps of the series, at the nodes whose numbers depend on data. `all`: also at those
/// whose file says to what they are.
fn range_changes(graph: &Graph, word: &str, all: bool) -> Vec<Change> {
    let mut changes = Vec::new();
    for &place in &graph.order {
        let node = &graph.nodes[place];
        if node.node.parameter(RELATIVE_TO.name).is_none() || !all && node.parameters.is_set(RELATIVE_TO.name)
        {
            continue;
        }
        let is_wired =
            node.inputs.iter().any(|edge| input_of(node, edge).is_some_and(|port| port.name == VOLUME));
        let is_view = ["view", "direction"].iter().any(|name| node.parameters.is_set(name));
        let depends = is_view || !node.parameters.relative_numbers().is_empty() || node.node.name == PROBE;
        let is_unit_auto =
            node.node.parameter(UNIT).is_some() && node.parameters.optional_number(UNIT).is_none();
        // A unit distance of the series is that of what is drawn.
        let drawn = if is_unit_auto && !is_wired && word != "step" { drawn_with(graph, place) } else { None };
        changes.extend(drawn.iter().map(|source| Change::wire(&node.name, VOLUME, source)));
        if drawn.is_some() || is_wired && (depends || is_unit_auto) {
            let word = ParameterValue::Text(word.into());
            changes.push(Change::set(&node.name, RELATIVE_TO.name, word));
        }
    }
    changes
}

fn input_of(node: &GraphNode, edge: &Edge) -> Option<&'static Port> {
    node.node.all_inputs().nth(edge.port)
}

/// The output whose volume is drawn with the transfer function of a node, as a wire names it; none where several are.
fn drawn_with(graph: &Graph, look: usize) -> Option<String> {
    let uses = |node: &&GraphNode| node.inputs.iter().any(|edge| edge.node == look);
    let is_volume = |node: &GraphNode, edge: &&Edge| {
        input_of(node, edge).is_some_and(|port| port.port_type == PortType::Volume)
    };
    let users = graph.order.iter().map(|&place| &graph.nodes[place]).filter(uses);
    let mut drawn = users.filter_map(|node| {
        let edge = node.inputs.iter().find(|edge| is_volume(node, edge))?;
        let source = &graph.nodes[edge.node];
        let outputs = source.node.outputs;
        Some(match outputs.len() {
            1 => source.name.clone(),
            _ => format!("{}.{}", source.name, outputs[edge.output].name),
        })
    });
    let first = drawn.next()?;
    drawn.all(|other| other == first).then_some(first)
}

/// Refuses sweeps of parameters that frames set by themselves.
fn refuse_sweeps(graph: &Graph, sweeps: &[Sweep]) -> Result<()> {
    for sweep in sweeps {
        let (node, parameter) = (graph.nodes.iter().find(|node| node.name == sweep.node), &sweep.parameter);
        let Some(node) = node else { continue };
        let is_written =
            node.parameters.paths().iter().any(|path| path.written && path.parameter == *parameter);
        let is_reader = node.node.parameter(TIME_STEP).is_some();
        let accepted = match parameter.as_str() {
            _ if is_written => "{sweep} in the path, for the pictures of a sweep have names of their own",
            "path" if is_reader => "--for FILES (Python: files=FILES), which draws each of these files",
            TIME_STEP if is_reader => {
                "--steps STEPS (Python: steps=STEPS), which draws each of these time steps"
            }
            TIME if is_reader => {
                "--times TIMES, or --steps STEPS (Python: times=TIMES or steps=STEPS), which draw each of these time steps"
            }
            PHASE if phase(node, 0, 1).is_some() => {
                "--frames COUNT (Python: turns=COUNT), which moves the camera on its way"
            }
            _ => continue,
        };
        let error = Error::usage("this parameter is not swept, for each picture has a value of its own");
        return Err(error.got(format!("{}.{parameter}", sweep.node)).expected(accepted));
    }
    Ok(())
}

/// Each frame with each combination of the values of parameters.
fn swept(frames: Vec<Frame>, sweeps: &[Sweep]) -> Result<Vec<Frame>> {
    let mut combinations: Vec<(Vec<Change>, Vec<String>)> = vec![Default::default()];
    for sweep in sweeps {
        let mut longer = Vec::new();
        for (changes, texts) in &combinations {
            for value in &sweep.values {
                let (mut changes, mut texts) = (changes.clone(), texts.clone());
                let short = sweep.parameter.rsplit('.').next().unwrap_or_default();
                texts.push(format!("{short} = {value}"));
                changes.push(Change::set(&sweep.node, &sweep.parameter, value.clone()));
                longer.push((changes, texts));
            }
        }
        combinations = longer;
    }
    let mut all = Vec::new();
    for frame in frames {
        for (sweep, (changes, texts)) in combinations.iter().enumerate() {
            let mut own = Frame { values: texts.join(", "), ..frame.clone() };
            own.marks.sweep = sweep;
            own.changes.extend(changes.iter().cloned());
            all.push(own);
        }
    }
    Ok(all)
}

/// Moves the cameras on their ways from the first frame to the last; `count`: frames of a way where nothing else varies.
fn turn(graph: &Graph, frames: &mut Vec<Frame>, count: Option<usize>) -> Result<()> {
    let cameras = graph.order.iter().map(|&place| &graph.nodes[place]);
    let cameras: Vec<&GraphNode> = cameras.filter(|node| phase(node, 0, 1).is_some()).collect();
    if let Some(count) = count {
        if frames.len() > 1 {
            let error =
                Error::usage("--frames (Python: turns) is for what does not change but for the camera");
            return Err(error.got(format!("{} frames", frames.len())).expected("one step, file and value"));
        }
        if cameras.is_empty() {
            let error =
                Error::usage("--frames (Python: turns) moves the camera on its way, and no camera has one");
            return Err(error.expected("orbit = 360.0 or keys = […] at the camera"));
        }
        *frames = (0..count).flat_map(|_| frames.clone()).collect();
        for (frame, turn) in frames.iter_mut().zip(0..) {
            frame.marks.turn = turn;
        }
    }
    let length = frames.len();
    if length < 2 {
        return Ok(());
    }
    for camera in cameras.into_iter().filter(|camera| !camera.parameters.is_set(PHASE)) {
        for (number, frame) in frames.iter_mut().enumerate() {
            let phase = phase(camera, number, length).map(ParameterValue::Number);
            frame.changes.extend(phase.map(|phase| Change::set(&camera.name, PHASE, phase)));
        }
    }
    Ok(())
}

/// Place on its way of a camera in one of so many pictures; `None` of a node that has no way.
fn phase(node: &GraphNode, number: usize, count: usize) -> Option<f64> {
    node.node.parameter(PHASE)?;
    let (orbit, keys) = (node.parameters.optional_number("orbit"), node.parameters.optional("keys"));
    series::phase(orbit.unwrap_or(0.0), keys.is_some(), number, count)
}

/// Quantities in which frames differ.
fn varying(frames: &[Frame]) -> Vec<Varying> {
    let differs = |kind: &Varying| frames.iter().any(|frame| kind.differs(&frame.marks, &frames[0].marks));
    Varying::ALL.into_iter().filter(differs).collect()
}

/// Changes that name the files that a frame writes.
///
/// # Errors
/// - those of [`names::path_of`], with the place of the path.
pub fn file_names(graph: &Graph, marks: &MarkValues, varying: &[Varying]) -> Result<Vec<Change>> {
    let mut changes = Vec::new();
    for (node, named) in written(graph) {
        let path = names::path_of(&named.path, marks, varying)
            .map_err(|error| node.parameters.locate(&named.parameter, error))
            .map_err(|error| node.locate(error))?;
        if path != named.path {
            changes.push(Change::set(&node.name, &named.parameter, ParameterValue::Text(path)));
        }
    }
    Ok(changes)
}

/// The files that nodes write, each with its node.
pub fn written(graph: &Graph) -> impl Iterator<Item = (&GraphNode, NamedPath)> {
    graph.nodes.iter().flat_map(|node| {
        let written = node.parameters.paths().into_iter().filter(|named| named.written);
        written.map(move |named| (node, named))
    })
}

/// Nodes that read data files, of those that some output needs.
fn readers(graph: &Graph) -> impl Iterator<Item = &GraphNode> {
    let nodes = graph.order.iter().map(|&place| &graph.nodes[place]);
    nodes.filter(|node| node.node.parameter(TIME_STEP).is_some())
}

/// Name of the first data file without folder and ending.
fn stem(graph: &Graph) -> Option<String> {
    let path = |node: &GraphNode| {
        node.parameters.paths().into_iter().find(|named| !named.written && named.parameter == "path")
    };
    let path = readers(graph).find_map(path)?;
    Some(Path::new(&path.path).file_stem()?.to_string_lossy().into_owned())
}
