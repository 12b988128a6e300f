//! Points that several pieces of a grid hold: found by their keys ([`PointKeys`]), and put into one order with all other points.
//!
//! The order keeps that of each piece. It is found for the shared points alone; each other point follows the last of them that its
//! piece has before it. So two points of a cell have the same order whatever other pieces are there, and faces are cut by the same
//! diagonals.

use super::extent;
use super::parts::{Cells, RawGrid};
use super::point_keys::{Keys, PointKeys, boxes_of_others};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// A point that several pieces hold, in one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SharedPoint {
    /// Number in the piece.
    pub point: u32,
    /// Place in the order of all shared points.
    pub rank: u32,
    /// True in the one piece whose position and values count.
    pub is_source: bool,
}

/// A piece and the number of a point there.
type Place = [u32; 2];

/// The shared points of the pieces of a grid.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SharedPoints {
    /// For each piece its shared points, by their numbers there.
    of_pieces: Vec<Vec<SharedPoint>>,
    /// Shared points, each once.
    count: usize,
    /// The first place of each by rank, where pieces contradict each other and all points are in the order of their global ids.
    firsts: Option<Vec<Place>>,
}

impl SharedPoints {
    /// Finds points of different pieces that are one. Points of one piece stay apart: its second of a key is one with the second of
    /// another piece.
    ///
    /// Their order is that of every piece; where the pieces contradict each other, that of the ids if there are any, else of the
    /// first of the pieces.
    pub fn find(pieces: &[PointKeys]) -> SharedPoints {
        let mut of_blocks = BTreeMap::<usize, Vec<usize>>::new();
        for (index, piece) in pieces.iter().enumerate() {
            of_blocks.entry(piece.block).or_default().push(index);
        }
        let mut holders: Vec<(Place, Place)> = Vec::new();
        for members in of_blocks.into_values().filter(|members| members.len() > 1) {
            let (mut ids, mut places) = (Vec::new(), Vec::new());
            for index in members {
                let number = index as u32;
                let place = |key: usize| [number, pieces[index].point(key)];
                match &pieces[index].keys {
                    Keys::Ids(own) => ids.extend(own.iter().enumerate().map(|(key, &id)| (id, place(key)))),
                    Keys::Places(own) => {
                        places.extend(own.iter().enumerate().map(|(key, &own)| (own, place(key))));
                    }
                }
            }
            add_holders(&mut holders, ids);
            add_holders(&mut holders, places);
        }
        holders.par_sort_unstable();
        let classes: Vec<&[(Place, Place)]> = holders.chunk_by(|a, b| a.0 == b.0).collect();
        let mut lists: Vec<Vec<SharedPoint>> = vec![Vec::new(); pieces.len()];
        for (class, same) in classes.iter().enumerate() {
            let owned = |[piece, point]: Place| pieces[piece as usize].is_owned(point);
            let source = same.iter().position(|&(_, own)| owned(own)).unwrap_or(0);
            for (place, &(_, [piece, point])) in same.iter().enumerate() {
                let shared = SharedPoint { point, rank: class as u32, is_source: place == source };
                lists[piece as usize].push(shared);
            }
        }
        lists.par_iter_mut().for_each(|list| list.sort_unstable_by_key(|shared| shared.point));
        let counts = classes.iter().map(|same| same.len() as u32).collect();
        let (mut ranks, is_contradictory) = merged(&lists, counts);
        let has_ids = pieces.iter().any(|piece| matches!(&piece.keys, Keys::Ids(ids) if !ids.is_empty()));
        let firsts = (is_contradictory && has_ids).then(|| {
            let id = |[piece, point]: Place| pieces[piece as usize].id(point);
            let mut firsts: Vec<(Place, usize)> =
                classes.iter().enumerate().map(|(class, same)| (same[0].0, class)).collect();
            firsts.par_sort_by_key(|first| (id(first.0), first.0));
            firsts.iter().zip(0..).for_each(|(&(_, class), rank)| ranks[class] = rank);
            firsts.into_iter().map(|first| first.0).collect()
        });
        lists.iter_mut().flatten().for_each(|shared| shared.rank = ranks[shared.rank as usize]);
        SharedPoints { of_pieces: lists, count: ranks.len(), firsts }
    }

    /// The shared points of pieces of which one has no global ids, so that values count; `None` where they do not, or for a single piece.
    pub fn by_values(pieces: &[RawGrid]) -> Option<SharedPoints> {
        let values_count = pieces.len() > 1 && pieces.iter().any(|piece| piece.global_ids.is_none());
        values_count.then(|| shared_points(pieces))
    }

