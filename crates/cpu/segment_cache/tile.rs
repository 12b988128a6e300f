//! Cached segments of a tile.

use crate::tile::TILE;

/// Cached segments of a picture.
#[derive(Debug)]
pub(crate) struct SegmentCache {
    tiles: Vec<Option<CachedTile>>,
    /// Numbers of the tiles that have segments, fullest first.
    pub queue: Vec<u32>,
    /// Optical depth that they were projected for: see [`crate::project::cells::Input::max_optical_depth`].
    pub max_optical_depth: f64,
}

/// Cached segments of a tile, slice by slice: the lengths of 16 pixels, each attribute at their entries, each at their exits.
#[derive(Debug)]
pub(crate) struct CachedTile {
    /// The first slice of each row; then the end of the last.
    pub(super) begins: [u32; TILE + 1],
    pub(super) numbers: Vec<f32>,
}

impl SegmentCache {
    /// Cache of tiles with their numbers. `count`: tiles of the picture.
    pub fn new(tiles: Vec<(u32, CachedTile)>, count: usize, max_optical_depth: f64) -> SegmentCache {
        let mut queue: Vec<(usize, u32)> =
            tiles.iter().map(|(tile, cached)| (cached.numbers.len(), *tile)).collect();
        queue.sort_unstable_by(|a, b| b.cmp(a));
        let mut by_number: Vec<Option<CachedTile>> = (0..count).map(|_| None).collect();
        for (tile, cached) in tiles {
            by_number[tile as usize] = Some(cached);
        }
        SegmentCache {
            tiles: by_number,
            queue: queue.into_iter().map(|(_, tile)| tile).collect(),
            max_optical_depth,
        }
    }

    /// A tile, if it has segments.
    pub fn tile(&self, tile: usize) -> Option<&CachedTile> {
        self.tiles.get(tile)?.as_ref()
    }
}
