//! The editor: a document, a worker, what is selected and shown; and one frame: what happened meanwhile, the layout of the window's parts,
//! what is requested of the worker.

use crate::files::{BETWEEN, Disk, FileDialog, FileWatcher, Recent, Recover, ask, show_dialog};
use crate::focus::{self, SheetKeys};
use crate::graph::GraphView;
use crate::invitation::invite;
use crate::jobs::{Arrays, DataSource, Job};
use crate::keys::{self, GestureTracker};
use crate::opening::{LargeData, Making, show_making};
use crate::panes::Pane;
use crate::parameters::ParameterPanel;
use crate::picture::{self, PicturePanel};
use crate::plugins::Plugins;
use crate::rescale_edits::PendingRescale;
use crate::scene::{Actions, Command, FilePurpose, Lag, ProbePurpose, Scene, error_text, pictures};
use crate::section::SectionPanel;
use crate::study::{StudyPanel, show_costs};
use crate::templates::{Template, templates};
use crate::text_sheet::TextSheet;
use crate::theme::{self, Help};
use crate::threads;
use crate::time_strip::TimeStrip;
use crate::transfer::TransferPanel;
use crate::ways_out::{Message, buttons, ways_out};
use crate::worker::{
    Estimate, NodeState, PixelProbe, RenderRequest, VolumeSource, Worker, WorkerOutput, size_of,
};
use eframe::egui::{
    Align, CentralPanel, Context, Frame, Id, Label, Layout, Panel, Popup, RichText, Ui, ViewportCommand,
};
use glam::DVec3;
use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_document::{Document, Gesture};
use voltet_graph::{Registry, RunReport};

/// Makes the text of a pipeline for a file that is none, such as data; the second path is where it would be saved. It can be stopped.
pub type Start = Arc<dyn Fn(&Path, &Path, &dyn Progress) -> Result<String> + Send + Sync>;

/// The parts of the window, each with what a hand is doing in it.
#[derive(Default)]
pub(crate) struct Panels {
    pub graph: GraphView,
    pub picture: PicturePanel,
    pub parameters: ParameterPanel,
    pub transfer: TransferPanel,
    pub section: SectionPanel,
    pub study: StudyPanel,
    pub time: TimeStrip,
    pub text: TextSheet,
    /// Shares of what is at the right, the transfer function there, and the parameters.
    pub panes: [Pane; 3],
    pub costs: bool,
    pub help: bool,
}

/// Step that takes the document away.
pub(crate) enum Next {
    /// Another document in its place.
    Take(Box<Document>),
    Open(PathBuf),
    Choose(FilePurpose),
    /// Work that another window left behind.
    Recover,
    Quit,
}

/// Requests to the worker, and how far its answers are behind.
#[derive(Default)]
pub(crate) struct Answers {
    /// The picture that was asked for last, and its number.
    pub asked: Option<RenderRequest>,
    pub picture_number: u64,
    /// True if it is drawn with a widget that is proposed.
    pub proposes: bool,
    /// Use of a probe that is waited for.
    pub probing: Option<ProbePurpose>,
    /// Points of the length that is measured, at most two; world units.
    pub measured: Vec<DVec3>,
    /// Values that were probed, and the volume that they are of.
    pub probed: Option<(VolumeSource, Arc<PixelProbe>)>,
    pub picture_lag: Lag,
    pub section_lag: Lag,
}

/// All that a window shows.
pub struct Editor {
    pub(crate) document: Document,
    pub(crate) registry: Registry,
    pub(crate) worker: Worker,
    pub(crate) start: Start,
    /// Bytes that this process may still take, where the system tells.
    pub(crate) free_memory: fn() -> Option<u64>,
    pub(crate) templates: Vec<Template>,
    pub(crate) made: Option<Making>,
    pub(crate) large: Option<LargeData>,
    pub(crate) selection: BTreeSet<String>,
    pub(crate) shown_node: Option<String>,
    /// Nodes whose picture was chosen to be shown, the newest last; also those that are gone, which an undo or redo may bring back.
    pub(crate) chosen_pictures: Vec<String>,
    pub(crate) arrays: Arrays,
    /// Readers that were given a file in this window, and take its first array where none is named, with what they read.
    pub(crate) new_readers: BTreeMap<String, DataSource>,
    pub(crate) message: Option<Message>,
    pub(crate) recover: Recover,
    pub(crate) disk: Disk,
    pub(crate) watch: FileWatcher,
    pub(crate) file_dialog: Option<FileDialog>,
    pub(crate) recent: Recent,
    pub(crate) run: Option<Job<RunReport>>,
    /// Next step, once unsaved work is settled.
    pub(crate) unsaved: Option<Next>,
    pub(crate) answers: Answers,
    pub(crate) plugins: Plugins,
    pub(crate) panels: Panels,
    pub(crate) actions: Actions,
    pub(crate) faults: (Option<u64>, Vec<Error>),
    pub(crate) gestures: GestureTracker,
    pub(crate) gesture: Option<Gesture>,
    pub(crate) pending_rescale: Option<PendingRescale>,
    pub(crate) ends: bool,
    /// True if a text was typed in the last frame: Escape leaves it.
    pub(crate) was_typing: bool,
    pub(crate) sheet_keys: SheetKeys,
    /// Sheets, questions and menus that were open in the last frame.
    pub(crate) over: Vec<Id>,
}

