//! Bands: any number in a cell, thin ones, cut by regions, far from the data's values.

use crate::drawing::Tested;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{Profile, Region, Wave, Widget};
use voltet_cpu as engine;
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, SHADING};
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::*;

fn scene(name: &str, widgets: Vec<Widget>) -> NamedScene {
    NamedScene {
        name: name.into(),
        volume: smooth(cube([4, 4, 4], 0.2)),
        look: look(widgets),
        camera: outside([40, 40]),
    }
}

fn both(name: &str, wave: Wave, extinction: f64, region: Option<Region>) {
    for profile in [Profile::TriangleWave(wave), Profile::SineWave(wave)] {
        let kind = if matches!(profile, Profile::SineWave(_)) { "sine" } else { "triangle" };
        let widget = Widget { profile, color: [0.9, 0.6, 0.2], extinction, region: region.clone() };
        let scene = scene(&format!("{name} {kind}"), vec![widget]);
        Tested.ordinary(&scene);
        let cells = engine::cull(&scene.volume, &scene.look, &scene.camera, &NoProgress)
            .expect("the scene can be drawn");
        let (_, counts) = engine::draw(&cells, &scene.look, &scene.camera, &SHADING, &NoProgress)
            .expect("the scene can be drawn");
        assert_eq!(counts.segments_exact, 0, "{name} {kind}: integrated in 64 bits");
    }
}

fn wave(period: f64, band_width: f64) -> Wave {
    Wave { origin: [0.1, 0.0], angle: 0.3, scale: [1.0, 0.2], period, band_width }
}

#[test]
fn few_and_many_bands() {
    both("one band", wave(3.0, 1.0), 2.0, None);
    both("few bands", wave(0.21, 0.4), 2.0, None);
    both("many bands", wave(0.004, 1.0), 2.0, None);
    both("thin bands", wave(0.1, 0.05), 5.0, None);
}

#[test]
fn cut_by_a_region() {
    let region = Region { corners: vec![[0.2, 0.1], [0.9, 0.3], [0.5, 2.0]] };
    both("in a region", wave(0.13, 0.7), 4.0, Some(region));
}

/// In g alone, and with an origin a million bands away.
#[test]
fn directions_and_origins() {
    both("in g", Wave { angle: std::f64::consts::FRAC_PI_2, ..wave(0.2, 0.5) }, 3.0, None);
    both("far origin", Wave { origin: [2e5, 0.0], ..wave(0.2, 0.5) }, 3.0, None);
}
