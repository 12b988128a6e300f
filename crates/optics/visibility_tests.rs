//! Orders along faces, held against the crossings of the 64-bit ray tracer, which uses no faces.

use crate::scene::Scene;
use crate::shading::{Integrator, Shading, VisibilityOrder};
use crate::trace::Tracer;
use crate::{CompiledTransferFunction, WidgetBlend};
use glam::{DQuat, DVec3};
use proptest::prelude::*;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::grid::generate::{Random, box_of_tetrahedra};
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::visibility::*;
use voltet_core::volume::Volume;

const SHADING: Shading =
    Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette: None, light: None };

fn tracer(scene: &Scene) -> Tracer<'_> {
    let forms = CompiledTransferFunction::new(&scene.transfer_function).expect("is in range");
    Tracer::new(scene, Box::new(forms)).expect("is in range")
}

fn cube(counts: [usize; 3], jitter: f64) -> Grid {
    box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], jitter)
}

/// A grid of these points and cells.
fn grid(points: Vec<DVec3>, mut cells: Vec<[u32; 4]>) -> Grid {
    cells.iter_mut().for_each(|cell| cell.sort_unstable());
    Grid { points: SharedSlice::from(points), tetrahedra: SharedSlice::from(cells), ..Grid::default() }
}

/// The cells of a grid that are wanted, by number and middle.
fn part(base: &Grid, mut wanted: impl FnMut(DVec3) -> bool) -> Grid {
    let cells = (0..base.tetrahedra.len()).filter(|&i| wanted(base.corners(i).iter().sum::<DVec3>() / 4.0));
    grid(base.points.to_vec(), cells.map(|i| base.tetrahedra[i]).collect())
}

fn together(parts: &[Grid]) -> Grid {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for part in parts {
        let first = points.len() as u32;
        points.extend_from_slice(&part.points);
        cells.extend(part.tetrahedra.iter().map(|cell| cell.map(|p| p + first)));
    }
    grid(points, cells)
}

fn moved(base: &Grid, place: impl Fn(DVec3) -> DVec3) -> Grid {
    grid(base.points.iter().map(|&p| place(p)).collect(), base.tetrahedra.to_vec())
}

/// Three bars about the z axis, each over the next: seen along it they hide each other in a circle.
fn bars(length: f64) -> Grid {
    let bar = |k: i32| {
        let turn = DQuat::from_rotation_z(f64::from(k) * std::f64::consts::TAU / 3.0);
        let along = DVec3::new(0.0, 20f64.to_radians().cos(), 20f64.to_radians().sin());
        moved(&cube([1, 1, 1], 0.0), |p| {
            let q = p - 0.5;
            turn * (DVec3::X * (0.5 + 0.3 * q.x) + along * (length * q.y) + DVec3::Z * (0.25 * q.z))
        })
    };
    together(&[bar(0), bar(1), bar(2)])
}

fn perspective(eye: [f64; 3], target: [f64; 3], fov_y: f64) -> Camera {
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::new(0.1, 0.2, 1.0),
        projection: Projection::Perspective { fov_y },
        near: 0.0,
        size: [31, 27],
        samples: 1,
    }
}

fn parallel(eye: [f64; 3], target: [f64; 3], height: f64) -> Camera {
    Camera { projection: Projection::Orthographic { height }, ..perspective(eye, target, 30.0) }
}

/// From outside, from far, from within, with a near plane in the grid, by parallel rays, with several samples a pixel.
fn cameras() -> Vec<Camera> {
    let outside = perspective([2.1, -1.7, 1.9], [0.5, 0.5, 0.5], 42.0);
    vec![
        outside,
        perspective([-70.0, 93.0, 41.0], [0.5, 0.5, 0.5], 1.1),
        perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 100.0),
        Camera { near: 2.3, ..outside },
        parallel([3.0, 2.0, -2.5], [0.5, 0.5, 0.5], 1.7),
        Camera { samples: 3, size: [17, 19], ..parallel([-3.0, 0.2, 0.4], [0.5, 0.5, 0.5], 1.3) },
    ]
}

fn order_of(grid: &Grid, camera: &Camera) -> Result<FaceOrder, OrderError> {
    Faces::new(grid).order(grid, camera).expect("the camera is in range")
}

