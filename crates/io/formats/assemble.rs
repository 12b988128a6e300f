//! From the table of contents to the grid: decodes what is asked for, puts pieces together, builds tetrahedra.

use super::contents::{Dataset, GHOST_LEVELS, GHOST_TYPE, Geometry, Meter, Piece};
use super::request::{ArraySelection, Component, Request};
use super::{cells, request};
use crate::memory::GridSize;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::grid::{
    Array, Association, CellSet, CellType, Cells, Grid, RawGrid, Scalar, code, structured_corners,
};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, grid, progress};

/// Cell flags that leave a cell out: it is another piece's, it is refined elsewhere, it is hidden
/// (vtkDataSetAttributes::DUPLICATECELL, REFINEDCELL, HIDDENCELL).
const GHOST_CELL: u64 = 1 | 8 | 32;
/// Point flag that leaves out the cells of a point (vtkDataSetAttributes::HIDDENPOINT).
const HIDDEN_POINT: u64 = 2;

/// The degrees of Lagrange and Bezier cells along their axes, as a cell array.
const DEGREES: &str = "HigherOrderDegrees";

/// Reads and builds.
pub(super) fn assemble(dataset: &Dataset, request: &Request, progress: &dyn Progress) -> Result<Grid> {
    let meter = Meter::new(progress, dataset.file_bytes);
    let pieces: Vec<&Piece> =
        dataset.pieces.iter().filter(|p| p.cell_count > 0 && p.point_count > 0).collect();
    let external = pieces.iter().find_map(|piece| match &piece.geometry {
        Geometry::Added(external) => Some(external),
        _ => None,
    });
    if let Some(external) = external {
        let choices = choices(dataset, request)?;
        external.fetch(|name, association| is_read(&choices, name, association), progress)?;
    }
    let cells: Vec<Cells> = pieces.iter().map(|piece| cells::load(piece, &meter)).collect::<Result<_>>()?;
    check_dimension(&cells)?;

    let choices = choices(dataset, request)?;
    let left = unread(dataset, &choices)?;
    if request.every_array {
        for array in pieces.iter().flat_map(|piece| &piece.arrays) {
            if left.arrays.contains(&array.stored.name) {
                let values: Vec<f64> = array.stored.load(&meter)?;
                drop(std::hint::black_box(values));
            }
        }
    }
    refuse_beyond_memory(&pieces, &cells, choices.len(), progress)?;
    let mut loaded = Vec::new();
    for (piece, cells) in pieces.iter().zip(cells) {
        loaded.push(load(piece, cells, &choices, &meter)?);
    }
    let Loaded { points, cells, ghost, degrees, columns } = merge(loaded, &pieces)?;

    let mut parts = RawGrid::new(points, cells);
    (parts.ghost, parts.degrees) = (ghost, degrees);
    parts.origin.warnings = dataset.warnings.clone();
    parts.origin.warnings.extend(external.into_iter().flat_map(|external| external.ready().warnings.clone()));
    parts.origin.arrays_decoded = choices.len() as u64;
    if request.every_array {
        parts.origin.arrays_decoded += left.arrays.len() as u64;
    } else {
        (parts.origin.arrays_unread, parts.origin.values_unread) = (left.arrays, left.value_count);
    }
    let (names, kept) = (unique(&request.point_arrays), unique(&request.cell_arrays));
    let mut columns = choices.iter().zip(columns);
    if let Some((choice, values)) = columns.next() {
        let name = request.scalar.clone().unwrap_or_else(|| choice.name.clone());
        parts.scalar = Some(Scalar { name, association: choice.association, values: values.into() });
    }
    for (i, (choice, values)) in columns.enumerate() {
        let component_count = if choice.component == Component::All { choice.component_count } else { 1 };
        let array = Array { component_count, values: values.into() };
        match names.get(i) {
            Some(name) if choice.association == Association::Cell => {
                parts.cell_arrays.insert(name.to_string(), array)
            }
            Some(name) => parts.point_arrays.insert(name.to_string(), array),
            None => parts.kept_cell_arrays.insert(kept[i - names.len()].clone(), array),
        };
    }
    let &Request { subdivision, cell_values, keep_cells, .. } = request;
    let options = grid::Options { subdivision, cell_values, keep_cells };
    grid::build(parts, &options, progress)
}

/// True if an array is read: it is chosen, or a part of every grid.
fn is_read(choices: &[ArraySelection], name: &str, association: Association) -> bool {
    choices.iter().any(|choice| choice.association == association && choice.name == name)
        || [GHOST_TYPE, GHOST_LEVELS, DEGREES].contains(&name)
}

