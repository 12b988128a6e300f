//! Pictures: what is culled, which cells go in 64 bits, in which order segments are composited, where tiles end.

use super::*;
use voltet_core::SharedSlice;
use voltet_core::camera::Projection;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_cpu::{Traversal, VolumeCache, cull, draw};
use voltet_optics::shading::{Light, Shading};
use voltet_testing::pictures::looks::perspective;

/// Cells of a density that is nothing along the longest ray are left out, those that a picture shows are not: no pixel
/// changes by more than 1e-6, whatever the density of all that is culled.
#[test]
fn culling_changes_no_pixel_by_more_than_a_millionth() {
    let (cube, camera) = (unit_cube([4; 3]), along(DVec3::Y));
    let diagonal = 3f64.sqrt();
    for depth in [2e-8, 9e-8, 1.1e-7, 3e-7, 3e-6, 3e-5, 3e-4, 3e-3] {
        let look = look(vec![uniform([-1.0, 2.0], depth / diagonal, [1.0, 0.5, 0.2])]);
        let culled = cull(&cube, &look, &camera, &NoProgress).expect("culls");
        // All of it together has a depth of 1e-7 at most.
        assert_eq!(culled.ids.is_empty(), depth < 1e-7, "depth {depth:e}");
        let all = VolumeCache::new(&cube).and_then(|cache| cache.all(&look, &camera)).expect("keeps all");
        let pictures =
            [culled, all].map(|cells| draw(&cells, &look, &camera, &SHADING, &NoProgress).expect("draws").0);
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
        let cells = cull(&cube, &look, &Camera { near, ..narrow }, &NoProgress).expect("culls");
        assert_eq!((cells.ids.len(), cells.culled_by_frustum), (seen, 384 - seen as u64), "near {near}");
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
            let cells = cull(&cube, &look, &camera, &NoProgress).expect("culls");
            let (picture, counts) = draw(&cells, &look, &camera, &SHADING, &NoProgress).expect("draws");
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
    let tetrahedra = vec![[4, 5, 6, 7], [0, 1, 2, 3]];
    let grid = Grid { points: SharedSlice::from(points), tetrahedra: tetrahedra.into(), ..Grid::default() };
    let scalar = (0..9).map(|i| if (4..8).contains(&i) { 0.75 } else { 0.25 }).collect();
    let two = Arc::new(Volume { scalar, ..Volume::clone(&volume(grid, |_| 0.0)) });
    let red = uniform([0.0, 0.5], 2.0, [1.0, 0.0, 0.0]);
    let look = look(vec![red, uniform([0.5, 1.0], 2.0, [0.0, 0.0, 1.0])]);
    let camera = along(DVec3::Z);
    let cells = cull(&two, &look, &camera, &NoProgress).expect("culls");
    let (found, _) = draw(&cells, &look, &camera, &SHADING, &NoProgress).expect("draws");
    let exact = drawn_exactly(two, look, camera);
    let difference = largest_difference(&found, &exact);
    // The wrong order is off by a tenth and more.
    assert!(difference < 2e-4, "off by {difference:e}");
}
/// Two cells meet in a face that holds a line of pixels but for a small angle: each of their rays passes from one to the other
/// where large terms cancel, a million of them at 1e-6 of a radian.
#[test]
fn a_face_nearly_edge_on_parts_its_cells_where_it_should() {
    let camera = Camera { up: DVec3::Y, ..perspective([0.0; 3], [0.0, 0.0, -1.0], 60.0, [33, 33]) };
    for angle in [1e-6, 4e-5, 5e-5, 7e-5, 1e-4, 2e-4, 5e-4, 1e-3, 1e-2] {
        let across = DVec3::new(1.0, -2.0, 0.0) * angle;
        let points = vec![
            DVec3::new(-2.0, -1.0, -3.0) + across,
            DVec3::new(2.0, 1.0, -3.0) + across,
            DVec3::new(0.2, 0.1, -9.0) - 2.0 * across,
            DVec3::new(3.0, -6.0, -5.0),
            DVec3::new(-3.0, 6.0, -5.0),
        ];
        let tetrahedra = vec![[0, 1, 2, 3], [0, 1, 2, 4]];
        let grid =
            Grid { points: SharedSlice::from(points), tetrahedra: tetrahedra.into(), ..Grid::default() };
        let (red, blue) = ([1.0, 0.2, 0.1], [0.1, 0.3, 1.0]);
        let look = look(vec![uniform([-1.0, 0.5], 0.7, red), uniform([0.5, 2.0], 0.2, blue)]);
        let volume = volume(grid, |p| if p.x > 2.5 { 1.0 } else { 0.0 });
        let all = VolumeCache::new(&volume).and_then(|cache| cache.all(&look, &camera)).expect("keeps all");
        let found = draw(&all, &look, &camera, &SHADING, &NoProgress).expect("draws").0;
        let exact = drawn_exactly(volume, look, camera);
        let lit = exact.rgba.iter().filter(|pixel| pixel[3] > 0.1).count();
        assert!(lit > 100, "{lit} pixels see the cells");
        let difference = largest_difference(&found, &exact);
        // 2.6e-5 at 5e-4, where 32 bits hold the face still; ten times as steep a face would leave ten times that.
        assert!(difference < 6e-5, "off by {difference:e} at {angle:e}");
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
    let camera = perspective([0.45, 0.015, 0.55], [0.5, 3.0, 0.5], 14.0, [6, 6]);
    let cells = cull(&volume, &look, &camera, &NoProgress).expect("culls");
    let (found, counts) = draw(&cells, &look, &camera, &SHADING, &NoProgress).expect("draws");
    assert_eq!(counts.tiles_deep, 1, "{counts:?}");
    let scene = scene(volume, look, camera);
    let exact = reference::draw(&scene, &NoProgress).expect("draws");
    let difference = largest_difference(&found, &exact);
    assert!(difference < 2e-4, "off by {difference:e}");
    let tracer = reference::tracer(&scene).expect("is a scene");
    let on =
        |k: usize| tracer.crossings(&tracer.ray((k % 6) as f64 + 0.5, (k / 6) as f64 + 0.5)).len() as u64;
    let segments: u64 = (0..36).map(on).sum();
    // Some of no length for the one or the other.
    assert!(counts.segments.abs_diff(segments) * 100 < segments, "{} for {segments}", counts.segments);
}

/// One cell with s at its corners.
fn one_cell(corners: [[f64; 3]; 4], s: [f64; 4]) -> Arc<Volume> {
    let points = corners.map(DVec3::from).to_vec();
    let grid = Grid {
        points: SharedSlice::from(points),
        tetrahedra: SharedSlice::from(vec![[0, 1, 2, 3]]),
        ..Grid::default()
    };
    Arc::new(Volume { scalar: SharedSlice::from(s.to_vec()), ..Volume::clone(&volume(grid, |_| 0.0)) })
}

/// By how much a picture of all cells, seen along −z from the origin, is off; at least `lit` of its pixels show something.
fn off(volume: Arc<Volume>, look: TransferFunction, fov_y: f64, lit: usize) -> f32 {
    let camera = Camera { up: DVec3::Y, ..perspective([0.0; 3], [0.0, 0.0, -1.0], fov_y, [65, 65]) };
    let all = VolumeCache::new(&volume).and_then(|cache| cache.all(&look, &camera)).expect("keeps all");
    let found = draw(&all, &look, &camera, &SHADING, &NoProgress).expect("draws").0;
    let exact = drawn_exactly(volume, look, camera);
    let shown = exact.rgba.iter().filter(|pixel| pixel[3] > 0.1).count();
    assert!(shown >= lit, "{shown} pixels show something");
    largest_difference(&found, &exact)
}

/// A cell about the eye, of which one face is parallel to the middle ray, and one that passes beside the eye.
#[test]
fn cells_about_the_eye_and_beside_it_are_seen_whole() {
    let about = [[-1.0, -5.0, 5.0], [-1.0, 5.0, 5.0], [-1.0, 0.0, -8.0], [6.0, 0.0, 0.0]];
    let beside = [[-0.5, -1.5, 1.0], [-0.6, 1.5, 1.0], [-0.2, 0.1, 1.0], [0.0, 0.0, -10.0]];
    for (name, corners) in [("about", about), ("beside", beside)] {
        let look = look(vec![uniform([-1.0, 2.0], 0.3, [1.0, 0.5, 0.2])]);
        let difference = off(one_cell(corners, [0.0, 0.2, 0.7, 1.0]), look, 120.0, 1200);
        // Two roundings of a colour near 1 to 32 bits, in which such a cell is shaded like any other.
        assert!(difference < 2.5e-7, "{name}: off by {difference:e}");
    }
}

/// Two colours that meet within a cell which reaches from near the eye to many times as far.
#[test]
fn cells_over_a_wide_range_of_depths_keep_their_digits() {
    for ratio in [2.0, 3.5, 3.9, 5.0, 10.0, 39.0, 300.0] {
        let far = [[-0.4, -0.3, -1.0], [0.5, -0.2, -1.0], [0.06, 0.56, -0.9]].map(|p| p.map(|x| ratio * x));
        let (red, blue) = ([1.0, 0.2, 0.1], [0.1, 0.3, 1.0]);
        let look = look(vec![uniform([0.0, 0.5], 3.0 / ratio, red), uniform([0.5, 1.0], 1.0 / ratio, blue)]);
        let cell = one_cell([[0.02, 0.01, -1.0], far[0], far[1], far[2]], [0.9, 0.1, 0.3, 0.6]);
        let difference = off(cell, look, 60.0, 1000);
        // 9e-7 up to a ratio of 4; ten times as much would be left at ten times that.
        assert!(difference < 2e-6, "off by {difference:e} at 1 : {ratio}");
    }
}

/// A sliver through whose thickness s goes over its whole range, so dense that it is seen.
#[test]
fn slivers_keep_their_digits() {
    for thin in [1e-3, 1e-4, 4e-5, 3e-5, 1e-5, 5e-6, 1e-6] {
        // The last point lies so far before the middle of the others.
        let middle = [0.04, -0.17, -3.02 + 2.0 * thin];
        let corners = [[-1.0, -1.0, -3.0], [1.0, -0.9, -3.2], [0.1, 1.0, -2.9], middle];
        let (red, blue) = ([1.0, 0.2, 0.1], [0.1, 0.3, 1.0]);
        let look = look(vec![uniform([0.0, 0.5], 2.0 / thin, red), uniform([0.5, 1.0], 0.5 / thin, blue)]);
        let difference = off(one_cell(corners, [0.0, 0.1, 0.05, 1.0]), look, 40.0, 800);
        // Lengths and values are off by 2e-4 of their range, and colours by some times that.
        assert!(difference < 2e-3, "off by {difference:e} at {thin:e}");
    }
}

/// The same where s hardly varies: its length is what is seen.
#[test]
fn flat_cells_keep_their_length() {
    for thin in [1e-3, 3e-4, 1e-4, 4e-5, 1e-5, 1e-6] {
        let middle = [0.04, -0.17, -3.02 + 2.0 * thin];
        let corners = [[-1.0, -1.0, -3.0], [1.0, -0.9, -3.2], [0.1, 1.0, -2.9], middle];
        let look = look(vec![uniform([0.0, 1.0], 1.0 / thin, [1.0, 0.2, 0.1])]);
        let difference = off(one_cell(corners, [0.1, 0.11, 0.12, 0.1]), look, 40.0, 800);
        assert!(difference < 2e-4, "off by {difference:e} at {thin:e}");
    }
}

/// In a sliver all whose points but one have s = 0 nothing is met of what is dense where s is less than 0 by a millionth and more.
#[test]
fn values_lie_between_those_of_the_corners() {
    let corners = [[-1.0, -1.0, -3.0], [1.0, -0.9, -3.2], [0.1, 1.0, -2.9], [0.04, -0.17, -3.0198]];
    let look = look(vec![uniform([-1.0, -2e-6], 1e9, [1.0; 3]), uniform([0.2, 1.0], 1e4, [0.5; 3])]);
    let difference = off(one_cell(corners, [0.0, 0.0, 0.0, 1.0]), look, 40.0, 800);
    assert!(difference < 2e-3, "off by {difference:e}");
}

/// Two overlapping widgets so dense that every segment waits until it is known to be seen: then lanes serve Gaussians, 64 bits a
/// wave; what is hidden nobody, and from cell to cell no ray comes to it. Lit or not, the picture is the referee's.
#[test]
fn what_is_dense_and_hidden_is_not_integrated() {
    let widget =
        |profile: Profile, color: [f64; 3]| Widget { profile, color, extinction: 20_000.0, region: None };
    let gaussian = |s: f64| Profile::Gaussian { centre: [s, 0.0], matrix: [[3.0, 0.0], [0.0, 0.0]] };
    let bands = Wave { origin: [0.2, 0.0], angle: 0.0, scale: [1.0, 1.0], period: 2.0, band_width: 1.0 };
    let cube = unit_cube([24, 3, 3]);
    let gradient = vec![DVec3::X; cube.grid.points.len()];
    let cube = Arc::new(Volume { gradient: Some(gradient.into()), ..Volume::clone(&cube) });
    let camera = along(DVec3::X);
    let light = Light { direction: DVec3::new(-1.0, 0.2, 0.3), ambient: 0.3, diffuse: 0.6 };
    for (first, in_lanes) in [(gaussian(0.2), true), (Profile::SineWave(bands), false)] {
        let look = look(vec![widget(first, [1.0, 0.1, 0.0]), widget(gaussian(0.7), [0.0, 0.3, 1.0])]);
        let mut cells = cull(&cube, &look, &camera, &NoProgress).expect("culls");
        let lit = Shading { light: Some(light), ..SHADING };
        for (shading, casts) in [(SHADING, false), (lit, false), (SHADING, true), (lit, true)] {
            cells.traversal = if casts { Traversal::RayCast } else { Traversal::Project };
            let (picture, counts) = draw(&cells, &look, &camera, &shading, &NoProgress).expect("draws");
            let referee = Scene { shading, ..scene(cube.clone(), look.clone(), camera) };
            let exact = reference::draw(&referee, &NoProgress).expect("draws");
            let difference = largest_difference(&picture, &exact);
            assert!(difference < 1e-5, "off by {difference:e}");
            let pixels = 16 * 16;
            let goes_on = counts.segments > 24 * pixels;
            assert_ne!(goes_on, casts, "{} segments", counts.segments);
            // The first cell of a ray is opaque; where it is crossed in a corner only, lanes serve it, and the second is.
            let wanted = if in_lanes { 0..=0 } else { pixels / 2..=2 * pixels };
            let exact_count = counts.segments_exact;
            assert!(wanted.contains(&exact_count), "{exact_count} of {}", counts.segments);
        }
    }
}
