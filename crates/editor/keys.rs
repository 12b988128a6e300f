//! The keys: one table, from which they are read and the help sheet is made; the bar at the top: menus, and what is done most; input events:
//! their grouping into undo steps, and those that wait for the next frame.

use crate::scene::{Actions, Command, Scene};
use crate::theme;
use eframe::egui::{
    self, Button, Context, Event, Grid, Key, KeyboardShortcut, Label, Layout, Modifiers, RawInput, RichText,
    ScrollArea, Ui, Vec2, Window, menu, vec2,
};
use std::path::Path;
use std::time::{Duration, Instant};
use voltet_document::Gesture;
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
    (Command::Costs, NONE, Key::C, "times and error of the picture"),
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
            ("drag from a fed input", "detach the wire"),
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
            ("Alt-drag", "the same at a fifth of the speed"),
            ("double click", "add a point to the selected curve or polygon; elsewhere show all"),
            ("right click on a point", "remove it"),
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
pub(crate) fn read(ctx: &Context, over_widgets: bool, actions: &Actions) {
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

pub(crate) fn bar(ui: &mut Ui, scene: &Scene) {
    menu::bar(ui, |ui| {
        let list = |ui: &mut Ui, title: &str, entries: &[(&str, Command)]| {
            ui.menu_button(title, |ui| {
                ui.set_min_width(220.0);
                for (text, command) in entries {
                    let key = shortcut(ui.ctx(), *command);
                    if ui.add(Button::new(*text).shortcut_text(key)).clicked() {
                        scene.actions.command(*command);
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
                    scene.actions.command(command);
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

/// Edits by wheel and keys that follow one another within this time are one step.
const PAUSE: Duration = Duration::from_millis(600);

#[derive(Default)]
pub(crate) struct GestureTracker {
    last: u64,
    pressed: Option<u64>,
    at: Option<(Instant, u64)>,
}

impl GestureTracker {
    fn next(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// The gesture of an edit made now: a mouse button held, or what follows soon after by wheel or key.
    pub fn gesture(&mut self, ctx: &Context) -> Option<Gesture> {
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

/// Events that wait. A button pressed and the pointer moved on within one slow frame: what is taken hold of lies where it was
/// pressed, as is what is let go of. egui looks at a frame's last place alone, so what follows a button waits for the next frame.
#[derive(Default)]
pub(crate) struct InputQueue {
    waiting: Vec<Event>,
}

impl InputQueue {
    /// Leaves of a frame's events, after those that waited, those up to the first press, or those before a release: what is dragged
    /// is brought there first. Whether some wait now, for a frame that is to follow at once.
    pub fn cut(&mut self, input: &mut RawInput) -> bool {
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        let button = |event: &Event| match event {
            Event::PointerButton { pressed, .. } => Some(*pressed),
            _ => None,
        };
        let first = events.iter().enumerate().find_map(|(place, event)| Some((place, button(event)?)));
        if let Some((place, pressed)) = first {
            let moves = events[..place].iter().any(|event| matches!(event, Event::PointerMoved(_)));
            self.waiting = events.split_off(if !pressed && moves { place } else { place + 1 });
        }
        input.events = events;
        !self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Modifiers, PointerButton, pos2};
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

    #[test]
    fn each_button_ends_a_frame_and_nothing_is_lost() {
        let button = |x: f32, pressed| Event::PointerButton {
            pos: pos2(x, 0.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let moved = |x: f32| Event::PointerMoved(pos2(x, 0.0));
        let mut presses = InputQueue::default();
        let mut frame = |events: Vec<Event>| {
            let mut input = RawInput { events, ..RawInput::default() };
            let waits = presses.cut(&mut input);
            (input.events, waits)
        };
        let all = vec![moved(1.0), button(1.0, true), moved(2.0), button(2.0, false), moved(3.0)];
        assert_eq!(frame(all), (vec![moved(1.0), button(1.0, true)], true));
        assert_eq!(frame(vec![moved(4.0)]), (vec![moved(2.0)], true), "it is brought there");
        assert_eq!(frame(vec![]), (vec![button(2.0, false)], true), "and let go of");
        assert_eq!(frame(vec![]), (vec![moved(3.0), moved(4.0)], false));
        assert_eq!(frame(vec![]), (vec![], false));
    }
}
