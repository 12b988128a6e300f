//! Strip below the picture: the time steps of the readers that feed it, the way of its camera with its keys, and films of both.
//!
//! A *frame* is a step of the series, or a place on the camera's way where there is no series. While a hand drags the slider, or the
//! strip plays, the worker draws other frames than the document states; the document is edited once, at the end.

use crate::film::FilmPanel;
use crate::jobs::Job;
use crate::scene::{Command, Scene, TimeMove, camera_of, error_text};
use crate::theme::{self, Help, button};
use crate::view::View;
use crate::ways_out::{buttons, ways_out};
use eframe::egui::{
    Context, DragValue, Label, Rect, RichText, Sense, Slider, Stroke, Ui, WidgetInfo, WidgetType, pos2, vec2,
};
use std::path::PathBuf;
use std::time::Instant;
use voltet_core::Error;
use voltet_core::arithmetic::decimal;
use voltet_document::{Change, Edit, Path, Series, series};
use voltet_graph::{LocatedValue, NodeEntry, ParameterValue};
use voltet_nodes::VIEW_PARAMETERS;

/// Frames of a camera's way where there is no series, at first, and at most.
const LENGTH: usize = 101;
const MAX_LENGTH: usize = 10_000;

/// Width of a tick for a key, points.
const TICK: f32 = 10.0;

/// Readers of a picture, without the step that they name, and the folder of their paths: what its series follows from.
pub(crate) type Readers = (Vec<NodeEntry>, PathBuf);

#[derive(Default)]
pub(crate) struct TimeStrip {
    /// True if it is shown where there is nothing but a camera, whose way may begin here.
    pub is_open: bool,
    pub film: FilmPanel,
    pub readers: Readers,
    pub series: Series,
    pub fault: Option<Error>,
    pub found: Option<Job<Series>>,
    /// Frame in place of the one that the document states.
    pub moved: Option<usize>,
    /// True while a hand drags the slider.
    pub is_dragged: bool,
    /// Time of the last step while it plays.
    pub playing: Option<Instant>,
    /// Time since which it waits for the histogram of the frame that is shown; time until which that may be of an earlier one.
    pub counting: Option<Instant>,
    pub lags_until: Option<Instant>,
    /// Frame and number of frames of a way without a series.
    at: usize,
    length: Option<usize>,
    /// Frame of the last request.
    pub requested: usize,
    /// True if the whole picture of the frame that is shown is there.
    pub is_drawn: bool,
    /// Revision of the document for which the series was looked for.
    pub revision: u64,
    /// View of a camera whose way is by keys, until it becomes one of them; the camera as it was then.
    pub free: Option<(NodeEntry, View)>,
    /// The last such view that was left for the camera's way, and the camera's name: it can be had again.
    left: Option<(String, View)>,
}

impl TimeStrip {
    /// The strip of another document.
    pub fn emptied(self) -> TimeStrip {
        TimeStrip { is_open: self.is_open, film: self.film.emptied(), ..TimeStrip::default() }
    }

    /// True if the step is the strip's own, as a view is: where some readers stay at the step that the file states, a step that the file
    /// stated of the others would make all of them one series.
    pub fn keeps_step(&self) -> bool {
        self.series.has_fixed
    }

    /// Number of frames; 0 where nothing moves and the strip is not asked for.
    pub fn count(&self, camera: Option<&NodeEntry>) -> usize {
        match self.series.is_none() {
            false => self.series.count(),
            true if camera.is_some() && (self.moves(camera) || self.is_open || self.film.is_open) => {
                self.length.unwrap_or(LENGTH)
            }
            true => 0,
        }
    }

    /// True if its frames differ.
    pub fn moves(&self, camera: Option<&NodeEntry>) -> bool {
        !self.series.is_none() || camera.is_some_and(|camera| phase(camera, 0, 2).is_some())
    }

    /// True if it has something to move or to say.
    pub fn is_wanted(&self, scene: &Scene) -> bool {
        let nodes = &scene.document.pipeline().nodes;
        let camera = scene.shown_node.and_then(|shown| camera_of(nodes, shown));
        self.count(camera) > 1 || self.fault.is_some() && scene.failure.is_none()
    }

