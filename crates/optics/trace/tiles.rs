//! The picture: cells put into screen tiles by conservative bounds, tiles drawn on all cores.

use crate::trace::{Crossing, Ray, Tracer, Walk, sample_places};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::camera::Projection;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;

/// Side of a tile, pixels.
pub(super) const SIDE: usize = 16;

/// Part of the picture in pixel coordinates, row 0 at the top: [left, right], [top, bottom].
type Box2 = [[f64; 2]; 2];

/// Bounds of a cell that reaches before the eye plane and has none.
const UNBOUNDED: Box2 = [[f64::NEG_INFINITY, f64::INFINITY]; 2];

/// Tiles of a picture that are drawn, by their numbers from the upper left corner, row by row: what a stopped picture
/// leaves. Each holds 16 × 16 pixels, row by row.
pub type Tiles = BTreeMap<u32, Vec<[f32; 4]>>;

/// Pixels of a tile.
pub const TILE_PIXELS: usize = SIDE * SIDE;

impl Tracer<'_> {
    /// Draws the picture. Errors when a cell cannot be integrated or the user stopped the run.
    pub fn draw(&self, progress: &dyn Progress) -> Result<Picture> {
        self.draw_further(&mut Tiles::new(), progress)
    }

    /// Draws the tiles that are not there yet, and makes the picture of all. Where that ends early, `tiles` holds those that
    /// are drawn.
    pub fn draw_further(&self, tiles: &mut Tiles, progress: &dyn Progress) -> Result<Picture> {
        let [width, height] = self.camera.size.map(|n| n as usize);
        let [columns, _] = self.tile_counts();
        let lists = self.tile_lists(0..self.cell_count());
        tiles.retain(|&tile, pixels| (tile as usize) < lists.len() && pixels.len() == TILE_PIXELS);
        let missing: Vec<usize> =
            (0..lists.len()).filter(|&tile| !tiles.contains_key(&(tile as u32))).collect();
        let there = Mutex::new(tiles);
        let lock = || there.lock().unwrap_or_else(PoisonError::into_inner);
        missing.par_iter().try_for_each(|&tile| {
            progress.check_cancelled()?;
            let pixels = self.draw_tile([tile % columns * SIDE, tile / columns * SIDE], &lists[tile])?;
            let finished = {
                let mut tiles = lock();
                tiles.insert(tile as u32, pixels);
                tiles.len()
            };
            progress.report("reference", finished as f64 / lists.len() as f64);
            Result::Ok(())
        })?;
        let mut picture = Picture::transparent(width, height);
        for (&tile, pixels) in lock().iter() {
            let tile = tile as usize;
            for (k, pixel) in pixels.iter().enumerate() {
                let (i, j) = (tile % columns * SIDE + k % SIDE, tile / columns * SIDE + k / SIDE);
                if i < width && j < height {
                    picture.rgba[j * width + i] = *pixel;
                }
            }
        }
        Ok(picture)
    }

    /// Pixels of one tile, row by row. `corner`: its upper left pixel.
    fn draw_tile(&self, corner: [usize; 2], cells: &[u32]) -> Result<Vec<[f32; 4]>> {
        let samples = sample_places(self.camera.samples);
        let mut sums = vec![[0.0; 4]; SIDE * SIDE];
        let mut lists: Vec<Vec<Crossing>> = vec![Vec::new(); SIDE * SIDE];
        for place in &samples {
            let of_cell = |cell: u32| Some(move |ray: &Ray| self.crossing(ray, cell));
            self.find_crossings(corner, *place, cells, &mut lists, of_cell);
            for (k, list) in
                lists.iter_mut().enumerate().filter(|(_, list)| !list.is_empty() || !self.surfaces.is_empty())
            {
                self.sort(list);
                let ray = self.tile_ray(corner, *place, k);
                let seen = self.composite(&ray, list, |_, _, _| {})?;
                let [r, g, b] = seen.color;
                for (sum, part) in sums[k].iter_mut().zip([r, g, b, seen.opacity]) {
                    *sum += part / samples.len() as f64;
                }
            }
        }
        Ok(sums.iter().map(|pixel| pixel.map(|x| x as f32)).collect())
    }

    /// The ray through a pixel of a tile, by the pixel's number row by row, at a place from its upper left corner.
    pub(super) fn tile_ray(&self, corner: [usize; 2], place: [f64; 2], pixel: usize) -> Ray {
        self.ray((corner[0] + pixel % SIDE) as f64 + place[0], (corner[1] + pixel / SIDE) as f64 + place[1])
    }

    /// Replaces the lists of a tile's pixels by the crossings of their rays with these cells. `of_cell`: the crossings of a cell.
    pub(super) fn find_crossings<F: Fn(&Ray) -> Option<Crossing>>(
        &self,
        corner: [usize; 2],
        place: [f64; 2],
        cells: &[u32],
        lists: &mut [Vec<Crossing>],
        of_cell: impl Fn(u32) -> Option<F>,
    ) {
        lists.iter_mut().for_each(Vec::clear);
        for &cell in cells {
            let Some((bounds, crossing)) = self.bounds(cell).zip(of_cell(cell)) else { continue };
            let covers = |k: usize, index: usize| {
                (bounds[k][0]..=bounds[k][1]).contains(&((corner[k] + index) as f64 + place[k]))
            };
            for row in (0..SIDE).filter(|&row| covers(1, row)) {
                for column in (0..SIDE).filter(|&column| covers(0, column)) {
                    let pixel = row * SIDE + column;
                    lists[pixel].extend(crossing(&self.tile_ray(corner, place, pixel)));
                }
            }
        }
    }

    /// Columns and rows of the picture's tiles.
    pub(super) fn tile_counts(&self) -> [usize; 2] {
        self.camera.size.map(|length| (length as usize).div_ceil(SIDE))
    }

    /// Numbers of the cells, of some, that may touch each tile, row by row, in their order: for [`Tracer::walk_near`].
    pub fn tile_lists(&self, cells: impl Iterator<Item = u32>) -> Vec<Vec<u32>> {
        let [columns, rows] = self.tile_counts();
        let mut lists = vec![Vec::new(); columns * rows];
        for cell in cells {
            let Some(bounds) = self.bounds(cell) else { continue };
            let corners = self.corners(cell);
            let range = |k: usize, count: usize| {
                let [low, high] = bounds[k].map(|pixel| (pixel / SIDE as f64).clamp(0.0, count as f64));
                low as usize..((high.floor() as usize + 1).min(count))
            };
            let touches = |k: usize, tile: usize| bounds != UNBOUNDED || !self.beside(&corners, k, tile);
            for row in range(1, rows).filter(|&row| touches(1, row)) {
                for column in range(0, columns).filter(|&column| touches(0, column)) {
                    lists[row * columns + column].push(cell);
                }
            }
        }
        lists
    }

    /// Traces the ray through a place of the picture, (i, j) in pixels from its upper left corner, cell by cell, among those of its tile.
    /// Errors: what cannot be integrated.
    pub fn walk_near(&self, [i, j]: [f64; 2], lists: &[Vec<u32>]) -> Result<Walk> {
        let (counts, ray) = (self.tile_counts(), self.ray(i, j));
        let tile = |k: usize, x: f64| ((x / SIDE as f64) as usize).min(counts[k] - 1);
        let cells = &lists[tile(1, j) * counts[0] + tile(0, i)];
        let mut crossings = cells.iter().filter_map(|cell| self.crossing(&ray, *cell)).collect::<Vec<_>>();
        self.sort(&mut crossings);
        self.walk_crossings(&ray, &crossings)
    }

    /// True if a plane through the eye along a tile's edge has the cell on one side and the tile on the other.
    fn beside(&self, corners: &[[f64; 3]; 4], axis: usize, tile: usize) -> bool {
        let place = |pixel: f64| {
            let ray = self.ray(pixel, pixel);
            if axis == 0 { ray.x } else { ray.y }
        };
        // One pixel more on each side than the tile has.
        let (a, b) = (place((tile * SIDE) as f64 - 1.0), place(((tile + 1) * SIDE) as f64 + 1.0));
        let (low, high) = (a.min(b), a.max(b));
        corners.iter().all(|c| c[axis] > high * c[2]) || corners.iter().all(|c| c[axis] < low * c[2])
    }

    /// Bounds of what is seen of a cell, a little too large for rounding; `None` where nothing is.
    fn bounds(&self, cell: u32) -> Option<Box2> {
        let corners = self.corners(cell);
        if corners.iter().all(|c| c[2] <= self.near()) {
            return None;
        }
        let perspective = matches!(self.camera.projection, Projection::Perspective { .. });
        if perspective && corners.iter().any(|c| c[2] <= 0.0) {
            return Some(UNBOUNDED);
        }
        let [width, height] = self.camera.size.map(f64::from);
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for c in corners {
            let scale = if perspective { c[2] * self.pitch() } else { self.pitch() };
            let place = [c[0] / scale + 0.5 * width, 0.5 * height - c[1] / scale];
            for (bound, x) in bounds.iter_mut().zip(place) {
                let margin = 1e-6 + 1e-12 * x.abs();
                *bound = [bound[0].min(x - margin), bound[1].max(x + margin)];
            }
        }
        let outside =
            bounds[0][1] < 0.0 || bounds[0][0] > width || bounds[1][1] < 0.0 || bounds[1][0] > height;
        // A corner a hair before the eye plane may project to no number at all.
        let is_finite = bounds.iter().flatten().all(|x| x.is_finite());
        (!outside).then_some(if is_finite { bounds } else { UNBOUNDED })
    }
}
