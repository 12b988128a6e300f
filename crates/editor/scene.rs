//! Read-only view of the editor for the window's parts while a frame is shown, and their requests, which are applied after all of them were
//! shown, so that each shows the same document.

use crate::jobs::Arrays;
use crate::templates::Template;
use crate::view::View;
use crate::worker::{Distribution, Hit, NodeStatus, PixelProbe, Pixels, Section, Share, VolumeSource};
use eframe::egui::Ui;
use glam::DVec3;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::{Error, Result};
use voltet_document::arrange::Align;
use voltet_document::links::upstream;
use voltet_document::panel::DataExtent;
use voltet_document::{Document, Edit, Path, links};
use voltet_graph::{Node, NodeEntry, Port, PortType, Registry, RunReport};

/// View of the editor in one frame, and what the parts of the window request.
pub(crate) struct Scene<'a> {
    pub actions: &'a Actions,
    pub document: &'a Document,
    pub registry: &'a Registry,
    pub arrays: &'a Arrays,
    pub templates: &'a [Template],
    pub selection: &'a BTreeSet<String>,
    pub shown_node: Option<&'a str>,
    pub view: Option<View>,
    /// Its size as the document says.
    pub picture_size: Option<[u32; 2]>,
    pub pixels: Option<Pixels>,
    pub previews: BTreeMap<String, Pixels>,
    /// The nodes whose pictures, at large or small, are of an earlier state of the document or the data.
    pub earlier: BTreeSet<&'a str>,
    /// True if a question must be answered first, and other input is blocked.
    pub asks: bool,
    /// True if a text was typed in the last frame: the keys of this one may be the end of it.
    pub was_typing: bool,
    pub nodes: BTreeMap<String, NodeStatus>,
    /// For each output what runs through it, and the box of its points.
    pub values: Arc<BTreeMap<String, String>>,
    pub bounds: Arc<BTreeMap<String, [DVec3; 2]>>,
    pub failure: Option<Error>,
    pub running: Option<String>,
    pub seconds: Option<f64>,
    /// The distribution of what the selected transfer function is drawn with.
    pub distribution: Option<Arc<Distribution>>,
    /// Reason why there is none.
    pub distribution_fault: Option<Error>,
    /// Stage of the distribution that is being computed, and how much of that is done (0 … 1).
    pub distribution_progress: Option<(String, f64)>,
    pub probed: Option<Arc<PixelProbe>>,
    /// Place that is seen first under the pointer in the picture.
    pub hovered: Option<Hit>,
    /// The output that gives the volume in which it is looked for.
    pub hovered_in: Option<String>,
    /// True if the picture is drawn with a widget that is proposed.
    pub proposes: bool,
    /// Points of the length that is measured, world units.
    pub measured: &'a [DVec3],
    /// Contribution of the selected widget to the picture, or an error message; `None` while unknown.
    pub share: Option<Result<Share>>,
    pub section: Option<Result<Arc<Section>>>,
    /// True if the section is of an earlier state.
    pub is_section_earlier: bool,
    pub report: Option<Arc<RunReport>>,
    /// Estimated error of the picture, if requested.
    pub estimate: Option<Result<[f64; 2]>>,
    pub is_estimating: bool,
    /// Faults of the document, each with the node that it concerns.
    pub faults: &'a [Error],
    /// The document's nodes by name: looked up for every port and wire of a frame.
    pub entries: HashMap<&'a str, &'a NodeEntry>,
}

/// Most letters of a title that is made of a comment.
const TITLE: usize = 28;

/// The beginning of a comment, up to where it explains.
fn beginning(comment: &str) -> String {
    let end = [". ", ": ", "; ", ", ", " ("].iter().filter_map(|mark| comment.find(mark)).min();
    let words = comment[..end.unwrap_or(comment.len())].trim_end_matches(['.', ':']);
    match words.char_indices().nth(TITLE) {
        Some((end, _)) => format!("{} …", words[..end].trim_end()),
        None => words.to_string(),
    }
}

