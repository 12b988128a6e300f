//! Random scenes in special positions, which those of general position hardly ever meet: rays along faces and edges, an eye on a
//! vertex, thin layers, near planes far away, values whose offset takes most digits.

use super::general::{self, Axis, Rng, up};
use glam::DVec3;
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::extent::bounds;
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::grid::{CellSet, Cells, Grid, Options, RawGrid, build};
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Region, TransferFunction, Widget};
use voltet_optics::scene::Scene;

const KINDS: [fn(&mut Rng) -> Result<Scene>; 10] = [
    along_an_axis,
    through_a_keyhole,
    delaunay_in_parallel,
    lit_at_an_offset,
    graded_with_steps,
    constant_from_a_vertex,
    slivers_by_fields,
    grazing,
    cut_far_away,
    stiff,
];

/// The scene of a number: its kind goes round.
pub(super) fn scene(seed: u64, number: u64) -> Result<Scene> {
    let mut rng = Rng::new(!seed, number);
    KINDS[(number % KINDS.len() as u64) as usize](&mut rng)
}

const UNIT: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];

/// With everything that a kind does not set as in general position.
fn scene_of(rng: &mut Rng, grid: Grid, scalar: Vec<f64>) -> Result<Scene> {
    general::scene_of(rng, grid, scalar, |_, grid| grid.clone())
}

fn with_look(scene: Scene, change: impl FnOnce(&mut TransferFunction)) -> Scene {
    let mut look = (*scene.transfer_function).clone();
    change(&mut look);
    Scene { transfer_function: Arc::new(look), ..scene }
}

fn perspective(rng: &mut Rng, eye: DVec3, towards: DVec3, fov_y: f64) -> Camera {
    Camera {
        eye,
        target: eye + towards,
        up: up(towards),
        projection: Projection::Perspective { fov_y },
        near: 0.0,
        size: [9 + rng.pick(24) as u32, 9 + rng.pick(24) as u32],
        samples: 1,
    }
}

