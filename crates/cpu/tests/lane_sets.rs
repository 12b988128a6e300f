//! Whole pictures on every lane set that the processor has, against the 64-bit referee. (`tests/validation` holds the set that
//! the program takes to all scenes.)

use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_cpu::{Traversal, cull, draw};
use voltet_simd::LaneSet;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::{one_gaussian, orthographic, outside, overlapping, perspective, ramp};

fn picture(scene: &NamedScene, lanes: LaneSet, casting: Traversal) -> Result<Picture> {
    let mut cells = cull(&scene.volume, &scene.look, &scene.camera, &NoProgress)?;
    (cells.lanes, cells.traversal) = (lanes, casting);
    Ok(draw(&cells, &scene.look, &scene.camera, &SHADING, &NoProgress)?.0)
}

#[test]
fn every_lane_set_draws_what_the_referee_draws() {
    let volume = smooth(cube([6, 6, 6], 0.2));
    let inside = perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 70.0, [40, 30]);
    for (place, camera) in [
        ("outside", outside([40, 30])),
        ("oblique", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [30, 40])),
        ("inside near", Camera { near: 0.2, ..inside }),
    ] {
        for (kind, look) in [("ramp", ramp()), ("gaussian", one_gaussian()), ("overlap", overlapping())] {
            let mut scene = NamedScene { name: String::new(), volume: volume.clone(), look, camera };
            let expected = referee(&scene);
            assert!(expected.rgba.iter().any(|p| p[3] > 0.1), "{place} {kind} shows nothing");
            for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
                for casting in [Traversal::Project, Traversal::RayCast] {
                    scene.name = format!("{place} {kind} {} {casting:?}", lanes.name());
                    let actual =
                        picture(&scene, lanes, casting).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
                    within(&scene.name, &actual, &expected, ORDINARY);
                }
            }
        }
    }
}
