//! Order of cells across gaps of the grid, along the rays of the pixels.
//!
//! A ray that leaves a grid that is not convex may meet it again, and no chain of faces says which cell comes first. Silva,
//! Mitchell and Williams (An exact interactive time visibility ordering algorithm for polyhedral cell complexes, 1998) sort the
//! boundary at each pixel; so it is done here: at each pixel's ray, of the boundary's faces the exits and entries in the order of
//! their depths, the cell of each exit before that of the entry behind it.

use super::faces::Faces;
use super::rays::{Rays, Triangle};
use crate::Result;
use crate::camera::Camera;
use crate::grid::faces::face_of;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Rows of pixels that are looked at together.
const ROWS: u32 = 16;

/// Faces that meet within this share of the grid's diagonal touch: parts that lie against each other without sharing faces.
const TOUCH: f64 = 1e-9;

/// Relations found across gaps.
#[derive(Debug, Default)]
pub(super) struct Gaps {
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
pub(super) struct Crossing {
    pub depth: f64,
    pub cell: u32,
    pub enters: bool,
}

/// The gaps along the rays of a camera's pixels. Errors: a camera out of range.
pub(super) fn gaps(faces: &Faces, points: &[DVec3], cells: &[[u32; 4]], camera: &Camera) -> Result<Gaps> {
    let mut all = Gaps::default();
    for rays in Rays::per_sample(camera)? {
        let outer = |&(cell, k): &(u32, usize)| {
            let corners = face_of(cells[cell as usize], k).map(|p| points[p as usize]);
            let triangle = rays.triangle(corners)?;
            Some(OuterTriangle { cell, is_at_normal: faces.is_at_normal(cell, k), triangle })
        };
        let outer: Vec<OuterTriangle> = faces.outer.par_iter().with_min_len(256).filter_map(outer).collect();
        let bands: Vec<Range<u32>> =
            (0..rays.size[1]).step_by(ROWS as usize).map(|y| y..(y + ROWS).min(rays.size[1])).collect();
        let touch = TOUCH * faces.diagonal;
        let found: Vec<Gaps> =
            bands.into_par_iter().map(|rows| in_rows(&outer, &rays, rows, touch)).collect();
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
pub(super) fn follow(crossings: &mut [Crossing], touch: f64, relations: &mut Vec<[u32; 2]>) -> bool {
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
