//! The editor: a document, a worker, what is selected and shown; one function a frame, which knows no window.

use crate::actions::{Action, Actions, Command};
use crate::files::{Asked, FileAsking, begun, free_path, is_pipeline};
use crate::graph::GraphView;
use crate::keys;
use crate::layout;
use crate::parameters::ParameterPanel;
use crate::picture::PicturePanel;
use crate::scene::{Scene, pictures};
use crate::transfer::{self, TransferPanel};
use crate::view::View;
use crate::worker::{Distribution, NodeState, Probed, Probing, Shown, Wanted, Worker, short};
use eframe::egui::{Context, Key, ThemePreference, Vec2, ViewportCommand};
use glam::DVec3;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use voltet_core::graph::{Datum, NodeEntry, Registry};
use voltet_core::{Error, Result};
use voltet_document::{Document, Edit, Gesture};

/// Makes the text of a pipeline for a file that is none, such as data; the second path is where it would be saved.
pub type Start = Arc<dyn Fn(&Path, &Path) -> Result<String> + Send + Sync>;

/// Edits by wheel and keys that follow one another within this time are one step.
const PAUSE: Duration = Duration::from_millis(600);

/// All that a window shows.
pub struct Editor {
    pub(crate) document: Document,
    pub(crate) registry: Registry,
    pub(crate) worker: Worker,
    start: Start,
    /// A pipeline that is being made.
    made: Option<Receiver<Result<Document>>>,
    selection: BTreeSet<String>,
    shown_node: Option<String>,
    pub(crate) graph: GraphView,
    pub(crate) picture: PicturePanel,
    pub(crate) parameters: ParameterPanel,
    pub(crate) transfer: TransferPanel,
    pub(crate) message: Option<(String, bool)>,
    pub(crate) help: bool,
    pub(crate) asking: Option<FileAsking>,
    /// What waits for an answer about unsaved work.
    pub(crate) unsaved: Option<Command>,
    asked: Option<Wanted>,
    /// The distribution that was asked for last.
    distribution: Option<Distribution>,
    /// The probe that is waited for, and whether it is for the centre of the picture.
    probing: Option<(u64, bool)>,
    last_probe: u64,
    probed: Option<Arc<Probed>>,
    faults: (Option<u64>, Vec<Error>),
    hand: Hand,
    /// What the edits of this frame belong to.
    gesture: Option<Gesture>,
    ends: bool,
}

/// Which edits belong together.
#[derive(Default)]
struct Hand {
    last: u64,
    pressed: Option<u64>,
    at: Option<(Instant, u64)>,
}