/// Hexahedra, each as it is or as two wedges or as six pyramids about its centre.
fn mixed_cells(rng: &mut Rng, [nx, ny, nz]: [usize; 3]) -> Result<Grid> {
    let number = |i: usize, j: usize, k: usize| (i + (nx + 1) * (j + (ny + 1) * k)) as u32;
    let mut points = Vec::new();
    for k in 0..=nz {
        for j in 0..=ny {
            points.extend(
                (0..=nx)
                    .map(|i| DVec3::new(i as f64 / nx as f64, j as f64 / ny as f64, k as f64 / nz as f64)),
            );
        }
    }
    let mut cells = CellSet::default();
    let mut add = |code: u8, corners: &[u32]| cells.push(code, corners.iter().copied());
    for cell in 0..nx * ny * nz {
        let (i, j, k) = (cell % nx, cell / nx % ny, cell / (nx * ny));
        let p: [u32; 8] = std::array::from_fn(|c| number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
        match rng.pick(4) {
            0 => {}
            1 => {
                add(13, &[p[0], p[1], p[2], p[4], p[5], p[6]]);
                add(13, &[p[1], p[3], p[2], p[5], p[7], p[6]]);
            }
            2 => {
                let top = points.len() as u32;
                points.push(0.5 * (points[p[0] as usize] + points[p[7] as usize]));
                let sides =
                    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
                sides.iter().for_each(|side| add(14, &[side.map(|c| p[c]).as_slice(), &[top]].concat()));
            }
            _ => add(12, &[p[0], p[1], p[3], p[2], p[4], p[5], p[7], p[6]]),
        }
    }
    if cells.types.is_empty() {
        return Ok(box_of_tetrahedra([nx, ny, nz], UNIT, 0.0));
    }
    let grid = build(RawGrid::new(points, Cells::Mixed(cells)), &Options::default(), &NoProgress)?;
    Ok(Grid { source_cells: None, ..grid })
}

/// From a vertex, or from the middle of an edge, of a lattice with holes, along an axis: whole rows of rays lie in faces.
fn along_an_axis(rng: &mut Rng) -> Result<Scene> {
    let counts = rng.counts();
    let grid = match rng.chance(0.5) {
        true => mixed_cells(rng, counts)?,
        false => general::thinned(rng, box_of_tetrahedra(counts, UNIT, 0.0), 0.7),
    };
    let scalar = general::field(rng, &grid);
    let towards = rng.axis();
    let place = |rng: &mut Rng| {
        let step = |n: usize, rng: &mut Rng| (rng.pick(2 * n + 5) as f64 - 2.0) / (2 * n) as f64;
        DVec3::new(step(counts[0], rng), step(counts[1], rng), step(counts[2], rng))
    };
    let eye = place(rng);
    let fov_y = [90.0, rng.between(20.0, 150.0)][rng.pick(2)];
    let camera = perspective(rng, eye, towards, fov_y);
    Ok(Scene { camera, ..scene_of(rng, grid, scalar)? })
}

/// Cells that overlap, through an angle of a degree and less.
fn through_a_keyhole(rng: &mut Rng) -> Result<Scene> {
    let count = 2 + rng.pick(4);
    let grid = general::loose_cells(rng, count);
    let scalar = general::field(rng, &grid);
    let towards = rng.direction();
    let eye = DVec3::splat(0.5) - rng.power(-1.0, 2.0) * towards;
    let fov_y = rng.power(-1.0, 0.1);
    let camera = perspective(rng, eye, towards, fov_y);
    Ok(Scene { camera, ..scene_of(rng, grid, scalar)? })
}

/// The tetrahedra of random points whose circumscribed spheres hold no other point.
fn delaunay(rng: &mut Rng) -> Grid {
    let points: Vec<DVec3> = (0..5 + rng.pick(8)).map(|_| rng.place(0.0, 1.0)).collect();
    let n = points.len() as u32;
    let mut cells = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                cells.extend((c + 1..n).map(|d| [a, b, c, d]));
            }
        }
    }
    cells.retain(|cell| {
        let [a, b, c, d] = cell.map(|p| points[p as usize]);
        let (u, v, w) = (b - a, c - a, d - a);
        let to_centre = (u.length_squared() * v.cross(w)
            + v.length_squared() * w.cross(u)
            + w.length_squared() * u.cross(v))
            / (2.0 * u.dot(v.cross(w)));
        (0..n)
            .all(|p| cell.contains(&p) || (points[p as usize] - a - to_centre).length() > to_centre.length())
    });
    Grid { points: points.into(), tetrahedra: cells.into(), ..Grid::default() }
}

/// A linear field over Delaunay's cells, in parallel projection, with regions and a silhouette.
fn delaunay_in_parallel(rng: &mut Rng) -> Result<Scene> {
    let grid = delaunay(rng);
    let along = if rng.chance(0.3) { rng.axis() } else { rng.direction() };
    let scalar = sample(&grid, |p| along.dot(p));
    let mut scene = scene_of(rng, grid, scalar)?;
    let s = Axis::new(&scene.volume.scalar);
    scene = with_look(scene, |look| {
        for widget in &mut look.widgets {
            widget.region = Some(Region::rectangle(s.interval(rng), [f64::NEG_INFINITY, f64::INFINITY]));
        }
    });
    scene.shading.silhouette = Some(rng.power(-0.5, 0.8));
    scene.camera.projection = Projection::Orthographic { height: rng.between(0.3, 2.0) };
    // At times all is seen face on.
    if rng.chance(0.3) {
        scene.camera.eye = scene.camera.target - along;
        scene.camera.up = up(along);
    }
    Ok(scene)
}

