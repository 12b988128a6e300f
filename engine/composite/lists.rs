//! Per-pixel lists of a tile: segments are appended as the cells come, then each pixel's are sorted by entry
//! distance and composited front to back. The order is exact for disjoint cells whatever the cells are: cycles,
//! non-convex and disconnected grids need no special case.
//!
//! Layout: slot k of the 16 pixels of a row lie side by side, so 16 pixels are 16 lanes of the sorting network
//! and of the compositor.

use crate::project::record::TILE;
use voltet_lanes::sort::sort_columns;
use voltet_lanes::{Float, Lanes, Mask, Unsigned, array, inlined};

/// Segments a pixel can hold here; a tile that needs more is drawn again by [`super::growing_lists`].
pub(crate) const DEPTH: usize = 1024;
/// Bits of a slot number.
const SLOT_BITS: u32 = 10;
/// Distance between rows. Not a power of two: those cost a third of the speed to cache conflicts.
const ROW: usize = DEPTH * TILE + 3 * TILE;

/// What one segment contributes to its pixel: 32 bytes, so that it lies in one cache line.
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Layer {
    /// Premultiplied colour and opacity.
    pub rgba: [f32; 4],
    /// Depth of the entry.
    pub entry: f32,
    /// Depth of the exit.
    pub exit: f32,
    /// Fills the line.
    pub unused: [f32; 2],
}

impl Layer {
    pub fn new(entry: f32, exit: f32, rgba: [f32; 4]) -> Layer {
        Layer { rgba, entry, exit, unused: [0.0; 2] }
    }
}

/// Entries that differ by less than this share of themselves may be one face, found from both of its cells.
const ENTRY_NOISE: f32 = 3e-7;

impl Layer {
    /// Whether this segment comes behind the other: by entry, then by exit. Entries within rounding count as equal:
    /// disjoint cells are in the same order by their exits, and of cells that overlap behind a shared face the one that
    /// ends first comes first.
    pub fn follows(&self, other: &Layer) -> bool {
        let noise = ENTRY_NOISE * self.entry.abs().max(other.entry.abs());
        if (self.entry - other.entry).abs() <= noise {
            self.exit > other.exit
        } else {
            self.entry > other.entry
        }
    }
}

/// Share of the picture under which what lies behind is left out: an optical depth of 25.
pub(crate) const UNSEEN: f32 = 1e-11;

/// Words of 32 bits in a layer, as a power of two.
const LAYER_WORDS_LOG2: u32 = 3;

/// The lists of one tile.
pub(crate) struct Lists {
    count: [u16; TILE * TILE],
    layers: Box<[Layer; ROW * TILE]>,
    keys: Vec<u32>,
    /// Entries of the row in hand, side by side.
    entries: Vec<f32>,
    /// What is seen through each pixel, as far as it is more than [`UNSEEN`].
    pub through: [f32; TILE * TILE],
    /// Slots of the row in hand whose level is that of the slot before, with the lanes concerned.
    met: Vec<(u32, u32)>,
}

/// A pixel has more segments than [`DEPTH`].
pub(crate) struct Overflow;

impl Lists {
    pub fn new() -> Self {
        // Zeroed pages are mapped when first touched: a tile touches what its deepest pixel needs.
        let layers = bytemuck::zeroed_vec(ROW * TILE).into_boxed_slice().try_into();
        Lists {
            count: [0; TILE * TILE],
            layers: layers.expect("as many as it was made with"),
            keys: vec![0; DEPTH * TILE],
            entries: vec![0.0; DEPTH * TILE],
            through: [1.0; TILE * TILE],
            met: Vec::new(),
        }
    }

    pub fn clear(&mut self) {
        self.count = [0; TILE * TILE];
    }

    /// Appends to the list of a pixel (row << 4 | column).
    #[inline(always)]
    pub fn push(&mut self, pixel: usize, layer: Layer) -> Result<(), Overflow> {
        let pixel = pixel & (TILE * TILE - 1);
        let slot = usize::from(self.count[pixel]);
        if slot >= DEPTH {
            return Err(Overflow);
        }
        self.count[pixel] += 1;
        let at = (pixel >> 4) * ROW + slot * TILE + (pixel & 15);
        self.layers[at] = layer;
        Ok(())
    }

    /// Composites every pixel, sorted or in the order of arrival, into `out` (rows of `TILE` pixels). Returns the
    /// pixels whose segments were not in order.
    #[inline(always)]
    pub fn composite<L: Lanes>(&mut self, sorted: bool, out: &mut [[f32; 4]; TILE * TILE]) -> u64 {
        let mut disordered = 0;
        for row in 0..TILE {
            let counts: [u16; TILE] = self.count[row * TILE..][..TILE].try_into().expect("a row of counts");
            let deepest = usize::from(counts.iter().copied().max().unwrap_or(0));
            if deepest == 0 {
                out[row * TILE..][..TILE].fill([0.0; 4]);
                self.through[row * TILE..][..TILE].fill(1.0);
                continue;
            }
            self.make_keys::<L>(row, &counts, deepest);
            if sorted {
                sort_columns::<L, TILE>(&mut self.keys, deepest);
                self.mend::<L>(row, deepest);
            } else {
                disordered += self.disordered(row, &counts);
            }
            self.blend::<L>(row, deepest, &mut out[row * TILE..][..TILE]);
        }
        disordered
    }