impl Hand {
    fn next(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// The gesture of an edit made now: a mouse button held, or what follows soon after by wheel or key.
    fn gesture(&mut self, ctx: &Context) -> Option<Gesture> {
        let (down, pressed, released, repeated) = ctx.input(|input| {
            let pointer = &input.pointer;
            let wheel = input.smooth_scroll_delta != Vec2::ZERO || input.zoom_delta() != 1.0;
            let arrows = [Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown];
            let nudged = arrows.iter().any(|key| input.keys_down.contains(key));
            (pointer.any_down(), pointer.any_pressed(), pointer.any_released(), wheel || nudged)
        });
        if pressed || (down && self.pressed.is_none()) {
            self.pressed = Some(self.next());
        }
        if down || released {
            return self.pressed.map(Gesture);
        }
        self.pressed = None;
        if !repeated {
            return None;
        }
        let now = Instant::now();
        let number = match self.at {
            Some((before, number)) if now - before < PAUSE => number,
            _ => self.next(),
        };
        self.at = Some((now, number));
        Some(Gesture(number))
    }
}

impl Editor {
    /// An editor of a document. `wake` has the window shown again, from any thread.
    pub fn new(
        document: Document,
        registry: &Registry,
        start: Start,
        wake: crate::worker::Wake,
    ) -> Result<Editor> {
        let mut own = Registry::new();
        registry.iter().try_for_each(|node| own.add(node))?;
        registry.filters().try_for_each(|filter| own.add_filter(filter.clone()))?;
        Ok(Editor {
            document,
            worker: Worker::start(&own, wake)?,
            registry: own,
            start,
            made: None,
            selection: BTreeSet::new(),
            shown_node: None,
            graph: GraphView::default(),
            picture: PicturePanel::default(),
            parameters: ParameterPanel::default(),
            transfer: TransferPanel::default(),
            message: None,
            help: false,
            asking: None,
            unsaved: None,
            asked: None,
            distribution: None,
            probing: None,
            last_probe: 0,
            probed: None,
            faults: (None, Vec::new()),
            hand: Hand::default(),
            gesture: None,
            ends: false,
        })
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The worker.
    pub fn worker(&self) -> &Worker {
        &self.worker
    }

    /// Whether the window is to close.
    pub fn ends(&self) -> bool {
        self.ends
    }

    /// Shows everything once and carries out what was asked for.
    pub fn frame(&mut self, ctx: &Context) {
        self.take_made();
        self.take_probed();
        self.settle_on_nodes();
        self.gesture = self.hand.gesture(ctx);
        if ctx.input(|input| input.viewport().close_requested()) && !self.ends {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.command(ctx, Command::Quit);
        }
        let mut actions = Actions::default();
        keys::read(ctx, &mut actions);
        layout::show(self, ctx, &mut actions);
        for action in actions.0 {
            self.carry_out(ctx, action);
        }
        self.paste(ctx);
        self.settle_on_nodes();
        self.draw();
        self.find_distribution();
    }

    /// Drops from the selection what is gone, and finds a picture to show where there is none.
    fn settle_on_nodes(&mut self) {
        let nodes = &self.document.pipeline().nodes;
        self.selection.retain(|name| nodes.iter().any(|node| node.name == *name));
        let pictures = pictures(&self.document, &self.registry);
        if !self.shown_node.as_deref().is_some_and(|shown| pictures.contains(&shown)) {
            self.shown_node = pictures.last().map(|name| name.to_string());
        }
        if self.faults.0 != Some(self.document.revision()) {
            self.faults = (Some(self.document.revision()), faults(&self.document, &self.registry));
        }
    }

    /// Asks the worker for the picture where another is wanted than before.
    fn draw(&mut self) {
        let Some(node) = self.shown_node.clone() else { return };
        let nodes = &self.document.pipeline().nodes;
        let size =
            self.camera().and_then(|camera| camera_size(camera)).map(|own| fitted(own, self.picture.room));
        let mut nodes = nodes.clone();
        if let Some((look, hidden)) = self.transfer.hidden() {
            leave_out(&mut nodes, look, hidden);
        }
        let wanted = Wanted {
            background: background(&nodes, &node),
            nodes,
            folder: self.document.folder(),
            node,
            size,
            coarse_first: true,
        };
        let same = |asked: &Wanted| {
            let feeding = |wanted: &Wanted| {
                let names = wanted.upstream();
                wanted.nodes.iter().filter(|node| names.contains(&node.name)).cloned().collect::<Vec<_>>()
            };
            (&asked.node, asked.size, asked.background, &asked.folder)
                == (&wanted.node, wanted.size, wanted.background, &wanted.folder)
                && feeding(asked) == feeding(&wanted)
        };
        if !self.asked.as_ref().is_some_and(same) {
            self.worker.draw(wanted.clone());
            self.asked = Some(wanted);
        }
    }

    /// Asks for the distribution of what the edited transfer function is drawn with, where another is wanted than before.
    fn find_distribution(&mut self) {
        let source = {
            let scene = self.scene();
            let look = transfer::of(&scene).map(|look| look.name.clone());
            look.and_then(|look| transfer::volume_of(&scene, &look))
        };
        let Some(source) = source else { return };
        let all = &self.document.pipeline().nodes;
        let (name, _) = voltet_document::links::source(&source, all);
        let feeding = crate::worker::upstream(all, name);
        let nodes: Vec<NodeEntry> = all.iter().filter(|node| feeding.contains(&node.name)).cloned().collect();
        let folder = self.document.folder();
        let same =
            |asked: &Distribution| asked.nodes == nodes && asked.node == source && asked.folder == folder;
        if !self.distribution.as_ref().is_some_and(same) {
            let key = self.distribution.as_ref().map_or(0, |asked| asked.key) + 1;
            let wanted = Distribution { nodes, folder, node: source, key };
            self.worker.find_distribution(wanted.clone());
            self.distribution = Some(wanted);
        }
    }

    /// Asks what lies at places of the picture.
    fn probe(&mut self, places: Vec<[f64; 2]>, centres: bool) {
        let sources = {
            let scene = self.scene();
            let look = transfer::of(&scene).map(|look| look.name.clone());
            look.and_then(|look| {
                Some([transfer::volume_of(&scene, &look)?, look, self.camera()?.name.clone()])
            })
        };
        let Some(sources) = sources else { return };
        self.last_probe += 1;
        let key = self.last_probe;
        self.probing = Some((key, centres));
        let nodes = self.document.pipeline().nodes.clone();
        self.worker.probe(Probing { nodes, folder: self.document.folder(), sources, places, key });
    }

    /// Takes over what a probe found: values in a line, or the centre.
    fn take_probed(&mut self) {
        let Some((key, centres)) = self.probing else { return };
        let found = self.worker.shown(|shown| shown.probed.as_ref().filter(|(of, _)| *of == key).cloned());
        match found {
            Some((_, Err(error))) => self.complain(&error),
            Some((_, Ok(found))) if centres => {
                if let (Some(point), Some(view)) = (found.point, self.camera().and_then(View::of)) {
                    self.look(view.centred(point));
                }
            }
            Some((_, Ok(found))) => {
                let text = match found.moments() {
                    Some([[s, g], [ds, dg]]) => format!(
                        "on the ray: s {} ± {}, g {} ± {}, opacity {}; \"+ at probe\" makes a widget of it",
                        short(s),
                        short(ds),
                        short(g),
                        short(dg),
                        short(found.opacity)
                    ),
                    None => "the ray meets no cell".into(),
                };
                self.message = Some((text, false));
                self.probed = Some(found);
            }
            None => return,
        }
        self.probing = None;
    }

    /// The camera node that the shown picture is seen from.
    fn camera(&self) -> Option<&NodeEntry> {
        let nodes = &self.document.pipeline().nodes;
        let feeding = crate::worker::upstream(nodes, self.shown_node.as_deref()?);
        nodes.iter().find(|node| node.node_type.text() == Some("camera") && feeding.contains(&node.name))
    }

    /// What the parts of the window look at.
    pub(crate) fn scene(&self) -> Scene<'_> {
        let camera = self.camera();
        let of_worker = self.worker.shown(|shown| {
            let engine = shown.report.as_ref().and_then(|report| report.engine.as_ref());
            let key = self.distribution.as_ref().map(|asked| asked.key);
            let found =
                shown.distribution.as_ref().filter(|(of, _)| Some(*of) == key).map(|(_, found)| found);
            (
                shown.pixels.clone().filter(|_| self.shown_node.is_some()),
                shown.nodes.clone(),
                shown.values.clone(),
                shown.failure.clone(),
                running(shown),
                shown.pixels.as_ref().and_then(|p| shown.seconds[usize::from(p.divisor != 1)]),
                engine.map(|engine| engine.0.clone()),
                found.and_then(|found| found.as_ref().ok().cloned()),
                found.and_then(|found| found.as_ref().err().map(Error::to_string)),
                shown.looks.clone(),
            )
        });
        let (
            pixels,
            nodes,
            values,
            failure,
            running,
            seconds,
            engine,
            distribution,
            distribution_fault,
            looks,
        ) = of_worker;
        Scene {
            document: &self.document,
            registry: &self.registry,
            selection: &self.selection,
            shown_node: self.shown_node.as_deref(),
            view: camera.and_then(View::of),
            picture_size: camera.and_then(camera_size),
            pixels,
            nodes,
            values,
            failure,
            running,
            seconds,
            engine,
            distribution,
            distribution_fault,
            looks,
            probed: self.probed.clone(),
            faults: &self.faults.1,
        }
    }