/// A slightly uneven lattice with values, points or both near 1e8 that vary by 1e-2, lit.
fn lit_at_an_offset(rng: &mut Rng) -> Result<Scene> {
    let (counts, jitter) = (rng.counts(), rng.power(-12.0, -1.0));
    let grid = box_of_tetrahedra(counts, UNIT, jitter);
    let offset = if rng.chance(0.7) { 1e8 } else { 0.0 };
    let along = 4.0 * rng.direction();
    let scalar = sample(&grid, |p| offset + 1e-2 * along.dot(p).sin());
    let far = if rng.chance(0.3) { rng.power(3.0, 8.0) * rng.direction() } else { DVec3::ZERO };
    let grid = Grid { points: sample(&grid, |p| p + far).into(), ..grid };
    let mut scene = scene_of(rng, grid, scalar)?;
    scene.shading.light = rng.chance(0.7).then(|| rng.light());
    Ok(scene)
}

/// Layers that grow by a factor, values that jump, a silhouette.
fn graded_with_steps(rng: &mut Rng) -> Result<Scene> {
    let counts = [2 + rng.pick(4), 1 + rng.pick(3), 1 + rng.pick(3)];
    let growth = rng.between(1.2, 10.0);
    let graded = |x: f64, n: usize| (growth.powf(x * n as f64) - 1.0) / (growth.powi(n as i32) - 1.0);
    let lattice = box_of_tetrahedra(counts, UNIT, 0.0);
    let points = sample(&lattice, |p| DVec3::new(graded(p.x, counts[0]), graded(p.y, counts[1]), p.z));
    let grid = Grid { points: points.into(), ..lattice };
    let scalar = general::field(rng, &grid);
    let mut scene = scene_of(rng, grid, scalar)?;
    let s = Axis::new(&scene.volume.scalar);
    scene = with_look(scene, |look| {
        let (place, width) = (s.value(rng), s.range * rng.power(-6.0, -2.0));
        let [low, high] = [rng.color(), rng.color()];
        let dense = rng.power(0.0, 3.0);
        let points = vec![
            ControlPoint { s: place, color: low, extinction: 0.0 },
            ControlPoint { s: place + width, color: high, extinction: dense },
        ];
        let profile = Profile::PiecewiseLinear { points };
        look.widgets.push(Widget { profile, color: [1.0; 3], extinction: 1.0, region: None });
    });
    scene.shading.silhouette = Some(rng.power(-0.5, 0.8));
    Ok(scene)
}

/// A constant field with a region, at the widest angle, from a vertex.
fn constant_from_a_vertex(rng: &mut Rng) -> Result<Scene> {
    let (counts, jitter) = (rng.counts(), [0.0, 0.2][rng.pick(2)]);
    let grid = box_of_tetrahedra(counts, UNIT, jitter);
    let value = [1.0, 0.0, 1e8, rng.between(-1.0, 1.0)][rng.pick(4)];
    let scalar = vec![value; grid.points.len()];
    let eye = grid.points[rng.pick(grid.points.len())];
    let towards = if rng.chance(0.5) { rng.axis() } else { rng.direction() };
    let fov_y = [170.0, rng.between(140.0, 178.0)][rng.pick(2)];
    let camera = perspective(rng, eye, towards, fov_y);
    let scene = with_look(scene_of(rng, grid, scalar)?, |look| {
        let low = if rng.chance(0.3) { value } else { value - rng.power(-3.0, 0.0) };
        let region = Region::rectangle([low, value + 0.5], [f64::NEG_INFINITY, f64::INFINITY]);
        look.widgets[0] = Widget {
            profile: Profile::Uniform,
            color: rng.color(),
            extinction: rng.power(-1.0, 2.0),
            region: Some(region),
        };
    });
    Ok(Scene { camera, ..scene })
}

/// A lattice squeezed across an axis.
fn thin(rng: &mut Rng, jitter: f64) -> (Grid, usize, f64) {
    let (counts, across, thickness) = (rng.counts(), rng.pick(3), rng.power(-6.0, -1.0));
    let grid = box_of_tetrahedra(counts, UNIT, jitter);
    let mut points = grid.points.to_vec();
    points.iter_mut().for_each(|p| p[across] = 0.5 + thickness * (p[across] - 0.5));
    (Grid { points: points.into(), ..grid }, across, thickness)
}

