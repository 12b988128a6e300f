//! Films: a sheet that chooses the frames, their rate and size, and the file; made in the background as `voltet run --film` makes them.

use crate::focus::Sheet;
use crate::jobs::Job;
use crate::scene::{Action, FilePurpose, Scene, camera_of, error_text};
use crate::theme::{self, Help};
use crate::ways_out::{AGAIN, ELSEWHERE, FEWER_PIXELS, WayOut, buttons, end_text, is_of_pixels, ways_out};
use eframe::egui::{Button, Context, DragValue, Grid, ProgressBar, Rect, RichText, TextEdit, Ui, Widget};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_document::Edit;
use voltet_graph::Observer;

/// Request for a film.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmRequest {
    /// The pipeline, saved or not.
    pub text: String,
    /// Its file, which paths are relative to.
    pub path: PathBuf,
    /// Time steps, as `voltet run --steps` takes them; `None`: a way of the camera past data that stand still.
    pub steps: Option<String>,
    /// Pictures of that way.
    pub frames: Option<usize>,
    /// Frames a second.
    pub rate: f64,
    /// Width and height in pixels; `None`: as the camera says.
    pub size: Option<[u32; 2]>,
    /// The file: .mp4, .webm, .gif or .png.
    pub film: PathBuf,
}

/// Makes a film and gives a line about it; called on a thread of its own. Errors: those of `voltet run`; a stop.
pub type Film = Arc<dyn Fn(&FilmRequest, &dyn Observer) -> Result<String> + Send + Sync>;

/// Most frames a second.
const MAX_RATE: f64 = 1000.0;

/// Frames a second where a hand gives none, at most, and how long a film lasts where it takes fewer, seconds.
const USUAL_RATE: f64 = 25.0;
const SHORTEST: f64 = 3.0;

/// Size of a film of a camera that states none.
const USUAL_SIZE: [u32; 2] = [1024, 768];

/// Most pixels of a side.
const MAX_SIDE: u32 = 32_768;

pub(crate) struct FilmPanel {
    pub is_open: bool,
    /// Function that makes films, where the program has one.
    pub make: Option<Film>,
    /// Place of the slider of the frames in the window.
    pub rail: Rect,
    made: Option<Job<String>>,
    /// Outcome of the film that was asked for last, and its file.
    found: Option<Result<String>>,
    file: PathBuf,
    /// First and last frame, and the way from one to the next; `None`: all of them.
    range: Option<[usize; 3]>,
    /// Frames a second; `None`: as many as are usual.
    rate: Option<f64>,
    size: Option<[u32; 2]>,
    /// Path of the file, as typed.
    pub path: Option<String>,
}

impl Default for FilmPanel {
    fn default() -> Self {
        FilmPanel {
            is_open: false,
            make: None,
            rail: Rect::NOTHING,
            made: None,
            found: None,
            file: PathBuf::new(),
            range: None,
            rate: None,
            size: None,
            path: None,
        }
    }
}

impl FilmPanel {
    /// The sheet of another document; a film in progress is stopped.
    pub fn emptied(self) -> FilmPanel {
        FilmPanel { is_open: self.is_open, make: self.make, ..FilmPanel::default() }
    }

    /// Stops a film in progress, and waits until its file is as it was.
    pub fn end(&mut self) {
        if let Some(made) = self.made.take() {
            made.end();
        }
    }

    /// Progress of a film, in words; `None` where none is being made.
    pub fn progress(&self) -> Option<String> {
        let (stage, fraction) = self.made.as_ref()?.progress();
        Some(format!("film: {stage} {:.0} %", 100.0 * fraction))
    }

    /// Shows the sheet. `steps`: those of the time series; `frames`: those of the camera's way without one; `fault`: why there is no
    /// series.
    pub fn show(
        &mut self,
        ctx: &Context,
        scene: &Scene,
        (steps, frames): (usize, usize),
        fault: Option<&Error>,
    ) {
        self.take_found();
        let mut is_open = self.is_open;
        let window = Sheet::FILM.window().open(&mut is_open).resizable(false).default_pos([60.0, 90.0]);
        window.default_width(380.0).show(ctx, |ui| {
            if let Some(made) = &self.made {
                let (stage, fraction) = made.progress();
                ui.horizontal(|ui| {
                    if ui.button("Stop").help("pictures that are drawn stay for the next film").clicked() {
                        made.cancel();
                    }
                    ui.add(ProgressBar::new(fraction as f32).desired_width(180.0).show_percentage());
                    ui.label(stage);
                });
            } else {
                self.form(ui, scene, steps, frames, fault);
            }
            self.outcome(ui, scene, steps, frames);
        });
        self.is_open = is_open;
    }