    /// True if values keep points of the pieces apart that are at one position: which of them are one depends on the arrays that are there.
    pub fn are_parted_by_values(&self, pieces: &[RawGrid]) -> bool {
        let without_arrays = |piece: &RawGrid| RawGrid {
            block: piece.block,
            global_ids: piece.global_ids.clone(),
            ..RawGrid::new(piece.points.clone(), Cells::default())
        };
        *self != shared_points(&pieces.iter().map(without_arrays).collect::<Vec<_>>())
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn piece_count(&self) -> usize {
        self.of_pieces.len()
    }

    /// True if a piece has none.
    pub fn is_empty_at(&self, piece: usize) -> bool {
        self.of_piece(piece).is_empty()
    }

    pub(super) fn of_piece(&self, piece: usize) -> &[SharedPoint] {
        self.of_pieces.get(piece).map_or(&[], Vec::as_slice)
    }

    /// For each piece those that it shares points with.
    pub fn neighbours(&self) -> Vec<BTreeSet<usize>> {
        let mut holders: Vec<(u32, usize)> = Vec::new();
        for (piece, list) in self.of_pieces.iter().enumerate() {
            holders.extend(list.iter().map(|shared| (shared.rank, piece)));
        }
        holders.par_sort_unstable();
        let mut neighbours = vec![BTreeSet::new(); self.of_pieces.len()];
        for same in holders.chunk_by(|a, b| a.0 == b.0) {
            for &(_, piece) in same {
                neighbours[piece].extend(same.iter().map(|other| other.1).filter(|&other| other != piece));
            }
        }
        neighbours
    }

    /// Memory that they take.
    pub fn byte_count(&self) -> u64 {
        let lists = self.of_pieces.iter().map(|list| size_of_val(&list[..])).sum::<usize>();
        (lists + self.firsts.as_deref().map_or(0, size_of_val)) as u64
    }

    /// Calls `take` for each point of a holder, with the shared point that it is and one more than the greatest rank before it.
    pub(super) fn each(&self, holder: &PointHolder, mut take: impl FnMut(usize, Option<SharedPoint>, u32)) {
        let mut shared = self.of_piece(holder.piece).iter().peekable();
        let mut before = 0;
        for point in 0..holder.count {
            let original = holder.original(point);
            while let Some(passed) = shared.next_if(|shared| shared.point < original) {
                before = before.max(passed.rank + 1);
            }
            let own = shared.next_if(|shared| shared.point == original).copied();
            take(point, own, before);
            before = own.map_or(before, |own| before.max(own.rank + 1));
        }
    }

    /// Numbers of the points of holders, ascending by their pieces, in a grid of them alone.
    pub(super) fn numbers(&self, holders: &[PointHolder]) -> PointNumbers {
        let slots = holders.iter().map(|holder| holder.count).sum();
        // The point whose values count: the source, or the first where that is not there.
        let mut chosen = vec![u32::MAX; self.count];
        // Points behind the shared point of each rank, from 1 on.
        let mut behind = vec![0_u32; self.count + 1];
        let mut slot = 0_u32;
        for holder in holders {
            self.each(holder, |_, shared, before| {
                match shared {
                    Some(own) => {
                        let chosen = &mut chosen[own.rank as usize];
                        *chosen = if own.is_source { slot } else { (*chosen).min(slot) };
                    }
                    None => behind[before as usize] += 1,
                }
                slot += 1;
            });
        }
        let mut found = PointNumbers { numbers: Vec::with_capacity(slots), ..PointNumbers::default() };
        match &self.firsts {
            None => self.number_by_rank(holders, &chosen, behind, &mut found),
            Some(firsts) => self.number_by_ids(holders, firsts, &mut found),
        }
        found.targets.reserve_exact(slots);
        let mut slot = 0_u32;
        for holder in holders {
            self.each(holder, |_, shared, _| {
                let is_chosen = shared.is_none_or(|own| chosen[own.rank as usize] == slot);
                found.targets.push(if is_chosen { found.numbers[slot as usize] } else { u32::MAX });
                slot += 1;
            });
        }
        found
    }

    fn number_by_rank(
        &self,
        holders: &[PointHolder],
        chosen: &[u32],
        mut behind: Vec<u32>,
        found: &mut PointNumbers,
    ) {
        let mut next = 0;
        let mut of_shared = vec![u32::MAX; self.count];
        for (rank, behind) in behind.iter_mut().enumerate() {
            if rank > 0 && chosen[rank - 1] != u32::MAX {
                of_shared[rank - 1] = next;
                next += 1;
            }
            next += std::mem::replace(behind, next);
        }
        for holder in holders {
            self.each(holder, |_, shared, before| {
                let next = &mut behind[before as usize];
                found.numbers.push(shared.map_or(*next, |own| of_shared[own.rank as usize]));
                *next += u32::from(shared.is_none());
            });
        }
        found.count = next as usize;
    }

    fn number_by_ids(&self, holders: &[PointHolder], firsts: &[Place], found: &mut PointNumbers) {
        let mut keyed: Vec<(i64, Place, u32)> = Vec::new();
        for holder in holders {
            self.each(holder, |point, shared, _| {
                let own = [holder.piece as u32, holder.original(point)];
                let first = shared.map_or(own, |own| firsts[own.rank as usize]);
                let id = holder.ids.get(point).copied().unwrap_or(i64::MAX);
                keyed.push((id, first, keyed.len() as u32));
            });
        }
        keyed.par_sort_unstable();
        found.numbers.resize(keyed.len(), 0);
        for same in keyed.chunk_by(|a, b| a.1 == b.1) {
            same.iter().for_each(|&(_, _, slot)| found.numbers[slot as usize] = found.count as u32);
            found.count += 1;
        }
    }
}

/// Points of a piece, all or some, that go into a grid.
pub(super) struct PointHolder<'a> {
    pub piece: usize,
    pub count: usize,
    /// Numbers in the piece, ascending; `None`: all points are there.
    pub originals: Option<&'a [u32]>,
    /// Global ids, or nothing.
    pub ids: &'a [i64],
}

