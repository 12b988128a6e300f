//! Slots of a tile's fragment lists: one run of slots a pixel, and the next free one of each.

use crate::tile::{PIXELS, TILE};

/// Segments that a pixel's list holds; a tile that needs more is drawn again with lists that grow.
pub(crate) const MAX_LIST_LENGTH: usize = 1024;

/// Bits of a slot's number within its list.
pub(crate) const SLOT_BITS: u32 = 10;

/// Slots of a pixel: each cell of a vector may take one before the lengths are checked. An odd number of cache lines, so that the lists
/// of pixels do not meet in the same sets of a cache.
pub(crate) const SLOTS_PER_PIXEL: usize = MAX_LIST_LENGTH + 20;
const _: () = assert!(SLOTS_PER_PIXEL * size_of::<[f32; 4]>() / 64 % 2 == 1);

/// Slot of fragments that belong to no pixel.
pub(crate) const DUMMY_SLOT: u32 = (PIXELS * SLOTS_PER_PIXEL) as u32;

/// Next free slot of each pixel, row by row; then room to read a whole vector from any of them.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct NextSlots(pub [u32; PIXELS + TILE]);

/// First slot of each pixel.
pub(crate) const FIRST_SLOTS: NextSlots = {
    let mut first = [0; PIXELS + TILE];
    let mut pixel = 0;
    while pixel < first.len() {
        first[pixel] = (pixel * SLOTS_PER_PIXEL) as u32;
        pixel += 1;
    }
    NextSlots(first)
};

impl Default for NextSlots {
    fn default() -> Self {
        FIRST_SLOTS
    }
}
