//! Places for nodes: in layers from left to right, and in line with each other.

use crate::links;
use std::collections::BTreeSet;
use voltet_graph::NodeEntry;

/// Gap between two layers, and between two nodes of one (points).
const GAP: [f64; 2] = [70.0, 40.0];
/// The size of a node that nobody has drawn yet.
pub const USUAL: [f64; 2] = [170.0, 100.0];
/// Most nodes one above the other; where a layer has more, chains are grouped, and what is no chain stands in several columns.
const MAX_ROWS: usize = 8;
/// Nodes that a source feeds at least if it belongs to no chain; and those that another node does.
const SHARED: [usize; 2] = [3, MAX_ROWS];
/// Width of grouped chains over their height, about.
const ASPECT: f64 = 1.5;
/// Number of passes that order the layers by their neighbours.
const SWEEPS: usize = 4;

/// A node as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedNode {
    /// The node.
    pub name: String,
    /// Its upper left corner.
    pub position: [f64; 2],
    /// Its width and height.
    pub size: [f64; 2],
}

/// Alignment of nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Align {
    /// Left sides.
    Left,
    /// Right sides.
    Right,
    /// Middles, one under the other.
    Centre,
    /// Upper sides.
    Top,
    /// Lower sides.
    Bottom,
    /// Middles, one beside the other.
    Middle,
    /// Equal gaps from left to right.
    Across,
    /// Equal gaps from top to bottom.
    Down,
}

/// A place for each node: in the layer that the longest way from a source leads to, a source in the one before the first that it
/// feeds; within the layers in the order of the mean place of their neighbours, swept back and forth (Sugiyama, Tagawa, Toda
/// 1981), the best order kept. Where layers would be long, nodes that are wired to each other are laid out in groups, which stand beside
/// each other in lines; nodes that many chains share come first, with all that feeds them. A layer that is long still has several
/// columns. Equal pipelines have equal places.
pub fn tidy(nodes: &[NodeEntry], size: &dyn Fn(&str) -> [f64; 2]) -> Vec<[f64; 2]> {
    let feeding = feeding(nodes);
    let laid_out: Vec<PlacedGroup> =
        groups(&feeding).into_iter().map(|group| layered(group, &feeding, nodes, size)).collect();
    let area: f64 = laid_out.iter().map(|group| (group.size[0] + GAP[0]) * (group.size[1] + GAP[1])).sum();
    let widest = laid_out.iter().map(|group| group.size[0]).fold((ASPECT * area).sqrt(), f64::max);
    let mut places = vec![[0.0; 2]; nodes.len()];
    let (mut left, mut top, mut height) = (0.0, 0.0, 0.0);
    for group in laid_out {
        if left > 0.0 && left + group.size[0] > widest {
            (left, top, height) = (0.0, top + height + 2.0 * GAP[1], 0.0);
        }
        for (i, [x, y]) in group.places {
            places[i] = [left + x, top + y];
        }
        left += group.size[0] + 2.0 * GAP[0];
        height = group.size[1].max(height);
    }
    places
}

/// Nodes that are laid out together: the place of each, by its number, and the size of all.
struct PlacedGroup {
    places: Vec<(usize, [f64; 2])>,
    size: [f64; 2],
}

