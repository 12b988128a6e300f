//! Per-pixel lists of a tile: segments are appended as the cells come, then each pixel's are sorted by entry
//! distance and composited front to back. The order is exact for disjoint cells whatever the cells are: cycles,
//! non-convex and disconnected grids need no special case.
//!
//! Layout: a pixel's segments lie one after another, so that what the pixels of a tile take next stays in the first-level cache
//! however unevenly they fill. Keys turn that: those of the 16 pixels of a row lie side by side, 16 lanes of the sorting network
//! and of the compositor. Colours stand in fours, so that each moves by one instruction.

use crate::composite::kernels::Arrange;
use crate::fragments::batch::{BATCH, Batch, Column, LANES_MOST};
use crate::project::record::TILE;
use crate::shade::later::Mark;
use crate::shade::shaded::Shaded;
use voltet_lanes::sort::sort_columns;
use voltet_lanes::{Float, LaneSet, Lanes, Mask, Unsigned, array, dispatch, inlined};

/// Segments a pixel can hold here; a tile that needs more is drawn again by [`super::growing_lists`].
pub(crate) const DEPTH: usize = 1024;
/// Bits of a slot number.
const SLOT_BITS: u32 = 10;
/// Slots of a pixel: a whole batch may go to it before anybody looks whether there is room. An odd number of cache lines, so that
/// those of pixels do not meet in the same sets of a cache.
const ROOM: usize = DEPTH + BATCH + 2;
const _: () = assert!(ROOM * size_of::<Slot>() / 64 % 2 == 1);

/// What one segment contributes to its pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Layer {
    /// Premultiplied colour and opacity.
    pub rgba: [f32; 4],
    /// Depth of the entry.
    pub entry: f32,
    /// Depth of the exit.
    pub exit: f32,
}

impl Layer {
    pub fn new(entry: f32, exit: f32, rgba: [f32; 4]) -> Layer {
        Layer { rgba, entry, exit }
    }
}

/// One segment.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
struct Slot {
    rgba: [f32; 4],
    entry: f32,
    exit: f32,
    spare: [f32; 2],
}

/// Fours of numbers in a slot.
const FOURS: u32 = (size_of::<Slot>() / size_of::<[f32; 4]>()) as u32;
/// Numbers in a slot, as a power of two, and which of them is the entry.
const NUMBERS_BITS: u32 = 3;
const ENTRY: u32 = 4;
const _: () = assert!(size_of::<Slot>() == size_of::<f32>() << NUMBERS_BITS);
const _: () = assert!(std::mem::offset_of!(Slot, entry) == size_of::<f32>() * ENTRY as usize);

/// Entries that differ by less than this share of themselves may be one face, found from both of its cells.
const ENTRY_NOISE: f32 = 3e-7;

impl Layer {
    /// Whether this segment comes behind the other: by entry, then by exit. Entries within rounding count as equal:
    /// disjoint cells are in the same order by their exits, and of cells that overlap behind a shared face the one that
    /// ends first comes first.
    pub fn follows(&self, other: &Layer) -> bool {
        follows([self.entry, self.exit], [other.entry, other.exit])
    }
}

/// [`Layer::follows`] by entry and exit.
fn follows([entry, exit]: [f32; 2], [other_entry, other_exit]: [f32; 2]) -> bool {
    let noise = ENTRY_NOISE * entry.abs().max(other_entry.abs());
    if (entry - other_entry).abs() <= noise { exit > other_exit } else { entry > other_entry }
}

/// Share of the picture under which what lies behind is left out: an optical depth of 25.
pub(crate) const UNSEEN: f32 = 1e-11;

/// The same of what waits for its colour.
const UNSEEN_COLOR: f32 = 1e-8;

/// The lists of one tile.
pub(crate) struct Lists {
    /// The next free slot of each pixel, counted from the first pixel's first; then one for what belongs to none.
    next: [u32; COUNTERS],
    /// Pixel by pixel; then room for what belongs to none.
    slots: Vec<Slot>,
    /// Of the row in hand: slot by slot the entries of its pixels, and their keys.
    entries: Vec<f32>,
    keys: Vec<u32>,
    /// What is seen through each pixel, as far as it is more than [`UNSEEN`].
    pub through: [f32; TILE * TILE],
    /// Where the segments of the last batch went.
    pub places: Box<Column<u32>>,
    /// Slots of the row in hand whose level is that of the slot before, with the lanes concerned.
    met: Vec<(u32, u32)>,
    /// What is seen of the row in hand and waits for its colour.
    marks: Vec<Mark>,
}

