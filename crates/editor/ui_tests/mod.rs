//! The window's logic, driven by raw input events without a display.

mod compare;
mod digits;
mod dropped;
mod earlier;
mod expression;
mod eyes;
mod files;
mod first_steps;
mod focus;
mod graph;
mod ground;
mod handles;
mod hits;
mod keyboard;
mod new_nodes;
mod opening;
mod other_array;
mod parameters;
mod picture;
mod probe;
mod recovery;
mod screens;
mod session;
mod slow;
mod templates;
mod time;
mod transfer;
mod transfer_axes;
mod transfer_more;
mod ways_out;

use crate::editor::Editor;
use crate::panes::Layouts;
use crate::scene::Command;
use crate::window::Window;
use eframe::egui::epaint::ClippedShape;
use eframe::egui::{
    Context, Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, TouchPhase, pos2, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use voltet_core::Error;
use voltet_core::progress::Progress;
use voltet_document::Document;
use voltet_graph::{Node, Port, PortType, Registry};

/// A pipeline with comments, drawn in one node.
const TEXT: &str = include_str!("scene.toml");

/// Ports of a node that draws with a transfer function.
const DRAWING: Node = Node {
    inputs: &[Port {
        name: "transfer_function",
        port_type: PortType::TransferFunction,
        summary: "whose changes ask for another picture",
    }],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "a picture" }],
    demand: &|_| Ok(()),
    ..Node::BLANK
};

