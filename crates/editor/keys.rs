//! The keys: one table, from which they are read and the help sheet is made; the bar at the top: menus, and what is done most; input events:
//! their grouping into undo steps, and those that wait for the next frame.

use crate::focus::{FollowFocus, Sheet};
use crate::invitation::template_buttons;
use crate::scene::{Actions, Command, Scene, TimeMove};
use crate::theme::{self, Help};
use eframe::egui::{
    self, Button, Context, Event, Grid, Key, KeyboardShortcut, Label, Layout, MenuBar, Modifiers, RawInput,
    RichText, ScrollArea, Ui, Vec2, vec2,
};
use std::path::Path;
use std::time::{Duration, Instant};
use voltet_document::Gesture;
use voltet_document::arrange::Align as How;

/// A command: its menu and the words there; its keys, of which menu and help show the first; and the words for that in help. Empty where
/// there are none.
type Binding = (&'static str, Command, &'static str, &'static [(Modifiers, Key)], &'static str);

const NONE: Modifiers = Modifiers::NONE;
const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };
const SHIFT: Modifiers = Modifiers::SHIFT;

const COMMANDS: &[Binding] = {
    use Command::*;
    &[
        ("File", New, "New", &[(CTRL, Key::N)], "new pipeline"),
        ("File", Example, "Example", &[], ""),
        ("File", Open, "Open …", &[(CTRL, Key::O)], "open a pipeline, a picture with one, or a data file"),
        ("File", Save, "Save", &[(CTRL, Key::S)], "save"),
        ("File", SaveAs, "Save as …", &[(CTRL_SHIFT, Key::S)], "save as"),
        ("File", Run, "Run: write the files", &[(CTRL, Key::R)], "run: write the files; stops a run"),
        ("File", Film, "Film …", &[(SHIFT, Key::A)], "film of the time steps, or of the camera's way"),
        ("File", Quit, "Quit", &[(CTRL, Key::Q)], "quit"),
        ("Edit", Undo, "Undo", &[(CTRL, Key::Z)], "undo"),
        ("Edit", Redo, "Redo", &[(CTRL_SHIFT, Key::Z), (CTRL, Key::Y)], "redo"),
        ("Edit", Cut, "Cut", &[(CTRL, Key::X)], "cut the selected nodes"),
        ("Edit", Copy, "Copy", &[(CTRL, Key::C)], "copy the selected nodes, as text of the file"),
        ("Edit", Duplicate, "Duplicate", &[(CTRL, Key::D)], "duplicate the selected nodes"),
        (
            "Edit",
            Delete,
            "Delete",
            &[(NONE, Key::Delete), (NONE, Key::Backspace)],
            "delete the selected nodes, or the widget that was selected after them",
        ),
        ("Edit", SelectAll, "Select all", &[(CTRL, Key::A)], "select all nodes"),
        (
            "Graph",
            Add,
            "Add a node …",
            &[(NONE, Key::Space)],
            "add a node: type to search, Enter takes the first",
        ),
        (
            "Graph",
            Wire,
            "Wire …",
            &[(NONE, Key::J)],
            "wire of the selected node: type to search, Enter takes the first",
        ),
        (
            "Graph",
            Edit,
            "Parameters",
            &[(NONE, Key::Enter)],
            "to the parameters of the selected node; Escape: back",
        ),
        (
            "",
            Step(1, 0),
            "",
            &[(NONE, Key::ArrowRight)],
            "select the next node to the right; so do the other arrows",
        ),
        ("", Step(-1, 0), "", &[(NONE, Key::ArrowLeft)], ""),
        ("", Step(0, 1), "", &[(NONE, Key::ArrowDown)], ""),
        ("", Step(0, -1), "", &[(NONE, Key::ArrowUp)], ""),
        (
            "",
            Shift(1, 0),
            "",
            &[(SHIFT, Key::ArrowRight)],
            "move the selected nodes to the right; so do the other arrows",
        ),
        ("", Shift(-1, 0), "", &[(SHIFT, Key::ArrowLeft)], ""),
        ("", Shift(0, 1), "", &[(SHIFT, Key::ArrowDown)], ""),
        ("", Shift(0, -1), "", &[(SHIFT, Key::ArrowUp)], ""),
        ("Graph", Tidy, "Tidy", &[(NONE, Key::L)], "tidy: lay the nodes out"),
        ("Graph", Frame, "Frame", &[(CTRL, Key::G)], "frame around the selected nodes"),
        ("Graph", Note, "Note", &[(NONE, Key::N)], "note in the graph"),
        ("Graph", Fold, "Fold", &[(NONE, Key::B)], "fold the selected nodes, or unfold them"),
        (
            "Graph",
            Eye,
            "Show in the picture, or not",
            &[(NONE, Key::E)],
            "take what the selected nodes add out of the picture, or bring it back",
        ),
        ("Graph", FitGraph, "All into view", &[(NONE, Key::F)], "all nodes into view"),
        ("Align", Align(How::Left), "Left sides", &[(SHIFT, Key::L)], "align the selected nodes in a column"),
        ("Align", Align(How::Centre), "Middles in a column", &[], ""),
        ("Align", Align(How::Right), "Right sides", &[], ""),
        ("Align", Align(How::Top), "Upper sides", &[], ""),
        ("Align", Align(How::Middle), "Middles in a row", &[], ""),
        ("Align", Align(How::Bottom), "Lower sides", &[], ""),
        ("Align", Align(How::Across), "Equal gaps across", &[], ""),
        ("Align", Align(How::Down), "Equal gaps down", &[], ""),
        ("View", Home, "Home", &[(NONE, Key::H)], "all of the data into the picture"),
        ("View", Along(0, true), "From +x", &[(NONE, Key::X)], "seen from +x"),
        ("View", Along(1, true), "From +y", &[(NONE, Key::Y)], "seen from +y"),
        ("View", Along(2, true), "From +z", &[(NONE, Key::Z)], "seen from +z"),
        ("View", Along(0, false), "From −x", &[(SHIFT, Key::X)], "seen from −x"),
        ("View", Along(1, false), "From −y", &[(SHIFT, Key::Y)], "seen from −y"),
        ("View", Along(2, false), "From −z", &[(SHIFT, Key::Z)], "seen from −z"),
        (
            "View",
            Isometric,
            "Isometric",
            &[(NONE, Key::I)],
            "seen from the positive sides of x, y and z alike",
        ),
        ("", Roll(true), "", &[(NONE, Key::Comma)], "roll to the left"),
        ("", Roll(false), "", &[(NONE, Key::Period)], "roll to the right"),
        ("View", ReadAgain, "Read again", &[(NONE, Key::F5)], "read again what other programs wrote anew"),
        ("View", Section, "Section", &[(NONE, Key::K)], "section: s on a plane through the data"),
        ("View", Costs, "Costs and errors", &[(NONE, Key::C)], "times and error of the picture"),
        ("View", Study, "Study", &[(NONE, Key::U)], "study: error against time of every integrator"),
        (
            "",
            Widgets,
            "",
            &[(NONE, Key::W)],
            "keys for the widgets wherever the pointer is; again or Escape: no more",
        ),
        ("View", Strip, "Frames", &[(NONE, Key::M)], "strip of frames, for a way of the camera"),
        ("", Time(TimeMove::Play), "", &[(NONE, Key::A)], "play the time steps, or stop"),
        ("", Time(TimeMove::Previous), "", &[(NONE, Key::OpenBracket)], "time step before"),
        ("", Time(TimeMove::Next), "", &[(NONE, Key::CloseBracket)], "time step after"),
        ("", Time(TimeMove::First), "", &[(NONE, Key::Home)], "first time step"),
        ("", Time(TimeMove::Last), "", &[(NONE, Key::End)], "last time step"),
        ("View", Theme, "Light or dark", &[(NONE, Key::T)], "light or dark"),
        (
            "View",
            Zoom(1),
            "Larger",
            &[(CTRL, Key::Plus), (CTRL, Key::Equals)],
            "everything in the window larger",
        ),
        ("View", Zoom(-1), "Smaller", &[(CTRL, Key::Minus)], "everything in the window smaller"),
        ("View", Zoom(0), "Usual size", &[(CTRL, Key::Num0)], "everything in the window at its usual size"),
        ("View", Help, "Keys and mouse", &[(NONE, Key::F1)], "this sheet"),
    ]
};

