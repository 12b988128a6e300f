//! `study` at a click: every integrator on the picture that is shown, its time and its error; and the costs of the last full picture.

use crate::focus::{FollowFocus, Sheet};
use crate::jobs::Job;
use crate::picture::milliseconds;
use crate::scene::{Action, EARLIER, Scene};
use crate::theme::{self, Help};
use crate::ways_out::{show_error, ways_out};
use crate::worker::short;
use eframe::egui::{Context, Grid, ProgressBar, RichText, ScrollArea, Ui};
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::{Result, with_commas};
use voltet_graph::{Observer, RunReport};

/// Request for a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRequest {
    /// The pipeline, saved or not.
    pub text: String,
    /// Its file, which paths are relative to and beside which the study is written.
    pub path: PathBuf,
    /// The node that draws.
    pub node: Option<String>,
}

/// Results of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Studied {
    /// The settings that were measured, cheapest first.
    pub rows: Vec<StudiedRow>,
    /// Recommendation, and settings that were skipped.
    pub notes: Vec<String>,
    /// The folder that the study was written into; none where nothing was measured.
    pub folder: Option<PathBuf>,
}

/// One setting, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct StudiedRow {
    /// The setting in words.
    pub label: String,
    /// Median seconds of a picture.
    pub seconds: f64,
    /// The largest error, 1 being full scale.
    pub max: f64,
    /// The root of the mean square error.
    pub rms: f64,
    /// True if nothing is both cheaper and better.
    pub on_front: bool,
    /// True if the pipeline draws with it.
    pub of_file: bool,
}

/// Makes a study; called on a thread of its own. Errors: those of `voltet study`; a stop.
pub type Study = Arc<dyn Fn(&StudyRequest, &dyn Observer) -> Result<Studied> + Send + Sync>;

#[derive(Default)]
pub(crate) struct StudyPanel {
    pub open: bool,
    /// Function that makes studies, where the program has one.
    pub make: Option<Study>,
    made: Option<Job<Studied>>,
    pub found: Option<Result<Studied>>,
}

impl StudyPanel {
    /// The panel of another document; a study in progress is stopped.
    pub fn emptied(self) -> StudyPanel {
        StudyPanel { open: self.open, make: self.make, ..StudyPanel::default() }
    }

    /// Shows the window; begins a study where that is asked for.
    pub fn show(&mut self, ctx: &Context, scene: &Scene) {
        let mut open = self.open;
        let window = Sheet::STUDY.window().open(&mut open).default_pos([40.0, 110.0]);
        window.default_size([600.0, 460.0]).show(ctx, |ui| {
            ui.horizontal_wrapped(|ui| self.controls(ui, scene));
            ui.separator();
            match &self.found {
                Some(Ok(studied)) => results(ui, studied),
                // The button above tries it again.
                Some(Err(error)) => show_error(ui, scene, error, &ways_out(scene, error)),
                None => {
                    ui.label(
                        "Draws the picture with every integrator and setting on every engine, and compares each with the \
                         64-bit reference. That takes seconds to minutes; leave the window alone meanwhile, since other work \
                         slows what is measured.",
                    );
                }
            }
        });
        self.open = open;
    }

    pub fn take_found(&mut self) {
        let Some(found) = self.made.as_ref().and_then(Job::result) else { return };
        self.made = None;
        self.found = Some(found);
    }

    fn controls(&mut self, ui: &mut Ui, scene: &Scene) {
        if let Some(made) = &self.made {
            let (stage, fraction) = made.progress();
            if ui.button("Stop").clicked() {
                self.stop();
            }
            ui.add(ProgressBar::new(fraction as f32).desired_width(160.0).show_percentage());
            ui.label(stage);
            return;
        }
        let path = scene.document.path();
        let can = self.make.is_some() && path.is_some() && scene.shown_node.is_some();
        let button = ui.add_enabled(can, eframe::egui::Button::new("Study this picture"));
        let button = button.why_disabled("save the pipeline first: the study is written beside its file");
        if let (true, Some(path)) = (button.clicked(), path) {
            self.begin(
                StudyRequest {
                    text: scene.document.text().to_string(),
                    path: path.to_path_buf(),
                    node: scene.shown_node.map(str::to_string),
                },
                ui.ctx(),
            );
        }
        if let Some(path) = path {
            let folder = path.with_extension("study");
            ui.label(RichText::new(format!("into {}", folder.display())).small());
        }
    }

    pub fn begin(&mut self, of: StudyRequest, ctx: &Context) {
        let Some(make) = self.make.clone() else { return };
        match Job::start("study", ctx, move |observer| make(&of, observer)) {
            Ok(made) => (self.made, self.found) = (Some(made), None),
            Err(error) => self.found = Some(Err(error)),
        }
    }

    pub fn stop(&self) {
        if let Some(made) = &self.made {
            made.cancel();
        }
    }
}