/// Pixels (over all samples) whose segments the reference enters in another order, of those longer than rounding.
fn disordered_by_reference(grid: &Grid, order: &[u32], camera: &Camera) -> u64 {
    let scalar = SharedSlice::from(vec![0.0; grid.points.len()]);
    let volume = Volume { grid: Arc::new(grid.clone()), scalar, gradient: None, gradient_magnitude: None };
    let model = OpticalModel::DensityEmitter;
    let scene = Scene {
        volume: Arc::new(volume),
        transfer_function: Arc::new(TransferFunction { model, unit_distance: 1.0, widgets: vec![] }),
        camera: *camera,
        shading: SHADING,
        order: VisibilityOrder::Exact,
    };
    let tracer = tracer(&scene);
    let mut rank = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, cell)| rank[*cell as usize] = k);
    let mut count = 0;
    for [dx, dy] in camera.sample_offsets() {
        for (x, y) in (0..camera.size[0]).flat_map(|x| (0..camera.size[1]).map(move |y| (x, y))) {
            let ray = tracer.ray(f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy);
            let crossings = tracer.crossings(&ray);
            let longer = crossings.iter().filter(|c| c.depth[1] - c.depth[0] > 1e-9);
            let ranks: Vec<usize> = longer.map(|c| rank[c.cell as usize]).collect();
            count += u64::from(!ranks.is_sorted());
        }
    }
    count
}

/// Holds the order of a grid against the reference and the check, from everywhere; gives how many there were.
fn holds(name: &str, grid: &Grid) -> usize {
    let faces = Faces::new(grid);
    let mut known = 0;
    for (k, camera) in cameras().iter().enumerate() {
        let order = match faces.order(grid, camera).expect("the camera is in range") {
            Ok(order) => order,
            Err(why) => {
                println!("{name}, camera {k}: {why}");
                continue;
            }
        };
        let mut each = order.cells.clone();
        each.sort_unstable();
        assert!(
            each.iter().copied().eq(0..grid.tetrahedra.len() as u32),
            "{name}, camera {k}: each cell once"
        );
        assert_eq!(disordered_by_reference(grid, &order.cells, camera), 0, "{name}, camera {k}");
        let found = disorder(grid, &order.cells, camera, |_| true).expect("in range");
        let pixels = u64::from(camera.samples * camera.size[0] * camera.size[1]);
        assert_eq!(found, Disorder { pixels_tested: pixels, disordered: 0 }, "{name}, camera {k}");
        known += 1;
    }
    known
}

#[test]
fn convex_grids_have_an_order_from_everywhere() {
    for (counts, jitter) in [([1, 1, 1], 0.0), ([4, 3, 5], 0.0), ([4, 4, 4], 0.25), ([9, 2, 3], 0.2)] {
        let grid = cube(counts, jitter);
        assert!(Faces::new(&grid).is_independent_of_direction(), "{counts:?}");
        assert_eq!(holds(&format!("{counts:?}"), &grid), cameras().len(), "{counts:?} {jitter}");
    }
}

/// A ball of cells is convex, one with a dent is not, nor are two parts, nor a ring.
#[test]
fn convex_grids_are_known() {
    let ball = |p: DVec3| {
        let q = 2.0 * p - 1.0;
        let most = q.abs().max_element();
        if most == 0.0 { p } else { 0.5 + 0.5 * q * most / q.length() }
    };
    let base = cube([8, 8, 8], 0.0);
    // Its faces follow the sphere as chords, quadrilaterals of two triangles, of which half are dents.
    assert!(!Faces::new(&moved(&base, ball)).is_independent_of_direction());
    let corner = grid([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].to_vec(), vec![[0, 1, 2, 3]]);
    assert!(Faces::new(&corner).is_independent_of_direction());
    assert!(!Faces::new(&moved(&base, |p| p + 1e-6 * p.x * p.x * DVec3::Z)).is_independent_of_direction());
    assert!(
        !Faces::new(&together(&[corner.clone(), moved(&corner, |p| p + 2.0)])).is_independent_of_direction()
    );
    assert!(
        !Faces::new(&part(&base, |p| p.x < 0.3 || p.x > 0.7 || p.y < 0.3 || p.y > 0.7))
            .is_independent_of_direction()
    );
    // A hollow, whose own boundary is convex the other way round.
    assert!(!Faces::new(&part(&base, |p| (p - 0.5).abs().max_element() > 0.2)).is_independent_of_direction());
}

