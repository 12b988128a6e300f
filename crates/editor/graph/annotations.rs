//! Frames and notes by their numbers, and what a hand does with them.

use eframe::egui::Vec2;
use voltet_document::{Frame, Note};

/// A frame or a note, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Annotation {
    Frame(usize),
    Note(usize),
}

/// Drag of an annotation: its earlier position, and the offset.
#[derive(Debug, Default)]
pub(super) struct AnnotationDrag {
    pub frames: Vec<(usize, Frame)>,
    pub notes: Vec<(usize, Note)>,
    pub nodes: Vec<(String, [f64; 2])>,
    /// The frame changes its size instead.
    pub resizes: bool,
    pub way: Vec2,
}

/// Words that are being written.
#[derive(Debug)]
pub(super) struct Writing {
    pub thing: Annotation,
    pub text: String,
    pub is_new: bool,
}