fn results(ui: &mut Ui, studied: &Studied) {
    if let Some(folder) = &studied.folder {
        ui.label(format!("Written: {} (study.html, study.csv, plot.svg …)", folder.display()));
        ui.hyperlink_to("error against time", format!("file://{}", folder.join("plot.svg").display()));
    }
    for note in &studied.notes {
        ui.label(note);
    }
    ScrollArea::vertical().auto_shrink([false, false]).show_followed(ui, |ui| {
        Grid::new("settings").num_columns(4).striped(true).spacing([18.0, 3.0]).show(ui, |ui| {
            for title in ["setting", "time", "largest error", "root mean square"] {
                ui.strong(title);
            }
            ui.end_row();
            for row in &studied.rows {
                let mark = match (row.of_file, row.on_front) {
                    (true, _) => "  (the pipeline's)",
                    (false, true) => "  (Pareto-optimal)",
                    (false, false) => "",
                };
                let label = RichText::new(format!("{}{mark}", row.label));
                ui.label(if row.on_front || row.of_file { label.strong() } else { label });
                ui.label(milliseconds(row.seconds));
                ui.label(short(row.max));
                ui.label(short(row.rms));
                ui.end_row();
            }
        });
    });
}

pub(crate) fn show_costs(ctx: &Context, open: &mut bool, scene: &Scene) {
    let window = Sheet::COSTS.window().open(open).resizable(true);
    window.default_pos([150.0, 60.0]).default_size([560.0, 400.0]).show(ctx, |ui| {
        let Some(report) = &scene.report else {
            ui.label("Nothing was drawn yet.");
            return;
        };
        ui.horizontal(|ui| {
            let earlier = if scene.is_earlier() { format!(", {EARLIER}") } else { String::new() };
            ui.strong(format!("the last full picture{earlier}: {}", milliseconds(report.seconds)));
            if let Some((engine, why)) = &report.engine {
                ui.label(engine).help(why);
            }
        });
        estimate(ui, scene);
        ui.separator();
        ScrollArea::vertical().auto_shrink([false, false]).show_followed(ui, |ui| {
            ui.columns(2, |columns| {
                if let [left, right] = columns {
                    stages(left, report);
                    // Columns are justified, which tears short lines of words apart.
                    right.vertical(|right| left_out(right, report));
                }
            });
        });
    });
}

/// Seconds by node and stage, and what was counted.
fn stages(ui: &mut Ui, report: &RunReport) {
    let weak = theme::weak(ui.visuals().dark_mode);
    let weak = |text: String| RichText::new(text).small().color(weak);
    Grid::new("stages").num_columns(2).striped(true).spacing([24.0, 3.0]).show(ui, |ui| {
        for node in &report.nodes {
            ui.label(&node.name);
            ui.label(if node.reused { "cached".to_string() } else { milliseconds(node.seconds) });
            ui.end_row();
            for (stage, seconds) in node.stages.iter().filter(|_| !node.reused) {
                ui.label(weak(format!("    {stage}")));
                ui.label(weak(milliseconds(*seconds)));
                ui.end_row();
            }
            for (count, n) in node.counts.iter().filter(|_| !node.reused) {
                ui.label(weak(format!("    {}", count.replace('_', " "))));
                ui.label(weak(with_commas(*n)));
                ui.end_row();
            }
        }
    });
}

/// Skipped work, with reasons and savings; and warnings.
fn left_out(ui: &mut Ui, report: &RunReport) {
    let dark = ui.visuals().dark_mode;
    ui.strong("left out");
    let all: Vec<_> = report.skipped.iter().filter(|left| left.what != "repetition").collect();
    if all.is_empty() {
        ui.label("nothing");
    }
    for left in all {
        let saving = left.saving.map_or(String::new(), |saving| format!(" (saves {saving})"));
        ui.label(format!("{}: {}{saving}", left.node, left.what));
        ui.label(RichText::new(&left.why).small().color(theme::weak(dark)));
    }
    for warning in &report.warnings {
        ui.label(RichText::new(warning).color(theme::accent(dark)));
    }
}

/// Error of the picture, computed on request, since the reference renderer takes its time.
fn estimate(ui: &mut Ui, scene: &Scene) {
    ui.horizontal_wrapped(|ui| {
        let help = "draws a few thousand pixels with the 64-bit reference, and compares";
        if ui.button("Estimate the error").help(help).clicked() {
            scene.actions.push(Action::Estimate);
        }
        match &scene.estimate {
            None if scene.is_estimating => drop(ui.label("drawing the reference …")),
            None => {}
            Some(Ok([most, rms])) => {
                let [most, rms] = [most, rms].map(|error| short(*error));
                ui.label(format!("largest error {most}, root mean square {rms} (1 is full scale)"));
            }
            // Said below.
            Some(Err(_)) => {}
        }
        if ui.button("Study …").help("error against time of every integrator (U)").clicked() {
            scene.actions.command(crate::scene::Command::Study);
        }
    });
    if let Some(Err(error)) = &scene.estimate {
        // The button above tries it again.
        show_error(ui, scene, error, &ways_out(scene, error));
    }
}