/// An early error where the grid would not fit into memory. The cells of the file are there already.
fn refuse_beyond_memory(
    pieces: &[&Piece],
    cells: &[Cells],
    array_count: usize,
    progress: &dyn Progress,
) -> Result<()> {
    let mut size =
        GridSize { points: pieces.iter().map(|piece| piece.point_count).sum(), ..GridSize::default() };
    cells.iter().for_each(|cells| size.add(cells));
    let further =
        (array_count as u64 - 1).saturating_mul(size.points.saturating_mul(size_of::<f64>() as u64));
    let what = || format!("a grid of about {} tetrahedra", size.tetrahedra);
    progress::refuse_beyond_memory(progress, what, size.bytes().saturating_add(further))
}

/// The arrays that a request means: the scalar, those beside it on the points, and those that stay on the cells.
pub(super) fn choices(dataset: &Dataset, request: &Request) -> Result<Vec<ArraySelection>> {
    let model = request::model(dataset)?;
    let mut choices = vec![request::scalar(dataset, request.scalar.as_deref(), request.association)?];
    for name in unique(&request.point_arrays) {
        choices.push(request::array(model, name, None)?);
    }
    for name in unique(&request.cell_arrays) {
        choices.push(request::array(model, name, Some(Association::Cell))?);
    }
    Ok(choices)
}

/// Names in ascending order, each once.
fn unique(names: &[String]) -> Vec<&String> {
    names.iter().collect::<BTreeSet<_>>().into_iter().collect()
}

/// An early error where no cell is three-dimensional, before anything else is read.
fn check_dimension(cells: &[Cells]) -> Result<()> {
    let is_volume = |&code: &u8| CellType::from_code(code).is_none_or(|cell_type| cell_type.dimension == 3);
    let mut counts = BTreeMap::<u8, u64>::new();
    let mut flat = false;
    for cells in cells {
        match cells {
            Cells::Mixed(set) if set.types.iter().any(is_volume) => return Ok(()),
            Cells::Mixed(set) => set.types.iter().for_each(|&code| *counts.entry(code).or_default() += 1),
            _ if cells.count() > 0 => return Ok(()),
            // A structured grid with one point along an axis.
            _ => flat = true,
        }
    }
    let found =
        if flat { "a structured grid without thickness".to_owned() } else { grid::describe_counts(&counts) };
    Err(Error::run("the file holds no three-dimensional cells, so there is no volume to draw")
        .got(found)
        .expected("tetrahedra, hexahedra or other cells with a volume"))
}

/// Arrays that nobody asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SkippedArray {
    /// Their names, each once.
    pub arrays: Vec<String>,
    /// Numbers that they hold, as far as headers say.
    pub value_count: u64,
}

/// Arrays that the selection skips.
pub(super) fn unread(dataset: &Dataset, choices: &[ArraySelection]) -> Result<SkippedArray> {
    let (mut arrays, mut value_count) = (Vec::new(), 0u64);
    for array in dataset.pieces.iter().flat_map(|piece| &piece.arrays) {
        let name = &array.stored.name;
        if !is_read(choices, name, array.association) {
            value_count = value_count.saturating_add(array.stored.promised()?.unwrap_or(0));
            if !arrays.contains(name) {
                arrays.push(name.clone());
            }
        }
    }
    Ok(SkippedArray { arrays, value_count })
}

fn load(piece: &Piece, cells: Cells, choices: &[ArraySelection], meter: &Meter) -> Result<Loaded> {
    // The values first: their bytes are there to be counted, those of a uniform grid's points are not.
    let columns = choices.iter().map(|choice| column(piece, choice, meter)).collect::<Result<_>>()?;
    let ghost = ghosts(piece, &cells, meter)?;
    let degrees = degrees(piece, &cells, meter)?;
    Ok(Loaded { points: points(piece, meter)?, cells, ghost, degrees, columns })
}

/// The values of a choice.
pub(super) fn column(piece: &Piece, choice: &ArraySelection, meter: &Meter) -> Result<Vec<f64>> {
    let Some(stored) = piece.array(choice.association, &choice.name) else {
        return Err(Error::run(format!("a piece of the file lacks the array '{}'", choice.name))
            .expected("the same arrays in every piece"));
    };
    let count = stored.component_count;
    if count != choice.component_count {
        return Err(Error::run(format!(
            "the array '{}' differs between the pieces of the file",
            choice.name
        ))
        .got(format_args!("{count} components"))
        .expected(choice.component_count));
    }
    let values: Vec<f64> = stored.load(meter)?;
    Ok(match choice.component {
        Component::All => values,
        Component::Index(_) if count == 1 => values,
        Component::Index(index) => values.into_par_iter().skip(index).step_by(count).collect(),
        Component::Magnitude => values.par_chunks(count).map(length).collect(),
    })
}