impl PointHolder<'_> {
    fn original(&self, point: usize) -> u32 {
        self.originals.map_or(point as u32, |originals| originals[point])
    }
}

/// Numbers of points in a grid that is put together, one holder after the other.
#[derive(Default)]
pub(super) struct PointNumbers {
    pub numbers: Vec<u32>,
    /// The number, or nowhere (`u32::MAX`) where another point's position and values stand for these.
    pub targets: Vec<u32>,
    pub count: usize,
}

/// Adds the places of points that several pieces hold, each after the first of the same.
fn add_holders<K: Ord + Copy + Send>(holders: &mut Vec<(Place, Place)>, mut keyed: Vec<(K, Place)>) {
    keyed.par_sort_unstable();
    // By how many of the key its piece has before it.
    let mut numbered: Vec<(u32, Place)> = Vec::new();
    for equal in keyed.chunk_by(|a, b| a.0 == b.0).filter(|equal| equal.len() > 1) {
        numbered.clear();
        let (mut of_piece, mut seen) = (u32::MAX, 0);
        for &(_, place) in equal {
            (of_piece, seen) = if place[0] == of_piece { (of_piece, seen + 1) } else { (place[0], 0) };
            numbered.push((seen, place));
        }
        numbered.sort_unstable();
        for same in numbered.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            holders.extend(same.iter().map(|own| (same[0].1, own.1)));
        }
    }
}

/// Ranks of points in an order that keeps those of all lists, and true where the lists contradict each other: then the first point that a
/// list waits for comes next. `counts`: lists that hold each point.
fn merged(lists: &[Vec<SharedPoint>], mut counts: Vec<u32>) -> (Vec<u32>, bool) {
    let mut ranks = vec![u32::MAX; counts.len()];
    let mut next = 0..;
    let mut cursors = vec![0; lists.len()];
    let mut going: Vec<usize> = (0..lists.len()).rev().collect();
    // Lists that have come to a point which others have before them.
    let mut waiting: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut is_contradictory = false;
    loop {
        while let Some(list) = going.pop() {
            while let Some(shared) = lists[list].get(cursors[list]) {
                let point = shared.rank;
                if ranks[point as usize] == u32::MAX {
                    counts[point as usize] -= 1;
                    if counts[point as usize] > 0 {
                        waiting.entry(point).or_default().push(list);
                        break;
                    }
                    ranks[point as usize] = next.next().unwrap_or(u32::MAX);
                    going.extend(waiting.remove(&point).unwrap_or_default());
                }
                cursors[list] += 1;
            }
        }
        let Some((point, lists)) = waiting.pop_first() else { return (ranks, is_contradictory) };
        is_contradictory = true;
        ranks[point as usize] = next.next().unwrap_or(u32::MAX);
        going.extend(lists);
    }
}

/// The shared points of pieces that are all there.
pub(super) fn shared_points(pieces: &[RawGrid]) -> SharedPoints {
    SharedPoints::find(&keys_of_all(pieces))
}

/// Keys of points of pieces that are all there.
pub(super) fn keys_of_all(pieces: &[RawGrid]) -> Vec<PointKeys> {
    let has_ghosts = pieces.iter().any(|piece| piece.ghost.is_some());
    match pieces.iter().all(|piece| piece.global_ids.is_some()) {
        true => pieces.par_iter().map(|piece| PointKeys::of_ids(piece, has_ghosts)).collect(),
        false => {
            let boxes: Vec<(usize, Option<[DVec3; 2]>)> =
                pieces.iter().map(|piece| (piece.block, extent::bounds(&piece.points))).collect();
            let others = boxes_of_others(&boxes);
            let keyed = pieces.par_iter().zip(&others);
            keyed.map(|(piece, others)| PointKeys::of_places(piece, others)).collect()
        }
    }
}
