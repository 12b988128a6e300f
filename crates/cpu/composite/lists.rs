//! Per-pixel lists of a tile: segments are appended as the cells come, as lengths and values at both ends; then a row's are put in
//! order by entry distance and handed on front to back, the 16 pixels of the row side by side. What a segment contributes is asked
//! only then, so that nothing is shaded that is hidden. The order is exact for disjoint cells whatever the cells are: cycles,
//! non-convex and disconnected grids need no special case.
//!
//! Layout: a pixel's segments lie one after another, so that what the pixels of a tile take next stays in the first-level cache
//! however unevenly they fill. Keys turn that: those of the 16 pixels of a row lie side by side, 16 lanes of the sorting network
//! and of the shader. Numbers stand in fours, so that each four moves by one instruction.

use crate::fragments::batch::Batch;
use crate::project::record::TILE;
use voltet_simd::sort::sort_columns;
use voltet_simd::{Float, Lanes, Mask, Unsigned, inlined};

/// Segments a pixel can hold here; a tile that needs more is drawn again by [`super::growing_lists`].
pub(crate) const DEPTH: usize = 1024;
/// Bits of a slot number.
const SLOT_BITS: u32 = 10;
/// Slots of a pixel: it may take one from each cell of a vector before anybody looks whether there is room. An odd number of cache
/// lines, so that those of pixels do not meet in the same sets of a cache.
const ROOM: usize = DEPTH + 20;
const _: () = assert!(ROOM * size_of::<[f32; 4]>() / 64 % 2 == 1);

/// Pixels of a tile.
const PIXELS: usize = TILE * TILE;

/// The slot of what belongs to no pixel.
pub(crate) const NOBODY: u32 = (PIXELS * ROOM) as u32;

/// Entries that differ by less than this share of themselves may be one face, found from both of its cells.
const ENTRY_NOISE: f32 = 3e-7;

/// Whether a segment comes behind another of its pixel: by entry, then by exit, which is by length where entries are equal. Entries
/// within rounding count as equal: disjoint cells are in the same order by their exits, and of cells that overlap behind a shared face
/// the one that ends first comes first. Both by entry and length.
pub(crate) fn follows([entry, length]: [f32; 2], [other_entry, other_length]: [f32; 2]) -> bool {
    let noise = ENTRY_NOISE * entry.abs().max(other_entry.abs());
    if (entry - other_entry).abs() <= noise { length > other_length } else { entry > other_entry }
}

/// Share of the picture under which what lies behind is left out: an optical depth of 25.
pub(crate) const UNSEEN: f32 = 1e-11;

/// The same where what lies in front is not all known yet: so much less that rounding never leaves out what the sum would still show.
pub(crate) const UNSEEN_FOR_SURE: f32 = 0.5 * UNSEEN;

/// The next free slot of each pixel, row by row; then room to read a whole vector from any of them.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Next(pub [u32; PIXELS + TILE]);

/// Where each pixel's first segment goes.
const FIRST: Next = {
    let mut first = [0; PIXELS + TILE];
    let mut pixel = 0;
    while pixel < first.len() {
        first[pixel] = (pixel * ROOM) as u32;
        pixel += 1;
    }
    Next(first)
};

impl Default for Next {
    fn default() -> Self {
        FIRST
    }
}

/// The lists of one tile.
pub(crate) struct Lists {
    pub next: Next,
    /// Pixel by pixel, then one slot for what belongs to none. First: depth of the entry from the distance origin, depth from entry to
    /// exit, the first attribute at both; then two further attributes each, at entry and exit.
    pub fours: Vec<Vec<[f32; 4]>>,
    /// Of the row in hand: slot by slot the entries of its pixels, and their keys.
    entries: Vec<f32>,
    keys: Vec<u32>,
    /// Slots of the row in hand whose level is that of the slot before, with the lanes concerned.
    met: Vec<(u32, u32)>,
}

/// A pixel has more segments than [`DEPTH`].
#[derive(Debug)]
pub(crate) struct Overflow;

impl Default for Lists {
    fn default() -> Self {
        Lists {
            next: Next::default(),
            fours: Vec::new(),
            entries: vec![0.0; DEPTH * TILE],
            keys: vec![0; DEPTH * TILE],
            met: Vec::new(),
        }
    }
}

impl std::fmt::Debug for Lists {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lists").finish_non_exhaustive()
    }
}

impl Lists {
    /// Empty ones, of segments with so many attributes.
    pub fn clear(&mut self, attribute_count: usize) {
        self.next = FIRST;
        while self.fours.len() < (attribute_count + 1).div_ceil(2) {
            // Zeroed pages are mapped when first touched: a tile touches what its deepest pixel needs.
            self.fours.push(bytemuck::zeroed_vec(PIXELS * ROOM + 1));
        }
    }

