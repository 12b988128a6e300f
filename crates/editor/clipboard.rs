//! Nodes to the clipboard and back, as text of a pipeline file; copies beside; and where nodes stand.

use crate::actions::Command;
use crate::editor::Editor;
use crate::graph::Annotation;
use eframe::egui::{Context, Event};
use voltet_core::Result;
use voltet_document::arrange::{PlacedNode, align, tidy};
use voltet_document::{Edit, Frame, Note};
use voltet_graph::NodeEntry;

/// From a node to what is pasted after it, points.
const PASTE_OFFSET: f64 = 40.0;

impl Editor {
    fn selected(&self) -> Vec<String> {
        self.selection.iter().cloned().collect()
    }

    /// The selected nodes as text.
    pub(crate) fn copy(&self, ctx: &Context) {
        if !self.selection.is_empty() {
            ctx.copy_text(self.document.copy(&self.selected()));
        }
    }

    /// Copies of the selected nodes beside them.
    pub(crate) fn duplicate(&mut self) {
        if !self.selection.is_empty() {
            let outcome = self.document.duplicate(&self.selected());
            self.take_copies(outcome);
        }
    }

    /// Takes what the clipboard gives, unless a text field does.
    pub(crate) fn paste(&mut self, ctx: &Context) {
        if ctx.wants_keyboard_input() {
            return;
        }
        let pasted = ctx.input(|input| {
            input.events.iter().find_map(|event| match event {
                Event::Paste(text) => Some(text.clone()),
                _ => None,
            })
        });
        let Some(text) = pasted else { return };
        let at = self.selection.iter().next().map_or([0.0; 2], |name| self.document.position(name));
        let outcome = self.document.paste(&text, at.map(|x| x + PASTE_OFFSET));
        self.take_copies(outcome);
    }

    /// Selects the added nodes.
    fn take_copies(&mut self, outcome: Result<Vec<String>>) {
        match outcome {
            Ok(names) => self.selection = names.into_iter().collect(),
            Err(error) => self.complain(&error),
        }
    }

    /// The selected nodes show their heads alone; all of them, if all do.
    pub(crate) fn fold(&mut self) {
        let views = &self.document.view().nodes;
        let is_folded = |name: &String| views.get(name).is_some_and(|view| view.folded);
        let folded = !self.selection.iter().all(is_folded);
        let other = self.selection.iter().filter(|name| is_folded(name) != folded);
        let edits: Vec<Edit> = other.map(|name| Edit::Fold { node: name.clone(), folded }).collect();
        if !edits.is_empty() {
            self.edit(if folded { "fold" } else { "unfold" }.into(), &edits);
        }
    }

    /// Moves nodes, and adds frames and notes.
    pub(crate) fn arrange_nodes(&mut self, command: Command) {
        let all = &self.document.pipeline().nodes;
        let nodes: Vec<NodeEntry> = match self.selection.is_empty() {
            true => all.clone(),
            false => all.iter().filter(|node| self.selection.contains(&node.name)).cloned().collect(),
        };
        let placed = |node: &NodeEntry| PlacedNode {
            name: node.name.clone(),
            position: self.document.position(&node.name),
            size: self.graph.size_of(&node.name),
        };
        let placed: Vec<PlacedNode> = nodes.iter().map(placed).collect();
        let least = |axis: usize| placed.iter().map(|node| node.position[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| {
            placed.iter().map(|node| node.position[axis] + node.size[axis]).fold(f64::NEG_INFINITY, f64::max)
        };
        let (label, edit) = match command {
            Command::Tidy if !nodes.is_empty() => {
                let places = tidy(&nodes, &|name| self.graph.size_of(name));
                let moved = nodes.iter().zip(places);
                let moved = moved.map(|(node, [x, y])| (node.name.clone(), [x + least(0), y + least(1)]));
                ("tidy", Edit::MoveNodes(moved.collect()))
            }
            Command::Align(how) if nodes.len() > 1 => ("align", Edit::MoveNodes(align(&placed, how))),
            Command::Frame if !self.selection.is_empty() => {
                let at = [least(0) - 20.0, least(1) - 36.0];
                let size = [most(0) + 20.0 - at[0], most(1) + 20.0 - at[1]];
                let count = self.document.view().frames.len();
                let frame = Frame { title: "frame".into(), position: at, size, color: None };
                ("add a frame", Edit::PutFrame(count, frame))
            }
            Command::Note => {
                let count = self.document.view().notes.len();
                let at = if nodes.is_empty() { [0.0, 0.0] } else { [least(0), most(1) + 30.0] };
                ("add a note", Edit::PutNote(count, Note { text: "a note".into(), position: at }))
            }
            _ => return,
        };
        self.edit(label.into(), std::slice::from_ref(&edit));
        match &edit {
            Edit::PutFrame(number, frame) => self.graph.write_on(Annotation::Frame(*number), &frame.title),
            Edit::PutNote(number, note) => self.graph.write_on(Annotation::Note(*number), &note.text),
            _ if command == Command::Tidy => self.graph.fit(),
            _ => {}
        }
    }
}