/// Actions of the mouse, and keys over the widgets, for the help sheet.
const MOUSE: &[(&str, &[(&str, &str)])] = &[
    (
        "Picture",
        &[
            ("drag", "orbit"),
            ("Shift-drag, middle drag", "pan"),
            ("Ctrl-drag", "roll"),
            ("wheel, right drag", "zoom to the pointer"),
            ("double click", "pick the centre to orbit about"),
            ("rest", "s, g, cell and point of the first hit"),
            ("click", "pick the cell; probe: the values on the ray"),
            ("Alt-drag", "probe: the values on rays through a box"),
            ("drag by \"outline\"", "probe: the values in what is drawn"),
            ("drag a grip of a clip or slice", "move or turn it; so do arrows in small steps"),
            ("right click", "menu"),
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
            ("right click", "menu; on the ground, as a double click, of nodes"),
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
            ("double click", "a point more on the curve or polygon; elsewhere show all"),
            ("right click on a point", "remove it; elsewhere: menu"),
            ("wheel, Alt-wheel", "zoom to the right, zoom up"),
            ("Shift-drag", "pan"),
            ("arrows", "nudge the point or widget; Shift: five times, Alt: a fifth"),
            ("PageUp, PageDown", "choose another widget; with Shift: its place in the list"),
            ("P, Ctrl+D, Delete", "add at the peak, duplicate, take away"),
            ("V, S", "hide, show alone"),
            ("Ctrl+1 … 9, 1 … 9", "store (in the file) and recall the widgets"),
        ],
    ),
];

