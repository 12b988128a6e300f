//! What the engine leaves out or takes as equal, by numbers that its sources state: each is crossed here.

use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_core::optics::integrators::{self, Extent};
use voltet_core::optics::{Contribution, Overlap, Segment};
use voltet_core::picture::Picture;
use voltet_core::progress::Silent;
use voltet_core::reference;
use voltet_core::scene::Scene;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use voltet_core::volume::Volume;
use voltet_engine::{Segments, cull, draw, keep_all, segments};
use voltet_lanes::LaneSet;

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
    for depth in [2e-8, 9e-8, 1.1e-7, 3e-7, 3e-6, 3e-5, 3e-4, 3e-3] {
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

/// A cell is out of view where all of its corners lie beyond one plane: the outermost pixels' rays, or the near plane.
#[test]
fn cells_out_of_view_are_culled_and_counted() {
    let cube = unit_cube([4; 3]);
    let look = look(vec![uniform([-1.0, 2.0], 1.0, [1.0; 3])]);
    // Outermost rays at 3/16 beside the middle, planes of corners at quarters: two by two columns of six cells are seen.
    let narrow = Camera { projection: Projection::Orthographic { height: 0.4 }, ..along(DVec3::Y) };
    // And two of their four layers lie before 5.01, but for what reaches beyond.
    for (near, seen) in [(0.0, 2 * 2 * 4 * 6), (5.01, 2 * 2 * 2 * 6)] {
        let cells = cull(&cube, &look, &Camera { near, ..narrow }, &Silent).expect("culls");
        assert_eq!((cells.kept.len(), cells.culled_by_frustum), (seen, 384 - seen as u64), "near {near}");
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

/// One widget looks at eight fields at most, several together at more: what is drawn is read where it stands, and what a
/// picture has no room for is refused.
#[test]
fn widgets_look_at_eleven_fields_together() {
    let nd = |fields: std::ops::Range<usize>, extinction: f64| {
        let (count, names) = (fields.len(), fields.map(|k| format!("field {k:02}")).collect());
        let row = |i: usize| (0..count).map(|j| f64::from(u8::from(i == j))).collect();
        let matrix = (0..count).map(row).collect();
        let profile = Profile::GaussianNd { fields: names, centre: vec![0.0; count], matrix };
        Widget { profile, color: [1.0; 3], extinction, region: None }
    };
    // The same all along, so that the depths are the profiles at one point.
    let values: Vec<f64> = (1..=12).map(|k| 0.0625 * f64::from(k)).collect();
    let at = |fields: std::ops::Range<usize>| (-values[fields].iter().map(|v| v * v).sum::<f64>()).exp();
    let draw = |count: usize| {
        let look = look(vec![nd(0..8, 0.5), nd(8..count, 0.3)]);
        let ends = &values[..count];
        let segment =
            Segment { length: 1.0, front: [0.0; 2], back: [0.0; 2], fields_front: ends, fields_back: ends };
        segments(LaneSet::detect().unwrap(), &look, &SHADING, false, &[segment])
    };
    let depth = draw(11).expect("draws")[0].contribution.optical_depth;
    let exact = 0.5 * at(0..8) + 0.3 * at(8..11);
    // Rounding of the depth to 32 bits: the values have few digits.
    assert!((depth / exact - 1.0).abs() < 2e-7, "{depth} for {exact}");
    let refusal = draw(12).expect_err("more fields than a picture is drawn from").to_string();
    assert!(refusal.contains("12 beside s and g") && refusal.contains("at most 11"), "{refusal}");
}

/// A triangular Gaussian's width is g itself: it keeps its digits where g is a hundred-thousandth of the largest, though no
/// value of the data is 0.
#[test]
fn small_widths_keep_their_digits() {
    let profile = Profile::TriangularGaussian { centre: 0.5, sigma: 1.0 };
    let look = look(vec![Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }]);
    let segment = |front, back| Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
    let small = segment([0.5, 1e-5], [0.5 + 1e-5, 1.7e-5]);
    let list = [segment([0.0, 1e-5], [1.0, 1.0]), small];
    let extent = Extent { scalar: [0.0, 1.0], longest: 1.0 };
    let exact = integrators::new(&SHADING.integrator, SHADING.overlap, &look, &extent).expect("serves it");
    let exact = exact.integrate(&small).optical_depth;
    for Segments { lanes, .. } in Segments::each() {
        let found = segments(lanes, &look, &SHADING, false, &list).expect("draws")[1];
        let depth = found.contribution.optical_depth;
        // Some steps of 32 bits in the ends and in the mean; counted from the middle of g they leave 1e-3.
        assert!((depth / exact - 1.0).abs() < 2e-6, "{depth} for {exact} on {}", lanes.name());
        assert_eq!(found.left, None, "left to 64 bits on {}", lanes.name());
    }
}

/// What lies near the widgets keeps its digits, though the data reach thirty times as far: a segment along which g changes by
/// a hundred-thousandth of its range is cut where the edge of a region is.
#[test]
fn edges_keep_their_digits_where_the_data_reach_far() {
    let low = Widget {
        region: Some(Region::rectangle([0.0, 2.0], [0.0, 2.5])),
        ..uniform([0.0; 2], 1.0, [1.0; 3])
    };
    let profile = Profile::Gaussian { centre: [4.0, 3.0], matrix: [[9.0, 0.0], [0.0, 0.4]] };
    let look = look(vec![low, Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }]);
    let segment = |front, back| Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
    let grazing = segment([0.8, 2.49937], [0.9, 2.50041]);
    let list = [segment([0.0, 0.0], [5.0, 100.0]), grazing];
    let extent = Extent { scalar: [0.0, 5.0], longest: 1.0 };
    let exact = integrators::new(&SHADING.integrator, SHADING.overlap, &look, &extent).expect("serves it");
    let exact = exact.integrate(&grazing).optical_depth;
    for Segments { lanes, .. } in Segments::each() {
        let depth =
            segments(lanes, &look, &SHADING, false, &list).expect("draws")[1].contribution.optical_depth;
        // Some steps of 32 bits at a distance of 1 from the middle of the widgets' places, over what g changes by; from the
        // middle of the data they are fifty times as long.
        assert!((depth - exact).abs() < 2e-4, "{depth} for {exact} on {}", lanes.name());
    }
}

/// Two cells meet in a face that holds a line of pixels but for 1e-6 of a radian: each of their rays passes from one to the
/// other where terms of a million cancel.
#[test]
fn a_face_nearly_edge_on_parts_its_cells_where_it_should() {
    let across = DVec3::new(1.0, -2.0, 0.0) * 1e-6;
    let points = vec![
        DVec3::new(-2.0, -1.0, -3.0) + across,
        DVec3::new(2.0, 1.0, -3.0) + across,
        DVec3::new(0.2, 0.1, -9.0) - 2.0 * across,
        DVec3::new(3.0, -6.0, -5.0),
        DVec3::new(-3.0, 6.0, -5.0),
    ];
    let tetrahedra = Arc::new(vec![[0, 1, 2, 3], [0, 1, 2, 4]]);
    let grid = Grid { points: Arc::new(points), tetrahedra, ..Grid::default() };
    let look =
        look(vec![uniform([-1.0, 0.5], 0.7, [1.0, 0.2, 0.1]), uniform([0.5, 2.0], 0.2, [0.1, 0.3, 1.0])]);
    let volume = volume(grid, |p| if p.x > 2.5 { 1.0 } else { 0.0 });
    let camera = Camera {
        eye: DVec3::ZERO,
        target: -DVec3::Z,
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y: 60.0 },
        near: 0.0,
        size: [33, 33],
        samples: 1,
    };
    let all = keep_all(&volume, &look, &camera).expect("keeps all");
    let found = draw(&all, &look, &camera, &SHADING, &Silent).expect("draws").0;
    let scene =
        Scene { volume, transfer_function: Arc::new(look), camera, shading: SHADING, order: Order::Exact };
    let exact = reference::draw(&scene, &Silent).expect("draws");
    let lit = exact.rgba.iter().filter(|pixel| pixel[3] > 0.1).count();
    assert!(lit > 100, "{lit} pixels see the cells");
    let difference = largest_difference(&found, &exact);
    assert!(difference < 2e-5, "off by {difference:e}");
}

