//! Orders that are not exact, and looks that the engine integrates in 64 bits.

use crate::drawing::{ByCells, Tested, picture};
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Wave, Widget};
use voltet_cpu as engine;
use voltet_optics::shading::{Integrator, Ordering, Shading, VisibilityOrder};
use voltet_reference::REFERENCE;
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, SHADING};
use voltet_testing::pictures::grids::*;
use voltet_testing::pictures::looks::*;

/// The exact order leaves no pixel disordered; centroids are wrong somewhere in a jittered grid, grid order in
/// more places; and where the colour is one, no order is wrong.
#[test]
fn disordered_pixels_are_counted() {
    let scene = NamedScene {
        name: "orders".into(),
        volume: smooth(cube([6, 6, 6], 0.3)),
        look: overlapping(),
        camera: outside([48, 48]),
    };
    let cells = engine::cull(&scene.volume, &scene.look, &scene.camera, &NoProgress).unwrap();
    let disordered = |order: VisibilityOrder, look: &TransferFunction| {
        let cells = engine::sort(&cells, &scene.camera, Ordering::new(order, true)).unwrap();
        engine::draw(&cells, look, &scene.camera, &SHADING, &NoProgress).unwrap().1.pixels_disordered
    };
    let [exact, centroid, none] =
        [VisibilityOrder::Exact, VisibilityOrder::Centroid, VisibilityOrder::Unsorted]
            .map(|o| disordered(o, &scene.look));
    assert_eq!(exact, 0);
    assert!(0 < centroid && centroid < none, "centroid {centroid}, none {none}");
    assert_eq!(disordered(VisibilityOrder::Unsorted, &one_gaussian()), 0);
}

fn widget(profile: Profile) -> Widget {
    Widget { profile, color: [0.9, 0.6, 0.2], extinction: 2.0, region: None }
}

fn wave(period: f64, band_width: f64) -> Wave {
    Wave { origin: [0.1, 0.0], angle: 0.3, scale: [1.0, 0.2], period, band_width }
}

#[test]
fn widgets_without_a_vector_form() {
    for (name, profile) in [
        ("triangular gaussian", Profile::TriangularGaussian { centre: 0.5, sigma: 0.1 }),
        ("triangle wave", Profile::TriangleWave(wave(0.21, 0.4))),
        ("sine wave", Profile::SineWave(wave(0.13, 1.0))),
    ] {
        Tested.ordinary(&NamedScene {
            name: name.into(),
            volume: smooth(cube([4, 4, 4], 0.2)),
            look: look(vec![widget(profile)]),
            camera: outside([40, 40]),
        });
    }
}

#[test]
fn constant_emitter() {
    let mut look = overlapping();
    look.model = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };
    Tested.ordinary(&NamedScene {
        name: "constant emitter".into(),
        volume: smooth(cube([4, 4, 4], 0.2)),
        look,
        camera: outside([40, 40]),
    });
}

/// Also one whose values the data straddle without meeting it: no cell lies in the hole of its region.
#[test]
fn widgets_that_no_cell_touches_are_left_out() {
    let scene = NamedScene {
        name: "untouched".into(),
        volume: volume(cube([4, 4, 4], 0.2), |p| p.x, |p| p.x),
        look: overlapping(),
        camera: outside([32, 32]),
    };
    let kept = picture(&scene, &SHADING).rgba;
    for far in [gaussian([40.0, 0.0], [0.5, 0.5], 3.0, [0.0, 1.0, 0.0]), corner()] {
        let mut more = scene.clone();
        more.look.widgets.insert(1, far);
        let cells = engine::cull(&more.volume, &more.look, &more.camera, &NoProgress).unwrap();
        assert_eq!(cells.inactive_widgets, [1]);
        assert_eq!(picture(&more, &SHADING).rgba, kept);
    }
}

/// A corner of the (s, g) plane inside the data's ranges, away from s = g.
fn corner() -> Widget {
    polygon(&[[0.6, 0.0], [1.0, 0.0], [1.0, 0.4]], 5.0, [0.0, 0.0, 1.0])
}

/// Counted in lanes and in 64 bits alike; a threshold of 1e-8 lies on a few segments' rounding.
#[test]
fn overlaps_are_counted() {
    let scene = NamedScene {
        name: "overlaps".into(),
        volume: smooth(cube([4, 4, 4], 0.2)),
        look: overlapping(),
        camera: outside([40, 40]),
    };
    let count = |look: &TransferFunction, integrator: Integrator| {
        let cells = engine::cull(&scene.volume, look, &scene.camera, &NoProgress).unwrap();
        let shading = Shading { integrator, ..SHADING };
        engine::draw(&cells, look, &scene.camera, &shading, &NoProgress).unwrap().1
    };
    let (lanes, exact) = (count(&scene.look, Integrator::ANALYTIC), count(&scene.look, REFERENCE));
    assert_eq!(exact.segments_exact, exact.segments);
    let [a, b] = [lanes, exact].map(|counts| counts.segments_overlapping as f64);
    assert!(a > 0.1 * lanes.segments as f64 && (a - b).abs() <= 0.01 * b, "{a} in lanes, {b} in 64 bits");
    assert_eq!(count(&one_gaussian(), Integrator::ANALYTIC).segments_overlapping, 0);
}

/// Tiles of opaque pixels read no further cell where no order is needed: the picture is the referee's, also in
/// tiles that the picture's edge cuts.
#[test]
fn opaque_tiles_stop_early() {
    let fog = |extinction| look(vec![everywhere(extinction, [1.0, 0.5, 0.25])]);
    let scene = |extinction| NamedScene {
        name: format!("fog {extinction}"),
        volume: smooth(cube([10, 10, 10], 0.2)),
        look: fog(extinction),
        camera: perspective([0.5, -2.0, 0.5], [0.5, 0.0, 0.5], 15.0, [40, 24]),
    };
    let counts = |extinction| {
        let scene = scene(extinction);
        Tested.ordinary(&scene);
        let mut cells = engine::cull(&scene.volume, &scene.look, &scene.camera, &NoProgress).unwrap();
        cells.traversal = engine::Traversal::Project;
        engine::draw(&cells, &scene.look, &scene.camera, &SHADING, &NoProgress).unwrap().1
    };
    let (thin, dense) = (counts(2.0), counts(1e4));
    assert_eq!((thin.tiles_stopped, thin.cells_hidden), (0, 0));
    // All of 3 × 2.
    assert_eq!(dense.tiles_stopped, 6);
    assert!(dense.cells_hidden > 0 && dense.segments < thin.segments, "{dense:?} after {thin:?}");
}

/// Widgets of two colours, so dense that most of what there is is hidden: the picture is the referee's, inside the outline and beyond
/// it.
#[test]
fn dense_scenes_of_two_colours_are_the_referees() {
    for extinction in [2.0, 300.0] {
        let scene = NamedScene {
            name: format!("two colours, {extinction}"),
            volume: smooth(cube([7, 36, 7], 0.2)),
            look: look(vec![
                everywhere(extinction, [1.0, 0.5, 0.25]),
                gaussian([0.5, 0.7], [0.3, 0.9], extinction, [0.1, 0.2, 0.9]),
            ]),
            camera: perspective([0.5, -2.0, 0.6], [0.5, 0.0, 0.5], 32.0, [88, 72]),
        };
        Tested.ordinary(&scene);
        ByCells.ordinary(&scene);
    }
}
