//! Screen regions, which bound the memory of large grids: a thread projects the cells of one region, composites its tiles, and takes the
//! next region in the same memory. Before that the cells are only binned by the regions that they touch: 4 bytes each.
//!
//! A cell that touches several regions is projected in each of them. Regions hold about a requested number of cells; where the cells of
//! one are more, it is split again, down to a tile.

use crate::project::cells::{Corners, Input, MAX_DOUBLE_LANES, max_of, min_of};
use crate::project::precise_cell::PreciseCell;
use crate::tile::{Area, TILE, tiles_of};
use crate::tolerances::SPAN_SLACK;
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use voltet_simd::{Double, Kernel, LaneSet, Lanes, Mask, dispatch};

/// Cells that are binned at a time.
const PIECE: usize = 1 << 16;

/// Regions for each thread at least, so that the last ones do not keep the other threads idle.
const REGIONS_PER_THREAD: usize = 4;

/// A region of the picture, and the cells that touch it.
#[derive(Debug)]
pub(crate) struct Region {
    pub area: Area,
    /// Numbers of the cells, in their order.
    pub pieces: Vec<Vec<u32>>,
}

/// Cells that cover a pixel centre, and the regions that they touch.
#[derive(Debug)]
pub(crate) struct Regions {
    pub list: Vec<Region>,
    pub cell_count: u64,
}

impl Region {
    fn cell_count(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }
}

impl Regions {
    /// Bins cells, in their order, by regions of about `size` cells, the fullest first.
    pub fn new(input: &Input<'_>, lanes: LaneSet, points: &[DVec3], cells: &[u32], size: usize) -> Regions {
        let binner = RegionBinner { input, lanes, points };
        let least_count = REGIONS_PER_THREAD * rayon::current_num_threads();
        let tile_count = binner.tiles_in_view();
        let tiles_per_region = (size * tile_count / cells.len().max(1)).min(tile_count / least_count);
        let pieces: Vec<&[u32]> = cells.chunks(PIECE).collect();
        let (mut list, cell_count) = binner.bin(input.area, tiles_per_region.isqrt().max(1), &pieces);
        let mut fit = Vec::with_capacity(list.len());
        while let Some(region) = list.pop() {
            let (count, tile_count) = (region.cell_count(), region.area.tile_count());
            if count <= 2 * size || tile_count == 1 {
                fit.push(region);
                continue;
            }
            let [columns, rows] = region.area.size();
            let side = (size * tile_count / count).isqrt().clamp(1, columns.max(rows).div_ceil(2));
            let pieces: Vec<&[u32]> = region.pieces.iter().map(Vec::as_slice).collect();
            list.extend(binner.bin(region.area, side, &pieces).0);
        }
        fit.sort_by_key(|region| (Reverse(region.cell_count()), region.area.from));
        Regions { list: fit, cell_count }
    }

    /// Drops the regions that none of some tiles, numbered row by row of `columns`, lies in.
    pub fn retain(&mut self, tiles: &[u32], columns: usize) {
        let at = |tile: u32| [tile as usize % columns, tile as usize / columns];
        self.list.retain(|region| tiles.iter().any(|&tile| region.area.holds(at(tile))));
    }
}

struct RegionBinner<'a> {
    input: &'a Input<'a>,
    lanes: LaneSet,
    points: &'a [DVec3],
}

