//! Adaptive grids in VTKHDF: overlapping patches by level, and hyper trees.

use super::shared::{GridStep, attributes, components, span};
use crate::formats::amr::{self, Patch};
use crate::formats::blocks;
use crate::formats::contents::{Dataset, Meter, PieceArray, extent_dimensions};
use crate::formats::hdf5::Group;
use crate::formats::hyper_tree::{self, HyperTree, HyperTrees, TreeList};
use crate::formats::lattice::HeaderProgress;
use crate::formats::numbers::Target;
use crate::formats::request::Request;
use glam::DVec3;
use voltet_core::grid::Association;
use voltet_core::progress::{NoProgress, refuse_beyond_memory};
use voltet_core::{Error, Result, counted};

/// Types of these grids.
pub(super) const PATCHES: &str = "OverlappingAMR";
pub(super) const TREES: &str = "HyperTreeGrid";

struct Level {
    group: Group,
    number: usize,
    /// First and last cell along each axis, of each patch.
    extents: Vec<[i64; 6]>,
}

/// Adds the patches of all levels, the blocks of the file.
pub(super) fn add_patches(
    group: &Group,
    step: &GridStep,
    request: &Request,
    dataset: &mut Dataset,
) -> Result<()> {
    let description = group.text("GridDescription")?;
    if let Some(plane) = description.filter(|description| description.trim() != "XYZ") {
        let error = Error::run("the file holds no three-dimensional cells, so there is no volume to draw");
        return Err(error
            .got(format_args!("GridDescription '{plane}'"))
            .expected("'XYZ'")
            .at_item(group.path()));
    }
    let levels = levels(group, step)?;
    let names = |level: &Level| -> Vec<String> {
        (0..level.extents.len()).map(|number| format!("level{}/box{number}", level.number)).collect()
    };
    dataset.blocks = levels.iter().flat_map(names).collect();
    let selected = blocks::selected(&dataset.blocks, request)?;
    let origin = DVec3::from_array(group.vector("Origin", None)?);
    let (mut patches, mut block) = (Vec::new(), 0);
    for level in &levels {
        let spacing = DVec3::from_array(level.group.vector("Spacing", None)?);
        let mut arrays = Vec::new();
        for (association, array, name) in attributes(&level.group, dataset)? {
            let names = match association {
                Association::Point => ["PointDataOffsets", "PointDataOffset"],
                Association::Cell => ["CellDataOffsets", "CellDataOffset"],
            };
            let first = at_step(step, level.number, names, Some(array.name()), 0)?;
            arrays.push((association, array, name, first));
        }
        for extent in &level.extents {
            let cells = extent_dimensions(*extent);
            let product = |n: [u64; 3]| {
                n.iter().try_fold(1_u64, |product, &n| product.checked_mul(n)).unwrap_or(u64::MAX)
            };
            let counts = [product(cells.map(|n| n.saturating_add(1))), product(cells)];
            let is_read = selected[block];
            let mut own = Vec::new();
            for (association, array, name, first) in &mut arrays {
                let count = counts[usize::from(*association == Association::Cell)];
                if is_read {
                    let stored = array.rows(name, span(*first, count), components(array, 1)?)?;
                    own.push(PieceArray::new(*association, stored));
                }
                *first = first.saturating_add(count);
            }
            if is_read {
                let low = DVec3::new(extent[0] as f64, extent[2] as f64, extent[4] as f64);
                let (origin, name) = (origin + low * spacing, dataset.blocks[block].clone());
                patches.push(Patch { block, name, origin, spacing, cells, arrays: own }.checked()?);
            }
            block += 1;
        }
    }
    amr::add(dataset, patches, !selected.contains(&false))
}

fn levels(group: &Group, step: &GridStep) -> Result<Vec<Level>> {
    let mut levels = Vec::new();
    while let Some(level) = group.group(&format!("Level{}", levels.len()))? {
        let number = levels.len();
        let array = level.required_array("AMRBox")?;
        if array.shape().get(1) != Some(&6) {
            let error =
                Error::run("the dataset has the wrong shape").got(format_args!("{:?}", array.shape()));
            return Err(error.expected("6 numbers for each box").at_item(array.path()));
        }
        let all: Vec<i64> = array.numbers()?;
        let all = all.as_chunks().0;
        let first = at_step(step, number, ["AMRBoxOffsets", "AMRBoxOffset"], None, 0)?;
        let count = at_step(step, number, ["NumberOfAMRBoxes", "NumberOfAMRBox"], None, all.len() as u64)?;
        let range =
            usize::try_from(first).ok().zip(first.checked_add(count).and_then(|end| end.try_into().ok()));
        let own = range.and_then(|(first, end): (usize, usize)| all.get(first..end)).ok_or_else(|| {
            let error = Error::run("the step has boxes that the file lacks")
                .got(format_args!("{count} from {first} on"));
            error.expected(format_args!("at most {}", all.len())).at_item(array.path())
        })?;
        levels.push(Level { group: level, number, extents: own.to_vec() });
    }
    let number = |name: &String| name.strip_prefix("Level").and_then(|number| number.parse::<usize>().ok());
    let names = group.names()?;
    if let Some(lost) = names.iter().find(|name| number(name).is_some_and(|number| number >= levels.len())) {
        let error = Error::run("the levels are not numbered without gaps").at_item(group.path());
        return Err(error.got(lost).expected(format_args!("Level{}", levels.len())));
    }
    Ok(levels)
}