    pub fn frame(&self, nodes: &[NodeEntry]) -> usize {
        match self.series.is_none() {
            true => self.at,
            false => self.moved.unwrap_or_else(|| self.series.step_of(nodes)),
        }
    }

    /// Puts the camera back on its way; the view that it leaves is kept.
    pub fn leave_view(&mut self) {
        if let Some((camera, view)) = self.free.take() {
            self.left = Some((camera.name, view));
        }
    }

    /// Edits that let the document state a frame.
    fn settled(&mut self, nodes: &[NodeEntry], frame: usize) -> Vec<Edit> {
        (self.playing, self.is_dragged) = (None, false);
        self.leave_view();
        if self.series.is_none() {
            self.at = frame;
            return Vec::new();
        }
        self.moved = Some(frame);
        match self.keeps_step() {
            true => Vec::new(),
            false => self.series.stated_at(frame, nodes).iter().map(Change::edit).collect(),
        }
    }

    /// Stops playing at the frame that is shown.
    pub fn stop(&mut self, nodes: &[NodeEntry], count: usize) -> Vec<Edit> {
        let frame = self.frame(nodes).min(count.saturating_sub(1));
        self.settled(nodes, frame)
    }

    /// Shows another frame, and leaves the document as it is.
    pub fn move_to(&mut self, frame: usize) {
        (self.moved, self.at) = (Some(frame), frame);
        self.leave_view();
    }

    /// Changes of nodes that make a frame of their picture.
    pub fn put(&self, nodes: &mut [NodeEntry], frame: usize, count: usize) {
        let own = self.moved.is_none() || self.series.is_none();
        let mut changes = if own { Vec::new() } else { self.series.at(frame) };
        for camera in nodes.iter().filter(|node| node.node_type.text() == Some("camera")) {
            let phase = phase(camera, frame, count);
            changes.extend(phase.map(|phase| Change::set(&camera.name, "phase", phase.into())));
        }
        if let Some((camera, view)) = &self.free {
            changes.extend(VIEW_PARAMETERS.map(|name| Change::unset(&camera.name, name)));
            let stated = view.settings().into_iter();
            changes.extend(stated.map(|(name, value)| Change::set(&camera.name, name, value)));
        }
        // A node that is gone has no frame.
        changes.iter().for_each(|change| drop(change.apply(nodes)));
    }