    /// The line about the last film, or why there is none, with ways out.
    fn outcome(&mut self, ui: &mut Ui, scene: &Scene, steps: usize, frames: usize) {
        let error = match &self.found {
            None => return,
            Some(Ok(line)) => {
                ui.label(line.trim_end());
                let path = self.file.display().to_string();
                let help = format!("{path}\nfor the program that shows the film");
                if ui.button("Copy path").help(help).clicked() {
                    ui.ctx().copy_text(path);
                }
                return;
            }
            Some(Err(error)) => error.clone(),
        };
        ui.label(end_text(ui, scene, &error));
        ui.horizontal_wrapped(|ui| {
            let is_size = |(text, _): &WayOut| text == FEWER_PIXELS;
            let ways: Vec<WayOut> = ways_out(scene, &error).into_iter().filter(|way| !is_size(way)).collect();
            buttons(ui, scene, &ways);
            let Some(again) = self.request(scene, steps, frames) else { return };
            if is_of_pixels(&error) && ui.small_button(FEWER_PIXELS).clicked() {
                let own = again.size.or(scene.picture_size).unwrap_or(USUAL_SIZE);
                self.size = Some(own.map(|length| (length / 2).max(1)));
                self.begin(FilmRequest { size: self.size, ..again }, ui.ctx());
                return;
            }
            let is_of_film = error.location.file.as_deref() == Some(&*again.film.to_string_lossy());
            if is_of_film && ui.small_button(ELSEWHERE).clicked() {
                scene.actions.push(Action::ChooseFile(FilePurpose::Film, Some(again.film.clone())));
            }
            if ui.small_button(AGAIN).clicked() {
                self.begin(again, ui.ctx());
            }
        });
    }

    fn form(&mut self, ui: &mut Ui, scene: &Scene, steps: usize, frames: usize, fault: Option<&Error>) {
        let has_steps = steps > 1;
        if !has_steps && frames == 0 {
            let none =
                || "there is no frame: no reader has time steps, and the camera has no way (orbit or keys)";
            ui.label(fault.map_or_else(|| none().to_string(), |fault| error_text(fault, scene.document)));
            let ways = fault.map_or(Vec::new(), |fault| ways_out(scene, fault));
            buttons(ui, scene, &ways);
            let nodes = &scene.document.pipeline().nodes;
            let camera = scene.shown_node.and_then(|shown| camera_of(nodes, shown));
            if let Some(camera) = camera
                && ui.button("Orbit about the data").help("gives the camera a way: once around").clicked()
            {
                scene.actions.edit(Edit::set(&camera.name, ["orbit"], 360.0.into()));
            }
            return;
        }
        let last = steps.saturating_sub(1);
        let [mut from, mut to, mut by] = self.steps(last);
        let own = scene.picture_size.unwrap_or(USUAL_SIZE);
        let mut size = self.size.unwrap_or(own);
        let usual_rate = self.usual_rate(steps, frames);
        let mut rate = self.rate.unwrap_or(usual_rate);
        let path = self.path.get_or_insert_with(|| proposed(scene));
        Grid::new("film").num_columns(2).show(ui, |ui| {
            if has_steps {
                ui.label("steps").help("as --steps of `voltet run`: from, to and by");
                ui.horizontal(|ui| {
                    named(ui, "first step", DragValue::new(&mut from).range(0..=to));
                    ui.label("to");
                    named(ui, "last step", DragValue::new(&mut to).range(from..=last));
                    ui.label("by");
                    named(ui, "step width", DragValue::new(&mut by).range(1..=last.max(1)));
                });
            } else {
                ui.label("frames").help("as --frames of `voltet run`: along the camera's way");
                ui.label(frames.to_string());
            }
            ui.end_row();
            ui.label("rate");
            let field = DragValue::new(&mut rate).range(0.1..=MAX_RATE).suffix(" frames a second");
            named(ui, "frames a second", field);
            ui.end_row();
            ui.label("size");
            ui.horizontal(|ui| {
                let [width, height] = &mut size;
                named(ui, "width of the film", DragValue::new(width).range(1..=MAX_SIDE));
                ui.label("×");
                named(ui, "height of the film", DragValue::new(height).range(1..=MAX_SIDE));
                ui.label("pixels");
            });
            ui.end_row();
            ui.label("file").help(".gif and .png (animated); .mp4 and .webm by the program ffmpeg");
            ui.horizontal(|ui| {
                named(ui, "file of the film", TextEdit::singleline(path).desired_width(240.0));
                if ui.button("…").help("choose a file").clicked() {
                    let at = scene.document.folder().join(&*path);
                    scene.actions.push(Action::ChooseFile(FilePurpose::Film, Some(at)));
                }
            });
            ui.end_row();
        });
        // While the steps are looked for the choice of them stays.
        if has_steps {
            self.range = Some([from, to, by]).filter(|range| *range != [0, last, 1]);
        }
        self.size = Some(size).filter(|size| *size != own);
        self.rate = Some(rate).filter(|rate| *rate != usual_rate);
        let film = self.path.as_deref().map(Path::new);
        let lacks_ffmpeg =
            film.filter(|film| !is_own_kind(film) && !has_ffmpeg()).map(|film| film.with_extension("gif"));
        let can = self.make.is_some() && scene.document.path().is_some() && lacks_ffmpeg.is_none();
        let begins = ui.add_enabled(can, Button::new("Make the film"));
        if let Some(other) = lacks_ffmpeg {
            ui.label(
                RichText::new("the program ffmpeg, which makes such films, is not there")
                    .color(theme::wrong(ui.visuals().dark_mode)),
            );
            if ui.small_button("Make a .gif").clicked() {
                self.path = Some(other.to_string_lossy().into_owned());
            }
        }
        let begins = begins.why_disabled(match scene.document.path() {
            Some(_) => "another kind of film is needed here",
            None => "save the pipeline first: paths of the film are relative to its file",
        });
        ui.label("The pictures of the frames are written as the pipeline names them; those that are there already, as they would be drawn, stay.");
        if let Some(request) = self.request(scene, steps, frames).filter(|_| begins.clicked()) {
            self.begin(request, ui.ctx());
        }
    }

