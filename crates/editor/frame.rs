//! One frame: what happened meanwhile, what the hand asks for, the layout of the window's parts, what is asked of the worker; the start
//! screen of an empty window, and the screen of an unreadable file.

use crate::actions::{Action, Actions, Command};
use crate::costs;
use crate::editor::Editor;
use crate::file_dialog::{self, ask};
use crate::graph::GraphView;
use crate::keys;
use crate::parameters::ParameterPanel;
use crate::picture::{self, PicturePanel};
use crate::scene::Scene;
use crate::theme;
use crate::transfer::TransferPanel;
use eframe::egui::{
    Align, Button, CentralPanel, Context, Frame, Key, Label, Layout, Rect, RichText, SidePanel,
    TopBottomPanel, Ui, UiBuilder, ViewportCommand, vec2,
};
use std::path::Path;
use voltet_core::Error;

/// Width of what is offered, points.
const WIDTH: f32 = 340.0;

impl Editor {
    /// Shows everything once and carries out what was asked for.
    pub fn frame(&mut self, ctx: &Context) {
        self.look_at_disk();
        self.take_made();
        self.take_probed();
        self.study.take_found();
        self.show_run();
        self.settle_on_nodes();
        self.gesture = self.gestures.gesture(ctx);
        if ctx.input(|input| input.viewport().close_requested()) && !self.ends {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.command(ctx, Command::Quit);
        }
        let mut actions = Actions::default();
        let dropped = ctx.input(|input| input.raw.dropped_files.iter().find_map(|file| file.path.clone()));
        dropped.into_iter().for_each(|path| actions.push(Action::Begin(path)));
        keys::read(ctx, self.transfer.takes_keys(), &mut actions);
        show(self, ctx, &mut actions);
        for action in actions.0 {
            self.apply(ctx, action);
        }
        self.paste(ctx);
        self.keep(ctx);
        self.settle_on_nodes();
        if self.picture.room == [0; 2] {
            // Nothing was shown yet; how large the picture is follows from the next frame.
            if !self.document.pipeline().nodes.is_empty() {
                ctx.request_repaint();
            }
            return;
        }
        self.wish();
    }
}

/// Shows everything once.
fn show(editor: &mut Editor, ctx: &Context, actions: &mut Actions) {
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
        TopBottomPanel::top("menus").show(ctx, |ui| keys::bar(ui, &scene, actions));
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
        let recent: Vec<&Path> = editor.recent.paths().collect();
        invite(ui, place, &recent, editor.made.is_some(), actions);
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
            broken(ui, place, scene.faults);
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
                    let label = Label::new(RichText::new(&text).color(color)).truncate();
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
    let name = editor.document().path().map_or("The new pipeline".into(), |path| path.display().to_string());
    let text = format!("{name} has changes that are not saved.");
    let answers = [("Save", Some(true)), ("Discard", Some(false)), ("Cancel", None)];
    let answer = match ask(ctx, "Unsaved work", text, &answers) {
        _ if ctx.input(|input| input.key_pressed(Key::Escape)) => None,
        None => return,
        Some(answer) => answer,
    };
    editor.unsaved = None;
    let Some(saves) = answer else { return };
    if saves {
        editor.save();
    }
    if !saves || editor.document().is_saved() {
        editor.go_on(ctx, command);
    }
}

/// Message above the graph of a file that is no TOML.
fn broken(ui: &mut Ui, place: Rect, faults: &[Error]) {
    let dark = ui.visuals().dark_mode;
    // At the top, on a ground of its own: what can be read of the file is shown below.
    let rect = Rect::from_min_size(place.min + vec2(12.0, 8.0), vec2(place.width() - 24.0, 120.0));
    ui.allocate_new_ui(UiBuilder::new().max_rect(rect), |ui| {
        Frame::none().fill(ui.visuals().window_fill).inner_margin(8.0).rounding(4.0).show(ui, |ui| {
            for fault in faults.iter().take(3) {
                ui.label(RichText::new(fault.to_string()).color(theme::wrong(dark)));
            }
            let text = "Mend it in a text editor; once it is saved there, it can be taken over here.";
            ui.label(RichText::new(text).color(theme::weak(dark)));
        });
    });
}

/// Shows the ways to begin, in the middle of a place. `recent`: files that were opened last; `is_making`: a pipeline is being
/// made for data.
fn invite(ui: &mut Ui, place: Rect, recent: &[&Path], is_making: bool, actions: &mut Actions) {
    let dark = ui.visuals().dark_mode;
    let weak = theme::weak(dark);
    let height = 150.0 + 26.0 * recent.len() as f32;
    let size = vec2(WIDTH.min(place.width() - 20.0), height.min(place.height() - 10.0));
    let rect = Rect::from_center_size(place.center(), size);
    let layout = Layout::top_down(Align::Center);
    ui.allocate_new_ui(UiBuilder::new().max_rect(rect).layout(layout), |ui| {
        if is_making {
            ui.add_space(0.4 * rect.height());
            ui.label(RichText::new("Looking at the data …").size(16.0));
            return;
        }
        let button =
            |text: &str| Button::new(RichText::new(text).size(15.0)).min_size(vec2(rect.width(), 34.0));
        let open = ui.add(button("Open data or a pipeline …"));
        if open.on_hover_text("for a data file, a pipeline with a picture is made (Ctrl+O)").clicked() {
            actions.command(Command::Open);
        }
        ui.add_space(4.0);
        if ui.add(button("Add a node …")).on_hover_text("Space").clicked() {
            actions.command(Command::Add);
        }
        ui.add_space(6.0);
        ui.label(RichText::new("or drop a file here").color(weak));
        if recent.is_empty() {
            return;
        }
        ui.add_space(8.0);
        ui.label(RichText::new("Lately opened").color(weak));
        for path in recent {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let folder = path.parent().unwrap_or(Path::new("")).display().to_string();
            let entry = Button::new(format!("{name}   in {folder}")).frame(false).truncate();
            if ui.add(entry).on_hover_text(path.display().to_string()).clicked() {
                actions.push(Action::Begin(path.to_path_buf()));
            }
        }
    });
}