/// Two arms with an opening between them, a hollow cube, parts apart, and a bent slab.
#[test]
fn rays_that_leave_a_grid_and_meet_it_again() {
    let base = cube([6, 6, 3], 0.1);
    let arms = part(&base, |p| p.x < 0.34 || p.y < 0.34 || p.y > 0.66);
    let hollow = part(&cube([5, 5, 5], 0.2), |p| (p - 0.5).abs().max_element() > 0.3);
    let small = moved(&cube([2, 2, 2], 0.1), |p| 0.3 * p);
    let apart = together(&[0.0, 0.35, 0.7].map(|x| moved(&small, |p| p + DVec3::new(x, 0.7 - x, 0.5 * x))));
    let bent = moved(&cube([10, 5, 2], 0.1), |p| {
        let turn = DQuat::from_rotation_z(3.0 * p.x);
        0.5 + turn * DVec3::new(0.2 + 0.25 * p.y, 0.0, p.z - 0.5)
    });
    for (name, grid) in [("arms", arms), ("hollow", hollow), ("apart", apart), ("bent", bent)] {
        assert!(!Faces::new(&grid).is_independent_of_direction(), "{name}");
        assert_eq!(holds(name, &grid), cameras().len(), "{name}");
    }
}

/// Bars that hide each other in a circle have no order where pixels show it, and one where they do not.
#[test]
fn circles_have_no_order() {
    let above = parallel([0.01, 0.02, 5.0], [0.0, 0.0, 0.0], 4.0);
    let above = Camera { size: [90, 90], ..above };
    let grid = bars(3.0);
    let Err(OrderError::Cyclic(count)) = order_of(&grid, &above) else { panic!("no circle found") };
    assert!((3..=grid.tetrahedra.len()).contains(&count), "{count}");
    // Any order of whole cells is wrong there, as the check finds.
    let all: Vec<u32> = (0..grid.tetrahedra.len() as u32).collect();
    let centroid = centroid_order(&grid.points, &grid.tetrahedra, &all, &above).unwrap();
    let found = disorder(&grid, &centroid, &above, |_| true).unwrap();
    assert!(found.disordered > 0);
    assert_eq!(found.disordered, disordered_by_reference(&grid, &centroid, &above));
    // Short ones do not reach over each other.
    assert!(order_of(&bars(0.5), &above).is_ok());
    // From the side they are one behind the other.
    assert!(order_of(&grid, &parallel([5.0, 0.1, 0.02], [0.0; 3], 4.0)).is_ok());
}

/// A prism of three cells, twisted so that each hides the next: the faces themselves lead round in a circle. It is told from
/// the same prism between the rays of two pixels, which show nothing of it.
#[test]
fn a_circle_of_faces_that_no_ray_crosses_is_taken_out() {
    // Schönhardt's twist about the axis of view, about a thin core: cells that share faces round it.
    let ring = |count: u32, twist: f64| {
        let at = |k: u32, z: f64, r: f64, turn: f64| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count) + turn;
            DVec3::new(r * angle.cos(), r * angle.sin(), z)
        };
        // Spokes from near the axis outwards, tilted: between each and the next a wedge of three cells.
        let mut points = Vec::new();
        for k in 0..count {
            points.extend([
                at(k, -0.5, 0.1, -twist),
                at(k, 0.5, 0.1, twist),
                at(k, -0.5, 1.0, -twist),
                at(k, 0.5, 1.0, twist),
            ]);
        }
        let mut cells = Vec::new();
        for k in 0..count {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| 4 * k + i);
            let [e, f, g, h] = [0, 1, 2, 3].map(|i| 4 * ((k + 1) % count) + i);
            // The hexahedron a c d b – e g h f, by its diagonal from a to h.
            cells.extend([
                [a, c, d, h],
                [a, d, b, h],
                [a, b, f, h],
                [a, f, e, h],
                [a, e, g, h],
                [a, g, c, h],
            ]);
        }
        grid(points, cells)
    };
    let grid = ring(8, 0.12);
    let above = parallel([0.003, 0.002, 5.0], [0.003, 0.002, 0.0], 2.4);
    let fine = Camera { size: [96, 96], ..above };
    let Err(OrderError::Cyclic(count)) = order_of(&grid, &fine) else { panic!("no circle found") };
    assert!(count >= 8, "{count}");
    // Rays two widths apart go by it.
    let coarse = Camera { size: [2, 2], ..parallel([0.003, 0.002, 5.0], [0.003, 0.002, 0.0], 8.0) };
    let order = order_of(&grid, &coarse).expect("no ray shows the circle");
    assert!(order.taken_out > 0);
    assert_eq!(disordered_by_reference(&grid, &order.cells, &coarse), 0);
}

