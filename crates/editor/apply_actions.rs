//! Application of the actions that the parts of the window requested: edits, commands, the clipboard, runs.

use crate::actions::{Action, Command, FilePurpose};
use crate::editor::Editor;
use crate::file_dialog::FileDialog;
use crate::graph::Annotation;
use crate::jobs::Job;
use crate::picture::milliseconds;
use crate::view::View;
use crate::worker::size_of;
use eframe::egui::{Context, Event, ThemePreference};
use glam::DVec3;
use std::collections::BTreeSet;
use std::path::Path;
use voltet_core::{Error, Result};
use voltet_document::arrange::{PlacedNode, align, tidy};
use voltet_document::{Edit, Frame, Note};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{NodeEntry, ParameterValue};
use voltet_nodes::files::relative_to;

/// From a node to what is pasted after it, points.
const PASTE_OFFSET: f64 = 40.0;

impl Editor {
    pub(crate) fn apply(&mut self, ctx: &Context, action: Action) {
        match action {
            Action::Edit(label, edits) => self.edit(label, &edits),
            Action::Select(names) => self.selection = names,
            Action::Show(name) => self.shown_node = Some(name),
            Action::MoveCamera(view) => self.look(view),
            Action::Probe(places) => self.probe(places, false),
            Action::PixelProbe(found) => self.show_probed(found),
            Action::Centre(place) => self.probe(vec![place], true),
            Action::Estimate => self.estimate(),
            Action::Do(command) => self.command(ctx, command),
            Action::Say(text) => self.message = Some((text, false)),
            Action::Open(path) => self.open_any(ctx, &path),
            Action::Begin(path) => {
                self.begin_with = Some(path);
                self.unless_unsaved(ctx, Command::Open);
            }
            Action::SaveAs(path) => self.save_as(&path),
            Action::ChooseFile(asked, at) => self.file_dialog = Some(FileDialog::new(asked, at.as_deref())),
            Action::Name { node, path, file } => {
                let text = relative_to(&file, &self.document.folder()).to_string_lossy().into_owned();
                let edit = Edit::Set { node, path, value: ParameterValue::Text(text) };
                self.edit(edit.label(), &[edit]);
            }
        }
    }

    pub(crate) fn complain(&mut self, error: &Error) {
        self.message = Some((error.to_string(), true));
    }

    pub(crate) fn edit(&mut self, label: String, edits: &[Edit]) {
        self.message = None;
        if let Err(error) = self.document.edit_all(label, edits, self.gesture) {
            self.complain(&error);
            return;
        }
        // What is new is what is worked on next.
        let added: BTreeSet<String> = edits
            .iter()
            .filter_map(|edit| match edit {
                Edit::AddNode { name, .. } => Some(name.clone()),
                _ => None,
            })
            .collect();
        if !added.is_empty() {
            self.selection = added;
        }
        for edit in edits {
            if let Edit::Rename { node, to } = edit
                && self.selection.remove(node)
            {
                self.selection.insert(to.clone());
            }
        }
    }

    /// Has the camera node say so.
    pub(crate) fn look(&mut self, view: View) {
        let Some(camera) = self.camera() else { return };
        let name = camera.name.clone();
        // A standard value that stays needs not be written.
        let standing = View::from_camera(camera);
        let is_other = |key: &str| {
            standing.is_none_or(|before| match key {
                "up" => before.up != view.up,
                _ => before.projection != view.projection,
            })
        };
        let needed = view.settings().into_iter().filter(|(key, datum)| {
            camera.setting(key).map_or_else(|| is_other(key), |stated| !same(&stated.datum, datum))
        });
        let edits: Vec<Edit> = needed.map(|(key, datum)| Edit::set(&name, [key], datum)).collect();
        if !edits.is_empty() {
            self.edit(format!("move the camera '{name}'"), &edits);
        }
    }

