//! VTKHDF (.vtkhdf, .hdf): VTK's grids in HDF5, in partitions, blocks and time steps.
//!
//! Source: VTKHDF format specification, version 2.7 (docs.vtk.org, VTK File Formats), and what vtkHDFWriter of VTK 9.7 writes.
//! All partitions of all steps lie one after the other in the same arrays; counts of each partition (`NumberOf…`) and, for
//! steps, offsets (`Steps`) say where each begins. A list of offsets of n cells holds n + 1 numbers.

mod adaptive;
mod shared;

use crate::formats::blocks;
use crate::formats::contents::{
    CellBlocks, Dataset, Geometry, Piece, PieceArray, Stored, StoredCells, StoredFaces, TIME,
    extent_dimensions, structured_counts,
};
use crate::formats::hdf5::{Array, Extent, Group};
use crate::formats::request::Request;
use glam::{DMat3, DVec3};
use shared::{GridArray, GridStep, attributes, components, span};
use std::collections::HashMap;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// Name of the group that holds everything.
pub(super) const ROOT: &str = "VTKHDF";
/// Greatest major version whose files are read.
const VERSION: f64 = 2.0;
/// Group that arranges blocks in a tree.
const ASSEMBLY: &str = "Assembly";
/// Deepest tree of blocks, and most of its nodes.
const MAX_LEVELS: usize = 64;
const MAX_NODES: usize = 100_000;

/// Reads the table of contents.
pub(super) fn open(root: &Group, request: &Request) -> Result<Dataset> {
    let group = root.required_group(ROOT)?;
    let [version, _] = group.vector("Version", Some([VERSION, 0.0]))?;
    if version > VERSION {
        let error = Error::run("the file is of a newer version of VTKHDF").got(version);
        return Err(error.expected(format_args!("at most {VERSION}")));
    }
    let kind = kind(&group)?;
    let mut dataset = Dataset { format: format!("VTKHDF {kind}"), ..Dataset::default() };
    if ["PartitionedDataSetCollection", "MultiBlockDataSet"].contains(&kind.as_str()) {
        dataset.has_blocks = true;
        let (names, groups): (Vec<String>, Vec<Group>) = named_blocks(&group)?.into_iter().unzip();
        let selected = blocks::selected(&names, request)?;
        dataset.blocks = names;
        let mut flat = Vec::new();
        for (block, group) in groups.iter().enumerate().filter(|(block, _)| selected[*block]) {
            if !add(group, Some(block), request, &mut dataset)? {
                flat.push(block);
            }
        }
        let flat = flat.into_iter().map(|block| dataset.blocks[block].as_str());
        dataset.warnings.extend(blocks::blocks_left_out("without a volume that is read", flat));
    } else {
        add(&group, None, request, &mut dataset)?;
    }
    dataset.file_bytes = root.file_bytes();
    Ok(dataset)
}

fn kind(group: &Group) -> Result<String> {
    let missing = || {
        Error::run("the file does not say what it holds").expected("the attribute Type").at_item(group.path())
    };
    // Early files of version 1.0, which has no other cells, lack the attribute.
    let has_cells =
        || group.required_array("Connectivity").and_then(|_| group.required_array("Types")).is_ok();
    match group.text("Type")? {
        None if has_cells() => Ok("UnstructuredGrid".to_owned()),
        found => found.ok_or_else(missing),
    }
}

/// Adds the pieces of a grid, which may be a block; false where that has no volume that is read.
fn add(group: &Group, block: Option<usize>, request: &Request, dataset: &mut Dataset) -> Result<bool> {
    let kind = kind(group)?;
    let pieces: fn(&StepGrid) -> Result<Vec<Piece>> = match kind.as_str() {
        adaptive::PATCHES | adaptive::TREES if block.is_none() => |_| Ok(Vec::new()),
        "UnstructuredGrid" => unstructured,
        "ImageData" => uniform,
        "StructuredGrid" => curvilinear,
        "RectilinearGrid" => rectilinear,
        _ if block.is_some() => return Ok(false),
        _ => return Err(refusal(&kind)),
    };
    let step = GridStep::of_grid(group, request, dataset)?;
    if step.group.is_none() && dataset.time.is_none() {
        dataset.time = time(group)?;
    }
    match kind.as_str() {
        adaptive::PATCHES => adaptive::add_patches(group, &step, request, dataset)?,
        adaptive::TREES => adaptive::add_trees(group, &step, dataset)?,
        _ => {}
    }
    let source = StepGrid { group, step, attributes: attributes(group, dataset)? };
    let blocks = CellBlocks::One(block.unwrap_or(0));
    dataset.pieces.extend(pieces(&source)?.into_iter().map(|piece| piece.with_blocks(blocks.clone())));
    Ok(true)
}

