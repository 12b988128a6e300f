//! Application of the actions that the parts of the window requested.

use crate::actions::FilePurpose;
use crate::actions::{Action, Command};
use crate::editor::Editor;
use crate::file_dialog::FileDialog;
use crate::files::Disk;
use crate::graph::GraphView;
use crate::parameters::ParameterPanel;
use crate::picture::milliseconds;
use crate::run::Run;
use crate::transfer::TransferPanel;
use crate::view::View;
use crate::worker::size_of;
use eframe::egui::{Context, ThemePreference};
use glam::DVec3;
use std::collections::BTreeSet;
use std::path::Path;
use voltet_core::Error;
use voltet_document::{Document, Edit};
use voltet_graph::ParameterValue;
use voltet_nodes::files::relative_to;

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
        let stated = |key: &str| camera.settings.iter().find(|field| field.name == key);
        let settings = view.settings().into_iter();
        let changed = settings
            .filter(|(key, datum)| stated(key).is_none_or(|field| !same(&field.setting.datum, datum)));
        // A standard value that stays needs not be written.
        let standing = View::from_camera(camera);
        let needed = changed.filter(|(key, _)| {
            stated(key).is_some()
                || standing.is_none_or(|before| match *key {
                    "up" => before.up != view.up,
                    _ => before.projection != view.projection,
                })
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

    /// Starts a run of the document as it is shown; cancels the one in progress.
    fn run(&mut self, ctx: &Context) {
        if self.run.take().is_some() {
            self.message = Some(("the run is stopped; nothing of it is half written".into(), false));
            return;
        }
        match Run::start(&self.document, &self.registry, ctx) {
            Ok(run) => {
                self.run = Some(run);
                self.message = Some(("running; Ctrl+R stops it".into(), false));
            }
            Err(error) => self.complain(&error),
        }
    }

    /// Shows the outcome of a run, once it has ended.
    pub(crate) fn show_run(&mut self) {
        let Some(outcome) = self.run.as_ref().and_then(Run::report) else { return };
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

    /// Carries out what takes the document away, or asks first.
    fn unless_unsaved(&mut self, ctx: &Context, command: Command) {
        match self.document.is_saved() {
            true => self.go_on(ctx, command),
            false => self.unsaved = Some(command),
        }
    }

    /// Carries it out.
    pub(crate) fn go_on(&mut self, ctx: &Context, command: Command) {
        match (command, self.begin_with.take()) {
            (Command::New, _) => self.take(Document::new()),
            (Command::Open, Some(path)) => self.open_any(ctx, &path),
            (Command::Open, None) => {
                self.file_dialog = Some(FileDialog::new(FilePurpose::Open, self.document.path()))
            }
            _ => self.ends = true,
        }
    }

    /// Another document in place of this one.
    pub(crate) fn take(&mut self, document: Document) {
        self.document = document;
        self.run = None;
        self.recover.forget();
        self.begin();
        self.disk = Disk::default();
        self.shown_node = None;
        (self.asked, self.ground, self.previews_of) = (None, None, None);
        self.worker.forget_previews();
        // Revisions count from the beginning of each document.
        self.faults = (None, Vec::new());
        self.parameters = ParameterPanel::default();
        self.message = None;
        self.graph = GraphView::default();
        self.transfer = TransferPanel::default();
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
