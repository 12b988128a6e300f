//! Parts of a grid: some pieces of a file at a time, with cells of the other pieces around them as ghosts. Each part has at its own cells
//! what the grid of all pieces has there (docs/src/explanation/optics.md, section 2).
//!
//! [`borders`] finds the keys of points that may be shared, then the cells near those that are, where gradients, means, ghost flags or
//! curved cells need them, and with global ids the values at those points of the piece whose values count. It reads the pieces of the part
//! that comes first, all that fit into memory, once, and keeps them for that part; the others one after the other, for the keys and for the
//! cells. Of several processes each reads its own, finds with the others which keys are shared ([`PointKeys::retain_shared`]), sends
//! all others these, and each the cells that lie near the pieces of that one. In memory are, beside the pieces that are kept and one
//! other, at first 49 bytes a point of the own pieces with global ids, or 60 a point in the box of another piece where there are none (its
//! key, and [`PointKeys::RETAIN_BYTES`]); then 12 for each shared point of each piece, and the cells near the borders with their values: of pieces of compact shape a share
//! that falls with their size, of cells scattered over the pieces all. Of 2.1 million hexahedra in 8 cubes, two layers are 17 MiB, in
//! 64 cubes 50 MiB.

use super::assemble::{
    choices, describe, fetch, global_ids, has_volume, is_averaged, is_unsplit, load, load_all,
    pieces_with_cells, unread_of,
};
use super::contents::{Dataset, GHOST_LEVELS, GHOST_TYPE, Geometry, Meter, NumberedPiece, Piece};
use super::piece_share::Share;
use super::request::{ArraySelection, Request};
use super::{assemble, blocks, cells};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};
use voltet_core::grid::{
    self, Association, Cells, Grid, Halo, Options, PointKeys, RawGrid, SharedPoints, extent,
};
use voltet_core::parallel::all_or_first;
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::{Error, Result, counted};
use voltet_graph::MEAN_LAYERS;

/// Borders between the pieces of a file: the points that several of them hold, in one order, and the cells near these.
#[derive(Debug)]
pub struct PieceBorders {
    /// For each piece: true if a picture may show it.
    is_drawn: Vec<bool>,
    shared: SharedPoints,
    halos: Vec<Option<Halo>>,
    /// For each piece the number of its first cell in the whole grid.
    first_cells: Vec<u64>,
    /// True if means of cell values are those of an adaptive grid.
    is_adaptive: bool,
    /// Pieces of the part that is read first.
    kept: Mutex<BTreeMap<usize, RawGrid>>,
    /// Times that this process has read a piece for them, each time some arrays of it.
    pub reads: u64,
}

impl PieceBorders {
    /// True if a picture may show a piece.
    pub fn is_drawn(&self, piece: usize) -> bool {
        self.is_drawn.get(piece).is_some_and(|is_drawn| *is_drawn)
    }

    /// Number of some pieces that are kept for the part that is read first, and so are not read again for it.
    pub fn kept_count(&self, pieces: &[usize]) -> usize {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        pieces.iter().filter(|piece| kept.contains_key(piece)).count()
    }

    /// Memory that they take, beside pieces that are kept.
    pub fn byte_count(&self) -> u64 {
        self.shared.byte_count() + self.halos.iter().flatten().map(Halo::byte_count).sum::<u64>()
    }
}