fn refusal(kind: &str) -> Error {
    let error =
        Error::run("this kind of VTKHDF file holds no volume grid").got(format_args!("type '{kind}'"));
    match kind {
        "PolyData" => error.expected("cells with a volume: a surface has to be filled with them by a mesher (Gmsh, TetGen) first"),
        _ => error.expected(
            "UnstructuredGrid, ImageData, StructuredGrid, RectilinearGrid, OverlappingAMR, HyperTreeGrid, PartitionedDataSetCollection or MultiBlockDataSet",
        ),
    }
}

/// The time that the fields of a grid say it is of.
fn time(group: &Group) -> Result<Option<f64>> {
    let Some(fields) = group.group("FieldData")? else { return Ok(None) };
    for name in TIME {
        if let Some(array) = fields.array(name)?.filter(Array::has_numbers) {
            return Ok(array.numbers::<f64>()?.first().copied());
        }
    }
    Ok(None)
}

/// The blocks of a collection with their paths: those of their tree, or their names where they are not in it.
fn named_blocks(group: &Group) -> Result<Vec<(String, Group)>> {
    let mut blocks = Vec::new();
    for block in group.groups()? {
        if block.name() != ASSEMBLY && block.text("Type")?.is_some() {
            let index = block.numbers("Index")?.and_then(|index| index.first().copied());
            blocks.push((index.unwrap_or(f64::INFINITY), String::new(), block));
        }
    }
    blocks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut numbers = HashMap::new();
    for (number, block) in blocks.iter().enumerate() {
        numbers.entry(block.2.identity()).or_insert(number);
    }
    if let Some(tree) = group.group(ASSEMBLY)? {
        let too_large = || Error::run("the tree of blocks contains itself, or is too large");
        let mut nodes = vec![(String::new(), vec![tree.identity()], tree)];
        let mut count = 0;
        while let Some((path, above, node)) = nodes.pop() {
            for child in node.groups()? {
                count += 1;
                if count > MAX_NODES {
                    return Err(too_large().at_item(child.path()));
                }
                let own = if path.is_empty() {
                    child.name().to_owned()
                } else {
                    format!("{path}/{}", child.name())
                };
                if let Some(&number) = numbers.get(&child.identity()) {
                    if blocks[number].1.is_empty() {
                        blocks[number].1 = own;
                    }
                } else if above.contains(&child.identity()) || above.len() > MAX_LEVELS {
                    return Err(too_large().at_item(child.path()));
                } else {
                    nodes.push((own, [&above[..], &[child.identity()]].concat(), child));
                }
            }
        }
    }
    let named = |(_, path, block): (f64, String, Group)| {
        (if path.is_empty() { block.name().to_owned() } else { path }, block)
    };
    Ok(blocks.into_iter().map(named).collect())
}

struct StepGrid<'a> {
    group: &'a Group,
    step: GridStep,
    attributes: Vec<GridArray>,
}

/// Numbers of each partition.
struct Counts {
    points: Vec<u64>,
    cells: Vec<u64>,
    connectivity: Vec<u64>,
}

/// Sum of the first numbers.
fn sum(counts: &[u64]) -> Result<u64> {
    let sum = counts.iter().try_fold(0_u64, |sum, &count| sum.checked_add(count));
    sum.ok_or_else(|| Error::run("the numbers of the partitions are damaged").got("a sum beyond 64 bits"))
}

