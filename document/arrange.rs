//! Places for nodes: in layers from left to right.

use crate::links;
use voltet_core::graph::NodeEntry;

/// From the left edge of one layer to that of the next, in points.
pub const LAYER: f64 = 240.0;
/// From the top of one node to that of the next.
pub const ROW: f64 = 140.0;

/// A place for each node: in the layer of the longest way that leads to it, ordered so that wires cross little. Equal
/// pipelines have equal places.
pub fn layers(nodes: &[NodeEntry]) -> Vec<[f64; 2]> {
    let number = |name: &str| nodes.iter().position(|node| node.name == name);
    let feeding: Vec<Vec<usize>> = nodes
        .iter()
        .map(|node| {
            let named = node.inputs.iter().flat_map(links::sources);
            named.filter_map(|text| number(links::source(text, nodes).0)).collect()
        })
        .collect();
    let mut layer = vec![0usize; nodes.len()];
    for _ in 0..nodes.len() {
        for i in 0..nodes.len() {
            layer[i] = feeding[i].iter().map(|&k| layer[k] + 1).max().unwrap_or(0).min(nodes.len());
        }
    }
    let mut rows = vec![0usize; nodes.len() + 1];
    layer
        .iter()
        .map(|&layer| {
            rows[layer] += 1;
            [layer as f64 * LAYER, (rows[layer] - 1) as f64 * ROW]
        })
        .collect()
}