/// Numbers of the nodes that are laid out together.
fn groups(feeding: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let layer = layer_of(feeding);
    let mut lengths = vec![0; feeding.len()];
    layer.iter().for_each(|own| lengths[*own] += 1);
    if lengths.iter().all(|length| *length <= MAX_ROWS) {
        return vec![(0..feeding.len()).collect()];
    }
    let fed = |i: usize| feeding.iter().filter(|from| from.contains(&i)).count();
    let is_shared = |&i: &usize| fed(i) >= SHARED[usize::from(!feeding[i].is_empty())];
    let mut open: Vec<usize> = (0..feeding.len()).filter(is_shared).collect();
    let mut shared = BTreeSet::new();
    while let Some(i) = open.pop() {
        if shared.insert(i) {
            open.extend(&feeding[i]);
        }
    }
    let shared: Vec<usize> = shared.into_iter().collect();
    let mut groups: Vec<Vec<usize>> = vec![shared.clone()];
    for i in (0..feeding.len()).filter(|i| !shared.contains(i)) {
        let wired = |group: &Vec<usize>| {
            group
                .iter()
                .any(|&k| !shared.contains(&k) && (feeding[i].contains(&k) || feeding[k].contains(&i)))
        };
        let (mut joined, others): (Vec<_>, Vec<_>) = groups.into_iter().partition(wired);
        let mut group = joined.drain(..).flatten().chain([i]).collect::<Vec<usize>>();
        group.sort_unstable();
        groups = others;
        groups.push(group);
    }
    groups.retain(|group| !group.is_empty());
    groups.sort_by_key(|group| (*group != shared, group[0]));
    groups
}

/// Layers of a group of nodes from left to right.
fn layered(
    group: Vec<usize>,
    feeding: &[Vec<usize>],
    nodes: &[NodeEntry],
    size: &dyn Fn(&str) -> [f64; 2],
) -> PlacedGroup {
    let number = |i: &usize| group.iter().position(|k| k == i);
    let feeding: Vec<Vec<usize>> =
        group.iter().map(|&i| feeding[i].iter().filter_map(number).collect()).collect();
    let size = |i: usize| size(&nodes[group[i]].name);
    let layer = layer_of(&feeding);
    let count = layer.iter().max().map_or(0, |last| last + 1);
    let mut layers: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, &layer) in layer.iter().enumerate() {
        layers[layer].push(i);
    }
    order(&mut layers, &feeding);
    let mut places = Vec::new();
    let mut left = 0.0;
    let heights = |layer: &[usize]| {
        let heights = layer.iter().map(|&i| size(i)[1]);
        heights.sum::<f64>() + GAP[1] * (layer.len().max(1) - 1) as f64
    };
    let columns: Vec<&[usize]> =
        layers.iter().flat_map(|layer| layer.chunks(rows_of(layer, &size))).collect();
    let tallest = columns.iter().map(|column| heights(column)).fold(0.0, f64::max);
    for layer in columns {
        let mut top = ((tallest - heights(layer)) / 2.0).round();
        let mut width: f64 = 0.0;
        for &i in layer {
            let [own_width, height] = size(i);
            places.push((group[i], [left, top]));
            top += height + GAP[1];
            width = width.max(own_width);
        }
        left += width + GAP[0];
    }
    PlacedGroup { places, size: [left - GAP[0], tallest] }
}

/// Most nodes one above the other in the columns of a layer: all, or as many as give it its width over its height.
fn rows_of(layer: &[usize], size: &dyn Fn(usize) -> [f64; 2]) -> usize {
    if layer.len() <= MAX_ROWS {
        return layer.len().max(1);
    }
    let mean =
        |axis: usize| layer.iter().map(|&i| size(i)[axis] + GAP[axis]).sum::<f64>() / layer.len() as f64;
    let rows = (layer.len() as f64 * mean(0) / (ASPECT * mean(1))).sqrt().ceil() as usize;
    rows.clamp(MAX_ROWS, layer.len())
}

/// For each node those that feed it, by their numbers.
fn feeding(nodes: &[NodeEntry]) -> Vec<Vec<usize>> {
    let number = |name: &str| nodes.iter().position(|node| node.name == name);
    let of = |node: &NodeEntry| {
        let named = node.inputs.iter().flat_map(links::sources);
        named.filter_map(|text| number(links::source(text, nodes).0)).collect()
    };
    nodes.iter().map(of).collect()
}

