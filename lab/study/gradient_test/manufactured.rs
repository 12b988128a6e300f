//! Manufactured fields, whose gradient is a formula: the only truth that filters are compared with; and families of grids over the unit
//! cube, from even to stretched, each at any fineness.

use glam::{DMat3, DVec3};
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::grid::{Grid, cells_of_points, points_of_points};

#[derive(Debug, Clone, Copy)]
pub(super) struct Field {
    pub name: &'static str,
    /// s at a place.
    pub value: fn(DVec3) -> f64,
    pub gradient: fn(DVec3) -> DVec3,
}

pub(super) const SMOOTH: [Field; 2] = [
    Field { name: "waves", value: waves, gradient: waves_gradient },
    Field { name: "peak", value: peak, gradient: peak_gradient },
];

/// A linear function: nearly every reconstruction claims to be exact here.
pub(super) const LINEAR: Field = Field { name: "linear", value: |p| 0.3 + SLOPE.dot(p), gradient: |_| SLOPE };

/// A quadratic function with all six products.
pub(super) const QUADRATIC: Field = Field {
    name: "quadratic",
    value: |p| {
        0.7 * p.x * p.x - 0.4 * p.y * p.y + 0.9 * p.z * p.z + p.x * p.y - 0.6 * p.y * p.z + 0.5 * p.x * p.z
    },
    gradient: |p| {
        DVec3::new(
            1.4 * p.x + p.y + 0.5 * p.z,
            -0.8 * p.y + p.x - 0.6 * p.z,
            1.8 * p.z - 0.6 * p.y + 0.5 * p.x,
        )
    },
};

/// Two materials that meet at x = ½: the scalar is continuous, its slope across is ten times as large beyond.
pub(super) const MATERIALS: Field = Field {
    name: "materials",
    value: |p| along(p) + if p.x <= MEETING { p.x - MEETING } else { STEEP * (p.x - MEETING) },
    gradient: |p| DVec3::new(if p.x <= MEETING { 1.0 } else { STEEP }, 2.0 * (2.0 * p.y).cos(), -(p.z).sin()),
};

/// Plane in which the two materials meet.
pub(super) const MEETING: f64 = 0.5;

/// By how much ∂s/∂x jumps there.
pub(super) const JUMP: f64 = STEEP - 1.0;

const STEEP: f64 = 10.0;

const SLOPE: DVec3 = DVec3::new(1.7, -0.9, 0.6);

fn along(p: DVec3) -> f64 {
    (2.0 * p.y).sin() + p.z.cos()
}

/// Waves of different lengths along each axis; no wave ends at the boundary.
fn waves(p: DVec3) -> f64 {
    (4.1 * p.x + 0.3).sin() * (3.3 * p.y - 0.2).cos() * (0.7 * p.z).exp()
}

fn waves_gradient(p: DVec3) -> DVec3 {
    let ((sine, cosine), growth) = ((4.1 * p.x + 0.3).sin_cos(), (0.7 * p.z).exp());
    let (up, across) = (3.3 * p.y - 0.2).sin_cos();
    DVec3::new(4.1 * cosine * across, -3.3 * sine * up, 0.7 * sine * across) * growth
}

const SUMMIT: DVec3 = DVec3::new(0.45, 0.55, 0.6);
const WIDTH: f64 = 0.28;

/// A Gaussian peak within the cube.
fn peak(p: DVec3) -> f64 {
    (-(p - SUMMIT).length_squared() / (2.0 * WIDTH * WIDTH)).exp()
}

fn peak_gradient(p: DVec3) -> DVec3 {
    (SUMMIT - p) * (peak(p) / (WIDTH * WIDTH))
}

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
    /// The distorted one with two planes of points at the same positions, as contact elements have: flat cells between them, and edges
    /// without length.
    Coincident,
}

impl Mesh {
    /// Families on which filters converge.
    pub const ALL: [Mesh; 4] = [Mesh::Regular, Mesh::Distorted, Mesh::Stretched, Mesh::Anisotropic];

    /// Families on which filters are exact.
    pub const EXACT: [Mesh; 5] =
        [Mesh::Regular, Mesh::Distorted, Mesh::Stretched, Mesh::Anisotropic, Mesh::Coincident];

