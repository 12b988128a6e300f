//! Parts of a grid: some pieces of a file at a time, with cells of the other pieces around them as ghosts. Each part has at its own cells
//! what the grid of all pieces has there (docs/src/explanation/optics.md, section 2).
//!
//! [`borders`] reads the pieces one after the other: keys of points that may be shared, then the cells near those that are. Of several
//! processes each reads its own, sends all others the keys, and each the cells that lie near the pieces of that one. In memory are,
//! beside one piece, at first 24 bytes a point with global ids, or 48 a point in the box of another piece where there are none; then 12
//! for each shared point of each piece, and the cells near the borders with their values: of pieces of compact shape a share that
//! falls with their size, of cells scattered over the pieces all. Of 2.1 million hexahedra in 8 cubes, two layers are 17 MiB, in 64
//! cubes 50 MiB.

use super::assemble::{
    choices, describe, fetch, global_ids, has_volume, is_averaged, is_unsplit, load, load_all, of_each,
    pieces_with_cells, unread_of,
};
use super::contents::{Dataset, GHOST_LEVELS, GHOST_TYPE, Geometry, Meter, NumberedPiece, Piece};
use super::piece_share::Share;
use super::request::{ArraySelection, Request};
use super::{assemble, blocks, cells};
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::grid::{
    self, Association, Cells, Grid, Halo, Options, PointKeys, RawGrid, SharedPoints, extent,
};
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::{Error, Result, SharedSlice, counted};

/// Size of a piece of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PieceSize {
    /// Points.
    pub points: u64,
    /// Cells of any dimension.
    pub cells: u64,
}

/// Borders between the pieces of a file: the points that several of them hold, in one order, and the cells near these.
#[derive(Debug, Clone)]
pub struct PieceBorders {
    /// For each piece: true if a picture may show it.
    is_drawn: Vec<bool>,
    shared: SharedPoints,
    halos: Vec<Option<Halo>>,
    /// For each piece the number of its first cell in the whole grid.
    first_cells: Vec<u64>,
    /// True if means of cell values are those of an adaptive grid.
    is_adaptive: bool,
    /// Times that this process has read a piece for them.
    reads: u64,
}

impl PieceBorders {
    /// Times that this process has read a piece for them, each time some arrays of it.
    pub fn read_count(&self) -> u64 {
        self.reads
    }

    /// True if a picture may show a piece.
    pub fn is_drawn(&self, piece: usize) -> bool {
        self.is_drawn.get(piece).is_some_and(|is_drawn| *is_drawn)
    }

    /// Memory that they take.
    pub fn byte_count(&self) -> u64 {
        self.shared.byte_count() + self.halos.iter().flatten().map(Halo::byte_count).sum::<u64>()
    }
}

/// Sizes of all pieces.
pub(super) fn sizes(dataset: &Dataset) -> Vec<PieceSize> {
    let size = |piece: &Piece| PieceSize { points: piece.point_count, cells: piece.cell_count };
    dataset.pieces.iter().map(size).collect()
}

