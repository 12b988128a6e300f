//! From the table of contents to the grid: decodes what is asked for, has pieces put together and tetrahedra built.

use super::contents::{
    BLOCK, CellBlocks, DEGREES, Dataset, GHOST_LEVELS, GHOST_TYPE, GLOBAL_IDS, Geometry, Meter,
    NumberedPiece, OpenPiece, Piece, PieceArray, grid_of, structured_counts,
};
use super::request::{ArraySelection, Component, Request};
use super::vectors::length;
use super::{blocks, cells, hexahedra, request};
use crate::memory::GridSize;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::grid::{
    Array, Association, CellType, CellValues, Cells, Grid, Options, RawGrid, Scalar, code,
};
use voltet_core::parallel::all_or_first;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, counted, grid, progress};

/// Cell flags of ghosts and of hidden cells (vtkDataSetAttributes::DUPLICATECELL, HIDDENCELL).
const DUPLICATE_CELL: u8 = 1;
const HIDDEN_CELL: u8 = 32;
const CELL_FLAGS: u64 = 63;
/// Point flag that leaves out the cells of a point (vtkDataSetAttributes::HIDDENPOINT).
const HIDDEN_POINT: u64 = 2;

pub(super) fn assemble(dataset: &Dataset, request: &Request, progress: &dyn Progress) -> Result<Grid> {
    let meter = Meter::new(progress, dataset.file_bytes);
    let pieces = pieces_with_cells(dataset);
    let open = fetch(dataset, &pieces, request, progress)?;
    let cells: Vec<Cells> = all_or_first(pieces.par_iter().map(|piece| cells::load(piece.1, &meter)))?;
    let has_cells = cells.iter().any(|cells| cells.count() > 0);
    if !(request.options.without_tetrahedra && has_cells) {
        check_dimension(&cells)?;
    }
    let choices = choices(dataset, request)?;
    let is_unsplit = is_unsplit(request, &choices);
    if !is_unsplit {
        check_dimension(&cells)?;
    }

    let (kept, sentences) = match is_unsplit {
        true => {
            let mut sentences = blocks::blocks_to_fill(dataset, &choices);
            sentences.extend(blocks::blocks_without_cells(dataset, &pieces, &cells));
            (pieces.into_iter().zip(cells).collect(), sentences)
        }
        false => {
            blocks::drawn_pieces(dataset, pieces.into_iter().zip(cells).collect(), has_volume, &choices)?
        }
    };
    let left = unread(dataset, &choices)?;
    // For comparison: what is not read otherwise is decoded and dropped.
    if request.every_array {
        for array in kept.iter().flat_map(|((_, piece), _)| &piece.arrays) {
            if left.arrays.contains(&array.stored.name) {
                let values: Vec<f64> = array.stored.load(&meter)?;
                drop(std::hint::black_box(values));
            }
        }
    }
    let loaded = load_all(dataset, kept, request, &choices, &meter)?;
    let mut parts = grid::join(loaded.into_iter().map(|piece| piece.1).collect())?;
    describe(&mut parts, dataset, request, &choices)?;
    parts.origin.warnings.extend(sentences);
    parts.origin.warnings.extend(open.iter().flat_map(|open| open.ready().warnings.clone()));
    if request.every_array {
        parts.origin.arrays_decoded += left.arrays.len() as u64;
    } else {
        (parts.origin.arrays_unread, parts.origin.values_unread) = (left.arrays, left.value_count);
    }
    grid::build(parts, &Options { without_tetrahedra: is_unsplit, ..request.options }, progress)
}

pub(super) fn pieces_with_cells(dataset: &Dataset) -> Vec<NumberedPiece<'_>> {
    let pieces = dataset.pieces.iter().enumerate();
    pieces.filter(|(_, piece)| piece.cell_count > 0 && piece.point_count > 0).collect()
}

/// Loads pieces whose cells are there already, side by side. Errors: that of the first piece that has one; memory ends before the grid
/// that is made of them is there.
pub(super) fn load_all(
    dataset: &Dataset,
    pieces: Vec<(NumberedPiece, Cells)>,
    request: &Request,
    choices: &[ArraySelection],
    meter: &Meter,
) -> Result<Vec<(usize, RawGrid)>> {
    let is_unsplit = is_unsplit(request, choices);
    check_memory(&pieces, choices.len(), is_unsplit, meter.progress())?;
    let (ids, fills) = (global_ids(dataset), is_unsplit && dataset.has_blocks);
    let wanted = PieceRequest { request, choices, ids, fills };
    all_or_first(pieces.into_par_iter().map(|((index, piece), cells)| {
        let block = group(dataset, piece, index);
        Ok((index, RawGrid { block, ..load(piece, cells, &wanted, meter)? }))
    }))
}

