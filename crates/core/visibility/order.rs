//! The order of cells along their faces (Williams, Visibility-ordering meshed polyhedra, 1992: MPVO), and across gaps.
//!
//! Of two cells that share a face the one on the eye's side of its plane comes first. Along a ray that stays in the grid every cell
//! is followed by one with which it shares a face, so an order that keeps all these relations, and those across the gaps of a
//! grid that is not convex, is exact at every pixel. Relations that lead round in a circle have none; those that no pixel's ray
//! bears out, since it crosses no such face, are taken out of the circles first.
//!
//! A ray that leaves a grid that is not convex may meet it again, and no chain of faces says which cell comes first. Silva,
//! Mitchell and Williams (An exact interactive time visibility ordering algorithm for polyhedral cell complexes, 1998) sort the
//! boundary at each pixel; so it is done here: at each pixel's ray, of the boundary's faces the exits and entries in the order of
//! their depths, the cell of each exit before that of the entry behind it.

use super::faces::{CHUNK, Faces, NO_CELL};
use super::rays::{Rays, Triangle};
use crate::camera::{Camera, Projection};
use crate::grid::Grid;
use crate::grid::faces::face_of;
use crate::{Result, agreeing, counted};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;
use std::ops::Range;

/// An eye within this share of the plane of a face, by rounding of the face's normal, sees it as a line: no ray crosses it.
const EDGE_ON: f64 = 1e-14;

/// An order of all cells of a grid for one camera, exact at every sample of its pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaceOrder {
    /// The cells, nearest first.
    pub cells: Vec<u32>,
    /// Relations between cells across gaps of the grid.
    pub across_gaps: usize,
    /// Relations along faces that led round in a circle, and that no pixel's ray bears out.
    pub taken_out: usize,
}

/// Reason why a grid has no exact order of its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrderError {
    /// Number of faces with three cells or more.
    Crowded(u64),
    /// Number of faces with both cells on one side.
    Folded(u64),
    /// Number of pixels whose rays meet parts of the grid that lie in each other, or a boundary that is not closed.
    Unclear(u64),
    /// Number of cells that hide each other in circles, or lie between such.
    Cyclic(usize),
}

impl fmt::Display for OrderError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            OrderError::Crowded(count) => {
                write!(
                    f,
                    "{} {} more than two cells",
                    counted(*count, "face"),
                    agreeing(count, "has", "have")
                )
            }
            OrderError::Folded(count) => {
                let them = agreeing(count, "it", "them");
                write!(f, "the cells of {} lie on one side of {them}", counted(*count, "face"))
            }
            OrderError::Unclear(count) => {
                write!(f, "parts of the grid lie in each other at {}", counted(*count, "pixel"))
            }
            OrderError::Cyclic(count) => write!(f, "{} hide each other in circles", counted(*count, "cell")),
        }
    }
}

/// Order of the two cells of a face as seen from the eye, two bits: none where the face is seen edge-on.
const THIS_CELL_FIRST: u8 = 1;
const OTHER_CELL_FIRST: u8 = 2;

impl Faces {
    /// True if an order of which no relation was taken out serves every picture from the same eye: so it is without gaps.
    pub fn is_independent_of_direction(&self) -> bool {
        self.is_convex
    }

    /// The order of all cells of the grid, which these are the faces of, as a camera sees them; or why none is known.
    ///
    /// Errors: a camera out of range.
    pub fn order(&self, grid: &Grid, camera: &Camera) -> Result<std::result::Result<FaceOrder, OrderError>> {
        let forward = camera.frame()?.forward;
        if self.crowded > 0 {
            return Ok(Err(OrderError::Crowded(self.crowded)));
        }
        if self.folded > 0 {
            return Ok(Err(OrderError::Folded(self.folded)));
        }
        let (points, cells) = (&grid.points[..], &grid.tetrahedra[..]);
        let Gaps { relations, unclear } = match self.is_convex {
            true => Gaps::default(),
            false => gaps(self, points, cells, camera)?,
        };
        if unclear > 0 {
            return Ok(Err(OrderError::Unclear(unclear)));
        }
        let eye = match camera.projection {
            Projection::Perspective { .. } => Eye::At(camera.eye),
            Projection::Orthographic { .. } => Eye::Towards(-forward),
        };
        let mut relations =
            Relations { faces: self, along: self.order_across_faces(points, cells, eye), across: relations };
        let mut order = Vec::with_capacity(cells.len());
        let mut left = relations.sort(&mut order);
        let mut taken_out = 0;
        if !left.is_empty() {
            taken_out = relations.take_out(&left, points, cells, &Rays::per_sample(camera)?);
            left = relations.sort_rest(&left, &mut order);
        }
        Ok(match left.len() {
            0 => Ok(FaceOrder { cells: order, across_gaps: relations.across.len(), taken_out }),
            _ => Err(OrderError::Cyclic(relations.in_circles(&left).len())),
        })
    }