/// Exact integrals of segments of one length unit, with two widgets in front of each other.
fn exact_of(look: &TransferFunction, segment: &Segment) -> Contribution {
    let extent = Extent { scalar: [0.0, 1.0], longest: 1.0 };
    let exact = integrators::new(&SHADING.integrator, SHADING.overlap, look, &extent).expect("serves it");
    exact.integrate(segment)
}

fn segment(front: [f64; 2], back: [f64; 2]) -> Segment<'static> {
    Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] }
}

/// Widgets are mixed without regard to their order only where that is worth less than 1e-8.
#[test]
fn overlap_is_ordered_from_a_product_of_depths_on() {
    for depth in [3e-5, 9e-5, 1.1e-4, 3e-4, 1e-3] {
        let halves = [([0.0, 0.5], [1.0, 0.0, 0.0]), ([0.5, 1.0], [0.0, 0.0, 1.0])]
            .map(|(s, c)| uniform(s, 2.0 * depth, c));
        let gaussian = |s, color| {
            let profile = Profile::Gaussian { centre: [s, 0.0], matrix: [[1.0, 0.0], [0.0, 0.0]] };
            Widget { profile, color, extinction: depth, region: None }
        };
        let smooth = [gaussian(-0.5, [1.0, 0.0, 0.0]), gaussian(1.5, [0.0, 0.0, 1.0])];
        for widgets in [halves, smooth] {
            let look = look(widgets.to_vec());
            let across = segment([0.0; 2], [1.0, 0.0]);
            let exact = exact_of(&look, &across).color;
            for Segments { lanes, .. } in Segments::each() {
                let found = segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0];
                for (found, exact) in found.contribution.color.into_iter().zip(exact) {
                    // And some roundings of 32 bits.
                    let bound = 1e-8 + 1e-6 * exact;
                    let error = (found - exact).abs();
                    assert!(error < bound, "depth {depth:e} on {}: {found} for {exact}", lanes.name());
                }
            }
        }
    }
}

