//! Large grids window by window: a thread projects the cells of one part of the picture, composites its tiles, and takes the next
//! window in the same memory. Before that the cells are only told apart by the windows that they touch: 4 bytes each.
//!
//! A cell that touches several windows is projected in each of them. Windows hold about as many cells as wished; where the
//! cells of one are more, it is split again, down to a tile.

use crate::project::area::{Area, tiles_of};
use crate::project::cell64::Cell64;
use crate::project::covered::{BESIDE, Corners, MOST, least, most};
use crate::project::part::Input;
use crate::project::record::TILE;
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use voltet_simd::{Double, Kernel, LaneSet, Lanes, Mask, dispatch};

/// Cells that are told apart at a time.
const PIECE: usize = 1 << 16;

/// Windows that a thread should find, so that the last ones do not keep the others waiting.
const WINDOWS_OF_THREAD: usize = 4;

/// A part of the picture, and the cells that touch it.
#[derive(Debug)]
pub(crate) struct Window {
    pub area: Area,
    /// Their numbers, in their order.
    pub pieces: Vec<Vec<u32>>,
}

/// Cells that cover a pixel centre, and the windows that they touch.
#[derive(Debug)]
pub(crate) struct Windows {
    pub list: Vec<Window>,
    pub cell_count: u64,
}

impl Window {
    fn cell_count(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }
}

impl Windows {
    /// Tells cells apart, in their order, for windows of about `wished` cells, the fullest first.
    pub fn of(input: &Input<'_>, lanes: LaneSet, points: &[DVec3], cells: &[u32], wished: usize) -> Windows {
        let telling = Telling { input, lanes, points };
        let least_count = WINDOWS_OF_THREAD * rayon::current_num_threads();
        let tile_count = telling.tiles_seen();
        let wished_tiles = (wished * tile_count / cells.len().max(1)).min(tile_count / least_count);
        let pieces: Vec<&[u32]> = cells.chunks(PIECE).collect();
        let (mut list, cell_count) = telling.apart(input.area, wished_tiles.isqrt().max(1), &pieces);
        let mut fit = Vec::with_capacity(list.len());
        while let Some(window) = list.pop() {
            let (count, tile_count) = (window.cell_count(), window.area.tile_count());
            if count <= 2 * wished || tile_count == 1 {
                fit.push(window);
                continue;
            }
            let [columns, rows] = window.area.size();
            let side = (wished * tile_count / count).isqrt().clamp(1, columns.max(rows).div_ceil(2));
            let pieces: Vec<&[u32]> = window.pieces.iter().map(Vec::as_slice).collect();
            list.extend(telling.apart(window.area, side, &pieces).0);
        }
        fit.sort_by_key(|window| (Reverse(window.cell_count()), window.area.from));
        Windows { list: fit, cell_count }
    }

    /// Drops the windows that none of some tiles, numbered row by row of `columns`, lies in.
    pub fn retain(&mut self, tiles: &[u32], columns: usize) {
        let at = |tile: u32| [tile as usize % columns, tile as usize / columns];
        self.list.retain(|window| tiles.iter().any(|&tile| window.area.holds(at(tile))));
    }
}

/// What cells are told apart by.
struct Telling<'a> {
    input: &'a Input<'a>,
    lanes: LaneSet,
    points: &'a [DVec3],
}

