//! Meshes of text whose nodes and elements have numbers of their own: a format hands them out in passes over its file, and they become
//! points, cells and arrays here.

use super::blocks::selected;
use super::contents::{CellBlocks, Dataset, Meter, Piece};
use super::lazy::{MeshTags, Tags, into_cells, mesh_head, missing_node};
use super::request::Request;
use super::source::Source;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::{Association, CellSet};
use voltet_core::progress::Progress;
use voltet_core::reading::{FileArray, GridHead, GridRead, OpenGrid};

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
/// Called with the number of a node or element and values of it.
pub(super) type VisitValues<'a> = &'a mut dyn FnMut(u64, &[f64]) -> Result<()>;
/// An array, and the columns of its components in the table of nodes or elements.
pub(super) type ArrayColumns = (FileArray, Vec<usize>);

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

    /// Hands out the values in these columns, at least one, of the table of nodes or of elements, row by row.
    fn each_row(&self, _of: Association, _columns: &[usize], _visit: VisitValues) -> Result<()> {
        Ok(())
    }
}

/// A mesh with what was found of it.
struct OpenMesh<M> {
    mesh: M,
    head: GridHead,
    /// Columns of each array of the head.
    columns: Vec<Vec<usize>>,
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
    arrays: Vec<ArrayColumns>,
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
    let (arrays, columns) = arrays.into_iter().unzip();
    let head = GridHead { arrays, ..mesh_head([node_count, sum(0), sum(1)]) };
    let tags = MeshTags::default();
    let open =
        Arc::new(OpenMesh { mesh, head, columns, blocks: blocks.clone(), block_places, is_selected, tags });
    let mut piece = Piece::of_open(source, open.clone());
    if !blocks.is_empty() {
        let numbers = Arc::new(move |_: &Meter| Ok(open.read_elements()?.1));
        piece.blocks = CellBlocks::Each { numbers, grid: None };
    }
    Ok(Dataset { format, pieces: vec![piece], blocks, file_bytes: source.len(), ..Dataset::default() })
}

/// True for the same names, of which most are empty.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && (a.is_empty() || a == b)
}

impl<M: TaggedMesh> OpenGrid for OpenMesh<M> {
    fn head(&self) -> &GridHead {
        &self.head
    }

