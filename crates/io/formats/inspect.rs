//! Summary of a file for people: cells by type, arrays with ranges, bounds, time steps. Ranges and bounds are those of what is drawn:
//! not of ghosts, hidden cells, surfaces beside a volume, or points that no cell uses.

use super::assemble::PieceRequest;
use super::contents::{BLOCK, CellBlocks, Dataset, Geometry, Meter, Piece, PieceArray, Stored, StoredCells};
use super::request::Request;
use super::vectors::length;
use super::{assemble, cells, request};
use crate::memory::GridSize;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use voltet_core::Result;
use voltet_core::grid::{self, Association, CellType, Cells, RawGrid, code, is_drawn};
use voltet_core::parallel::all_or_first;
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
    /// Reason why none of the cells with a volume is drawn.
    pub not_drawn: Option<String>,
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

/// Decodes everything, small pieces side by side and of each one array at a time, and says what it is.
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
    // Points are joined by their values, too.
    let scalar = request::scalar(dataset, None, None).ok();
    let scalar = scalar.filter(|choice| {
        // A block may lack it, one of surfaces beside a volume for example.
        let has_scalar = |piece: &Piece| piece.array(choice.association, &choice.name).is_some();
        choice.association == Association::Point && dataset.pieces.iter().all(has_scalar)
    });
    let (request, ids) = (Request::default(), assemble::global_ids(dataset));
    let wanted = PieceRequest { request: &request, choices: scalar.as_slice(), ids, fills: false };
    let mut all = PieceSums::default();
    let mut first = 0;
    while first < dataset.pieces.len() {
        let budget = progress.memory_left().map_or(BATCH_BYTES, |left| left.min(BATCH_BYTES));
        let batch = first..first + batch_len(&dataset.pieces[first..], budget);
        first = batch.end;
        for sums in sums_of(dataset, batch, &wanted, &meter)? {
            all.merge(sums, &mut summary);
        }
    }
    let PieceSums { pieces, arrays, drawn_bounds, all_bounds, size, .. } = all;
    summary.size = size;
    // A single piece's ghosts are nobody else's; what is damaged is said by what reads it to draw it.
    if let Ok(joined) = grid::join(pieces) {
        summary.points_joined = joined.origin.points_joined;
        summary.ghosts_without_owner = joined.ghosts_without_owner();
    }
    let is_drawn = drawn_bounds.is_some();
    summary.bounds = if is_drawn { drawn_bounds } else { all_bounds };
    if !is_drawn && summary.has_volume() && summary.damage.is_none() {
        let none = "each cell with a volume is a ghost, hidden (vtkGhostType), or at a point without a finite position";
        summary.not_drawn = Some(none.to_owned());
    }
    summary.arrays = arrays
        .into_iter()
        .map(|(array, of_all)| if is_drawn { array } else { ArraySummary { range: of_all, ..array } })
        .collect();
    summary.arrays.sort_by_key(|array| array.head.association == Association::Cell);
    summary.size.points = summary.point_count;
    Ok(summary)
}

/// Bytes of the pieces that are decoded side by side, however many threads there are.
const BATCH_BYTES: u64 = 64 << 20;
/// Pieces whose contents stand beside each other until they are added up.
const MAX_BATCH: usize = 1 << 12;

/// Number of pieces, at least the first of them, that take no more than `budget` bytes together.
fn batch_len(pieces: &[Piece], budget: u64) -> usize {
    let mut left = budget;
    let fits = |piece: &&Piece| match left.checked_sub(decoded_bytes(piece)) {
        Some(rest) => {
            left = rest;
            true
        }
        None => false,
    };
    pieces.iter().take(MAX_BATCH).take_while(fits).count().max(1)
}