/// Counters of a tile's pixels and of what belongs to none, and more, so that a number's lowest bits are one of them.
const COUNTERS: usize = 2 * TILE * TILE;

/// Where each pixel's first segment goes.
const FIRST: [u32; COUNTERS] = {
    let mut first = [0; COUNTERS];
    let mut pixel = 0;
    while pixel <= TILE * TILE {
        first[pixel] = (pixel * ROOM) as u32;
        pixel += 1;
    }
    first
};

/// Makes colours of what stands for those that wait ([`crate::shade::later`]), once it is known that they are seen; none waits
/// where there is none.
pub(crate) type Resolve<'a> = Option<&'a mut dyn FnMut(&mut [Mark])>;

/// A pixel has more segments than [`DEPTH`].
pub(crate) struct Overflow;

impl Default for Lists {
    fn default() -> Self {
        Lists::new()
    }
}

impl std::fmt::Debug for Lists {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lists").finish_non_exhaustive()
    }
}

impl Lists {
    pub fn new() -> Self {
        // Zeroed pages are mapped when first touched: a tile touches what its deepest pixel needs.
        Lists {
            next: FIRST,
            slots: bytemuck::zeroed_vec(ROOM * TILE * TILE + LANES_MOST),
            entries: vec![0.0; DEPTH * TILE],
            keys: vec![0; DEPTH * TILE],
            through: [1.0; TILE * TILE],
            places: Column::new(),
            met: Vec::new(),
            marks: Vec::new(),
        }
    }

    pub fn clear(&mut self) {
        self.next = FIRST;
    }

    /// Segments of a row's pixels.
    fn counts(&self, row: usize) -> [u32; TILE] {
        std::array::from_fn(|x| self.next[row * TILE + x] - FIRST[row * TILE + x])
    }

    /// Appends to the list of a pixel (row << 4 | column).
    #[inline(always)]
    pub fn push(&mut self, pixel: usize, layer: Layer) -> Result<(), Overflow> {
        let pixel = pixel & (TILE * TILE - 1);
        let at = self.next[pixel];
        if at >= FIRST[pixel] + DEPTH as u32 {
            return Err(Overflow);
        }
        self.next[pixel] += 1;
        self.slots[at as usize] =
            Slot { rgba: layer.rgba, entry: layer.entry, exit: layer.exit, spare: [0.0; 2] };
        Ok(())
    }

    /// Appends the first `count` fragments of a batch; those of no length are not segments.
    #[inline(always)]
    pub fn take<L: Lanes>(&mut self, batch: &Batch, shaded: &Shaded, count: usize) -> Result<(), Overflow> {
        let Lists { next, slots, places, .. } = self;
        let slots = slots.as_mut_slice();
        for at in (0..count).step_by(L::WIDTH) {
            let hit = L::F::splat(0.0).lt(L::F::load(&batch.length[at..]));
            let last = L::U::splat((count - at - 1).min(L::WIDTH - 1) as u32);
            let hit = hit.and(L::U::iota().max(last).equal(last));
            // What is no segment goes where nobody looks.
            let nobody = L::U::splat((TILE * TILE) as u32);
            let mut pixels = [0; LANES_MOST];
            L::U::select(hit, L::U::load(&batch.pixel[at..]), nobody).store(&mut pixels);
            next[TILE * TILE] = FIRST[TILE * TILE];
            for (place, &pixel) in places[at..][..L::WIDTH].iter_mut().zip(&pixels) {
                let next = &mut next[pixel as usize & (COUNTERS - 1)];
                *place = *next;
                *next += 1;
            }
        }
        // Only now: a vector that was just written number by number is slow to read.
        let slots: &mut [[[f32; 4]; 2]] = bytemuck::cast_slice_mut(slots);
        for at in (0..count).step_by(L::WIDTH) {
            let rgba = array(
                #[inline(always)]
                |c| L::F::load(&shaded.rgba[c][at..]),
            );
            let (entry, exit) = (L::F::load(&batch.entry[at..]), L::F::load(&batch.exit[at..]));
            let spare = L::F::splat(0.0);
            L::F::scatter_parts([rgba, [entry, exit, spare, spare]], slots, L::U::load(&places[at..]));
        }
        let mut full = 0;
        for (&next, &first) in next.iter().zip(&FIRST).take(TILE * TILE) {
            full |= u32::from(first + (DEPTH as u32) < next);
        }
        if full != 0 { Err(Overflow) } else { Ok(()) }
    }

