//! Two pictures of the referee, kept, so that neither it nor the engine changes unseen.

use crate::drawing::Tested;
use std::path::PathBuf;
use voltet_core::picture::Picture;
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, referee, save, within};
use voltet_testing::pictures::grids::{cube, cyclic_bars, smooth};
use voltet_testing::pictures::looks::*;

fn scenes() -> [NamedScene; 2] {
    [
        NamedScene {
            name: "overlap".into(),
            volume: smooth(cube([4, 4, 4], 0.2)),
            look: overlapping(),
            camera: outside([40, 30]),
        },
        NamedScene {
            name: "bars".into(),
            volume: smooth(cyclic_bars()),
            look: ramp(),
            camera: perspective([0.1, -0.2, -5.0], [0.0, 0.0, 0.0], 40.0, [32, 32]),
        },
    ]
}

fn path(scene: &NamedScene) -> PathBuf {
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
        Tested.matches(&scene, &golden, ORDINARY);
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

/// Reads what `save` wrote.
fn load(path: &std::path::Path) -> Picture {
    let image = image::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).to_rgba32f();
    let (width, height) = (image.width() as usize, image.height() as usize);
    Picture { width, height, rgba: image.pixels().map(|p| p.0).collect() }
}