/// Cells without volume between others hand their order on.
#[test]
fn cells_without_volume_hand_the_order_on() {
    let base = cube([4, 3, 3], 0.0);
    for thickness in [0.0, 1e-13] {
        let flat = moved(&base, |p| {
            let layer = (p.x * 4.0).round() as usize;
            DVec3::new([0.0, 0.4, 0.4 + thickness, 0.4 + 2.0 * thickness, 1.0][layer], p.y, p.z)
        });
        assert_eq!(holds(&format!("flat {thickness:e}"), &flat), cameras().len());
    }
}

/// Blocks with points of their own at one place share their faces; others touch, and hide each other across no gap.
#[test]
fn blocks_that_touch() {
    let base = cube([3, 3, 3], 0.0);
    let beside = moved(&base, |p| p + DVec3::X);
    let halves = |grid: &Grid| moved(grid, |p| DVec3::new(0.5 * p.x, p.y, p.z));
    let same = halves(&together(&[base.clone(), beside]));
    assert_eq!(holds("same points", &same), cameras().len());
    let other = moved(&cube([3, 2, 4], 0.0), |p| p + DVec3::X);
    let touching = halves(&together(&[base, other]));
    assert_eq!(holds("other points", &touching), cameras().len());
}

#[test]
fn grids_in_each_other_have_no_order() {
    let base = cube([2, 2, 2], 0.1);
    let camera = &cameras()[0];
    let within = together(&[base.clone(), moved(&base, |p| p + DVec3::new(0.31, 0.27, 0.23))]);
    assert!(matches!(order_of(&within, camera), Err(OrderError::Unclear(1..))));
    assert!(matches!(
        order_of(&together(&[base.clone(), base.clone()]), camera),
        Err(OrderError::Crowded(1..))
    ));
    // A corner pulled through the cells beyond.
    let last = base.points.len() - 1;
    let mut points = base.points.to_vec();
    points[last] = DVec3::splat(0.2);
    assert!(matches!(
        order_of(&grid(points, base.tetrahedra.to_vec()), camera),
        Err(OrderError::Folded(1..))
    ));
    // No grid at all is in order.
    assert_eq!(order_of(&Grid::default(), camera).map(|order| order.cells), Ok(vec![]));
}

/// The check finds two cells that changed places, where they are looked at alone.
#[test]
fn the_check_finds_what_is_wrong() {
    let grid = cube([4, 4, 4], 0.2);
    let camera = cameras()[0];
    let mut order = order_of(&grid, &camera).unwrap().cells;
    order.reverse();
    let all = disorder(&grid, &order, &camera, |_| true).unwrap();
    assert_eq!(all.disordered, disordered_by_reference(&grid, &order, &camera));
    assert!(all.disordered > 100, "{all:?}");
    let some = disorder(&grid, &order, &camera, |[x, y]| (x, y) == (15, 13)).unwrap();
    assert_eq!(some, Disorder { pixels_tested: 1, disordered: 1 });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Any part of a grid with points moved about: holes, cells alone, parts that hang together by a point.
    #[test]
    fn parts_of_grids_are_in_order(
        counts in [1usize..6, 1usize..6, 1usize..6], jitter in 0.0..0.25f64, kept in 0.2..1.0f64, seed in 1u64..,
        eye in [-2.0..3.0f64, -2.0..3.0f64, -2.0..3.0f64], parallel in any::<bool>(),
    ) {
        let mut random = Random(seed);
        let grid = part(&cube(counts, jitter), |_| random.next() < kept);
        let camera = perspective(eye, [0.51, 0.47, 0.53], 60.0);
        let camera = match parallel {
            true => Camera { projection: Projection::Orthographic { height: 1.6 }, ..camera },
            false => camera,
        };
        match order_of(&grid, &camera) {
            Ok(order) => {
                prop_assert_eq!(order.cells.len(), grid.tetrahedra.len());
                prop_assert_eq!(disordered_by_reference(&grid, &order.cells, &camera), 0);
                prop_assert_eq!(disorder(&grid, &order.cells, &camera, |_| true).unwrap().disordered, 0);
            }
            Err(why) => prop_assert!(matches!(why, OrderError::Cyclic(_)), "{}", why),
        }
    }
}
