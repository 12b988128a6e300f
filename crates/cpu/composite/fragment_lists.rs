//! Per-pixel fragment lists of a tile (A-buffer; Carpenter 1984): segments are appended in the cells' order, as lengths and values at
//! both ends; then a row's are sorted by entry distance and handed on front to back, the 16 pixels of the row side by side. Segments are
//! shaded only then, so that no occluded one is. The order is exact for disjoint cells whatever the cells are: cycles, non-convex and
//! disconnected grids need no special case.
//!
//! Layout: a pixel's segments lie one after another, so that the next slots of a tile's pixels stay in the first-level cache
//! however unevenly they fill. Keys are transposed: those of the 16 pixels of a row lie side by side, 16 lanes of the sorting network
//! and of the shader. Numbers stand in quads, so that each four moves by one instruction.

use crate::fragments::batch::Batch;
use crate::fragments::spans::{FIRST_SLOTS, MAX_LIST_LENGTH, NextSlots, SLOT_BITS, SLOTS_PER_PIXEL};
use crate::tile::{PIXELS, TILE};
use crate::tolerances::ENTRY_NOISE;
use voltet_simd::sort::sort_columns;
use voltet_simd::{Float, Kernel, Lanes, Mask, Unsigned, inlined};

/// True if a segment comes behind another of its pixel: by entry, then by exit. `exit_difference`: by how far it ends behind the other.
/// Entries within rounding count as equal: disjoint cells are in the same order by their exits, and of cells that overlap behind a shared
/// face the one that ends first comes first.
pub(crate) fn is_behind([entry, other_entry]: [f32; 2], exit_difference: f32) -> bool {
    let noise = ENTRY_NOISE * entry.abs().max(other_entry.abs());
    if (entry - other_entry).abs() <= noise { exit_difference > 0.0 } else { entry > other_entry }
}

pub(crate) struct FragmentLists {
    pub next: NextSlots,
    /// Pixel by pixel, then one slot for what belongs to none. First: depth of the entry from the distance origin, depth from entry to
    /// exit, the first attribute at both; then two further attributes each, at entry and exit.
    pub quads: Vec<Vec<[f32; 4]>>,
    /// Current row: slot by slot the entries of its pixels, and their keys.
    entries: Vec<f32>,
    keys: Vec<u32>,
    /// Ties of the current row: slots whose level is that of the slot before, with the lanes concerned.
    ties: Vec<(u32, u32)>,
}

/// A pixel has more segments than [`MAX_LIST_LENGTH`].
#[derive(Debug)]
pub(crate) struct Overflow;

impl Default for FragmentLists {
    fn default() -> Self {
        FragmentLists {
            next: NextSlots::default(),
            quads: Vec::new(),
            entries: vec![0.0; MAX_LIST_LENGTH * TILE],
            keys: vec![0; MAX_LIST_LENGTH * TILE],
            ties: Vec::new(),
        }
    }
}

impl std::fmt::Debug for FragmentLists {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FragmentLists").finish_non_exhaustive()
    }
}

impl FragmentLists {
    /// Empties the lists, for segments with so many attributes.
    pub fn clear(&mut self, attribute_count: usize) {
        self.next = FIRST_SLOTS;
        while self.quads.len() < (attribute_count + 1).div_ceil(2) {
            // Zeroed pages are mapped when first touched: a tile touches what its max_length pixel needs.
            self.quads.push(bytemuck::zeroed_vec(PIXELS * SLOTS_PER_PIXEL + 1));
        }
    }

    /// Segments of a row's pixels.
    pub fn counts(&self, row: usize) -> [u32; TILE] {
        std::array::from_fn(|x| self.next.0[row * TILE + x] - FIRST_SLOTS.0[row * TILE + x])
    }

    /// Most segments of a pixel of a row.
    pub fn max_length(&self, row: usize) -> usize {
        self.counts(row).iter().copied().max().unwrap_or(0) as usize
    }

    /// True if a list is longer than [`MAX_LIST_LENGTH`].
    pub fn is_over_full(&self) -> bool {
        let over = self.next.0.iter().zip(&FIRST_SLOTS.0).take(PIXELS);
        over.fold(false, |any, (next, first)| any | (first + (MAX_LIST_LENGTH as u32) < *next))
    }

