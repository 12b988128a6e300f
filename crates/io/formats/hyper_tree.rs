//! Hyper tree grids: a rectilinear grid of roots, each cut into 2³ or 3³ children, and these again. The leaves are the cells.
//!
//! A tree lists its vertices level by level (Carrard, Harel, Pébaÿ, Lekien, "A hyper tree grid for adaptive mesh refinement", 2016,
//! and vtkHyperTreeGrid of VTK 9): a bit for each vertex of all levels but the last says whether it has children, which follow in the
//! next level in the order of their parents, x fastest. What is masked is no cell, and nothing below it.

use super::adaptive::{self, Part};
use super::contents::{Dataset, PieceArray};
use super::lattice::{Axis, LatticeBox, refuse_too_many};
use std::collections::HashSet;
use std::ops::Range;
use voltet_core::{Error, Result};

/// Sentence about interfaces that cut cells.
pub(super) const INTERFACES: &str = "Interfaces within cells are passed over: each cell is drawn as a whole.";

/// More levels than 32 bits number the parts of.
pub(super) const MAX_LEVELS: u64 = 33;

pub(super) struct HyperTrees {
    /// Children along an axis.
    pub branch_factor: u64,
    /// Points of the grid of roots along each axis.
    pub dimensions: [u64; 3],
    pub coordinates: [Vec<f64>; 3],
    /// True if the numbers of roots run fastest along z.
    pub is_transposed: bool,
    pub lists: Vec<TreeList>,
}

pub(super) struct TreeList {
    /// For each vertex of all levels of a tree but the last: 1 if it has children.
    pub parents: Vec<u8>,
    /// For each vertex: 1 if it is masked. What lies beyond the end is not.
    pub masked: Vec<u8>,
    pub trees: Vec<HyperTree>,
    pub arrays: Vec<PieceArray>,
}

/// A tree, by its place in a list.
pub(super) struct HyperTree {
    pub root: u64,
    pub parents: Range<u64>,
    pub vertices: Range<u64>,
}

impl HyperTree {
    /// Trees of a list, by their roots, levels, and the vertices of each level. Errors: lists of other lengths.
    pub fn list(roots: &[u64], depths: &[u64], counts: &[u64]) -> Result<Vec<HyperTree>> {
        let wrong = |what: &str, found: usize| Error::run(what).got(found);
        if roots.len() != depths.len() {
            let error =
                wrong("the hyper tree grid has another number of trees than of their depths", depths.len());
            return Err(error.expected(roots.len()));
        }
        let (mut rest, mut parent, mut vertex) = (counts, 0_u64, 0_u64);
        let mut trees = Vec::new();
        for (&root, &depth) in roots.iter().zip(depths) {
            let levels = usize::try_from(depth).ok().and_then(|depth| rest.split_at_checked(depth));
            let Some((levels, after)) = levels else {
                let error = wrong("the levels of trees are fewer than their depths say", counts.len());
                return Err(error.at_item(format!("tree {root}")));
            };
            let count = levels.iter().fold(0_u64, |sum, &count| sum.saturating_add(count));
            let (parent_end, end) =
                (parent.saturating_add(count - levels.last().unwrap_or(&0)), vertex.saturating_add(count));
            trees.push(HyperTree { root, parents: parent..parent_end, vertices: vertex..end });
            (rest, parent, vertex) = (after, parent_end, end);
        }
        Ok(trees)
    }
}

/// Part of a list of bits that is there.
fn bits_of<'a>(all: &'a [u8], range: &Range<u64>) -> &'a [u8] {
    let end = |index: u64| index.min(all.len() as u64) as usize;
    &all[end(range.start)..end(range.end)]
}

/// Refuses grids of roots that are damaged or plane, and gives their number of roots.
pub(super) fn root_count(branch_factor: u64, dimensions: [u64; 3]) -> Result<u64> {
    if !(2..=3).contains(&branch_factor) {
        return Err(Error::run("the branch factor of the hyper tree grid is wrong")
            .got(branch_factor)
            .expected("2 or 3"));
    }
    if dimensions.iter().any(|&n| n < 2) {
        let error = Error::run("the file holds no three-dimensional cells, so there is no volume to draw");
        return Err(error
            .got(format_args!("a hyper tree grid of {dimensions:?} points"))
            .expected("two points at least along each axis"));
    }
    let count = dimensions.iter().try_fold(1_u64, |product, n| product.checked_mul(n - 1));
    count.filter(|&count| count <= u64::from(u32::MAX)).ok_or_else(|| {
        Error::run("the hyper tree grid cannot be that large").got(format_args!("{dimensions:?} points"))
    })
}

