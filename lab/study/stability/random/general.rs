//! Random scenes in general position: a grid of up to some hundred cells, fields on it, a transfer function over their values, shading
//! and a camera. All follow from a seed and the scene's number alone.

use glam::{DQuat, DVec3};
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::field::{Method, VolumeWeighted, magnitude};
use voltet_core::grid::extent::bounds;
use voltet_core::grid::generate::{Random, box_of_tetrahedra, sample};
use voltet_core::grid::{Array, Grid};
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_core::volume::Volume;
use voltet_core::{Result, SharedSlice};
use voltet_optics::WidgetBlend;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};

/// The scene of a number.
pub(super) fn scene(seed: u64, number: u64) -> Result<Scene> {
    let mut rng = Rng::new(seed, number);
    let unit = grid(&mut rng);
    let scalar = field(&mut rng, &unit);
    scene_of(&mut rng, unit, scalar, placed)
}

/// A scene of a grid with the scalar at its points, where `place` puts it. Errors: none that a grid of these shapes has.
pub(super) fn scene_of(
    rng: &mut Rng,
    unit: Grid,
    scalar: Vec<f64>,
    place: impl FnOnce(&mut Rng, &Grid) -> Grid,
) -> Result<Scene> {
    let volume = volume(rng, &unit, scalar, place)?;
    let bounds = bounds(&volume.grid.points).unwrap_or_default();
    let transfer_function = Arc::new(look(rng, &volume, bounds[0].distance(bounds[1])));
    let shading = shading(rng);
    let camera = camera(rng, bounds);
    Ok(Scene::new(Arc::new(volume), transfer_function, camera, shading, VisibilityOrder::Exact))
}

pub(super) struct Rng(Random);

impl Rng {
    /// Random numbers of one scene: neighbours' numbers have nothing to do with each other.
    pub(super) fn new(seed: u64, scene: u64) -> Rng {
        // Steele, Lea & Flood 2014, the finaliser of SplitMix64.
        let mut z = (seed << 32 ^ scene).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        Rng(Random((z ^ z >> 31) | 1))
    }

    /// In [low, high).
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.next()
    }

    /// 10 to a power in [low, high).
    pub(super) fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    /// One of 0 … n − 1.
    pub(super) fn pick(&mut self, n: usize) -> usize {
        ((self.0.next() * n as f64) as usize).min(n - 1)
    }

    /// True if something of this probability happens.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.next() < probability
    }

    /// In the cube [low, high)³.
    pub(super) fn place(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::new(self.between(low, high), self.between(low, high), self.between(low, high))
    }

    /// A unit vector, each as likely.
    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let place = self.place(-1.0, 1.0);
            if (0.01..=1.0).contains(&place.length_squared()) {
                return place.normalize();
            }
        }
    }

    /// Boxes along the axes.
    pub(super) fn counts(&mut self) -> [usize; 3] {
        [1 + self.pick(4), 1 + self.pick(4), 1 + self.pick(4)]
    }

    /// An axis, of either sense.
    pub(super) fn axis(&mut self) -> DVec3 {
        DVec3::AXES[self.pick(3)] * if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Light from anywhere.
    pub(super) fn light(&mut self) -> Light {
        Light { direction: self.direction(), ambient: 0.3, diffuse: 0.7 }
    }

    /// Linear RGB, some of it above 1.
    pub(super) fn color(&mut self) -> [f64; 3] {
        self.place(0.0, 1.2).to_array()
    }
}

/// Names of the further fields, and of one that is nowhere negative.
pub(super) const FIELDS: [&str; 2] = ["a", "b"];
const MAGNITUDE: &str = "m";

/// A grid with s, ∇s by the volumes of its cells, g, and further fields. Errors: none that a grid of these shapes has.
fn volume(
    rng: &mut Rng,
    unit: &Grid,
    scalar: Vec<f64>,
    place: impl FnOnce(&mut Rng, &Grid) -> Grid,
) -> Result<Volume> {
    let wave = |rng: &mut Rng| (3.0 * rng.direction(), rng.between(0.0, 6.0));
    let (a, b, m) = (wave(rng), wave(rng), wave(rng));
    let one = |(along, phase): (DVec3, f64)| sample(unit, move |p| (along.dot(p) + phase).sin());
    let array = |values: Vec<f64>| Arc::new(Array { component_count: 1, values: values.into() });
    let mut grid = place(rng, unit);
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
pub(super) fn grid(rng: &mut Rng) -> Grid {
    let unit = [DVec3::ZERO, DVec3::ONE];
    let counts = rng.counts();
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
            thinned(rng, cube(), share)
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
            loose_cells(rng, count)
        }
        _ => cube(),
    }
}