    /// For each cell and its faces to cells of higher numbers, which of the two comes first.
    fn order_across_faces(&self, points: &[DVec3], cells: &[[u32; 4]], eye: Eye) -> Vec<u8> {
        let of_cell = |(cell, neighbours): (usize, &[u32; 4])| {
            let mut along = 0;
            for (k, &other) in neighbours.iter().enumerate() {
                if other == NO_CELL || (other as usize) < cell {
                    continue;
                }
                let height = eye.height(face_of(cells[cell], k).map(|p| points[p as usize]));
                if height != 0.0 {
                    let is_first = (height > 0.0) == self.is_at_normal(cell as u32, k);
                    along |= (if is_first { THIS_CELL_FIRST } else { OTHER_CELL_FIRST }) << (2 * k);
                }
            }
            along
        };
        self.neighbours.par_iter().enumerate().with_min_len(CHUNK).map(of_cell).collect()
    }
}

/// Origin of the rays.
#[derive(Clone, Copy)]
enum Eye {
    At(DVec3),
    /// Parallel rays: the direction towards the eye.
    Towards(DVec3),
}

impl Eye {
    /// Above 0 on the side of a triangle that its normal points to; 0 where rounding could turn it.
    fn height(self, [a, b, c]: [DVec3; 3]) -> f64 {
        let [u, v] = [b - a, c - a];
        let towards = match self {
            Eye::At(eye) => eye - a,
            Eye::Towards(direction) => direction,
        };
        let height = u.cross(v).dot(towards);
        // The largest of the products that were summed.
        let sum = u.abs().max_element() * v.abs().max_element() * towards.abs().max_element();
        if height.abs() > EDGE_ON * sum { height } else { 0.0 }
    }
}

/// Relations "comes before" between cells.
struct Relations<'a> {
    faces: &'a Faces,
    /// See [`Faces::order`].
    along: Vec<u8>,
    /// The first before the second, ascending.
    across: Vec<[u32; 2]>,
}