/// The layer of each node. Wires that close a circle count for nothing.
fn layer_of(feeding: &[Vec<usize>]) -> Vec<usize> {
    // An order in which what feeds comes first, by depth; a node met again on its own way is not gone into.
    let (mut order, mut state) = (Vec::new(), vec![0u8; feeding.len()]);
    let mut before: Vec<Vec<usize>> = vec![Vec::new(); feeding.len()];
    for start in 0..feeding.len() {
        let mut way = vec![(start, 0)];
        while let Some(&mut (i, ref mut next)) = way.last_mut() {
            if state[i] == 2 || *next == feeding[i].len() {
                if state[i] != 2 {
                    order.push(i);
                }
                state[i] = 2;
                way.pop();
                continue;
            }
            state[i] = 1;
            let k = feeding[i][*next];
            *next += 1;
            if state[k] != 1 {
                before[i].push(k);
                way.push((k, 0));
            }
        }
    }
    let mut layer = vec![0; feeding.len()];
    for &i in &order {
        layer[i] = before[i].iter().map(|&k| layer[k] + 1).max().unwrap_or(0);
    }
    // A source stands by what it feeds.
    for &i in order.iter().filter(|&&i| before[i].is_empty()) {
        let fed = (0..feeding.len()).filter(|&k| before[k].contains(&i)).map(|k| layer[k]);
        layer[i] = fed.min().map_or(0, |first| first - 1);
    }
    layer
}

/// Orders the nodes within layers so that wires cross little.
fn order(layers: &mut [Vec<usize>], feeding: &[Vec<usize>]) {
    let count = feeding.len();
    let mut fed: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, from) in feeding.iter().enumerate() {
        from.iter().for_each(|&k| fed[k].push(i));
    }
    let mut row = rows(layers, count);
    let mut best = (crossings(layers, feeding, &row), layers.to_vec());
    for sweep in 0..2 * SWEEPS {
        let neighbours = if sweep % 2 == 0 { feeding } else { &fed };
        let mut turns: Vec<usize> = (0..layers.len()).collect();
        if sweep % 2 == 1 {
            turns.reverse();
        }
        for l in turns {
            let mean = |i: usize| {
                let rows: Vec<f64> = neighbours[i].iter().map(|&k| row[k]).collect();
                if rows.is_empty() { row[i] } else { rows.iter().sum::<f64>() / rows.len() as f64 }
            };
            let mut keyed: Vec<(f64, usize)> = layers[l].iter().map(|&i| (mean(i), i)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            layers[l] = keyed.into_iter().map(|(_, i)| i).collect();
            row = rows(layers, count);
        }
        let found = crossings(layers, feeding, &row);
        if found < best.0 {
            best = (found, layers.to_vec());
        }
    }
    layers.clone_from_slice(&best.1);
}

/// The place of each node in its layer, from the middle of the layer on.
fn rows(layers: &[Vec<usize>], count: usize) -> Vec<f64> {
    let mut rows = vec![0.0; count];
    for layer in layers {
        let middle = (layer.len().max(1) - 1) as f64 / 2.0;
        layer.iter().enumerate().for_each(|(row, &i)| rows[i] = row as f64 - middle);
    }
    rows
}

/// Number of crossings between wires of the same layers.
fn crossings(layers: &[Vec<usize>], feeding: &[Vec<usize>], row: &[f64]) -> usize {
    let mut layer = vec![0; feeding.len()];
    for (l, nodes) in layers.iter().enumerate() {
        nodes.iter().for_each(|&i| layer[i] = l);
    }
    let wires: Vec<(usize, usize)> =
        feeding.iter().enumerate().flat_map(|(i, from)| from.iter().map(move |&k| (k, i))).collect();
    let cross = |&(a, b): &(usize, usize), &(c, d): &(usize, usize)| {
        let same = layer[a] == layer[c] && layer[b] == layer[d];
        same && (row[a] - row[c]) * (row[b] - row[d]) < 0.0
    };
    wires.iter().enumerate().map(|(n, one)| wires[..n].iter().filter(|other| cross(one, other)).count()).sum()
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