/// Where Gaussians extend over up to two widths four points on one or four steps leave 3e-5 of their depth.
#[test]
fn overlap_is_integrated_by_as_many_steps_as_it_needs() {
    let share = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
    let gaussian = |s, color| {
        let profile = Profile::Gaussian { centre: [s, 0.0], matrix: [[2.0, 0.0], [0.0, 0.0]] };
        Widget { profile, color, extinction: 1.5, region: None }
    };
    let look = look(vec![gaussian(0.3, [1.0, 0.0, 0.0]), gaussian(0.6, [0.0, 0.0, 1.0])]);
    // A width is a half; the first spans all.
    let list: Vec<Segment> = (0..400)
        .map(|i| match i {
            0 => segment([0.0; 2], [1.0, 0.0]),
            _ => segment([share(i, 0.618), 0.0], [share(i, 0.755), 0.0]),
        })
        .collect();
    for Segments { lanes, .. } in Segments::each() {
        let found = segments(lanes, &look, &SHADING, false, &list).expect("draws");
        let mut worst = 0.0;
        for (found, segment) in found.iter().zip(&list) {
            let exact = exact_of(&look, segment);
            for (found, color) in found.contribution.color.into_iter().zip(exact.color) {
                worst = f64::max(worst, (found - color).abs() / exact.optical_depth);
            }
        }
        println!("{worst:.1e} of the depth on {}", lanes.name());
        assert!(worst < 3e-5, "{worst:e} of the depth on {}", lanes.name());
    }
}