impl Relations<'_> {
    /// Order across a face: 1 if this cell comes first, 2 if the other does, 0 if unknown.
    #[inline]
    fn face_order(&self, cell: u32, k: usize) -> u8 {
        let other = self.faces.neighbours[cell as usize][k];
        if other == NO_CELL {
            return 0;
        }
        match cell < other {
            true => (self.along[cell as usize] >> (2 * k)) & 3,
            false => {
                let known = (self.along[other as usize] >> (2 * self.faces.theirs(cell, k))) & 3;
                // The other way round: 1 and 2 change places.
                (3 - known) % 3
            }
        }
    }

    /// The cells that come behind this one by a face or a gap.
    #[inline]
    fn each_behind(&self, cell: u32, mut take: impl FnMut(u32)) {
        for k in 0..4 {
            if self.face_order(cell, k) == THIS_CELL_FIRST {
                take(self.faces.neighbours[cell as usize][k]);
            }
        }
        if !self.across.is_empty() {
            let from = self.across.partition_point(|pair| pair[0] < cell);
            self.across[from..].iter().take_while(|pair| pair[0] == cell).for_each(|pair| take(pair[1]));
        }
    }

    /// Puts cells behind all that come before them (Kahn, Topological sorting of large networks, 1962). Gives those that it
    /// cannot place: in circles, or behind such.
    fn sort(&self, order: &mut Vec<u32>) -> Vec<u32> {
        let count = self.along.len() as u32;
        let before =
            |cell: u32| (0..4).filter(|&k| self.face_order(cell, k) == OTHER_CELL_FIRST).count() as u32;
        let mut before: Vec<u32> = (0..count).into_par_iter().with_min_len(CHUNK).map(before).collect();
        self.across.iter().for_each(|pair| before[pair[1] as usize] += 1);
        self.append_ready((0..count).rev(), &mut before, order);
        (0..count).filter(|&cell| before[cell as usize] > 0).collect()
    }

    /// Sorts the cells that could not be placed before.
    fn sort_rest(&self, rest: &[u32], order: &mut Vec<u32>) -> Vec<u32> {
        let mut before = vec![0; self.along.len()];
        rest.iter().for_each(|&cell| self.each_behind(cell, |other| before[other as usize] += 1));
        self.append_ready(rest.iter().rev().copied(), &mut before, order);
        rest.iter().copied().filter(|&cell| before[cell as usize] > 0).collect()
    }

    /// Places these cells and those behind them, as soon as nothing is `before` them that has no place.
    fn append_ready(&self, cells: impl Iterator<Item = u32>, before: &mut [u32], order: &mut Vec<u32>) {
        let mut ready: Vec<u32> = cells.filter(|&cell| before[cell as usize] == 0).collect();
        while let Some(cell) = ready.pop() {
            order.push(cell);
            self.each_behind(cell, |other| {
                before[other as usize] -= 1;
                if before[other as usize] == 0 {
                    ready.push(other);
                }
            });
        }
    }

    /// Cells in circles and between them: cells with one before and one behind them, repeatedly.
    fn in_circles(&self, left: &[u32]) -> Vec<u32> {
        let mut is_in = vec![false; self.along.len()];
        left.iter().for_each(|&cell| is_in[cell as usize] = true);
        let mut behind = vec![0u32; self.along.len()];
        let mut before: Vec<[u32; 2]> = Vec::new();
        for &cell in left {
            self.each_behind(cell, |other| {
                if is_in[other as usize] {
                    behind[cell as usize] += 1;
                    before.push([other, cell]);
                }
            });
        }
        before.sort_unstable();
        let mut ready: Vec<u32> = left.iter().copied().filter(|&cell| behind[cell as usize] == 0).collect();
        while let Some(cell) = ready.pop() {
            is_in[cell as usize] = false;
            let from = before.partition_point(|pair| pair[0] < cell);
            for pair in before[from..].iter().take_while(|pair| pair[0] == cell) {
                behind[pair[1] as usize] -= 1;
                if behind[pair[1] as usize] == 0 {
                    ready.push(pair[1]);
                }
            }
        }
        left.iter().copied().filter(|&cell| is_in[cell as usize]).collect()
    }

    /// Takes the relations out of circles that no pixel's ray bears out, since none crosses the face. Gives how many.
    fn take_out(&mut self, left: &[u32], points: &[DVec3], cells: &[[u32; 4]], samples: &[Rays]) -> usize {
        let circles = self.in_circles(left);
        let mut is_in = vec![false; self.along.len()];
        circles.iter().for_each(|&cell| is_in[cell as usize] = true);
        let idle = |&cell: &u32| {
            let neighbours = self.faces.neighbours[cell as usize];
            let inner = |k: &usize| {
                let other = neighbours[*k];
                other != NO_CELL && cell < other && is_in[other as usize] && self.face_order(cell, *k) != 0
            };
            let is_crossed = |k: usize| {
                let corners = face_of(cells[cell as usize], k).map(|p| points[p as usize]);
                samples.iter().any(|rays| rays.meet(corners))
            };
            (0..4).filter(inner).filter(|&k| !is_crossed(k)).map(|k| (cell, k)).collect::<Vec<_>>()
        };
        let idle: Vec<(u32, usize)> = circles.par_iter().flat_map_iter(idle).collect();
        for &(cell, k) in &idle {
            self.along[cell as usize] &= !(3 << (2 * k));
        }
        idle.len()
    }
}

/// Faces that meet within this share of the grid's diagonal touch: parts that lie against each other without sharing faces.
const TOUCH: f64 = 1e-9;

/// Relations found across gaps.
#[derive(Debug, Default)]
struct Gaps {
    /// The first cell before the second, each pair once, ascending.
    pub relations: Vec<[u32; 2]>,
    /// Pixels (samples of them) at which parts of the grid lie in each other, or the boundary is not closed.
    pub unclear: u64,
}

/// A face of the boundary as the rays cross it.
struct OuterTriangle {
    cell: u32,
    /// True if the cell lies on the side that the plane's normal points to.
    is_at_normal: bool,
    triangle: Triangle,
}

/// A crossing of the boundary.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    pub depth: f64,
    pub cell: u32,
    pub enters: bool,
}

/// The gaps along the rays of a camera's pixels. Errors: a camera out of range.
fn gaps(faces: &Faces, points: &[DVec3], cells: &[[u32; 4]], camera: &Camera) -> Result<Gaps> {
    let mut all = Gaps::default();
    for rays in Rays::per_sample(camera)? {
        let outer = |&(cell, k): &(u32, usize)| {
            let corners = face_of(cells[cell as usize], k).map(|p| points[p as usize]);
            let triangle = rays.triangle(corners)?;
            Some(OuterTriangle { cell, is_at_normal: faces.is_at_normal(cell, k), triangle })
        };
        let outer: Vec<OuterTriangle> = faces.outer.par_iter().with_min_len(256).filter_map(outer).collect();
        let touch = TOUCH * faces.diagonal;
        let found: Vec<Gaps> =
            rays.bands().into_par_iter().map(|rows| in_rows(&outer, &rays, rows, touch)).collect();
        for mut band in found {
            all.relations.append(&mut band.relations);
            all.unclear += band.unclear;
        }
    }
    all.relations.par_sort_unstable();
    all.relations.dedup();
    Ok(all)
}