impl HyperTrees {
    /// Adds the leaves as a piece.
    pub fn add(mut self, dataset: &mut Dataset) -> Result<()> {
        self.check()?;
        let mut roots = HashSet::new();
        let mut depth = 0;
        for (list, tree) in self.lists.iter().flat_map(|list| list.trees.iter().map(move |tree| (list, tree)))
        {
            let own = self.depth(list, tree).map_err(|error| error.at_item(format!("tree {}", tree.root)))?;
            depth = depth.max(own);
            if !roots.insert(tree.root) {
                return Err(Error::run("the hyper tree grid holds a tree twice").got(tree.root));
            }
        }
        let vertices = self.lists.iter().flat_map(|list| &list.trees);
        let count = vertices.map(|tree| tree.vertices.end - tree.vertices.start).fold(0, u64::saturating_add);
        refuse_too_many(count, Part::BYTES_PER_BOX)?;
        let parts = u32::try_from(self.branch_factor).ok().and_then(|factor| factor.checked_pow(depth));
        let parts = parts.ok_or_else(|| {
            Error::run("the hyper tree grid is too deep").got(format_args!("{depth} levels"))
        })?;
        let mut all = Vec::new();
        for list in std::mem::take(&mut self.lists) {
            let mut part = Part::default();
            list.trees.iter().for_each(|tree| self.add_leaves(&list, tree, parts, &mut part));
            if !part.tuples.is_empty() {
                all.push(Part { arrays: list.arrays, ..part });
            }
        }
        let axes = self.coordinates.map(|coordinates| Axis { coordinates, parts });
        adaptive::add(dataset, axes, all)
    }

    /// Errors: roots, coordinates or arrays are damaged or missing.
    fn check(&self) -> Result<()> {
        root_count(self.branch_factor, self.dimensions)?;
        let ascends =
            |axis: &Vec<f64>| axis.iter().all(|at| at.is_finite()) && axis.is_sorted_by(|a, b| a < b);
        if !self.coordinates.iter().all(ascends) {
            let error = Error::run("the coordinates of the hyper tree grid do not ascend");
            return Err(error.expected("finite, ascending coordinates"));
        }
        // The vertices are believed once an array may have values for them.
        if self.lists.iter().any(|list| list.arrays.is_empty()) {
            return Err(Error::run("the hyper tree grid holds no arrays").expected("values of its cells"));
        }
        self.lists.iter().flat_map(|list| &list.arrays).try_for_each(|array| array.stored.check_backing())
    }

    fn child_count(&self) -> u64 {
        self.branch_factor.pow(3)
    }

    /// Levels of a tree below its root. Errors: its bits do not fit its number of vertices, or the grid lacks its root.
    fn depth(&self, list: &TreeList, tree: &HyperTree) -> Result<u32> {
        let parents = bits_of(&list.parents, &tree.parents);
        let (mut depth, mut begin, mut count) = (0, 0_u64, 1_u64);
        while count > 0 {
            let level = bits_of(parents, &(begin..begin + count));
            begin += count;
            count = self.child_count() * level.iter().filter(|&&bit| bit != 0).count() as u64;
            depth += u32::from(count > 0);
        }
        let vertex_count = tree.vertices.end - tree.vertices.start;
        if begin != vertex_count || tree.vertices.end > u64::from(u32::MAX) {
            let error = Error::run("a tree has other vertices than its descriptor says");
            return Err(error.got(vertex_count).expected(begin));
        }
        let count = root_count(self.branch_factor, self.dimensions)?;
        if tree.root >= count {
            let error = Error::run("a tree has a root that the grid lacks").got(tree.root);
            return Err(error.expected(format_args!("a number below {count}")));
        }
        Ok(depth)
    }

    /// Lattice point at the low corner of a root, each of so many parts.
    fn corner_of_root(&self, root: u64, parts: u32) -> [u32; 3] {
        let [nx, ny, nz] = self.dimensions.map(|n| n - 1);
        let index = if self.is_transposed {
            [root / nz / ny, root / nz % ny, root % nz]
        } else {
            [root % nx, root / nx % ny, root / nx / ny]
        };
        // A lattice that leaves 32 bits is refused when it is made.
        index.map(|index| (index as u32).saturating_mul(parts))
    }

    fn add_leaves(&self, list: &TreeList, tree: &HyperTree, parts: u32, to: &mut Part) {
        let factor = self.branch_factor as u32;
        let (parents, masked) =
            (bits_of(&list.parents, &tree.parents), bits_of(&list.masked, &tree.vertices));
        let is_set = |bits: &[u8], vertex: usize| bits.get(vertex).is_some_and(|&bit| bit != 0);
        let mut level = vec![(self.corner_of_root(tree.root, parts), false)];
        let (mut size, mut vertex) = (parts, 0);
        while !level.is_empty() {
            let mut next = Vec::new();
            for (low, is_below_masked) in level {
                let is_masked = is_below_masked || is_set(masked, vertex);
                if is_set(parents, vertex) {
                    let child = |child: u32| -> [u32; 3] {
                        let index = [child % factor, child / factor % factor, child / factor / factor];
                        std::array::from_fn(|axis| low[axis].saturating_add(index[axis] * (size / factor)))
                    };
                    next.extend((0..self.child_count() as u32).map(|number| (child(number), is_masked)));
                } else if !is_masked {
                    to.boxes.push(LatticeBox { low, size });
                    to.tuples.push((tree.vertices.start + vertex as u64) as u32);
                }
                vertex += 1;
            }
            level = next;
            size /= factor;
        }
    }
}