/// Finds the borders between the pieces.
pub(super) fn borders(
    dataset: &Dataset,
    request: &Request,
    layers: usize,
    share: &Share,
    progress: &dyn Progress,
) -> Result<PieceBorders> {
    // Keys, of positions after boxes; then halos.
    let meter = Meter::new(progress, dataset.file_bytes.saturating_mul(3));
    let choices = choices(dataset, request)?;
    let mut reads = 0;
    let pieces = drawn_pieces(dataset, request, &choices, (share, &mut reads), &meter)?;
    let mut found = PieceBorders {
        is_drawn: vec![false; dataset.pieces.len()],
        shared: SharedPoints::default(),
        halos: vec![None; dataset.pieces.len()],
        first_cells: vec![0; dataset.pieces.len()],
        is_adaptive: is_averaged(request, &choices)
            && pieces.iter().any(|piece| matches!(piece.1.geometry, Geometry::Adaptive(_))),
        reads: 0,
    };
    let mut cell_count = 0_u64;
    for &(index, piece) in &pieces {
        found.is_drawn[index] = true;
        found.first_cells[index] = cell_count;
        cell_count = cell_count.saturating_add(piece.cell_count);
    }
    if pieces.len() < 2 {
        return Ok(found);
    }
    // A ghost cell is without owner only where no other piece has its original.
    let has_ghosts = pieces.iter().any(|piece| has_ghost_flags(piece.1));
    let layers = layers.max(usize::from(has_ghosts));
    let own: Vec<NumberedPiece> = pieces.iter().copied().filter(|piece| share.has(piece.0)).collect();
    let own_keys = match global_ids(dataset) {
        Some(ids) => keys_of_ids(dataset, &own, ids, has_ghosts, request, &meter)?,
        None => keys_of_places(dataset, &own, request, &choices, share, &meter)?,
    };
    reads += own_keys.reads;
    let mut keys = vec![PointKeys::default(); dataset.pieces.len()];
    for (index, of_piece) in share.gather(own_keys.keys)? {
        keys[index] = of_piece;
    }
    let bytes = keys.iter().map(|keys| keys.byte_count().saturating_mul(3)).fold(0, u64::saturating_add);
    let what = || format!("the points at the borders of {}", counted(pieces.len(), "piece"));
    refuse_beyond_memory(progress, what, bytes)?;
    found.shared = SharedPoints::find(&keys);
    drop(keys);
    let mut halos = Vec::new();
    let own_pieces = own.iter().map(|piece| piece.0).collect();
    for own @ (index, piece) in own {
        // Points that curved cells add on a border are numbered by all cells there.
        let is_needed =
            layers > 0 || global_ids(dataset).is_some() || cells::has_types(piece, grid::is_curved, &meter)?;
        if is_needed && !found.shared.is_empty_at(index) {
            let cells = cells::load(piece, &meter)?;
            let loaded = load_all(dataset, vec![(own, cells)], request, &choices, &meter)?;
            reads += 1;
            for (index, raw) in loaded {
                let halo = Halo::from_piece(raw, &found.shared, index, layers)?;
                halos.extend(halo.map(|halo| (index, halo)));
            }
        }
        forget(piece);
    }
    // A piece with curved cells has a layer more.
    let reached = match share.is_alone() {
        true => BTreeMap::new(),
        false => within(&found.shared.neighbours(), own_pieces, layers + 1),
    };
    let reaches =
        |from: usize, to: &BTreeSet<usize>| reached.get(&from).is_some_and(|own| !own.is_disjoint(to));
    for (index, halo) in share.exchange(halos, reaches)? {
        found.halos[index] = Some(halo);
    }
    found.reads = reads;
    Ok(found)
}

/// For each of some pieces those that are at most so many neighbours away.
fn within(
    neighbours: &[BTreeSet<usize>],
    pieces: Vec<usize>,
    steps: usize,
) -> BTreeMap<usize, BTreeSet<usize>> {
    let of_piece = |piece: usize| {
        let mut reached = BTreeSet::from([piece]);
        for _ in 0..steps {
            let next: Vec<usize> = reached.iter().flat_map(|&own| &neighbours[own]).copied().collect();
            reached.extend(next);
        }
        (piece, reached)
    };
    pieces.into_iter().map(of_piece).collect()
}

/// Keys of the points of pieces, with the pieces' numbers, and how often a piece was read for them.
#[derive(Default)]
struct KeysOfPieces {
    keys: Vec<(usize, PointKeys)>,
    reads: u64,
}