impl Editor {
    /// An editor of a document. `wake` has the window shown again, from any thread.
    pub fn new(
        document: Document,
        registry: &Registry,
        start: Start,
        wake: crate::worker::RepaintCallback,
    ) -> Result<Editor> {
        threads::divided_work_gives_way();
        let wakes = wake.clone();
        let no_thread = |error| Error::run("no thread can be started to watch files").got(error);
        let watch = FileWatcher::start(BETWEEN, move || wakes()).map_err(no_thread)?;
        let mut editor = Editor {
            document,
            worker: Worker::start(registry, wake)?,
            registry: registry.clone(),
            templates: templates(registry),
            start,
            free_memory: voltet_io::memory::available,
            made: None,
            large: None,
            selection: BTreeSet::new(),
            shown_node: None,
            chosen_pictures: Vec::new(),
            arrays: Arrays::default(),
            new_readers: BTreeMap::new(),
            message: None,
            recover: Recover::default(),
            disk: Disk::default(),
            watch,
            file_dialog: None,
            recent: Recent::default(),
            run: None,
            unsaved: None,
            answers: Answers::default(),
            plugins: Plugins::default(),
            panels: Panels::default(),
            actions: Actions::default(),
            faults: (None, Vec::new()),
            gestures: GestureTracker::default(),
            gesture: None,
            pending_rescale: None,
            ends: false,
            was_typing: false,
            sheet_keys: SheetKeys::default(),
            over: Vec::new(),
        };
        editor.begin();
        Ok(editor)
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The worker.
    pub fn worker(&self) -> &Worker {
        &self.worker
    }

    /// True if the window is to close.
    pub fn ends(&self) -> bool {
        self.ends
    }

    /// Lays out the document; the transfer function is what is worked on first.
    pub(crate) fn begin(&mut self) {
        let nodes = &self.document.pipeline().nodes;
        let look = nodes.iter().find(|node| node.node_type.text() == Some("transfer-function"));
        self.selection = look.iter().map(|node| node.name.clone()).collect();
        let registry = &self.registry;
        self.document.lay_out(&|entry| crate::graph::usual_size(registry.node_type(entry)));
    }

    /// Drops from the selection what is gone, and finds a picture to show where there is none.
    pub(crate) fn settle_on_nodes(&mut self) {
        let nodes = &self.document.pipeline().nodes;
        self.selection.retain(|name| nodes.iter().any(|node| node.name == *name));
        self.settle_on_picture();
        if self.faults.0 != Some(self.document.revision()) {
            self.faults = (Some(self.document.revision()), faults(&self.document, &self.registry));
        }
        if self.answers.probed.as_ref().is_some_and(|(source, _)| !self.is_current(source)) {
            self.answers.probed = None;
        }
    }

    pub(crate) fn scene(&self) -> Scene<'_> {
        let (camera, view) = (self.camera(), self.view());
        self.worker.shown(|shown| {
            let distribution = shown.distribution.answer();
            let is_newest =
                shown.share.asked().is_some_and(|asked| asked.picture == self.answers.picture_number);
            let previews = shown.previews.iter();
            let preview = |(node, preview): (&String, &crate::worker::Preview)| {
                Some((node.clone(), preview.last()?.as_ref().ok()?.clone()))
            };
            let pixels = shown.pixels.clone().filter(|pixels| self.shown_node.as_ref() == Some(&pixels.node));
            let is_late = self.answers.picture_lag.is_long;
            let failure = shown.failure.clone().filter(|_| !is_late);
            let all = LazyCell::new(|| self.nodes_of_frame());
            let is_earlier = |node: &&str| match self.shown_node.as_deref() == Some(*node) {
                true => pixels.as_ref().is_some_and(|pixels| {
                    pixels.number != self.answers.picture_number && (is_late || failure.is_some())
                }),
                false => shown.previews.get(*node).is_some_and(|preview| {
                    let wanted = || self.request_of(&all, node, None, false);
                    preview.last().is_some()
                        && (preview.answer().is_none()
                            || preview.asked().is_some_and(|asked| asked.0 != wanted()))
                }),
            };
            let earlier = pictures(&self.document, &self.registry).into_iter().filter(is_earlier).collect();
            Scene {
                actions: &self.actions,
                document: &self.document,
                registry: &self.registry,
                arrays: &self.arrays,
                templates: &self.templates,
                selection: &self.selection,
                shown_node: self.shown_node.as_deref(),
                view,
                picture_size: camera.and_then(size_of),
                seconds: pixels.as_ref().and_then(|pixels| shown.seconds[usize::from(!pixels.is_full())]),
                pixels,
                earlier,
                previews: previews.filter_map(preview).collect(),
                asks: self.asks() || self.file_dialog.is_some(),
                was_typing: self.was_typing,
                nodes: shown.nodes.clone(),
                values: shown.values.clone(),
                bounds: shown.output_bounds.clone(),
                failure,
                running: running(shown),
                distribution: distribution.and_then(|found| found.as_ref().ok().cloned()),
                distribution_progress: shown
                    .distribution
                    .progress()
                    .map(|(stage, fraction)| (stage.to_string(), fraction)),
                distribution_fault: distribution.and_then(|found| found.as_ref().err().cloned()),
                probed: self.answers.probed.as_ref().map(|(_, found)| found.clone()),
                hovered: shown.hover.answer().and_then(|found| found.as_ref().ok()?.hit.clone()),
                hovered_in: shown.hover.asked().map(|asked| asked.source.output.clone()),
                proposes: self.answers.proposes,
                measured: &self.answers.measured,
                share: shown.share.answer().filter(|_| is_newest).cloned(),
                section: shown.section.last().cloned(),
                is_section_earlier: self.answers.section_lag.is_long,
                report: shown.report.clone(),
                estimate: shown.estimate.answer().cloned(),
                is_estimating: shown.estimate.is_waiting(),
                faults: &self.faults.1,
                entries: self.document.pipeline().nodes.iter().map(|n| (n.name.as_str(), n)).collect(),
            }
        })
    }