/// A tenth inside each limit lanes serve a segment, a tenth beyond it 64 bits do, and it is said why.
#[test]
fn what_32_bits_do_not_hold_is_left_to_64() {
    let widget = |profile| Widget { profile, color: [1.0, 0.5, 0.2], extinction: 1.0, region: None };
    let line = |widths: f64| Profile::Gaussian { centre: [0.5, 0.0], matrix: [[widths, 0.0], [0.0, 0.0]] };
    let everywhere = |extinction, color| uniform([-1.0, 2.0], extinction, color);
    let wave = |bands: f64| {
        let period = 1.0 / bands;
        Profile::SineWave(Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period, band_width: 1.0 })
    };
    let nd = |widths: f64| {
        let (fields, matrix) = (vec!["field".to_owned()], vec![vec![widths]]);
        Profile::GaussianNd { fields, centre: vec![0.5], matrix }
    };
    let triangular_nd = |widths: f64| {
        let (fields, matrix) = (vec!["field".to_owned()], vec![vec![widths]]);
        Profile::TriangularGaussianNd { fields, magnitude: "one".into(), centre: vec![0.5], matrix }
    };
    type Of<'a> = &'a dyn Fn(f64) -> Vec<Widget>;
    let of_gaussian = "100,000 widths of a Gaussian, or 50 of a triangular one";
    let cases: [(f64, f64, Of, &str); 7] = [
        (1e5, 1.0, &|widths| vec![widget(line(widths))], of_gaussian),
        (1e5, 1.0, &|widths| vec![widget(nd(widths))], of_gaussian),
        // g is 1.
        (
            50.0,
            1.0,
            &|widths| vec![widget(Profile::TriangularGaussian { centre: 0.5, sigma: 1.0 / widths })],
            of_gaussian,
        ),
        (50.0, 1.0, &|widths| vec![widget(triangular_nd(widths))], of_gaussian),
        (1e6, 1.0, &|bands| vec![widget(wave(bands))], "its numbers leave 32 bits"),
        (
            200.0,
            1.0,
            &|depth| vec![everywhere(0.9 * depth, [1.0; 3]), everywhere(0.1 * depth, [0.5; 3])],
            "a density of over 200",
        ),
        // A unit distance of 1e30 lengths.
        (
            1.0,
            1e30,
            &|_| vec![widget(Profile::TriangularGaussian { centre: 0.5, sigma: 0.1 })],
            "lengths per unit distance",
        ),
    ];
    let (one, zero) = ([0.0, 1.0], [1.0, 1.0]);
    for (limit, unit_distance, of, why) in cases {
        for (share, is_left) in [(0.9, false), (1.1, true)] {
            let mut look = look(of(share * limit));
            // A longer unit is a shorter length.
            look.unit_distance = unit_distance * share;
            let names = look.fields().len();
            let across = Segment {
                fields_front: &one[..names],
                fields_back: &zero[..names],
                ..segment([0.0, 1.0], [1.0, 1.0])
            };
            let across = if unit_distance == 1.0 { Segment { length: share, ..across } } else { across };
            for Segments { lanes, .. } in Segments::each() {
                let found = segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0];
                let expected = is_left.then_some(true);
                assert_eq!(
                    found.left.map(|left| left.contains(why)),
                    expected,
                    "{why}, {share} on {}: {:?}",
                    lanes.name(),
                    found.left
                );
            }
        }
    }
}

/// A tile of over a thousand segments in a pixel, of which some are of cells about the eye, which 64 bits draw: its rows are
/// drawn one by one, and no segment is counted or drawn twice.
#[test]
fn deep_tiles_with_cells_about_the_eye_are_drawn_once() {
    let grid = box_of_tetrahedra([1, 400, 1], [DVec3::ZERO, DVec3::new(1.0, 3.0, 1.0)], 0.0);
    let volume = volume(grid, |p| 0.5 + 0.4 * (9.0 * p.y + 2.0 * p.x).sin());
    let look =
        look(vec![uniform([0.0, 0.5], 0.4, [1.0, 0.2, 0.1]), uniform([0.5, 1.0], 0.9, [0.1, 0.3, 1.0])]);
    let camera = Camera {
        eye: DVec3::new(0.45, 0.015, 0.55),
        target: DVec3::new(0.5, 3.0, 0.5),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 14.0 },
        near: 0.0,
        size: [6, 6],
        samples: 1,
    };
    let cells = cull(&volume, &look, &camera, &Silent).expect("culls");
    let (found, counts) = draw(&cells, &look, &camera, &SHADING, &Silent).expect("draws");
    assert_eq!(counts.tiles_deep, 1, "{counts:?}");
    let scene =
        Scene { volume, transfer_function: Arc::new(look), camera, shading: SHADING, order: Order::Exact };
    let exact = reference::draw(&scene, &Silent).expect("draws");
    let difference = largest_difference(&found, &exact);
    assert!(difference < 2e-4, "off by {difference:e}");
    let tracer = reference::Tracer::new(&scene).expect("is a scene");
    let on =
        |k: usize| tracer.crossings(&tracer.ray((k % 6) as f64 + 0.5, (k / 6) as f64 + 0.5)).len() as u64;
    let segments: u64 = (0..36).map(on).sum();
    // Some of no length for the one or the other.
    assert!(counts.segments.abs_diff(segments) * 100 < segments, "{} for {segments}", counts.segments);
}
