//! RandomReport grids of up to some hundred cells, and the fields on them.

use super::rng::Rng;
use glam::{DQuat, DVec3};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::SharedSlice;
use voltet_core::field::{Method, VolumeWeighted, magnitude};
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::grid::{Array, Grid};
use voltet_core::progress::NoProgress;
use voltet_core::volume::Volume;

/// Names of the further fields, and of one that is nowhere negative.
pub(super) const FIELDS: [&str; 2] = ["a", "b"];
pub(super) const MAGNITUDE: &str = "m";

/// A grid with s, ∇s by the volumes of its cells, g, and further fields. Errors: none that a grid of these shapes has.
pub(super) fn volume(rng: &mut Rng) -> Result<Volume> {
    let unit = grid(rng);
    let scalar = field(rng, &unit);
    let wave = |rng: &mut Rng| (3.0 * rng.direction(), rng.between(0.0, 6.0));
    let (a, b, m) = (wave(rng), wave(rng), wave(rng));
    let one = |(along, phase): (DVec3, f64)| sample(&unit, move |p| (along.dot(p) + phase).sin());
    let array = |values: Vec<f64>| Arc::new(Array { component_count: 1, values: values.into() });
    let mut grid = placed(rng, &unit);
    grid.point_arrays.insert(FIELDS[0].into(), array(one(a)));
    grid.point_arrays.insert(FIELDS[1].into(), array(one(b)));
    grid.point_arrays.insert(MAGNITUDE.into(), array(one(m).iter().map(|x| x.abs() + 0.1).collect()));
    let gradient =
        Method::with_defaults(Arc::new(VolumeWeighted))?.gradient(&grid, &scalar, &NoProgress)?.vectors;
    Ok(Volume {
        gradient_magnitude: Some(SharedSlice::from(magnitude(&gradient))),
        gradient: Some(SharedSlice::from(gradient)),
        scalar: SharedSlice::from(scalar),
        grid: Arc::new(grid),
    })
}

/// In the unit cube.
fn grid(rng: &mut Rng) -> Grid {
    let unit = [DVec3::ZERO, DVec3::ONE];
    let counts = [1 + rng.pick(4), 1 + rng.pick(4), 1 + rng.pick(4)];
    let jitter = if rng.chance(0.7) { rng.between(0.0, 0.25) } else { 0.0 };
    let cube = || box_of_tetrahedra(counts, unit, jitter);
    match rng.pick(8) {
        // Each cell cut into four about a point within, at times close to a corner.
        0 => {
            let (whole, shares) = (cube(), [0.25, rng.power(-6.0, -0.7)]);
            let (mut points, mut cells) = (whole.points.to_vec(), Vec::new());
            for &[a, b, c, d] in whole.tetrahedra.iter() {
                let centre = points.len() as u32;
                let corners = [a, b, c, d].map(|p| points[p as usize]);
                let near = shares[rng.pick(2)];
                points.push(corners[0] * (1.0 - 3.0 * near) + near * (corners[1] + corners[2] + corners[3]));
                cells.extend([[a, b, c, centre], [a, b, d, centre], [a, c, d, centre], [b, c, d, centre]]);
            }
            Grid { points: points.into(), tetrahedra: cells.into(), ..Grid::default() }
        }
        // Holes, and pieces that do not touch.
        1 => {
            let share = rng.between(0.3, 0.9);
            let whole = cube();
            let mut cells = whole.tetrahedra.to_vec();
            cells.retain(|_| rng.chance(share));
            let cells = if cells.is_empty() { whole.tetrahedra.to_vec() } else { cells };
            Grid { tetrahedra: cells.into(), ..whole }
        }
        // A layer of slivers across one axis.
        2 => {
            let (axis, thin) = (rng.pick(3), rng.power(-9.0, -1.0));
            moved(&box_of_tetrahedra(counts, unit, 0.0), |mut p| {
                p[axis] = if p[axis] < 0.5 { p[axis] } else { 0.5 + thin * (p[axis] - 0.5) };
                p
            })
        }
        // Twisted and sheared.
        3 => {
            let (twist, shear) = (rng.between(-2.0, 2.0), rng.between(-1.0, 1.0));
            moved(&cube(), |p| {
                let q = DQuat::from_rotation_z(twist * p.z) * (p - 0.5);
                q + 0.5 + DVec3::new(shear * q.y, 0.0, 0.0)
            })
        }
        // A lattice whose planes are nearly, but not quite, even.
        4 => {
            let least = rng.power(-12.0, -3.0);
            let regular = box_of_tetrahedra(counts, unit, 0.0);
            let shifts: Vec<DVec3> = regular.points.iter().map(|_| rng.place(-least, least)).collect();
            let points = regular.points.iter().zip(shifts).map(|(p, shift)| *p + shift).collect();
            Grid { points, ..regular }
        }
        // Few cells at random places, which may overlap.
        5 => {
            let count = 1 + rng.pick(3);
            let points: Vec<DVec3> = (0..4 * count).map(|_| rng.place(0.0, 1.0)).collect();
            let cells =
                (0..count as u32).map(|k| [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]).collect::<Vec<_>>();
            Grid { points: points.into(), tetrahedra: cells.into(), ..Grid::default() }
        }
        _ => cube(),
    }
}

