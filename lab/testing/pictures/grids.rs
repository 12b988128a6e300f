//! Grids that are hard to draw.

use glam::{DQuat, DVec3};
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::grid::Grid;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_core::volume::Volume;

/// The unit cube in tetrahedra.
pub fn cube(counts: [usize; 3], jitter: f64) -> Grid {
    box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], jitter)
}

/// A grid of the given points and cells.
pub fn grid(points: Vec<DVec3>, mut tetrahedra: Vec<[u32; 4]>) -> Grid {
    tetrahedra.iter_mut().for_each(|cell| cell.sort_unstable());
    Grid { points: SharedSlice::from(points), tetrahedra: SharedSlice::from(tetrahedra), ..Grid::default() }
}

/// The grid with every point moved.
pub fn moved(base: &Grid, place: impl Fn(DVec3) -> DVec3) -> Grid {
    grid(base.points.iter().map(|&p| place(p)).collect(), base.tetrahedra.to_vec())
}

/// The cells whose centroid is wanted.
pub fn part(base: &Grid, wanted: impl Fn(DVec3) -> bool) -> Grid {
    let centroid = |c: &[u32; 4]| c.iter().map(|&p| base.points[p as usize]).sum::<DVec3>() / 4.0;
    grid(base.points.to_vec(), base.tetrahedra.iter().copied().filter(|c| wanted(centroid(c))).collect())
}

/// Several grids as one.
pub fn together(parts: &[Grid]) -> Grid {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for part in parts {
        let first = points.len() as u32;
        points.extend_from_slice(&part.points);
        cells.extend(part.tetrahedra.iter().map(|c| c.map(|p| p + first)));
    }
    grid(points, cells)
}

/// Each cell cut into four around its centroid.
pub fn subdivided(base: &Grid) -> Grid {
    let (mut points, mut cells) = (base.points.to_vec(), Vec::new());
    for &[a, b, c, d] in base.tetrahedra.iter() {
        let centre = points.len() as u32;
        points.push([a, b, c, d].iter().map(|&p| base.points[p as usize]).sum::<DVec3>() / 4.0);
        cells.extend([[a, b, c, centre], [a, b, d, centre], [a, c, d, centre], [b, c, d, centre]]);
    }
    grid(points, cells)
}

/// Two arms joined at one end, an opening between them: along most rays through both, something else is between.
pub fn two_arms() -> Grid {
    let base = cube([6, 6, 2], 0.0);
    part(&base, |p| p.x < 1.0 / 3.0 || p.y < 1.0 / 3.0 || p.y > 2.0 / 3.0)
}

/// Three bars around the z axis, each over the next: no order of the bars is right.
pub fn cyclic_bars() -> Grid {
    let bar = |k: i32| {
        let turn = DQuat::from_rotation_z(f64::from(k) * std::f64::consts::TAU / 3.0);
        moved(&cube([1, 1, 1], 0.0), |p| {
            let q = p - 0.5;
            let along = DVec3::new(0.0, 20f64.to_radians().cos(), 20f64.to_radians().sin());
            turn * (DVec3::X * (0.5 + 0.3 * q.x) + along * (3.0 * q.y) + DVec3::Z * (0.25 * q.z))
        })
    };
    together(&[bar(0), bar(1), bar(2)])
}

/// A cube with a layer of cells of the given thickness in the middle, across x.
pub fn with_flat_layer(thickness: f64) -> Grid {
    let base = cube([3, 3, 3], 0.0);
    moved(&base, |p| {
        let layer = (p.x * 3.0).round() as usize;
        DVec3::new([0.0, 0.5, 0.5 + thickness, 1.0][layer], p.y, p.z)
    })
}

/// The unit cube in cells of two sizes, those in the middle half as large: each face between them is one on one side and four on the other.
pub fn refined() -> Grid {
    let is_middle = |p: DVec3| ((p - 0.5).abs().max_element()) < 0.25;
    let around = part(&cube([4, 4, 4], 0.0), |p| !is_middle(p));
    together(&[around, moved(&cube([4, 4, 4], 0.0), |p| 0.25 + 0.5 * p)])
}

/// s and g at every point.
pub fn volume(grid: Grid, s: impl Fn(DVec3) -> f64, g: impl Fn(DVec3) -> f64) -> Arc<Volume> {
    let scalar = grid.points.iter().map(|&p| s(p)).collect();
    let magnitude = grid.points.iter().map(|&p| g(p)).collect();
    Arc::new(Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: Some(magnitude) })
}

/// A smooth field on the unit cube in about [0, 1], and its gradient magnitude, in about [0, 2.5].
pub fn smooth_s(p: DVec3) -> f64 {
    0.5 + 0.25 * (4.0 * p.x + p.y).sin() + 0.25 * (3.0 * p.z - 2.0 * p.y).cos()
}

/// ∇ of [`smooth_s`].
pub fn smooth_gradient(p: DVec3) -> DVec3 {
    let a = 0.25 * (4.0 * p.x + p.y).cos();
    let b = -0.25 * (3.0 * p.z - 2.0 * p.y).sin();
    DVec3::new(4.0 * a, a - 2.0 * b, 3.0 * b)
}

/// |∇| of [`smooth_s`].
pub fn smooth_g(p: DVec3) -> f64 {
    smooth_gradient(p).length()
}

/// The smooth field on a grid.
pub fn smooth(grid: Grid) -> Arc<Volume> {
    volume(grid, smooth_s, smooth_g)
}