    /// Shows the strip, or why there is no series.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene) {
        let nodes = &scene.document.pipeline().nodes;
        let camera = scene.shown_node.and_then(|shown| camera_of(nodes, shown));
        let count = self.count(camera);
        if let (0..=1, Some(fault)) = (count, &self.fault) {
            let text = error_text(fault, scene.document);
            ui.label(RichText::new(text).color(theme::wrong(ui.visuals().dark_mode)));
            ui.horizontal_wrapped(|ui| buttons(ui, scene, &ways_out(scene, fault)));
            return;
        }
        let frame = self.frame(nodes).min(count.saturating_sub(1));
        ui.horizontal(|ui| {
            self.buttons(ui, scene);
            self.slider(ui, scene, [frame, count]);
        });
        if let Some(camera) = camera {
            self.ticks(ui, scene, camera, count);
        }
        ui.horizontal_wrapped(|ui| {
            if let Some(camera) = camera {
                let help = "keeps this view as one of the places that the camera passes (keys of the camera); up and field of view \
                            are those of the camera";
                // Of a camera that is not stated by eye and target the view is known once its picture is drawn.
                let is_known = self.free.is_some() || View::from_camera(camera).is_some() || self.is_drawn;
                let is_known = is_known && !self.is_dragged && self.playing.is_none();
                let clicked =
                    ui.add_enabled_ui(is_known, |ui| button(ui, "+ key", "add a camera key", help).clicked());
                if let (true, Some(view)) = (clicked.inner, scene.view) {
                    match with_key(camera, &view, place_of(frame, count)) {
                        Ok(edits) => {
                            scene.actions.edits("add a camera key", edits);
                            self.free = None;
                        }
                        Err(why) => scene.actions.say(why),
                    }
                }
                let is_left = self.left.as_ref().is_some_and(|(name, _)| *name == camera.name);
                let help = "the view that you left for the camera's way";
                if is_left
                    && self.free.is_none()
                    && camera.setting("keys").is_some()
                    && ui.button("Back to your view").help(help).clicked()
                {
                    self.free = self.left.take().map(|(_, view)| (camera.clone(), view));
                }
            }
            if ui.button("Film …").help("a film of these frames (Shift+A)").clicked() {
                self.film.is_open = true;
            }
            if self.series.is_none() {
                let mut length = self.length.unwrap_or(LENGTH);
                let field = DragValue::new(&mut length).range(2..=MAX_LENGTH).suffix(" frames");
                if ui.add(field).help("frames of the camera's way").changed() {
                    (self.length, self.at) = (Some(length), self.at.min(length - 1));
                }
            }
            let text = self.words(camera, frame, count);
            let text = RichText::new(text).color(theme::weak(ui.visuals().dark_mode));
            ui.add(Label::new(text).truncate());
        });
    }

    /// Shows the sheet of films, where it is open.
    pub fn show_film(&mut self, ctx: &Context, scene: &Scene) {
        let nodes = &scene.document.pipeline().nodes;
        let camera = scene.shown_node.and_then(|shown| camera_of(nodes, shown));
        let has_way = camera.is_some_and(|camera| phase(camera, 0, 2).is_some());
        let frames = if has_way { self.length.unwrap_or(LENGTH) } else { 0 };
        self.film.show(ctx, scene, (self.series.count(), frames), self.fault.as_ref());
    }

    /// "step 3 of 0 to 10, time 0.35".
    fn words(&self, camera: Option<&NodeEntry>, frame: usize, count: usize) -> String {
        if self.free.is_some() {
            return "a view that is kept nowhere yet: + key keeps it".into();
        }
        let mut words = match self.series.is_none() {
            true => format!("frame {frame} of 0 to {}", count - 1),
            false => format!("step {frame} of 0 to {}", count - 1),
        };
        if let Some(time) = self.series.times.get(frame) {
            words += &format!(", time {}", crate::worker::short_by(*time, 1e-6 * time.abs()));
        }
        if let Some(phase) = camera.and_then(|camera| phase(camera, frame, count)) {
            words += &format!(", camera at {:.0} % of its way", 100.0 * phase);
        }
        if self.keeps_step() {
            words += " (not in the file: other readers stay at the step that it states)";
        }
        words
    }

    fn buttons(&mut self, ui: &mut Ui, scene: &Scene) {
        let play = if self.playing.is_some() { "⏸" } else { "▶" };
        let playing = "plays the frames as fast as they are drawn; the file is as it was until it is stopped, and then states the \
                       step that is shown (A)";
        for (text, name, help, to) in [
            ("⏮", "first frame", "the first frame (Home)", TimeMove::First),
            ("⏴", "previous frame", "the frame before ([)", TimeMove::Previous),
            (play, "play", playing, TimeMove::Play),
            ("⏵", "next frame", "the frame after (])", TimeMove::Next),
            ("⏭", "last frame", "the last frame (End)", TimeMove::Last),
        ] {
            if button(ui, text, name, help).clicked() {
                scene.actions.command(Command::Time(to));
            }
        }
    }

    /// Carries a command out; gives what it changes in the document.
    pub fn step(&mut self, nodes: &[NodeEntry], count: usize, to: TimeMove) -> Vec<Edit> {
        let Some(last) = count.checked_sub(1) else { return Vec::new() };
        let frame = self.frame(nodes).min(last);
        let to = match to {
            TimeMove::Play if self.playing.is_none() => {
                self.move_to(frame);
                self.playing = Some(Instant::now());
                return Vec::new();
            }
            TimeMove::Play => frame,
            TimeMove::First => 0,
            TimeMove::Previous => frame.saturating_sub(1),
            TimeMove::Next => (frame + 1).min(last),
            TimeMove::Last => last,
        };
        self.settled(nodes, to)
    }

    fn slider(&mut self, ui: &mut Ui, scene: &Scene, [frame, count]: [usize; 2]) {
        let mut to = frame;
        ui.spacing_mut().slider_width = (ui.available_width() - 4.0).max(40.0);
        let response = ui.add(Slider::new(&mut to, 0..=count.saturating_sub(1)).show_value(false));
        let name = if self.series.is_none() { "frame" } else { "time step" };
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
        if response.drag_stopped() || response.changed() && !response.dragged() {
            let edits = self.settled(&scene.document.pipeline().nodes, to);
            scene.actions.edits("set the time step", edits);
        } else if response.dragged() {
            self.playing = None;
            self.is_dragged = true;
            self.move_to(to);
        }
        self.film.rail = response.rect;
    }

    /// A tick for each key of the camera, below the slider.
    fn ticks(&mut self, ui: &mut Ui, scene: &Scene, camera: &NodeEntry, count: usize) {
        let Some(rows) = keys(camera).filter(|rows| !rows.is_empty() && count > 1) else { return };
        // The middle of the slider's handle runs within the rail by its radius.
        let rail = self.film.rail.shrink2(vec2(self.film.rail.height() / 2.5, 0.0));
        let (room, _) = ui.allocate_exact_size(vec2(ui.available_width(), 12.0), Sense::hover());
        let color = theme::accent(ui.visuals().dark_mode);
        for (number, row) in rows.iter().enumerate() {
            let middle = pos2(rail.left() + rail.width() * row[0] as f32, room.center().y);
            let tick = Rect::from_center_size(middle, vec2(TICK, room.height()));
            let response = ui.interact(tick, ui.id().with(("camera key", number)), Sense::click_and_drag());
            let name = format!("camera key {}", number + 1);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
            let width = if response.hovered() || response.dragged() { 5.0 } else { 3.0 };
            let ends = [tick.center_top(), tick.center_bottom()];
            ui.painter().line_segment(ends, Stroke::new(width, color));
            let frame = frame_at(row[0], count);
            if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
                let share = f64::from((at.x - rail.left()) / rail.width().max(1.0));
                let to = frame_at(share, count);
                let is_free = |other: &[f64; 7]| frame_at(other[0], count) != to;
                let beside = [number.checked_sub(1), Some(number + 1)];
                let low = beside[0].and_then(|k| rows.get(k)).map_or(0, |row| frame_at(row[0], count) + 1);
                let high = beside[1].and_then(|k| rows.get(k)).map_or(count, |row| frame_at(row[0], count));
                if to != frame && (low..high).contains(&to) && rows.iter().all(is_free) {
                    let path = key_path(number).with(0_usize);
                    let place = ParameterValue::Number(place_of(to, count));
                    let edit = Edit::Set { node: camera.name.clone(), path, value: place };
                    scene.actions.edits("move a camera key", vec![edit]);
                }
            } else if response.clicked() {
                let edits = self.settled(&scene.document.pipeline().nodes, frame);
                scene.actions.edits("set the time step", edits);
            }
            response.context_menu(|ui| {
                if ui.button("Delete this key").clicked() {
                    scene.actions.edits("delete a camera key", without_key(camera, &rows, number));
                    ui.close();
                }
            });
            response
                .help("a place that the camera passes: a drag moves it in time, a right click deletes it");
        }
    }
}