/// The pieces that a picture may show. Errors: none has a volume and the arrays.
fn drawn_pieces<'a>(
    dataset: &'a Dataset,
    request: &Request,
    choices: &[ArraySelection],
    (share, reads): (&Share, &mut u64),
    meter: &Meter,
) -> Result<Vec<NumberedPiece<'a>>> {
    let mut pieces = pieces_with_cells(dataset);
    if !dataset.has_blocks || is_unsplit(request, choices) {
        pieces.retain(|piece| !is_flat(piece.1));
        return Ok(pieces);
    }
    let mut flags = Vec::new();
    for &(index, piece) in pieces.iter().filter(|piece| share.has(piece.0)) {
        flags.push((index, has_volume(&cells::load(piece, meter)?)));
        *reads += 1;
        forget(piece);
    }
    let flags: BTreeMap<usize, bool> = share.gather(flags)?.into_iter().collect();
    let flagged = pieces.into_iter().map(|piece| (piece, flags.get(&piece.0).is_some_and(|flag| *flag)));
    let flagged = flagged.collect();
    let (drawn, _) = blocks::drawn_pieces(dataset, flagged, |has_volume| *has_volume, choices)?;
    Ok(drawn.into_iter().map(|piece| piece.0).collect())
}

/// True for a structured grid without thickness, which has no cells.
fn is_flat(piece: &Piece) -> bool {
    match &piece.geometry {
        Geometry::Curvilinear { dimensions, .. }
        | Geometry::Rectilinear { dimensions, .. }
        | Geometry::Uniform { dimensions, .. } => dimensions.iter().any(|&count| count < 2),
        _ => false,
    }
}

/// Drops what a reader from outside has read of a piece and nobody took.
fn forget(piece: &Piece) {
    if let Geometry::Added(external) = &piece.geometry {
        *external.ready() = Default::default();
    }
}

fn has_ghost_flags(piece: &Piece) -> bool {
    piece.arrays.iter().any(|array| [GHOST_TYPE, GHOST_LEVELS].contains(&array.stored.name.as_str()))
}

/// Keys of global ids; with ghosts, cells decide which points are another piece's.
fn keys_of_ids(
    dataset: &Dataset,
    pieces: &[NumberedPiece],
    ids: &str,
    has_ghosts: bool,
    request: &Request,
    meter: &Meter,
) -> Result<KeysOfPieces> {
    let bare = request_of(request, Vec::new(), true);
    let mut found = KeysOfPieces::default();
    for &(index, piece) in pieces {
        let raw = match has_ghosts {
            true => load_one(dataset, piece, cells::load(piece, meter)?, &bare, meter)?,
            false => {
                let ids = piece.array(Association::Point, ids).map(|ids| ids.load(meter)).transpose()?;
                RawGrid { global_ids: ids, ..RawGrid::new(SharedSlice::default(), no_cells()) }
            }
        };
        grid::check_cells(&raw).map_err(|error| error.at_item(format!("piece {index}")))?;
        let raw = RawGrid { block: assemble::group(dataset, piece, index), ..raw };
        found.keys.push((index, PointKeys::of_ids(&raw, has_ghosts)));
        found.reads += 1;
        forget(piece);
    }
    Ok(found)
}

/// Keys of positions and values.
fn keys_of_places(
    dataset: &Dataset,
    pieces: &[NumberedPiece],
    request: &Request,
    choices: &[ArraySelection],
    share: &Share,
    meter: &Meter,
) -> Result<KeysOfPieces> {
    let bare = request_of(request, Vec::new(), true);
    let mut found = KeysOfPieces::default();
    let mut own = Vec::new();
    for &(index, piece) in pieces {
        let raw = load_one(dataset, piece, no_cells(), &bare, meter)?;
        own.push((index, assemble::group(dataset, piece, index), extent::bounds(&raw.points)));
        found.reads += 1;
        forget(piece);
    }
    let mut boxes = vec![(0, None); dataset.pieces.len()];
    for (index, block, bounds) in share.gather(own)? {
        boxes[index] = (block, bounds);
    }
    let others = grid::boxes_of_others(&boxes);
    // Points are one where all values on points are equal.
    let with_scalar = !request.without_scalar
        && choices.first().is_some_and(|choice| choice.association == Association::Point);
    let of_arrays = assemble::unique(&request.point_arrays).into_iter();
    let of_arrays = of_arrays.zip(&choices[usize::from(!request.without_scalar)..]);
    let names = of_arrays.filter(|(_, choice)| choice.association == Association::Point);
    let wanted = request_of(request, names.map(|(name, _)| name.clone()).collect(), !with_scalar);
    for &(index, piece) in pieces.iter().filter(|piece| !others[piece.0].is_empty()) {
        let raw = load_one(dataset, piece, no_cells(), &wanted, meter)?;
        let raw = RawGrid { block: boxes[index].0, ..raw };
        found.keys.push((index, PointKeys::of_places(&raw, &others[index])));
        found.reads += 1;
        forget(piece);
    }
    Ok(found)
}

