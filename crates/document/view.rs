//! View of a pipeline in the editor, kept in the table `[editor]` of its file: positions, frames, notes, sets of widgets.
//!
//! ```toml
//! [editor]
//! frames = [
//!   { title = "materials", at = [0, 40], size = [420, 260] },
//! ]
//! notes = [
//!   { text = "after Kniss et al.", at = [20, 320] },
//! ]
//!
//! [editor.nodes]
//! grid = [0, 120]
//! look = { at = [220, 40], folded = true, remark = "by hand" }
//! cut = { at = [220, 160], hidden = true }
//!
//! [editor.sets]
//! 3 = [{ kind = "uniform", color = [1.0, 0.5, 0.2], extinction = 4.0, region = { s = [1.0, 2.0] } }]
//! ```
//!
//! Places and sizes are in points of the graph view at its usual scale, to the right and downward, and are written as whole
//! numbers. What is not understood is left as it is.

use std::collections::BTreeMap;
use voltet_graph::{Field, LocatedValue, ParameterValue, find_setting};

/// View of a node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NodeView {
    /// Its place; none where the file gives none.
    pub position: Option<[f64; 2]>,
    /// True if its head alone is shown.
    pub folded: bool,
    /// True if the window's picture leaves out what it adds.
    pub hidden: bool,
    /// Words that stand with it.
    pub remark: Option<String>,
}

/// A frame around nodes, or a note: words anywhere in the graph view.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Annotation {
    /// Title of the frame, or words of the note.
    pub text: String,
    /// Upper left corner.
    pub position: [f64; 2],
    /// Width and height of a frame; none of a note.
    pub size: Option<[f64; 2]>,
    /// Red, green and blue of a frame, 0 to 1; none for the usual colour.
    pub color: Option<[f64; 3]>,
}

/// A frame or a note, by its number among its like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AnnotationId {
    /// A frame.
    Frame(usize),
    /// A note.
    Note(usize),
}

impl AnnotationId {
    /// Its list in the file, the word for it, and its number.
    pub(crate) fn parts(self) -> (&'static str, &'static str, usize) {
        match self {
            AnnotationId::Frame(number) => ("frames", "a frame", number),
            AnnotationId::Note(number) => ("notes", "a note", number),
        }
    }
}

/// All that the table `[editor]` says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct View {
    /// Nodes, by name.
    pub nodes: BTreeMap<String, NodeView>,
    /// Titled rectangles behind nodes, in the order of the file.
    pub frames: Vec<Annotation>,
    /// Notes, in the order of the file.
    pub notes: Vec<Annotation>,
    /// Sets of widgets that a digit recalls into a transfer function, 0 to 9.
    pub sets: BTreeMap<u8, Vec<LocatedValue>>,
}

impl View {
    /// From the keys of the table.
    pub fn read(fields: &[Field]) -> View {
        let list = |name: &str| find_setting(fields, name).and_then(LocatedValue::list).unwrap_or_default();
        let nodes = find_setting(fields, "nodes").and_then(LocatedValue::table).unwrap_or_default();
        View {
            nodes: nodes.iter().map(|field| (field.name.clone(), NodeView::read(&field.setting))).collect(),
            frames: list("frames").iter().map(|setting| Annotation::read(setting, true)).collect(),
            notes: list("notes").iter().map(|setting| Annotation::read(setting, false)).collect(),
            sets: find_setting(fields, "sets")
                .and_then(LocatedValue::table)
                .unwrap_or_default()
                .iter()
                .filter_map(set)
                .collect(),
        }
    }

    /// The frames and then the notes.
    pub fn annotations(&self) -> impl Iterator<Item = (AnnotationId, &Annotation)> {
        let frames = self.frames.iter().enumerate().map(|(i, frame)| (AnnotationId::Frame(i), frame));
        frames.chain(self.notes.iter().enumerate().map(|(i, note)| (AnnotationId::Note(i), note)))
    }
}

fn set(field: &Field) -> Option<(u8, Vec<LocatedValue>)> {
    let digit = field.name.parse().ok().filter(|digit| *digit <= 9 && field.name.len() == 1)?;
    Some((digit, field.setting.list()?.to_vec()))
}

impl NodeView {
    fn read(setting: &LocatedValue) -> NodeView {
        if let Some(fields) = setting.table() {
            let is_set = |name: &str| {
                find_setting(fields, name).is_some_and(|flag| flag.datum == ParameterValue::Boolean(true))
            };
            return NodeView {
                position: numbers(fields, "at"),
                folded: is_set("folded"),
                hidden: is_set("hidden"),
                remark: text(fields, "remark"),
            };
        }
        NodeView { position: setting.array(), ..NodeView::default() }
    }

    /// As the file has it; none where there is nothing to say.
    pub(crate) fn datum(&self) -> Option<ParameterValue> {
        let at = self.position.map(position_value);
        if !self.folded && !self.hidden && self.remark.is_none() {
            return at;
        }
        let [folded, hidden] =
            [self.folded, self.hidden].map(|flag| flag.then_some(ParameterValue::Boolean(true)));
        let remark = self.remark.clone().map(ParameterValue::Text);
        Some(table([("at", at), ("folded", folded), ("hidden", hidden), ("remark", remark)]))
    }
}

impl Annotation {
    fn read(setting: &LocatedValue, is_frame: bool) -> Annotation {
        let fields = setting.table().unwrap_or_default();
        Annotation {
            text: text(fields, if is_frame { "title" } else { "text" }).unwrap_or_default(),
            position: numbers(fields, "at").unwrap_or_default(),
            size: is_frame.then(|| numbers(fields, "size").unwrap_or([200.0, 100.0])),
            color: numbers(fields, "color").filter(|_| is_frame),
        }
    }

    pub(crate) fn datum(&self) -> ParameterValue {
        let color = self.color.map(|color| color.into_iter().collect());
        let key = if self.size.is_some() { "title" } else { "text" };
        table([
            (key, Some(ParameterValue::Text(self.text.clone()))),
            ("at", Some(position_value(self.position))),
            ("size", self.size.map(position_value)),
            ("color", color),
        ])
    }
}

fn text(fields: &[Field], name: &str) -> Option<String> {
    find_setting(fields, name)?.text().map(str::to_string)
}

fn numbers<const N: usize>(fields: &[Field], name: &str) -> Option<[f64; N]> {
    find_setting(fields, name)?.array()
}

/// A place as whole numbers.
pub(crate) fn position_value(at: [f64; 2]) -> ParameterValue {
    // Beyond the range of integers they saturate, which no screen shows.
    at.into_iter().map(|x| ParameterValue::Integer(x.round() as i64)).collect()
}

fn table<const N: usize>(entries: [(&str, Option<ParameterValue>); N]) -> ParameterValue {
    let field = |(name, datum): (&str, Option<ParameterValue>)| Some(Field::new(name, datum?));
    ParameterValue::Table(entries.into_iter().filter_map(field).collect())
}