/// Adds to a grid what the table of contents says of all of the file.
pub(super) fn describe(
    parts: &mut RawGrid,
    dataset: &Dataset,
    request: &Request,
    choices: &[ArraySelection],
) -> Result<()> {
    parts.origin.warnings.extend(dataset.warnings.iter().cloned());
    parts.origin.blocks.clone_from(&dataset.blocks);
    parts.origin.time = match dataset.time_steps.as_slice() {
        [] => dataset.time,
        times => Some(times[request.step_index(times)?]),
    };
    parts.origin.units = units(dataset, request, choices);
    parts.origin.arrays_decoded = choices.len() as u64;
    Ok(())
}

/// Units that the file states of the arrays that are read, by the names that these are read under.
fn units(dataset: &Dataset, request: &Request, choices: &[ArraySelection]) -> BTreeMap<String, String> {
    let scalar = (!request.without_scalar).then_some(request.scalar.as_ref());
    let others = unique(&request.point_arrays).into_iter().chain(unique(&request.cell_arrays));
    let names = scalar.into_iter().chain(others.map(Some));
    let unit = |choice: &ArraySelection| {
        let mut arrays = dataset.pieces.iter().flat_map(|piece| piece.arrays_of(choice.association));
        arrays.find(|array| array.stored.name == choice.name).and_then(|array| array.unit.clone())
    };
    let entry = |(name, choice): (Option<&String>, &ArraySelection)| {
        unit(choice).map(|unit| (name.unwrap_or(&choice.name).clone(), unit))
    };
    names.zip(choices).filter_map(entry).collect()
}

/// True if the file's cells are taken as they are, and no tetrahedra are made: none are asked for, and no value needs them, as means of
/// cell values do.
pub(super) fn is_unsplit(request: &Request, choices: &[ArraySelection]) -> bool {
    let point_arrays = unique(&request.point_arrays).len();
    request.options.without_tetrahedra
        && request.without_scalar
        && choices[..point_arrays].iter().all(|choice| choice.association == Association::Point)
}

/// True if points get means of cell values.
pub(super) fn is_averaged(request: &Request, choices: &[ArraySelection]) -> bool {
    request.options.cell_values == CellValues::Average
        && choices.iter().any(|choice| choice.association == Association::Cell)
}

/// Checks that memory holds the open grids; has each read in one pass with its arrays, a single one at once. Gives all of them.
///
/// Errors: memory ends before all are there.
pub(super) fn fetch<'a>(
    dataset: &Dataset,
    pieces: &[NumberedPiece<'a>],
    request: &Request,
    progress: &dyn Progress,
) -> Result<Vec<&'a OpenPiece>> {
    let open = |piece: &'a Piece| match &piece.geometry {
        Geometry::Open(open) => Some((piece, &**open)),
        _ => None,
    };
    let open: Vec<(&Piece, &OpenPiece)> = pieces.iter().filter_map(|own| open(own.1)).collect();
    if open.is_empty() {
        return Ok(Vec::new());
    }
    let choices = choices(dataset, request)?;
    // Of blocks, those that lack an array are not drawn.
    let is_whole = |piece: &Piece| {
        let mut own = choices.iter().map(|choice| piece.array(choice.association, &choice.name));
        !dataset.has_blocks || is_unsplit(request, &choices) || own.all(|array| array.is_some())
    };
    let places = |&(piece, own): &(&Piece, &OpenPiece)| match is_whole(piece) {
        true => own.places(piece, |array| is_read(&choices, array)),
        false => Vec::new(),
    };
    let places: Vec<Vec<usize>> = open.iter().map(places).collect();
    let bytes = open.iter().zip(&places).map(|(own, places)| own.1.byte_count(true, places));
    let cell_count = pieces.iter().map(|piece| piece.1.cell_count).fold(0, u64::saturating_add);
    let point_count = point_count(pieces.iter().map(|piece| piece.1));
    let what = || grid_of(point_count, cell_count);
    refuse_beyond_memory(progress, pieces.len(), what, bytes.fold(0, u64::saturating_add))?;
    match (&open[..], &places[..]) {
        // A reader from outside has one piece, and is called from here.
        ([(_, own)], [places]) => own.read(true, places, progress)?,
        // Those of others are read side by side as they are taken.
        _ => open.iter().zip(places).for_each(|(own, places)| own.1.read_ahead(places)),
    }
    Ok(open.into_iter().map(|own| own.1).collect())
}