impl RegionBinner<'_> {
    /// Tiles of the bounding box of the projected points.
    fn tiles_in_view(&self) -> usize {
        let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        let join =
            |a: [f64; 4], b: [f64; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
        let vertices = self.input.screen_vertices.par_iter().with_min_len(1 << 14);
        let [x0, y0, x1, y1] = vertices.map(|s| [s.x, s.y, s.x, s.y]).reduce(|| none, join);
        let [columns, rows] = self.input.area.size();
        // A cast from float saturates.
        let tiles = |low: f64, high: f64, max: usize| {
            let [low, high] = [low, high].map(|x| ((x / TILE as f64).max(0.0) as usize).min(max));
            (high - low.min(high)).max(1)
        };
        tiles(x0, x1, columns) * tiles(y0, y1, rows)
    }

    /// The regions of an area that cells touch, row by row, and the number of cells that cover a pixel centre.
    fn bin(&self, area: Area, side: usize, pieces: &[&[u32]]) -> (Vec<Region>, u64) {
        let areas = area.split(side);
        let columns = area.size()[0].div_ceil(side);
        let RegionBinner { input, points, .. } = *self;
        let lists: Vec<(Vec<Vec<u32>>, u64)> = pieces
            .par_iter()
            .map(|cells| {
                let mut lists = vec![Vec::new(); areas.len()];
                let kernel = BinKernel { input, points, cells, area, side, columns, lists: &mut lists };
                let cell_count = dispatch(self.lanes, kernel);
                (lists, cell_count)
            })
            .collect();
        let cell_count = lists.iter().map(|(_, count)| count).sum();
        let mut regions: Vec<Region> =
            areas.into_iter().map(|area| Region { area, pieces: Vec::new() }).collect();
        for (lists, _) in lists {
            for (region, list) in regions.iter_mut().zip(lists).filter(|(_, list)| !list.is_empty()) {
                region.pieces.push(list);
            }
        }
        regions.retain(|region| !region.pieces.is_empty());
        (regions, cell_count)
    }
}

struct BinKernel<'a> {
    input: &'a Input<'a>,
    points: &'a [DVec3],
    cells: &'a [u32],
    area: Area,
    side: usize,
    columns: usize,
    /// Numbers of the cells, region by region.
    lists: &'a mut [Vec<u32>],
}

impl Kernel<u64> for BinKernel<'_> {
    /// Returns the number of cells that cover a pixel centre.
    #[inline(always)]
    fn run<L: Lanes>(self) -> u64 {
        let BinKernel { input, points, cells, area, side, columns, lists } = self;
        let (view, mut cell_count) = (input.view, 0);
        let splat = L::D::splat;
        for group in cells.chunks(L::D::COUNT) {
            let corners = Corners::<L::D>::gather(input.screen_vertices, input.tetrahedra, group);
            let covered = corners.covered(view);
            // Precise cells are crossed without the rounding of pixel coordinates: 2⁻²⁴, and far outside what 64 bits leave of them.
            let mut boxes = [[0.0; MAX_DOUBLE_LANES]; 4];
            for (axis, c) in [&corners.x, &corners.y].into_iter().enumerate() {
                let (low, high) = (min_of(c), max_of(c));
                let slack = splat(SPAN_SLACK) + splat(f64::EPSILON * 16.0) * low.abs().max(high.abs());
                let max = splat(view.size[axis] as f64);
                (low - slack).ceil().max(splat(0.0)).min(max).store(&mut boxes[axis]);
                (high + slack).ceil().max(splat(0.0)).min(max).store(&mut boxes[axis + 2]);
            }
            let live = (1u32 << group.len()) - 1;
            let in_depth = covered.in_depth.bits();
            let ordinary = in_depth & covered.any.bits();
            for (lane, &id) in group.iter().enumerate() {
                let pixels = if ordinary >> lane & 1 != 0 {
                    [0, 1, 2, 3].map(|k: usize| boxes[k][lane] as usize)
                } else if live & !in_depth & (1 << lane) != 0 {
                    let corners = input.tetrahedra[id as usize].map(|p| points[p as usize]);
                    let Some(cell) = PreciseCell::new(view, id, corners) else { continue };
                    cell.bounds
                } else {
                    continue;
                };
                cell_count += 1;
                let Some([x0, y0, x1, y1]) = area.intersection(tiles_of(pixels)) else { continue };
                let [x0, y0] = [(x0 - area.from[0]) / side, (y0 - area.from[1]) / side];
                let [x1, y1] = [(x1 - area.from[0]).div_ceil(side), (y1 - area.from[1]).div_ceil(side)];
                for y in y0..y1 {
                    lists[y * columns + x0..y * columns + x1].iter_mut().for_each(|list| list.push(id));
                }
            }
        }
        cell_count
    }
}
