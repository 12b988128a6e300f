//! Layout of the window's parts.

use crate::actions::Actions;
use crate::begin;
use crate::costs;
use crate::editor::Editor;
use crate::file_dialog;
use crate::graph::GraphView;
use crate::keys;
use crate::menus;
use crate::parameters::ParameterPanel;
use crate::picture::{self, PicturePanel};
use crate::scene::Scene;
use crate::theme;
use crate::transfer::TransferPanel;
use eframe::egui::{
    Align, CentralPanel, Context, Frame, Layout, RichText, SidePanel, TopBottomPanel, Ui, Window,
};

/// Shows everything once.
pub(crate) fn show(editor: &mut Editor, ctx: &Context, actions: &mut Actions) {
    changed_on_disk(editor, ctx);
    // The views keep what a hand is doing; everything else is looked at.
    let mut graph = std::mem::take(&mut editor.graph);
    let mut panel = std::mem::take(&mut editor.picture);
    let mut parameters = std::mem::take(&mut editor.parameters);
    let mut transfer = std::mem::take(&mut editor.transfer);
    let mut section = std::mem::take(&mut editor.section);
    let mut study = std::mem::take(&mut editor.study);
    let mut open = editor.costs;
    {
        let scene = editor.scene();
        TopBottomPanel::top("menus").show(ctx, |ui| menus::show(ui, &scene, actions));
        TopBottomPanel::bottom("status").show(ctx, |ui| status(ui, editor, &scene));
        if scene.is_empty() {
            empty(editor, ctx, &mut graph, &scene, actions);
        } else {
            parts(ctx, &scene, &mut graph, &mut panel, &mut parameters, &mut transfer, actions);
        }
        costs::show(ctx, &mut open, &scene, actions);
        section.show(ctx, &scene, actions);
        study.show(ctx, &scene);
    }
    (editor.section, editor.study) = (section, study);
    (editor.graph, editor.picture, editor.parameters, editor.transfer) = (graph, panel, parameters, transfer);
    editor.costs = open;
    keys::sheet(ctx, &mut editor.help);
    file_dialog::show(&mut editor.file_dialog, ctx, actions);
    unsaved(editor, ctx);
    editor.offer_left_behind(ctx);
}

/// An empty window: the ways to begin, over the graph view.
fn empty(editor: &Editor, ctx: &Context, graph: &mut GraphView, scene: &Scene, actions: &mut Actions) {
    let ground = Frame::none().fill(theme::ground(ctx.style().visuals.dark_mode));
    CentralPanel::default().frame(ground).show(ctx, |ui| {
        let place = ui.max_rect();
        graph.show(ui, scene, &|_| None, actions);
        let recent: Vec<&std::path::Path> = editor.recent.paths().collect();
        begin::invite(ui, place, &recent, editor.made.is_some(), actions);
    });
}

/// The graph and the parameters at the left, the picture and the transfer function at the right.
fn parts(
    ctx: &Context,
    scene: &Scene,
    graph: &mut GraphView,
    panel: &mut PicturePanel,
    parameters: &mut ParameterPanel,
    transfer: &mut TransferPanel,
    actions: &mut Actions,
) {
    let width = ctx.screen_rect().width();
    SidePanel::right("right")
        .resizable(true)
        .default_width(0.5 * width)
        .width_range(280.0..=0.75 * width)
        .show(ctx, |ui| {
            if transfer.is_wanted(scene) {
                let height = ui.available_height();
                TopBottomPanel::bottom("transfer")
                    .resizable(true)
                    .default_height(0.42 * height)
                    .height_range(140.0..=0.75 * height)
                    .frame(Frame::none())
                    .show_inside(ui, |ui| transfer.show(ui, scene, actions));
            }
            panel.show(ui, scene, actions);
        });
    let height = ctx.available_rect().height();
    TopBottomPanel::bottom("parameters")
        .resizable(true)
        .default_height(0.42 * height)
        .height_range(80.0..=0.75 * height)
        .show(ctx, |ui| parameters.show(ui, scene, actions));
    let ground = Frame::none().fill(theme::ground(ctx.style().visuals.dark_mode));
    CentralPanel::default().frame(ground).show(ctx, |ui| {
        let place = ui.max_rect();
        graph.show(ui, scene, &|node| panel.texture_of(scene, node), actions);
        if !scene.document.is_toml() {
            begin::broken(ui, place, scene.faults);
        }
    });
}

fn status(ui: &mut Ui, editor: &Editor, scene: &Scene) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            picture::status(ui, scene);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let said = match (&editor.message, scene.faults.first()) {
                    (Some((text, true)), _) => Some((text.clone(), theme::wrong(dark))),
                    (Some((text, false)), _) => Some((text.clone(), theme::weak(dark))),
                    (None, Some(fault)) => Some((fault.to_string(), theme::wrong(dark))),
                    (None, None) => None,
                };
                if let Some((text, color)) = said {
                    let label = eframe::egui::Label::new(RichText::new(&text).color(color)).truncate();
                    ui.add(label).on_hover_text(text);
                } else {
                    ui.label(RichText::new("F1: keys and mouse").color(theme::weak(dark)));
                }
            });
        });
    });
}

/// The question about a file that another program wrote.
fn changed_on_disk(editor: &mut Editor, ctx: &Context) {
    if !editor.disk.is_changed {
        return;
    }
    let mut answer = None;
    TopBottomPanel::top("changed").show(ctx, |ui| {
        ui.horizontal(|ui| {
            ui.label("Another program changed the file.");
            for (text, help, takes_over) in [
                ("Take it over", "as a step that can be undone", true),
                ("Write over it", "with what is shown here", false),
            ] {
                if ui.button(text).on_hover_text(help).clicked() {
                    answer = Some(takes_over);
                }
            }
        });
    });
    if let Some(takes_over) = answer {
        editor.settle_with_disk(takes_over);
    }
}

/// The question about unsaved work.
fn unsaved(editor: &mut Editor, ctx: &Context) {
    let Some(command) = editor.unsaved else { return };
    let mut answer = None;
    Window::new("Unsaved work")
        .collapsible(false)
        .resizable(false)
        .anchor(eframe::egui::Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| {
            let name =
                editor.document().path().map_or("The new pipeline".into(), |path| path.display().to_string());
            ui.label(format!("{name} has changes that are not saved."));
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                for (text, is_answer) in [("Save", Some(true)), ("Discard", Some(false)), ("Cancel", None)] {
                    if ui.button(text).clicked() {
                        answer = Some(is_answer);
                    }
                }
            });
        });
    if ctx.input(|input| input.key_pressed(eframe::egui::Key::Escape)) {
        answer = Some(None);
    }
    match answer {
        None => {}
        Some(None) => editor.unsaved = None,
        Some(Some(false)) => {
            editor.unsaved = None;
            editor.go_on(ctx, command);
        }
        Some(Some(true)) => {
            editor.unsaved = None;
            editor.save();
            if editor.document().is_saved() {
                editor.go_on(ctx, command);
            }
        }
    }
}
