//! Nodes to the clipboard and back, as text of a pipeline file; copies beside; and where nodes stand.

use crate::actions::Command;
use crate::editor::Editor;
use eframe::egui::{Context, Event};
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::graph::NodeEntry;
use voltet_core::pipeline::Pipeline;
use voltet_document::{Document, Edit, Frame, Note, links};

/// How far copies stand from what they are copies of, points.
const BESIDE: f64 = 40.0;

/// From the top of one aligned node to the next, points.
const ROW: f64 = 140.0;

impl Editor {
    fn selected(&self) -> Vec<NodeEntry> {
        let nodes = &self.document.pipeline().nodes;
        nodes.iter().filter(|node| self.selection().contains(&node.name)).cloned().collect()
    }

    /// The selected nodes as text.
    pub(crate) fn copy(&self, ctx: &Context) {
        let nodes = self.selected();
        if !nodes.is_empty() {
            ctx.copy_text(Pipeline { title: None, nodes }.to_string());
        }
    }

    /// Copies of the selected nodes beside them.
    pub(crate) fn duplicate(&mut self) {
        let nodes = self.selected();
        self.put(&nodes, "duplicate");
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
        match Pipeline::parse(&text) {
            Ok(pipeline) => self.put(&pipeline.nodes, "paste"),
            Err(_) => self.message = Some(("the clipboard holds no nodes of a pipeline".into(), true)),
        }
    }

    /// Adds copies. Wires among them lead to the copies, others to what they led to where it is there.
    fn put(&mut self, nodes: &[NodeEntry], verb: &str) {
        let mut taken: BTreeSet<String> =
            self.document.pipeline().nodes.iter().map(|node| node.name.clone()).collect();
        let before = taken.clone();
        let mut names = BTreeMap::new();
        for node in nodes {
            let mut name = self.document.free_name(&node.name);
            // Several copies of like names must not meet.
            for number in 2.. {
                if !taken.contains(&name) {
                    break;
                }
                name = format!("{}_{number}", node.name);
            }
            taken.insert(name.clone());
            names.insert(node.name.clone(), name);
        }
        let (mut added, mut wired) = (Vec::new(), Vec::new());
        for node in nodes {
            let Some(name) = names.get(&node.name) else { continue };
            let [x, y] = self.document.position(&node.name);
            added.push(Edit::AddNode {
                name: name.clone(),
                node_type: node.node_type.text().unwrap_or_default().to_string(),
                settings: node.settings.clone(),
                at: Some([x + BESIDE, y + BESIDE]),
            });
            for link in &node.inputs {
                for text in links::sources(link) {
                    let (feeding, output) = links::source(text, nodes);
                    let source = match names.get(feeding) {
                        Some(copy) => output.map_or(copy.clone(), |output| format!("{copy}.{output}")),
                        None if before.contains(feeding) => text.to_string(),
                        None => continue,
                    };
                    let beside = link.source.list().is_some();
                    wired.push(Edit::Connect { node: name.clone(), port: link.port.clone(), source, beside });
                }
            }
        }
        let label = match nodes {
            [] => return,
            [one] => format!("{verb} '{}'", one.name),
            many => format!("{verb} {} nodes", many.len()),
        };
        added.extend(wired);
        self.edit(label, &added);
    }

    /// Where nodes stand, frames and notes.
    pub(crate) fn arrange(&mut self, command: Command) {
        let nodes = match self.selection().is_empty() {
            true => self.document.pipeline().nodes.clone(),
            false => self.selected(),
        };
        let at = |editor: &Editor| -> Vec<[f64; 2]> {
            nodes.iter().map(|node| editor.document.position(&node.name)).collect()
        };
        let places = at(self);
        let least = |axis: usize| places.iter().map(|at| at[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| places.iter().map(|at| at[axis]).fold(f64::NEG_INFINITY, f64::max);
        match command {
            Command::Tidy if !nodes.is_empty() => {
                // A document without places lays its nodes out.
                let text = Pipeline { title: None, nodes: nodes.clone() }.to_string();
                let laid_out = Document::from_text(text, None);
                let corner = [least(0), least(1)];
                let moved = nodes.iter().map(|node| {
                    let [x, y] = laid_out.position(&node.name);
                    (node.name.clone(), [x + corner[0], y + corner[1]])
                });
                self.edit("tidy".into(), &[Edit::MoveNodes(moved.collect())]);
                self.graph.fit();
            }
            Command::Align if nodes.len() > 1 => {
                let mut by_height: Vec<(&NodeEntry, [f64; 2])> =
                    nodes.iter().zip(places.iter().copied()).collect();
                by_height.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
                let (left, top) = (least(0), least(1));
                let moved = by_height.iter().enumerate();
                let moved = moved.map(|(i, (node, _))| (node.name.clone(), [left, top + ROW * i as f64]));
                self.edit("align".into(), &[Edit::MoveNodes(moved.collect())]);
            }
            Command::Frame if !self.selection().is_empty() => {
                let at = [least(0) - 20.0, least(1) - 36.0];
                let size = [most(0) + 200.0 - at[0], most(1) + 150.0 - at[1]];
                let count = self.document.view().frames.len();
                let frame = Frame { title: "frame".into(), at, size, color: None };
                self.edit("add a frame".into(), &[Edit::PutFrame(count, frame)]);
            }
            Command::Note => {
                let count = self.document.view().notes.len();
                let at = if nodes.is_empty() { [0.0, 0.0] } else { [least(0), most(1) + 160.0] };
                let note = Note { text: "a note: right click to write".into(), at };
                self.edit("add a note".into(), &[Edit::PutNote(count, note)]);
            }
            _ => {}
        }
    }
}
