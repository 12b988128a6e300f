//! Summary of a file for people: cells by type, arrays with ranges, bounds, time steps. Ranges and bounds are those of what is drawn:
//! not of ghosts, hidden cells, surfaces beside a volume, or points that no cell uses.

use super::assemble::PieceRequest;
use super::contents::{BLOCK, CellBlocks, Dataset, Geometry, Meter, Piece, PieceArray};
use super::request::Request;
use super::{assemble, cells, request};
use crate::memory::GridSize;
use glam::DVec3;
use std::collections::BTreeMap;
use voltet_core::grid::{self, Association, CellType, Cells, RawGrid, code, is_drawn};
use voltet_core::progress::Progress;
use voltet_core::reading::FileArray;
use voltet_core::{Result, SharedSlice};

/// Contents of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Summary {
    /// Format and encoding: "VTK XML UnstructuredGrid, zlib, little-endian, UInt32 headers".
    pub format: String,
    /// Number of pieces.
    pub piece_count: usize,
    /// Points of all pieces.
    pub point_count: u64,
    /// Cells of all pieces.
    pub cell_count: u64,
    /// Cells by VTK type code.
    pub cells_by_type: BTreeMap<u8, u64>,
    /// Points that several pieces hold.
    pub points_joined: u64,
    /// Ghost cells whose original is in no piece.
    pub ghosts_without_owner: u64,
    /// Least and greatest coordinates; `None` where no point is finite.
    pub bounds: Option<[DVec3; 2]>,
    /// Points with a position that is not finite.
    pub points_not_finite: u64,
    /// Blocks, in the order of the file; those that were not selected have no cells.
    pub blocks: Vec<BlockSummary>,
    /// All arrays, the points' first.
    pub arrays: Vec<ArraySummary>,
    /// Name of the array that the file marks as its scalars.
    pub active_scalars: Option<String>,
    /// The array that a reader takes where none is named; `None` where it must be named.
    pub unnamed: Option<(String, Association)>,
    /// The time that the file says it is of.
    pub time: Option<f64>,
    /// Times of the steps of a series; empty where the file is none.
    pub time_steps: Vec<f64>,
    /// Bytes of the files.
    pub file_bytes: u64,
    /// The size of the grid of tetrahedra that it becomes.
    pub size: GridSize,
    /// Sentences for the user.
    pub warnings: Vec<String>,
    /// Further contents of the file: "2 node sets: 'inlet', 'outlet'".
    pub notes: Vec<String>,
    /// Damage for which no grid is built of the cells.
    pub damage: Option<String>,
}

impl Summary {
    /// True if some cell is three-dimensional.
    pub fn has_volume(&self) -> bool {
        let is_volume = |&code: &u8| CellType::from_code(code).is_some_and(|cell| cell.dimension == 3);
        self.cells_by_type.keys().any(is_volume)
    }

    /// The arrays but that of the numbers of blocks.
    pub fn quantities(&self) -> impl Iterator<Item = &ArraySummary> {
        let is_number = |array: &ArraySummary| {
            !self.blocks.is_empty() && array.head.name == BLOCK && array.head.association == Association::Cell
        };
        self.arrays.iter().filter(move |array| !is_number(array))
    }
}

/// One block of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BlockSummary {
    /// Name, after those of the groups that it is in, with `/` between.
    pub name: String,
    /// Cells by VTK type code.
    pub cells_by_type: BTreeMap<u8, u64>,
}

impl BlockSummary {
    /// Cells of any type.
    pub fn cell_count(&self) -> u64 {
        self.cells_by_type.values().sum()
    }
}

/// One array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ArraySummary {
    /// Header.
    pub head: FileArray,
    /// Unit that the file states.
    pub unit: Option<String>,
    /// Type of the numbers as the XML formats call it: "Float32".
    pub number_type: &'static str,
    /// Tuples of all pieces.
    pub tuple_count: u64,
    /// Least and greatest finite value, of the tuple's length where there are several components.
    pub range: Option<[f64; 2]>,
    /// Tuples with a value that is not finite.
    pub not_finite_count: u64,
}

/// The arrays of a table of contents, each once, the points' first.
pub(super) fn array_heads(dataset: &Dataset) -> Vec<FileArray> {
    let mut heads: Vec<FileArray> = Vec::new();
    for head in dataset.pieces.iter().flat_map(|piece| &piece.arrays).map(PieceArray::head) {
        if !heads.contains(&head) {
            heads.push(head);
        }
    }
    heads.sort_by_key(|head| head.association == Association::Cell);
    heads
}