/// Length of a vector, without overflow on the way.
pub fn length(vector: &[f64]) -> f64 {
    let scale = vector.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
    if scale == 0.0 || !scale.is_finite() || vector.iter().any(|value| value.is_nan()) {
        return vector.iter().map(|value| value.abs()).sum();
    }
    scale * vector.iter().map(|value| (value / scale).powi(2)).sum::<f64>().sqrt()
}

/// Flags of the cells that are to be left out.
fn ghosts(piece: &Piece, cells: &Cells, meter: &Meter) -> Result<Option<Vec<bool>>> {
    let flags = |association, name, is_set: fn(u64) -> bool| -> Result<Option<Vec<bool>>> {
        let Some(array) = piece.array(association, name) else { return Ok(None) };
        Ok(Some(array.load::<u64>(meter)?.into_iter().map(is_set).collect()))
    };
    let mut ghost = flags(Association::Cell, GHOST_TYPE, |flag| flag & GHOST_CELL != 0)?;
    if ghost.is_none() {
        ghost = flags(Association::Cell, GHOST_LEVELS, |level| level > 0)?;
    }
    let hidden = flags(Association::Point, GHOST_TYPE, |flag| flag & HIDDEN_POINT != 0)?;
    if let Some(hidden) = hidden.filter(|hidden| hidden.contains(&true)) {
        let ghost = ghost.get_or_insert_with(|| vec![false; cells.count()]);
        for (number, ghost) in ghost.iter_mut().enumerate() {
            *ghost |= corners(cells, number).any(|corner| hidden.get(corner as usize) == Some(&true));
        }
    }
    Ok(ghost.filter(|ghost| ghost.contains(&true)))
}

/// The points of a cell; what is damaged is found out when the grid is built.
fn corners(cells: &Cells, number: usize) -> Box<dyn Iterator<Item = u32> + '_> {
    match cells {
        Cells::Tetrahedra(tetrahedra) => Box::new(tetrahedra[number].into_iter()),
        Cells::Mixed(set) => {
            let range = set.offsets[number] as usize..set.offsets[number + 1] as usize;
            Box::new(set.connectivity.get(range).unwrap_or(&[]).iter().copied())
        }
        &Cells::Structured(dimensions) => Box::new(structured_corners(dimensions, number).into_iter()),
    }
}

fn degrees(piece: &Piece, cells: &Cells, meter: &Meter) -> Result<Option<Vec<[u8; 3]>>> {
    let Cells::Mixed(set) = cells else { return Ok(None) };
    match piece.array(Association::Cell, DEGREES).filter(|array| array.component_count == 3) {
        Some(array) if set.types.iter().any(|&code| code >= code::LAGRANGE_TETRAHEDRON) => {
            let values: Vec<u8> = array.load(meter)?;
            Ok(Some(values.as_chunks().0.to_vec()))
        }
        _ => Ok(None),
    }
}

/// The positions of a piece's points.
pub(super) fn points(piece: &Piece, meter: &Meter) -> Result<Vec<DVec3>> {
    match &piece.geometry {
        Geometry::Unstructured { points, .. } | Geometry::Curvilinear { points, .. } => {
            points.load_tuples::<f64, _>(meter)
        }
        Geometry::Added(external) => external.take(None, |read| read.points.take(), meter.progress()),
        Geometry::Rectilinear { axes, .. } => {
            let [x, y, z] = &**axes;
            let (x, y, z): (Vec<f64>, Vec<f64>, Vec<f64>) = (x.load(meter)?, y.load(meter)?, z.load(meter)?);
            Ok(lattice([x.len(), y.len(), z.len()], |[i, j, k]| DVec3::new(x[i], y[j], z[k])))
        }
        &Geometry::Uniform { dimensions, first, origin, spacing, direction } => {
            Ok(lattice(dimensions.map(|n| n as usize), |index| {
                let index = DVec3::from_array(index.map(|i| i as f64));
                origin + direction * (spacing * (first + index))
            }))
        }
    }
}

