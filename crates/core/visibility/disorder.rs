//! The check of an order of cells: pixels at which it is not that of the entries.
//!
//! Knows nothing of how the order was found: each ray is cut by the four faces of every cell around it, in 64 bits.

use super::rays::{Plane, Rays};
use crate::Result;
use crate::camera::Camera;
use crate::grid::Grid;
use crate::grid::faces::face_of;
use rayon::prelude::*;
use std::ops::Range;

/// Cells that hide each other by less than this share of the grid's diagonal may stand in either order: rounding.
const ROUNDING: f64 = 1e-9;

/// Result of the check of an order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Disorder {
    /// Pixels that were looked at, over all their samples.
    pub pixels_tested: u64,
    /// Pixels among these at which a cell comes before one that its ray enters sooner.
    pub disordered: u64,
}

/// A cell as the rays of one sample cross it.
struct ProjectedCell {
    columns: Range<u32>,
    rows: Range<u32>,
    /// Its faces, each with whether the cell lies on the side that the plane's normal points to.
    planes: [(Plane, bool); 4],
}

/// Looks at an order of cells, nearest first, at the pixels that are `wanted`, by column and row.
///
/// Errors: a camera out of range.
pub fn disorder(
    grid: &Grid,
    order: &[u32],
    camera: &Camera,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
) -> Result<Disorder> {
    let rounding = ROUNDING * grid.bounds().map_or(0.0, |[low, high]| (high - low).length());
    let mut found = Disorder::default();
    for rays in Rays::per_sample(camera)? {
        let crossed: Vec<ProjectedCell> =
            order.par_iter().with_min_len(256).filter_map(|&cell| crossed(grid, cell, &rays)).collect();
        let width = rays.size[0];
        let in_band = |rows: Range<u32>| {
            let place = |[x, y]: [u32; 2]| ((y - rows.start) * width + x) as usize;
            let mut farthest: Vec<Option<f64>> = vec![None; width as usize * rows.len()];
            let pixels = || rows.clone().flat_map(|y| (0..width).map(move |x| [x, y]));
            pixels().filter(|pixel| wanted(*pixel)).for_each(|pixel| farthest[place(pixel)] = Some(0.0));
            let looked_at = farthest.iter().flatten().count() as u64;
            for cell in crossed.iter().filter(|_| looked_at > 0) {
                for y in cell.rows.start.max(rows.start)..cell.rows.end.min(rows.end) {
                    for x in cell.columns.clone() {
                        let Some(so_far) = &mut farthest[place([x, y])] else { continue };
                        let Some(entry) = cell.entry([x, y], &rays, rounding) else { continue };
                        // What is out of order once stays so.
                        let is_behind = *so_far <= entry + rounding;
                        *so_far = if is_behind { so_far.max(entry) } else { f64::INFINITY };
                    }
                }
            }
            let disordered = farthest.iter().flatten().filter(|depth| depth.is_infinite()).count() as u64;
            Disorder { pixels_tested: looked_at, disordered }
        };
        for band in rays.bands().into_par_iter().map(in_band).collect::<Vec<_>>() {
            found.pixels_tested += band.pixels_tested;
            found.disordered += band.disordered;
        }
    }
    Ok(found)
}

/// A cell for the rays of a sample; `None` where none of them comes near it, or it has no volume.
fn crossed(grid: &Grid, cell: u32, rays: &Rays) -> Option<ProjectedCell> {
    let corners = grid.corners(cell as usize);
    let [columns, rows] = rays.around(corners)?;
    let [a, b, c, d] = corners;
    let hand = (b - a).cross(c - a).dot(d - a);
    let planes = std::array::from_fn(|k| {
        let face = face_of([0, 1, 2, 3], k).map(|i| corners[i as usize]);
        (rays.plane(face), (hand > 0.0) == (k % 2 == 1))
    });
    (hand != 0.0).then_some(ProjectedCell { columns, rows, planes })
}

impl ProjectedCell {
    /// The depth at which a pixel's ray enters the cell; `None` where what it sees of the cell is no longer than `least`.
    fn entry(&self, pixel: [u32; 2], rays: &Rays, least: f64) -> Option<f64> {
        let (mut enters, mut leaves) = (rays.near, f64::INFINITY);
        for (plane, is_at_normal) in &self.planes {
            let depth = plane.depth(pixel);
            if (plane.turn(pixel) > 0.0) == *is_at_normal {
                enters = enters.max(depth);
            } else {
                leaves = leaves.min(depth);
            }
        }
        (leaves - enters > least).then_some(enters)
    }
}