    fn carry_out(&mut self, ctx: &Context, action: Action) {
        match action {
            Action::Edit(label, edits) => self.edit(label, &edits),
            Action::Select(names) => self.selection = names,
            Action::Show(name) => self.shown_node = Some(name),
            Action::Look(view) => self.look(view),
            Action::Probe(places) => self.probe(places, false),
            Action::Centre(place) => self.probe(vec![place], true),
            Action::Do(command) => self.command(ctx, command),
            Action::Say(text) => self.message = Some((text, false)),
            Action::Open(path) => self.open_any(ctx, &path),
            Action::SaveAs(path) => self.save_as(&path),
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
    fn look(&mut self, view: View) {
        let Some(camera) = self.camera() else { return };
        let name = camera.name.clone();
        let stated = |key: &str| camera.settings.iter().find(|field| field.name == key);
        let settings = view.settings().into_iter();
        let changed = settings
            .filter(|(key, datum)| stated(key).is_none_or(|field| !same(&field.setting.datum, datum)));
        // A standard value that stays needs not be written.
        let standing = View::of(camera);
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
            Command::New | Command::Open | Command::Quit => self.unless_unsaved(command),
            Command::Save => self.save(),
            Command::SaveAs => self.asking = Some(FileAsking::new(Asked::SaveAs, self.document.path())),
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
            Command::Tidy | Command::Align | Command::Frame | Command::Note => self.arrange(command),
            Command::FitGraph => self.graph.fit(),
            Command::Home => {
                let bounds = self.worker.shown(|shown| shown.bounds);
                let size = self.camera().and_then(camera_size).unwrap_or([4, 3]);
                if let (Some(view), Some(bounds)) = (self.camera().and_then(View::of), bounds) {
                    self.look(view.home(bounds, f64::from(size[0]) / f64::from(size[1])));
                }
            }
            Command::Along(axis, from_positive) => {
                let Some(view) = self.camera().and_then(View::of) else { return };
                let towards = DVec3::AXES[axis.min(2)] * if from_positive { 1.0 } else { -1.0 };
                let up = if axis == 2 { DVec3::Y } else { DVec3::Z };
                self.look(view.along(towards, up));
            }
            Command::Roll(left) => {
                let Some(view) = self.camera().and_then(View::of) else { return };
                let angle = 15f64.to_radians();
                self.look(view.rolled(if left { -angle } else { angle }));
            }
            Command::Theme => {
                let dark = ctx.style().visuals.dark_mode;
                ctx.set_theme(if dark { ThemePreference::Light } else { ThemePreference::Dark });
            }
            Command::Help => self.help = !self.help,
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
    fn unless_unsaved(&mut self, command: Command) {
        match self.document.is_saved() {
            true => self.go_on(command),
            false => self.unsaved = Some(command),
        }
    }

    /// Carries it out.
    pub(crate) fn go_on(&mut self, command: Command) {
        match command {
            Command::New => self.take(Document::new()),
            Command::Open => self.asking = Some(FileAsking::new(Asked::Open, self.document.path())),
            _ => self.ends = true,
        }
    }

    /// Another document in place of this one.
    pub(crate) fn take(&mut self, document: Document) {
        self.document = document;
        self.selection.clear();
        self.shown_node = None;
        self.asked = None;
        self.message = None;
        self.graph = GraphView::default();
        self.transfer = TransferPanel::default();
    }

    /// Opens a pipeline file, or makes a pipeline for another file, on a thread of its own.
    pub(crate) fn open_any(&mut self, ctx: &Context, path: &Path) {
        if is_pipeline(path) {
            match Document::open(path) {
                Ok(document) => self.take(document),
                Err(error) => self.complain(&error),
            }
            return;
        }
        let at = free_path(path);
        let (start, path, ctx) = (self.start.clone(), path.to_path_buf(), ctx.clone());
        let (sender, made) = channel();
        let name = path.display().to_string();
        let spawned = std::thread::Builder::new().name("start".into()).spawn(move || {
            let text = start(&path, &at);
            // Nobody waits for it any more where the window was closed.
            let _ = sender.send(text.and_then(|text| begun(text, &at)));
            ctx.request_repaint();
        });
        match spawned {
            Ok(_) => {
                self.message = Some((format!("making a pipeline for {name} …"), false));
                self.made = Some(made);
            }
            Err(error) => self.complain(&Error::run("no thread can be had").found(error)),
        }
    }

    /// Takes over a pipeline that was made.
    fn take_made(&mut self) {
        let Some(made) = self.made.as_ref().and_then(|made| made.try_recv().ok()) else { return };
        self.made = None;
        match made {
            Ok(document) => self.take(document),
            Err(error) => self.complain(&error),
        }
    }

    pub(crate) fn selection(&self) -> &BTreeSet<String> {
        &self.selection
    }
}

/// Takes widgets out of a transfer function.
fn leave_out(nodes: &mut [NodeEntry], look: &str, hidden: &BTreeSet<usize>) {
    let node = nodes.iter_mut().find(|node| node.name == look);
    let field = node.and_then(|node| node.settings.iter_mut().find(|field| field.name == "widgets"));
    if let Some(Datum::List(list)) = field.map(|field| &mut field.setting.datum) {
        let mut place = 0;
        list.retain(|_| {
            place += 1;
            !hidden.contains(&(place - 1))
        });
    }
}

/// Whether two values are the same; 2 and 2.0 are.
fn same(a: &Datum, b: &Datum) -> bool {
    match (a, b) {
        (Datum::List(a), Datum::List(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(&a.datum, &b.datum))
        }
        (Datum::Integer(a), Datum::Number(b)) | (Datum::Number(b), Datum::Integer(a)) => *a as f64 == *b,
        _ => a == b,
    }
}

/// Width and height that a camera node states.
fn camera_size(camera: &NodeEntry) -> Option<[u32; 2]> {
    crate::worker::size_of(camera)
}

/// A picture of that shape with no more pixels than there is room for, and no more than it has.
fn fitted([width, height]: [u32; 2], room: [u32; 2]) -> [u32; 2] {
    let scale = (f64::from(room[0]) / f64::from(width)).min(f64::from(room[1]) / f64::from(height)).min(1.0);
    [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1))
}

/// The background that a writer puts behind the picture of a node.
fn background(nodes: &[NodeEntry], node: &str) -> [f64; 3] {
    let writes = |entry: &&NodeEntry| {
        entry.node_type.text() == Some("image-writer")
            && entry.inputs.iter().any(|link| {
                link.source.text().is_some_and(|text| text == node || text.split('.').next() == Some(node))
            })
    };
    let writer = nodes.iter().find(writes);
    let stated = writer.and_then(|writer| writer.settings.iter().find(|field| field.name == "background"));
    stated.and_then(|field| field.setting.numbers()?.try_into().ok()).unwrap_or([0.0; 3])
}

/// What runs, in words.
fn running(shown: &Shown) -> Option<String> {
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

/// What is wrong with the document as a whole.
fn faults(document: &Document, registry: &Registry) -> Vec<Error> {
    if document.pipeline().nodes.is_empty() {
        return Vec::new();
    }
    let graph = document.pipeline().graph(registry, document.folder());
    graph.err().into_iter().map(|error| document.locate(error)).collect()
}