impl Scene<'_> {
    /// Reason for which there is no picture or histogram: the error, or where it is said already.
    pub fn reason(&self, what: &str, error: &Error) -> String {
        match error.location.node.as_ref().filter(|_| self.is_said(error)) {
            Some(node) => format!("no {what}: '{node}' has a fault"),
            None => error_text(error, self.document),
        }
    }

    /// True if an error of the same node is said elsewhere.
    pub fn is_said(&self, error: &Error) -> bool {
        let of_picture = self.failure.iter().filter(|said| !std::ptr::eq(*said, error));
        let mut others = self.faults.iter().chain(of_picture);
        error.location.node.is_some() && others.any(|said| said.location.node == error.location.node)
    }

    /// Line of the document's text that an error is about, from 1.
    pub fn line_of(&self, error: &Error) -> Option<usize> {
        let own = self.document.locate(Error::usage("")).location.file;
        error.location.line_column.filter(|_| error.location.file == own).map(|(line, _)| line)
    }

    /// True if an error is about another file than the document's.
    pub fn is_of_other_file(&self, error: &Error) -> bool {
        let file = &error.location.file;
        file.is_some() && *file != self.document.locate(Error::usage("")).location.file
    }

    /// Name of an entry of a node: the one that the file states, else its comment; `None` without both.
    pub fn name_of(&self, node: &str, path: &Path, stated: Option<&str>) -> Option<String> {
        let stated = stated.filter(|name| !name.is_empty()).map(str::to_string);
        stated.or_else(|| Some(beginning(&self.document.comment(node, path)?)))
    }
}

/// An error as the window says it: without the place in the document's own file, and without what is right in the words of that file alone.
pub(crate) fn error_text(error: &Error, document: &Document) -> String {
    let mut text = error.location.node.as_ref().map_or(String::new(), |node| format!("{node}: "));
    text += &error.what;
    if let Some(got) = &error.got {
        text += &format!(": found {got}");
    }
    if let Some(expected) = error.expected.as_ref().filter(|expected| !expected.contains(" = ")) {
        text += &format!("; expected {expected}");
    }
    let item = error.location.item.as_ref().map(|item| format!("'{item}'"));
    let own = document.locate(Error::usage("")).location.file;
    let file = error.location.file.clone().filter(|file| Some(file) != own.as_ref());
    let places: Vec<String> =
        file.into_iter().chain(item.filter(|item| !text.contains(item.as_str()))).collect();
    if !places.is_empty() {
        text += &format!(" ({})", places.join(", "));
    }
    text
}

/// Words for pictures that are [earlier](Scene::earlier).
pub(crate) const EARLIER: &str = "of an earlier state";

/// Time for which what is shown may be of an earlier request: while a hand moves, each picture is one behind.
const GRACE: Duration = Duration::from_millis(300);

/// Time since which an answer is not that to the newest request.
#[derive(Debug, Default)]
pub(crate) struct Lag {
    /// Number of the request that was answered, and the time.
    since: Option<(u64, Instant)>,
    pub is_long: bool,
}

impl Lag {
    /// Takes the numbers of the newest request and of the answered one; returns the time until the lag is long, if there is one.
    pub fn follow(&mut self, [newest, answered]: [u64; 2], now: Instant) -> Option<Duration> {
        self.since = self.since.filter(|(number, _)| *number == answered && newest != answered);
        if newest != answered && self.since.is_none() {
            self.since = Some((answered, now));
        }
        let left = self.since.map(|(_, since)| GRACE.saturating_sub(now.duration_since(since)));
        self.is_long = left.is_some_and(|left| left.is_zero());
        left.filter(|left| !left.is_zero())
    }
}

impl<'a> Scene<'a> {
    /// True if the large picture is of an earlier state.
    pub fn is_earlier(&self) -> bool {
        self.shown_node.is_some_and(|node| self.earlier.contains(node))
    }

    /// Name of the array that is s where the edited transfer function is drawn, once its data were looked at.
    pub fn scalar(&self) -> Option<&str> {
        self.distribution.as_ref().map(|found| found.scalar.as_str()).filter(|name| !name.is_empty())
    }

