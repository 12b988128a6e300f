//! Places for nodes: in layers from left to right, and in line with each other.

use crate::links;
use voltet_graph::NodeEntry;

/// Gap between two layers, and between two nodes of one (points).
const GAP: [f64; 2] = [70.0, 40.0];
/// The size of a node that nobody has drawn yet.
pub const USUAL: [f64; 2] = [170.0, 100.0];
/// Number of passes that order the layers by their neighbours.
const SWEEPS: usize = 4;

/// A node as it is drawn.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the fields' names say what they are")]
pub struct PlacedNode {
    pub name: String,
    pub position: [f64; 2],
    pub size: [f64; 2],
}

/// Alignment of nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the variants' names say what they are")]
pub enum Align {
    Left,
    Right,
    Centre,
    Top,
    Bottom,
    Middle,
    Across,
    Down,
}

/// A place for each node: in the layer that the longest way from a source leads to, a source in the one before the first that it
/// feeds; within the layers in the order of the mean place of their neighbours, swept back and forth (Sugiyama, Tagawa, Toda
/// 1981). Equal pipelines have equal places.
pub fn tidy(nodes: &[NodeEntry], size: &dyn Fn(&str) -> [f64; 2]) -> Vec<[f64; 2]> {
    let feeding = feeding(nodes);
    let layer = layer_of(&feeding);
    let count = layer.iter().max().map_or(0, |last| last + 1);
    let mut layers: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, &layer) in layer.iter().enumerate() {
        layers[layer].push(i);
    }
    layers.retain(|layer| !layer.is_empty());
    order(&mut layers, &feeding);
    let mut places = vec![[0.0; 2]; nodes.len()];
    let mut left = 0.0;
    let heights = |layer: &[usize]| {
        let heights = layer.iter().map(|&i| size(&nodes[i].name)[1]);
        heights.sum::<f64>() + GAP[1] * (layer.len().max(1) - 1) as f64
    };
    let tallest = layers.iter().map(|layer| heights(layer)).fold(0.0, f64::max);
    for layer in &layers {
        let mut top = ((tallest - heights(layer)) / 2.0).round();
        let mut width: f64 = 0.0;
        for &i in layer {
            let [own_width, height] = size(&nodes[i].name);
            places[i] = [left, top];
            top += height + GAP[1];
            width = width.max(own_width);
        }
        left += width + GAP[0];
    }
    places
}

fn feeding(nodes: &[NodeEntry]) -> Vec<Vec<usize>> {
    let number = |name: &str| nodes.iter().position(|node| node.name == name);
    let of = |node: &NodeEntry| {
        let named = node.inputs.iter().flat_map(links::sources);
        named.filter_map(|text| number(links::source(text, nodes).0)).collect()
    };
    nodes.iter().map(of).collect()
}

/// The layer of each node. Nodes of a circle of wires share the last one.
fn layer_of(feeding: &[Vec<usize>]) -> Vec<usize> {
    let count = feeding.len();
    let mut layer = vec![0; count];
    // No way without a circle is longer.
    for _ in 0..count {
        for i in 0..count {
            layer[i] = feeding[i].iter().map(|&k| layer[k] + 1).max().map_or(0, |next| next.min(count - 1));
        }
    }
    // A source stands by what it feeds.
    for i in (0..count).filter(|&i| feeding[i].is_empty()) {
        let fed = (0..count).filter(|&k| feeding[k].contains(&i)).map(|k| layer[k]);
        layer[i] = fed.min().map_or(0, |first| first - 1);
    }
    layer
}

/// Orders the nodes within layers so that wires cross little.
fn order(layers: &mut [Vec<usize>], feeding: &[Vec<usize>]) {
    let mut fed: Vec<Vec<usize>> = vec![Vec::new(); feeding.len()];
    for (i, from) in feeding.iter().enumerate() {
        from.iter().for_each(|&k| fed[k].push(i));
    }
    // The place of each node in its layer, from the middle of the layer on.
    let mut row = vec![0.0; feeding.len()];
    let place = |layer: &[usize], row: &mut [f64]| {
        let middle = (layer.len().max(1) - 1) as f64 / 2.0;
        layer.iter().enumerate().for_each(|(k, &i)| row[i] = k as f64 - middle);
    };
    layers.iter().for_each(|layer| place(layer, &mut row));
    for sweep in 0..2 * SWEEPS {
        let (neighbours, is_back) = if sweep % 2 == 0 { (&fed[..], true) } else { (feeding, false) };
        for l in 0..layers.len() {
            let l = if is_back { layers.len() - 1 - l } else { l };
            let mean = |i: usize| {
                let rows = neighbours[i].iter().map(|&k| row[k]);
                if neighbours[i].is_empty() { row[i] } else { rows.sum::<f64>() / neighbours[i].len() as f64 }
            };
            let mut keyed: Vec<(f64, usize)> = layers[l].iter().map(|&i| (mean(i), i)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            layers[l] = keyed.into_iter().map(|(_, i)| i).collect();
            place(&layers[l], &mut row);
        }
    }
}

/// Other places that bring nodes in line; only those that move.
pub fn align(nodes: &[PlacedNode], how: Align) -> Vec<(String, [f64; 2])> {
    let axis = match how {
        Align::Left | Align::Right | Align::Centre | Align::Across => 0,
        Align::Top | Align::Bottom | Align::Middle | Align::Down => 1,
    };
    let low = nodes.iter().map(|node| node.position[axis]).fold(f64::INFINITY, f64::min);
    let high =
        nodes.iter().map(|node| node.position[axis] + node.size[axis]).fold(f64::NEG_INFINITY, f64::max);
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by(|&a, &b| nodes[a].position[axis].total_cmp(&nodes[b].position[axis]));
    let whole: f64 = nodes.iter().map(|node| node.size[axis]).sum();
    let gap = (high - low - whole) / (nodes.len().max(2) - 1) as f64;
    let mut next = low;
    let mut moved = Vec::new();
    for i in order {
        let node = &nodes[i];
        let place = match how {
            Align::Left | Align::Top => low,
            Align::Right | Align::Bottom => high - node.size[axis],
            Align::Centre | Align::Middle => 0.5 * (low + high - node.size[axis]),
            Align::Across | Align::Down => next,
        };
        next += node.size[axis] + gap;
        let mut at = node.position;
        at[axis] = place.round();
        if at != node.position {
            moved.push((node.name.clone(), at));
        }
    }
    moved
}