/// Bytes that a piece takes while it is decoded: points, cells, flags, and the widest array.
fn decoded_bytes(piece: &Piece) -> u64 {
    let widest = |association| {
        let widths = piece.arrays_of(association).map(|array| array.stored.component_count as u64);
        widths.max().unwrap_or(0).saturating_mul(8)
    };
    // A position, a scalar, a flag; a type, an offset and eight corners.
    let points = piece.point_count.saturating_mul(33_u64.saturating_add(widest(Association::Point)));
    let cells = piece.cell_count.saturating_mul(42_u64.saturating_add(widest(Association::Cell)));
    let of_geometry = match &piece.geometry {
        Geometry::Open(open) => open.byte_count(true, &[]),
        Geometry::Unstructured { cells, .. } => match &**cells {
            StoredCells::Offsets { connectivity, faces, .. } => {
                value_count(connectivity).saturating_add(faces.value_count()).saturating_mul(8)
            }
            StoredCells::Counted { list, .. } => value_count(list).saturating_mul(8),
            StoredCells::Converted(_) => 0,
        },
        _ => 0,
    };
    points.saturating_add(cells).saturating_add(of_geometry)
}

/// Number of values that the headers promise; 0 where they tell none.
fn value_count(stored: &Stored) -> u64 {
    stored.value_count().unwrap_or(0)
}

/// Contents of each of some pieces, which are decoded side by side.
fn sums_of(
    dataset: &Dataset,
    numbers: Range<usize>,
    wanted: &PieceRequest,
    meter: &Meter,
) -> Result<Vec<PieceSums>> {
    let of_piece = |index: usize| {
        let mut sums = PieceSums::default();
        sums.add(dataset, index, &dataset.pieces[index], wanted, meter).map(|()| sums)
    };
    all_or_first(numbers.into_par_iter().map(of_piece))
}

type Bounds = Option<[DVec3; 2]>;

#[derive(Default)]
struct PieceSums {
    pieces: Vec<RawGrid>,
    arrays: Vec<WithRange>,
    /// Bounds of what is drawn, and of all, for where nothing is.
    drawn_bounds: Bounds,
    all_bounds: Bounds,
    size: GridSize,
    counts: [u64; 2],
    points_not_finite: u64,
    cells_by_type: BTreeMap<u8, u64>,
    /// Cells of the piece by block and type.
    of_blocks: BTreeMap<usize, BTreeMap<u8, u64>>,
    damage: Option<String>,
}

impl PieceSums {
    /// Adds a piece, of which everything is decoded.
    fn add(
        &mut self,
        dataset: &Dataset,
        index: usize,
        piece: &Piece,
        wanted: &PieceRequest,
        meter: &Meter,
    ) -> Result<()> {
        self.counts = [piece.point_count, piece.cell_count];
        let cells = match piece.cell_count {
            0 => Cells::default(),
            _ => cells::load(piece, meter)?,
        };
        if piece.cell_count > 0 {
            count_cells(&cells, piece, &mut self.cells_by_type);
            self.size.add(&cells);
        }
        if piece.cell_count > 0 && !dataset.blocks.is_empty() {
            count_blocks(&cells, piece, &mut self.of_blocks, meter)?;
        }
        let mut raw = assemble::load(piece, cells, wanted, meter)?;
        self.damage = grid::check_cells(&raw).err().map(|error| error.to_string());
        let drawn = DrawnParts::of_piece(&raw, piece.point_count as usize);
        for array in &piece.arrays {
            add_array(&mut self.arrays, array, &drawn, meter)?;
        }
        self.points_not_finite = raw.points.iter().filter(|point| !point.is_finite()).count() as u64;
        let of_drawn = raw.points.iter().zip(&drawn.points).filter(|(_, is_drawn)| **is_drawn);
        add_points(&mut self.drawn_bounds, of_drawn.map(|(point, _)| point));
        add_points(&mut self.all_bounds, raw.points.iter());
        raw.block = assemble::group(dataset, piece, index);
        self.pieces.push(raw);
        Ok(())
    }

    /// Adds the contents of a piece behind these, and its counts to the summary.
    fn merge(&mut self, other: PieceSums, summary: &mut Summary) {
        summary.point_count = summary.point_count.saturating_add(other.counts[0]);
        summary.cell_count = summary.cell_count.saturating_add(other.counts[1]);
        summary.points_not_finite += other.points_not_finite;
        summary.damage = summary.damage.take().or(other.damage);
        add_counts(&mut summary.cells_by_type, &other.cells_by_type);
        for (block, own) in other.of_blocks {
            if let Some(block) = summary.blocks.get_mut(block) {
                add_counts(&mut block.cells_by_type, &own);
            }
        }
        self.pieces.extend(other.pieces);
        self.size.add_size(&other.size);
        for (to, bounds) in
            [(&mut self.drawn_bounds, other.drawn_bounds), (&mut self.all_bounds, other.all_bounds)]
        {
            add_points(to, bounds.iter().flatten());
        }
        for (array, of_all) in other.arrays {
            let Some((own, own_of_all)) = self.arrays.iter_mut().find(|own| own.0.is_same(&array)) else {
                self.arrays.push((array, of_all));
                continue;
            };
            own.tuple_count += array.tuple_count;
            own.not_finite_count += array.not_finite_count;
            array.range.iter().flatten().for_each(|&value| widen(&mut own.range, value));
            of_all.iter().flatten().for_each(|&value| widen(own_of_all, value));
        }
    }
}