/// Finds the borders between the pieces. `first`: the pieces of the part that is read first, which are kept for it.
pub(super) fn borders(
    dataset: &Dataset,
    request: &Request,
    (layers, first): (usize, &[usize]),
    share: &Share,
    progress: &dyn Progress,
) -> Result<PieceBorders> {
    // Of what is not kept: keys, of positions after boxes; then halos.
    let meter = Meter::new(progress, dataset.file_bytes.saturating_mul(3));
    let choices = &choices(dataset, request)?;
    let mut own = OwnPieces { dataset, request, choices, meter: &meter, kept: BTreeMap::new(), reads: 0 };
    let pieces = drawn_pieces(&mut own, share)?;
    let has_means = is_averaged(request, choices);
    let mut found = PieceBorders {
        is_drawn: vec![false; dataset.pieces.len()],
        shared: SharedPoints::default(),
        halos: vec![None; dataset.pieces.len()],
        first_cells: vec![0; dataset.pieces.len()],
        is_adaptive: has_means
            && pieces.iter().any(|piece| matches!(piece.1.geometry, Geometry::Adaptive(_))),
        kept: Mutex::default(),
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
    let layers = (layers + if has_means { MEAN_LAYERS } else { 0 }).max(usize::from(has_ghosts));
    let numbered: Vec<NumberedPiece> = pieces.iter().copied().filter(|piece| share.has(piece.0)).collect();
    own.keep(numbered.iter().copied().filter(|piece| first.contains(&piece.0)).collect())?;
    let own_keys = match global_ids(dataset) {
        Some(ids) => own.keys_of_ids(&numbered, ids, has_ghosts)?,
        None => own.keys_of_places(&numbered, share)?,
    };
    let mut keys = vec![PointKeys::default(); dataset.pieces.len()];
    let shared_keys = shared_keys(own_keys, share, progress)?;
    for (index, of_piece) in share.gather(shared_keys)? {
        keys[index] = of_piece;
    }
    found.shared = SharedPoints::find(&keys);
    drop(keys);
    let halos = own.halos(&numbered, &found.shared, layers)?;
    let own_numbers: Vec<usize> = numbered.iter().map(|piece| piece.0).collect();
    // Other parts of this process need them.
    let is_one_part = own_numbers.iter().all(|piece| first.contains(piece));
    // A piece with curved cells has a layer more.
    let reached = match share.is_alone() {
        true => BTreeMap::new(),
        false => within(&found.shared.neighbours(), own_numbers, layers + 1),
    };
    let reaches =
        |from: usize, to: &BTreeSet<usize>| reached.get(&from).is_some_and(|own| !own.is_disjoint(to));
    for (index, halo) in share.exchange(halos, reaches)? {
        found.halos[index] = Some(halo).filter(|_| !(is_one_part && share.has(index)));
    }
    (found.kept, found.reads) = (Mutex::new(own.kept), own.reads);
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

/// Keys of own pieces that another piece has, too, once all processes have room for those of all pieces.
fn shared_keys(own: NumberedKeys, share: &Share, progress: &dyn Progress) -> Result<NumberedKeys> {
    let count = own.iter().map(|(_, keys)| keys.count() as u64).sum::<u64>();
    let what = || format!("finding which of {} are at borders", counted(count as usize, "point"));
    refuse_beyond_memory(progress, what, count.saturating_mul(PointKeys::RETAIN_BYTES))?;
    let shared = share.shared_keys(own)?;
    // As they are sent and come, and what becomes of them.
    let bytes = shared.iter().map(|(_, keys)| keys.byte_count().saturating_mul(3)).sum::<u64>();
    let bytes = share.gather(vec![bytes])?.into_iter().fold(0, u64::saturating_add);
    refuse_beyond_memory(progress, || "the points at the borders of pieces".into(), bytes)?;
    Ok(shared)
}

type NumberedKeys = Vec<(usize, PointKeys)>;

struct OwnPieces<'a> {
    dataset: &'a Dataset,
    request: &'a Request,
    choices: &'a [ArraySelection],
    meter: &'a Meter<'a>,
    /// Pieces of the part that is read first.
    kept: BTreeMap<usize, RawGrid>,
    /// Times that a piece was read.
    reads: u64,
}

impl OwnPieces<'_> {
    /// Reads pieces with all that is requested, and keeps them.
    fn keep(&mut self, pieces: Vec<NumberedPiece>) -> Result<()> {
        let open = fetch(self.dataset, &pieces, self.request, self.meter.progress())?;
        let cells: Vec<Cells> =
            all_or_first(pieces.par_iter().map(|piece| cells::load(piece.1, self.meter)))?;
        self.reads += pieces.len() as u64;
        let with_cells = pieces.iter().copied().zip(cells).collect();
        let loaded = load_all(self.dataset, with_cells, self.request, self.choices, self.meter)?;
        self.kept.extend(loaded);
        if let Some(first) = self.kept.values_mut().next() {
            let warnings = open.iter().flat_map(|open| open.ready().warnings.clone());
            first.origin.warnings.extend(warnings);
        }
        pieces.iter().for_each(|piece| forget(piece.1));
        Ok(())
    }

    /// Work on a piece, as it is kept or as `read` reads it.
    fn with<T>(
        &mut self,
        (index, piece): NumberedPiece,
        read: impl FnOnce(&Self) -> Result<RawGrid>,
        work: impl FnOnce(&mut RawGrid) -> Result<T>,
    ) -> Result<T> {
        if let Some(kept) = self.kept.get_mut(&index) {
            return work(kept);
        }
        let mut raw = read(self)?;
        raw.block = assemble::group(self.dataset, piece, index);
        self.reads += 1;
        let done = work(&mut raw);
        forget(piece);
        done
    }

    /// Keys of global ids; with ghosts, cells decide which points are another piece's.
    fn keys_of_ids(&mut self, pieces: &[NumberedPiece], ids: &str, has_ghosts: bool) -> Result<NumberedKeys> {
        let bare = request_of(self.request, Vec::new(), true);
        let mut found = Vec::new();
        for &numbered @ (index, piece) in pieces {
            let read = |own: &Self| match has_ghosts {
                true => own.load(piece, cells::load(piece, own.meter)?, &bare),
                false => {
                    let ids = piece.array(Association::Point, ids);
                    let ids = ids.map(|ids| ids.load(own.meter)).transpose()?;
                    Ok(RawGrid { global_ids: ids, ..RawGrid::default() })
                }
            };
            let keys = self.with(numbered, read, |raw| {
                grid::check_cells(raw).map_err(|error| error.at_item(format!("piece {index}")))?;
                Ok(PointKeys::of_ids(raw, has_ghosts))
            })?;
            found.push((index, keys));
        }
        Ok(found)
    }

    fn keys_of_places(&mut self, pieces: &[NumberedPiece], share: &Share) -> Result<NumberedKeys> {
        let bare = request_of(self.request, Vec::new(), true);
        let mut own = Vec::new();
        for &numbered @ (index, piece) in pieces {
            let read = |own: &Self| own.load(piece, Cells::default(), &bare);
            own.push(self.with(numbered, read, |raw| Ok((index, raw.block, extent::bounds(&raw.points))))?);
        }
        let mut boxes = vec![(0, None); self.dataset.pieces.len()];
        for (index, block, bounds) in share.gather(own)? {
            boxes[index] = (block, bounds);
        }
        let others = grid::boxes_of_others(&boxes);
        // Points are one where all values on points are equal.
        let (request, choices) = (self.request, self.choices);
        let with_scalar = !request.without_scalar
            && choices.first().is_some_and(|choice| choice.association == Association::Point);
        let of_arrays = assemble::unique(&request.point_arrays).into_iter();
        let of_arrays = of_arrays.zip(&choices[usize::from(!request.without_scalar)..]);
        let names = of_arrays.filter(|(_, choice)| choice.association == Association::Point);
        let wanted = request_of(request, names.map(|(name, _)| name.clone()).collect(), !with_scalar);
        let mut found = Vec::new();
        for &numbered @ (index, piece) in pieces.iter().filter(|piece| !others[piece.0].is_empty()) {
            let read = |own: &Self| own.load(piece, Cells::default(), &wanted);
            let keys = self.with(numbered, read, |raw| Ok(PointKeys::of_places(raw, &others[index])))?;
            found.push((index, keys));
        }
        Ok(found)
    }

    /// The cells near the shared points.
    fn halos(
        &mut self,
        pieces: &[NumberedPiece],
        shared: &SharedPoints,
        layers: usize,
    ) -> Result<Vec<(usize, Halo)>> {
        let mut halos = Vec::new();
        for &numbered @ (index, piece) in pieces.iter().filter(|piece| !shared.is_empty_at(piece.0)) {
            // Points that curved cells add on a border are numbered by all cells there.
            let is_needed = layers > 0
                || global_ids(self.dataset).is_some()
                || cells::has_types(piece, grid::is_curved, self.meter)?;
            if is_needed {
                let read = |own: &Self| {
                    let cells = vec![(numbered, cells::load(piece, own.meter)?)];
                    let loaded = load_all(own.dataset, cells, own.request, own.choices, own.meter)?;
                    loaded.into_iter().next().map(|own| own.1).ok_or_else(|| Error::run("a piece is missing"))
                };
                let halo = self.with(numbered, read, |raw| Halo::from_piece(raw, shared, index, layers))?;
                halos.extend(halo.map(|halo| (index, halo)));
            }
        }
        Ok(halos)
    }

    fn load(&self, piece: &Piece, cells: Cells, request: &Request) -> Result<RawGrid> {
        let choices = choices(self.dataset, request)?;
        let ids = global_ids(self.dataset);
        load(
            piece,
            cells,
            &assemble::PieceRequest { request, choices: &choices, ids, fills: false },
            self.meter,
        )
    }
}

