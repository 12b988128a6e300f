//! Meshes of text whose nodes and elements have numbers of their own: a format hands them out in passes over its file, and they become
//! points, cells and arrays here.

use super::blocks::selected;
use super::contents::{CellBlocks, Compute, Dataset, Meter, Piece, PieceArray};
use super::lazy::{GatheredCells, MeshTags, Tags, geometry, missing_node};
use super::request::Request;
use super::source::Source;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::Association;
use voltet_core::reading::FileArray;

/// Name of the block of elements that are in none, in a file with blocks.
const NO_BLOCK: &str = "no block";

/// Tags of a mesh of several parts have the number of the part above these bits.
pub(super) const PART_SHIFT: u32 = 40;

/// Number within its part of a node or element of a mesh of several parts.
pub(super) fn number_in_part(tag: u64) -> u64 {
    tag & ((1 << PART_SHIFT) - 1)
}

pub(super) struct TaggedElement<'a> {
    /// Its own number.
    pub tag: u64,
    /// Type code of VTK.
    pub code: u8,
    /// Name of its block; empty: none.
    pub block: &'a str,
    /// Numbers of its nodes, in VTK's order.
    pub nodes: &'a [u64],
}

/// Called with the number and the position of a node.
pub(super) type VisitNode<'a> = &'a mut dyn FnMut(u64, DVec3) -> Result<()>;
/// Called with an element that is a volume.
pub(super) type VisitElement<'a> = &'a mut dyn FnMut(&TaggedElement) -> Result<()>;
/// Called with the number of a node or element and its tuple.
pub(super) type VisitValues<'a> = &'a mut dyn FnMut(u64, &[f64]) -> Result<()>;

/// A mesh that is read in passes.
pub(super) trait TaggedMesh: Send + Sync + 'static {
    fn each_node(&self, visit: VisitNode) -> Result<()>;

    fn count_nodes(&self) -> Result<u64> {
        let mut count = 0;
        self.each_node(&mut |_, _| {
            count += 1;
            Ok(())
        })?;
        Ok(count)
    }

    /// Hands out the volume elements.
    fn each_element(&self, visit: VisitElement) -> Result<()>;

    /// Number in the file of a node or element, for messages.
    fn own_number(&self, tag: u64) -> u64 {
        tag
    }

    /// Hands out the tuples of an array, by its place in the list that was given.
    fn each_tuple(&self, _array: usize, _visit: VisitValues) -> Result<()> {
        Ok(())
    }
}

/// A mesh with what was found of it.
struct OpenMesh<M> {
    mesh: M,
    blocks: Vec<String>,
    block_places: HashMap<String, usize>,
    is_selected: Vec<bool>,
    tags: MeshTags,
}

/// The table of contents of a mesh with these arrays.
pub(super) fn dataset(
    source: &Arc<Source>,
    format: String,
    mesh: impl TaggedMesh,
    arrays: Vec<FileArray>,
    request: &Request,
) -> Result<Dataset> {
    let mut blocks: Vec<String> = Vec::new();
    // Cells and corners of each block.
    let mut counts: Vec<[u64; 2]> = Vec::new();
    let mut block_places: HashMap<String, usize> = HashMap::new();
    let mut last = 0;
    mesh.each_element(&mut |element| {
        if blocks.get(last).is_none_or(|name| !is_same(name, element.block)) {
            last = block_places.get(element.block).copied().unwrap_or(blocks.len());
        }
        if last == blocks.len() {
            block_places.insert(element.block.to_owned(), last);
            blocks.push(element.block.to_owned());
            counts.push([0; 2]);
        }
        counts[last][0] += 1;
        counts[last][1] += element.nodes.len() as u64;
        Ok(())
    })?;
    let node_count = mesh.count_nodes()?;
    if blocks == [""] {
        blocks.clear();
    }
    blocks.iter_mut().filter(|name| name.is_empty()).for_each(|name| *name = NO_BLOCK.to_owned());
    let mut is_selected = selected(&blocks, request)?;
    is_selected.resize(counts.len(), true);
    let sum =
        |place: usize| counts.iter().zip(&is_selected).filter(|own| *own.1).map(|own| own.0[place]).sum();
    let counts: [u64; 3] = [node_count, sum(0), sum(1)];
    let has_blocks = !blocks.is_empty();
    let tags = MeshTags::default();
    let open = Arc::new(OpenMesh { mesh, blocks: blocks.clone(), block_places, is_selected, tags });
    let arrays = arrays.into_iter().enumerate().map(|(place, array)| {
        let (of, n, association) = (open.clone(), array.component_count, array.association);
        let compute = move |_: &Meter| of.values(place, n, association);
        PieceArray::computed(source, &array, [counts[0], counts[1]], compute)
    });
    let of = open.clone();
    let geometry = geometry(counts, move |_| Ok((of.read_nodes()?, of.read_elements()?.0.into_cells())));
    let mut piece = Piece::new([counts[0], counts[1]], geometry, arrays.collect());
    if has_blocks {
        let numbers: Compute = Arc::new(move |_: &Meter| Ok(open.read_elements()?.1));
        piece.blocks = CellBlocks::Each { numbers, grid: None };
    }
    Ok(Dataset { format, pieces: vec![piece], blocks, file_bytes: source.len(), ..Dataset::default() })
}

