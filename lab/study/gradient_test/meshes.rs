//! Grids over the unit cube, from even to stretched, each at any fineness.

use glam::{DMat3, DVec3};
use voltet_core::SharedSlice;
use voltet_core::grid::Grid;
use voltet_core::grid::generate::box_of_tetrahedra;

/// A family of grids, finer and finer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mesh {
    /// Equal boxes, each cut into tetrahedra.
    Regular,
    /// Regular, with the points inside moved at random by up to a fifth of the spacing.
    Distorted,
    /// The distorted one, flattened: cells ten times as long as they are high.
    Stretched,
    /// Layers that thin towards one side by 1 : 30, as a boundary layer's, turned out of the axes and moved at random.
    Anisotropic,
}

impl Mesh {
    /// All of them.
    pub const EVERY: [Mesh; 4] = [Mesh::Regular, Mesh::Distorted, Mesh::Stretched, Mesh::Anisotropic];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Mesh::Regular => "regular",
            Mesh::Distorted => "distorted",
            Mesh::Stretched => "stretched",
            Mesh::Anisotropic => "anisotropic",
        }
    }

    /// With `count` boxes a side.
    pub fn grid(self, count: usize) -> Meshed {
        let jitter = if self == Mesh::Regular { 0.0 } else { JITTER };
        let grid = box_of_tetrahedra([count; 3], [DVec3::ZERO, DVec3::ONE], jitter);
        let at_boundary = (0..grid.points.len()).map(|p| on_surface(p, count)).collect();
        let place: &dyn Fn(DVec3) -> DVec3 = match self {
            Mesh::Regular | Mesh::Distorted => &|p| p,
            Mesh::Stretched => &|p| DVec3::new(p.x, p.y, p.z * FLAT),
            Mesh::Anisotropic => {
                let turn = turn();
                &move |p| {
                    let layer = ((p.z * THIN.ln()).exp() - 1.0) / (THIN - 1.0);
                    turn * (DVec3::new(p.x, p.y, layer) - DVec3::splat(0.5)) + DVec3::splat(0.5)
                }
            }
        };
        let grid = Grid {
            points: SharedSlice::from(grid.points.iter().map(|&p| place(p)).collect::<Vec<_>>()),
            ..grid
        };
        Meshed { grid, at_boundary }
    }
}

/// A grid, and which of its points lie on its boundary.
pub(super) struct Meshed {
    /// The grid, without a scalar.
    pub grid: Grid,
    /// One flag a point.
    pub at_boundary: Vec<bool>,
}

/// Largest move as a fraction of the spacing; up to a quarter no cell turns over.
const JITTER: f64 = 0.2;
const FLAT: f64 = 0.1;
/// The thickest layer by the thinnest, for many layers.
const THIN: f64 = 30.0;

/// A rotation out of all axes.
pub(super) fn turn() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7)
}

/// True if point `p` of a box of `count`³ boxes, x fastest, lies on its surface.
fn on_surface(p: usize, count: usize) -> bool {
    let side = count + 1;
    [p % side, p / side % side, p / (side * side)].iter().any(|&k| k == 0 || k == count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::grid::tetrahedron_volume;

    #[test]
    fn no_cell_turns_over_and_the_volume_is_that_of_the_box() {
        for mesh in Mesh::EVERY {
            let Meshed { grid, at_boundary } = mesh.grid(5);
            let volumes =
                grid.tetrahedra.iter().map(|t| tetrahedron_volume(t.map(|p| grid.points[p as usize])));
            let (least, sum) = volumes.fold((f64::MAX, 0.0), |(least, sum), v| (v.min(least), sum + v));
            let whole = if mesh == Mesh::Stretched { FLAT } else { 1.0 };
            assert!(least > 0.0 && (sum - whole).abs() < 1e-2, "{}: {least:e}, {sum}", mesh.name());
            assert_eq!(at_boundary.iter().filter(|at| !**at).count(), 4 * 4 * 4, "{}", mesh.name());
        }
    }
}
