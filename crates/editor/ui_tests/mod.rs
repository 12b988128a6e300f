//! The window's logic, driven by raw input events without a display.

mod digits;
mod earlier;
mod files;
mod graph;
mod ground;
mod parameters;
mod picture;
mod probe;
mod recovery;
mod screens;
mod session;
mod transfer;
mod transfer_axes;
mod transfer_more;

use crate::editor::Editor;
use crate::keys::InputQueue;
use eframe::egui::epaint::ClippedShape;
use eframe::egui::{Context, Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, pos2, vec2};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use voltet_core::Error;
use voltet_document::Document;

/// A pipeline with comments, drawn in one node.
const TEXT: &str = include_str!("scene.toml");

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

/// A person before a window that is not there.
struct Hand {
    ctx: Context,
    editor: Editor,
    at: Pos2,
    time: f64,
    /// Width and height of the window in points, and the screen's pixels a point.
    screen: ([f32; 2], f32),
    presses: InputQueue,
    /// Shapes of the last frame.
    shapes: Vec<ClippedShape>,
    folder: tempfile::TempDir,
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
        let folder = tempfile::tempdir().unwrap();
        write(folder.path());
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let document = Document::open(&path).unwrap();
        let start = Arc::new(|_: &Path, _: &Path| Err(Error::usage("no data here")));
        let mut registry = voltet_nodes::registry().unwrap();
        voltet_reference::register(&mut registry).unwrap();
        let editor = Editor::new(document, &registry, start, Arc::new(|| {})).unwrap();
        let ctx = Context::default();
        crate::theme::apply(&ctx);
        let mut hand = Hand {
            ctx,
            editor,
            at: pos2(5.0, 400.0),
            time: 0.0,
            screen: (size, 1.0),
            presses: InputQueue::default(),
            shapes: Vec::new(),
            folder,
        };
        hand.settle();
        hand
    }

    /// One frame with these events, or more where a button is followed by something.
    fn frame(&mut self, events: Vec<Event>, modifiers: Modifiers) {
        self.time += 1.0 / 60.0;
        let ([width, height], pixels_per_point) = self.screen;
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(width, height))),
            time: Some(self.time),
            events,
            modifiers,
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&input.viewport_id) {
            viewport.native_pixels_per_point = Some(pixels_per_point);
        }
        let waits = self.presses.cut(&mut input);
        let editor = &mut self.editor;
        self.shapes = self.ctx.run(input, |ctx| editor.frame(ctx)).shapes;
        if waits {
            self.frame(Vec::new(), modifiers);
        }
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
        self.shapes.iter().for_each(|clipped| of(&clipped.shape, is_it, &mut found));
        found
    }

    /// True if so many textures are drawn.
    fn has_textures(&self, count: usize) -> bool {
        let of = |clipped: &ClippedShape| match &clipped.shape {
            Shape::Rect(shape) => Some(shape.fill_texture_id),
            Shape::Mesh(mesh) => Some(mesh.texture_id),
            _ => None,
        };
        let all: std::collections::HashSet<_> = self.shapes.iter().filter_map(of).collect();
        all.len() >= count
    }

    /// Clicks at a text.
    fn click_on(&mut self, text: &str) {
        let at = self.texts(text).first().copied().unwrap_or_else(|| panic!("'{text}' is not in the window"));
        self.click(at);
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
        self.time += 1.0;
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
        self.time += 1.0;
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
        self.editor.message.clone().map_or(String::new(), |(text, _)| text)
    }
}