    /// Appends to the list of a pixel (row << 4 | column). `depths`: entry and length; `ends`: each attribute at both ends.
    pub fn push(
        &mut self,
        pixel: usize,
        depths: [f32; 2],
        ends: impl IntoIterator<Item = [f32; 2]>,
    ) -> Result<(), Overflow> {
        let pixel = pixel % PIXELS;
        let at = self.next.0[pixel];
        if at >= FIRST_SLOTS.0[pixel] + MAX_LIST_LENGTH as u32 {
            return Err(Overflow);
        }
        self.next.0[pixel] += 1;
        let [entry, length] = depths;
        self.quads[0][at as usize][..2].copy_from_slice(&[entry, length]);
        for (a, ends) in ends.into_iter().enumerate() {
            // The first attribute stands behind entry and length.
            let two = a + 1;
            self.quads[two / 2][at as usize][two % 2 * 2..][..2].copy_from_slice(&ends);
        }
        Ok(())
    }

    /// Pixels of a row whose segments did not arrive in order.
    fn disordered(&self, row: usize, counts: &[u32; TILE]) -> u64 {
        let entry = |x: usize, slot: usize| self.quads[0][(row * TILE + x) * SLOTS_PER_PIXEL + slot][0];
        let wrong =
            |(x, &count): (usize, &u32)| (1..count as usize).any(|slot| entry(x, slot) < entry(x, slot - 1));
        counts.iter().enumerate().filter(|&column| wrong(column)).count() as u64
    }

    /// Keys: if `sorted` the entry in 22 bits of the pixel's own depth range, then the slot; past the end of a list all ones.
    #[inline(always)]
    fn make_keys<L: Lanes>(&mut self, row: usize, counts: &[u32; TILE], max_length: usize, sorted: bool) {
        let splat = L::F::splat;
        let steps = splat(((1u32 << (32 - SLOT_BITS)) - 2) as f32);
        let numbers: &[f32] = self.quads[0].as_flattened();
        for half in (0..TILE).step_by(L::WIDTH) {
            let count = L::U::load(&counts[half..]);
            // slot ≥ count: max(slot, count) == slot.
            let past =
                inlined!(|slot: usize| count.max(L::U::splat(slot as u32)).equal(L::U::splat(slot as u32)));
            if !sorted {
                for (k, keys) in self.keys.chunks_exact_mut(TILE).take(max_length).enumerate() {
                    L::U::select(past(k), L::U::splat(u32::MAX), L::U::splat(k as u32))
                        .store(&mut keys[half..]);
                }
                continue;
            }
            let first = L::U::load(&FIRST_SLOTS.0[row * TILE + half..]).shl::<2>();
            let (mut nearest, mut farthest) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for (k, entries) in self.entries.chunks_exact_mut(TILE).take(max_length).enumerate() {
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
            for (k, (entries, keys)) in rows.take(max_length).enumerate() {
                let level = ((L::F::load(&entries[half..]) - nearest) * scale).max(splat(0.0)).min(steps);
                let key = level.to_unsigned().shl::<SLOT_BITS>().or(L::U::splat(k as u32));
                L::U::select(past(k), L::U::splat(u32::MAX), key).store(&mut keys[half..]);
            }
        }
    }

    /// The keys are rounded: puts segments whose levels meet or touch into the order of [`is_behind`].
    #[inline(always)]
    fn resolve_ties<L: Lanes>(&mut self, row: usize, max_length: usize) {
        for half in (0..TILE).step_by(L::WIDTH) {
            self.ties.clear();
            let mut before = L::U::load(&self.keys[half..]).shr::<SLOT_BITS>();
            for k in 1..max_length {
                let key = L::U::load(&self.keys[k * TILE + half..]);
                let level = key.shr::<SLOT_BITS>();
                let touches = level.equal(before).or(level.equal(before + L::U::splat(1)));
                let bits = touches.bits() & !key.equal(L::U::splat(u32::MAX)).bits();
                if bits != 0 {
                    self.ties.push((k as u32, bits));
                }
                before = level;
            }
            for i in 0..self.ties.len() {
                let (k, mut bits) = self.ties[i];
                while bits != 0 {
                    self.insertion_step(row, half + bits.trailing_zeros() as usize, k as usize);
                    bits &= bits - 1;
                }
            }
        }
    }

    /// Moves the segment at index `k` of column `x` forward among those of its level and the next: a step of an
    /// insertion sort. Rounding is monotone, so other levels are in order already.
    fn insertion_step(&mut self, row: usize, x: usize, k: usize) {
        let at = |key: u32| {
            let [entry, length, ..] = self.quads[0]
                [(row * TILE + x) * SLOTS_PER_PIXEL + (key & (MAX_LIST_LENGTH as u32 - 1)) as usize];
            [entry, length]
        };
        let key = self.keys[k * TILE + x];
        let mut to = k;
        while to > 0 {
            let before = self.keys[(to - 1) * TILE + x];
            let apart = (key >> SLOT_BITS).abs_diff(before >> SLOT_BITS) > 1;
            let ([entry, length], [other_entry, other_length]) = (at(before), at(key));
            // Cells may be thinner than the rounding of their sum.
            let exit_difference = (entry - other_entry) + (length - other_length);
            if apart || !is_behind([entry, other_entry], exit_difference) {
                break;
            }
            self.keys[to * TILE + x] = before;
            to -= 1;
        }
        self.keys[to * TILE + x] = key;
    }
}

/// Puts the keys of a row in order of distance, or if not `sorted` of arrival.
pub(crate) struct Arrange<'a> {
    pub lists: &'a mut FragmentLists,
    pub row: usize,
    pub sorted: bool,
}

