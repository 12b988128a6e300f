//! What the picture costs and what was left out of it: a small window of figures, from the last full run's report.

use crate::actions::Actions;
use crate::picture::milliseconds;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{Context, Grid, RichText, ScrollArea, Ui, Window};

/// Shows it.
pub(crate) fn show(ctx: &Context, open: &mut bool, scene: &Scene, actions: &mut Actions) {
    Window::new("Costs").open(open).resizable(true).default_size([420.0, 380.0]).show(ctx, |ui| {
        let Some(report) = &scene.report else {
            ui.label("Nothing was drawn yet.");
            return;
        };
        let dark = ui.visuals().dark_mode;
        let weak = |text: &str| RichText::new(text).small().color(theme::weak(dark));
        ui.horizontal(|ui| {
            ui.strong(format!("the last full picture: {}", milliseconds(report.seconds)));
            if let Some((engine, why)) = &report.engine {
                ui.label(weak(engine)).on_hover_text(why);
            }
        });
        estimate(ui, scene, actions);
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            Grid::new("stages").num_columns(2).striped(true).spacing([24.0, 3.0]).show(ui, |ui| {
                for node in &report.nodes {
                    ui.label(&node.name);
                    ui.label(if node.reused { "as before".to_string() } else { milliseconds(node.seconds) });
                    ui.end_row();
                    for (stage, seconds) in node.stages.iter().filter(|_| !node.reused) {
                        ui.label(weak(&format!("    {stage}")));
                        ui.label(weak(&milliseconds(*seconds)));
                        ui.end_row();
                    }
                    for (count, n) in node.counts.iter().filter(|_| !node.reused) {
                        ui.label(weak(&format!("    {}", count.replace('_', " "))));
                        ui.label(weak(&n.to_string()));
                        ui.end_row();
                    }
                }
            });
            let left_out: Vec<_> = report.left_out.iter().filter(|left| left.what != "repetition").collect();
            if !left_out.is_empty() {
                ui.add_space(6.0);
                ui.strong("left out");
                for left in left_out {
                    let saving = left.saving.map_or(String::new(), |saving| format!(" (saves {saving})"));
                    ui.label(format!("{}: {} – {}{saving}", left.node, left.what, left.why));
                }
            }
            for warning in &report.warnings {
                ui.label(RichText::new(warning).color(theme::accent(dark)));
            }
        });
    });
}

/// How wrong the picture is: asked for by a button, since the referee takes its time.
fn estimate(ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
    ui.horizontal(|ui| {
        let help = "draws a few thousand pixels again by the 64-bit referee, and compares";
        if ui.button("How wrong is it?").on_hover_text(help).clicked() {
            actions.push(crate::actions::Action::Estimate);
        }
        match &scene.estimate {
            None => {}
            Some(Ok([most, rms])) => {
                ui.label(format!("largest error {most:.1e}, root mean square {rms:.1e} (1 is full scale)"));
            }
            Some(Err(error)) => {
                ui.label(error);
            }
        }
    });
}
