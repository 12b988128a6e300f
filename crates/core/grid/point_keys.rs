//! Keys of points, by which points of different pieces that are one are found without the pieces.

use super::extent;
use super::parts::{Association, DUPLICATE, RawGrid, corners};
use crate::{Error, Result, counted};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Points that one task handles.
const CHUNK: usize = 1 << 13;

/// Keys of points of a piece: equal keys of pieces of one block are one point.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct PointKeys {
    pub(super) block: usize,
    pub(super) keys: Keys,
    /// Numbers of the points with these keys, ascending; `None`: all points have one.
    points: Option<Vec<u32>>,
    /// For each key, true at a point of a cell that is no ghost; `None`: at all.
    owned: Option<Vec<bool>>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum Keys {
    Ids(Vec<i64>),
    Places(Vec<PlaceKey>),
}

impl Default for Keys {
    fn default() -> Keys {
        Keys::Places(Vec::new())
    }
}

/// Two hashes of a position and values, whose 128 bits are not equal by chance.
pub(super) type PlaceKey = [u64; 2];

/// Function that sends bytes to each process and gives what each has sent to this one.
pub type Exchange<'a> = dyn Fn(Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> + 'a;

impl PointKeys {
    /// Keys of the points of a piece with global ids; `has_ghosts`: some piece of the grid has ghost cells, and a point that a piece has
    /// for its ghosts alone may hold older values than its owner's.
    pub fn of_ids(piece: &RawGrid, has_ghosts: bool) -> PointKeys {
        let owned = has_ghosts.then(|| {
            let mut owned = vec![false; piece.points.len()];
            // Lengths that do not fit are found when the piece is joined.
            let flags = |cell: usize| piece.ghost.as_ref().and_then(|ghost| ghost.get(cell));
            let own = |cell: &usize| flags(*cell).is_none_or(|flags| flags & DUPLICATE == 0);
            for &corner in (0..piece.cells.count()).filter(own).flat_map(|cell| corners(&piece.cells, cell)) {
                owned.get_mut(corner as usize).into_iter().for_each(|owned| *owned = true);
            }
            owned
        });
        let ids = piece.global_ids.clone().unwrap_or_default();
        PointKeys { block: piece.block, keys: Keys::Ids(ids), points: None, owned }
    }

    /// Keys of positions and of values in all point arrays, at the points of a piece that lie in one of the boxes of others.
    pub fn of_places(piece: &RawGrid, others: &[[DVec3; 2]]) -> PointKeys {
        let columns = columns_of_points(piece);
        let key = |(point, &at): (usize, &DVec3)| {
            others.iter().any(|&other| meet([at, at], other)).then(|| {
                let values = columns.iter().filter_map(|&(values, n)| values.get(point * n..(point + 1) * n));
                let words = at.as_ref().iter().chain(values.flatten()).map(|&x| bits(x));
                (words.fold([0, u64::MAX], |key, word| key.map(|key| mixed(key, word))), point as u32)
            })
        };
        let found = piece.points.par_iter().enumerate().with_min_len(CHUNK).filter_map(key);
        let (keys, points) = found.unzip();
        PointKeys { block: piece.block, keys: Keys::Places(keys), points: Some(points), owned: None }
    }

