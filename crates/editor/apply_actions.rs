//! Application of the actions that the parts of the window requested: edits, commands, the clipboard, runs; the document's file, which is
//! opened or made for data, saved, changed by another program.

use crate::drawn_with::wires_past;
use crate::editor::{Editor, Next, Panels};
use crate::eyes;
use crate::files::{Disk, FileDialog, is_pipeline};
use crate::jobs::{Arrays, Job};
use crate::picture::milliseconds;
use crate::scene::{Action, Command, FilePurpose, error_text};
use crate::view::View;
use crate::ways_out::Message;
use crate::worker::size_of;
use eframe::egui::{Context, Event, ThemePreference, gui_zoom};
use glam::DVec3;
use std::collections::BTreeSet;
use std::path::Path;
use voltet_core::{Error, Result, counted};
use voltet_document::arrange::{PlacedNode, align, tidy};
use voltet_document::{Annotation, AnnotationId, Document, Edit};
use voltet_graph::NodeEntry;
use voltet_graph::pipeline::Pipeline;
use voltet_nodes::VIEW_PARAMETERS;
use voltet_nodes::files::{folder, refuse_unwritable, relative_to};

/// From a node to what is pasted after it, points.
const PASTE_OFFSET: f64 = 40.0;

impl Editor {
    pub(crate) fn apply(&mut self, ctx: &Context, action: Action) {
        match action {
            Action::Edit(label, edits) => self.edit(label, &edits),
            Action::Select(names) => self.select(names),
            Action::ToggleEyes(names) => self.toggle_eyes(&names),
            Action::Show(name) => self.show_picture(&name),
            Action::MoveCamera(view) => self.look(view),
            Action::Probe(places, purpose) => self.probe(places, purpose),
            Action::PixelProbe(source, found) => self.show_probed(source, found),
            Action::Estimate => self.estimate(),
            Action::Do(command) => self.command(ctx, command),
            Action::Say(text) => self.say(text),
            Action::ShowText(line) => self.panels.text.open_at(Some(line)),
            Action::Begin(path) => self.unless_unsaved(ctx, Next::Open(path)),
            Action::BeginFrom(template) => {
                self.unless_unsaved(ctx, Next::Choose(FilePurpose::Data(template)))
            }
            Action::ChooseFile(asked, at) => self.file_dialog = Some(FileDialog::new(asked, at.as_deref())),
        }
    }

    /// A file was chosen in the dialog, which stays open with the reason where the file cannot be opened.
    pub(crate) fn chosen(&mut self, ctx: &Context, dialog: FileDialog, file: &Path) {
        match dialog.purpose.clone() {
            FilePurpose::Open => {
                self.message = None;
                self.open_by(ctx, file, dialog);
            }
            FilePurpose::Data(template) => {
                let registry = self.registry.clone();
                self.make(ctx, file, dialog, move |file, at, progress| {
                    template.filled(file, at, &registry, progress)
                });
            }
            FilePurpose::SaveAs => self.save_as(file),
            FilePurpose::Film => {
                let path = relative_to(file, &self.document.folder());
                self.panels.time.film.path = Some(path.to_string_lossy().into_owned());
            }
            FilePurpose::Parameter { node, path, .. } => {
                let text = relative_to(file, &self.document.folder()).to_string_lossy().into_owned();
                self.edit_one(Edit::Set { node, path, value: text.into() });
            }
        }
    }

    /// Shows the dialog by which a file was chosen that cannot be opened, or would be, with the reason, unless another is open.
    pub(crate) fn ask_again(&mut self, mut dialog: FileDialog) {
        if let (Some(Message { text, error: Some(_), .. }), None) = (&self.message, &self.file_dialog) {
            dialog.refuse(text.clone());
            self.file_dialog = Some(dialog);
        }
    }

    /// Value of an outcome; an error is shown.
    pub(crate) fn check<T>(&mut self, outcome: Result<T>) -> Option<T> {
        self.check_of(outcome, None)
    }

    /// Value of an outcome of a command, which can be given again where it failed.
    fn check_of<T>(&mut self, outcome: Result<T>, again: Option<Command>) -> Option<T> {
        let said = |error: Error| {
            let text = error_text(&error, &self.document);
            self.message = Some(Message { text, error: Some(error), again });
        };
        outcome.map_err(said).ok()
    }