    pub(crate) fn command(&mut self, ctx: &Context, command: Command) {
        let names = || self.selection.iter().cloned().collect::<Vec<_>>();
        match command {
            Command::New | Command::Open | Command::Quit => {
                self.begin_with = None;
                self.unless_unsaved(ctx, command);
            }
            Command::Run => self.run(ctx),
            Command::Save => self.save(),
            Command::SaveAs => {
                self.file_dialog = Some(FileDialog::new(FilePurpose::SaveAs, self.document.path()))
            }
            Command::Undo | Command::Redo => self.step(command == Command::Undo),
            Command::Copy => self.copy(ctx),
            Command::Cut => {
                self.copy(ctx);
                self.command(ctx, Command::Delete);
            }
            Command::Duplicate => self.duplicate(),
            Command::Delete => {
                let edits = [Edit::RemoveNodes(names())];
                if !self.selection.is_empty() {
                    self.edit(edits[0].label(), &edits);
                }
            }
            Command::SelectAll => {
                self.selection =
                    self.document.pipeline().nodes.iter().map(|node| node.name.clone()).collect();
            }
            Command::Add => self.graph.open_menu(),
            Command::Tidy | Command::Align(_) | Command::Frame | Command::Note => self.arrange_nodes(command),
            Command::Fold => self.fold(),
            Command::FitGraph => self.graph.fit(),
            Command::Home => {
                let bounds = self.worker.shown(|shown| shown.bounds);
                let size = self.camera().and_then(size_of).unwrap_or([4, 3]);
                if let (Some(view), Some(bounds)) = (self.camera().and_then(View::from_camera), bounds) {
                    self.look(view.home(bounds, f64::from(size[0]) / f64::from(size[1])));
                }
            }
            Command::Along(axis, from_positive) => {
                let Some(view) = self.camera().and_then(View::from_camera) else { return };
                let towards = DVec3::AXES[axis.min(2)] * if from_positive { 1.0 } else { -1.0 };
                let up = if axis == 2 { DVec3::Y } else { DVec3::Z };
                self.look(view.looking_along(towards, up));
            }
            Command::Roll(left) => {
                let Some(view) = self.camera().and_then(View::from_camera) else { return };
                let angle = 15f64.to_radians();
                self.look(view.rolled(if left { -angle } else { angle }));
            }
            Command::Theme => {
                let dark = ctx.style().visuals.dark_mode;
                ctx.set_theme(if dark { ThemePreference::Light } else { ThemePreference::Dark });
            }
            Command::Costs => self.costs = !self.costs,
            Command::Widgets => self.transfer.by_keyboard = !self.transfer.by_keyboard,
            Command::Section => self.section.open = !self.section.open,
            Command::Study => self.study.open = !self.study.open,
            Command::ReadAgain => self.read_again(),
            Command::Help => self.help = !self.help,
        }
    }

    /// Starts a full run of the document as it is shown, like `voltet run`, which writes files, beside the session of the shown
    /// picture; cancels the one in progress.
    fn run(&mut self, ctx: &Context) {
        if self.run.take().is_some() {
            self.message = Some(("the run is stopped; nothing of it is half written".into(), false));
            return;
        }
        let graph = self.document.pipeline().graph(&self.registry, self.document.folder());
        // Pictures carry the text with its comments.
        let stated = Pipeline::stated(self.document.text().to_string(), &self.registry);
        let started = graph.and_then(|mut graph| {
            graph.stated = stated?;
            Job::start("run", ctx, move |observer| voltet_nodes::session().run(&graph, observer))
        });
        match started {
            Ok(run) => {
                self.run = Some(run);
                self.message = Some(("running; Ctrl+R stops it".into(), false));
            }
            Err(error) => self.complain(&error),
        }
    }

    /// Shows the outcome of a run, once it has ended.
    pub(crate) fn show_run(&mut self) {
        let Some(outcome) = self.run.as_ref().and_then(Job::result) else { return };
        self.run = None;
        match outcome {
            Ok(report) => {
                let folder = self.document.folder();
                let name = |file: &String| relative_to(Path::new(file), &folder).display().to_string();
                let files = match report.files.is_empty() {
                    true => "no files".into(),
                    false => report.files.iter().map(name).collect::<Vec<_>>().join(", "),
                };
                let text = format!("written in {}: {files}", milliseconds(report.seconds));
                self.message = Some((text, false));
            }
            Err(error) => self.complain(&error),
        }
    }

    fn step(&mut self, back: bool) {
        let label = match back {
            true => self.document.history().undo_label().map(|label| format!("undone: {label}")),
            false => self.document.history().redo_label().map(|label| format!("done again: {label}")),
        };
        let outcome = if back { self.document.undo() } else { self.document.redo() };
        match outcome {
            Ok(true) => self.message = label.map(|label| (label, false)),
            Ok(false) => self.message = Some(("there is nothing more".into(), false)),
            Err(error) => self.complain(&error),
        }
    }

    fn selected(&self) -> Vec<String> {
        self.selection.iter().cloned().collect()
    }

    /// The selected nodes as text.
    pub(crate) fn copy(&self, ctx: &Context) {
        if !self.selection.is_empty() {
            ctx.copy_text(self.document.copy(&self.selected()));
        }
    }