/// Points of a structured grid, the first index running fastest.
fn lattice([nx, ny, nz]: [usize; 3], position: impl Fn([usize; 3]) -> DVec3 + Sync) -> Vec<DVec3> {
    let mut points = vec![DVec3::ZERO; nx * ny * nz];
    points.par_chunks_mut(nx.max(1)).enumerate().for_each(|(row, points)| {
        for (i, point) in points.iter_mut().enumerate() {
            *point = position([i, row % ny, row / ny]);
        }
    });
    points
}

/// Requested contents of one piece.
pub(super) struct Loaded {
    pub points: Vec<DVec3>,
    pub cells: Cells,
    pub ghost: Option<Vec<bool>>,
    pub degrees: Option<Vec<[u8; 3]>>,
    /// One entry a choice.
    pub columns: Vec<Vec<f64>>,
}

/// Puts pieces together; a single one is handed through.
pub(super) fn merge(mut pieces: Vec<Loaded>, from: &[&Piece]) -> Result<Loaded> {
    if pieces.len() == 1 {
        return Ok(pieces.remove(0));
    }
    let all_tetrahedra = pieces.iter().all(|piece| matches!(piece.cells, Cells::Tetrahedra(_)));
    let has_ghost = pieces.iter().any(|piece| piece.ghost.is_some());
    let has_degrees = pieces.iter().any(|piece| piece.degrees.is_some());
    let mut points = Vec::new();
    let mut tetrahedra = Vec::new();
    let mut set = CellSet { offsets: vec![0], ..CellSet::default() };
    let mut ghost = has_ghost.then(Vec::new);
    let mut degrees = has_degrees.then(Vec::new);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (mut piece, from) in pieces.into_iter().zip(from) {
        let shift = u32::try_from(points.len())
            .ok()
            .filter(|shift| u64::from(*shift) + from.point_count <= u64::from(u32::MAX))
            .ok_or_else(|| {
                Error::run("the grid has too many points")
                    .expected(format_args!("at most {} in all", u32::MAX))
            })?;
        let cell_count = piece.cells.count();
        check_numbers(&piece.cells, piece.points.len())?;
        match piece.cells {
            Cells::Tetrahedra(own) if all_tetrahedra => {
                tetrahedra
                    .par_extend(own.into_par_iter().map(|corners: [u32; 4]| corners.map(|c| c + shift)));
            }
            cells => append(&mut set, cells::into_set(cells, code::VOXEL), shift),
        }
        points.append(&mut piece.points);
        if let Some(ghost) = &mut ghost {
            ghost.extend(piece.ghost.unwrap_or_else(|| vec![false; cell_count]));
        }
        if let Some(degrees) = &mut degrees {
            degrees.extend(piece.degrees.unwrap_or_else(|| vec![[0; 3]; cell_count]));
        }
        columns.resize_with(piece.columns.len(), Vec::new);
        for (all, own) in columns.iter_mut().zip(&mut piece.columns) {
            all.append(own);
        }
    }
    let cells = if all_tetrahedra { Cells::Tetrahedra(tetrahedra) } else { Cells::Mixed(set) };
    Ok(Loaded { points, cells, ghost, degrees, columns })
}

/// That cells name points of their own piece, before the numbers are shifted into another one's.
fn check_numbers(cells: &Cells, point_count: usize) -> Result<()> {
    let wrong = |&&corner: &&u32| corner as usize >= point_count;
    let found = match cells {
        Cells::Tetrahedra(tetrahedra) => tetrahedra.as_flattened().iter().find(wrong),
        Cells::Mixed(set) => {
            let faces = set.polyhedra.iter().flat_map(|polyhedron| polyhedron.faces.iter().flatten());
            set.connectivity.iter().chain(faces).find(wrong)
        }
        Cells::Structured(_) => None,
    };
    match found {
        None => Ok(()),
        Some(corner) => Err(Error::run("a cell names a point that its piece does not hold")
            .got(corner)
            .expected(format_args!("a point number below {point_count}"))),
    }
}

fn append(to: &mut CellSet, own: CellSet, shift: u32) {
    let (first_cell, begin) = (to.types.len() as u32, to.connectivity.len() as u64);
    to.types.extend(own.types);
    to.offsets.extend(own.offsets[1..].iter().map(|offset| offset + begin));
    to.connectivity.extend(own.connectivity.iter().map(|corner| corner + shift));
    for mut polyhedron in own.polyhedra {
        polyhedron.cell += first_cell;
        polyhedron.faces.iter_mut().flatten().for_each(|corner| *corner += shift);
        to.polyhedra.push(polyhedron);
    }
}