    pub(crate) fn say(&mut self, text: impl Into<String>) {
        self.message = Some(Message { text: text.into(), error: None, again: None });
    }

    pub(crate) fn edit_one(&mut self, edit: Edit) {
        self.edit(edit.label(), &[edit]);
    }

    pub(crate) fn edit(&mut self, label: String, edits: &[Edit]) {
        self.message = None;
        let (pending, looks) = (self.before_rescale(edits), self.before_scales(edits));
        let gesture = pending.as_ref().map(|pending| pending.gesture).or(self.gesture);
        let gesture = gesture.or_else(|| (!looks.is_empty()).then(|| self.gestures.begin()));
        // Where nodes stand that the file gives no places follows from nodes and wires: of others they would stand elsewhere next time.
        let is_laid_out_by = |edit: &Edit| {
            matches!(edit, Edit::RemoveNodes(_) | Edit::Connect { .. } | Edit::Disconnect { .. })
        };
        let places = edits.iter().any(is_laid_out_by).then(|| Edit::MoveNodes(Vec::new()));
        let all: Vec<Edit> = edits.iter().cloned().chain(places).collect();
        let outcome = self.document.edit_all(label, &all, gesture);
        if self.check(outcome).is_none() {
            return;
        }
        pending.into_iter().for_each(|pending| self.expect_ranges(pending));
        self.follow_scales(looks, gesture);
        let mut added = BTreeSet::new();
        for edit in edits {
            match edit {
                Edit::AddNode { name, .. } => {
                    added.insert(name.clone());
                    self.show_made_of_shown(name);
                    self.expect_array(name);
                }
                Edit::Set { node, path, .. } if *path == "path".into() => self.expect_array(node),
                Edit::Rename { node, to } => {
                    if self.selection.remove(node) {
                        self.selection.insert(to.clone());
                    }
                    if self.shown_node.as_ref() == Some(node) {
                        self.show_picture(to);
                    }
                }
                _ => {}
            }
        }
        // What is new is what is worked on next.
        self.show_new(added);
    }

    pub(crate) fn move_camera(&mut self, to: impl FnOnce(View) -> View) {
        if let Some(view) = self.view() {
            self.look(to(view));
        }
    }

    /// Has the camera node say so.
    pub(crate) fn look(&mut self, view: View) {
        if self.take_free_view(view) {
            return;
        }
        let Some(camera) = self.camera() else { return };
        let name = camera.name.clone();
        // What stays as it is, stated or not, needs not be written.
        let before = View::from_camera(camera).map(|before| before.settings()).unwrap_or_default();
        let other = view.settings().into_iter().filter(|setting| !before.contains(setting));
        let mut edits: Vec<Edit> = other.map(|(key, datum)| Edit::set(&name, [key], datum)).collect();
        // A view in words, and its angles, are numbers from then on.
        let in_words = VIEW_PARAMETERS.into_iter().filter(|name| camera.setting(name).is_some());
        edits.extend(in_words.map(|key| Edit::Unset { node: name.clone(), path: [key].into() }));
        if !edits.is_empty() {
            self.edit(format!("move the camera '{name}'"), &edits);
        }
    }