/// Decodes everything, one array at a time, and says what it is.
pub(super) fn summarize(
    dataset: &Dataset,
    association: Option<Association>,
    progress: &dyn Progress,
) -> Result<Summary> {
    let meter = Meter::new(progress, dataset.file_bytes);
    let mut summary = Summary {
        format: dataset.format.clone(),
        piece_count: dataset.pieces.len(),
        active_scalars: dataset.active_scalars.clone(),
        unnamed: request::scalar(dataset, None, association)
            .ok()
            .map(|found| (found.name, found.association)),
        time: dataset.time,
        time_steps: dataset.time_steps.clone(),
        file_bytes: dataset.file_bytes,
        warnings: dataset.warnings.clone(),
        notes: dataset.notes.clone(),
        blocks: dataset
            .blocks
            .iter()
            .map(|name| BlockSummary { name: name.clone(), ..Default::default() })
            .collect(),
        ..Summary::default()
    };
    // Of what is drawn; of all, where nothing is.
    let (mut drawn_bounds, mut all_bounds) = (None, None);
    let mut arrays = Vec::new();
    let mut pieces = Vec::new();
    // Points are joined by their values, too.
    let scalar = request::scalar(dataset, None, None).ok();
    let scalar = scalar.filter(|choice| {
        // A block may lack it, one of surfaces beside a volume for example.
        let has_scalar = |piece: &Piece| piece.array(choice.association, &choice.name).is_some();
        choice.association == Association::Point && dataset.pieces.iter().all(has_scalar)
    });
    let (request, ids) = (Request::default(), assemble::global_ids(dataset));
    let wanted = PieceRequest { request: &request, choices: scalar.as_slice(), ids, fills: false };
    for (index, piece) in dataset.pieces.iter().enumerate() {
        summary.point_count = summary.point_count.saturating_add(piece.point_count);
        summary.cell_count = summary.cell_count.saturating_add(piece.cell_count);
        let cells = match piece.cell_count {
            0 => Cells::Tetrahedra(SharedSlice::default()),
            _ => cells::load(piece, &meter)?,
        };
        if piece.cell_count > 0 {
            count_cells(&cells, piece, &mut summary.cells_by_type);
            summary.size.add(&cells);
            count_blocks(&cells, piece, &mut summary.blocks, &meter)?;
        }
        let mut raw = assemble::load(piece, cells, &wanted, &meter)?;
        let damage = grid::check_cells(&raw).err().map(|error| error.to_string());
        summary.damage = summary.damage.take().or(damage);
        let drawn = DrawnParts::of_piece(&raw, piece.point_count as usize);
        for array in &piece.arrays {
            add_array(&mut arrays, array, &drawn, &meter)?;
        }
        summary.points_not_finite += raw.points.iter().filter(|point| !point.is_finite()).count() as u64;
        let of_drawn = raw.points.iter().zip(&drawn.points).filter(|(_, is_drawn)| **is_drawn);
        add_points(&mut drawn_bounds, of_drawn.map(|(point, _)| point));
        add_points(&mut all_bounds, raw.points.iter());
        raw.block = assemble::group(dataset, piece, index);
        pieces.push(raw);
    }
    // A single piece's ghosts are nobody else's; what is damaged is said by what reads it to draw it.
    if let Ok(joined) = grid::join(pieces) {
        summary.points_joined = joined.origin.points_joined;
        summary.ghosts_without_owner = joined.ghosts_without_owner();
    }
    let is_drawn = drawn_bounds.is_some();
    summary.bounds = if is_drawn { drawn_bounds } else { all_bounds };
    summary.arrays = arrays
        .into_iter()
        .map(|(array, of_all)| if is_drawn { array } else { ArraySummary { range: of_all, ..array } })
        .collect();
    summary.arrays.sort_by_key(|array| array.head.association == Association::Cell);
    summary.size.points = summary.point_count;
    Ok(summary)
}

/// The points and cells of a piece that are drawn.
struct DrawnParts {
    points: Vec<bool>,
    cells: Vec<bool>,
}

