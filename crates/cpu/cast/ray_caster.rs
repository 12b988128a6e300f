//! Ray caster: the acceleration structure of a picture.

use super::boundary::Boundary;
use super::face_cache::FaceCache;
use super::half_faces::{HalfFaces, MAX_CELLS};
use super::points::{Points, ScreenExtent};
use super::policy::RayCastPolicy;
use crate::project::cells::Input;
use crate::selection::{CellSelection, Traversal};
use crate::tolerances::MAX_THIN_CELL_DEPTH;
use crate::view::{ScreenVertex, View};
use std::sync::Arc;
use voltet_optics::shading::Ordering;

/// Attributes that rays interpolate: s, g and the components of ∇s.
pub(crate) const MAX_RAYCAST_ATTRIBUTES: usize = 5;

/// Cells of the sample that estimates how many pixels a cell covers.
const SAMPLED_CELLS: usize = 4096;

/// Acceleration structure of a picture's rays.
#[derive(Debug)]
pub(crate) struct RayCaster {
    pub(super) half_faces: Arc<HalfFaces>,
    pub(super) points: Points,
    pub(super) boundary: Boundary,
}

impl RayCaster {
    /// Prepares rays through the cells of a picture. `None` where cells are projected instead: in another order than the exact one; by the
    /// selection's `traversal`; where attributes are many; where the policy is not met, or thin cells are optically thick.
    ///
    /// Where the near plane or the eye lies among the cells, rays go through those in view alone: they enter by faces of these on the
    /// eye's side of the near plane, and their segments begin at it.
    pub fn new(
        cells: &CellSelection,
        faces: &FaceCache,
        input: &Input<'_>,
        policy: RayCastPolicy,
    ) -> Option<RayCaster> {
        let Input { view, screen_vertices, tetrahedra, attributes, max_optical_depth, .. } = *input;
        let extent = ScreenExtent::new(screen_vertices);
        let drawn = if extent.is_cut(view) { &cells.ids } else { faces.drawn() };
        let is_possible = cells.traversal != Traversal::Project
            && matches!(cells.ordering, Ordering::Independent | Ordering::PerPixel)
            && attributes.len() <= MAX_RAYCAST_ATTRIBUTES
            && !drawn.is_empty()
            && drawn.len() <= MAX_CELLS;
        if !is_possible {
            return None;
        }
        let segments = covered_pixels(view, screen_vertices, tetrahedra, &cells.ids) / drawn.len() as f64;
        if cells.traversal != Traversal::RayCast && !policy.pays(segments) {
            return None;
        }
        // Faces are found last: of a volume that takes longer than a frame.
        let grid = &cells.volume.grid;
        let mesh = faces.mesh(grid);
        let [longest, longest_thin] = mesh.longest.map(|longest| longest / cells.length);
        if MAX_THIN_CELL_DEPTH < max_optical_depth * longest_thin {
            return None;
        }
        let half_faces = faces.half_faces(&mesh, grid, drawn);
        if !policy.allows_boundary(half_faces.boundary.len(), drawn.len()) {
            return None;
        }
        let points = Points::new(view, &grid.points, screen_vertices, &extent, longest, attributes)?;
        let corner = |point| points.corner(screen_vertices, &grid.points, point);
        let boundary = Boundary::new(&half_faces, corner, view.size);
        Some(RayCaster { half_faces, points, boundary })
    }

    /// Tiles that rays enter at, numbered row by row, those with most boundary faces first.
    pub fn queue(&self) -> Vec<u32> {
        self.boundary.queue()
    }
}

/// Pixels that cells cover in front of the near plane, estimated from some of them. A tetrahedron covers half of the sum of its four faces.
fn covered_pixels(
    view: &View,
    screen_vertices: &[ScreenVertex],
    tetrahedra: &[[u32; 4]],
    cells: &[u32],
) -> f64 {
    let step = (cells.len() / SAMPLED_CELLS).max(1);
    let area = |cell: &u32| {
        let corners @ [a, b, c, d] = tetrahedra[*cell as usize].map(|p| &screen_vertices[p as usize]);
        if corners.iter().any(|corner| corner.z <= view.near) {
            return 0.0;
        }
        let face = |a: &ScreenVertex, b: &ScreenVertex, c: &ScreenVertex| {
            (0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x))).abs()
        };
        0.5 * (face(a, b, c) + face(a, b, d) + face(a, c, d) + face(b, c, d))
    };
    cells.iter().step_by(step).map(area).sum::<f64>() * step as f64
}
