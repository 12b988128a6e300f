//! Rays from cell to cell against cells that are projected, one by one.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_cpu::{Cells, Counts, Traversal, VolumeCache, composite, cull, project};
use voltet_optics::shading::Ordering;
use voltet_simd::LaneSet;
use voltet_testing::pictures::compare::{NamedScene, SHADING, referee, within};
use voltet_testing::pictures::grids::{
    cube, moved, part, refined, smooth, together, two_arms, volume, with_flat_layer,
};
use voltet_testing::pictures::looks::{
    gaussian, look, orthographic, outside, overlapping, perspective, ramp,
};

/// What 32 bits leave of a segment's length, in both ways.
const ROUNDING: f64 = 1e-5;

/// The picture, its counts, and whether its cells were projected.
fn drawn(scene: &NamedScene, set: impl Fn(&mut Cells)) -> (Picture, Counts, bool) {
    let draw = || -> Result<(Picture, Counts, bool)> {
        let mut cells = cull(&scene.volume, &scene.look, &scene.camera, &NoProgress)?;
        set(&mut cells);
        let projection = project(&cells, &scene.look, &scene.camera, false, &NoProgress)?;
        let (picture, counts) = composite(&projection, &scene.look, &SHADING, &NoProgress)?;
        Ok((picture, counts, projection.cells_projected().is_some()))
    };
    draw().unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Share of the segments that may count in one way alone: cells whose faces and edges a ray lies in.
const SHARE_OF_SEGMENTS: f64 = 0.05;

/// Tiles that rays were lost in, of a scene that is drawn in both ways on every lane set.
fn lost(scene: &NamedScene) -> u64 {
    lost_with(scene, SHARE_OF_SEGMENTS)
}

/// Like [`lost`], with another share of segments by which rays may count fewer than projected cells.
fn lost_with(scene: &NamedScene, fewer: f64) -> u64 {
    let mut most = 0;
    for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
        let (expected, by_cells, was_projected) =
            drawn(scene, |cells| (cells.lanes, cells.traversal) = (lanes, Traversal::Project));
        assert!(was_projected, "{}", scene.name);
        assert!(expected.rgba.iter().any(|p| p[3] > 0.1), "{} shows nothing", scene.name);
        let (picture, counts, was_projected) =
            drawn(scene, |cells| (cells.lanes, cells.traversal) = (lanes, Traversal::RayCast));
        let name = format!("{} on {}", scene.name, lanes.name());
        assert!(!was_projected, "{name}: projected");
        within(&name, &picture, &expected, ROUNDING);
        // Tiles that rays are lost in, from windows of a few cells.
        let (in_windows, again, _) = drawn(scene, |cells| {
            (cells.lanes, cells.traversal) = (lanes, Traversal::RayCast);
            cells.max_resident_cells = cells.ids.len() / 5;
        });
        assert_eq!(again.tiles_lost, counts.tiles_lost, "{name}");
        assert!(in_windows.rgba == picture.rgba, "{name}: windows show something else");
        let (cast, projected) = (counts.segments as f64, by_cells.segments as f64);
        assert!(
            (1.0 - fewer) * projected - 8.0 <= cast && cast <= (1.0 + SHARE_OF_SEGMENTS) * projected + 8.0,
            "{name}: {cast} segments for {projected}"
        );
        most = most.max(counts.tiles_lost);
    }
    most
}

/// Scenes of a volume with two kinds of widgets.
fn scenes(name: &str, volume: &Arc<Volume>, cameras: &[(&str, Camera)]) -> Vec<NamedScene> {
    let looks = [("ramp", ramp()), ("overlap", overlapping())];
    let of = |(place, camera): &(&str, Camera)| {
        looks.clone().map(|(kind, look)| NamedScene {
            name: format!("{name}, {place}, {kind}"),
            volume: volume.clone(),
            look,
            camera: *camera,
        })
    };
    cameras.iter().flat_map(of).collect()
}