fn unstructured(source: &StepGrid) -> Result<Vec<Piece>> {
    let StepGrid { group, step, .. } = source;
    let numbers = |name: &str| group.required_array(name)?.numbers::<u64>();
    let counts = Counts {
        points: numbers("NumberOfPoints")?,
        cells: numbers("NumberOfCells")?,
        connectivity: numbers("NumberOfConnectivityIds")?,
    };
    let all = counts.points.len();
    if [counts.cells.len(), counts.connectivity.len()] != [all; 2] {
        let found = format!("{all}, {} and {}", counts.cells.len(), counts.connectivity.len());
        let error = Error::run("NumberOfPoints, NumberOfCells and NumberOfConnectivityIds differ in length");
        return Err(error
            .got(found)
            .expected("one number of each for every partition")
            .at_item(group.path()));
    }
    let first = step.number(&["PartOffsets"], 0)?;
    let count = step.number(&["NumberOfParts"], if step.group.is_some() { 1 } else { all as u64 })?;
    let Some(end) = first.checked_add(count).filter(|&end| end <= all as u64) else {
        let error = Error::run("the step has partitions that the file lacks")
            .got(format_args!("{count} from {first} on"));
        return Err(error.expected(format_args!("at most {all}")).at_item(group.path()));
    };
    let (first, end) = (first as usize, end as usize);
    let offset = |name: &str, counts: &[u64]| step.number(&[name], sum(&counts[..first])?);
    let mut point = offset("PointOffsets", &counts.points)?;
    let mut cell = offset("CellOffsets", &counts.cells)?;
    let mut id = offset("ConnectivityIdOffsets", &counts.connectivity)?;
    let mut attributes = Vec::new();
    for (association, array, name) in &source.attributes {
        let (section, otherwise) = match association {
            Association::Point => ("PointDataOffsets", point),
            Association::Cell => ("CellDataOffsets", cell),
        };
        attributes.push((*association, array, name, step.number(&[section, array.name()], otherwise)?));
    }
    let arrays = ["Points", "Types", "Offsets", "Connectivity"].map(|name| group.required_array(name));
    let [points, types, offsets, connectivity] = arrays;
    let (points, types, offsets, connectivity) = (points?, types?, offsets?, connectivity?);
    let faces = Faces::of_grid(group)?;
    let mut pieces = Vec::new();
    for part in first..end {
        let (point_count, cell_count, id_count) =
            (counts.points[part], counts.cells[part], counts.connectivity[part]);
        if cell_count > 0 && point_count > 0 {
            let with_end = span(cell.saturating_add(part as u64), cell_count.saturating_add(1));
            let cells = StoredCells::Offsets {
                connectivity: connectivity.rows("Connectivity", span(id, id_count), 1)?,
                offsets: offsets.rows("Offsets", with_end.clone(), 1)?,
                types: types.rows("Types", span(cell, cell_count), 1)?,
                faces: faces.as_ref().map_or(Ok(StoredFaces::None), |faces| faces.of_part(part, with_end))?,
            };
            let arrays = attributes.iter().map(|&(association, array, name, from)| {
                let count = if association == Association::Point { point_count } else { cell_count };
                let components = components(array, 1)?;
                Ok(PieceArray::new(association, array.rows(name, span(from, count), components)?))
            });
            let points = points.rows("Points", span(point, point_count), 3)?;
            let geometry = Geometry::Unstructured { points, cells: Box::new(cells) };
            pieces.push(Piece::new([point_count, cell_count], geometry, arrays.collect::<Result<_>>()?));
        }
        point = point.saturating_add(point_count);
        cell = cell.saturating_add(cell_count);
        id = id.saturating_add(id_count);
        for (association, _, _, from) in &mut attributes {
            *from = from.saturating_add(if *association == Association::Point {
                point_count
            } else {
                cell_count
            });
        }
    }
    Ok(pieces)
}

/// Faces of polyhedra: the points of each face, and the faces of each cell.
struct Faces {
    arrays: [Array; 4],
    /// Faces, their points, and faces of cells, of each partition.
    counts: [Vec<u64>; 3],
}

impl Faces {
    fn of_grid(group: &Group) -> Result<Option<Faces>> {
        if group.array("FaceConnectivity")?.is_none() {
            return Ok(None);
        }
        let array = |name: &str| group.required_array(name);
        let count = |name: &str| group.required_array(name)?.numbers::<u64>();
        Ok(Some(Faces {
            arrays: [
                array("FaceConnectivity")?,
                array("FaceOffsets")?,
                array("PolyhedronToFaces")?,
                array("PolyhedronOffsets")?,
            ],
            counts: [
                count("NumberOfFaces")?,
                count("NumberOfFaceConnectivityIds")?,
                count("NumberOfPolyhedronToFaceIds")?,
            ],
        }))
    }

    /// `with_end`: the offsets of the partition's cells.
    fn of_part(&self, part: usize, with_end: std::ops::Range<u64>) -> Result<StoredFaces> {
        let [points, point_offsets, faces, face_offsets] = &self.arrays;
        let bounds = |counts: &[u64]| -> Result<(u64, u64)> {
            let missing = || {
                Error::run("the file lacks the number of faces of a partition")
                    .got(counts.len())
                    .expected(part + 1)
            };
            let count = *counts.get(part).ok_or_else(missing)?;
            Ok((sum(&counts[..part])?, count))
        };
        let [of_faces, of_points, of_cells] = &self.counts;
        let ((face, face_count), (point, point_count), (own, own_count)) =
            (bounds(of_faces)?, bounds(of_points)?, bounds(of_cells)?);
        let rows = |array: &Array, rows| array.rows(array.name(), rows, 1).map(Box::new);
        // The first offset of a list is 0 and says nothing.
        Ok(StoredFaces::Indexed {
            points: rows(points, span(point, point_count))?,
            point_offsets: rows(point_offsets, span(face.saturating_add(part as u64 + 1), face_count))?,
            faces: rows(faces, span(own, own_count))?,
            face_offsets: rows(face_offsets, with_end.start.saturating_add(1)..with_end.end)?,
        })
    }
}

