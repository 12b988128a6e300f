//! The bar at the top: menus, and what is done most.

use crate::actions::{Actions, Command};
use crate::keys;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{self, Button, Label, Layout, RichText, Ui, menu};
use std::path::Path;
use voltet_document::arrange::Align;

/// The menus, what is done most at a click, and the file.
pub(crate) fn show(ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
    menu::bar(ui, |ui| {
        let mut list = |ui: &mut Ui, title: &str, entries: &[(&str, Command)]| {
            ui.menu_button(title, |ui| {
                ui.set_min_width(220.0);
                for (text, command) in entries {
                    let key = keys::shortcut(ui.ctx(), *command);
                    if ui.add(Button::new(*text).shortcut_text(key)).clicked() {
                        actions.command(*command);
                        ui.close_menu();
                    }
                }
            });
        };
        let file = [
            ("New", Command::New),
            ("Open …", Command::Open),
            ("Save", Command::Save),
            ("Save as …", Command::SaveAs),
            ("Run: write the files", Command::Run),
            ("Quit", Command::Quit),
        ];
        let history = scene.document.history();
        let undo = history.undo_label().map_or("Undo".into(), |label| format!("Undo: {label}"));
        let redo = history.redo_label().map_or("Redo".into(), |label| format!("Redo: {label}"));
        let edit = [
            (undo.as_str(), Command::Undo),
            (redo.as_str(), Command::Redo),
            ("Cut", Command::Cut),
            ("Copy", Command::Copy),
            ("Duplicate", Command::Duplicate),
            ("Delete", Command::Delete),
            ("Select all", Command::SelectAll),
        ];
        let graph = [
            ("Add a node …", Command::Add),
            ("Tidy", Command::Tidy),
            ("Frame", Command::Frame),
            ("Note", Command::Note),
            ("Fold", Command::Fold),
            ("All into view", Command::FitGraph),
        ];
        let align = [
            ("Left sides", Command::Align(Align::Left)),
            ("Middles in a column", Command::Align(Align::Centre)),
            ("Right sides", Command::Align(Align::Right)),
            ("Upper sides", Command::Align(Align::Top)),
            ("Middles in a row", Command::Align(Align::Middle)),
            ("Lower sides", Command::Align(Align::Bottom)),
            ("Equal gaps across", Command::Align(Align::Across)),
            ("Equal gaps down", Command::Align(Align::Down)),
        ];
        let view = [
            ("Home", Command::Home),
            ("Read again", Command::ReadAgain),
            ("Section", Command::Section),
            ("Costs and errors", Command::Costs),
            ("Study", Command::Study),
            ("Light or dark", Command::Theme),
            ("Keys and mouse", Command::Help),
        ];
        list(ui, "File", &file);
        list(ui, "Edit", &edit);
        list(ui, "Graph", &graph);
        list(ui, "Align", &align);
        list(ui, "View", &view);
        ui.separator();
        ui.add_enabled_ui(!scene.is_empty(), |ui| {
            for (text, command, help) in [
                ("Save", Command::Save, "save the pipeline"),
                ("▶ Run", Command::Run, "write the files of the pipeline, such as its picture; stops a run"),
            ] {
                let help = format!("{help} ({})", keys::shortcut(ui.ctx(), command));
                if ui.button(text).on_hover_text(help).clicked() {
                    actions.command(command);
                }
            }
        });
        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
            let path = scene.document.path();
            let name =
                path.and_then(Path::file_name).map_or("new pipeline".into(), |name| name.to_string_lossy());
            let mark = if scene.document.is_saved() { "" } else { " • not saved" };
            let name = RichText::new(format!("{name}{mark}")).color(theme::weak(ui.visuals().dark_mode));
            let label = ui.add(Label::new(name).truncate());
            if let Some(path) = path {
                label.on_hover_text(path.display().to_string());
            }
        });
    });
}