/// Reads the keys that no text field wants, nor a button that has the focus. `of_widgets`: what is moved and duplicated, and what is
/// deleted, is a widget then, not a node; `is_held`: something else than a node of the graph has the focus.
pub(crate) fn read(ctx: &Context, of_widgets: [bool; 2], is_held: bool, actions: &Actions) {
    let typing = ctx.text_edit_focused();
    ctx.input_mut(|input| {
        // Longer combinations first: a key with Shift is not the key alone.
        for (command, modifiers, key) in keys(true).chain(keys(false)) {
            // In a text field keys are letters, but for those of the window's own business.
            let anywhere = matches!(
                command,
                Command::Save | Command::SaveAs | Command::Open | Command::Run | Command::Help
            );
            let is_for_widgets = match command {
                Command::Duplicate | Command::Step(..) | Command::Shift(..) => of_widgets[0],
                Command::Delete => of_widgets[1],
                _ => false,
            };
            // A button takes these where it has the focus.
            let is_for_focus = is_held
                && matches!(
                    key,
                    Key::Space
                        | Key::Enter
                        | Key::ArrowRight
                        | Key::ArrowLeft
                        | Key::ArrowDown
                        | Key::ArrowUp
                );
            let is_free = !is_for_widgets && !is_for_focus;
            if (!typing || anywhere) && is_free && input.consume_key(modifiers, key) {
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

/// Commands with their keys, those with Shift or those without.
fn keys(shift: bool) -> impl Iterator<Item = (Command, Modifiers, Key)> {
    let of = |&(_, command, _, keys, _): &Binding| keys.iter().map(move |&(held, key)| (command, held, key));
    COMMANDS.iter().flat_map(of).filter(move |(_, held, _)| held.shift == shift)
}

fn shortcut(ctx: &Context, keys: &[(Modifiers, Key)]) -> String {
    let text = |&(held, key): &(Modifiers, Key)| {
        let text = ctx.format_shortcut(&KeyboardShortcut::new(held, key));
        // A key of a sign is named by it.
        let sign = Some(key.symbol_or_name()).filter(|sign| sign.is_ascii() && sign.len() == 1);
        sign.map_or_else(|| text.clone(), |sign| text.replace(key.name(), sign))
    };
    keys.first().map(text).unwrap_or_default()
}

pub(crate) fn bar(ui: &mut Ui, scene: &Scene) {
    MenuBar::new().ui(ui, |ui| {
        let history = scene.document.history();
        for title in ["File", "Edit", "Graph", "Align", "View"] {
            ui.menu_button(title, |ui| {
                ui.set_min_width(220.0);
                for (_, command, text, keys, _) in COMMANDS.iter().filter(|row| row.0 == title) {
                    let step = match command {
                        Command::Undo => history.undo_label(),
                        Command::Redo => history.redo_label(),
                        _ => None,
                    };
                    let text = step.map_or(text.to_string(), |step| format!("{text}: {step}"));
                    if ui.add(Button::new(text).shortcut_text(shortcut(ui.ctx(), keys))).clicked() {
                        scene.actions.command(*command);
                        ui.close();
                    }
                    if *command == Command::Example {
                        ui.menu_button("Template", |ui| template_buttons(ui, scene));
                    }
                }
            });
        }
        ui.separator();
        ui.add_enabled_ui(!scene.is_empty(), |ui| {
            for (text, command, help) in [
                ("Save", Command::Save, "save the pipeline (Ctrl+S)"),
                (
                    "▶ Run",
                    Command::Run,
                    "write the files of the pipeline, such as its picture; stops a run (Ctrl+R)",
                ),
            ] {
                if ui.button(text).help(help).clicked() {
                    scene.actions.command(command);
                }
            }
        });
        ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
            let path = scene.document.path();
            let name =
                path.and_then(Path::file_name).map_or("new pipeline".into(), |name| name.to_string_lossy());
            let mark = if scene.document.is_unwritten() { " • not saved" } else { "" };
            let name = RichText::new(format!("{name}{mark}")).color(theme::weak(ui.visuals().dark_mode));
            let label = ui.add(Label::new(name).truncate());
            if let Some(path) = path {
                label.help(path.display().to_string());
            }
        });
    });
}

/// The keys with the words for them.
fn rows(ctx: &Context) -> Vec<(String, &'static str)> {
    let known = COMMANDS.iter().filter(|row| !row.4.is_empty());
    let others: [(&[(Modifiers, Key)], &str); 3] = [
        (&[(CTRL, Key::V)], "paste nodes"),
        (&[(NONE, Key::Tab)], "to the next node, grip, field or button; Shift+Tab: the one before"),
        (&[(NONE, Key::Escape)], "out of a field, menu, sheet, question, mode or comparison; stops playing"),
    ];
    let all = known.map(|&(_, _, _, keys, words)| (keys, words)).chain(others);
    all.map(|(keys, words)| (shortcut(ctx, keys), words)).collect()
}

/// Width of the help sheet with two columns, points.
const SHEET_WIDTH: f32 = 1140.0;

/// Places in [`MOUSE`] that stand below the keys of each of two columns.
const BELOW_KEYS: [&[usize]; 2] = [&[1], &[0, 2]];

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
    let all = rows(ctx);
    let keys: Vec<(&str, &str)> = all.iter().map(|(keys, words)| (keys.as_str(), *words)).collect();
    let room = ctx.content_rect().size() - vec2(60.0, 90.0);
    // Two columns of like lengths where there is room, else one.
    let is_wide = room.x > SHEET_WIDTH;
    let rows_below = |places: &[usize]| places.iter().map(|place| MOUSE[*place].1.len() + 1).sum::<usize>();
    let [left, right] = BELOW_KEYS.map(rows_below);
    let first = if is_wide { (keys.len() + right).saturating_sub(left).div_ceil(2) } else { keys.len() };
    let column = |ui: &mut Ui, keys: &[(&str, &str)], places: &[usize]| {
        ui.vertical(|ui| {
            keys.first().inspect(|(key, _)| grid(ui, key, keys));
            for (place, rows) in places.iter().map(|place| MOUSE[*place]) {
                ui.add_space(4.0);
                ui.strong(place);
                grid(ui, place, rows);
            }
        });
    };
    let (layout, width) = match is_wide {
        true => (Layout::left_to_right(egui::Align::Min), SHEET_WIDTH),
        false => (Layout::top_down(egui::Align::Min), 0.55 * SHEET_WIDTH),
    };
    let window = Sheet::KEYS.window().open(open).resizable(true);
    window.default_size([room.x.min(width), room.y]).show(ctx, |ui| {
        ScrollArea::both().max_height(room.y).max_width(room.x).show_followed(ui, |ui| {
            ui.with_layout(layout, |ui| {
                let (before, after) = keys.split_at(first.min(keys.len()));
                match is_wide {
                    true => {
                        column(ui, before, BELOW_KEYS[0]);
                        ui.add_space(12.0);
                        column(ui, after, BELOW_KEYS[1]);
                    }
                    false => column(ui, before, &[0, 1, 2]),
                }
            });
        });
    });
}

/// Name of the file that a hand holds over the window.
pub(crate) fn held_over(ctx: &Context) -> Option<String> {
    let path = ctx.input(|input| input.raw.hovered_files.first()?.path.clone())?;
    Some(path.file_name()?.to_string_lossy().into_owned())
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
    /// A gesture of its own.
    pub fn begin(&mut self) -> Gesture {
        Gesture(self.next())
    }

    fn next(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// Ends a gesture of keys: what they do next is another one. True unless a hand is at the mouse, whose gesture goes on.
    pub fn end_of_keys(&mut self) -> bool {
        self.at = None;
        self.pressed.is_none()
    }

    /// The gesture of an edit made now: a mouse button held, or what follows soon after by wheel or key.
    pub fn gesture(&mut self, ctx: &Context) -> Option<Gesture> {
        let (down, pressed, released, repeated) = ctx.input(|input| {
            let pointer = &input.pointer;
            let wheel = input.smooth_scroll_delta != Vec2::ZERO || input.zoom_delta() != 1.0;
            let arrows = [Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown];
            // A short press may begin and end within a frame.
            let nudged =
                arrows.iter().any(|key| input.keys_down.contains(key) || input.num_presses(*key) > 0);
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

/// Queue of input events, of which each frame gets those up to the first button event. egui looks at the last position of a frame alone:
/// in a slow frame, in which a button goes down and the pointer moves on, it would take hold of what lies elsewhere.
#[derive(Default)]
pub(crate) struct InputQueue {
    waiting: Vec<Event>,
}

impl InputQueue {
    /// Leaves the queued events and those of the frame up to the first press, or up to before a release where the pointer moved, so that
    /// a drag is carried out first; the rest waits. Returns true if some wait, for a frame that is to follow at once.
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
            keys(true).chain(keys(false)).map(|(_, held, key)| format!("{held:?} {key:?}")).collect();
        assert_eq!(keys.len(), COMMANDS.iter().map(|row| row.3.len()).sum::<usize>());
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
    fn a_press_that_begins_and_ends_within_a_frame_goes_on_with_those_before() {
        let ctx = Context::default();
        let key = |pressed| Event::Key {
            key: Key::ArrowUp,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        ctx.begin_pass(RawInput { events: vec![key(true), key(false)], ..RawInput::default() });
        assert!(GestureTracker::default().gesture(&ctx).is_some());
        let _ = ctx.end_pass();
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
        let mut queue = InputQueue::default();
        let mut frame = |events: Vec<Event>| {
            let mut input = RawInput { events, ..RawInput::default() };
            let waits = queue.cut(&mut input);
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
