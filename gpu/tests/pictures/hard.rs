//! What is hard for the device's compositor alone: long lists, more segments than it keeps, surfaces within its limits.

use crate::compare::{SHADING, Scene, ordinary, stiff};
use crate::drawing::draw;
use crate::grids::*;
use crate::looks::*;
use glam::DVec3;
use voltet_core::shading::Order;

/// Hundreds of segments in a pixel, long cells among them: a dispatch that goes on meets cells of every former chunk again.
#[test]
fn deep_pixels_with_long_cells() {
    let base = moved(&cube([2, 780, 2], 0.0), |p| DVec3::new(p.x, 3.0 * p.y, p.z));
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for k in 0..240u32 {
        let share = f64::from(k) / 240.0;
        let [x, z] = [0.754_877_67, 0.569_840_29].map(|step| 0.05 + 0.85 * (step * f64::from(k)).fract());
        let y = 2.9 * share;
        points.extend(
            [[x, y, z], [x + 0.05, y, z], [x, y, z + 0.05], [x + 0.02, 3.1, z + 0.02]].map(DVec3::from),
        );
        cells.push([4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]);
    }
    let s = |p: DVec3| 0.5 + 0.5 * (9.0 * p.y + 2.0 * p.x).sin();
    let scene = Scene {
        name: "deep with long cells".into(),
        volume: volume(together(&[base, grid(points, cells)]), s, |p| p.z),
        look: look(overlapping().widgets.iter().map(|widget| widget.with_extinction_times(0.2)).collect()),
        camera: perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 18.0, [16, 16]),
    };
    ordinary(&scene);
}

/// Many cells that begin at one depth and overlap: a pixel gives up what finds no room, and sweeps again.
#[test]
fn sweeps_lose_nothing() {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for k in 0..60u32 {
        let back = 0.3 + 0.01 * f64::from(k);
        points.extend([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.2, back, 0.2]].map(DVec3::from));
        cells.push([4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]);
    }
    let scene = Scene {
        name: "overlapping cells".into(),
        volume: volume(grid(points, cells), |p| (40.0 * p.y).sin().abs(), |p| 2.0 * p.x),
        look: overlapping(),
        camera: orthographic([0.3, -2.0, 0.3], [0.3, 0.0, 0.3], 0.8, [24, 24]),
    };
    let Some(drawn) = draw(&scene, &SHADING, Order::Exact) else { return };
    assert!(drawn.counts.sweeps_further > 0);
    ordinary(&scene);
}

#[test]
fn surfaces() {
    for sigma in [1e-3, 1e-4] {
        stiff(&Scene {
            name: format!("narrow {sigma:e}"),
            volume: smooth(cube([5, 5, 5], 0.2)),
            look: look(vec![
                gaussian([0.6, 0.8], [sigma, 2.0], 1e4, [1.0, 0.5, 0.15]),
                gaussian([0.35, 0.8], [sigma, 0.6], 5e3, [0.2, 0.5, 1.0]),
            ]),
            camera: outside([64, 64]),
        });
        stiff(&Scene {
            name: format!("sheet {sigma:e}"),
            volume: smooth(cube([5, 5, 5], 0.2)),
            look: look(vec![gaussian([0.6, 0.8], [sigma, 2.0], 0.5 / sigma, [1.0, 0.5, 0.15])]),
            camera: outside([64, 64]),
        });
    }
}