    pub(crate) fn command(&mut self, ctx: &Context, command: Command) {
        match command {
            // The menus mean what the keys do: the widget, where one was selected last.
            Command::Delete | Command::Duplicate if self.panels.transfer.is_last() => {
                self.panels.transfer.asked = Some(command);
                ctx.request_repaint();
            }
            Command::Cut if self.panels.transfer.is_last() => {
                self.say("a widget is not cut: Delete takes it away; to cut a node, select it first");
            }
            Command::New => self.unless_unsaved(ctx, Next::Take(Box::default())),
            Command::Example => {
                let text = self.registry.find("wavelet").map(|node| node.example.to_string());
                if let Some(text) = self.check(text) {
                    let document = Document::from_text(text, None);
                    self.unless_unsaved(ctx, Next::Take(Box::new(document)));
                }
            }
            Command::Open => self.unless_unsaved(ctx, Next::Choose(FilePurpose::Open)),
            Command::Quit => self.unless_unsaved(ctx, Next::Quit),
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
                if !self.selection.is_empty() {
                    let removal = Edit::RemoveNodes(self.selected());
                    let mut edits = wires_past(&self.scene(), &self.selected());
                    edits.push(removal.clone());
                    self.edit(removal.label(), &edits);
                }
            }
            Command::SelectAll => {
                self.select(self.document.pipeline().nodes.iter().map(|node| node.name.clone()).collect());
            }
            Command::Add => self.panels.graph.opens_menu = true,
            Command::Wire => match self.selection.first() {
                Some(node) if self.selection.len() == 1 => self.panels.graph.wires_of = Some(node.clone()),
                _ => self.say("select one node, whose wires are to be listed"),
            },
            Command::Edit => match self.selection.len() {
                1 => self.panels.parameters.begins = true,
                _ => self.say("select one node, whose parameters are to be edited"),
            },
            Command::Step(x, y) => self.choose_beside([x, y].map(f32::from)),
            Command::Shift(x, y) => self.shift([x, y].map(f64::from)),
            Command::Tidy | Command::Align(_) | Command::Frame | Command::Note => self.arrange_nodes(command),
            Command::Fold => self.fold(),
            Command::Eye => self.toggle_eyes(&self.selection.clone()),
            Command::FitGraph => self.panels.graph.fit(),
            Command::Home => {
                let bounds = self.worker.shown(|shown| shown.bounds);
                let size = self.camera().and_then(size_of).unwrap_or([4, 3]);
                if let Some(bounds) = bounds {
                    self.move_camera(|view| view.home(bounds, size));
                }
            }
            Command::Along(axis, from_positive) => {
                let towards = DVec3::AXES[axis.min(2)] * if from_positive { 1.0 } else { -1.0 };
                let up = if axis == 2 { DVec3::Y } else { DVec3::Z };
                self.move_camera(|view| view.looking_along(towards, up));
            }
            Command::Isometric => self.move_camera(|view| view.looking_along(DVec3::ONE, DVec3::Z)),
            Command::Roll(left) => {
                self.move_camera(|view| view.rolled((if left { -15f64 } else { 15.0 }).to_radians()));
            }
            Command::Theme => {
                let dark = ctx.global_style().visuals.dark_mode;
                ctx.set_theme(if dark { ThemePreference::Light } else { ThemePreference::Dark });
            }
            Command::Zoom(0) => ctx.set_zoom_factor(1.0),
            Command::Zoom(by) if by > 0 => gui_zoom::zoom_in(ctx),
            Command::Zoom(_) => gui_zoom::zoom_out(ctx),
            Command::Costs => self.panels.costs = !self.panels.costs,
            Command::Widgets => self.panels.transfer.switch_keys(),
            Command::Section => self.panels.section.open = !self.panels.section.open,
            Command::Time(to) => self.move_time(to),
            Command::Film => self.panels.time.film.is_open = true,
            Command::Strip => self.panels.time.is_open = !self.panels.time.is_open,
            Command::Study => self.panels.study.open = !self.panels.study.open,
            Command::ReadAgain => {
                self.read_again();
                self.say_what_is_missing();
            }
            Command::Help => self.panels.help = !self.panels.help,
        }
    }

    /// Starts a full run of the document as it is shown, like `voltet run`, which writes files, beside the session of the shown
    /// picture; cancels the one in progress.
    fn run(&mut self, ctx: &Context) {
        if self.run.take().is_some() {
            self.say("the run is stopped; no file is half written");
            return;
        }
        let graph = self.document.pipeline().graph(&self.registry, self.document.folder());
        // Pictures carry the text with its comments.
        let stated = Pipeline::stated(self.document.text().to_string(), &self.registry);
        let started = graph.and_then(|mut graph| {
            graph.stated = stated?;
            Job::start("run", ctx, move |observer| voltet_nodes::session().run(&graph, observer))
        });
        if let Some(run) = self.check_of(started, Some(Command::Run)) {
            self.run = Some(run);
            self.say("running; Ctrl+R stops it");
        }
    }

    pub(crate) fn show_run(&mut self) {
        let Some(outcome) = self.run.as_ref().and_then(Job::result) else { return };
        self.run = None;
        let Some(report) = self.check_of(outcome, Some(Command::Run)) else { return };
        let folder = self.document.folder();
        let name = |file: &String| relative_to(Path::new(file), &folder).display().to_string();
        let files = if report.files.is_empty() {
            "no files".into()
        } else {
            report.files.iter().map(name).collect::<Vec<_>>().join(", ")
        };
        self.say(format!("written in {}: {files}", milliseconds(report.seconds)));
    }

    fn step(&mut self, back: bool) {
        let history = self.document.history();
        let (label, verb, none) = match back {
            true => (history.undo_label(), "undone", "nothing to undo"),
            false => (history.redo_label(), "redone", "nothing to redo"),
        };
        let text = label.map_or(none.into(), |label| format!("{verb}: {label}"));
        let _ = if back { self.document.undo() } else { self.document.redo() };
        self.say(text);
    }

    pub(crate) fn copy(&self, ctx: &Context) {
        if !self.selection.is_empty() {
            ctx.copy_text(self.document.copy(&self.selected()));
        }
    }

    pub(crate) fn duplicate(&mut self) {
        if !self.selection.is_empty() {
            let outcome = self.document.duplicate(&self.selected());
            self.take_copies(outcome);
        }
    }

    /// Takes what the clipboard gives, unless a text field does.
    pub(crate) fn paste(&mut self, ctx: &Context) {
        if ctx.text_edit_focused() || self.asks() {
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

    fn take_copies(&mut self, outcome: Result<Vec<String>>) {
        if let Some(names) = self.check(outcome) {
            self.show_new(names.into_iter().collect());
        }
    }

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

    fn toggle_eyes(&mut self, names: &BTreeSet<String>) {
        match &eyes::toggled(&self.document, &self.registry, names)[..] {
            [] => self
                .say("surfaces, annotations and clips can be taken out of the picture: select their nodes"),
            [one] => self.edit_one(one.clone()),
            edits => {
                let is_out = edits.iter().any(|edit| matches!(edit, Edit::Hide { hidden: true, .. }));
                let nodes = counted(edits.len(), "node");
                let label = match is_out {
                    true => format!("take {nodes} out of the picture"),
                    false => format!("bring {nodes} back into the picture"),
                };
                self.edit(label, edits);
            }
        }
    }

    pub(crate) fn arrange_nodes(&mut self, command: Command) {
        let all = &self.document.pipeline().nodes;
        let nodes: Vec<NodeEntry> = if self.selection.is_empty() {
            all.clone()
        } else {
            all.iter().filter(|node| self.selection.contains(&node.name)).cloned().collect()
        };
        let placed = |node: &NodeEntry| PlacedNode {
            name: node.name.clone(),
            position: self.document.position(&node.name),
            size: self.panels.graph.size_of(&node.name),
        };
        let placed: Vec<PlacedNode> = nodes.iter().map(placed).collect();
        let least = |axis: usize| placed.iter().map(|node| node.position[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| {
            placed.iter().map(|node| node.position[axis] + node.size[axis]).fold(f64::NEG_INFINITY, f64::max)
        };
        let (label, edit) = match command {
            Command::Tidy if !nodes.is_empty() => {
                let places = tidy(&nodes, &|name| self.panels.graph.size_of(name));
                let moved = nodes.iter().zip(places);
                let moved = moved.map(|(node, [x, y])| (node.name.clone(), [x + least(0), y + least(1)]));
                ("tidy", Edit::MoveNodes(moved.collect()))
            }
            Command::Align(how) if nodes.len() > 1 => ("align", Edit::MoveNodes(align(&placed, how))),
            Command::Frame if !self.selection.is_empty() => {
                let at = [least(0) - 20.0, least(1) - 36.0];
                let size = [most(0) + 20.0 - at[0], most(1) + 20.0 - at[1]];
                let count = self.document.view().frames.len();
                let frame = Annotation { text: "frame".into(), position: at, size: Some(size), color: None };
                ("add a frame", Edit::Annotate(AnnotationId::Frame(count), frame))
            }
            Command::Note => {
                let count = self.document.view().notes.len();
                let at = if nodes.is_empty() { [0.0, 0.0] } else { [least(0), most(1) + 30.0] };
                let note = Annotation { text: "a note".into(), position: at, ..Annotation::default() };
                ("add a note", Edit::Annotate(AnnotationId::Note(count), note))
            }
            _ => return,
        };
        self.edit(label.into(), std::slice::from_ref(&edit));
        match &edit {
            Edit::Annotate(id, thing) => self.panels.graph.write_on(*id, &thing.text),
            _ if command == Command::Tidy => self.panels.graph.fit(),
            _ => {}
        }
    }

    /// Opens a pipeline file, or makes a pipeline for another file, on a thread of its own. A file that cannot be opened leads to the dialog.
    pub(crate) fn open_any(&mut self, ctx: &Context, path: &Path) {
        self.open_by(ctx, path, FileDialog::new(FilePurpose::Open, Some(path)));
    }

    /// [Opens](Self::open_any) a file that was chosen by a dialog.
    fn open_by(&mut self, ctx: &Context, path: &Path, dialog: FileDialog) {
        if is_pipeline(path) {
            match self.check(Document::open(path)) {
                Some(document) => {
                    self.recent.add(path);
                    self.take(document);
                }
                None => self.ask_again(dialog),
            }
            return;
        }
        let start = self.start.clone();
        self.make(ctx, path, dialog, move |file, at, progress| {
            Ok(Document::from_text(start(file, at, progress)?, Some(at.to_path_buf())))
        });
    }

    /// Saves the document in its own file, or asks for one; and asks where another program wrote it meanwhile.
    pub(crate) fn save(&mut self) {
        let Some(path) = self.document.path().map(Path::to_path_buf) else {
            self.file_dialog = Some(FileDialog::new(FilePurpose::SaveAs, None));
            return;
        };
        if self.document.changed_on_disk() {
            self.disk.is_changed = true;
            return;
        }
        self.save_as(&path);
    }

    pub(crate) fn settle_with_disk(&mut self, takes_over: bool) {
        let outcome = if takes_over { self.document.reload() } else { self.document.save_over() };
        self.disk = Disk::default();
        self.new_readers.clear();
        self.check_of(outcome, (!takes_over).then_some(Command::Save));
    }

    pub(crate) fn save_as(&mut self, path: &Path) {
        let mut path = path.to_path_buf();
        if path.extension().is_none() {
            path.set_extension("toml");
        }
        let again = if self.document.path() == Some(&*path) { Command::Save } else { Command::SaveAs };
        if self.check_of(refuse_unwritable(&path), Some(again)).is_none() {
            return;
        }
        let follow = self.document.following_to(&self.registry, folder(&path));
        let paths = match follow.len() {
            0 => String::new(),
            1 => "; a path in it leads to the same file from there".into(),
            count => format!("; {count} paths in it lead to the same files from there"),
        };
        if !follow.is_empty() {
            self.edit("paths that lead from the new folder".into(), &follow);
        }
        let outcome = self.document.save_as(&path);
        if self.check_of(outcome, Some(again)).is_some() {
            // What is kept from now on is of this file.
            self.recover.forget();
            self.recent.add(&path);
            self.say(format!("saved: {}{paths}", path.display()));
        }
    }

    /// Carries out what takes the document away, or asks first.
    pub(crate) fn unless_unsaved(&mut self, ctx: &Context, next: Next) {
        if self.document.is_saved() { self.go_on(ctx, next) } else { self.unsaved = Some(next) }
    }

    pub(crate) fn go_on(&mut self, ctx: &Context, next: Next) {
        match next {
            Next::Take(document) => self.take(*document),
            Next::Open(path) => self.open_any(ctx, &path),
            Next::Choose(purpose) => {
                let data = self.data_file().filter(|_| matches!(purpose, FilePurpose::Data(_)));
                let at = data.or_else(|| self.document.path().map(Path::to_path_buf));
                self.file_dialog = Some(FileDialog::new(purpose, at.as_deref()));
            }
            Next::Recover => self.recover(ctx),
            Next::Quit => self.ends = true,
        }
    }

    /// Another document in place of this one.
    pub(crate) fn take(&mut self, document: Document) {
        self.document = document;
        self.new_readers.clear();
        self.pending_rescale = None;
        (self.run, self.made, self.large) = (None, None, None);
        self.recover.forget();
        self.begin();
        (self.disk, self.arrays) = (Disk::default(), Arrays::default());
        (self.shown_node, self.chosen_pictures) = (None, Vec::new());
        self.forget_answers();
        // Revisions count from the beginning of each document.
        self.faults = (None, Vec::new());
        self.message = None;
        // Which windows are open is the user's; what they show was the other document's.
        let Panels { section, study, time, panes, costs, help, .. } = std::mem::take(&mut self.panels);
        self.panels = Panels {
            section: section.emptied(),
            study: study.emptied(),
            time: time.emptied(),
            panes,
            costs,
            help,
            ..Panels::default()
        };
    }
}