    /// Drops keys that no other piece of the grid has. `pieces`: those of this process, of `process_count` that call it together, each
    /// with its own. Each key is compared by the process that its hash names, so none holds the keys of all. Beside the keys it
    /// takes [`PointKeys::RETAIN_BYTES`] for each.
    ///
    /// # Errors
    /// - those of `exchange`; an answer of another length.
    pub fn retain_shared(pieces: &mut [PointKeys], process_count: usize, exchange: &Exchange) -> Result<()> {
        let mut counts = vec![0; process_count];
        pieces.iter().for_each(|piece| piece.each_hash(|hash| counts[owner(hash, process_count)] += 1));
        let mut hashes: Vec<Vec<u64>> = counts.into_iter().map(Vec::with_capacity).collect();
        for piece in &*pieces {
            piece.each_hash(|hash| hashes[owner(hash, process_count)].push(hash));
        }
        // Keys that two pieces of this process have need no answer, but others have to learn of them.
        let mut shared = Vec::new();
        for own in &mut hashes {
            own.par_sort_unstable();
            shared.extend(repeated(own));
            own.dedup();
        }
        if process_count > 1 {
            let answers = exchange(answers(exchange(hashes.iter().map(|own| bytes(own)).collect())?))?;
            for (own, flags) in hashes.into_iter().zip(answers) {
                if own.len() != flags.len() {
                    let error =
                        Error::run("another process sent a broken answer about points").got(flags.len());
                    return Err(error.expected(counted(own.len(), "flag")));
                }
                shared
                    .extend(own.into_iter().zip(flags).filter(|(_, flag)| *flag != 0).map(|(hash, _)| hash));
            }
        }
        shared.par_sort_unstable();
        pieces.par_iter_mut().for_each(|piece| piece.retain(&shared));
        Ok(())
    }

    /// Bytes that [`PointKeys::retain_shared`] takes for each key: its hash, as it is sent and one that comes, and both once more in the
    /// buffers of MPI. Processes compare about as many keys as they have.
    pub const RETAIN_BYTES: u64 = 5 * size_of::<u64>() as u64;

    /// Number of keys.
    pub fn count(&self) -> usize {
        match &self.keys {
            Keys::Ids(ids) => ids.len(),
            Keys::Places(places) => places.len(),
        }
    }

    pub(super) fn point(&self, key: usize) -> u32 {
        self.points.as_ref().map_or(key as u32, |points| points[key])
    }

    /// Calls `take` with a hash of each key and of the block, in order.
    fn each_hash(&self, take: impl FnMut(u64)) {
        let block = mixed(0, self.block as u64);
        match &self.keys {
            Keys::Ids(ids) => ids.iter().map(|&id| mixed(block, id as u64)).for_each(take),
            Keys::Places(places) => places.iter().map(|key| mixed(block, key[0])).for_each(take),
        }
    }

    /// Keeps the keys with these hashes, ascending.
    fn retain(&mut self, hashes: &[u64]) {
        let mut kept = Vec::new();
        let mut key = 0;
        self.each_hash(|hash| {
            if hashes.binary_search(&hash).is_ok() {
                kept.push(key);
            }
            key += 1;
        });
        self.points = Some(kept.iter().map(|&key| self.point(key)).collect());
        // Ids may be more than points; what does not fit is found when the piece is joined.
        let is_owned = |owned: &[bool], key: usize| owned.get(key).copied().unwrap_or(true);
        self.owned = self.owned.take().map(|owned| kept.iter().map(|&key| is_owned(&owned, key)).collect());
        self.keys = match &self.keys {
            Keys::Ids(ids) => Keys::Ids(kept.iter().map(|&key| ids[key]).collect()),
            Keys::Places(places) => Keys::Places(kept.iter().map(|&key| places[key]).collect()),
        };
    }

    /// Memory that they take.
    pub fn byte_count(&self) -> u64 {
        let keys = match &self.keys {
            Keys::Ids(ids) => size_of_val(&ids[..]),
            Keys::Places(places) => size_of_val(&places[..]),
        };
        let points = self.points.as_deref().map_or(0, size_of_val);
        (keys + points + self.owned.as_deref().map_or(0, size_of_val)) as u64
    }

    /// Place of a point's key.
    fn key_of(&self, point: u32) -> Option<usize> {
        match &self.points {
            Some(points) => points.binary_search(&point).ok(),
            None => Some(point as usize),
        }
    }

    pub(super) fn is_owned(&self, point: u32) -> bool {
        self.owned.as_ref().and_then(|owned| owned.get(self.key_of(point)?)).is_none_or(|owned| *owned)
    }

    pub(super) fn id(&self, point: u32) -> Option<i64> {
        match &self.keys {
            Keys::Ids(ids) => ids.get(self.key_of(point)?).copied(),
            Keys::Places(_) => None,
        }
    }
}