    /// The data that are shown, as things that are added find them.
    pub fn data_extent(&self) -> DataExtent {
        let joined = |[low, high]: [DVec3; 2], [from, to]: [DVec3; 2]| [low.min(from), high.max(to)];
        let bounds = self.bounds.values().copied().reduce(joined).unwrap_or([DVec3::ZERO, DVec3::ONE]);
        let forward = self.view.map_or(DVec3::X, |view| view.target - view.eye);
        DataExtent { bounds: bounds.map(|end| end.to_array()), forward: forward.to_array() }
    }

    pub fn entry(&self, name: &str) -> Option<&'a NodeEntry> {
        self.entries.get(name).copied()
    }

    /// The node and the output that a source names, the first where it names none; and the output's declaration.
    pub fn giving<'t>(&self, text: &'t str) -> (&'t str, &'t str, Option<&'static Port>) {
        let (name, output) = links::source(text, &self.document.pipeline().nodes);
        let node = self.entry(name).and_then(|entry| self.node_type(entry));
        let outputs = node.map_or(&[][..], |node| node.outputs);
        let given = match output {
            Some(output) => outputs.iter().find(|port| port.name == output),
            None => outputs.first(),
        };
        (name, output.or(given.map(|port| port.name)).unwrap_or_default(), given)
    }

    /// The node and the output that a source names.
    pub fn output_of(&self, text: &str) -> (String, String) {
        let (node, output, _) = self.giving(text);
        (node.to_string(), output.to_string())
    }

    pub fn is_empty(&self) -> bool {
        self.document.pipeline().nodes.is_empty() && self.document.is_toml()
    }

    pub fn node_type(&self, entry: &NodeEntry) -> Option<&'static Node> {
        self.registry.node_type(entry)
    }

    pub fn pictures(&self) -> Vec<&'a str> {
        pictures(self.document, self.registry)
    }
}

pub(crate) fn camera_of<'a>(nodes: &'a [NodeEntry], picture: &str) -> Option<&'a NodeEntry> {
    let feeding = upstream(nodes, picture);
    nodes.iter().find(|node| node.node_type.text() == Some("camera") && feeding.contains(&node.name))
}

/// A time in words.
pub(crate) fn milliseconds(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => "< 1 ms".into(),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 100.0 => format!("{s:.1} s"),
        s => format!("{s:.0} s"),
    }
}

/// The names of the nodes that give pictures, in the order of the document.
pub(crate) fn pictures<'a>(document: &'a Document, registry: &Registry) -> Vec<&'a str> {
    let gives = |node: &&NodeEntry| {
        registry
            .node_type(node)
            .is_some_and(|node| node.outputs.iter().any(|port| port.port_type == PortType::Image))
    };
    document.pipeline().nodes.iter().filter(gives).map(|node| node.name.as_str()).collect()
}

#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Edits of the document, one step in its history; while a mouse button is held, all of them are one.
    Edit(String, Vec<Edit>),
    Select(BTreeSet<String>),
    Show(String),
    /// Takes what nodes add out of the picture, or brings it back.
    ToggleEyes(BTreeSet<String>),
    MoveCamera(View),
    /// The values at places of the picture are asked for (heights from its middle, to the right and up).
    Probe(Vec<[f64; 2]>, ProbePurpose),
    /// Values of a volume were found otherwise.
    PixelProbe(VolumeSource, Arc<PixelProbe>),
    Estimate,
    Do(Command),
    Say(String),
    /// The text of the pipeline is shown, at a line.
    ShowText(usize),
    /// A pipeline file is opened, or one that is made for a file that is none, after a question about unsaved work.
    Begin(PathBuf),
    /// A pipeline of a template is made for a data file that is asked for, after a question about unsaved work.
    BeginFrom(Template),
    /// Opens a file dialog, at the path of a file if there is one.
    ChooseFile(FilePurpose, Option<PathBuf>),
}

/// Use of what a probe of the picture finds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProbePurpose {
    /// Values are shown, for widgets.
    Values,
    /// The picture is centred on the point.
    Centre,
    /// The point is an end of a length.
    Length,
}

