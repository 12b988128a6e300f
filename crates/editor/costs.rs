//! Costs of the picture and skipped work: a small window, from the last full run's report.

use crate::actions::{Action, Actions};
use crate::picture::milliseconds;
use crate::scene::Scene;
use crate::theme;
use crate::worker::grouped;
use eframe::egui::{Context, Grid, RichText, ScrollArea, Ui, Window};
use voltet_graph::RunReport;

/// Shows it.
pub(crate) fn show(ctx: &Context, open: &mut bool, scene: &Scene, actions: &mut Actions) {
    let window = Window::new("Costs").open(open).resizable(true);
    window.default_pos([150.0, 60.0]).default_size([560.0, 400.0]).show(ctx, |ui| {
        let Some(report) = &scene.report else {
            ui.label("Nothing was drawn yet.");
            return;
        };
        ui.horizontal(|ui| {
            ui.strong(format!("the last full picture: {}", milliseconds(report.seconds)));
            if let Some((engine, why)) = &report.engine {
                ui.label(engine).on_hover_text(why);
            }
        });
        estimate(ui, scene, actions);
        ui.separator();
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
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
            ui.label(if node.reused { "as before".to_string() } else { milliseconds(node.seconds) });
            ui.end_row();
            for (stage, seconds) in node.stages.iter().filter(|_| !node.reused) {
                ui.label(weak(format!("    {stage}")));
                ui.label(weak(milliseconds(*seconds)));
                ui.end_row();
            }
            for (count, n) in node.counts.iter().filter(|_| !node.reused) {
                ui.label(weak(format!("    {}", count.replace('_', " "))));
                ui.label(weak(grouped(*n as usize)));
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
fn estimate(ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
    ui.horizontal_wrapped(|ui| {
        let help = "draws a few thousand pixels again by the 64-bit referee, and compares";
        if ui.button("How wrong is it?").on_hover_text(help).clicked() {
            actions.push(Action::Estimate);
        }
        match &scene.estimate {
            None if scene.is_estimating => drop(ui.label("the referee draws …")),
            None => {}
            Some(Ok([most, rms])) => {
                ui.label(format!("largest error {most:.1e}, root mean square {rms:.1e} (1 is full scale)"));
            }
            Some(Err(error)) => {
                ui.label(error.to_string());
            }
        }
        if ui.button("Study …").on_hover_text("error against time of every integrator (U)").clicked() {
            actions.command(crate::actions::Command::Study);
        }
    });
}
