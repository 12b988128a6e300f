//! Boundary of the drawn cells, by tiles.

use super::half_faces::HalfFaces;
use crate::tile::{Area, tiles_of};
use crate::tolerances::BOUNDARY_SLACK;
use crate::view::ScreenVertex;
use rayon::prelude::*;

/// Faces of a chunk of work.
const CHUNK: usize = 1 << 12;

/// Boundary faces that may cover a pixel's centre, by the tiles that they touch.
#[derive(Debug)]
pub(super) struct Boundary {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Boundary {
    pub fn new(vertices: &[ScreenVertex], half_faces: &HalfFaces, size: [usize; 2]) -> Boundary {
        let area = Area::of_picture(size);
        let touches: Vec<Vec<(u32, u32)>> = half_faces
            .boundary
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, faces)| {
                let mut touches = Vec::with_capacity(2 * faces.len());
                for (k, face) in faces.iter().enumerate() {
                    let Some(pixels) = pixels(vertices, face.corners, size) else { continue };
                    let Some([x0, y0, x1, y1]) = area.intersection(tiles_of(pixels)) else { continue };
                    for y in y0..y1 {
                        let first = area.index([x0, y]);
                        let tiles = first..first + (x1 - x0);
                        touches.extend(tiles.map(|tile| (tile as u32, (chunk * CHUNK + k) as u32)));
                    }
                }
                touches
            })
            .collect();
        let mut starts = vec![0u32; area.tile_count() + 1];
        for (tile, _) in touches.iter().flatten() {
            starts[*tile as usize + 1] += 1;
        }
        for tile in 0..area.tile_count() {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let mut faces = vec![0; starts[area.tile_count()] as usize];
        for &(tile, face) in touches.iter().flatten() {
            let slot = &mut next[tile as usize];
            faces[*slot as usize] = face;
            *slot += 1;
        }
        Boundary { starts, faces }
    }

    /// Faces that touch a tile.
    pub fn faces_of(&self, tile: usize) -> &[u32] {
        &self.faces[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// Tiles that boundary faces touch, those with most faces first.
    pub fn queue(&self) -> Vec<u32> {
        let count = |tile: usize| self.starts[tile + 1] - self.starts[tile];
        let mut queue: Vec<u32> =
            (0..self.starts.len() - 1).filter(|&tile| count(tile) > 0).map(|tile| tile as u32).collect();
        queue.sort_by_key(|&tile| std::cmp::Reverse(count(tile as usize)));
        queue
    }
}

/// Pixels whose centres lie in the box of a face: x0, y0, x1, y1 (exclusive).
fn pixels(vertices: &[ScreenVertex], corners: [u32; 3], size: [usize; 2]) -> Option<[usize; 4]> {
    let corners = corners.map(|p| &vertices[p as usize]);
    let within = |coordinates: [f64; 3], size: usize| {
        let low = coordinates.into_iter().fold(f64::INFINITY, f64::min);
        let high = coordinates.into_iter().fold(f64::NEG_INFINITY, f64::max);
        // A cast from float saturates. Positions are rounded again: half a step of them more.
        let from = (low - BOUNDARY_SLACK).ceil().max(0.0) as usize;
        let to = ((high + BOUNDARY_SLACK).floor() + 1.0).max(0.0) as usize;
        (from < to.min(size)).then_some([from, to.min(size)])
    };
    let [x0, x1] = within(corners.map(|s| s.x), size[0])?;
    let [y0, y1] = within(corners.map(|s| s.y), size[1])?;
    Some([x0, y0, x1, y1])
}