fn cameras() -> [(&'static str, Camera); 5] {
    [
        ("outside", outside([50, 40])),
        ("oblique", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [40, 50])),
        // Rays in faces that stand oblique on the screen: pixels of 1/16, points at multiples of 1/4 between them.
        ("along an axis", orthographic([-2.0, 0.5, 0.5], [0.5, 0.5, 0.5], 2.0, [32, 32])),
        // Rays through points, in edges and in all faces.
        ("through points", orthographic([-2.0, 0.5, 0.5], [0.5, 0.5, 0.5], 33.0 / 16.0, [33, 33])),
        ("along a diagonal", orthographic([-2.0, -2.0, 0.5], [0.5, 0.5, 0.5], 2.0, [32, 32])),
    ]
}

#[test]
fn rays_from_cell_to_cell_see_what_cells_show() {
    let arms = smooth(two_arms());
    let flat = smooth(with_flat_layer(1e-6));
    let grids = [("jittered", smooth(cube([4, 4, 4], 0.2))), ("regular", smooth(cube([4, 4, 4], 0.0)))];
    for (name, volume) in grids.iter().chain(&[("two arms", arms), ("a flat layer", flat)]) {
        for scene in scenes(name, volume, &cameras()) {
            let through_points = scene.name.contains("through points");
            let fewer = if through_points { SHARE_OF_SEGMENTS_AT_A_POINT } else { SHARE_OF_SEGMENTS };
            assert_eq!(lost_with(&scene, fewer), 0, "{}", scene.name);
        }
    }
}

#[test]
fn parts_that_are_apart_are_passed_one_after_another() {
    let near = cube([3, 3, 3], 0.1);
    let far = moved(&near, |p| p + glam::DVec3::new(0.2, 0.1, 1.5));
    let camera = perspective([0.4, 0.45, -3.0], [0.5, 0.5, 1.0], 30.0, [48, 48]);
    for scene in scenes("two cubes", &smooth(together(&[near, far])), &[("in a row", camera)]) {
        assert_eq!(lost(&scene), 0, "{}", scene.name);
    }
}

/// Each cube's rays end where those of the other begin, to rounding.
#[test]
fn parts_that_touch_are_passed_one_after_another() {
    let near = cube([3, 3, 3], 0.2);
    let far = moved(&near, |p| glam::DVec3::new(p.x, p.y, 2.0 - p.z));
    let cameras = [
        ("in a row", perspective([0.4, 0.45, -3.0], [0.5, 0.5, 1.0], 30.0, [48, 48])),
        ("oblique", orthographic([3.0, -2.0, 4.5], [0.5, 0.5, 1.0], 2.5, [60, 60])),
    ];
    for scene in scenes("two cubes that touch", &smooth(together(&[near, far])), &cameras) {
        assert_eq!(lost(&scene), 0, "{}", scene.name);
    }
}

/// Faces between levels have no partner: rays exit by one and enter by another in the same plane. Of a linear field the picture is that of
/// equal cells.
#[test]
fn levels_of_other_cell_sizes_are_passed_one_after_another() {
    for scene in scenes("levels", &smooth(refined()), &cameras()) {
        assert_eq!(lost(&scene), 0, "{}", scene.name);
    }
    let linear = |grid| volume(grid, |p| p.dot(glam::DVec3::new(0.5, 0.3, 0.2)), |_| 1.5);
    let (levels, equal) = (linear(refined()), linear(cube([8, 8, 8], 0.0)));
    for scene in scenes("levels of a linear field", &levels, &cameras()) {
        let of_equal = NamedScene { volume: equal.clone(), ..scene.clone() };
        for traversal in [Traversal::Project, Traversal::RayCast] {
            let (picture, ..) = drawn(&scene, |cells| cells.traversal = traversal);
            let (expected, ..) = drawn(&of_equal, |cells| cells.traversal = traversal);
            assert!(expected.rgba.iter().any(|p| p[3] > 0.1), "{} shows nothing", scene.name);
            within(&scene.name, &picture, &expected, ROUNDING);
        }
    }
}

/// Like [`SHARE_OF_SEGMENTS`], where every ray goes through a point of the grid: the cells that meet there, too.
const SHARE_OF_SEGMENTS_AT_A_POINT: f64 = 0.25;