impl Telling<'_> {
    /// Tiles of the box that the points are seen in.
    fn tiles_seen(&self) -> usize {
        let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        let join =
            |a: [f64; 4], b: [f64; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
        let seen = self.input.seen.par_iter().with_min_len(1 << 14);
        let [x0, y0, x1, y1] = seen.map(|s| [s.x, s.y, s.x, s.y]).reduce(|| none, join);
        let [columns, rows] = self.input.area.size();
        // A cast from float saturates.
        let tiles = |low: f64, high: f64, most: usize| {
            let [low, high] = [low, high].map(|x| ((x / TILE as f64).max(0.0) as usize).min(most));
            (high - low.min(high)).max(1)
        };
        tiles(x0, x1, columns) * tiles(y0, y1, rows)
    }

    /// The windows of an area that cells touch, row by row, and the number of cells that cover a pixel centre.
    fn apart(&self, area: Area, side: usize, pieces: &[&[u32]]) -> (Vec<Window>, u64) {
        let areas = area.split(side);
        let columns = area.size()[0].div_ceil(side);
        let Telling { input, points, .. } = *self;
        let lists: Vec<(Vec<Vec<u32>>, u64)> = pieces
            .par_iter()
            .map(|cells| {
                let mut told = Told { lists: vec![Vec::new(); areas.len()], cell_count: 0 };
                let tell = Tell { input, points, cells, area, side, columns, told: &mut told };
                dispatch(self.lanes, tell);
                (told.lists, told.cell_count)
            })
            .collect();
        let cell_count = lists.iter().map(|(_, count)| count).sum();
        let mut windows: Vec<Window> =
            areas.into_iter().map(|area| Window { area, pieces: Vec::new() }).collect();
        for (lists, _) in lists {
            for (window, list) in windows.iter_mut().zip(lists).filter(|(_, list)| !list.is_empty()) {
                window.pieces.push(list);
            }
        }
        windows.retain(|window| !window.pieces.is_empty());
        (windows, cell_count)
    }
}

/// What is told of some cells: their numbers, window by window, and how many cover a pixel centre.
struct Told {
    lists: Vec<Vec<u32>>,
    cell_count: u64,
}

struct Tell<'a> {
    input: &'a Input<'a>,
    points: &'a [DVec3],
    cells: &'a [u32],
    area: Area,
    side: usize,
    /// Columns of windows.
    columns: usize,
    told: &'a mut Told,
}

impl Kernel for Tell<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Tell { input, points, cells, area, side, columns, told } = self;
        let view = input.view;
        let splat = L::D::splat;
        for group in cells.chunks(L::D::COUNT) {
            let corners = Corners::<L::D>::gather(input.seen, input.tetrahedra, group);
            let covered = corners.covered(view);
            // What is crossed in 64 bits does not know of pixel coordinates' rounding: 2⁻²⁴, and far outside what 64 bits leave of them.
            let mut boxes = [[0.0; MOST]; 4];
            for (axis, c) in [&corners.x, &corners.y].into_iter().enumerate() {
                let (low, high) = (least(c), most(c));
                let slack = splat(BESIDE) + splat(f64::EPSILON * 16.0) * low.abs().max(high.abs());
                let most = splat(view.size[axis] as f64);
                (low - slack).ceil().max(splat(0.0)).min(most).store(&mut boxes[axis]);
                (high + slack).ceil().max(splat(0.0)).min(most).store(&mut boxes[axis + 2]);
            }
            let live = (1u32 << group.len()) - 1;
            let in_depth = covered.in_depth.bits();
            let ordinary = in_depth & covered.any.bits();
            for (lane, &id) in group.iter().enumerate() {
                let pixels = if ordinary >> lane & 1 != 0 {
                    [0, 1, 2, 3].map(|k: usize| boxes[k][lane] as usize)
                } else if live & !in_depth & (1 << lane) != 0 {
                    let corners = input.tetrahedra[id as usize].map(|p| points[p as usize]);
                    let Some(cell) = Cell64::new(view, id, corners) else { continue };
                    cell.bounds
                } else {
                    continue;
                };
                told.cell_count += 1;
                let Some([x0, y0, x1, y1]) = area.shared(tiles_of(pixels)) else { continue };
                let [x0, y0] = [(x0 - area.from[0]) / side, (y0 - area.from[1]) / side];
                let [x1, y1] = [(x1 - area.from[0]).div_ceil(side), (y1 - area.from[1]).div_ceil(side)];
                for y in y0..y1 {
                    told.lists[y * columns + x0..y * columns + x1].iter_mut().for_each(|list| list.push(id));
                }
            }
        }
    }
}