    /// Segments of a row's pixels.
    pub fn counts(&self, row: usize) -> [u32; TILE] {
        std::array::from_fn(|x| self.next.0[row * TILE + x] - FIRST.0[row * TILE + x])
    }

    /// Most segments of a pixel of a row.
    pub fn deepest(&self, row: usize) -> usize {
        self.counts(row).iter().copied().max().unwrap_or(0) as usize
    }

    /// Whether a pixel has more than [`DEPTH`].
    pub fn is_over_full(&self) -> bool {
        let over = self.next.0.iter().zip(&FIRST.0).take(PIXELS);
        over.fold(false, |any, (next, first)| any | (first + (DEPTH as u32) < *next))
    }

    /// Appends to the list of a pixel (row << 4 | column). `place`: entry and length; `ends`: each attribute at both ends.
    pub fn push(
        &mut self,
        pixel: usize,
        place: [f32; 2],
        ends: impl IntoIterator<Item = [f32; 2]>,
    ) -> Result<(), Overflow> {
        let pixel = pixel % PIXELS;
        let at = self.next.0[pixel];
        if at >= FIRST.0[pixel] + DEPTH as u32 {
            return Err(Overflow);
        }
        self.next.0[pixel] += 1;
        let [entry, length] = place;
        self.fours[0][at as usize][..2].copy_from_slice(&[entry, length]);
        for (a, ends) in ends.into_iter().enumerate() {
            // The first attribute stands behind entry and length.
            let two = a + 1;
            self.fours[two / 2][at as usize][two % 2 * 2..][..2].copy_from_slice(&ends);
        }
        Ok(())
    }

    /// Puts the keys of a row in order of distance, or if not `sorted` of arrival. Returns the pixels whose segments are not in order.
    #[inline(always)]
    pub fn arrange<L: Lanes>(&mut self, row: usize, sorted: bool) -> u64 {
        let counts = self.counts(row);
        let deepest = self.deepest(row);
        if deepest == 0 {
            return 0;
        }
        self.make_keys::<L>(row, &counts, deepest, sorted);
        if !sorted {
            return self.disordered(row, &counts);
        }
        sort_columns::<L, TILE>(&mut self.keys, deepest);
        self.mend::<L>(row, deepest);
        0
    }

    /// Fills a batch with the slices `from..to` of a row that is arranged: each the next segment of all pixels, in those that have no
    /// further one a fragment of no length. `stretch`: distance by depth, pixel by pixel.  `places`: whether pixels, entries and exits are wanted.
    #[inline(always)]
    pub fn fill<L: Lanes>(
        &self,
        row: usize,
        slices: std::ops::Range<usize>,
        stretch: &[f32; PIXELS],
        places: bool,
        batch: &mut Batch,
    ) {
        let zero = L::F::splat(0.0);
        let attribute_count = batch.front.len();
        let last = L::U::splat(self.deepest(row).saturating_sub(1) as u32);
        for half in (0..TILE).step_by(L::WIDTH) {
            let pixel = row * TILE + half;
            let first = L::U::load(&FIRST.0[pixel..]);
            let stretch = L::F::load(&stretch[pixel..]);
            let pixels = L::U::iota() + L::U::splat(pixel as u32);
            for (k, slice) in slices.clone().enumerate() {
                let at = k * TILE + half;
                let key = L::U::load(&self.keys[slice * TILE + half..]);
                let live = key.equal(L::U::splat(u32::MAX)).not();
                // Where there is none something is read that does not count.
                let place = first + key.and(L::U::splat(DEPTH as u32 - 1)).min(last);
                let [entry, length, front, back] = L::F::gather_parts(&self.fours[0], place);
                let exit = entry + length;
                (L::F::select(live, length, zero) * stretch).store(&mut batch.length[at..]);
                if places {
                    pixels.store(&mut batch.pixel[at..]);
                    entry.store(&mut batch.entry[at..]);
                    exit.store(&mut batch.exit[at..]);
                }
                let mut put = inlined(
                    #[inline(always)]
                    |a: usize, front: L::F, back: L::F| {
                        if a < attribute_count {
                            L::F::select(live, front, zero).store(&mut batch.front[a][at..]);
                            L::F::select(live, back, zero).store(&mut batch.back[a][at..]);
                        }
                    },
                );
                put(0, front, back);
                let mut a = 1;
                while a < attribute_count {
                    let [front, back, next_front, next_back] =
                        L::F::gather_parts(&self.fours[a.div_ceil(2)], place);
                    put(a, front, back);
                    put(a + 1, next_front, next_back);
                    a += 2;
                }
            }
        }
    }

