//! Boundary of the drawn cells, by tiles.

use super::half_faces::HalfFaces;
use crate::tile::{Area, tiles_of};
use crate::tolerances::{BOUNDARY_SLACK, EYE_CUT};
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
    /// `corner`: see [`super::points::Points::corner`].
    pub fn new(
        half_faces: &HalfFaces,
        corner: impl Fn(u32) -> ([f64; 3], f64) + Sync,
        size: [usize; 2],
    ) -> Boundary {
        let area = Area::of_picture(size);
        let touches: Vec<Vec<(u32, u32)>> = half_faces
            .boundary
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, faces)| {
                let mut touches = Vec::with_capacity(2 * faces.len());
                for (k, face) in faces.iter().enumerate() {
                    let corners = face.corners.map(&corner);
                    let boxes = boxes(corners.map(|(corner, _)| corner), corners[0].1, size);
                    let [front, behind] =
                        boxes.map(|pixels| pixels.and_then(|pixels| area.intersection(tiles_of(pixels))));
                    let is_in_front = |x: usize, y: usize| {
                        front.is_some_and(|[x0, y0, x1, y1]| (x0..x1).contains(&x) && (y0..y1).contains(&y))
                    };
                    let mut add = |x: usize, y: usize| {
                        touches.push((area.index([x, y]) as u32, (chunk * CHUNK + k) as u32));
                    };
                    if let Some([x0, y0, x1, y1]) = front {
                        (y0..y1).for_each(|y| (x0..x1).for_each(|x| add(x, y)));
                    }
                    if let Some([x0, y0, x1, y1]) = behind {
                        for y in y0..y1 {
                            (x0..x1).filter(|&x| !is_in_front(x, y)).for_each(|x| add(x, y));
                        }
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

/// Pixels whose centres lie in the boxes of the parts of a face in front of the eye and behind it: x0, y0, x1, y1 (exclusive). A corner is
/// (x z, y z, z), of which x z and y z are rounded by `rounding` at most.
fn boxes(corners: [[f64; 3]; 3], rounding: f64, size: [usize; 2]) -> [Option<[usize; 4]>; 2] {
    let largest = corners.iter().fold(0.0, |largest: f64, [_, _, z]| largest.max(z.abs()));
    // Nearer to the eye positions leave the range of numbers.
    let least = EYE_CUT * largest;
    let (mut front, mut behind, mut beside) = (Bounds::NONE, Bounds::NONE, Bounds::NONE);
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % 3];
        match a[2] {
            z if z > least => front.add_position(a, rounding),
            z if z < -least => behind.add_position(a, rounding),
            _ => beside.add([a[0], a[1]], rounding),
        }
        for (bounds, z) in [(&mut front, least), (&mut behind, -least)] {
            if (a[2] > z) != (b[2] > z) {
                let share = (z - a[2]) / (b[2] - a[2]);
                let [x, y] = [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]));
                bounds.add_position([x, y, z], rounding);
                beside.add([x, y], rounding);
            }
        }
    }
    // A face that comes as near to the eye may be met by any ray.
    if beside.is_near_zero(least * size[0].max(size[1]) as f64) {
        return [Some([0, 0, size[0], size[1]]), None];
    }
    [front.pixels(size), behind.pixels(size)]
}

/// Bounds of positions.
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    const NONE: Bounds = Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn add(&mut self, at: [f64; 2], slack: f64) {
        for (axis, at) in at.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(at - slack);
            self.high[axis] = self.high[axis].max(at + slack);
        }
    }

    /// Adds the position on the screen of a corner (x z, y z, z).
    fn add_position(&mut self, [x, y, z]: [f64; 3], rounding: f64) {
        self.add([x / z, y / z], BOUNDARY_SLACK + rounding / z.abs());
    }

    /// True if they come as near to 0 on both axes as `distance`.
    fn is_near_zero(&self, distance: f64) -> bool {
        (0..2).all(|axis| self.low[axis] <= distance && -distance <= self.high[axis])
    }

    /// Pixels whose centres lie within.
    fn pixels(&self, size: [usize; 2]) -> Option<[usize; 4]> {
        let within = |axis: usize| {
            // A cast from float saturates.
            let from = self.low[axis].ceil().max(0.0) as usize;
            let to = ((self.high[axis].floor() + 1.0).max(0.0) as usize).min(size[axis]);
            (from < to).then_some([from, to])
        };
        let ([x0, x1], [y0, y1]) = (within(0)?, within(1)?);
        Some([x0, y0, x1, y1])
    }
}