/// Refuses pieces that take more memory than is left; several can be read one after the other.
fn refuse_beyond_memory(
    progress: &dyn Progress,
    piece_count: usize,
    what: impl FnOnce() -> String,
    bytes: u64,
) -> Result<()> {
    progress::refuse_beyond_memory(progress, what, bytes).map_err(|error| match piece_count {
        0 | 1 => error,
        _ => {
            error.expected("more memory, or voltet run --memory SIZE, which reads pieces one after the other")
        }
    })
}

/// Number of the grid that a piece is of; points of different ones stay apart.
pub(super) fn group(dataset: &Dataset, piece: &Piece, index: usize) -> usize {
    match piece.blocks {
        _ if !dataset.has_blocks => 0,
        CellBlocks::One(block) | CellBlocks::Each { grid: Some(block), .. } => block,
        // Numbers of blocks come first.
        _ => dataset.blocks.len() + index,
    }
}

/// Name of the array that numbers the points of all pieces; `None` where no grid has several pieces, or where one lacks it.
pub(super) fn global_ids(dataset: &Dataset) -> Option<&str> {
    let in_all = |name: &&str| {
        dataset.pieces.iter().filter(|piece| piece.point_count > 0).all(|piece| {
            piece.array(Association::Point, name).is_some_and(|stored| stored.component_count == 1)
        })
    };
    let names = dataset.global_ids.as_deref().into_iter().chain(GLOBAL_IDS);
    let grids: BTreeSet<usize> =
        dataset.pieces.iter().enumerate().map(|(index, piece)| group(dataset, piece, index)).collect();
    names.filter(|_| grids.len() < dataset.pieces.len()).find(in_all)
}

/// True if an array is read: it is chosen, or says which cells are ghosts or of which degree.
fn is_read(choices: &[ArraySelection], array: &PieceArray) -> bool {
    let name = &array.stored.name;
    choices.iter().any(|choice| choice.association == array.association && choice.name == *name)
        || [GHOST_TYPE, GHOST_LEVELS, DEGREES].contains(&name.as_str())
}

fn point_count<'a>(pieces: impl Iterator<Item = &'a Piece>) -> u64 {
    pieces.map(|piece| piece.point_count).fold(0, u64::saturating_add)
}

/// An early error where the grid would not fit into memory. The cells of the file are there already, and what was read with them.
fn check_memory(
    pieces: &[(NumberedPiece, Cells)],
    array_count: usize,
    is_unsplit: bool,
    progress: &dyn Progress,
) -> Result<()> {
    let points = point_count(pieces.iter().map(|((_, piece), _)| *piece));
    let mut size = GridSize { points, ..GridSize::default() };
    if !is_unsplit {
        pieces.iter().for_each(|(_, cells)| size.add(cells));
    }
    let further = (array_count as u64)
        .saturating_sub(1)
        .saturating_mul(size.points.saturating_mul(size_of::<f64>() as u64));
    let what = || match is_unsplit {
        true => format!("a grid of {}", counted(size.points, "point")),
        false => format!("a grid of about {}", counted(size.tetrahedra, "tetrahedron")),
    };
    let ready = |((_, piece), _): &(NumberedPiece, Cells)| match &piece.geometry {
        Geometry::Open(open) => open.ready_bytes(array_count),
        _ => 0,
    };
    let ready = pieces.iter().map(ready).fold(0, u64::saturating_add);
    let bytes = size.bytes().saturating_add(further).saturating_sub(ready);
    refuse_beyond_memory(progress, pieces.len(), what, bytes)
}

