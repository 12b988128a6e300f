//! Time series of a pipeline, and the way of its cameras: what differs from one picture of several to the next.

use crate::Change;
use voltet_core::{Error, Result};
use voltet_graph::{Graph, GraphNode, LocatedValue, NodeEntry, ParameterValue};

/// Parameters of a reader that name its step.
pub const TIME_STEP: &str = "time_step";
/// Time of the step, in place of its number.
pub const TIME: &str = "time";

/// Parameter of a reader that says what is read between steps.
const BETWEEN: &str = "between_steps";

/// Place of a camera on its way (`orbit`, degrees; keys), 0 to 1, in one of `count` pictures; `None` where it has no way.
pub fn phase(orbit: f64, has_keys: bool, number: usize, count: usize) -> Option<f64> {
    if orbit == 0.0 && !has_keys {
        return None;
    }
    // The last picture of a whole turn comes before the first again.
    let is_closed = orbit != 0.0 && orbit % 360.0 == 0.0 && !has_keys;
    let last = if is_closed { count } else { count.max(2) - 1 };
    Some(number as f64 / last as f64)
}

/// Time series that the readers of a pipeline read together.
#[derive(Debug, Clone, Default)]
pub struct Series {
    readers: Vec<SeriesReader>,
    /// True if some reader of a series stays at the step that it names, while others go on.
    pub has_fixed: bool,
    /// True if some reader has values between steps.
    pub is_interpolated: bool,
    /// Number of the step that the pipeline names.
    pub own: usize,
    /// Time of each step.
    pub times: Vec<f64>,
}

/// A node that reads a time series.
#[derive(Debug, Clone)]
struct SeriesReader {
    node: String,
    /// True if it names its step by a time.
    names_time: bool,
    /// True if the file names its step.
    names_step: bool,
    /// True if the file has the parameter for a step, which may be all.
    has_step: bool,
    own: usize,
    times: Vec<f64>,
}

impl Series {
    /// The series of the nodes that some output needs. Where some of several name their step, those stay there. Files are opened,
    /// headers alone.
    ///
    /// # Errors
    /// - files that cannot be read, series of different lengths, values between steps of different times.
    pub fn from_graph(graph: &Graph) -> Result<Series> {
        let mut series = Series::default();
        let mut readers: Vec<(&GraphNode, SeriesReader)> = Vec::new();
        for &place in &graph.order {
            let node = &graph.nodes[place];
            let found = graph.time_series(place)?;
            if found.steps.len() < 2 {
                if series.times.is_empty() {
                    series.times = found.times;
                }
                continue;
            }
            let p = &node.parameters;
            let names_time = p.is_set(TIME);
            let is_number = p.optional(TIME_STEP).is_some_and(|step| step.text().is_none());
            let (own, times) = (found.own, found.times);
            let (names_step, has_step) = (names_time || is_number, p.is_set(TIME_STEP));
            let node_name = node.name.clone();
            readers
                .push((node, SeriesReader { node: node_name, names_time, names_step, has_step, own, times }));
        }
        let is_mixed = readers.iter().any(|(_, reader)| !reader.names_step);
        series.has_fixed = is_mixed && readers.iter().any(|(_, reader)| reader.names_step);
        readers.retain(|(_, reader)| !(is_mixed && reader.names_step));
        for (node, reader) in readers {
            match series.readers.first() {
                None => (series.own, series.times) = (reader.own, reader.times.clone()),
                Some(first) if first.times.len() != reader.times.len() => {
                    let error = Error::usage("two time series have different numbers of steps");
                    let [count, own] = [first, &reader].map(|reader| reader.times.len());
                    let counts = format!("{count} of '{}' and {own} of '{}'", first.node, reader.node);
                    let accepted = "series of the same length, or a time_step for the one that stays";
                    return Err(node.locate(error.got(counts).expected(accepted)));
                }
                Some(_) => {}
            }
            series.is_interpolated |=
                node.parameters.optional(BETWEEN).is_some_and(|word| word.text() == Some("linear"));
            series.readers.push(reader);
        }
        if series.is_interpolated
            && let Some(other) = series.readers.iter().find(|reader| reader.times != series.times)
        {
            let error = Error::usage("readers of values between steps have series of different times");
            let error = error.got(format!("'{}' and '{}'", series.readers[0].node, other.node));
            return Err(error.expected("series of the same times, or between_steps = \"nearest\""));
        }
        Ok(series)
    }

    /// True if no reader of a series goes from step to step.
    pub fn is_none(&self) -> bool {
        self.readers.is_empty()
    }

    /// Number of steps, 1 where there is no series.
    pub fn count(&self) -> usize {
        if self.readers.is_empty() { 1 } else { self.times.len() }
    }

    /// Number of the step that the nodes of the pipeline state now.
    pub fn step_of(&self, nodes: &[NodeEntry]) -> usize {
        let named = |reader: &&SeriesReader| nodes.iter().find(|node| node.name == reader.node);
        let Some(node) = self.readers.first().as_ref().and_then(named) else { return self.own };
        let number = |name: &str| node.setting(name).and_then(LocatedValue::number);
        let distance = |step: &usize, time: f64| (self.times[*step] - time).abs();
        match (number(TIME), number(TIME_STEP)) {
            (Some(time), _) => {
                let nearer = |a: &usize, b: &usize| distance(a, time).total_cmp(&distance(b, time));
                (0..self.count()).min_by(nearer).unwrap_or(0)
            }
            (None, Some(step)) => (step.max(0.0) as usize).min(self.count() - 1),
            (None, None) => self.own,
        }
    }

    /// Changes by which the nodes state a step; none of a reader that states exactly that one, or reads it without stating any.
    pub fn stated_at(&self, step: usize, nodes: &[NodeEntry]) -> Vec<Change> {
        let mut changes = Vec::new();
        for reader in &self.readers {
            let Some(node) = nodes.iter().find(|node| node.name == reader.node) else { continue };
            let number = |name: &str| node.setting(name).and_then(LocatedValue::number);
            let is_there = match (number(TIME), number(TIME_STEP)) {
                (None, Some(stated)) => stated == step as f64,
                (Some(time), None) => reader.times.get(step) == Some(&time),
                (None, None) => reader.own == step,
                (Some(_), Some(_)) => false,
            };
            if is_there {
                continue;
            }
            changes.extend(node.setting(TIME).map(|_| Change::unset(&node.name, TIME)));
            changes.push(Change::set(&node.name, TIME_STEP, ParameterValue::Integer(step as i64)));
        }
        changes
    }

    /// Changes that let every reader read at a time.
    pub fn at_time(&self, time: f64) -> Vec<Change> {
        let of_reader = |SeriesReader { node, has_step, .. }: &SeriesReader| {
            let step = has_step.then(|| Change::unset(node, TIME_STEP));
            step.into_iter().chain([Change::set(node, TIME, ParameterValue::Number(time))])
        };
        self.readers.iter().flat_map(of_reader).collect()
    }

    /// Changes that let every reader read a step.
    pub fn at(&self, step: usize) -> Vec<Change> {
        let mut changes = Vec::new();
        for SeriesReader { node, names_time, .. } in &self.readers {
            if *names_time {
                changes.push(Change::unset(node, TIME));
            }
            changes.push(Change::set(node, TIME_STEP, ParameterValue::Integer(step as i64)));
        }
        changes
    }
}