/// The number of a level at the step; `names`: of the array, and as version 2.2 has it. `array`: below it.
fn at_step(
    step: &GridStep,
    level: usize,
    names: [&str; 2],
    array: Option<&str>,
    otherwise: u64,
) -> Result<u64> {
    let level = format!("Level{level}");
    let number = |name, otherwise| {
        let path: Vec<&str> = [level.as_str(), name].into_iter().chain(array).collect();
        step.number(&path, otherwise)
    };
    number(names[0], number(names[1], otherwise)?)
}

pub(super) fn add_trees(group: &Group, step: &GridStep, dataset: &mut Dataset) -> Result<()> {
    let part_count = group.required_array("NumberOfTrees")?.shape().first().copied();
    if part_count != Some(1) || step.group.is_some() {
        let error =
            Error::run("hyper trees in several partitions or steps are not read").at_item(group.path());
        return Err(error.expected("one partition without Steps; files .htg of the partitions or steps"));
    }
    let [factor, transposed] = [("BranchFactor", None), ("TransposedRootIndexing", Some([0.0]))]
        .map(|(name, otherwise)| group.vector::<1>(name, otherwise).map(|[number]| number));
    let (branch_factor, dimensions) =
        (factor? as u64, group.vector("Dimensions", None)?.map(|n: f64| n as u64));
    let root_count = hyper_tree::root_count(branch_factor, dimensions)?;
    if group.text("InterfaceNormalsName")?.is_some_and(|name| !name.is_empty()) {
        dataset.warnings.push(hyper_tree::INTERFACES.to_owned());
    }
    let trees = HyperTree::list(
        &numbers(group, "TreeIds", root_count)?,
        &numbers(group, "DepthPerTree", root_count)?,
        &numbers(group, "NumberOfCellsPerTreeDepth", root_count.saturating_mul(hyper_tree::MAX_LEVELS))?,
    )?;
    let vertex_count = trees.last().map_or(0, |tree| tree.vertices.end);
    let mut arrays = Vec::new();
    for (association, array, name) in attributes(group, dataset)? {
        if association == Association::Cell {
            let stored = array.rows(&name, span(0, vertex_count), components(&array, 1)?)?;
            arrays.push(PieceArray::new(association, stored));
        }
    }
    // As many bits as the trees have vertices, eight in a byte.
    let bits = |name: &str, count: u64| -> Result<Vec<u8>> {
        let Some(array) = group.array(name)? else { return Ok(Vec::new()) };
        let len = array.shape().first().map_or(0, |&len| len.min(count.div_ceil(8)));
        refuse_beyond_memory(&HeaderProgress, || counted(8 * len, "bit"), 9 * len)?;
        let bytes: Vec<u8> = array.rows(name, span(0, len), 1)?.load(&Meter::new(&NoProgress, 1))?;
        Ok(bytes.into_iter().flat_map(|byte| (0..8).map(move |bit| byte >> (7 - bit) & 1)).collect())
    };
    let parents = bits("Descriptors", trees.last().map_or(0, |tree| tree.parents.end))?;
    let masked = bits("Mask", vertex_count)?;
    let [nx, ny, nz] = dimensions;
    let coordinates = [("XCoordinates", nx), ("YCoordinates", ny), ("ZCoordinates", nz)];
    let [x, y, z] = coordinates.map(|(name, count)| numbers(group, name, count));
    let trees = HyperTrees {
        branch_factor,
        dimensions,
        coordinates: [x?, y?, z?],
        is_transposed: transposed? != 0.0,
        lists: vec![TreeList { parents, masked, trees, arrays }],
    };
    trees.add(dataset)
}

/// Numbers of an array of so many at most. Errors: it has more, which no file of such a grid needs.
fn numbers<T: Target>(group: &Group, name: &str, greatest: u64) -> Result<Vec<T>> {
    let array = group.required_array(name)?;
    if array.shape().iter().any(|&n| n > greatest) {
        let error = Error::run("the dataset is larger than the hyper tree grid").at_item(array.path());
        return Err(error
            .got(format_args!("{:?}", array.shape()))
            .expected(format_args!("at most {greatest}")));
    }
    array.numbers()
}
