//! Tiles of the picture: their pixels, positions and rectangles.

/// Side of a tile (pixels): records are stored per tile, workers composite one at a time.
pub(crate) const TILE: usize = 16;

/// Pixels of a tile, row by row.
pub(crate) const PIXELS: usize = TILE * TILE;

/// Premultiplied colour and opacity of a tile's pixels.
pub(crate) type TilePicture = [[f32; 4]; PIXELS];

#[derive(Debug, Clone, Copy)]
pub(crate) struct TileRect {
    /// Number of the tile, row by row.
    pub tile: usize,
    /// Column and row of its first pixel.
    pub left: usize,
    pub top: usize,
    /// Columns and rows that are in the picture.
    pub size: [usize; 2],
}

impl TileRect {
    /// `size`: of the picture, pixels.
    pub fn new(tile: usize, [width, height]: [usize; 2]) -> TileRect {
        let tiles_wide = width.div_ceil(TILE);
        let (left, top) = (tile % tiles_wide * TILE, tile / tiles_wide * TILE);
        TileRect { tile, left, top, size: [TILE.min(width - left), TILE.min(height - top)] }
    }

    /// Column and row among the picture's tiles.
    pub fn position(&self) -> [usize; 2] {
        [self.left / TILE, self.top / TILE]
    }
}

/// Tiles of some columns and rows of a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Area {
    /// First column and row.
    pub from: [usize; 2],
    /// Column and row behind the last.
    pub to: [usize; 2],
}

impl Area {
    /// All tiles of a picture. `size`: in pixels.
    pub fn of_picture(size: [usize; 2]) -> Area {
        Area { from: [0; 2], to: size.map(|pixels| pixels.div_ceil(TILE)) }
    }

    /// The smallest area that holds some tiles, numbered row by row, of a picture of this size in pixels.
    pub fn around(size: [usize; 2], tiles: &[u32]) -> Area {
        let columns = size[0].div_ceil(TILE).max(1);
        let none = Area { from: [usize::MAX; 2], to: [0; 2] };
        tiles.iter().fold(none, |area, &tile| {
            let at = [tile as usize % columns, tile as usize / columns];
            Area {
                from: [0, 1].map(|k: usize| area.from[k].min(at[k])),
                to: [0, 1].map(|k: usize| area.to[k].max(at[k] + 1)),
            }
        })
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.to[0] - self.from[0], self.to[1] - self.from[1]]
    }

    pub fn tile_count(&self) -> usize {
        let [columns, rows] = self.size();
        columns * rows
    }

    pub fn holds(&self, tile: [usize; 2]) -> bool {
        (0..2).all(|k| self.from[k] <= tile[k] && tile[k] < self.to[k])
    }

    /// Index of a tile among the area's tiles, row by row.
    #[inline(always)]
    pub fn index(&self, [x, y]: [usize; 2]) -> usize {
        (y - self.from[1]) * (self.to[0] - self.from[0]) + (x - self.from[0])
    }

    pub fn tile(&self, index: usize) -> [usize; 2] {
        let columns = self.to[0] - self.from[0];
        [self.from[0] + index % columns, self.from[1] + index / columns]
    }

    /// Intersection with the tiles of columns x0 … x1 and rows y0 … y1 (exclusive), in this form; `None` where it is empty.
    #[inline(always)]
    pub fn intersection(&self, [x0, y0, x1, y1]: [usize; 4]) -> Option<[usize; 4]> {
        let [x0, y0] = [x0.max(self.from[0]), y0.max(self.from[1])];
        let [x1, y1] = [x1.min(self.to[0]), y1.min(self.to[1])];
        (x0 < x1 && y0 < y1).then_some([x0, y0, x1, y1])
    }

    /// Areas of `side` × `side` tiles that make it up, row by row; smaller ones at its ends.
    pub fn split(&self, side: usize) -> Vec<Area> {
        let part = |y: usize| {
            (self.from[0]..self.to[0]).step_by(side).map(move |x| Area {
                from: [x, y],
                to: [(x + side).min(self.to[0]), (y + side).min(self.to[1])],
            })
        };
        (self.from[1]..self.to[1]).step_by(side).flat_map(part).collect()
    }
}

/// Tiles that pixels of columns x0 … x1 and rows y0 … y1 (exclusive) lie in, in the same form.
#[inline(always)]
pub(crate) fn tiles_of([x0, y0, x1, y1]: [usize; 4]) -> [usize; 4] {
    [x0 / TILE, y0 / TILE, x1.div_ceil(TILE), y1.div_ceil(TILE)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_an_area_hold_each_tile_once() {
        let area = Area { from: [3, 1], to: [14, 8] };
        let parts = area.split(4);
        for index in 0..area.tile_count() {
            let [x, y] = area.tile(index);
            assert_eq!(area.index([x, y]), index);
            let holds = |part: &&Area| part.intersection([x, y, x + 1, y + 1]).is_some();
            assert_eq!(parts.iter().filter(holds).count(), 1, "tile {x}, {y}");
        }
        assert_eq!(parts.iter().map(Area::tile_count).sum::<usize>(), area.tile_count());
        assert_eq!(area.intersection([0, 0, 3, 8]), None);
    }
}