/// Frames until it is so.
fn until(hand: &mut Hand, what: &str, is_so: impl Fn(&Hand) -> bool) {
    for _ in 0..4000 {
        hand.frames(1);
        if is_so(hand) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("{what}: {}", hand.said());
}

/// A person before a window that is not there; the window's own fields are reached through it.
struct Hand {
    harness: Harness<'static, Window>,
    ctx: Context,
    at: Pos2,
    /// Seconds until the next frame, beside the usual sixtieth.
    pause: f64,
    folder: tempfile::TempDir,
}

impl Deref for Hand {
    type Target = Window;

    fn deref(&self) -> &Window {
        self.harness.state()
    }
}

impl DerefMut for Hand {
    fn deref_mut(&mut self) -> &mut Window {
        self.harness.state_mut()
    }
}

impl Hand {
    fn new(text: &str) -> Hand {
        Self::with_file(text, "unused", "")
    }

    /// Before a window that shows all rows of a transfer function.
    fn in_tall_window(text: &str) -> Hand {
        Self::before_window(text, [1280.0, 960.0], &|_| {})
    }

    /// With another file beside the pipeline.
    fn with_file(text: &str, name: &str, content: &str) -> Hand {
        Self::in_folder(text, &|folder| std::fs::write(folder.join(name), content).unwrap())
    }

    /// With what is written beside the pipeline.
    fn in_folder(text: &str, write: &dyn Fn(&Path)) -> Hand {
        Self::before_window(text, [1280.0, 720.0], write)
    }

    /// Before a window of this width and height, points.
    fn before_window(text: &str, size: [f32; 2], write: &dyn Fn(&Path)) -> Hand {
        let mut registry = voltet_nodes::registry().unwrap();
        voltet_reference::register(&mut registry).unwrap();
        let mut hand = Self::with_registry(text, size, write, &registry);
        hand.settle();
        hand
    }

    /// Before a window that knows these nodes, and has drawn nothing yet.
    fn with_registry(text: &str, size: [f32; 2], write: &dyn Fn(&Path), registry: &Registry) -> Hand {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path());
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let document = Document::open(&path).unwrap();
        let start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Err(Error::usage("no data here")));
        let editor = Editor::new(document, registry, start, Arc::new(|| {})).unwrap();
        let harness = Harness::builder().with_size(size).build_eframe(|context| {
            crate::theme::apply(&context.egui_ctx);
            Window::new(editor, Layouts::default())
        });
        let ctx = harness.ctx.clone();
        Hand { harness, ctx, at: pos2(5.0, 400.0), pause: 0.0, folder }
    }

    /// The window gets another size, points, and the screen another density, pixels a point.
    fn resize(&mut self, size: [f32; 2], pixels_per_point: f32) {
        self.harness.set_size(size.into());
        let input = self.harness.input_mut();
        if let Some(viewport) = input.viewports.get_mut(&input.viewport_id) {
            viewport.native_pixels_per_point = Some(pixels_per_point);
        }
    }

    /// One frame with these events, or more where a button is followed by something.
    fn frame(&mut self, events: Vec<Event>, modifiers: Modifiers) {
        self.frame_with(RawInput { events, ..RawInput::default() }, modifiers);
    }

    /// One frame with the events and dropped files of an input.
    fn frame_with(&mut self, more: RawInput, modifiers: Modifiers) {
        let mut input = std::mem::take(self.harness.input_mut());
        input.time = Some(self.ctx.time() + 1.0 / 60.0 + std::mem::take(&mut self.pause));
        if self.ctx.input(|input| input.modifiers) != modifiers {
            input.events.push(Event::ModifiersChanged(modifiers));
        }
        input.events.extend(more.events);
        input.dropped_files.extend(more.dropped_files);
        input.hovered_files = more.hovered_files;
        let waits = self.presses.cut(&mut input);
        *self.harness.input_mut() = input;
        self.harness.step();
        if waits {
            self.frame(Vec::new(), modifiers);
        }
    }

    /// Gives a command, as a menu does.
    fn command(&mut self, command: Command) {
        let ctx = self.ctx.clone();
        self.editor.command(&ctx, command);
    }

    /// Shapes of the last frame.
    fn shapes(&self) -> &[ClippedShape] {
        &self.harness.output().shapes
    }

    /// Positions of a text in the window: buttons, labels, titles.
    fn texts(&self, text: &str) -> Vec<Pos2> {
        self.shown(&|shown| shown == text)
    }

    /// Positions of texts with this beginning.
    fn shown_beginning(&self, text: &str) -> Vec<Pos2> {
        self.shown(&|shown| shown.starts_with(text))
    }

    fn shown(&self, is_it: &dyn Fn(&str) -> bool) -> Vec<Pos2> {
        fn of(shape: &Shape, is_it: &dyn Fn(&str) -> bool, found: &mut Vec<Pos2>) {
            match shape {
                Shape::Vec(shapes) => shapes.iter().for_each(|shape| of(shape, is_it, found)),
                Shape::Text(shape) if is_it(shape.galley.text()) => {
                    found.push(shape.visual_bounding_rect().center());
                }
                _ => {}
            }
        }
        let mut found = Vec::new();
        self.shapes().iter().for_each(|clipped| of(&clipped.shape, is_it, &mut found));
        found
    }

    /// True if so many textures are drawn.
    fn has_textures(&self, count: usize) -> bool {
        let of = |clipped: &ClippedShape| match &clipped.shape {
            Shape::Rect(shape) => Some(shape.brush.as_ref()?.fill_texture_id),
            Shape::Mesh(mesh) => Some(mesh.texture_id),
            _ => None,
        };
        let all: std::collections::HashSet<_> = self.shapes().iter().filter_map(of).collect();
        all.len() >= count
    }

    /// Places of what has a name: nodes, ports, handles, fields, buttons.
    fn all_named(&self, name: &str) -> Vec<Rect> {
        self.harness.query_all_by_label(name).map(|node| node.rect()).collect()
    }

    fn sees(&self, name: &str) -> bool {
        !self.all_named(name).is_empty()
    }

    /// Place of what has a name.
    fn rect(&self, name: &str) -> Rect {
        let found = self.all_named(name).first().copied();
        found.unwrap_or_else(|| panic!("'{name}' is not in the window: {:?}", self.harness))
    }

    fn named(&self, name: &str) -> Pos2 {
        self.rect(name).center()
    }

    /// Clicks at what has a name.
    fn click_on(&mut self, name: &str) {
        self.click(self.named(name));
        self.frames(2);
    }

    fn frames(&mut self, count: usize) {
        (0..count).for_each(|_| self.frame(Vec::new(), Modifiers::NONE));
    }

    /// Until the picture is there.
    fn settle(&mut self) {
        self.frames(4);
        for _ in 0..4000 {
            if self.editor.worker().shown(|shown| !shown.is_busy) {
                self.frames(2);
                return;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("the worker does not come to an end");
    }

    fn move_to(&mut self, to: Pos2, modifiers: Modifiers) {
        self.at = to;
        self.frame(vec![Event::PointerMoved(to)], modifiers);
    }

    fn button(&mut self, pressed: bool, button: PointerButton, modifiers: Modifiers) {
        self.frame(vec![Event::PointerButton { pos: self.at, button, pressed, modifiers }], modifiers);
    }

    fn click(&mut self, at: Pos2) {
        self.move_to(at, Modifiers::NONE);
        self.button(true, PointerButton::Primary, Modifiers::NONE);
        self.button(false, PointerButton::Primary, Modifiers::NONE);
        self.frames(1);
        // The next one is no double click.
        self.pause = 1.0;
    }

    /// In ten steps, as a hand does.
    fn drag_with(&mut self, from: Pos2, to: Pos2, button: PointerButton, modifiers: Modifiers) {
        self.move_to(from, modifiers);
        self.button(true, button, modifiers);
        for step in 1..=10 {
            self.move_to(from + (to - from) * (step as f32 / 10.0), modifiers);
        }
        self.button(false, button, modifiers);
        self.frames(2);
        self.pause = 1.0;
    }

    fn drag(&mut self, from: Pos2, to: Pos2) {
        self.drag_with(from, to, PointerButton::Primary, Modifiers::NONE);
    }

    fn key(&mut self, key: Key, modifiers: Modifiers) {
        let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        self.frame(vec![event(true)], modifiers);
        self.frame(vec![event(false)], modifiers);
    }

    fn typed(&mut self, text: &str) {
        self.frame(vec![Event::Text(text.into())], Modifiers::NONE);
    }

    fn text(&self) -> String {
        self.editor.document().text().to_string()
    }

    /// Number of steps that can be undone.
    fn steps(&self) -> usize {
        self.editor.document().history().position().0
    }

    fn numbers(&self, node: &str, key: &str) -> Vec<f64> {
        let nodes = &self.editor.document().pipeline().nodes;
        let node = nodes.iter().find(|entry| entry.name == node).unwrap();
        let field = node.settings.iter().find(|field| field.name == key).unwrap();
        field.setting.numbers().unwrap()
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    fn said(&self) -> String {
        self.editor.message.clone().map_or(String::new(), |said| said.text)
    }
}