/// Slivers, drawn by a Gaussian over further fields.
fn slivers_by_fields(rng: &mut Rng) -> Result<Scene> {
    let (grid, _, thickness) = thin(rng, 0.1);
    let scalar = general::field(rng, &grid);
    let scene = scene_of(rng, grid, scalar)?;
    let axes: Vec<Axis> =
        general::FIELDS.map(|name| Axis::new(&scene.volume.grid.point_arrays[name].values)).into();
    Ok(with_look(scene, |look| {
        let centre = axes.iter().map(|axis| axis.value(rng)).collect();
        let [a, b] = [0, 1].map(|k| FRAC_1_SQRT_2 / axes[k].width(rng));
        let matrix = vec![vec![a, rng.between(-1.0, 1.0) * b], vec![0.0, b]];
        let profile =
            Profile::GaussianNd { fields: general::FIELDS.map(String::from).to_vec(), centre, matrix };
        look.widgets[0] =
            Widget { profile, color: rng.color(), extinction: rng.power(0.0, 2.0), region: None };
        look.unit_distance = [thickness, 1.0][rng.pick(2)];
    }))
}

/// Along a thin layer, seen from its edge.
fn grazing(rng: &mut Rng) -> Result<Scene> {
    let jitter = [0.0, 0.1][rng.pick(2)];
    let (grid, across, thickness) = thin(rng, jitter);
    let scalar = general::field(rng, &grid);
    let mut towards = rng.direction();
    towards[across] = rng.between(-2.0, 2.0) * thickness;
    let towards = towards.normalize_or(DVec3::AXES[(across + 1) % 3]);
    let centre = DVec3::splat(0.5);
    let distance = rng.between(0.0, 10.0);
    let mut camera = perspective(rng, centre - distance * towards, towards, 30.0);
    let filled = thickness * rng.power(0.0, 2.0);
    camera.up = DVec3::AXES[across];
    camera.projection = match rng.chance(0.5) {
        true => Projection::Orthographic { height: filled },
        false => {
            Projection::Perspective { fov_y: (filled / distance.max(0.1)).to_degrees().clamp(1e-3, 120.0) }
        }
    };
    Ok(Scene { camera, ..scene_of(rng, grid, scalar)? })
}

/// From far away, cut by a near plane.
fn cut_far_away(rng: &mut Rng) -> Result<Scene> {
    let (counts, jitter) = (rng.counts(), [0.0, 0.2][rng.pick(2)]);
    let grid = box_of_tetrahedra(counts, UNIT, jitter);
    let scalar = general::field(rng, &grid);
    let [low, high] = bounds(&grid.points).unwrap_or_default();
    let towards = if rng.chance(0.25) { rng.axis() } else { rng.direction() };
    let distance = rng.power(1.0, 6.0);
    let eye = low.midpoint(high) - distance * towards;
    let fov_y = (rng.between(0.5, 2.0) / distance).to_degrees();
    let mut camera = perspective(rng, eye, towards, fov_y);
    camera.target = low.midpoint(high);
    camera.near = distance + rng.between(-0.6, 0.6);
    Ok(Scene { camera, ..scene_of(rng, grid, scalar)? })
}

/// Extinctions of 1e5 and far beyond.
fn stiff(rng: &mut Rng) -> Result<Scene> {
    let grid = general::grid(rng);
    let scalar = general::field(rng, &grid);
    let scene = scene_of(rng, grid, scalar)?;
    Ok(with_look(scene, |look| {
        look.model = OpticalModel::DensityEmitter;
        look.widgets.iter_mut().for_each(|widget| widget.extinction *= rng.power(4.0, 11.0));
    }))
}
