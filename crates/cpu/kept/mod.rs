//! Segments kept between pictures: while widgets change and nothing else does, a picture is shaded and blended anew, and nothing is
//! culled, projected, crossed or put in order.
//!
//! Kept of each segment are its length and its values at both ends, whatever widgets make of them: of every cell in view, front to
//! back, the pixels of a row side by side. Kept pictures differ from others by what culling leaves out, 1e-6 at most, and by the
//! rounding of values that are counted from the middle of their range.
//!
//! | file | what |
//! | --- | --- |
//! | `views` | which views are worth keeping, and what serves which transfer function |
//! | `keep` | a tile's segments from its lists |
//! | `walk` | kept segments, slices of a row at a time |

mod keep;
mod views;
mod walk;

pub(crate) use keep::{Keeper, Keeping};
pub(crate) use views::{Plan, Views};
pub(crate) use walk::KeptSlices;

use crate::project::record::TILE;

/// The segments of a picture.
#[derive(Debug)]
pub(crate) struct Kept {
    tiles: Vec<Option<KeptTile>>,
    /// Numbers of those that have segments, fullest first.
    pub queue: Vec<u32>,
    /// What they were projected for: see [`crate::project::part::Input::densest`].
    pub densest: f64,
}

/// The segments of a tile. Slice by slice: the lengths of 16 pixels, each attribute at their entries, each at their exits.
#[derive(Debug)]
pub(crate) struct KeptTile {
    /// The first slice of each row; then the end of the last.
    begins: [u32; TILE + 1],
    numbers: Vec<f32>,
}

impl Kept {
    /// From tiles with their numbers, of a picture of so many.
    pub fn new(tiles: Vec<(u32, KeptTile)>, count: usize, densest: f64) -> Kept {
        let mut queue: Vec<(usize, u32)> =
            tiles.iter().map(|(tile, kept)| (kept.numbers.len(), *tile)).collect();
        queue.sort_unstable_by(|a, b| b.cmp(a));
        let mut by_number: Vec<Option<KeptTile>> = (0..count).map(|_| None).collect();
        for (tile, kept) in tiles {
            by_number[tile as usize] = Some(kept);
        }
        Kept { tiles: by_number, queue: queue.into_iter().map(|(_, tile)| tile).collect(), densest }
    }

    /// A tile, if it has segments.
    pub fn tile(&self, tile: usize) -> Option<&KeptTile> {
        self.tiles.get(tile)?.as_ref()
    }
}