    pub(crate) fn estimate(&self) {
        if let Some(asked) = self.answers.asked.clone() {
            // One that came to nothing is made once more.
            self.worker.forget_query(|output| &mut output.estimate);
            self.worker.ask(|output| &mut output.estimate, Estimate(asked));
        }
    }
}

fn running(shown: &WorkerOutput) -> Option<String> {
    if !shown.is_busy {
        return None;
    }
    let in_hand = shown.nodes.iter().find_map(|(name, status)| match &status.state {
        NodeState::Running(stage, _) if stage.is_empty() => Some(format!("{name} …")),
        NodeState::Running(stage, fraction) => Some(format!("{name}: {stage} {:.0} %", 100.0 * fraction)),
        _ => None,
    });
    Some(in_hand.unwrap_or_else(|| "drawing …".into()))
}

/// Faults of a document; of a text that is no TOML the first alone, of which the others are consequences.
fn faults(document: &Document, registry: &Registry) -> Vec<Error> {
    if document.pipeline().nodes.is_empty() && document.is_toml() {
        return Vec::new();
    }
    let named = |fault: voltet_document::Diagnostic| match fault.node {
        Some(node) => fault.error.at_node(node),
        None => fault.error,
    };
    let count = if document.is_toml() { usize::MAX } else { 1 };
    document.faults(registry).into_iter().map(named).take(count).collect()
}

