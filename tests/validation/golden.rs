//! Two pictures of the referee, kept, so that neither it nor the engine changes unseen.

use crate::compare::{ORDINARY, Scene, engine, load, referee, save, within};
use crate::grids::{cube, cyclic_bars, smooth};
use crate::looks::*;
use std::path::PathBuf;

fn scenes() -> [Scene; 2] {
    [
        Scene {
            name: "overlap".into(),
            volume: smooth(cube([4, 4, 4], 0.2)),
            look: overlapping(),
            camera: outside([40, 30]),
        },
        Scene {
            name: "bars".into(),
            volume: smooth(cyclic_bars()),
            look: ramp(),
            camera: perspective([0.1, -0.2, -5.0], [0.0, 0.0, 0.0], 40.0, [32, 32]),
        },
    ]
}

fn path(scene: &Scene) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/validation/golden");
    folder.join(format!("{}.exr", scene.name))
}

/// The referee repeats itself to the last bits of the picture (libraries' exp may differ by one), the engine
/// keeps its bound.
#[test]
fn golden_pictures() {
    for scene in scenes() {
        let golden = load(&path(&scene));
        within(&format!("golden referee {}", scene.name), &referee(&scene), &golden, 2e-7);
        within(&format!("golden {}", scene.name), &engine(&scene), &golden, ORDINARY);
    }
}

/// Writes the pictures anew, after a change of their meaning: `cargo test --test validation -- --ignored`.
#[test]
#[ignore = "writes tests/validation/golden"]
fn write_golden_pictures() {
    for scene in scenes() {
        save(&referee(&scene), &path(&scene));
    }
}
