//! The arrays that the data really has, with their ranges: found on a thread of its own, once a file.

use crate::worker::short;
use eframe::egui::Context;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::progress::NoProgress;
use voltet_document::Document;
use voltet_document::links::upstream;
use voltet_graph::{LocatedValue, NodeEntry, Registry};
use voltet_io::formats::{self, Association, Request};
use voltet_nodes::external_formats;

/// An array that may be chosen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ArrayChoice {
    /// As a file names it.
    pub name: String,
    /// With what it is and its range.
    pub label: String,
}

/// True if a node reads a data file.
pub(crate) fn reads(entry: &NodeEntry, registry: &Registry) -> bool {
    let name = entry.node_type.text();
    let of_others = |name| registry.find(name).is_ok_and(|node| node.reader.is_some());
    name == Some("reader") || name.is_some_and(of_others)
}

/// The file of a node that reads one, as it is named there.
pub(crate) fn path_of(entry: &NodeEntry) -> Option<&str> {
    entry.setting("path").and_then(LocatedValue::text)
}

/// Arrays of data files; none while a file is being read.
#[derive(Default)]
pub(crate) struct Arrays(Arc<Mutex<HashMap<PathBuf, Arc<Vec<ArrayChoice>>>>>);

impl Arrays {
    /// The arrays of the files that feed a node; empty while they are not known.
    pub fn feeding(
        &self,
        ctx: &Context,
        document: &Document,
        registry: &Registry,
        node: &str,
    ) -> Arc<Vec<ArrayChoice>> {
        let nodes = &document.pipeline().nodes;
        let feeding = upstream(nodes, node);
        let reader =
            nodes.iter().filter(|entry| feeding.contains(&entry.name)).find(|entry| reads(entry, registry));
        let Some(path) = reader.and_then(path_of) else { return Arc::default() };
        let path = document.folder().join(path);
        let registry = registry.clone();
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let begin = || {
            let (known, ctx, path) = (self.0.clone(), ctx.clone(), path.clone());
            // Without a thread there are no choices, and the name is typed.
            let _ = std::thread::Builder::new().name("arrays".into()).spawn(move || {
                let tell = |found: Vec<ArrayChoice>| {
                    let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
                    known.insert(path.clone(), Arc::new(found));
                    drop(known);
                    ctx.request_repaint();
                };
                // Names come from the headers at once; ranges take a reading of the file.
                // A file that cannot be read has no arrays to choose from; the run says what is wrong with it.
                let Ok(request) = external_formats::request(Request::default(), &path, &registry) else {
                    return;
                };
                tell(heads(&path, &request));
                if let Some(found) = ranges(&path, &request) {
                    tell(found);
                }
            });
            Arc::default()
        };
        known.entry(path.clone()).or_insert_with(begin).clone()
    }
}

fn heads(path: &std::path::Path, request: &Request) -> Vec<ArrayChoice> {
    let arrays = formats::arrays(path, request).unwrap_or_default();
    arrays.iter().flat_map(|head| choices(head, None)).collect()
}

fn ranges(path: &std::path::Path, request: &Request) -> Option<Vec<ArrayChoice>> {
    let summary = formats::inspect(path, request, &NoProgress).ok()?;
    Some(summary.arrays.iter().flat_map(|array| choices(&array.head, array.range)).collect())
}

/// An array as it is, or its length and components.
fn choices(head: &formats::ArrayHead, range: Option<[f64; 2]>) -> Vec<ArrayChoice> {
    let place = if head.association == Association::Cell { "cells" } else { "points" };
    let range = range.map_or(String::new(), |[low, high]| format!(", {} to {}", short(low), short(high)));
    if head.component_count == 1 {
        return vec![ArrayChoice {
            name: head.name.clone(),
            label: format!("{}  ({place}{range})", head.name),
        }];
    }
    let length = format!("{}:magnitude", head.name);
    let all = std::iter::once(ArrayChoice { label: format!("{length}  ({place}{range})"), name: length });
    let parts = (0..head.component_count).map(|i| {
        let name = format!("{}:{i}", head.name);
        ArrayChoice { label: format!("{name}  ({place})"), name }
    });
    all.chain(parts).collect()
}
