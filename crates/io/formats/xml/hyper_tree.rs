//! Hyper tree grids in XML: .htg of the versions 1 (each tree an element with arrays of its own) and 2 (arrays of all trees).

use super::header::{Appended, Element};
use super::serial::{Context, grid, is_before, marked};
use crate::formats::contents::{Dataset, Meter, Stored};
use crate::formats::hyper_tree::{HyperTree, HyperTrees, INTERFACES, TreeList};
use crate::formats::lattice::HeaderProgress;
use crate::formats::numbers::Target;
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::progress::{NoProgress, refuse_beyond_memory};
use voltet_core::{Error, Result};

/// Type of the files.
pub(super) const KIND: &str = "HyperTreeGrid";

/// Reads the table of contents, and the trees.
pub(super) fn open(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Dataset> {
    let file_bytes = source.len();
    let context = Context::new(source, root, appended)?;
    let version = root.attribute("version").unwrap_or("");
    if is_before(version, [1, 0]) || !is_before(version, [3, 0]) {
        return Err(root.wrong("version", "1.0 or 2.0, as VTK 9 writes them"));
    }
    let element = grid(root, KIND)?;
    let format = format!("VTK XML {KIND}, {}", context.describe());
    let mut dataset = Dataset { format, file_bytes, ..Dataset::default() };
    if element.attribute("InterfaceNormalsName").is_some_and(|name| !name.is_empty()) {
        dataset.warnings.push(INTERFACES.to_owned());
    }
    dataset.active_scalars = marked(element, &["CellData"], "Scalars");
    let dimensions: [u64; 3] = element
        .numbers("Dimensions")?
        .ok_or_else(|| element.wrong("Dimensions", "three numbers of points"))?;
    let section = |tag: &str| {
        element.child(tag).ok_or_else(|| Error::run(format!("the hyper tree grid holds no <{tag}>")))
    };
    let (sides, trees) = (section("Grid")?, section("Trees")?);
    let axis = |name: &str, count: u64| loaded(&context.required(sides, name, Some(count))?);
    let [nx, ny, nz] = dimensions;
    let trees = HyperTrees {
        branch_factor: element.number("BranchFactor")?.unwrap_or(2),
        dimensions,
        coordinates: [axis("XCoordinates", nx)?, axis("YCoordinates", ny)?, axis("ZCoordinates", nz)?],
        is_transposed: element.number::<u8>("TransposedRootIndexing")?.unwrap_or(0) != 0,
        lists: if is_before(version, [2, 0]) {
            trees.children_of("Tree").map(|tree| list_of_tree(&context, tree)).collect::<Result<_>>()?
        } else {
            vec![list_of_all(&context, trees, element)?]
        },
    };
    trees.add(&mut dataset)?;
    Ok(dataset)
}

fn loaded<T: Target>(stored: &Stored) -> Result<Vec<T>> {
    stored.check_backing().map_err(|error| error.at_item(&stored.name))?;
    let count = stored.tuple_count.unwrap_or(0);
    let bytes = count.saturating_mul(size_of::<T>() as u64);
    refuse_beyond_memory(&HeaderProgress, || voltet_core::counted(count, "value"), bytes)?;
    stored.load(&Meter::new(&NoProgress, 1))
}

/// An array that says itself how many values it holds; none where it is not there.
fn counted<T: Target>(context: &Context, section: &Element, name: &str) -> Result<Vec<T>> {
    let Some(element) = context.arrays(section).find(|array| array.attribute("Name") == Some(name)) else {
        return Ok(Vec::new());
    };
    // VTK leaves the number out where it is 0.
    let count = element.number("NumberOfTuples")?.unwrap_or(0);
    loaded(&context.stored(element, Some(count))?)
}

fn list_of_tree(context: &Context, tree: &Element) -> Result<TreeList> {
    let number = |name: &str| -> Result<u64> {
        tree.required(name)?;
        Ok(tree.number(name)?.unwrap_or(0))
    };
    let (root, vertex_count) = (number("Index")?, number("NumberOfVertices")?);
    let read = || {
        let parents: Vec<u8> = counted(context, tree, "Descriptor")?;
        let mut arrays = context.section(tree, "CellData", Association::Cell, vertex_count)?;
        // As VTK called them before its version 9.
        arrays.extend(context.section(tree, "PointData", Association::Cell, vertex_count)?);
        let trees = vec![HyperTree { root, parents: 0..parents.len() as u64, vertices: 0..vertex_count }];
        Ok(TreeList { parents, masked: counted(context, tree, "Mask")?, trees, arrays })
    };
    read().map_err(|error: Error| error.at_item(format!("tree {root}")))
}

fn list_of_all(context: &Context, section: &Element, grid: &Element) -> Result<TreeList> {
    let numbers = |name: &str| counted::<u64>(context, section, name);
    let trees = HyperTree::list(
        &numbers("TreeIds")?,
        &numbers("DepthPerTree")?,
        &numbers("NumberOfVerticesPerDepth")?,
    )?;
    let vertex_count = trees.last().map_or(0, |tree| tree.vertices.end);
    let arrays = context.section(grid, "CellData", Association::Cell, vertex_count)?;
    let bits = |name: &str| counted(context, section, name);
    Ok(TreeList { parents: bits("Descriptors")?, masked: bits("Mask")?, trees, arrays })
}