    pub fn name(self) -> &'static str {
        ["regular", "distorted", "stretched", "anisotropic", "coincident"][self as usize]
    }

    /// With `count` boxes a side.
    pub fn grid(self, count: usize) -> Meshed {
        let jitter = if self == Mesh::Regular { 0.0 } else { JITTER };
        if self == Mesh::Coincident {
            return coincident(count);
        }
        let grid = box_of_tetrahedra([count; 3], [DVec3::ZERO, DVec3::ONE], jitter);
        let at_boundary = (0..grid.points.len()).map(|p| on_surface(p, [count; 3])).collect();
        let place: &dyn Fn(DVec3) -> DVec3 = match self {
            Mesh::Regular | Mesh::Distorted | Mesh::Coincident => &|p| p,
            Mesh::Stretched => &|p| DVec3::new(p.x, p.y, p.z * FLAT),
            Mesh::Anisotropic => {
                let turn = out_of_axes();
                &move |p| {
                    let layer = ((p.z * THIN.ln()).exp() - 1.0) / (THIN - 1.0);
                    turn * (DVec3::new(p.x, p.y, layer) - DVec3::splat(0.5)) + DVec3::splat(0.5)
                }
            }
        };
        Meshed { grid: Grid { points: sample(&grid, place).into(), ..grid }, at_boundary }
    }
}

/// A grid, and which of its points lie on its boundary.
pub(super) struct Meshed {
    pub grid: Grid,
    /// One flag a point.
    pub at_boundary: Vec<bool>,
}

/// Pairs of points that share an edge and a position.
pub(super) fn coincident_pairs(grid: &Grid) -> usize {
    let neighbours = points_of_points(grid, &cells_of_points(grid));
    let is_twin = |p: usize, q: &&u32| (**q as usize) > p && grid.points[p] == grid.points[**q as usize];
    (0..grid.points.len()).map(|p| neighbours.row(p).iter().filter(|q| is_twin(p, q)).count()).sum()
}

/// Largest move as a fraction of the spacing; up to a quarter no cell turns over.
const JITTER: f64 = 0.2;
const FLAT: f64 = 0.1;
const THIN: f64 = 30.0;

pub(super) fn out_of_axes() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7)
}

/// The distorted grid with one layer of boxes more along x, which has no thickness.
fn coincident(count: usize) -> Meshed {
    let counts = [count + 1, count, count];
    let grid = box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], JITTER);
    let (side, layer) = (count + 2, count / 2);
    let mut points = grid.points.to_vec();
    for (p, point) in points.iter_mut().enumerate() {
        // In spacings; the planes beside the layer are even, so that its cells are flat to the last digit.
        point.x = match p % side {
            i if i == layer || i == layer + 1 => layer as f64,
            i => point.x * counts[0] as f64 - if i > layer { 1.0 } else { 0.0 },
        } / count as f64;
    }
    let twins = (0..points.len()).filter(|p| p % side == layer + 1);
    twins.for_each(|p| points[p] = points[p - 1]);
    let at_boundary = (0..points.len()).map(|p| on_surface(p, counts)).collect();
    Meshed { grid: Grid { points: points.into(), ..grid }, at_boundary }
}

/// True if point `p` of a box of that many boxes, x fastest, lies on its surface.
fn on_surface(p: usize, counts: [usize; 3]) -> bool {
    let [x, y, _] = counts.map(|count| count + 1);
    let place = [p % x, p / x % y, p / (x * y)];
    place.iter().zip(counts).any(|(&k, count)| k == 0 || k == count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::grid::tetrahedron_volume;

    /// By central differences at places away from the meeting of materials.
    #[test]
    fn gradients_are_those_of_the_values() {
        let step = 1e-5;
        for field in SMOOTH.into_iter().chain([LINEAR, QUADRATIC, MATERIALS]) {
            for p in [DVec3::new(0.1, 0.7, 0.4), DVec3::new(0.9, 0.2, 0.8)] {
                let slope = |axis: DVec3| {
                    ((field.value)(p + axis * step) - (field.value)(p - axis * step)) / (2.0 * step)
                };
                let found = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
                let off = (found - (field.gradient)(p)).length();
                assert!(off < 1e-8 * (1.0 + found.length()), "{}: off by {off:e} at {p}", field.name);
            }
        }
    }

    #[test]
    fn neighbours_of_the_coincident_grid_lie_at_the_same_positions() {
        let Meshed { grid, at_boundary } = Mesh::Coincident.grid(4);
        assert_eq!(coincident_pairs(&grid), 5 * 5);
        let corners = |t: &[u32; 4]| t.map(|p| grid.points[p as usize]);
        let volumes: Vec<f64> = grid.tetrahedra.iter().map(|t| tetrahedron_volume(corners(t))).collect();
        assert!(volumes.iter().all(|v| *v == 0.0 || *v > 1e-4), "{volumes:?}");
        assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-2);
        assert_eq!(at_boundary.iter().filter(|at| !**at).count(), 4 * 3 * 3);
        assert_eq!(coincident_pairs(&Mesh::Distorted.grid(4).grid), 0);
    }

    #[test]
    fn no_cell_turns_over_and_the_volume_is_that_of_the_box() {
        for mesh in Mesh::ALL {
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
