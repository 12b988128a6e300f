//! Tile bins: projected cells by tiles.

use crate::project::cells::{AttributePlane, Input, ProjectCells, ProjectedCell, ProjectedCells};
use crate::project::precise_cell::PreciseCell;
use crate::tile::{Area, TILE, tiles_of};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};
use voltet_core::error::Remedy;
use voltet_core::{Error, Result};
use voltet_simd::{LaneSet, prefetch};

/// Bits of a cell's number within its part; the part's number stands above.
const INDEX_BITS: u32 = 24;

/// Parts at most: limited by the other bits of an entry.
const MAX_PARTS: usize = 1 << (u32::BITS - INDEX_BITS);

/// Projected cells of an area of the picture.
#[derive(Debug, Default)]
pub(crate) struct TileBins {
    area: Area,
    attribute_count: usize,
    parts: Vec<ProjectedCells>,
    /// `starts[t] .. starts[t + 1]` are the entries of the area's tile t.
    starts: Vec<u32>,
    /// Records by tile, in grid order.
    entries: Vec<u32>,
    precise_cells: Vec<PreciseCell>,
    /// Numbers of precise cells by tile.
    precise_tiles: Vec<Vec<u32>>,
}

/// A projected cell among the bins.
pub(crate) struct BinnedCell<'a> {
    part: &'a ProjectedCells,
    index: usize,
    attribute_count: usize,
}

impl TileBins {
    /// Projects cells, in their order, on all threads, in the memory that is there already.
    ///
    /// Errors: more cells, or more of them in tiles, than 32 bits count.
    pub fn fill_on_all(
        &mut self,
        input: &Input<'_>,
        lanes: LaneSet,
        points: &[DVec3],
        cells: &[u32],
    ) -> Result<()> {
        let part_count = (rayon::current_num_threads() * 4).max(cells.len().div_ceil(1 << INDEX_BITS));
        let length = cells.len().div_ceil(part_count.min(MAX_PARTS)).max(1);
        self.begin(input, cells.len().div_ceil(length))?;
        self.parts.par_iter_mut().zip(cells.par_chunks(length)).for_each(|(part, cells)| {
            part.begin(input.area);
            voltet_simd::dispatch(lanes, ProjectCells { input: *input, cells, part });
        });
        self.bin(input, points)
    }

    /// Like [`TileBins::fill_on_all`], on this thread. `pieces`: the cells, in their order.
    ///
    /// Errors: those of [`TileBins::fill_on_all`].
    pub fn fill(
        &mut self,
        input: &Input<'_>,
        lanes: LaneSet,
        points: &[DVec3],
        pieces: &[Vec<u32>],
    ) -> Result<()> {
        // Each part begins with the first piece that the one before it has no numbers for.
        let mut parts: Vec<_> = std::iter::once(0..0).collect();
        let mut count = 0;
        for (number, piece) in pieces.iter().enumerate() {
            count += piece.len();
            if count > 1 << INDEX_BITS {
                parts.push(number..number);
                count = piece.len();
            }
            if let Some(part) = parts.last_mut() {
                part.end = number + 1;
            }
        }
        self.begin(input, parts.len())?;
        for (part, which) in self.parts.iter_mut().zip(parts) {
            part.begin(input.area);
            for cells in &pieces[which] {
                voltet_simd::dispatch(lanes, ProjectCells { input: *input, cells, part });
            }
        }
        self.bin(input, points)
    }

    fn begin(&mut self, input: &Input<'_>, part_count: usize) -> Result<()> {
        if part_count > MAX_PARTS {
            return Err(
                Error::run("too many cells for one picture").expected("at most 4 thousand million cells")
            );
        }
        self.area = input.area;
        self.attribute_count = input.attributes.len();
        self.parts.resize_with(part_count, ProjectedCells::default);
        Ok(())
    }