#[derive(Debug, Clone, PartialEq)]
pub enum FilePurpose {
    Open,
    SaveAs,
    Data(Template),
    Film,
    /// Names it in a parameter of a node, which reads or writes it.
    Parameter {
        node: String,
        path: Path,
        writes: bool,
    },
}

/// Commands of keys and menus; the table of keys has words for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Command {
    New,
    /// A pipeline that needs no data file.
    Example,
    Open,
    Save,
    SaveAs,
    ReadAgain,
    Run,
    Quit,
    Undo,
    Redo,
    Copy,
    Cut,
    Duplicate,
    Delete,
    SelectAll,
    Add,
    /// A wire of the selected node, chosen from a list.
    Wire,
    /// The parameters of the selected node, to be typed.
    Edit,
    /// The node beside the selected one, so many steps to the right and down.
    Step(i8, i8),
    /// The selected nodes, moved so many steps to the right and down.
    Shift(i8, i8),
    Tidy,
    Align(Align),
    Fold,
    /// Takes what the selected nodes add out of the picture, or brings it back.
    Eye,
    Frame,
    Note,
    FitGraph,
    Home,
    /// Seen along an axis (0: x, 1: y, 2: z), from its positive or its negative side.
    Along(usize, bool),
    /// Seen from the positive sides of all axes alike.
    Isometric,
    /// To the left, or to the right.
    Roll(bool),
    Theme,
    /// Everything in the window: larger (1), smaller (−1), as large as usual (0).
    Zoom(i8),
    Costs,
    Widgets,
    Section,
    Study,
    /// Another frame of the time series or of the camera's way.
    Time(TimeMove),
    /// The sheet that makes films.
    Film,
    /// The strip of frames, also where there is only a camera.
    Strip,
    Help,
}

/// A place that a command moves the strip to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TimeMove {
    First,
    Previous,
    Next,
    Last,
    /// Begins to play, or stops.
    Play,
}

/// Buttons of a menu, each for a command.
pub(crate) fn command_buttons(ui: &mut Ui, actions: &Actions, buttons: &[(&str, Command)]) {
    for (text, command) in buttons {
        if ui.button(*text).clicked() {
            actions.command(*command);
            ui.close();
        }
    }
}

/// Requests collected while a frame is shown.
#[derive(Debug, Default)]
pub struct Actions(RefCell<Vec<Action>>);

impl Actions {
    pub fn take(&self) -> Vec<Action> {
        self.0.take()
    }

    pub fn push(&self, action: Action) {
        self.0.borrow_mut().push(action);
    }

    pub fn edit(&self, edit: Edit) {
        self.edits(edit.label(), vec![edit]);
    }

    /// Requests several edits as one step.
    pub fn edits(&self, label: impl Into<String>, edits: Vec<Edit>) {
        if !edits.is_empty() {
            self.push(Action::Edit(label.into(), edits));
        }
    }

    /// Requests that a line for the user is shown.
    pub fn say(&self, text: impl ToString) {
        self.push(Action::Say(text.to_string()));
    }

    pub fn command(&self, command: Command) {
        self.push(Action::Do(command));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_is_long_where_no_answer_comes_and_not_where_each_is_one_behind() {
        let begin = Instant::now();
        let at = |share: f64| begin + GRACE.mul_f64(share);
        let mut lag = Lag::default();
        assert_eq!((lag.follow([7, 7], at(0.0)), lag.is_long), (None, false));
        for step in 0..10u64 {
            let left = lag.follow([8 + step, 7 + step], at(0.5 * step as f64));
            assert_eq!((left, lag.is_long), (Some(GRACE), false));
        }
        assert!(lag.follow([18, 16], at(5.0)).is_some_and(|left| left < GRACE) && !lag.is_long);
        assert_eq!((lag.follow([18, 16], at(5.6)), lag.is_long), (None, true));
        assert_eq!((lag.follow([18, 18], at(5.7)), lag.is_long), (None, false));
    }
}