/// The grid where it stands in the world: scaled, stretched, far from the origin.
fn placed(rng: &mut Rng, unit: &Grid) -> Grid {
    let scale = if rng.chance(0.3) { rng.power(-6.0, 6.0) } else { 1.0 };
    let mut stretch = DVec3::splat(scale);
    if rng.chance(0.2) {
        stretch[rng.pick(3)] *= rng.power(-3.0, 0.0);
    }
    let turn = match rng.chance(0.5) {
        true => DQuat::from_axis_angle(rng.direction(), rng.between(0.0, 3.0)),
        false => DQuat::IDENTITY,
    };
    let offset = if rng.chance(0.15) { scale * rng.power(0.0, 8.0) * rng.direction() } else { DVec3::ZERO };
    moved(unit, |p| turn * (stretch * (p - 0.5)) + offset)
}

/// The grid with its points moved, or as it was where that would turn cells over: cells that lie over each other and begin
/// in a face that they share have no order.
fn moved(grid: &Grid, place: impl Fn(DVec3) -> DVec3) -> Grid {
    let points = sample(grid, place);
    let side = |points: &[DVec3], cell: &[u32; 4]| {
        let [a, b, c, d] = cell.map(|p| points[p as usize]);
        (b - a).cross(c - a).dot(d - a) > 0.0
    };
    let turned = grid.tetrahedra.iter().any(|cell| side(&points, cell) != side(&grid.points, cell));
    if turned { grid.clone() } else { Grid { points: points.into(), ..grid.clone() } }
}

/// s at the points: smooth, linear, a steep step, constant, noise; of any size and offset.
fn field(rng: &mut Rng, unit: &Grid) -> Vec<f64> {
    let (along, phase) = (rng.direction(), rng.between(0.0, 6.0));
    let steep = rng.power(0.5, 3.0);
    let values: Vec<f64> = match rng.pick(8) {
        0 => sample(unit, |p| along.dot(p)),
        1 => sample(unit, |p| (steep * along.dot(p - 0.5)).tanh()),
        2 => unit.points.iter().map(|_| rng.between(0.0, 1.0)).collect(),
        3 if rng.chance(0.3) => vec![phase; unit.points.len()],
        _ => sample(unit, |p| (3.0 * along.dot(p) + phase).sin() + 0.5 * (2.0 * p.z - p.x).cos()),
    };
    let (scale, offset) = match rng.pick(8) {
        0 => (rng.power(-20.0, 20.0), 0.0),
        1 => (1e-2, 1e8),
        2 => (1.0, rng.between(-100.0, 100.0)),
        _ => (1.0, 0.0),
    };
    values.iter().map(|x| scale * x + offset).collect()
}