/// Cameras whose near plane or eye lies in the unit cube.
fn cameras_inside() -> Vec<(&'static str, Camera)> {
    let near = |near: f64, camera: Camera| Camera { near, ..camera };
    let inside = perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 70.0, [45, 37]);
    let axis = perspective([0.5, 0.5, 0.5], [1.0, 0.5, 0.5], 90.0, [33, 33]);
    let parallel = orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [40, 50]);
    vec![
        ("the eye inside", inside),
        ("a wide view", perspective([0.43, 0.37, 0.52], [0.1, 0.3, 0.45], 130.0, [45, 37])),
        ("inside, near plane", near(0.2, inside)),
        ("inside, a tiny near plane", near(1e-4, inside)),
        // The eye at a point, rays through points, in edges and in faces.
        ("the eye at a point", axis),
        ("the eye at a point, near plane in faces", near(0.25, axis)),
        ("the eye in a face", perspective([0.25, 0.4, 0.6], [1.0, 0.5, 0.5], 80.0, [33, 33])),
        ("on the boundary", perspective([0.0, 0.5, 0.45], [1.0, 0.5, 0.5], 80.0, [40, 30])),
        ("close before the boundary", perspective([-0.003, 0.47, 0.45], [1.0, 0.5, 0.5], 80.0, [40, 30])),
        ("outside, near plane", near(1.5, outside([50, 40]))),
        ("far outside, near plane", near(100.3, perspective([-100.0, 0.4, 0.45], [0.5; 3], 0.8, [40, 40]))),
        ("parallel, near plane", near(3.7, parallel)),
        (
            "along an axis, near plane in faces",
            near(2.5, orthographic([-2.0, 0.5, 0.5], [0.5; 3], 2.0, [32, 32])),
        ),
        (
            "through points, near plane",
            near(2.6, orthographic([-2.0, 0.5, 0.5], [0.5; 3], 33.0 / 16.0, [33, 33])),
        ),
    ]
}

#[test]
fn rays_begin_at_the_near_plane() {
    let holes = part(&cube([14, 14, 14], 0.2), |p| (p - 0.5).length() > 0.2 && (p.x * 9.0).sin() < 0.8);
    for (name, grid) in [
        ("jittered", cube([4, 4, 4], 0.2)),
        ("regular", cube([4, 4, 4], 0.0)),
        ("fine", cube([8, 8, 8], 0.2)),
        ("flat cells", cube([3, 40, 3], 0.2)),
        ("holes", holes),
    ] {
        for scene in scenes(name, &smooth(grid), &cameras_inside()) {
            assert_eq!(lost_with(&scene, SHARE_OF_SEGMENTS_AT_A_POINT), 0, "{}", scene.name);
        }
    }
}