fn structured(source: &StepGrid, dimensions: [u64; 3], geometry: Geometry) -> Result<Vec<Piece>> {
    let (point_count, cell_count) = structured_counts(dimensions)?;
    let mut arrays = Vec::new();
    for (association, array, name) in &source.attributes {
        let (section, tuple_count, axes) = match association {
            Association::Point => ("PointDataOffsets", point_count, dimensions),
            Association::Cell => {
                ("CellDataOffsets", cell_count, dimensions.map(|n| n.saturating_sub(1).max(1)))
            }
        };
        let offset = [section, array.name()];
        arrays.push(PieceArray::new(*association, of_step(source, array, name, axes, tuple_count, &offset)?));
    }
    Ok(vec![Piece::new([point_count, cell_count], geometry, arrays)])
}

/// An array over a box of points or cells (the last axis of the file runs along x), at the step; `offset`: path of its offsets.
fn of_step(
    source: &StepGrid,
    array: &Array,
    name: &str,
    [nx, ny, nz]: [u64; 3],
    tuple_count: u64,
    offset: &[&str],
) -> Result<Stored> {
    let mut part: Vec<Extent> = array.shape().iter().map(|&n| (0, n, 1)).collect();
    let has_steps = source.step.group.is_some() && array.shape().get(1..4) == Some(&[nz, ny, nx]);
    if let Some(first) = part.first_mut().filter(|_| has_steps) {
        *first = (source.step.number(offset, source.step.index as u64)?, 1, 1);
    }
    let count = part.iter().try_fold(1_u64, |product, axis| product.checked_mul(axis.1)).unwrap_or(0);
    let components = count.checked_div(tuple_count).unwrap_or(0);
    if components == 0 || components.checked_mul(tuple_count) != Some(count) {
        let error = Error::run("the dataset has the wrong shape").got(format_args!("{:?}", array.shape()));
        return Err(error
            .expected(format_args!("[{nz}, {ny}, {nx}], with components after it"))
            .at_item(array.path()));
    }
    array.part(name, &part, components as usize)
}

fn uniform(source: &StepGrid) -> Result<Vec<Piece>> {
    let group = source.group;
    let extent: [f64; 6] = group.vector("WholeExtent", None)?;
    let dimensions = extent_dimensions(extent.map(|index| index as i64));
    let geometry = Geometry::Uniform {
        dimensions,
        first: DVec3::new(extent[0], extent[2], extent[4]),
        origin: DVec3::from_array(group.vector("Origin", Some([0.0; 3]))?),
        spacing: DVec3::from_array(group.vector("Spacing", Some([1.0; 3]))?),
        // The rows of the matrix are written one after the other.
        direction: DMat3::from_cols_array(&group.vector("Direction", Some(DMat3::IDENTITY.to_cols_array()))?)
            .transpose(),
    };
    structured(source, dimensions, geometry)
}

/// Numbers of points along each axis.
fn dimensions(group: &Group) -> Result<[u64; 3]> {
    Ok(group.vector("Dimensions", None)?.map(|n: f64| n as u64))
}

fn curvilinear(source: &StepGrid) -> Result<Vec<Piece>> {
    let dimensions = dimensions(source.group)?;
    let (point_count, _) = structured_counts(dimensions)?;
    let array = source.group.required_array("Points")?;
    let points = of_step(source, &array, "Points", dimensions, point_count, &["PointOffsets"])?;
    if points.component_count != 3 {
        let error = Error::run("the points have the wrong number of coordinates").got(points.component_count);
        return Err(error.expected(3).at_item(array.path()));
    }
    structured(source, dimensions, Geometry::Curvilinear { dimensions, points })
}

fn rectilinear(source: &StepGrid) -> Result<Vec<Piece>> {
    let dimensions = dimensions(source.group)?;
    let axis = |name: &str, count: u64| -> Result<Stored> {
        let array = source.group.required_array(name)?;
        let has_steps = source.step.group.is_some() && array.shape().len() == 2;
        let mut part: Vec<Extent> = array.shape().iter().map(|&n| (0, n, 1)).collect();
        if let Some(first) = part.first_mut().filter(|_| has_steps) {
            *first = (source.step.index as u64, 1, 1);
        }
        let stored = array.part(name, &part, 1)?;
        match stored.tuple_count {
            Some(found) if found != count => Err(Error::run("an axis has the wrong number of coordinates")
                .got(found)
                .expected(count)
                .at_item(array.path())),
            _ => Ok(stored),
        }
    };
    let axes = [
        axis("XCoordinates", dimensions[0])?,
        axis("YCoordinates", dimensions[1])?,
        axis("ZCoordinates", dimensions[2])?,
    ];
    structured(source, dimensions, Geometry::Rectilinear { dimensions, axes: Box::new(axes) })
}