/// The pieces that a picture may show. Errors: none has a volume and the arrays.
fn drawn_pieces<'a>(own: &mut OwnPieces<'a>, share: &Share) -> Result<Vec<NumberedPiece<'a>>> {
    let dataset = own.dataset;
    let mut pieces = pieces_with_cells(dataset);
    if !dataset.has_blocks || is_unsplit(own.request, own.choices) {
        pieces.retain(|piece| !is_flat(piece.1));
        return Ok(pieces);
    }
    let mut flags = Vec::new();
    for &(index, piece) in pieces.iter().filter(|piece| share.has(piece.0)) {
        flags.push((index, has_volume(&cells::load(piece, own.meter)?)));
        own.reads += 1;
        forget(piece);
    }
    let flags: BTreeMap<usize, bool> = share.gather(flags)?.into_iter().collect();
    let flagged = pieces.into_iter().map(|piece| (piece, flags.get(&piece.0).is_some_and(|flag| *flag)));
    let flagged = flagged.collect();
    let (drawn, _) = blocks::drawn_pieces(dataset, flagged, |has_volume| *has_volume, own.choices)?;
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

/// Drops what was read of a piece and nobody took.
fn forget(piece: &Piece) {
    if let Geometry::Open(open) = &piece.geometry {
        *open.ready() = Default::default();
    }
}