/// The arrays that a request means: the scalar, those beside it on the points, those that stay on the cells, the displacement.
pub(super) fn choices(dataset: &Dataset, request: &Request) -> Result<Vec<ArraySelection>> {
    let model = &request::model(dataset)?;
    let scalar = || request::scalar(dataset, request.scalar.as_deref(), request.association);
    let mut choices = Vec::new();
    if !request.without_scalar {
        choices.push(scalar()?);
    }
    let [of_points, of_cells] = &request.origins;
    for (names, origins, association) in
        [(&request.point_arrays, of_points, None), (&request.cell_arrays, of_cells, Some(Association::Cell))]
    {
        for name in unique(names) {
            let locate = |error| origins.get(name).into_iter().fold(error, |error, at| at.locate(error));
            choices.push(request::array(model, name, association).map_err(locate)?);
        }
    }
    if let Some((name, _)) = &request.displacement {
        choices.push(request::vector(model, name)?);
    }
    Ok(choices)
}

/// Names in ascending order, each once.
pub(super) fn unique(names: &[String]) -> Vec<&String> {
    names.iter().collect::<BTreeSet<_>>().into_iter().collect()
}

/// True if some cell is three-dimensional.
pub(super) fn has_volume(cells: &Cells) -> bool {
    let is_volume = |&code: &u8| CellType::from_code(code).is_none_or(|cell_type| cell_type.dimension == 3);
    match cells {
        Cells::Mixed(set) => set.types.iter().any(is_volume),
        _ => cells.count() > 0,
    }
}