    /// Bins the cells of all parts by tiles: grid order within a tile.
    fn bin(&mut self, input: &Input<'_>, points: &[DVec3]) -> Result<()> {
        let TileBins { area, parts, starts, entries, precise_cells, precise_tiles, .. } = self;
        starts.clear();
        let mut sum = 0u64;
        for tile in 0..area.tile_count() {
            starts.push(sum as u32);
            for part in parts.iter_mut() {
                // From here on an index, that of the part's next cell.
                sum += u64::from(std::mem::replace(&mut part.tile_counts[tile], sum as u32));
            }
        }
        if sum > u64::from(u32::MAX) {
            return Err(Error::run("the picture has too many cells in its tiles")
                .got(sum)
                .expected("at most 4 thousand million; draw a part of the grid or a smaller picture")
                .with_remedy(Remedy::FewerPixels));
        }
        starts.push(sum as u32);
        entries.clear();
        entries.resize(sum as usize, 0);
        let out = shared(entries);
        let bin = |number: usize, part: &mut ProjectedCells| {
            let ProjectedCells { tiles, tile_counts: next, .. } = part;
            for (index, rectangle) in tiles.iter().enumerate() {
                let entry = (number << INDEX_BITS | index) as u32;
                let [x0, y0, x1, y1] = rectangle.map(usize::from);
                for y in y0..y1 {
                    let first = area.index([x0, y]);
                    for slot in &mut next[first..first + (x1 - x0)] {
                        out[*slot as usize].store(entry, Ordering::Relaxed);
                        *slot += 1;
                    }
                }
            }
        };
        // One part is one thread's.
        match &mut parts[..] {
            [part] => bin(0, part),
            parts => parts.par_iter_mut().enumerate().for_each(|(number, part)| bin(number, part)),
        }

        precise_cells.clear();
        precise_cells.extend(parts.iter().flat_map(|part| &part.precise_cells).filter_map(|&id| {
            let corners = input.tetrahedra[id as usize].map(|p| points[p as usize]);
            PreciseCell::new(input.view, id, corners)
        }));
        precise_tiles.iter_mut().for_each(Vec::clear);
        precise_tiles.resize_with(if precise_cells.is_empty() { 0 } else { area.tile_count() }, Vec::new);
        for (k, cell) in precise_cells.iter().enumerate() {
            let Some([x0, y0, x1, y1]) = area.intersection(tiles_of(cell.bounds)) else { continue };
            for y in y0..y1 {
                let first = area.index([x0, y]);
                precise_tiles[first..first + (x1 - x0)].iter_mut().for_each(|tile| tile.push(k as u32));
            }
        }
        Ok(())
    }

    /// Projected and precise cells.
    pub fn cell_count(&self) -> u64 {
        (self.parts.iter().map(|part| part.planes.len()).sum::<usize>() + self.precise_cells.len()) as u64
    }

    /// Tiles that hold anything, fullest first, numbered row by row in a picture of a width in pixels.
    pub fn queue(&self, width: usize) -> Vec<u32> {
        let fill = |index: usize| {
            let precise_cells = self.precise_tiles.get(index).map_or(0, Vec::len);
            (self.starts[index + 1] - self.starts[index]) as usize + 16 * precise_cells
        };
        let mut queue: Vec<usize> = (0..self.area.tile_count()).filter(|&index| fill(index) > 0).collect();
        queue.sort_by_key(|&index| std::cmp::Reverse(fill(index)));
        let number = |index: usize| {
            let [x, y] = self.area.tile(index);
            (y * width.div_ceil(TILE) + x) as u32
        };
        queue.into_iter().map(number).collect()
    }

    #[inline(always)]
    pub fn entries_of(&self, tile: [usize; 2]) -> &[u32] {
        let index = self.area.index(tile);
        &self.entries[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    pub fn precise_cells_of(&self, tile: [usize; 2]) -> impl Iterator<Item = &PreciseCell> {
        let numbers = self.precise_tiles.get(self.area.index(tile)).map_or(&[][..], Vec::as_slice);
        numbers.iter().map(|&k| &self.precise_cells[k as usize])
    }

    #[inline(always)]
    pub fn cell(&self, entry: u32) -> BinnedCell<'_> {
        let index = (entry & ((1 << INDEX_BITS) - 1)) as usize;
        BinnedCell {
            part: &self.parts[(entry >> INDEX_BITS) as usize],
            index,
            attribute_count: self.attribute_count,
        }
    }
}

impl<'a> BinnedCell<'a> {
    #[inline(always)]
    pub fn planes(&self) -> &'a ProjectedCell {
        &self.part.planes[self.index]
    }

    #[inline(always)]
    pub fn attributes(&self) -> &'a [AttributePlane] {
        &self.part.attributes[self.index * self.attribute_count..][..self.attribute_count]
    }

    #[inline(always)]
    pub fn corners(&self) -> [u32; 4] {
        self.part.corners[self.index]
    }

    /// Prefetches its cache lines.
    #[inline(always)]
    pub fn prefetch(&self) {
        let BinnedCell { part, index, attribute_count } = *self;
        prefetch(part.planes.as_ptr().wrapping_add(index));
        prefetch(part.corners.as_ptr().wrapping_add(index));
        prefetch(part.attributes.as_ptr().wrapping_add(index * attribute_count));
    }
}

/// Numbers that several threads write, each at other indices.
fn shared(values: &mut [u32]) -> &[AtomicU32] {
    // SAFETY: an atomic has the size, the alignment and the bits of its number, and no other reference to the slice exists meanwhile.
    unsafe { &*(std::ptr::from_mut(values) as *const [AtomicU32]) }
}
