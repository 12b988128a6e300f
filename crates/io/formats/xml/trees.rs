//! Trees of data sets: .vtm (vtkMultiBlockDataSet), .vtpc and .vtpd (partitioned data sets), .vthb (adaptive mesh refinement in
//! patches), and the named parts of a step of a .pvd.
//!
//! A leaf is a file. Its block bears the names of the groups above it and its own with `/` between, where one has none its
//! number. The files of a partitioned data set are pieces of one block. The patches of a .vthb are blocks named by level and number.

use super::header::{self, Element};
use super::named::{HEAD, beside, open_named};
use super::parallel::{PATCHES, TREES, open_step};
use crate::formats::amr::{self, Patch};
use crate::formats::blocks;
use crate::formats::contents::{CellBlocks, Dataset, Geometry, Piece, extent_dimensions};

use crate::formats::request::Request;
use crate::formats::source::Source;
use crate::formats::text::has_mark;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::parallel::all_or_first;
use voltet_core::{Error, Result, counted};

/// Types of files without cells of three dimensions.
const WITHOUT_VOLUME: [&str; 4] = ["PolyData", "PPolyData", "Table", "PTable"];

/// The blocks of a tree, and the files of each.
#[derive(Default)]
pub(super) struct Tree {
    blocks: Vec<String>,
    leaves: Vec<Leaf>,
    /// Files of trees within.
    files: Vec<PathBuf>,
    adaptive_count: usize,
}

/// A file that is a block or a piece of one.
struct Leaf {
    block: usize,
    path: PathBuf,
    /// The file that names it.
    by: PathBuf,
    /// Number of the adaptive grid that it is a patch of, and the extent of its cells where the tree has that.
    patch_of: Option<(usize, Option<[i64; 6]>)>,
}

impl Tree {
    pub fn read(path: &Path, root: &Element) -> Result<Tree> {
        let mut tree = Tree::default();
        tree.add(path, root, "")?;
        Ok(tree)
    }

    /// Adds the tree of a file below a name.
    fn add(&mut self, by: &Path, root: &Element, prefix: &str) -> Result<()> {
        let kind = root.required("type")?;
        let top = root.child(kind).ok_or_else(|| {
            Error::run(format!("the file holds no <{kind}>")).expected("what its type says")
        })?;
        match kind {
            _ if PATCHES.contains(&kind) => self.add_levels(by, top, prefix),
            "vtkPartitionedDataSet" => {
                let name = if prefix.is_empty() { "block 0" } else { prefix };
                self.add_pieces(by, top, name)
            }
            _ => self.add_children(by, top, prefix),
        }
    }