fn no_cells() -> Cells {
    Cells::Tetrahedra(SharedSlice::default())
}

/// The request with these arrays on points and none on cells.
fn request_of(request: &Request, point_arrays: Vec<String>, without_scalar: bool) -> Request {
    Request { without_scalar, point_arrays, cell_arrays: Vec::new(), ..request.clone() }
}

fn load_one(
    dataset: &Dataset,
    piece: &Piece,
    cells: Cells,
    request: &Request,
    meter: &Meter,
) -> Result<RawGrid> {
    let choices = choices(dataset, request)?;
    let ids = global_ids(dataset);
    load(piece, cells, &assemble::PieceRequest { request, choices: &choices, ids, fills: false }, meter)
}

/// Reads some pieces and builds their grid.
pub(super) fn read(
    dataset: &Dataset,
    request: &Request,
    pieces: &[usize],
    borders: &PieceBorders,
    progress: &dyn Progress,
) -> Result<Option<Grid>> {
    let count = dataset.pieces.len();
    if borders.is_drawn.len() != count {
        let error = Error::usage("the borders are those of another file").got(borders.is_drawn.len());
        return Err(error.expected(counted(count, "piece")));
    }
    let numbers: BTreeSet<usize> = pieces.iter().copied().collect();
    if let Some(&wrong) = numbers.last().filter(|&&last| last >= count) {
        let error = Error::usage("the file has no such piece").got(wrong);
        return Err(error.expected(format_args!("a number below {count}")));
    }
    // Blocks that are left out are named.
    let is_own = |index: usize| numbers.contains(&index) && (borders.is_drawn[index] || dataset.has_blocks);
    let own = pieces_with_cells(dataset).into_iter().filter(|piece| is_own(piece.0));
    let own: Vec<NumberedPiece> = own.collect();
    if !own.iter().any(|piece| borders.is_drawn[piece.0]) {
        return Ok(None);
    }
    if borders.is_drawn.iter().filter(|is_drawn| **is_drawn).count() == 1 {
        return assemble::assemble(dataset, request, progress).map(Some);
    }
    let meter = Meter::new(progress, dataset.file_bytes);
    let external = fetch(dataset, &own, request, progress)?;
    let cells: Vec<Cells> = of_each(own.clone(), |piece| cells::load(piece.1, &meter))?;
    let choices = choices(dataset, request)?;
    let is_unsplit = is_unsplit(request, &choices);
    if !is_unsplit && !cells.iter().any(has_volume) {
        return Ok(None);
    }
    let left = unread_of(dataset, own.iter().map(|piece| piece.1), &choices)?;
    let with_cells = own.into_iter().zip(cells).collect();
    let (kept, sentences) = match is_unsplit {
        true => (with_cells, blocks::blocks_to_fill(dataset, &choices)),
        false => blocks::drawn_pieces(dataset, with_cells, has_volume, &choices)?,
    };
    let loaded = load_all(dataset, kept, request, &choices, &meter)?;
    let mut parts = grid::join_part(loaded, &borders.halos, &borders.shared, &borders.first_cells)?;
    describe(&mut parts, dataset, request, &choices)?;
    parts.origin.warnings.extend(sentences);
    parts.origin.warnings.extend(external.iter().flat_map(|external| external.ready().warnings.clone()));
    (parts.origin.arrays_unread, parts.origin.values_unread) = (left.arrays, left.value_count);
    if borders.is_adaptive {
        parts.hanging.get_or_insert_default();
    }
    grid::build_part(parts, &Options { without_tetrahedra: is_unsplit, ..request.options }, progress)
}