/// True for the same names, of which most are empty.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && (a.is_empty() || a == b)
}

impl<M: TaggedMesh> OpenMesh<M> {
    /// Numbers of the nodes (0) or of the selected elements (1), read if they were not yet.
    fn tags(&self, kind: usize) -> Result<Arc<Tags>> {
        self.tags.get(kind, || match kind {
            0 => self.read_nodes().map(drop),
            _ => self.read_elements().map(drop),
        })
    }

    fn keep_tags(&self, kind: usize, tags: Vec<u64>) -> Result<()> {
        let what = ["node", "element"][kind];
        self.tags.keep(kind, Tags::new(tags, what, |tag| self.mesh.own_number(tag))?);
        Ok(())
    }

    fn read_nodes(&self) -> Result<Vec<DVec3>> {
        let (mut tags, mut points) = (Vec::new(), Vec::new());
        self.mesh.each_node(&mut |tag, position| {
            tags.push(tag);
            points.push(position);
            Ok(())
        })?;
        self.keep_tags(0, tags)?;
        Ok(points)
    }

    /// Selected cells, and the block of each.
    fn read_elements(&self) -> Result<(GatheredCells, Vec<f64>)> {
        let nodes = self.tags(0)?;
        let (mut cells, mut tags, mut blocks) = (GatheredCells::default(), Vec::new(), Vec::new());
        let (mut corners, mut block) = (Vec::new(), 0);
        self.mesh.each_element(&mut |element| {
            if self.blocks.get(block).is_some_and(|last| !is_same(last, element.block)) {
                block = self.block_places.get(element.block).copied().unwrap_or(0);
            }
            if !self.is_selected[block] {
                return Ok(());
            }
            corners.clear();
            for &node in element.nodes {
                let number = nodes.find(node).ok_or_else(|| {
                    missing_node(self.mesh.own_number(element.tag), self.mesh.own_number(node))
                })?;
                corners.push(number as u32);
            }
            cells.add(element.code, corners.iter().copied());
            tags.push(element.tag);
            blocks.push(block as f64);
            Ok(())
        })?;
        self.keep_tags(1, tags)?;
        Ok((cells, blocks))
    }

    /// Values of all points or selected cells; not a number where the file has none.
    fn values(&self, array: usize, component_count: usize, association: Association) -> Result<Vec<f64>> {
        let tags = self.tags(usize::from(association == Association::Cell))?;
        let n = component_count;
        let mut all = vec![f64::NAN; tags.len() * n];
        self.mesh.each_tuple(array, &mut |tag, tuple| {
            if let Some(number) = tags.find(tag) {
                all[number * n..][..n].copy_from_slice(tuple);
            }
            Ok(())
        })?;
        Ok(all)
    }
}