fn has_ghost_flags(piece: &Piece) -> bool {
    piece.arrays.iter().any(|array| [GHOST_TYPE, GHOST_LEVELS].contains(&array.stored.name.as_str()))
}

/// The request with these arrays on points and none on cells.
fn request_of(request: &Request, point_arrays: Vec<String>, without_scalar: bool) -> Request {
    Request { without_scalar, point_arrays, cell_arrays: Vec::new(), ..request.clone() }
}

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
    let mut kept = std::mem::take(&mut *borders.kept.lock().unwrap_or_else(PoisonError::into_inner));
    let meter = Meter::new(progress, dataset.file_bytes);
    let unread: Vec<NumberedPiece> =
        own.iter().copied().filter(|piece| !kept.contains_key(&piece.0)).collect();
    let open = fetch(dataset, &unread, request, progress)?;
    let pieces: Vec<_> = own.iter().map(|&piece| (piece, kept.remove(&piece.0))).collect();
    let found: Vec<ReadPiece> = all_or_first(pieces.into_par_iter().map(|(piece, kept)| match kept {
        Some(kept) => Ok(ReadPiece::Whole(Box::new(kept))),
        None => Ok(ReadPiece::Cells(cells::load(piece.1, &meter)?)),
    }))?;
    drop(kept);
    let choices = choices(dataset, request)?;
    let is_unsplit = is_unsplit(request, &choices);
    if !is_unsplit && !found.iter().any(|piece| has_volume(piece.cells())) {
        return Ok(None);
    }
    let left = unread_of(dataset, own.iter().map(|piece| piece.1), &choices)?;
    let found = own.into_iter().zip(found).collect();
    let (drawn, sentences) = match is_unsplit {
        true => (found, blocks::blocks_to_fill(dataset, &choices)),
        false => blocks::drawn_pieces(dataset, found, |piece| has_volume(piece.cells()), &choices)?,
    };
    let (mut loaded, mut with_cells) = (Vec::new(), Vec::new());
    for (piece, own) in drawn {
        match own {
            ReadPiece::Whole(raw) => loaded.push((piece.0, *raw)),
            ReadPiece::Cells(cells) => with_cells.push((piece, cells)),
        }
    }
    loaded.extend(load_all(dataset, with_cells, request, &choices, &meter)?);
    loaded.sort_unstable_by_key(|piece| piece.0);
    let mut parts = grid::join_part(loaded, &borders.halos, &borders.shared, &borders.first_cells)?;
    describe(&mut parts, dataset, request, &choices)?;
    parts.origin.warnings.extend(sentences);
    parts.origin.warnings.extend(open.iter().flat_map(|open| open.ready().warnings.clone()));
    (parts.origin.arrays_unread, parts.origin.values_unread) = (left.arrays, left.value_count);
    if borders.is_adaptive {
        parts.hanging.get_or_insert_default();
    }
    grid::build_part(parts, &Options { without_tetrahedra: is_unsplit, ..request.options }, progress)
}

enum ReadPiece {
    /// It was kept.
    Whole(Box<RawGrid>),
    /// Its cells are read, its points and values are not.
    Cells(Cells),
}

impl ReadPiece {
    fn cells(&self) -> &Cells {
        match self {
            ReadPiece::Whole(raw) => &raw.cells,
            ReadPiece::Cells(cells) => cells,
        }
    }
}