/// An early error where no cell is three-dimensional, before anything else is read.
fn check_dimension(cells: &[Cells]) -> Result<()> {
    if cells.iter().any(has_volume) {
        return Ok(());
    }
    let mut counts = BTreeMap::<u8, u64>::new();
    let mut flat = false;
    for cells in cells {
        match cells {
            Cells::Mixed(set) => set.types.iter().for_each(|&code| *counts.entry(code).or_default() += 1),
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

pub(super) fn unread(dataset: &Dataset, choices: &[ArraySelection]) -> Result<SkippedArray> {
    unread_of(dataset, dataset.pieces.iter(), choices)
}

pub(super) fn unread_of<'a>(
    dataset: &Dataset,
    pieces: impl Iterator<Item = &'a Piece>,
    choices: &[ArraySelection],
) -> Result<SkippedArray> {
    let (mut arrays, mut value_count) = (Vec::new(), 0u64);
    let ids = global_ids(dataset);
    for array in pieces.flat_map(|piece| &piece.arrays) {
        let name = &array.stored.name;
        let is_own = !dataset.blocks.is_empty() && name == BLOCK && array.association == Association::Cell;
        if !is_own && !is_read(choices, array) && ids != Some(name) {
            value_count = value_count.saturating_add(array.stored.promised()?.unwrap_or(0));
            if !arrays.contains(name) {
                arrays.push(name.clone());
            }
        }
    }
    Ok(SkippedArray { arrays, value_count })
}

pub(super) struct PieceRequest<'a> {
    pub request: &'a Request,
    /// The scalar, and the arrays that the request names.
    pub choices: &'a [ArraySelection],
    /// The array that numbers the points of all pieces.
    pub ids: Option<&'a str>,
    /// True if a piece that lacks an array has NaN for it.
    pub fills: bool,
}

/// A piece as the import takes it.
pub(super) fn load(piece: &Piece, mut cells: Cells, wanted: &PieceRequest, meter: &Meter) -> Result<RawGrid> {
    if let Geometry::Open(open) = &piece.geometry {
        open.read_ahead(open.places(piece, |array| is_read(wanted.choices, array)));
    }
    // The values first, for progress: they are bytes of the file, the points of a uniform grid are not.
    let mut columns = wanted.choices.iter().zip(columns(piece, wanted, meter)?);
    let ghost = ghosts(piece, &cells, meter)?;
    let degrees = degrees(piece, &cells, meter)?;
    let ids = wanted.ids.and_then(|name| piece.array(Association::Point, name));
    let global_ids = ids.map(|ids| ids.load(meter)).transpose()?;
    let points = load_points(piece, meter)?;
    let trimmed = cells::leave_out_further_points(&mut cells);
    let warning = hexahedra::restore_order(&mut cells, &points, degrees.as_deref(), piece.is_old_order);
    let mut raw = RawGrid { ghost, degrees, global_ids, ..RawGrid::new(points, cells) };
    raw.origin.warnings.extend(trimmed.into_iter().chain(warning));
    // Means of cell values alone look at hanging points.
    if let Geometry::Adaptive(lattice) = &piece.geometry
        && is_averaged(wanted.request, wanted.choices)
    {
        raw.hanging = Some(lattice.hanging());
    }
    if !wanted.request.without_scalar
        && let Some((choice, values)) = columns.next()
    {
        let name = wanted.request.scalar.clone().unwrap_or_else(|| choice.name.clone());
        add_boundary(&mut raw, &name, piece, choice, wanted, meter)?;
        raw.scalar = Some(Scalar { name, association: choice.association, values: values.into() });
    }
    let (names, kept) = (unique(&wanted.request.point_arrays), unique(&wanted.request.cell_arrays));
    for (i, (choice, values)) in columns.enumerate() {
        let component_count = if choice.component == Component::All { choice.component_count } else { 1 };
        let array = Array { component_count, values: values.into() };
        match names.get(i) {
            Some(name) if choice.association == Association::Cell => {
                add_boundary(&mut raw, name, piece, choice, wanted, meter)?;
                raw.cell_arrays.insert(name.to_string(), array)
            }
            Some(name) => raw.point_arrays.insert(name.to_string(), array),
            None => match kept.get(i - names.len()) {
                Some(name) => raw.kept_cell_arrays.insert(name.to_string(), array),
                None => {
                    move_points(raw.points.make_mut(), &array.values, wanted.request);
                    None
                }
            },
        };
    }
    Ok(raw)
}

/// Adds what the file states of a chosen array at the boundary, where cell values become means at points.
fn add_boundary(
    raw: &mut RawGrid,
    name: &str,
    piece: &Piece,
    choice: &ArraySelection,
    wanted: &PieceRequest,
    meter: &Meter,
) -> Result<()> {
    if wanted.request.options.cell_values != CellValues::Average || choice.association != Association::Cell {
        return Ok(());
    }
    let mut arrays = piece.arrays_of(Association::Cell).filter(|array| array.stored.name == choice.name);
    let Some(compute) = arrays.next().and_then(|array| array.boundary.as_ref()) else { return Ok(()) };
    let (mut own, warnings) = compute(meter)?;
    raw.origin.warnings.extend(warnings);
    own.values = component(&own.values, choice);
    raw.boundary_values.insert(name.to_owned(), own);
    Ok(())
}

fn move_points(points: &mut [DVec3], displacement: &[f64], request: &Request) {
    let factor = request.displacement.as_ref().map_or(0.0, |(_, factor)| *factor);
    let vectors = displacement.as_chunks::<3>().0.par_iter();
    points
        .par_iter_mut()
        .zip(vectors)
        .for_each(|(point, &vector)| *point += factor * DVec3::from_array(vector));
}

/// The values of each choice. An array that is chosen several times, or of which several components are, is decoded once.
fn columns(piece: &Piece, wanted: &PieceRequest, meter: &Meter) -> Result<Vec<Vec<f64>>> {
    let choices = wanted.choices;
    let decoded = |choice: &ArraySelection| match piece.array(choice.association, &choice.name) {
        None if wanted.fills => not_there(piece, choice, meter),
        _ => decoded(piece, choice, meter),
    };
    let mut columns: Vec<Option<Vec<f64>>> = vec![None; choices.len()];
    while let Some(first) = columns.iter().position(Option::is_none) {
        let (choice, values) = (&choices[first], decoded(&choices[first])?);
        let is_same = |&other: &usize| {
            ArraySelection { component: choice.component, ..choices[other].clone() } == *choice
        };
        let same: Vec<usize> = (first..choices.len()).filter(is_same).collect();
        let whole = same.iter().copied().find(|&other| choices[other].is_whole());
        for &other in same.iter().filter(|&&other| Some(other) != whole) {
            columns[other] = Some(component(&values, &choices[other]));
        }
        if let Some(whole) = whole {
            columns[whole] = Some(values);
        }
    }
    Ok(columns.into_iter().flatten().collect())
}

/// NaN for each number of an array that a piece lacks.
fn not_there(piece: &Piece, choice: &ArraySelection, meter: &Meter) -> Result<Vec<f64>> {
    let tuples = match choice.association {
        Association::Point => piece.point_count,
        Association::Cell => piece.cell_count,
    };
    let count = tuples.saturating_mul(choice.component_count as u64);
    let what = || format!("the array '{}'", choice.name);
    progress::refuse_beyond_memory(meter.progress(), what, count.saturating_mul(size_of::<f64>() as u64))?;
    Ok(vec![f64::NAN; count as usize])
}

pub(super) fn column(piece: &Piece, choice: &ArraySelection, meter: &Meter) -> Result<Vec<f64>> {
    Ok(component(&decoded(piece, choice, meter)?, choice))
}

fn component(values: &[f64], choice: &ArraySelection) -> Vec<f64> {
    let count = choice.component_count;
    match choice.component {
        Component::Index(index) if count > 1 => {
            values.par_iter().skip(index).step_by(count).copied().collect()
        }
        Component::Magnitude => values.par_chunks(count).map(length).collect(),
        _ => values.to_vec(),
    }
}

fn decoded(piece: &Piece, choice: &ArraySelection, meter: &Meter) -> Result<Vec<f64>> {
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
        .got(counted(count, "component"))
        .expected(choice.component_count));
    }
    stored.load(meter)
}