    /// First and last step, and the way from one to the next, of those that there are.
    fn steps(&self, last: usize) -> [usize; 3] {
        let [from, to, by] = self.range.unwrap_or([0, last, 1]);
        [from.min(last), to.min(last), by]
    }

    /// Frames a second where a hand gives none: a short film lasts long enough to be seen.
    fn usual_rate(&self, steps: usize, frames: usize) -> f64 {
        let [from, to, by] = self.steps(steps.saturating_sub(1));
        let count = if steps > 1 { to.saturating_sub(from) / by.max(1) + 1 } else { frames };
        (count as f64 / SHORTEST).round().clamp(1.0, USUAL_RATE)
    }

    /// The film of the document and the fields as they are now; `None` without a frame, and of a document without a file.
    fn request(&self, scene: &Scene, steps: usize, frames: usize) -> Option<FilmRequest> {
        let has_steps = steps > 1;
        let [from, to, by] = self.steps(steps.saturating_sub(1));
        let path = scene.document.path().filter(|_| has_steps || frames > 0)?;
        Some(FilmRequest {
            text: scene.document.text().to_string(),
            path: path.to_path_buf(),
            steps: has_steps.then(|| format!("{from}:{to}:{by}")),
            frames: (!has_steps).then_some(frames),
            rate: self.rate.unwrap_or_else(|| self.usual_rate(steps, frames)),
            size: self.size,
            film: scene.document.folder().join(self.path.as_deref()?),
        })
    }

    fn begin(&mut self, of: FilmRequest, ctx: &Context) {
        let Some(make) = self.make.clone() else { return };
        self.file = of.film.clone();
        match Job::start("film", ctx, move |observer| make(&of, observer)) {
            Ok(made) => (self.made, self.found) = (Some(made), None),
            Err(error) => self.found = Some(Err(error)),
        }
    }

    fn take_found(&mut self) {
        let Some(found) = self.made.as_ref().and_then(Job::result) else { return };
        self.made = None;
        self.found = Some(found);
    }
}

fn named(ui: &mut Ui, name: &str, field: impl Widget) {
    let response = ui.add(field);
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// True if the program makes such films itself.
fn is_own_kind(film: &Path) -> bool {
    let ending = film.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    ["gif", "png"].iter().any(|own| ending.eq_ignore_ascii_case(own))
}

/// True if the program is there that most kinds of films need.
pub(crate) fn has_ffmpeg() -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let is_there = |folder: PathBuf| ["ffmpeg", "ffmpeg.exe"].iter().any(|name| folder.join(name).is_file());
    std::env::split_paths(&folders).any(is_there)
}

/// Name of a film of the document, beside it: of a kind that can be made here.
fn proposed(scene: &Scene) -> String {
    let stem = scene.document.path().and_then(|path| path.file_stem());
    let ending = if has_ffmpeg() { "mp4" } else { "gif" };
    format!("{}.{ending}", stem.map_or("film".into(), |stem| stem.to_string_lossy()))
}