fn add_counts(to: &mut BTreeMap<u8, u64>, counts: &BTreeMap<u8, u64>) {
    counts.iter().for_each(|(&code, count)| *to.entry(code).or_default() += count);
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

fn count_blocks(
    cells: &Cells,
    piece: &Piece,
    blocks: &mut BTreeMap<usize, BTreeMap<u8, u64>>,
    meter: &Meter,
) -> Result<()> {
    if let CellBlocks::One(block) = piece.blocks {
        count_cells(cells, piece, blocks.entry(block).or_default());
        return Ok(());
    }
    let Some(stored) = piece.array(Association::Cell, BLOCK) else { return Ok(()) };
    let numbers: Vec<f64> = stored.load(meter)?;
    for (cell, &number) in numbers.iter().enumerate() {
        let code =
            if let Cells::Mixed(set) = cells { set.types.get(cell).copied() } else { Some(code::TETRA) };
        if let Some(code) = code {
            *blocks.entry(number as usize).or_default().entry(code).or_default() += 1;
        }
    }
    Ok(())
}

fn add_points<'a>(bounds: &mut Bounds, points: impl Iterator<Item = &'a DVec3>) {
    for &point in points.filter(|point| point.is_finite()) {
        let [low, high] = bounds.unwrap_or([point; 2]);
        *bounds = Some([low.min(point), high.max(point)]);
    }
}

/// An array, and its range over all values.
type WithRange = (ArraySummary, Option<[f64; 2]>);

fn widen(range: &mut Option<[f64; 2]>, value: f64) {
    let [low, high] = range.unwrap_or([value; 2]);
    *range = Some([low.min(value), high.max(value)]);
}

impl ArraySummary {
    fn is_same(&self, other: &ArraySummary) -> bool {
        self.head == other.head && self.number_type == other.number_type
    }
}