    /// Most segments of a pixel of a row.
    pub fn deepest(&self, row: usize) -> usize {
        self.counts(row).iter().copied().max().unwrap_or(0) as usize
    }

    /// Puts a row in order and hands on each segment: its place from the front, its column, and the bits of its red.
    pub fn in_order(&mut self, lanes: LaneSet, row: usize, mut each: impl FnMut(usize, usize, u32)) {
        let counts = self.counts(row);
        dispatch(lanes, Arrange { lists: self, row });
        for (x, &count) in counts.iter().enumerate() {
            for depth in 0..count as usize {
                let slot = (self.keys[depth * TILE + x] & (DEPTH as u32 - 1)) as usize;
                each(depth, x, self.slots[(row * TILE + x) * ROOM + slot].rgba[0].to_bits());
            }
        }
    }

    /// Gives the segment that went to `place` its colour and opacity.
    pub fn set(&mut self, place: u32, rgba: [f32; 4]) {
        self.slots[place as usize].rgba = rgba;
    }

    /// Composites every pixel, sorted or in the order of arrival, into `out` (rows of `TILE` pixels). Returns the
    /// pixels whose segments were not in order.
    #[inline(always)]
    pub fn composite<L: Lanes>(
        &mut self,
        sorted: bool,
        out: &mut [[f32; 4]; TILE * TILE],
        mut resolve: Resolve,
    ) -> u64 {
        let mut disordered = 0;
        for row in 0..TILE {
            let counts = self.counts(row);
            let deepest = counts.iter().copied().max().unwrap_or(0) as usize;
            if deepest == 0 {
                out[row * TILE..][..TILE].fill([0.0; 4]);
                self.through[row * TILE..][..TILE].fill(1.0);
                continue;
            }
            if sorted {
                self.sort::<L>(row, &counts, deepest);
            } else {
                self.make_keys::<L>(row, &counts, deepest);
                disordered += self.disordered(row, &counts);
            }
            if let Some(color) = &mut resolve {
                self.resolve(row, &counts, *color);
            }
            self.blend::<L>(row, deepest, &mut out[row * TILE..][..TILE]);
        }
        disordered
    }

    /// Puts the keys of a row in order.
    #[inline(always)]
    pub fn arrange<L: Lanes>(&mut self, row: usize) {
        let deepest = self.deepest(row);
        if deepest > 0 {
            self.sort::<L>(row, &self.counts(row), deepest);
        }
    }

    #[inline(always)]
    fn sort<L: Lanes>(&mut self, row: usize, counts: &[u32; TILE], deepest: usize) {
        self.make_keys::<L>(row, counts, deepest);
        sort_columns::<L, TILE>(&mut self.keys, deepest);
        self.mend::<L>(row, deepest);
    }

    /// Segments of some pixels of a row, and those of them that are hidden.
    pub fn hidden(&self, row: usize) -> [usize; 2] {
        let (mut all, mut hidden) = (0, 0);
        for (x, &count) in self.counts(row).iter().enumerate().skip(1).step_by(4) {
            let slots = &self.slots[(row * TILE + x) * ROOM..][..count as usize];
            let mut segments: Vec<[f32; 2]> = slots.iter().map(|slot| [slot.entry, slot.rgba[3]]).collect();
            segments.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            let mut through = 1.0;
            all += segments.len();
            for (k, [_, opacity]) in segments.iter().enumerate() {
                if through <= UNSEEN {
                    hidden += segments.len() - k;
                    break;
                }
                through *= 1.0 - opacity;
            }
        }
        [all, hidden]
    }

    /// Pixels of a row whose segments did not arrive in order.
    fn disordered(&self, row: usize, counts: &[u32; TILE]) -> u64 {
        let entry = |x: usize, slot: usize| self.slots[(row * TILE + x) * ROOM + slot].entry;
        let wrong =
            |(x, &count): (usize, &u32)| (1..count as usize).any(|slot| entry(x, slot) < entry(x, slot - 1));
        counts.iter().enumerate().filter(|&column| wrong(column)).count() as u64
    }