    /// Copies of the selected nodes beside them.
    pub(crate) fn duplicate(&mut self) {
        if !self.selection.is_empty() {
            let outcome = self.document.duplicate(&self.selected());
            self.take_copies(outcome);
        }
    }

    /// Takes what the clipboard gives, unless a text field does.
    pub(crate) fn paste(&mut self, ctx: &Context) {
        if ctx.wants_keyboard_input() {
            return;
        }
        let pasted = ctx.input(|input| {
            input.events.iter().find_map(|event| match event {
                Event::Paste(text) => Some(text.clone()),
                _ => None,
            })
        });
        let Some(text) = pasted else { return };
        let at = self.selection.iter().next().map_or([0.0; 2], |name| self.document.position(name));
        let outcome = self.document.paste(&text, at.map(|x| x + PASTE_OFFSET));
        self.take_copies(outcome);
    }

    /// Selects the added nodes.
    fn take_copies(&mut self, outcome: Result<Vec<String>>) {
        match outcome {
            Ok(names) => self.selection = names.into_iter().collect(),
            Err(error) => self.complain(&error),
        }
    }

    /// The selected nodes show their heads alone; all of them, if all do.
    pub(crate) fn fold(&mut self) {
        let views = &self.document.view().nodes;
        let is_folded = |name: &String| views.get(name).is_some_and(|view| view.folded);
        let folded = !self.selection.iter().all(is_folded);
        let other = self.selection.iter().filter(|name| is_folded(name) != folded);
        let edits: Vec<Edit> = other.map(|name| Edit::Fold { node: name.clone(), folded }).collect();
        if !edits.is_empty() {
            self.edit(if folded { "fold" } else { "unfold" }.into(), &edits);
        }
    }

    /// Moves nodes, and adds frames and notes.
    pub(crate) fn arrange_nodes(&mut self, command: Command) {
        let all = &self.document.pipeline().nodes;
        let nodes: Vec<NodeEntry> = match self.selection.is_empty() {
            true => all.clone(),
            false => all.iter().filter(|node| self.selection.contains(&node.name)).cloned().collect(),
        };
        let placed = |node: &NodeEntry| PlacedNode {
            name: node.name.clone(),
            position: self.document.position(&node.name),
            size: self.graph.size_of(&node.name),
        };
        let placed: Vec<PlacedNode> = nodes.iter().map(placed).collect();
        let least = |axis: usize| placed.iter().map(|node| node.position[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| {
            placed.iter().map(|node| node.position[axis] + node.size[axis]).fold(f64::NEG_INFINITY, f64::max)
        };
        let (label, edit) = match command {
            Command::Tidy if !nodes.is_empty() => {
                let places = tidy(&nodes, &|name| self.graph.size_of(name));
                let moved = nodes.iter().zip(places);
                let moved = moved.map(|(node, [x, y])| (node.name.clone(), [x + least(0), y + least(1)]));
                ("tidy", Edit::MoveNodes(moved.collect()))
            }
            Command::Align(how) if nodes.len() > 1 => ("align", Edit::MoveNodes(align(&placed, how))),
            Command::Frame if !self.selection.is_empty() => {
                let at = [least(0) - 20.0, least(1) - 36.0];
                let size = [most(0) + 20.0 - at[0], most(1) + 20.0 - at[1]];
                let count = self.document.view().frames.len();
                let frame = Frame { title: "frame".into(), position: at, size, color: None };
                ("add a frame", Edit::PutFrame(count, frame))
            }
            Command::Note => {
                let count = self.document.view().notes.len();
                let at = if nodes.is_empty() { [0.0, 0.0] } else { [least(0), most(1) + 30.0] };
                ("add a note", Edit::PutNote(count, Note { text: "a note".into(), position: at }))
            }
            _ => return,
        };
        self.edit(label.into(), std::slice::from_ref(&edit));
        match &edit {
            Edit::PutFrame(number, frame) => self.graph.write_on(Annotation::Frame(*number), &frame.title),
            Edit::PutNote(number, note) => self.graph.write_on(Annotation::Note(*number), &note.text),
            _ if command == Command::Tidy => self.graph.fit(),
            _ => {}
        }
    }
}

/// True if two values are equal; 2 and 2.0 are.
fn same(a: &ParameterValue, b: &ParameterValue) -> bool {
    match (a, b) {
        (ParameterValue::List(a), ParameterValue::List(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(&a.datum, &b.datum))
        }
        (ParameterValue::Integer(a), ParameterValue::Number(b))
        | (ParameterValue::Number(b), ParameterValue::Integer(a)) => *a as f64 == *b,
        _ => a == b,
    }
}
