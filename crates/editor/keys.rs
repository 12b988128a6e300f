//! The keys: one table, from which they are read and the help sheet is made; and the bar at the top: menus, and what is done most.

use crate::actions::{Actions, Command};
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{
    self, Button, Context, Event, Grid, Key, KeyboardShortcut, Label, Layout, Modifiers, RichText,
    ScrollArea, Ui, Window, menu, vec2,
};
use std::path::Path;
use voltet_document::arrange::Align;

/// A key of the window: what it does, and the words for it. Where a command has several, help shows the first.
type Binding = (Command, Modifiers, Key, &'static str);

const NONE: Modifiers = Modifiers::NONE;
const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };
const SHIFT: Modifiers = Modifiers::SHIFT;

/// Longer combinations first: a key with Shift is not the key alone.
const KEYS: &[Binding] = &[
    (Command::New, CTRL, Key::N, "new pipeline"),
    (Command::Open, CTRL, Key::O, "open a pipeline, a picture that carries one, or a data file"),
    (Command::SaveAs, CTRL_SHIFT, Key::S, "save as"),
    (Command::Save, CTRL, Key::S, "save"),
    (Command::Run, CTRL, Key::R, "run: write the files of the pipeline; stops a run"),
    (Command::ReadAgain, NONE, Key::F5, "read again what other programs wrote anew"),
    (Command::Quit, CTRL, Key::Q, "quit"),
    (Command::Redo, CTRL_SHIFT, Key::Z, "redo"),
    (Command::Redo, CTRL, Key::Y, "redo"),
    (Command::Undo, CTRL, Key::Z, "undo"),
    (Command::Duplicate, CTRL, Key::D, "duplicate the selected nodes"),
    (Command::SelectAll, CTRL, Key::A, "select all nodes"),
    (Command::Frame, CTRL, Key::G, "frame around the selected nodes"),
    (Command::Delete, NONE, Key::Delete, "delete the selected nodes"),
    (Command::Delete, NONE, Key::Backspace, "delete the selected nodes"),
    (Command::Add, NONE, Key::Space, "add a node: type to search, Enter takes the first"),
    (Command::Add, NONE, Key::Tab, "add a node"),
    (Command::Tidy, NONE, Key::L, "tidy: lay the nodes out"),
    (
        Command::Align(Align::Left),
        SHIFT,
        Key::L,
        "align the selected nodes in a column; other ways in the menu",
    ),
    (Command::Fold, NONE, Key::B, "fold the selected nodes, or unfold them"),
    (Command::Note, NONE, Key::N, "note in the graph"),
    (Command::FitGraph, NONE, Key::F, "all nodes into view"),
    (Command::Home, NONE, Key::H, "all of the data into the picture"),
    (Command::Along(0, false), SHIFT, Key::X, "seen from −x"),
    (Command::Along(1, false), SHIFT, Key::Y, "seen from −y"),
    (Command::Along(2, false), SHIFT, Key::Z, "seen from −z"),
    (Command::Along(0, true), NONE, Key::X, "seen from +x"),
    (Command::Along(1, true), NONE, Key::Y, "seen from +y"),
    (Command::Along(2, true), NONE, Key::Z, "seen from +z"),
    (Command::Roll(true), NONE, Key::Comma, "roll to the left"),
    (Command::Roll(false), NONE, Key::Period, "roll to the right"),
    (Command::Costs, NONE, Key::C, "what the picture costs, and how wrong it is"),
    (
        Command::Widgets,
        NONE,
        Key::W,
        "keys for the widgets wherever the pointer is; again or Escape: no more",
    ),
    (Command::Section, NONE, Key::K, "section: s on a plane through the data"),
    (Command::Study, NONE, Key::U, "study: error against time of every integrator"),
    (Command::Theme, NONE, Key::T, "light or dark"),
    (Command::Help, NONE, Key::F1, "this sheet"),
];

/// Actions of the mouse, for the help sheet.
const MOUSE: &[(&str, &[(&str, &str)])] = &[
    (
        "Picture",
        &[
            ("drag", "orbit"),
            ("Shift-drag, middle drag", "pan"),
            ("Ctrl-drag", "roll"),
            ("wheel, right drag", "zoom to the pointer"),
            ("double click", "pick the centre to orbit about"),
            ("click", "probe: the values on the ray"),
            ("Alt-drag", "probe: the values on rays through a box"),
        ],
    ),
    (
        "Graph",
        &[
            ("drag a node", "move it, and all that are selected"),
            ("drag from a port", "wire; dropped on empty space: nodes that fit"),
            ("drag from a fed input", "take the wire off"),
            ("drag on empty space", "select nodes in a box"),
            ("drag the title of a frame", "move it with what it holds; its corner: its size"),
            ("double click on a title, a note", "write on it"),
            ("right click, double click", "add a node"),
            ("middle drag, Ctrl-drag", "pan"),
            ("wheel", "zoom to the pointer"),
            ("double click on a node", "show its picture"),
        ],
    ),
    (
        "Transfer function",
        &[
            ("drag a widget", "move it; its handles: widths, angle, corners, bands"),
            ("Alt-drag", "the same, a fifth of the hand's way"),
            ("double click", "a point more of the curve or polygon in hand; else show all"),
            ("right click on a point", "take it away"),
            ("wheel, Alt-wheel", "zoom to the right, zoom up"),
            ("Shift-drag", "pan"),
            ("arrows", "nudge the point or widget; Shift: five times, Alt: a fifth"),
            ("PageUp, PageDown", "choose another widget; with Shift: its place in the list"),
            ("P, Ctrl+D, Delete", "add at the peak, duplicate, take away"),
            ("V, S", "hide, show alone"),
            ("Ctrl+0 … 9, 0 … 9", "store (in the file) and recall the widgets"),
        ],
    ),
];