    /// Keys: the entry in 22 bits of the pixel's own depth range, then the slot; past the end of a list all ones.
    #[inline(always)]
    fn make_keys<L: Lanes>(&mut self, row: usize, counts: &[u32; TILE], deepest: usize) {
        let splat = L::F::splat;
        let steps = splat(((1u32 << (32 - SLOT_BITS)) - 2) as f32);
        let numbers: &[f32] = bytemuck::cast_slice(&self.slots);
        for half in (0..TILE).step_by(L::WIDTH) {
            let count = L::U::load(&counts[half..]);
            // slot ≥ count: max(slot, count) == slot.
            let past = inlined(
                #[inline(always)]
                |slot: usize| count.max(L::U::splat(slot as u32)).equal(L::U::splat(slot as u32)),
            );
            let first = L::U::load(&FIRST[row * TILE + half..]).shl::<NUMBERS_BITS>() + L::U::splat(ENTRY);
            let (mut nearest, mut farthest) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for (k, entries) in self.entries.chunks_exact_mut(TILE).take(deepest).enumerate() {
                // Past the end of a list something is read that does not count.
                let entry = L::F::gather(numbers, first + L::U::splat((k as u32) << NUMBERS_BITS));
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

    /// The keys are rounded: puts segments whose levels meet or touch into the order of [`Layer::follows`].
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
            let slot = &self.slots[(row * TILE + x) * ROOM + (key & (DEPTH as u32 - 1)) as usize];
            [slot.entry, slot.exit]
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

    /// Colours what waits for it and is seen; what is hidden becomes black.
    fn resolve(&mut self, row: usize, counts: &[u32; TILE], color: &mut dyn FnMut(&mut [Mark])) {
        self.marks.clear();
        for (x, &count) in counts.iter().enumerate() {
            let mut through = 1.0;
            for k in 0..count as usize {
                let key = self.keys[k * TILE + x];
                let slot = (row * TILE + x) * ROOM + (key & (DEPTH as u32 - 1)) as usize;
                let rgba = &mut self.slots[slot].rgba;
                if through <= UNSEEN_COLOR {
                    // What is left of white would show.
                    rgba[..3].fill(0.0);
                } else if let Some(mark) = Mark::new(*rgba, slot as u32) {
                    self.marks.push(mark);
                }
                through *= 1.0 - rgba[3];
            }
        }
        color(&mut self.marks);
        for mark in &self.marks {
            self.slots[mark.place as usize].rgba[..3].copy_from_slice(&mark.color);
        }
    }

    /// Front to back: C += (1 − A) C_seg, A += (1 − A) A_seg.
    #[inline(always)]
    fn blend<L: Lanes>(&mut self, row: usize, deepest: usize, out: &mut [[f32; 4]]) {
        let splat = L::F::splat;
        let fours: &[[f32; 4]] = bytemuck::cast_slice(&self.slots);
        let last = L::U::splat(deepest as u32 - 1);
        for half in (0..TILE).step_by(L::WIDTH) {
            let lane = L::U::iota() + L::U::splat(half as u32);
            let first = L::U::load(&FIRST[row * TILE + half..]);
            let mut color = [splat(0.0); 3];
            let mut opacity = splat(0.0);
            let mut through = splat(1.0);
            for slot in 0..deepest {
                let key = L::U::load(&self.keys[slot * TILE + half..]);
                let live = key.equal(L::U::splat(u32::MAX)).not();
                let place = key.and(L::U::splat(DEPTH as u32 - 1)).min(last);
                const { assert!(FOURS == 2) };
                let layer = L::F::gather_parts(fours, (first + place).shl::<1>());
                let layer: [L::F; 4] = array(
                    #[inline(always)]
                    |c| L::F::select(live, layer[c], splat(0.0)),
                );
                for (sum, layer) in color.iter_mut().zip(&layer) {
                    *sum = through.mul_add(*layer, *sum);
                }
                opacity = through.mul_add(layer[3], opacity);
                through = through * (splat(1.0) - layer[3]);
                if slot & 15 == 15 && !splat(UNSEEN).lt(through).any() {
                    break;
                }
            }
            through.store(&mut self.through[row * TILE + half..]);
            let pixel = [color[0], color[1], color[2], opacity.min(splat(1.0))];
            L::F::scatter_parts([pixel], out.as_chunks_mut().0, lane);
        }
    }
}