/// A grid with about this share of its cells, or all where that leaves none.
pub(super) fn thinned(rng: &mut Rng, whole: Grid, share: f64) -> Grid {
    let mut cells = whole.tetrahedra.to_vec();
    cells.retain(|_| rng.chance(share));
    if cells.is_empty() { whole } else { Grid { tetrahedra: cells.into(), ..whole } }
}

/// Cells at random places, which may overlap.
pub(super) fn loose_cells(rng: &mut Rng, count: usize) -> Grid {
    let points = (0..4 * count).map(|_| rng.place(0.0, 1.0)).collect();
    let tetrahedra = (0..count as u32).map(|k| [0, 1, 2, 3].map(|c| 4 * k + c)).collect();
    Grid { points, tetrahedra, ..Grid::default() }
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
pub(super) fn field(rng: &mut Rng, unit: &Grid) -> Vec<f64> {
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

/// A value that the data have, and how far they range; where they do not, the size of the value, or 1.
pub(super) struct Axis {
    pub(super) values: Vec<f64>,
    pub(super) range: f64,
}

impl Axis {
    pub(super) fn new(values: &[f64]) -> Axis {
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
        // A range of rounding errors is none.
        let range = if high - low > 1e-11 * high.abs().max(low.abs()) { high - low } else { high.abs() };
        Axis { values: values.to_vec(), range: if range > 0.0 { range } else { 1.0 } }
    }

    pub(super) fn value(&self, rng: &mut Rng) -> f64 {
        self.values[rng.pick(self.values.len())] + self.range * rng.between(-0.1, 0.1)
    }

    /// Mostly what one would choose, at times down to a millionth of the range.
    pub(super) fn width(&self, rng: &mut Rng) -> f64 {
        self.range * if rng.chance(0.75) { rng.power(-1.5, 0.3) } else { rng.power(-6.0, -1.5) }
    }

    pub(super) fn interval(&self, rng: &mut Rng) -> [f64; 2] {
        let (a, b) = (self.value(rng), self.value(rng));
        [a.min(b), a.max(b) + 1e-3 * self.range]
    }
}

/// One to three widgets of any kind.
fn look(rng: &mut Rng, volume: &Volume, size: f64) -> TransferFunction {
    let model = match rng.chance(0.25) {
        true => OpticalModel::ConstantEmitter { cutoff: rng.power(-3.0, -1.0) },
        false => OpticalModel::DensityEmitter,
    };
    let g = volume.gradient_magnitude.as_deref().map_or(&[][..], |g| g);
    let axes = [Axis::new(&volume.scalar), Axis::new(g)];
    let widgets = (0..1 + rng.pick(3)).map(|_| widget(rng, volume, &axes)).collect();
    TransferFunction { model, unit_distance: size * rng.power(-2.0, 0.3), widgets, axes: Default::default() }
}

fn widget(rng: &mut Rng, volume: &Volume, axes: &[Axis; 2]) -> Widget {
    let [s, g] = axes;
    let extinction = if rng.chance(0.85) { rng.power(-1.0, 2.0) } else { rng.power(-9.0, 9.0) };
    let profile = profile(rng, volume, axes, extinction);
    let region = match rng.pick(4) {
        0 => Some(Region::rectangle(s.interval(rng), g.interval(rng))),
        // Three corners, counter-clockwise.
        1 => {
            let ([a, b], [c, d]) = (s.interval(rng), g.interval(rng));
            Some(Region { corners: vec![[a, c], [b, c + 0.3 * (d - c)], [a + 0.4 * (b - a), d]] })
        }
        _ if profile == Profile::Uniform => {
            Some(Region::rectangle(s.interval(rng), [f64::NEG_INFINITY, f64::INFINITY]))
        }
        _ => None,
    };
    Widget { profile, color: rng.color(), extinction, region }
}

fn profile(rng: &mut Rng, volume: &Volume, [s, g]: &[Axis; 2], extinction: f64) -> Profile {
    let root_half = std::f64::consts::FRAC_1_SQRT_2;
    match rng.pick(10) {
        0 => Profile::Uniform,
        1 | 2 => {
            let (a, b, tilt) = (root_half / s.width(rng), root_half / g.width(rng), rng.between(-1.0, 1.0));
            let tilt = if rng.chance(0.5) { tilt } else { 0.0 };
            Profile::Gaussian { centre: [s.value(rng), g.value(rng)], matrix: [[a, tilt * b], [0.0, b]] }
        }
        3 => Profile::TriangularGaussian {
            centre: s.value(rng),
            sigma: s.width(rng) / g.values.iter().fold(1e-3 * g.range, |a, &b| a.max(b)),
        },
        4 | 5 => {
            let wave = Wave {
                origin: [s.value(rng), g.value(rng)],
                angle: if rng.chance(0.5) { 0.0 } else { rng.between(0.0, 6.3) },
                scale: [1.0 / s.range, 1.0 / g.range],
                period: rng.power(-1.5, 0.5),
                band_width: if rng.chance(0.5) { 1.0 } else { rng.power(-2.0, 0.0) },
            };
            if rng.chance(0.5) { Profile::TriangleWave(wave) } else { Profile::SineWave(wave) }
        }
        6 | 7 => {
            let mut places: Vec<f64> = (0..1 + rng.pick(5)).map(|_| s.value(rng)).collect();
            places.sort_by(f64::total_cmp);
            let point = |rng: &mut Rng, s| ControlPoint {
                s,
                color: rng.color(),
                extinction: if rng.chance(0.3) { 0.0 } else { extinction * rng.between(0.0, 1.0) },
            };
            Profile::PiecewiseLinear { points: places.into_iter().map(|s| point(rng, s)).collect() }
        }
        8 => {
            let (width, height) = (2 + rng.pick(7), 1 + rng.pick(6));
            let texel = |rng: &mut Rng| {
                let [r, g, b] = rng.color().map(|x| x as f32);
                [r, g, b, if rng.chance(0.3) { 0.0 } else { rng.between(0.0, 1.0) as f32 }]
            };
            let texels = (0..width * height).map(|_| texel(rng)).collect();
            Profile::Table(Arc::new(Table { width, height, texels, s: s.interval(rng), g: g.interval(rng) }))
        }
        _ => {
            let fields = FIELDS.map(String::from).to_vec();
            let values = |name: &str| Axis::new(&volume.grid.point_arrays[name].values);
            let axes: Vec<Axis> = FIELDS.iter().map(|name| values(name)).collect();
            let centre = axes.iter().map(|axis| axis.value(rng)).collect();
            let mut matrix: Vec<Vec<f64>> = (0..2)
                .map(|k| (0..2).map(|i| if i == k { root_half / axes[k].width(rng) } else { 0.0 }).collect())
                .collect();
            matrix[0][1] = rng.between(-1.0, 1.0) * matrix[0][0];
            match rng.chance(0.5) {
                true => Profile::GaussianNd { fields, centre, matrix },
                false => {
                    Profile::TriangularGaussianNd { fields, magnitude: MAGNITUDE.into(), centre, matrix }
                }
            }
        }
    }
}

/// Closed forms; at times a mix where widgets overlap, light, a silhouette.
fn shading(rng: &mut Rng) -> Shading {
    Shading {
        integrator: Integrator::ANALYTIC,
        overlap: if rng.chance(0.15) { WidgetBlend::Mix } else { WidgetBlend::Exact },
        silhouette: rng.chance(0.15).then(|| rng.between(0.5, 6.0)),
        light: rng.chance(0.15).then(|| rng.light()),
    }
}

/// From outside or inside, along an axis or not, at angles from 0.01 to 150 degrees, with near planes and several samples.
fn camera(rng: &mut Rng, [low, high]: [DVec3; 2]) -> Camera {
    let (centre, radius) = (low.midpoint(high), 0.5 * low.distance(high));
    let towards = match rng.chance(0.25) {
        true => rng.axis(),
        false => rng.direction(),
    };
    let target = match rng.chance(0.3) {
        true => centre,
        false => centre + 0.4 * radius * rng.place(-1.0, 1.0),
    };
    // How much of the picture's height the grid fills.
    let filled = rng.power(-0.3, 0.5);
    let (projection, distance) = match rng.pick(6) {
        0 | 1 => (Projection::Orthographic { height: 2.0 * radius / filled }, rng.between(0.0, 4.0) * radius),
        2 => (Projection::Perspective { fov_y: rng.between(30.0, 150.0) }, rng.between(0.0, 0.9) * radius),
        _ => {
            let fov_y = if rng.chance(0.25) { rng.power(-2.0, 0.0) } else { rng.between(5.0, 100.0) };
            let half = (0.5 * fov_y).to_radians().tan();
            (Projection::Perspective { fov_y }, radius / (filled * half))
        }
    };
    let eye = target - distance.max(1e-3 * radius) * towards;
    Camera {
        eye,
        target,
        up: up(towards),
        projection,
        near: if rng.chance(0.2) { distance * rng.between(0.2, 1.1) } else { 0.0 },
        size: [8 + rng.pick(24) as u32, 8 + rng.pick(24) as u32],
        samples: if rng.chance(0.1) { 2 + rng.pick(3) as u32 } else { 1 },
    }
}

/// A direction upward in pictures of this direction of view.
pub(super) fn up(towards: DVec3) -> DVec3 {
    if towards.z.abs() > 0.9 { DVec3::Y } else { DVec3::Z }
}