/// `vtkGhostType` of the cells, those at hidden points hidden; `None` where all are 0.
fn ghosts(piece: &Piece, cells: &Cells, meter: &Meter) -> Result<Option<Vec<u8>>> {
    let of = |association, name| -> Result<Option<Vec<u64>>> {
        piece.array(association, name).map(|array| array.load(meter)).transpose()
    };
    let mut ghost: Option<Vec<u8>> = match of(Association::Cell, GHOST_TYPE)? {
        Some(flags) => Some(flags.into_iter().map(|flags| (flags & CELL_FLAGS) as u8).collect()),
        None => of(Association::Cell, GHOST_LEVELS)?
            .map(|levels| levels.into_iter().map(|level| u8::from(level > 0) * DUPLICATE_CELL).collect()),
    };
    let hidden = of(Association::Point, GHOST_TYPE)?
        .map(|flags| flags.into_iter().map(|flags| flags & HIDDEN_POINT != 0).collect::<Vec<bool>>());
    if let Some(hidden) = hidden.filter(|hidden| hidden.contains(&true)) {
        let ghost = ghost.get_or_insert_with(|| vec![0; cells.count()]);
        for (number, ghost) in ghost.iter_mut().enumerate() {
            if cells::corners(cells, number).any(|corner| hidden.get(corner as usize) == Some(&true)) {
                *ghost |= HIDDEN_CELL;
            }
        }
    }
    Ok(ghost.filter(|ghost| ghost.iter().any(|&flags| flags != 0)))
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

pub(super) fn load_points(piece: &Piece, meter: &Meter) -> Result<Vec<DVec3>> {
    match &piece.geometry {
        Geometry::Unstructured { points, .. } | Geometry::Curvilinear { points, .. } => {
            points.load_tuples::<f64, _>(meter)
        }
        Geometry::Open(open) => open.take(None, |read| read.points.take(), meter.progress()),
        Geometry::Adaptive(lattice) => Ok(lattice.positions()),
        Geometry::Rectilinear { axes, .. } => {
            let [x, y, z] = &**axes;
            let (x, y, z): (Vec<f64>, Vec<f64>, Vec<f64>) = (x.load(meter)?, y.load(meter)?, z.load(meter)?);
            lattice([&x, &y, &z].map(|axis| axis.len() as u64), meter, |[i, j, k]| {
                DVec3::new(x[i], y[j], z[k])
            })
        }
        &Geometry::Uniform { dimensions, first, origin, spacing, direction } => {
            lattice(dimensions, meter, |index| {
                let index = DVec3::from_array(index.map(|i| i as f64));
                origin + direction * (spacing * (first + index))
            })
        }
    }
}

/// Points of a structured grid, the first index running fastest. Errors: a grid numbers no more than 32 bits can, or memory ends.
fn lattice(
    dimensions: [u64; 3],
    meter: &Meter,
    position: impl Fn([usize; 3]) -> DVec3 + Sync,
) -> Result<Vec<DVec3>> {
    let count = structured_counts(dimensions)?.0;
    let what = || counted(count, "point");
    if count > u64::from(u32::MAX) {
        let error = Error::run("the grid has too many points").got(count);
        return Err(error.expected(format_args!("at most {}", u32::MAX)));
    }
    progress::refuse_beyond_memory(meter.progress(), what, count.saturating_mul(size_of::<DVec3>() as u64))?;
    let [nx, ny, _] = dimensions.map(|n| n as usize);
    let mut points = vec![DVec3::ZERO; count as usize];
    points.par_chunks_mut(nx.max(1)).enumerate().for_each(|(row, points)| {
        for (i, point) in points.iter_mut().enumerate() {
            *point = position([i, row % ny, row / ny]);
        }
    });
    Ok(points)
}