    /// Pixels of a row whose segments did not arrive in order.
    fn disordered(&self, row: usize, counts: &[u16; TILE]) -> u64 {
        let entry = |x: usize, slot: usize| self.layers[row * ROW + slot * TILE + x].entry;
        let wrong = |(x, &count): (usize, &u16)| {
            (1..usize::from(count)).any(|slot| entry(x, slot) < entry(x, slot - 1))
        };
        counts.iter().enumerate().filter(|&column| wrong(column)).count() as u64
    }

    /// Keys: the entry in 22 bits of the pixel's own depth range, then the slot; past the end of a list all ones.
    #[inline(always)]
    fn make_keys<L: Lanes>(&mut self, row: usize, counts: &[u16; TILE], deepest: usize) {
        let splat = L::F::splat;
        let steps = splat(((1u32 << (32 - SLOT_BITS)) - 2) as f32);
        let counts = counts.map(u32::from);
        let words: &[f32] = bytemuck::cast_slice(self.layers.as_slice());
        for half in (0..TILE).step_by(L::WIDTH) {
            let count = L::U::load(&counts[half..]);
            // slot ≥ count: max(slot, count) == slot.
            let past = inlined(
                #[inline(always)]
                |slot: usize| count.max(L::U::splat(slot as u32)).equal(L::U::splat(slot as u32)),
            );
            let lane = (L::U::iota() + L::U::splat((row * ROW + half) as u32)).shl::<LAYER_WORDS_LOG2>();
            let entry_word = L::U::splat(std::mem::offset_of!(Layer, entry) as u32 / 4);
            let (mut nearest, mut farthest) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
            for slot in 0..deepest {
                let at = lane + entry_word + L::U::splat((slot * TILE) as u32).shl::<LAYER_WORDS_LOG2>();
                let entry = L::F::gather(words, at);
                entry.store(&mut self.entries[slot * TILE + half..]);
                let past = past(slot);
                nearest = L::F::select(past, nearest, entry.min(nearest));
                farthest = L::F::select(past, farthest, entry.max(farthest));
            }
            let range = farthest - nearest;
            // No finer than the noise: entries that may be one face are then at most one level apart.
            let noise = nearest.abs().max(farthest.abs()) * splat(ENTRY_NOISE);
            let finest = (splat(1.0) / noise).min(splat(f32::MAX));
            let scale = L::F::select(splat(0.0).lt(range), (steps / range).min(finest), splat(0.0));
            for slot in 0..deepest {
                let entry = L::F::load(&self.entries[slot * TILE + half..]);
                let level = ((entry - nearest) * scale).max(splat(0.0)).min(steps);
                let key = level.to_unsigned().shl::<SLOT_BITS>().or(L::U::splat(slot as u32));
                L::U::select(past(slot), L::U::splat(u32::MAX), key)
                    .store(&mut self.keys[slot * TILE + half..]);
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
        let at = |key: u32| row * ROW + (key & (DEPTH as u32 - 1)) as usize * TILE + x;
        let key = self.keys[k * TILE + x];
        let mut to = k;
        while to > 0 {
            let before = self.keys[(to - 1) * TILE + x];
            let apart = (key >> SLOT_BITS).abs_diff(before >> SLOT_BITS) > 1;
            if apart || !self.layers[at(before)].follows(&self.layers[at(key)]) {
                break;
            }
            self.keys[to * TILE + x] = before;
            to -= 1;
        }
        self.keys[to * TILE + x] = key;
    }

    /// Front to back: C += (1 − A) C_seg, A += (1 − A) A_seg.
    #[inline(always)]
    fn blend<L: Lanes>(&mut self, row: usize, deepest: usize, out: &mut [[f32; 4]]) {
        let splat = L::F::splat;
        let words: &[f32] = bytemuck::cast_slice(self.layers.as_slice());
        for half in (0..TILE).step_by(L::WIDTH) {
            let lane = L::U::iota() + L::U::splat((row * ROW + half) as u32);
            let mut color = [splat(0.0); 3];
            let mut opacity = splat(0.0);
            let mut through = splat(1.0);
            for slot in 0..deepest {
                let key = L::U::load(&self.keys[slot * TILE + half..]);
                let live = key.equal(L::U::splat(u32::MAX)).not();
                let at = (key.and(L::U::splat(DEPTH as u32 - 1)).shl::<4>() + lane).shl::<LAYER_WORDS_LOG2>();
                let layer: [L::F; 4] = array(
                    #[inline(always)]
                    |c| {
                        let word = L::F::gather(words, at + L::U::splat(c as u32));
                        L::F::select(live, word, splat(0.0))
                    },
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
            let mut columns = [[0f32; 16]; 4];
            for (column, value) in
                columns.iter_mut().zip([color[0], color[1], color[2], opacity.min(splat(1.0))])
            {
                value.store(column);
            }
            through.store(&mut self.through[row * TILE + half..]);
            for x in 0..L::WIDTH {
                out[half + x] = columns.map(|column| column[x]);
            }
        }
    }
}