impl Editor {
    /// Shows everything once, in the whole window, and carries out what was asked for.
    pub fn frame(&mut self, ui: &mut Ui) {
        let ctx = &ui.ctx().clone();
        self.look_at_disk();
        self.take_made(ctx);
        self.take_plugin();
        self.take_probed();
        self.panels.study.take_found();
        self.show_run();
        self.name_arrays(ctx);
        self.rescale_widgets();
        self.settle_on_nodes();
        self.follow_answers(ctx);
        self.follow_time(ctx);
        self.gesture = self.gestures.gesture(ctx);
        if ctx.input(|input| input.viewport().close_requested()) && !self.ends {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.command(ctx, Command::Quit);
        }
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.take_dropped(&dropped.iter().map(|file| file.path().to_path_buf()).collect::<Vec<_>>());
        }
        self.close_uppermost(ctx);
        self.follow_focus(ctx);
        let transfer = &self.panels.transfer;
        let of_widgets = [transfer.takes_keys(), transfer.is_last()];
        // A question has the keys for itself.
        let is_held = !self.panels.graph.has_focus() && ctx.egui_wants_keyboard_input();
        self.panels.transfer.has_arrows = !is_held;
        // So has a menu or a list that is open.
        if !self.asks() && !Popup::is_any_open(ctx) {
            keys::read(ctx, of_widgets, is_held, &self.actions);
        }
        show(self, ui);
        if !self.panels.graph.has_focus() {
            focus::ring(ctx);
        }
        self.was_typing = ctx.text_edit_focused();
        for action in self.actions.take() {
            self.apply(ctx, action);
        }
        self.paste(ctx);
        self.keep(ctx);
        self.settle_on_nodes();
        if self.panels.picture.room == [0; 2] {
            // Nothing was shown yet; how large the picture is follows from the next frame.
            if !self.document.pipeline().nodes.is_empty() {
                ctx.request_repaint();
            }
            return;
        }
        self.wish();
    }

    /// True if a question waits for its answer.
    pub(crate) fn asks(&self) -> bool {
        self.unsaved.is_some() || self.large.is_some() || self.offers_plugin()
    }
}

fn show(editor: &mut Editor, ui: &mut Ui) {
    let ctx = &ui.ctx().clone();
    let offers_plugin = editor.offers_plugin();
    changed_on_disk(editor, ui);
    editor.offer_left_behind(ui);
    // The panels change; everything else is looked at.
    let mut panels = std::mem::take(&mut editor.panels);
    {
        let scene = editor.scene();
        Panel::top("menus").show(ui, |ui| keys::bar(ui, &scene));
        Panel::bottom("status").show(ui, |ui| status(ui, editor, &scene, &panels));
        if scene.is_empty() {
            empty(editor, ui, &mut panels.graph, &scene);
        } else {
            parts(ui, &scene, &mut panels);
        }
        show_costs(ctx, &mut panels.costs, &scene);
        panels.section.show(ctx, &scene);
        panels.study.show(ctx, &scene);
        panels.time.show_film(ctx, &scene);
        panels.text.show(ctx, &scene);
    }
    keys::sheet(ctx, &mut panels.help);
    editor.panels = panels;
    if let Some((dialog, path)) = show_dialog(&mut editor.file_dialog, ctx) {
        editor.chosen(ctx, dialog, &path);
    }
    unsaved(editor, ctx);
    // Files that are chosen meanwhile are another question.
    if editor.unsaved.is_none() && editor.file_dialog.is_none() {
        editor.offer_large_data(ctx);
    }
    // A key that answers another question in this frame is not for this one.
    if offers_plugin && editor.offers_plugin() {
        editor.offer_plugin(ctx);
    }
}

fn empty(editor: &Editor, ui: &mut Ui, graph: &mut GraphView, scene: &Scene) {
    let ground = Frame::NONE.fill(theme::ground(ui.visuals().dark_mode));
    CentralPanel::default().frame(ground).show(ui, |ui| {
        let place = ui.max_rect();
        graph.show(ui, scene, &|_| None);
        let recent: Vec<&Path> = editor.recent.paths().collect();
        invite(ui, scene, place, &recent, editor.made.is_some());
    });
}