/// Adds a piece's array to that of the same name of the pieces before.
fn add_array(
    arrays: &mut Vec<WithRange>,
    array: &PieceArray,
    drawn: &DrawnParts,
    meter: &Meter,
) -> Result<()> {
    let stored = &array.stored;
    let values: Vec<f64> = stored.load(meter)?;
    let number_type = stored.number_type.name();
    let (tuple_count, range, not_finite_count) = (0, None, 0);
    let (head, unit) = (array.head(), array.unit.clone());
    let association = head.association;
    let own = ArraySummary { head, unit, number_type, tuple_count, range, not_finite_count };
    let place = arrays.iter().position(|known| known.0.is_same(&own)).unwrap_or_else(|| {
        arrays.push((own, None));
        arrays.len() - 1
    });
    let (array, of_all) = &mut arrays[place];
    let are_drawn = if association == Association::Cell { &drawn.cells } else { &drawn.points };
    for (number, tuple) in values.chunks(stored.component_count).enumerate() {
        let value = if let [only] = tuple { *only } else { length(tuple) };
        array.tuple_count += 1;
        if !value.is_finite() {
            array.not_finite_count += 1;
            continue;
        }
        widen(of_all, value);
        if are_drawn.get(number) == Some(&true) {
            widen(&mut array.range, value);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::contents::{Compute, Encoding};
    use crate::formats::source::Source;
    use glam::DMat3;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use voltet_core::Error;
    use voltet_core::progress::NoProgress;

    /// A box of so many points along each axis, with an array in its cells.
    fn cube(source: &Arc<Source>, points: u64, component_count: usize, compute: Compute) -> Piece {
        let [point_count, cell_count] = [points.pow(3), (points - 1).pow(3)];
        let encoding = Encoding::Computed(compute);
        let stored = Stored::of_f64(source, "v", component_count, cell_count, encoding);
        let geometry = Geometry::Uniform {
            dimensions: [points; 3],
            first: DVec3::ZERO,
            origin: DVec3::ZERO,
            spacing: DVec3::ONE,
            direction: DMat3::IDENTITY,
        };
        let arrays = vec![PieceArray::new(Association::Cell, stored)];
        Piece::new([point_count, cell_count], geometry, arrays)
    }

    fn some_file() -> Arc<Source> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"a").unwrap();
        Source::open(file.path()).unwrap()
    }

    #[test]
    fn large_pieces_are_decoded_alone_and_small_ones_side_by_side() {
        let source = some_file();
        let nothing: Compute = Arc::new(|_| Ok(Vec::new()));
        let pieces = |points: u64, components: usize, count: usize| {
            let piece = |_| cube(&source, points, components, nothing.clone());
            (0..count).map(piece).collect::<Vec<_>>()
        };
        let large = pieces(216, 3, 64);
        assert_eq!(large[0].cell_count / 100_000, 99);
        assert_eq!(batch_len(&large, BATCH_BYTES), 1);
        assert_eq!(batch_len(&pieces(2, 1, MAX_BATCH + 1), BATCH_BYTES), MAX_BATCH);
        // What all of a batch take together stays below the limit, and below the memory that is left.
        let some = pieces(40, 3, 100);
        let own = decoded_bytes(&some[0]);
        assert!(own > 40_u64.pow(3) * (24 + 3 * 8), "{own}");
        assert_eq!(batch_len(&some, BATCH_BYTES) as u64, BATCH_BYTES / own);
        assert_eq!(batch_len(&some, 3 * own), 3);
        assert_eq!(batch_len(&some, 0), 1);
        let mixed: Vec<Piece> = [pieces(2, 1, 5), large].into_iter().flatten().collect();
        assert_eq!(batch_len(&mixed, BATCH_BYTES), 5);
    }

    #[test]
    fn the_first_piece_that_fails_is_reported_and_those_behind_are_not_decoded() {
        let source = some_file();
        let decoded = Arc::new(AtomicUsize::new(0));
        let piece = |number: usize| {
            let decoded = decoded.clone();
            let compute: Compute = Arc::new(move |_| {
                decoded.fetch_add(1, Ordering::Relaxed);
                match number {
                    5 | 6 | 900 => Err(Error::run(format!("piece {number} is damaged"))),
                    _ => Ok(vec![number as f64]),
                }
            });
            cube(&source, 2, 1, compute)
        };
        let dataset = Dataset { pieces: (0..3000).map(piece).collect(), ..Dataset::default() };
        for threads in [1, 4] {
            decoded.store(0, Ordering::Relaxed);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| summarize(&dataset, None, &NoProgress)).unwrap_err().to_string();
            assert!(found.contains("piece 5 is damaged"), "{found}");
            if threads == 1 {
                assert_eq!(decoded.load(Ordering::Relaxed), 6);
            }
        }
    }

    #[test]
    fn pieces_side_by_side_are_summed_up_as_one_after_the_other() {
        let source = some_file();
        let piece = |number: usize| {
            let points = 2 + number as u64 % 3;
            let values = vec![number as f64; (points - 1).pow(3) as usize];
            cube(&source, points, 1, Arc::new(move |_| Ok(values.clone())))
        };
        let of = |numbers: Range<usize>, threads: usize| {
            let dataset = Dataset { pieces: numbers.map(piece).collect(), ..Dataset::default() };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| summarize(&dataset, None, &NoProgress)).unwrap()
        };
        let all = of(0..65, 4);
        assert_eq!(all, of(0..65, 1));
        let (most, last) = (of(0..63, 1), of(63..65, 1));
        assert_eq!(all.point_count, most.point_count + last.point_count);
        assert_eq!(all.cell_count, most.cell_count + last.cell_count);
        let tuples = |summary: &Summary| (summary.arrays[0].tuple_count, summary.arrays[0].range);
        let cells = all.cell_count;
        assert_eq!(
            [&most, &all].map(tuples),
            [(most.cell_count, Some([0.0, 62.0])), (cells, Some([0.0, 64.0]))]
        );
    }
}
