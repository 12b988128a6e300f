//! The picture: cells put into screen tiles by conservative bounds, tiles drawn on all cores.

use crate::trace::{Crossing, Tracer, sample_places};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::camera::Projection;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;

/// Side of a tile, pixels.
const SIDE: usize = 16;

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
        let columns = width.div_ceil(SIDE);
        let lists = self.tile_lists(columns, height.div_ceil(SIDE));
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
            lists.iter_mut().for_each(Vec::clear);
            let position = |k: usize, index: usize| (corner[k] + index) as f64 + place[k];
            for &cell in cells {
                let Some(bounds) = self.bounds(cell) else { continue };
                let covers =
                    |k: usize, index: usize| (bounds[k][0]..=bounds[k][1]).contains(&position(k, index));
                for row in (0..SIDE).filter(|&row| covers(1, row)) {
                    for column in (0..SIDE).filter(|&column| covers(0, column)) {
                        let ray = self.ray(position(0, column), position(1, row));
                        lists[row * SIDE + column].extend(self.crossing(&ray, cell));
                    }
                }
            }
            for (k, list) in
                lists.iter_mut().enumerate().filter(|(_, list)| !list.is_empty() || !self.surfaces.is_empty())
            {
                self.sort(list);
                let ray = self.ray(position(0, k % SIDE), position(1, k / SIDE));
                let seen = self.composite(&ray, list, |_, _, _| {})?;
                let [r, g, b] = seen.color;
                for (sum, part) in sums[k].iter_mut().zip([r, g, b, seen.opacity]) {
                    *sum += part / samples.len() as f64;
                }
            }
        }
        Ok(sums.iter().map(|pixel| pixel.map(|x| x as f32)).collect())
    }

    /// The cells that may touch each tile, in grid order.
    fn tile_lists(&self, columns: usize, rows: usize) -> Vec<Vec<u32>> {
        let mut lists = vec![Vec::new(); columns * rows];
        for cell in 0..self.cell_count() {
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