/// The graph and the parameters at the left, the picture and the transfer function at the right.
fn parts(ui: &mut Ui, scene: &Scene, panels: &mut Panels) {
    let ctx = &ui.ctx().clone();
    let width = ui.available_width();
    let [right, transfer, parameters] = &mut panels.panes;
    right.fit(ctx, "right", width);
    let shown = Panel::right("right")
        .resizable(true)
        .default_size(right.share_or(0.5) * width)
        .size_range(280f32.min(0.5 * width)..=0.75 * width)
        .show(ui, |ui| {
            if panels.transfer.is_wanted(scene) {
                let height = ui.available_height();
                transfer.fit(ctx, "transfer", height);
                let shown = Panel::bottom("transfer")
                    .resizable(true)
                    .default_size(transfer.share_or(0.42) * height)
                    .size_range(140f32.min(0.4 * height)..=0.75 * height)
                    .frame(Frame::NONE)
                    .show(ui, |ui| panels.transfer.show(ui, scene));
                transfer.keep(ctx, shown.response.rect.height(), height);
            } else {
                panels.transfer.lose_keys();
            }
            if panels.time.is_wanted(scene) {
                Panel::bottom("time").show(ui, |ui| panels.time.show(ui, scene));
            }
            panels.picture.show(ui, scene);
        });
    right.keep(ctx, shown.response.rect.width(), width);
    // A border of the panes at the left ends with them, however wide what they show is.
    ui.shrink_clip_rect(ui.available_rect_before_wrap());
    let height = ui.available_height();
    parameters.fit(ctx, "parameters", height);
    let shown = Panel::bottom("parameters")
        .resizable(true)
        .default_size(parameters.share_or(0.42) * height)
        .size_range(80f32.min(0.4 * height)..=0.75 * height)
        .show(ui, |ui| panels.parameters.show(ui, scene));
    parameters.keep(ctx, shown.response.rect.height(), height);
    panels.parameters.has_focus = focus::is_within(ctx, shown.response.rect);
    let ground = Frame::NONE.fill(theme::ground(ui.visuals().dark_mode));
    CentralPanel::default().frame(ground).show(ui, |ui| {
        let place = ui.max_rect();
        panels.graph.show(ui, scene, &|node| panels.picture.texture_of(scene, node));
        if !scene.document.is_toml() {
            panels.text.offer(ui, place, scene);
        }
    });
}

fn status(ui: &mut Ui, editor: &Editor, scene: &Scene, panels: &Panels) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            picture::status(ui, scene);
            if let Some(text) = panels.time.film.progress() {
                ui.label(RichText::new(text).color(theme::weak(dark)));
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let making = editor.made.as_ref().map(|made| show_making(made, ui));
                // The parameters of the selected node say what is wrong with it.
                let is_said = |fault: &&Error| {
                    let node = fault.location.node.as_ref();
                    scene.selection.len() == 1 && scene.selection.first() == node
                };
                let fault = scene.faults.iter().find(|fault| !is_said(fault));
                // Of a text that is no TOML the graph says it.
                let fault = fault.filter(|_| scene.document.is_toml());
                let said = match (&editor.message, fault) {
                    (Some(said), _) => {
                        let color = if said.error.is_some() { theme::wrong(dark) } else { theme::weak(dark) };
                        Some((said.text.clone(), color, said.ways_out(scene)))
                    }
                    (None, Some(fault)) => {
                        let text = error_text(fault, scene.document);
                        Some((text, theme::wrong(dark), ways_out(scene, fault)))
                    }
                    (None, None) => None,
                };
                let held = keys::held_over(ui.ctx());
                let held = held
                    .map(|name| (format!("drop {name} here to take it up"), theme::accent(dark), Vec::new()));
                if let Some((text, color, ways)) = held.or(said) {
                    // Before the words, which are cut where there is no room.
                    buttons(ui, scene, &ways);
                    let label = Label::new(RichText::new(&text).color(color)).truncate();
                    ui.add(label).help(making.map_or(text.clone(), |path| format!("{text}\n{path}")));
                } else {
                    ui.label(RichText::new("F1: keys and mouse").color(theme::weak(dark)));
                }
            });
        });
    });
}

fn changed_on_disk(editor: &mut Editor, ui: &mut Ui) {
    if !editor.disk.is_changed {
        return;
    }
    let mut answer = None;
    Panel::top("changed").show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label("Another program changed the file.");
            for (text, help, takes_over) in [
                ("Reload", "can be undone", true),
                ("Overwrite", "with the document that is shown here", false),
            ] {
                if ui.button(text).help(help).clicked() {
                    answer = Some(takes_over);
                }
            }
        });
    });
    if let Some(takes_over) = answer {
        editor.settle_with_disk(takes_over);
    }
}

fn unsaved(editor: &mut Editor, ctx: &Context) {
    let Some(next) = editor.unsaved.take() else { return };
    let name = editor.document().path().map_or("The new pipeline".into(), |path| path.display().to_string());
    let text = format!("{name} has changes that are not saved.");
    let answers = [("Save", Some(true)), ("Discard", Some(false)), ("Cancel", None)];
    let answer = match ask(ctx, "Unsaved work", text, &answers) {
        None => return editor.unsaved = Some(next),
        Some(answer) => answer,
    };
    let Some(saves) = answer else { return };
    if saves {
        editor.save();
    }
    if !saves || editor.document().is_saved() {
        editor.go_on(ctx, next);
    }
}