    /// Pixels of a row whose segments did not arrive in order.
    fn disordered(&self, row: usize, counts: &[u32; TILE]) -> u64 {
        let entry = |x: usize, slot: usize| self.fours[0][(row * TILE + x) * ROOM + slot][0];
        let wrong =
            |(x, &count): (usize, &u32)| (1..count as usize).any(|slot| entry(x, slot) < entry(x, slot - 1));
        counts.iter().enumerate().filter(|&column| wrong(column)).count() as u64
    }

    /// Keys: if `sorted` the entry in 22 bits of the pixel's own depth range, then the slot; past the end of a list all ones.
    #[inline(always)]
    fn make_keys<L: Lanes>(&mut self, row: usize, counts: &[u32; TILE], deepest: usize, sorted: bool) {
        let splat = L::F::splat;
        let steps = splat(((1u32 << (32 - SLOT_BITS)) - 2) as f32);
        let numbers: &[f32] = self.fours[0].as_flattened();
        for half in (0..TILE).step_by(L::WIDTH) {
            let count = L::U::load(&counts[half..]);
            // slot ≥ count: max(slot, count) == slot.
            let past = inlined(
                #[inline(always)]
                |slot: usize| count.max(L::U::splat(slot as u32)).equal(L::U::splat(slot as u32)),
            );
            if !sorted {
                for (k, keys) in self.keys.chunks_exact_mut(TILE).take(deepest).enumerate() {
                    L::U::select(past(k), L::U::splat(u32::MAX), L::U::splat(k as u32))
                        .store(&mut keys[half..]);
                }
                continue;
            }
            let first = L::U::load(&FIRST.0[row * TILE + half..]).shl::<2>();
            let (mut nearest, mut farthest) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for (k, entries) in self.entries.chunks_exact_mut(TILE).take(deepest).enumerate() {
                // Past the end of a list something is read that does not count.
                let entry = L::F::gather(numbers, first + L::U::splat((k as u32) << 2));
                entry.store(&mut entries[half..]);
                let past = past(k);
                nearest = L::F::select(past, nearest, entry.min(nearest));
                farthest = L::F::select(past, farthest, entry.max(farthest));
            }
            let range = farthest - nearest;
            // No finer than the noise: entries that may be one face are then at most one level apart.
            let noise = nearest.abs().max(farthest.abs()) * splat(ENTRY_NOISE);
            let finest = (splat(1.0) / noise).min(splat(f32::MAX));
            let scale = L::F::select(splat(0.0).lt(range), (steps / range).min(finest), splat(0.0));
            let rows = self.entries.chunks_exact(TILE).zip(self.keys.chunks_exact_mut(TILE));
            for (k, (entries, keys)) in rows.take(deepest).enumerate() {
                let level = ((L::F::load(&entries[half..]) - nearest) * scale).max(splat(0.0)).min(steps);
                let key = level.to_unsigned().shl::<SLOT_BITS>().or(L::U::splat(k as u32));
                L::U::select(past(k), L::U::splat(u32::MAX), key).store(&mut keys[half..]);
            }
        }
    }

    /// The keys are rounded: puts segments whose levels meet or touch into the order of [`follows`].
    #[inline(always)]
    fn mend<L: Lanes>(&mut self, row: usize, deepest: usize) {
        for half in (0..TILE).step_by(L::WIDTH) {
            self.met.clear();
            let mut before = L::U::load(&self.keys[half..]).shr::<SLOT_BITS>();
            for k in 1..deepest {
                let key = L::U::load(&self.keys[k * TILE + half..]);
                let level = key.shr::<SLOT_BITS>();
                let touches = level.equal(before).or(level.equal(before + L::U::splat(1)));
                let bits = touches.bits() & !key.equal(L::U::splat(u32::MAX)).bits();
                if bits != 0 {
                    self.met.push((k as u32, bits));
                }
                before = level;
            }
            for i in 0..self.met.len() {
                let (k, mut bits) = self.met[i];
                while bits != 0 {
                    self.settle(row, half + bits.trailing_zeros() as usize, k as usize);
                    bits &= bits - 1;
                }
            }
        }
    }

    /// Moves the segment at place `k` of column `x` forward among those of its level and the next: a step of an
    /// insertion sort. Rounding is monotone, so other levels are in order already.
    fn settle(&mut self, row: usize, x: usize, k: usize) {
        let at = |key: u32| {
            let [entry, length, ..] =
                self.fours[0][(row * TILE + x) * ROOM + (key & (DEPTH as u32 - 1)) as usize];
            [entry, length]
        };
        let key = self.keys[k * TILE + x];
        let mut to = k;
        while to > 0 {
            let before = self.keys[(to - 1) * TILE + x];
            let apart = (key >> SLOT_BITS).abs_diff(before >> SLOT_BITS) > 1;
            if apart || !follows(at(before), at(key)) {
                break;
            }
            self.keys[to * TILE + x] = before;
            to -= 1;
        }
        self.keys[to * TILE + x] = key;
    }
}