    fn add_children(&mut self, by: &Path, element: &Element, prefix: &str) -> Result<()> {
        for (place, child) in element.children.iter().enumerate() {
            let own = match child.attribute("name").or(child.attribute("Name")) {
                Some(name) if !name.trim().is_empty() => name.trim().to_owned(),
                _ => format!("block {}", child.attribute("index").map_or(place.to_string(), str::to_owned)),
            };
            let name = if prefix.is_empty() { own } else { format!("{prefix}/{own}") };
            match child.tag.as_str() {
                "Block" => self.add_children(by, child, &name)?,
                "Piece" | "Partitions" => self.add_pieces(by, child, &name)?,
                "DataSet" => {
                    let block = self.add_block(name);
                    self.add_leaf(by, child, block);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds the patches of an adaptive grid.
    fn add_levels(&mut self, by: &Path, element: &Element, prefix: &str) -> Result<()> {
        let prefix = if prefix.is_empty() { String::new() } else { format!("{prefix}/") };
        for (place, level) in element.children_of("Block").enumerate() {
            let number = level.attribute("level").map_or(place.to_string(), str::to_owned);
            for (place, child) in level.children_of("DataSet").enumerate() {
                let patch = child.attribute("index").map_or(place.to_string(), str::to_owned);
                let block = self.add_block(format!("{prefix}level{number}/box{patch}"));
                let first = self.leaves.len();
                self.add_leaf(by, child, block);
                let extent = child.numbers("amr_box")?;
                self.leaves[first..]
                    .iter_mut()
                    .for_each(|leaf| leaf.patch_of = Some((self.adaptive_count, extent)));
            }
        }
        self.adaptive_count += 1;
        Ok(())
    }

    fn add_pieces(&mut self, by: &Path, element: &Element, name: &str) -> Result<()> {
        let block = self.add_block(name.to_owned());
        element.children.iter().for_each(|child| self.add_leaf(by, child, block));
        Ok(())
    }

    fn add_block(&mut self, name: String) -> usize {
        self.blocks.push(name);
        self.blocks.len() - 1
    }

    /// Adds the file of an element; one without a file is an empty place in the tree.
    fn add_leaf(&mut self, by: &Path, element: &Element, block: usize) {
        if let Some(file) = element.attribute("file").filter(|file| !file.trim().is_empty()) {
            self.leaves.push(Leaf { block, path: beside(by, file), by: by.to_owned(), patch_of: None });
        }
    }

    /// Adds a part of a step of a series, by its name, which a single one lacks: a tree, or a file of data. True if it is a tree.
    pub fn add_part(&mut self, by: &Path, file: &str, name: &str) -> Result<bool> {
        let path = beside(by, file);
        if let Some(root) = root_of_tree(by, &path)? {
            self.add(&path, &root, name).map_err(|error| error.in_file(&path))?;
            self.files.push(path);
            return Ok(true);
        }
        let block = if name.is_empty() { 0 } else { self.add_block(name.to_owned()) };
        self.leaves.push(Leaf { block, path, by: by.to_owned(), patch_of: None });
        Ok(false)
    }

    /// Files of the blocks that a request selects; all where it names one that is not there, which is an error when they are read.
    pub fn files(self, request: Option<&Request>) -> Vec<PathBuf> {
        let is_read = request.and_then(|request| blocks::selected(&self.blocks, request).ok());
        let is_read =
            |leaf: &Leaf| is_read.as_ref().is_none_or(|is_read| is_read.get(leaf.block) != Some(&false));
        let leaves = self.leaves.into_iter().filter(is_read).map(|leaf| leaf.path);
        self.files.into_iter().chain(leaves).collect()
    }

    /// Reads the tables of contents of the files of the blocks that a request selects. `has_blocks`: their points stay apart.
    pub fn open(self, request: &Request, has_blocks: bool) -> Result<Dataset> {
        let selected = blocks::selected(&self.blocks, request)?;
        let is_read = |block: usize| selected.get(block) != Some(&false);
        let inner = Request { blocks: Vec::new(), time_step: None, ..request.clone() };
        let read = |(place, leaf): (usize, &Leaf)| -> Result<Option<(usize, Dataset)>> {
            let mut part = Dataset::default();
            let opened =
                is_read(leaf.block) && open_leaf(leaf, place, self.leaves.len() > 1, &inner, &mut part)?;
            Ok(opened.then_some((place, part)))
        };
        let parts = all_or_first(self.leaves.par_iter().enumerate().map(read))?;
        let mut dataset = Dataset { has_blocks, ..Dataset::default() };
        let mut is_given = vec![false; self.blocks.len().max(1)];
        let mut patches: Vec<Vec<Patch>> = (0..self.adaptive_count).map(|_| Vec::new()).collect();
        for (place, mut part) in parts.into_iter().flatten() {
            let leaf = &self.leaves[place];
            is_given[leaf.block] = true;
            if let Some((grid, extent)) = leaf.patch_of {
                for piece in part.pieces.drain(..) {
                    let patch = patch(piece, leaf.block, &self.blocks, extent);
                    patches[grid].push(patch.map_err(|error| error.in_file(&leaf.path))?);
                }
            }
            part.pieces.iter_mut().for_each(|piece| piece.blocks = CellBlocks::One(leaf.block));
            dataset.merge(part);
        }
        for patches in patches.into_iter().filter(|patches| !patches.is_empty()) {
            amr::add(&mut dataset, patches, !selected.contains(&false))?;
        }
        let flat =
            self.leaves.iter().map(|leaf| leaf.block).filter(|&block| is_read(block) && !is_given[block]);
        let flat: BTreeSet<usize> = flat.collect();
        let flat = flat.iter().map(|&block| self.blocks[block].as_str());
        dataset.warnings.extend(blocks::blocks_left_out("of surfaces or tables", flat));
        if dataset.pieces.is_empty() {
            return Err(Error::run("no block holds a volume grid")
                .got(counted(self.blocks.len(), "block"))
                .expected("a block of cells with a volume; a node of type surface-reader draws a surface (.vtp) as it is"));
        }
        dataset.blocks = self.blocks;
        Ok(dataset)
    }
}

/// A patch from the piece of its file, an image. `extent`: of its cells, as the tree says.
fn patch(piece: Piece, block: usize, blocks: &[String], extent: Option<[i64; 6]>) -> Result<Patch> {
    let wrong = || Error::run("the file of a patch holds no image");
    let Geometry::Uniform { dimensions, first, origin, spacing, direction } = piece.geometry else {
        return Err(wrong().expected("ImageData"));
    };
    if direction != glam::DMat3::IDENTITY {
        return Err(wrong().got("an image with a Direction").expected("an image along the axes"));
    }
    // Of one with a single point along an axis as many cells as the tree says: none.
    let cells = dimensions.map(|n| n.saturating_sub(1));
    if let Some(extent) =
        extent.map(extent_dimensions).filter(|extent| *extent != cells && !cells.contains(&0))
    {
        let error = Error::run("a patch has other cells than the file that names it says");
        return Err(error
            .got(format_args!("{cells:?}"))
            .expected(format_args!("{extent:?}, by its amr_box")));
    }
    let (origin, name) = (origin + spacing * first, blocks.get(block).cloned().unwrap_or_default());
    Patch { block, name, origin, spacing, cells, arrays: piece.arrays }.checked()
}

/// Reads the table of contents of a leaf; false where it is one of several and is of surfaces or a table. `place`: its number.
fn open_leaf(
    leaf: &Leaf,
    place: usize,
    is_of_several: bool,
    request: &Request,
    to: &mut Dataset,
) -> Result<bool> {
    let source = open_named(&leaf.by, &leaf.path, place)?;
    let read = header::read(&source).and_then(|(root, appended)| {
        if is_of_several && WITHOUT_VOLUME.contains(&root.required("type")?) {
            return Ok(false);
        }
        let part = open_step(source, &root, appended, request, true)?;
        to.merge(part);
        Ok(true)
    });
    read.map_err(|error| error.in_file(&leaf.path))
}

/// The root of a file whose head says that it is a tree.
fn root_of_tree(by: &Path, path: &Path) -> Result<Option<Element>> {
    let source: Arc<Source> = open_named(by, path, 0)?;
    let head = source.head(HEAD)?;
    if !TREES.iter().any(|kind| has_mark(&head, &format!("type=\"{kind}\""))) {
        return Ok(None);
    }
    header::read(&source).map(|(root, _)| Some(root)).map_err(|error| error.in_file(path))
}
