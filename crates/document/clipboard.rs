//! Copy, paste, duplicate: nodes as TOML text, which pastes into a text file as well as into another window.

use crate::Document;
use crate::edit::Edit;
use crate::links;
use std::collections::BTreeSet;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{NodeEntry, suggest};

/// From a node to its copy, in points.
const ASIDE: f64 = 30.0;

impl Document {
    /// Nodes as text, in the order of the file and with the comments that belong to them.
    pub fn copy(&self, names: &[String]) -> String {
        let nodes = self.pipeline().nodes.iter().filter(|node| names.contains(&node.name));
        let mut texts: Vec<String> = Vec::new();
        for node in nodes {
            let written = self.syntax.lines_of(&self.text, &["nodes", &node.name].into());
            texts.push(written.unwrap_or_else(|| plain(node)).replace("\r\n", "\n"));
        }
        texts.join("\n")
    }

    /// Adds the nodes that a text states, as one step, and gives their names here: those that are taken get a number. Wires among
    /// them stay, and those from nodes that are here. `at`: the upper left corner of the new ones. Errors: the text states no
    /// nodes.
    pub fn paste(&mut self, text: &str, at: [f64; 2]) -> Result<Vec<String>> {
        let pasted = Document::from_text(text.replace("\r\n", "\n"), None);
        let nodes = &pasted.pipeline().nodes;
        if nodes.is_empty() || !pasted.is_toml() {
            let error = Error::usage("the text has no nodes to paste");
            return Err(error.expected("TOML with a table [nodes.NAME] for each node"));
        }
        // As they lie here, where they are from here.
        let is_from_here =
            nodes.iter().all(|node| self.pipeline().nodes.iter().any(|here| here.name == node.name));
        let source: &Document = if is_from_here { self } else { &pasted };
        let places: Vec<[f64; 2]> = nodes.iter().map(|node| source.position(&node.name)).collect();
        let corner = [0, 1].map(|axis| places.iter().map(|place| place[axis]).fold(f64::INFINITY, f64::min));
        let places: Vec<[f64; 2]> =
            places.iter().map(|p| [p[0] - corner[0] + at[0], p[1] - corner[1] + at[1]]).collect();
        self.add_copies(pasted, &places, "paste")
    }

    /// Adds copies of nodes beside them, as one step, and gives their names. Wires from nodes that are not copied feed the copies,
    /// too.
    pub fn duplicate(&mut self, names: &[String]) -> Result<Vec<String>> {
        let nodes = &self.pipeline().nodes;
        if let Some(strange) = names.iter().find(|name| !nodes.iter().any(|node| node.name == **name)) {
            let known = suggest(strange, nodes.iter().map(|node| node.name.as_str()));
            return Err(Error::usage(format!("there is no node '{strange}'")).expected(known));
        }
        let copied = Document::from_text(self.copy(names), None);
        let places: Vec<[f64; 2]> =
            copied.pipeline().nodes.iter().map(|node| self.position(&node.name).map(|x| x + ASIDE)).collect();
        self.add_copies(copied, &places, "duplicate")
    }

    fn add_copies(&mut self, mut copies: Document, places: &[[f64; 2]], label: &str) -> Result<Vec<String>> {
        let names: Vec<String> = copies.pipeline().nodes.iter().map(|node| node.name.clone()).collect();
        let here: BTreeSet<String> = self.pipeline().nodes.iter().map(|node| node.name.clone()).collect();
        // Wires from what is nowhere go.
        for node in copies.pipeline().nodes.clone() {
            for link in &node.inputs {
                for text in links::sources(link) {
                    let among =
                        names.iter().any(|name| name == links::source(text, &copies.pipeline().nodes).0);
                    let outside = here.contains(links::source(text, &self.pipeline().nodes).0);
                    if !among && !outside {
                        let (node, port) = (node.name.clone(), link.port.clone());
                        copies.edit(&Edit::Disconnect { node, port, source: Some(text.to_string()) })?;
                    }
                }
            }
        }
        let mut taken = here;
        taken.extend(names.iter().cloned());
        let mut fresh = Vec::with_capacity(names.len());
        for name in &names {
            let is_taken = self.pipeline().nodes.iter().any(|node| node.name == *name);
            let to = match is_taken {
                true => crate::document::free_name(name, &|name| taken.contains(name)),
                false => name.clone(),
            };
            if to != *name {
                copies.edit(&Edit::Rename { node: name.clone(), to: to.clone() })?;
                taken.insert(to.clone());
            }
            fresh.push(to);
        }
        let moved = Edit::MoveNodes(fresh.iter().cloned().zip(places.iter().copied()).collect());
        let mut edits: Vec<Edit> = if self.has_nodes_in_place() {
            // Where all nodes stand in one value, headers cannot follow.
            copies.pipeline().nodes.iter().flat_map(added).collect()
        } else {
            vec![Edit::AddLines(copies.copy(&fresh))]
        };
        edits.push(moved);
        self.edit_all(label.to_string(), &edits, None)?;
        Ok(fresh)
    }

    /// True if all nodes are one value: `nodes = { … }`.
    fn has_nodes_in_place(&self) -> bool {
        self.syntax.sections[0].assignments.iter().any(|a| a.keys.len() == 1 && a.keys[0].name == "nodes")
    }
}

/// A node as edits that add it.
fn added(node: &NodeEntry) -> Vec<Edit> {
    let node_type = node.node_type.text().unwrap_or_default().to_string();
    let mut edits =
        vec![Edit::AddNode { name: node.name.clone(), node_type, settings: node.settings.clone(), at: None }];
    for link in &node.inputs {
        edits.extend(links::sources(link).map(|source| Edit::Connect {
            node: node.name.clone(),
            port: link.port.clone(),
            source: source.to_string(),
            beside: link.source.list().is_some(),
        }));
    }
    edits
}

/// A node as a text of its own, without comments.
fn plain(node: &NodeEntry) -> String {
    let pipeline = Pipeline { title: None, nodes: vec![node.clone()] }.to_string();
    let from = pipeline.find("[nodes.").unwrap_or(0);
    pipeline[from..].to_string()
}
