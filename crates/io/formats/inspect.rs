//! Summary of a file for people: cells by type, arrays with ranges, bounds, time steps.

use super::contents::{Dataset, Geometry, Meter, PieceArray};
use super::{assemble, cells};
use crate::memory::GridSize;
use glam::DVec3;
use std::collections::BTreeMap;
use voltet_core::Result;
use voltet_core::grid::{Association, CellType, Cells, code};
use voltet_core::progress::Progress;
use voltet_core::reading::FileArray;

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
    /// Least and greatest coordinates; `None` where no point is finite.
    pub bounds: Option<[DVec3; 2]>,
    /// Points with a position that is not finite.
    pub points_not_finite: u64,
    /// All arrays, the points' first.
    pub arrays: Vec<ArraySummary>,
    /// Name of the array that the file marks as its scalars.
    pub active_scalars: Option<String>,
    /// Times of the steps of a series; empty where the file is none.
    pub time_steps: Vec<f64>,
    /// Bytes of the files.
    pub file_bytes: u64,
    /// The size of the grid of tetrahedra that it becomes.
    pub size: GridSize,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

impl Summary {
    /// True if some cell is three-dimensional.
    pub fn has_volume(&self) -> bool {
        let is_volume = |&code: &u8| CellType::from_code(code).is_some_and(|cell| cell.dimension == 3);
        self.cells_by_type.keys().any(is_volume)
    }
}

/// One array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ArraySummary {
    /// Header.
    pub head: FileArray,
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
pub(super) fn summarize(dataset: &Dataset, progress: &dyn Progress) -> Result<Summary> {
    let meter = Meter::new(progress, dataset.file_bytes);
    let mut summary = Summary {
        format: dataset.format.clone(),
        piece_count: dataset.pieces.len(),
        active_scalars: dataset.active_scalars.clone(),
        time_steps: dataset.time_steps.clone(),
        file_bytes: dataset.file_bytes,
        warnings: dataset.warnings.clone(),
        ..Summary::default()
    };
    for piece in &dataset.pieces {
        summary.point_count = summary.point_count.saturating_add(piece.point_count);
        summary.cell_count = summary.cell_count.saturating_add(piece.cell_count);
        for array in &piece.arrays {
            add_array(&mut summary.arrays, array, &meter)?;
        }
        if piece.cell_count > 0 {
            let cells = cells::load(piece, &meter)?;
            count_cells(&cells, &piece.geometry, &mut summary.cells_by_type);
            summary.size.add(&cells);
        }
        if piece.point_count > 0 {
            add_points(&mut summary, &assemble::points(piece, &meter)?);
        }
    }
    summary.arrays.sort_by_key(|array| array.head.association == Association::Cell);
    summary.size.points = summary.point_count;
    Ok(summary)
}

/// Counts a piece's cells.
fn count_cells(cells: &Cells, geometry: &Geometry, by_type: &mut BTreeMap<u8, u64>) {
    let mut add = |code: u8, count: usize| *by_type.entry(code).or_default() += count as u64;
    match cells {
        Cells::Tetrahedra(own) => add(code::TETRA, own.len()),
        Cells::Mixed(set) => set.types.iter().for_each(|&code| add(code, 1)),
        Cells::Structured(dimensions) => {
            let is_curvilinear = matches!(geometry, Geometry::Curvilinear { .. });
            // Of fewer dimensions: quads and pixels, lines, vertices.
            let code = match (dimensions.iter().filter(|&&n| n > 1).count(), is_curvilinear) {
                (3, true) => code::HEXAHEDRON,
                (3, false) => code::VOXEL,
                (2, true) => 9,
                (2, false) => 8,
                (1, _) => 3,
                _ => 1,
            };
            add(code, cells.count());
        }
    }
}

fn add_points(summary: &mut Summary, points: &[DVec3]) {
    for &point in points {
        if point.is_finite() {
            let [low, high] = summary.bounds.unwrap_or([point; 2]);
            summary.bounds = Some([low.min(point), high.max(point)]);
        } else {
            summary.points_not_finite += 1;
        }
    }
}

/// Adds a piece's array to that of the same name of the pieces before.
fn add_array(arrays: &mut Vec<ArraySummary>, array: &PieceArray, meter: &Meter) -> Result<()> {
    let (head, stored) = (array.head(), &array.stored);
    let values: Vec<f64> = stored.load(meter)?;
    let number_type = stored.number_type.name();
    let known = |array: &ArraySummary| array.head == head && array.number_type == number_type;
    let place = arrays.iter().position(known).unwrap_or_else(|| {
        let (tuple_count, range, not_finite_count) = (0, None, 0);
        arrays.push(ArraySummary { head: head.clone(), number_type, tuple_count, range, not_finite_count });
        arrays.len() - 1
    });
    let array = &mut arrays[place];
    for tuple in values.chunks(stored.component_count) {
        let value = if let [only] = tuple { *only } else { assemble::length(tuple) };
        array.tuple_count += 1;
        if value.is_finite() {
            let [low, high] = array.range.unwrap_or([value; 2]);
            array.range = Some([low.min(value), high.max(value)]);
        } else {
            array.not_finite_count += 1;
        }
    }
    Ok(())
}