impl DrawnParts {
    fn of_piece(piece: &RawGrid, point_count: usize) -> DrawnParts {
        let count = piece.cells.count();
        let mut drawn = DrawnParts { points: vec![false; point_count], cells: vec![false; count] };
        for cell in 0..count {
            let is_volume = match &piece.cells {
                Cells::Mixed(set) => {
                    CellType::from_code(set.types[cell]).is_some_and(|cell| cell.dimension == 3)
                }
                _ => true,
            };
            if is_volume && piece.ghost.as_ref().is_none_or(|flags| is_drawn(flags[cell])) {
                drawn.cells[cell] = true;
                for corner in cells::corners(&piece.cells, cell) {
                    if let Some(point) = drawn.points.get_mut(corner as usize) {
                        *point = true;
                    }
                }
            }
        }
        drawn
    }
}

/// Counts a piece's cells.
fn count_cells(cells: &Cells, piece: &Piece, by_type: &mut BTreeMap<u8, u64>) {
    let mut add = |code: u8, count: u64| *by_type.entry(code).or_default() += count;
    match cells {
        Cells::Tetrahedra(own) => add(code::TETRA, own.len() as u64),
        Cells::Mixed(set) => set.types.iter().for_each(|&code| add(code, 1)),
        Cells::Structured(dimensions) => {
            let is_curvilinear = matches!(piece.geometry, Geometry::Curvilinear { .. });
            // Of fewer dimensions: quads and pixels, lines, vertices.
            let code = match (dimensions.iter().filter(|&&n| n > 1).count(), is_curvilinear) {
                (3, true) => code::HEXAHEDRON,
                (3, false) => code::VOXEL,
                (2, true) => 9,
                (2, false) => 8,
                (1, _) => 3,
                _ => 1,
            };
            add(code, piece.cell_count);
        }
    }
}

/// Counts a piece's cells by block and type.
fn count_blocks(cells: &Cells, piece: &Piece, blocks: &mut [BlockSummary], meter: &Meter) -> Result<()> {
    if blocks.is_empty() {
        return Ok(());
    }
    if let CellBlocks::One(block) = piece.blocks {
        if let Some(block) = blocks.get_mut(block) {
            count_cells(cells, piece, &mut block.cells_by_type);
        }
        return Ok(());
    }
    let Some(stored) = piece.array(Association::Cell, BLOCK) else { return Ok(()) };
    let numbers: Vec<f64> = stored.load(meter)?;
    for (cell, &number) in numbers.iter().enumerate() {
        let code =
            if let Cells::Mixed(set) = cells { set.types.get(cell).copied() } else { Some(code::TETRA) };
        if let (Some(block), Some(code)) = (blocks.get_mut(number as usize), code) {
            *block.cells_by_type.entry(code).or_default() += 1;
        }
    }
    Ok(())
}

fn add_points<'a>(bounds: &mut Option<[DVec3; 2]>, points: impl Iterator<Item = &'a DVec3>) {
    for &point in points.filter(|point| point.is_finite()) {
        let [low, high] = bounds.unwrap_or([point; 2]);
        *bounds = Some([low.min(point), high.max(point)]);
    }
}

/// An array, and its range over all values.
type WithRange = (ArraySummary, Option<[f64; 2]>);

/// Adds a piece's array to that of the same name of the pieces before.
fn add_array(
    arrays: &mut Vec<WithRange>,
    array: &PieceArray,
    drawn: &DrawnParts,
    meter: &Meter,
) -> Result<()> {
    let (head, stored) = (array.head(), &array.stored);
    let values: Vec<f64> = stored.load(meter)?;
    let number_type = stored.number_type.name();
    let known = |(array, _): &WithRange| array.head == head && array.number_type == number_type;
    let place = arrays.iter().position(known).unwrap_or_else(|| {
        let (tuple_count, range, not_finite_count) = (0, None, 0);
        let (head, unit) = (head.clone(), array.unit.clone());
        let array = ArraySummary { head, unit, number_type, tuple_count, range, not_finite_count };
        arrays.push((array, None));
        arrays.len() - 1
    });
    let (array, of_all) = &mut arrays[place];
    let are_drawn = if head.association == Association::Cell { &drawn.cells } else { &drawn.points };
    for (number, tuple) in values.chunks(stored.component_count).enumerate() {
        let value = if let [only] = tuple { *only } else { assemble::length(tuple) };
        array.tuple_count += 1;
        if !value.is_finite() {
            array.not_finite_count += 1;
            continue;
        }
        let widen = |range: &mut Option<[f64; 2]>| {
            let [low, high] = range.unwrap_or([value; 2]);
            *range = Some([low.min(value), high.max(value)]);
        };
        widen(of_all);
        if are_drawn.get(number) == Some(&true) {
            widen(&mut array.range);
        }
    }
    Ok(())
}