/// Cells of 1e-6 of the cube's side across x, and cameras in and before them.
fn slivers() -> (Grid, [(&'static str, Camera); 3]) {
    let layers = [0.0, 0.25, 0.5, 0.5 + 1e-6, 0.7, 0.85, 1.0];
    let grid =
        moved(&cube([6, 6, 6], 0.0), |p| glam::DVec3::new(layers[(p.x * 6.0).round() as usize], p.y, p.z));
    let eye = [0.5 + 4e-7, 0.43, 0.52];
    let before = orthographic([-2.0, 0.47, 0.51], [0.5, 0.47, 0.51], 0.9, [32, 32]);
    let cameras = [
        ("the eye in a sliver", perspective(eye, [0.9, 0.5, 0.45], 70.0, [45, 37])),
        ("along slivers", perspective(eye, [0.5, 0.9, 0.45], 70.0, [45, 37])),
        ("the near plane in slivers", Camera { near: 2.5, ..before }),
    ];
    (grid, cameras)
}

#[test]
fn rays_begin_in_slivers() {
    let (grid, cameras) = slivers();
    for scene in scenes("slivers", &smooth(grid), &[&cameras_inside()[..], &cameras].concat()) {
        assert_eq!(lost_with(&scene, SHARE_OF_SEGMENTS_AT_A_POINT), 0, "{}", scene.name);
    }
}

/// Bound of the error of rays that begin at the near plane; that of projected cells is 4e-6 there.
const REFERENCE_ERROR: f64 = 2e-6;

#[test]
fn rays_that_begin_at_the_near_plane_show_what_the_reference_shows() {
    let mut cameras = cameras_inside();
    // Rays on the outline of the grid are in it or beside it.
    cameras.retain(|(place, _)| *place != "through points, near plane");
    let (slivers, in_slivers) = slivers();
    let beside = [&cameras[..], &in_slivers].concat();
    for (name, grid, cameras) in [
        ("jittered", cube([4, 4, 4], 0.2), &cameras),
        ("flat cells", cube([3, 40, 3], 0.2), &cameras),
        ("slivers", slivers, &beside),
    ] {
        for scene in scenes(name, &smooth(grid), cameras) {
            let (picture, _, was_projected) = drawn(&scene, |cells| cells.traversal = Traversal::RayCast);
            assert!(!was_projected, "{}: projected", scene.name);
            within(&scene.name, &picture, &referee(&scene), REFERENCE_ERROR);
        }
    }
}

/// Depths keep their digits within the grid, however far the eye is.
#[test]
fn grids_seen_from_far_show_what_the_reference_shows() {
    let direction = [-0.5, -0.7, 0.51];
    for distance in [1e2, 1e4, 1e6] {
        let eye = direction.map(|x: f64| 0.5 + distance * x);
        let fov_y = 2.0 * (0.9 / distance).atan().to_degrees();
        let cameras = [
            ("in perspective", perspective(eye, [0.5; 3], fov_y, [40, 32])),
            ("in parallel", orthographic(eye, [0.5; 3], 1.9, [40, 32])),
        ];
        for scene in scenes(&format!("from {distance}"), &smooth(cube([4, 4, 4], 0.2)), &cameras) {
            assert_eq!(lost(&scene), 0, "{}", scene.name);
            let expected = referee(&scene);
            for traversal in [Traversal::RayCast, Traversal::Project] {
                let (picture, ..) = drawn(&scene, |cells| cells.traversal = traversal);
                within(&format!("{}, {traversal:?}", scene.name), &picture, &expected, ROUNDING);
            }
        }
    }
}

#[test]
fn tiles_where_cells_overlap_before_the_eye_are_drawn_from_their_cells() {
    let one = cube([4, 4, 4], 0.1);
    let other = moved(&one, |p| 0.7 * p + glam::DVec3::new(0.6, 0.4, 0.3));
    let overlapping = smooth(together(&[one, other]));
    let inside = perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 70.0, [45, 37]);
    for scene in scenes("one in the other", &overlapping, &[("the eye inside", inside)]) {
        assert!(lost(&scene) > 0, "{}: no ray was lost", scene.name);
    }
}

#[test]
fn tiles_where_cells_overlap_are_drawn_from_their_cells() {
    let one = cube([3, 3, 3], 0.1);
    let other = moved(&one, |p| 0.7 * p + glam::DVec3::new(0.6, 0.4, 0.3));
    // Each folded over its neighbour: on one side of the faces that they share.
    let folded = moved(&cube([4, 4, 4], 0.0), |p| glam::DVec3::new(p.x + 0.3 * (9.0 * p.x).sin(), p.y, p.z));
    for (name, grid) in [("one in the other", together(&[one, other])), ("folded", folded)] {
        for scene in scenes(name, &smooth(grid), &[("outside", outside([50, 40]))]) {
            assert!(lost(&scene) > 0, "{}: no ray was lost", scene.name);
        }
    }
}

#[test]
fn cells_that_are_not_drawn_are_a_boundary() -> Result<()> {
    let volume = smooth(part(&cube([9, 9, 9], 0.2), |p| (p - 0.5).length() > 0.25));
    let bands = [(0.6, [0.9, 0.4, 0.1]), (0.64, [0.2, 0.5, 0.8])]
        .map(|(centre, color)| gaussian([centre, 0.8], [0.01, 5.0], 40.0, color));
    let scene = NamedScene {
        name: "two bands".into(),
        volume,
        look: look(bands.to_vec()),
        camera: outside([60, 60]),
    };
    assert_eq!(lost(&scene), 0);
    let kept = cull(&scene.volume, &scene.look, &scene.camera, &NoProgress)?.ids.len();
    assert!(kept < scene.volume.grid.tetrahedra.len(), "every cell is drawn");
    Ok(())
}

#[test]
fn what_rays_do_not_serve_is_projected() -> Result<()> {
    let volume = smooth(cube([4, 4, 4], 0.2));
    let always = |cells: &mut Cells| cells.traversal = Traversal::RayCast;
    let scene =
        NamedScene { name: String::new(), volume: volume.clone(), look: ramp(), camera: outside([40, 30]) };
    assert!(!drawn(&scene, always).2);
    let unordered =
        |cells: &mut Cells| (cells.traversal, cells.ordering) = (Traversal::RayCast, Ordering::Submission);
    assert!(drawn(&scene, unordered).2, "without order");
    let mut all = VolumeCache::new(&scene.volume)?.all(&scene.look, &scene.camera)?;
    always(&mut all);
    let projection = project(&all, &scene.look, &scene.camera, false, &NoProgress)?;
    assert!(projection.cells_projected().is_none(), "with nothing left out");
    Ok(())
}

/// Says how much memory is left.
struct Left(u64);

impl Progress for Left {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn memory_left(&self) -> Option<u64> {
        Some(self.0)
    }
}

/// Whether each of some pictures of a volume, the camera turned a little before each, was projected.
fn projected(
    known: &VolumeCache,
    look: &TransferFunction,
    size: [u32; 2],
    left: u64,
    set: impl Fn(&mut Cells),
) -> Vec<bool> {
    let projected = |k: i32| -> Result<bool> {
        let camera = perspective([0.5 + 0.01 * f64::from(k), 0.6, -3.0], [0.5; 3], 30.0, size);
        let mut cells = known.cull(look, &camera, &NoProgress)?;
        set(&mut cells);
        let projection = project(&cells, look, &camera, false, &Left(left))?;
        Ok(projection.cells_projected().is_some())
    };
    (0..3).map(|k| projected(k).expect("the scene can be drawn")).collect()
}

#[test]
fn rays_go_from_cell_to_cell_where_that_pays() -> Result<()> {
    let volume = smooth(cube([12, 12, 12], 0.2));
    let [hardly, few, many] = [[8, 8], [40, 40], [600, 600]];
    let one_color = |extinction| look(vec![gaussian([0.5, 0.8], [0.3, 5.0], extinction, [1.0, 0.5, 0.2])]);
    for (name, look, size, is_projected) in [
        ("hardly a segment a cell", ramp(), hardly, true),
        ("few segments a cell", ramp(), few, false),
        ("many", ramp(), many, false),
        ("few, of one colour", one_color(4.0), few, false),
        ("many, of one colour, which need no order", one_color(4.0), many, true),
        ("many, of one colour, most of them hidden", one_color(400.0), many, false),
    ] {
        let projected = projected(&VolumeCache::new(&volume)?, &look, size, u64::MAX, |_| {});
        assert_eq!(projected, [is_projected; 3], "{name}");
    }
    Ok(())
}

#[test]
fn where_faces_have_no_room_cells_are_projected() -> Result<()> {
    let volume = smooth(cube([40, 40, 40], 0.2));
    let (cells, size) = (volume.grid.tetrahedra.len() as u64, [512, 512]);
    let projected = |known: &VolumeCache, bytes_of_cell: u64| {
        let left = bytes_of_cell * cells + 16 * 512 * 512;
        projected(known, &ramp(), size, left, |cells| cells.max_resident_cells = 1000)
    };
    let known = VolumeCache::new(&volume)?;
    assert_eq!(projected(&known, 60), [true; 3]);
    assert_eq!(projected(&known, 200), [false; 3]);
    // Once they are found they take no more.
    assert_eq!(projected(&known, 60), [false; 3]);
    Ok(())
}