/// Place on its way of a camera in one of so many frames; `None` where it has no way, or states its place there.
fn phase(camera: &NodeEntry, frame: usize, count: usize) -> Option<f64> {
    if camera.setting("phase").is_some() {
        return None;
    }
    let orbit = camera.setting("orbit").and_then(LocatedValue::number).unwrap_or(0.0);
    series::phase(orbit, camera.setting("keys").is_some(), frame, count)
}

/// Share of the way of a frame, with the digits that tell frames apart.
fn place_of(frame: usize, count: usize) -> f64 {
    decimal(frame as f64 / (count.max(2) - 1) as f64, 1e-9)
}

/// The frame nearest to a share of the way.
fn frame_at(place: f64, count: usize) -> usize {
    (place.clamp(0.0, 1.0) * (count.max(1) - 1) as f64).round() as usize
}

/// Keys of a camera: share of the way, eye, target; `None` where one of them is none.
fn keys(camera: &NodeEntry) -> Option<Vec<[f64; 7]>> {
    let Some(stated) = camera.setting("keys") else { return Some(Vec::new()) };
    stated.list()?.iter().map(LocatedValue::array).collect()
}

fn key_path(number: usize) -> Path {
    Path::from("keys").with(number)
}

/// Parameters that turn or shift a camera beside its keys.
const TURNS: [&str; 5] = ["azimuth", "elevation", "roll", "zoom", "orbit"];