/// Reads the keys that no text field wants. `over_widgets`: what is deleted and duplicated is a widget then, not a node.
pub(crate) fn read(ctx: &Context, over_widgets: bool, actions: &mut Actions) {
    let typing = ctx.wants_keyboard_input();
    ctx.input_mut(|input| {
        for &(command, modifiers, key, _) in KEYS {
            // In a text field keys are letters, but for those of the window's own business.
            let anywhere = matches!(
                command,
                Command::Save | Command::SaveAs | Command::Open | Command::Run | Command::Help
            );
            let of_widgets = over_widgets && matches!(command, Command::Delete | Command::Duplicate);
            if (!typing || anywhere) && !of_widgets && input.consume_key(modifiers, key) {
                actions.command(command);
            }
        }
        if typing {
            return;
        }
        for event in &input.events {
            match event {
                Event::Copy => actions.command(Command::Copy),
                Event::Cut => actions.command(Command::Cut),
                _ => {}
            }
        }
    });
}

/// The key of a command as menus show it.
fn shortcut(ctx: &Context, command: Command) -> String {
    match command {
        Command::Copy => return "Ctrl+C".into(),
        Command::Cut => return "Ctrl+X".into(),
        _ => {}
    }
    let binding = KEYS.iter().find(|binding| binding.0 == command);
    binding.map_or(String::new(), |&(_, modifiers, key, _)| {
        ctx.format_shortcut(&KeyboardShortcut::new(modifiers, key))
    })
}

/// The menus, what is done most at a click, and the file.
pub(crate) fn bar(ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
    menu::bar(ui, |ui| {
        let mut list = |ui: &mut Ui, title: &str, entries: &[(&str, Command)]| {
            ui.menu_button(title, |ui| {
                ui.set_min_width(220.0);
                for (text, command) in entries {
                    let key = shortcut(ui.ctx(), *command);
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
                let help = format!("{help} ({})", shortcut(ui.ctx(), command));
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

/// The keys with the words for them; of a command that has several, the first.
fn rows(ctx: &Context) -> Vec<(String, &'static str)> {
    let mut rows = Vec::new();
    let mut last = None;
    for &(command, modifiers, key, words) in KEYS {
        if last.replace(command) != Some(command) {
            rows.push((ctx.format_shortcut(&KeyboardShortcut::new(modifiers, key)), words));
        }
    }
    rows.push(("Ctrl+C, X, V".into(), "copy, cut, paste nodes (as text of the file)"));
    rows
}

/// The help sheet: the keys, and beside them what the mouse does.
pub(crate) fn sheet(ctx: &Context, open: &mut bool) {
    let grid = |ui: &mut Ui, name: &str, rows: &[(&str, &str)]| {
        Grid::new(name).num_columns(2).striped(true).min_row_height(0.0).spacing([10.0, 2.0]).show(
            ui,
            |ui| {
                for (hand, words) in rows {
                    ui.label(RichText::new(*hand).monospace());
                    ui.label(*words);
                    ui.end_row();
                }
            },
        );
    };
    let room = ctx.screen_rect().size() - vec2(60.0, 90.0);
    Window::new("Keys and mouse").open(open).resizable(true).default_size([room.x.min(1090.0), room.y]).show(
        ctx,
        |ui| {
            ScrollArea::both().max_height(room.y).max_width(room.x).show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    let all = rows(ctx);
                    let keys: Vec<(&str, &str)> =
                        all.iter().map(|(keys, words)| (keys.as_str(), *words)).collect();
                    ui.vertical(|ui| grid(ui, "keys", &keys));
                    ui.add_space(12.0);
                    ui.vertical(|ui| {
                        for (place, rows) in MOUSE {
                            ui.strong(*place);
                            grid(ui, place, rows);
                            ui.add_space(4.0);
                        }
                    });
                });
            });
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_key_means_two_things() {
        let keys: BTreeSet<String> =
            KEYS.iter().map(|(_, modifiers, key, _)| format!("{modifiers:?} {key:?}")).collect();
        assert_eq!(keys.len(), KEYS.len());
    }

    #[test]
    fn the_page_about_the_editor_has_every_key_and_what_the_mouse_does() {
        let page = include_str!("../../docs/src/reference/editor-keys.md");
        let mut lines = Vec::new();
        lines.extend(rows(&Context::default()).iter().map(|(keys, words)| format!("| {keys} | {words} |")));
        for (place, rows) in MOUSE {
            lines.extend(
                rows.iter().map(|(hand, words)| format!("| {} | {hand} | {words} |", place.to_lowercase())),
            );
        }
        let missing: Vec<&String> = lines.iter().filter(|line| !page.contains(line.as_str())).collect();
        assert!(missing.is_empty(), "docs/src/reference/editor-keys.md lacks\n{missing:#?}");
    }
}