impl Kernel<u64> for Arrange<'_> {
    /// Returns the number of pixels whose segments are not in order.
    #[inline(always)]
    fn run<L: Lanes>(self) -> u64 {
        let Arrange { lists, row, sorted } = self;
        let counts = lists.counts(row);
        let max_length = lists.max_length(row);
        if max_length == 0 {
            return 0;
        }
        lists.make_keys::<L>(row, &counts, max_length, sorted);
        if !sorted {
            return lists.disordered(row, &counts);
        }
        sort_columns::<L, TILE>(&mut lists.keys, max_length);
        lists.resolve_ties::<L>(row, max_length);
        0
    }
}

/// Fills a batch with slices of a row that is sorted: each the next segment of all pixels, in those that have no further one a fragment
/// of no length.
pub(crate) struct Fill<'a> {
    pub lists: &'a FragmentLists,
    pub row: usize,
    pub slices: std::ops::Range<usize>,
    /// Distance by depth, pixel by pixel.
    pub length_per_depth: &'a [f32; PIXELS],
    /// True if pixels, entries and exits are needed.
    pub depths: bool,
    pub batch: &'a mut Batch,
}

impl Kernel for Fill<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Fill { lists, row, slices, length_per_depth, depths, batch } = self;
        let zero = L::F::splat(0.0);
        let attribute_count = batch.front.len();
        let last = L::U::splat(lists.max_length(row).saturating_sub(1) as u32);
        for half in (0..TILE).step_by(L::WIDTH) {
            let pixel = row * TILE + half;
            let first = L::U::load(&FIRST_SLOTS.0[pixel..]);
            let length_per_depth = L::F::load(&length_per_depth[pixel..]);
            let pixels = L::U::iota() + L::U::splat(pixel as u32);
            for (k, slice) in slices.clone().enumerate() {
                let at = k * TILE + half;
                let key = L::U::load(&lists.keys[slice * TILE + half..]);
                let live = key.equal(L::U::splat(u32::MAX)).not();
                // Where there is none something is read that does not count.
                let slot = first + key.and(L::U::splat(MAX_LIST_LENGTH as u32 - 1)).min(last);
                let [entry, length, front, back] = L::F::gather_parts(&lists.quads[0], slot);
                let exit = entry + length;
                (L::F::select(live, length, zero) * length_per_depth).store(&mut batch.length[at..]);
                if depths {
                    pixels.store(&mut batch.pixel[at..]);
                    entry.store(&mut batch.entry[at..]);
                    exit.store(&mut batch.exit[at..]);
                }
                let mut put = inlined!(|a: usize, front: L::F, back: L::F| {
                    if a < attribute_count {
                        L::F::select(live, front, zero).store(&mut batch.front[a][at..]);
                        L::F::select(live, back, zero).store(&mut batch.back[a][at..]);
                    }
                });
                put(0, front, back);
                let mut a = 1;
                while a < attribute_count {
                    let [front, back, next_front, next_back] =
                        L::F::gather_parts(&lists.quads[a.div_ceil(2)], slot);
                    put(a, front, back);
                    put(a + 1, next_front, next_back);
                    a += 2;
                }
            }
        }
    }
}