/// Edits by which a camera passes a view at a share of its way. The first key takes the place of eye and target, and stands at an end, too:
/// a way has two keys at least. Errors: why it has none there.
fn with_key(camera: &NodeEntry, view: &View, place: f64) -> Result<Vec<Edit>, String> {
    let settings = view.settings();
    let vector = |name: &str| {
        let value = settings.iter().find(|(known, _)| *known == name).map(|(_, value)| value.clone());
        value.and_then(|value| LocatedValue::from(value).array::<3>()).unwrap_or_default()
    };
    let ([a, b, c], [d, e, f]) = (vector("eye"), vector("target"));
    let key = |place: f64| [place, a, b, c, d, e, f].into_iter().map(ParameterValue::Number).collect();
    let node = camera.name.clone();
    let Some(rows) = keys(camera) else {
        return Err(format!("a key of '{node}' is not seven numbers: mend that first"));
    };
    if !rows.is_empty() {
        // The view is what is seen at last; a key is what is turned then.
        if let Some(turn) = TURNS.iter().find(|name| camera.setting(name).is_some()) {
            return Err(format!("'{node}' has {turn} beside its keys, which would turn this view again"));
        }
        let number = rows.iter().position(|row| row[0] >= place - SAME).unwrap_or(rows.len());
        let is_there = rows.get(number).is_some_and(|row| (row[0] - place).abs() <= SAME);
        return Ok(vec![match is_there {
            true => Edit::Set { node, path: key_path(number), value: key(place) },
            false => Edit::Insert { node, list: "keys".into(), place: number, entry: key(place) },
        }]);
    }
    let ends = if place < 1.0 { [place, 1.0] } else { [0.0, place] };
    let mut edits = vec![Edit::set(&node, "keys", ends.into_iter().map(key).collect())];
    let other = settings.into_iter().filter(|(name, value)| {
        !["eye", "target"].contains(name) && camera.setting(name).map(|setting| &setting.datum) != Some(value)
    });
    edits.extend(other.map(|(name, value)| Edit::set(&node, name, value)));
    let replaced = VIEW_PARAMETERS.into_iter().chain(["eye", "target", "phase"]);
    let replaced = replaced.filter(|name| *name != "keys" && camera.setting(name).is_some());
    edits.extend(replaced.map(|name| Edit::Unset { node: node.clone(), path: [name].into() }));
    Ok(edits)
}

/// Difference of places on the way that are one.
const SAME: f64 = 1e-6;

/// Edits by which a camera loses a key; where one alone is left, it stands there.
fn without_key(camera: &NodeEntry, rows: &[[f64; 7]], number: usize) -> Vec<Edit> {
    let node = camera.name.clone();
    let left = rows.iter().enumerate().filter(|(place, _)| *place != number).map(|(_, row)| *row);
    let [[_, a, b, c, d, e, f]] = left.collect::<Vec<_>>()[..] else {
        return vec![Edit::Unset { node, path: key_path(number) }];
    };
    let place = |name: &str, place: [f64; 3]| {
        Edit::set(&camera.name, name, place.into_iter().map(ParameterValue::Number).collect())
    };
    vec![place("eye", [a, b, c]), place("target", [d, e, f]), Edit::Unset { node, path: ["keys"].into() }]
}