/// Number of the process that compares keys with a hash.
fn owner(hash: u64, process_count: usize) -> usize {
    (hash % process_count as u64) as usize
}

/// Hashes that are there more than once, of an ascending list, each once.
fn repeated(hashes: &[u64]) -> impl Iterator<Item = u64> {
    hashes.chunk_by(|a, b| a == b).filter(|same| same.len() > 1).map(|same| same[0])
}

/// For each hash that a process sent a flag: 1 where another has sent it, too.
fn answers(sent: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let sent: Vec<Vec<u64>> = sent.into_iter().map(|bytes| words(&bytes)).collect();
    let mut all = sent.concat();
    all.par_sort_unstable();
    let shared: Vec<u64> = repeated(&all).collect();
    drop(all);
    let flag = |hash: &u64| u8::from(shared.binary_search(hash).is_ok());
    sent.iter().map(|own| own.iter().map(flag).collect()).collect()
}

fn bytes(hashes: &[u64]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of_val(hashes));
    hashes.iter().for_each(|hash| bytes.extend(hash.to_le_bytes()));
    bytes
}

/// Hashes that were sent as bytes.
fn words(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word)).collect()
}

/// Boxes of others that are kept for a piece. One in a row of boxes has 26 neighbours.
const MAX_OTHERS: usize = 32;

/// For each piece, given by its block and its box, the boxes of the other pieces of the block that meet its own; its own box instead of
/// more than 32.
pub fn boxes_of_others(boxes: &[(usize, Option<[DVec3; 2]>)]) -> Vec<Vec<[DVec3; 2]>> {
    let mut of_blocks = BTreeMap::<usize, Vec<(usize, [DVec3; 2])>>::new();
    for (index, &(block, own)) in boxes.iter().enumerate() {
        of_blocks.entry(block).or_default().extend(own.map(|own| (index, own)));
    }
    let mut found = vec![Vec::new(); boxes.len()];
    for mut members in of_blocks.into_values() {
        // Along one axis, boxes that begin after the end of a piece do not meet it, nor do those before which all end.
        let all = members.iter().fold(None, |all, own| extent::joined(all, Some(own.1)));
        let axis = all.map_or(0, |[low, high]| (high - low).max_position());
        members.sort_by(|a, b| a.1[0][axis].total_cmp(&b.1[0][axis]));
        let mut ends: Vec<f64> = members.iter().map(|own| own.1[1][axis]).collect();
        for place in 1..ends.len() {
            ends[place] = ends[place].max(ends[place - 1]);
        }
        for &(index, own) in &members {
            let first = ends.partition_point(|&end| end < own[0][axis]);
            let end = members.partition_point(|other| other.1[0][axis] <= own[1][axis]);
            let others = members[first..end].iter().filter(|other| other.0 != index && meet(own, other.1));
            found[index] = others.map(|other| other.1).take(MAX_OTHERS + 1).collect();
            if found[index].len() > MAX_OTHERS {
                found[index] = vec![own];
            }
        }
    }
    found
}

fn meet([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> bool {
    a.cmple(d).all() && c.cmple(b).all()
}

/// Values of a point array and the components of a tuple.
type Column<'a> = (&'a [f64], usize);

fn columns_of_points(piece: &RawGrid) -> Vec<Column<'_>> {
    let scalar = piece.scalar.iter().filter(|scalar| scalar.association == Association::Point);
    let scalar = scalar.map(|scalar| (&scalar.values[..], 1));
    scalar
        .chain(piece.point_arrays.values().map(|array| (&array.values[..], array.component_count)))
        .collect()
}

/// Bits of a number: −0 is 0, and all NaNs are one.
fn bits(x: f64) -> u64 {
    if x.is_nan() { u64::MAX } else { (x + 0.0).to_bits() }
}

/// A key made of another and further bits: the finaliser of Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators".
fn mixed(key: u64, bits: u64) -> u64 {
    let mut z = (key ^ bits).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