    fn read(&self, geometry: bool, arrays: &[usize], _: &dyn Progress) -> Result<GridRead> {
        let mut read = GridRead::default();
        if geometry {
            read.points = Some(self.read_nodes()?);
            read.cells = Some(into_cells(self.read_elements()?.0));
        }
        Ok(GridRead { arrays: self.values(arrays)?, ..read })
    }
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
    fn read_elements(&self) -> Result<(CellSet, Vec<f64>)> {
        let nodes = self.tags(0)?;
        let (mut cells, mut tags, mut blocks) = (CellSet::default(), Vec::new(), Vec::new());
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
            cells.push(element.code, corners.iter().copied());
            tags.push(element.tag);
            blocks.push(block as f64);
            Ok(())
        })?;
        self.keep_tags(1, tags)?;
        Ok((cells, blocks))
    }

    /// Values of the arrays at these places, of all points or selected cells, in one pass over each table; not a number where the file has
    /// none.
    fn values(&self, places: &[usize]) -> Result<Vec<Vec<f64>>> {
        let mut all = vec![Vec::new(); places.len()];
        for (kind, of) in [Association::Point, Association::Cell].into_iter().enumerate() {
            let is_own = |place: usize| self.head.arrays[place].association == of;
            let mut own: Vec<_> = places.iter().zip(&mut all).filter(|array| is_own(*array.0)).collect();
            let columns: Vec<usize> = own.iter().flat_map(|array| &self.columns[*array.0]).copied().collect();
            if columns.is_empty() {
                continue;
            }
            let tags = self.tags(kind)?;
            let width = |place: usize| self.columns[place].len();
            own.iter_mut().for_each(|(place, values)| values.resize(tags.len() * width(**place), f64::NAN));
            self.mesh.each_row(of, &columns, &mut |tag, mut row| {
                let Some(number) = tags.find(tag) else { return Ok(()) };
                for (place, values) in &mut own {
                    let n = width(**place);
                    let (tuple, rest) = row.split_at(n);
                    values[number * n..][..n].copy_from_slice(tuple);
                    row = rest;
                }
                Ok(())
            })?;
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::super::assemble::assemble;
    use super::super::blocks::number_cells;
    use super::*;
    use std::sync::{Mutex, PoisonError};
    use voltet_core::grid::code;
    use voltet_core::progress::NoProgress;

    /// Tables of nodes and of elements and the columns that were read of them, each time that they were.
    type Passes = Arc<Mutex<Vec<(Association, Vec<usize>)>>>;

    /// A tetrahedron of a block, whose values are the number of the row and that of the column.
    struct OneTetrahedron(Passes, &'static str);

    impl TaggedMesh for OneTetrahedron {
        fn each_node(&self, visit: VisitNode) -> Result<()> {
            [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]
                .into_iter()
                .zip(1..)
                .try_for_each(|(at, tag)| visit(tag, at))
        }

        fn each_element(&self, visit: VisitElement) -> Result<()> {
            visit(&TaggedElement { tag: 9, code: code::TETRA, block: self.1, nodes: &[1, 2, 3, 4] })
        }

        fn each_row(&self, of: Association, columns: &[usize], visit: VisitValues) -> Result<()> {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push((of, columns.to_vec()));
            let tags = if of == Association::Point { 1..5 } else { 9..10 };
            tags.into_iter().try_for_each(|tag| {
                let row: Vec<f64> = columns.iter().map(|&column| (10 * tag + column as u64) as f64).collect();
                visit(tag, &row)
            })
        }
    }

    fn array(name: &str, association: Association, columns: &[usize]) -> ArrayColumns {
        (FileArray { name: name.into(), association, component_count: columns.len() }, columns.to_vec())
    }

    const POINT: Association = Association::Point;
    const CELL: Association = Association::Cell;

    /// A source for data sets that read nothing of it.
    fn source() -> (tempfile::TempDir, Arc<Source>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, " ").unwrap();
        let source = Source::open(&path).unwrap();
        (folder, source)
    }

    /// Several such tetrahedra as pieces, and their passes; `arrays`: of each.
    fn pieces(
        source: &Arc<Source>,
        block: &'static str,
        arrays: Vec<Vec<ArrayColumns>>,
        request: &Request,
    ) -> (Dataset, Vec<Passes>) {
        let all: Vec<Passes> = arrays.iter().map(|_| Passes::default()).collect();
        let own = arrays.into_iter().zip(&all).map(|(arrays, passes)| {
            let mesh = OneTetrahedron(passes.clone(), block);
            dataset(source, "a mesh".into(), mesh, arrays, request).unwrap()
        });
        let add = |mut all: Dataset, own: Dataset| {
            all.pieces.extend(own.pieces);
            all
        };
        (own.reduce(add).unwrap(), all)
    }

    fn several() -> (Vec<ArrayColumns>, Request) {
        let arrays = vec![
            array("other", POINT, &[0]),
            array("v", POINT, &[5, 3, 4]),
            array("s", POINT, &[2]),
            array("c", CELL, &[1]),
            array("other", CELL, &[0]),
        ];
        let point_arrays = vec!["v".into(), "c".into()];
        (arrays, Request { scalar: Some("s".into()), point_arrays, ..Request::default() })
    }

    #[test]
    fn the_arrays_of_a_request_are_read_in_one_pass_and_no_others() {
        let (_folder, source) = source();
        let (arrays, mut request) = several();
        request.point_arrays.push("s".into());
        let (both, passes) = pieces(&source, "", vec![arrays.clone(), arrays], &request);
        let grid = assemble(&both, &request, &NoProgress).unwrap();
        for passes in &passes {
            let expected = [(POINT, vec![5, 3, 4, 2]), (CELL, vec![1])];
            assert_eq!(*passes.lock().unwrap(), expected);
        }
        assert_eq!(**grid.scalar.as_ref().unwrap(), [12.0, 22.0, 32.0, 42.0]);
        assert_eq!(*grid.point_arrays["s"].values, [12.0, 22.0, 32.0, 42.0]);
        assert_eq!(grid.point_arrays["v"].values[..3], [15.0, 13.0, 14.0]);
        assert_eq!(*grid.point_arrays["c"].values, [91.0; 4]);
    }

    #[test]
    fn arrays_of_blocks_that_are_not_drawn_are_not_read() {
        let (_folder, source) = source();
        let (arrays, request) = several();
        let lacking = vec![array("v", POINT, &[5, 3, 4])];
        let (mut both, passes) = pieces(&source, "", vec![arrays, lacking], &request);
        (both.has_blocks, both.blocks) = (true, vec!["a".into(), "b".into()]);
        both.pieces[1].blocks = CellBlocks::One(1);
        let grid = assemble(&both, &request, &NoProgress).unwrap();
        assert_eq!((grid.tetrahedra.len(), passes[0].lock().unwrap().len()), (1, 2));
        assert!(passes[1].lock().unwrap().is_empty());
    }

    #[test]
    fn the_numbers_of_blocks_are_not_the_array_of_the_file_with_their_name() {
        let (_folder, source) = source();
        let request = Request { scalar: Some("block".into()), ..Request::default() };
        let (mut one, passes) = pieces(&source, "b", vec![vec![array("block", CELL, &[0])]], &request);
        number_cells(&mut one, &request, &source).unwrap();
        let grid = assemble(&one, &request, &NoProgress).unwrap();
        assert_eq!(**grid.scalar.as_ref().unwrap(), [0.0; 4]);
        assert!(passes[0].lock().unwrap().is_empty());
    }

    /// Memory that is left each time that somebody asks, the last first; later there is no limit.
    struct MemoryLeft(Mutex<Vec<u64>>);

    impl Progress for MemoryLeft {
        fn report(&self, _stage: &str, _fraction: f64) {}

        fn memory_left(&self) -> Option<u64> {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).pop()
        }
    }

    #[test]
    fn arrays_that_are_there_are_not_counted_again() {
        let (_folder, source) = source();
        let (arrays, request) = several();
        let read = |count: usize, last: &[u64]| {
            let (own, _) = pieces(&source, "", vec![arrays.clone(); count], &request);
            assemble(&own, &request, &MemoryLeft(Mutex::new(last.to_vec())))
        };
        // Points, a tetrahedron and two arrays further, without the points, the scalar, 4 numbers of 'v' and one of 'c'.
        let needed = 4 * 32 + 16 + 2 * 4 * 8 - 4 * 24 - 4 * 8 - 4 * 8 - 8;
        assert!(read(1, &[needed, u64::MAX]).is_ok());
        let error = read(1, &[needed - 1, u64::MAX]).unwrap_err().to_string();
        assert!(error.contains("memory ends") && !error.contains("--memory"), "{error}");
        let error = read(2, &[0]).unwrap_err().to_string();
        assert!(
            error.contains("a grid of 8 points and 2 cells") && error.contains("--memory SIZE"),
            "{error}"
        );
    }
}