fn in_rows(outer: &[OuterTriangle], rays: &Rays, rows: Range<u32>, touch: f64) -> Gaps {
    let width = rays.size[0] as usize;
    let place = |[x, y]: [u32; 2]| (y - rows.start) as usize * width + x as usize;
    let mut counts = vec![0u32; width * rows.len()];
    let here = outer
        .iter()
        .filter(|face| face.triangle.rows.start < rows.end && rows.start < face.triangle.rows.end);
    for face in here.clone() {
        face.triangle.each(rows.clone(), |pixel, _| counts[place(pixel)] += 1);
    }
    // Two crossings are an entry and an exit: no gap.
    let mut starts = Vec::with_capacity(counts.len() + 1);
    let mut sum = 0;
    for count in &counts {
        starts.push(sum);
        sum += if *count > 2 { *count as usize } else { 0 };
    }
    starts.push(sum);
    let mut found = Gaps::default();
    if sum == 0 {
        return found;
    }
    let mut crossings = vec![Crossing { depth: 0.0, cell: 0, enters: false }; sum];
    let mut filled = vec![0u32; counts.len()];
    for face in here {
        face.triangle.each(rows.clone(), |pixel, is_along_normal| {
            let at = place(pixel);
            if counts[at] > 2 {
                let enters = is_along_normal == face.is_at_normal;
                let crossing = Crossing { depth: face.triangle.depth(pixel), cell: face.cell, enters };
                crossings[starts[at] + filled[at] as usize] = crossing;
                filled[at] += 1;
            }
        });
    }
    let mut seen = Vec::new();
    for range in starts.windows(2).filter(|range| range[0] < range[1]) {
        seen.clear();
        seen.extend(
            crossings[range[0]..range[1]].iter().filter(|crossing| rays.is_visible_depth(crossing.depth)),
        );
        found.unclear += u64::from(!follow(&mut seen, touch, &mut found.relations));
    }
    found.relations.sort_unstable();
    found.relations.dedup();
    found
}

/// Goes along one ray and adds the relations across its gaps. `touch`: the depth within which crossings may have changed places.
/// Gives whether exits and entries alternate, as they do where the cells are disjoint.
fn follow(crossings: &mut [Crossing], touch: f64, relations: &mut Vec<[u32; 2]>) -> bool {
    crossings.sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth));
    // An eye within the grid meets an exit first.
    let entries = crossings.iter().filter(|crossing| crossing.enters).count();
    let mut is_inside = match crossings.len() - entries {
        exits if exits == entries => false,
        exits if exits == entries + 1 => true,
        _ => return false,
    };
    let mut left = None;
    for i in 0..crossings.len() {
        if crossings[i].enters == is_inside {
            // One behind it by less than rounding is meant to be before it.
            let reach = crossings[i].depth + touch;
            let near = crossings[i..].iter().take_while(|crossing| crossing.depth <= reach);
            let Some(k) = near.clone().position(|crossing| crossing.enters != is_inside) else {
                return false;
            };
            crossings[i..=i + k].rotate_right(1);
        }
        let Crossing { cell, enters, .. } = crossings[i];
        match (enters, left) {
            (true, Some(before)) if before != cell => relations.push([before, cell]),
            (true, _) => {}
            (false, _) => left = Some(cell),
        }
        is_inside = enters;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exits and entries along a ray, by rounding in the wrong order, and parts in each other.
    #[test]
    fn crossings_are_followed_along_a_ray() {
        let crossing = |(depth, cell, enters)| Crossing { depth, cell, enters };
        let follow = |crossings: &[(f64, u32, bool)]| {
            let mut relations = Vec::new();
            let mut crossings: Vec<_> = crossings.iter().copied().map(crossing).collect();
            follow(&mut crossings, 1e-6, &mut relations).then_some(relations)
        };
        let [enter, leave] = [true, false];
        let apart = [(1.0, 0, enter), (2.0, 1, leave), (3.0, 2, enter), (4.0, 3, leave)];
        assert_eq!(follow(&apart), Some(vec![[1, 2]]));
        assert_eq!(follow(&apart[1..]), Some(vec![[1, 2]]), "from within");
        let touching = [(1.0, 0, enter), (2.0 + 1e-9, 1, leave), (2.0, 2, enter), (4.0, 3, leave)];
        assert_eq!(follow(&touching), Some(vec![[1, 2]]));
        let sliver = [
            (1.0, 0, enter),
            (2.0, 1, leave),
            (3.0, 5, leave),
            (3.0 + 1e-9, 5, enter),
            (4.0, 2, enter),
            (5.0, 2, leave),
        ];
        assert_eq!(follow(&sliver), Some(vec![[1, 5], [5, 2]]));
        let within = [(1.0, 0, enter), (2.0, 2, enter), (3.0, 1, leave), (4.0, 3, leave)];
        assert_eq!(follow(&within), None);
        assert_eq!(follow(&apart[..3]), None, "open");
    }
}
