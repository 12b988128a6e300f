//! What the engine leaves out or takes as equal, by numbers that its sources state: each is crossed here.

use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_core::optics::Overlap;
use voltet_core::picture::Picture;
use voltet_core::progress::Silent;
use voltet_core::reference;
use voltet_core::scene::Scene;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_engine::{cull, draw, keep_all};

const SHADING: Shading =
    Shading { integrator: Integrator::Analytic, overlap: Overlap::Exact, silhouette: None, light: None };

/// The unit square seen along an axis, 16 pixels a side: one tile.
fn along(axis: DVec3) -> Camera {
    let centre = DVec3::splat(0.5);
    Camera {
        eye: centre - 5.0 * axis,
        target: centre,
        up: if axis.z == 0.0 { DVec3::Z } else { DVec3::Y },
        projection: Projection::Orthographic { height: 0.99 },
        near: 0.0,
        size: [16, 16],
        samples: 1,
    }
}

/// Where s lies in a range: one density, one colour.
fn uniform(range: [f64; 2], extinction: f64, color: [f64; 3]) -> Widget {
    let region = Some(Region::rectangle(range, [f64::NEG_INFINITY, f64::INFINITY]));
    Widget { profile: Profile::Uniform, color, extinction, region }
}

fn look(widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets }
}

fn volume(grid: Grid, s: impl Fn(&DVec3) -> f64) -> Arc<Volume> {
    let scalar = Arc::new(grid.points.iter().map(s).collect());
    Arc::new(Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: None })
}

fn unit_cube(counts: [usize; 3]) -> Arc<Volume> {
    volume(box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], 0.0), |p| p.x)
}

fn largest_difference(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Cells of a density that is nothing along the longest ray are left out, those that a picture shows are not: no pixel
/// changes by more than 1e-6, whatever the density of all that is culled.
#[test]
fn culling_changes_no_pixel_by_more_than_a_millionth() {
    let (cube, camera) = (unit_cube([4; 3]), along(DVec3::Y));
    let diagonal = 3f64.sqrt();
    for depth in [2e-8, 8e-8, 3e-7, 3e-6, 3e-5, 3e-4, 3e-3] {
        let look = look(vec![uniform([-1.0, 2.0], depth / diagonal, [1.0, 0.5, 0.2])]);
        let culled = cull(&cube, &look, &camera, &Silent).expect("culls");
        // All of it together has a depth of 1e-7 at most.
        assert_eq!(culled.kept.is_empty(), depth < 1e-7, "depth {depth:e}");
        let all = keep_all(&cube, &look, &camera).expect("keeps all");
        let pictures =
            [culled, all].map(|cells| draw(&cells, &look, &camera, &SHADING, &Silent).expect("draws").0);
        let difference = largest_difference(&pictures[0], &pictures[1]);
        assert!(difference <= 1e-6, "depth {depth:e}: a pixel changes by {difference:e}");
    }
}

/// A tile is left where every pixel is opaque, and what is missing of 1 then is under 1e-11: a stack of layers of depth ½,
/// seen from each side, so that some are taken front to back.
#[test]
fn tiles_are_left_where_nothing_is_missing() {
    let mut stopped = 0;
    for (counts, axis) in [([32, 1, 1], DVec3::X), ([1, 32, 1], DVec3::Y), ([1, 1, 32], DVec3::Z)] {
        let (cube, camera) = (unit_cube(counts), along(axis));
        for whole in [16.0, 64.0] {
            let look = look(vec![uniform([-1.0, 2.0], whole, [1.0, 0.5, 0.2])]);
            let cells = cull(&cube, &look, &camera, &Silent).expect("culls");
            let (picture, counts) = draw(&cells, &look, &camera, &SHADING, &Silent).expect("draws");
            // The rounding of 1 − e^(−16) to 32 bits, and of the 32 depths that it is a sum of.
            let exact = -f64::exp_m1(-whole);
            let worst = picture.rgba.iter().map(|p| (f64::from(p[3]) - exact).abs()).fold(0.0, f64::max);
            assert!(worst < 1.5e-7, "depth {whole} along {axis}: off by {worst:e}");
            stopped += u64::from(whole > 25.0) * counts.tiles_stopped;
            assert!(whole > 25.0 || counts.tiles_stopped == 0, "a tile of depth {whole} was left");
        }
    }
    assert!(stopped > 0, "no tile was left");
}

/// Segments whose entries differ by a ten-thousandth are two, in the order of their entries: only what rounding leaves
/// between the entries through one face (3e-7 of them) counts as equal. Two cells, the one within the other's shadow, and a
/// point nearer to the eye, from which depths are counted.
#[test]
fn cells_that_overlap_are_ordered_by_close_entries() {
    let cell = |front: f64, back: f64| {
        [[-1.0, -1.0, front], [3.0, -1.0, front], [-1.0, 3.0, front], [0.4, 0.4, back]].map(DVec3::from_array)
    };
    // The farther entry ends first: taken as equal, they would be ordered by their exits.
    let points = [cell(2.0, 4.0), cell(2.0001, 3.0)].concat();
    let points = [points, vec![DVec3::new(0.5, 0.5, 0.0)]].concat();
    let tetrahedra = Arc::new(vec![[4, 5, 6, 7], [0, 1, 2, 3]]);
    let grid = Grid { points: Arc::new(points), tetrahedra, ..Grid::default() };
    let scalar = Arc::new((0..9).map(|i| if (4..8).contains(&i) { 0.75 } else { 0.25 }).collect());
    let two = Arc::new(Volume { scalar, ..Volume::clone(&volume(grid, |_| 0.0)) });
    let red = uniform([0.0, 0.5], 2.0, [1.0, 0.0, 0.0]);
    let look = look(vec![red, uniform([0.5, 1.0], 2.0, [0.0, 0.0, 1.0])]);
    let camera = along(DVec3::Z);
    let cells = cull(&two, &look, &camera, &Silent).expect("culls");
    let (found, _) = draw(&cells, &look, &camera, &SHADING, &Silent).expect("draws");
    let scene = Scene {
        volume: two,
        transfer_function: Arc::new(look),
        camera,
        shading: SHADING,
        order: Order::Exact,
    };
    let exact = reference::draw(&scene, &Silent).expect("draws");
    let difference = largest_difference(&found, &exact);
    // The wrong order is off by a tenth and more.
    assert!(difference < 2e-4, "off by {difference:e}");
}
