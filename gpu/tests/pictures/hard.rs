//! Grids that are hard: rays in faces and edges, holes, cycles, flat cells, deep pixels, huge and tiny cells, far places.

use crate::compare::{SHADING, Scene, draw, ordinary, stiff, within};
use crate::grids::*;
use crate::looks::*;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::shading::Order;

const COLOR: [f64; 3] = [1.0, 0.5, 0.25];

/// Rays along each axis through a cube cut so that many lie exactly in faces and edges of cells: 1 − e^(−ρ) in every
/// pixel, none covered twice or missed. 5e-6: rounding of a dozen 32-bit segments, whose ends round like the grid's
/// diagonal.
#[test]
fn rays_in_shared_faces_and_edges() {
    let views = [([0.5, -2.0, 0.5], [0.5, 0.0, 0.5]), ([-2.0, 0.5, 0.5], [0.0, 0.5, 0.5])];
    for counts in [[1, 1, 1], [2, 2, 2], [4, 4, 4], [5, 3, 7]] {
        for (k, (eye, target)) in views.into_iter().enumerate() {
            for pixels in [8u32, 9, 20, 35] {
                for (kind, look) in [
                    ("sum", look(vec![everywhere(2.0, COLOR)])),
                    ("exact", look(vec![everywhere(1.0, COLOR), everywhere(1.0, [1.0, 0.5, 0.2500001])])),
                ] {
                    let scene = Scene {
                        name: format!("faces {counts:?} view {k} {pixels} {kind}"),
                        volume: volume(cube(counts, 0.0), |_| 0.5, |_| 0.0),
                        look,
                        camera: orthographic(eye, target, 1.0, [pixels, pixels]),
                    };
                    let Some(drawn) = draw(&scene, &SHADING, Order::Exact) else { return };
                    let opacity = -(-2f64).exp_m1();
                    let [r, g, b] = COLOR.map(|c| (c * opacity) as f32);
                    let n = pixels as usize;
                    let rgba = vec![[r, g, b, opacity as f32]; n * n];
                    let known = Picture { width: n, height: n, rgba };
                    within(&scene.name, &drawn.picture, &known, 5e-6);
                }
            }
        }
    }
}

#[test]
fn perspective_rays_in_shared_faces() {
    for pixels in [9, 15, 33] {
        ordinary(&Scene {
            name: format!("faces perspective {pixels}"),
            volume: volume(cube([4, 4, 4], 0.0), |_| 0.5, |_| 0.0),
            look: look(vec![everywhere(2.0, COLOR)]),
            camera: perspective([0.5, -2.0, 0.5], [0.5, 0.5, 0.5], 25.0, [pixels, pixels]),
        });
    }
}

#[test]
fn holes_and_cycles() {
    ordinary(&Scene {
        name: "arms".into(),
        volume: smooth(two_arms()),
        look: overlapping(),
        camera: perspective([0.7, -2.0, 0.8], [0.5, 0.5, 0.5], 35.0, [56, 48]),
    });
    let bars = cyclic_bars();
    let each = bars.points.len() / 3;
    let values = (0..bars.points.len()).map(|k| (k / each) as f64).collect();
    let mut bars = (*volume(bars, |_| 0.0, |_| 0.0)).clone();
    bars.scalar = Arc::new(values);
    let colors = points(&[[0.0, 1.0, 0.0, 0.0, 9.0], [1.0, 0.0, 1.0, 0.0, 9.0], [2.0, 0.0, 0.0, 1.0, 9.0]]);
    ordinary(&Scene {
        name: "cycle".into(),
        volume: Arc::new(bars),
        look: look(vec![colors]),
        camera: perspective([0.1, -0.2, -5.0], [0.0, 0.0, 0.0], 40.0, [64, 64]),
    });
}

#[test]
fn flat_cells() {
    for thickness in [1e-3, 1e-6, 1e-9, 1e-12, 0.0] {
        for (name, camera) in [
            ("across", orthographic([-2.0, 0.503, 0.507], [0.0, 0.503, 0.507], 0.9, [32, 32])),
            ("along", orthographic([0.503, -2.0, 0.507], [0.503, 0.0, 0.507], 0.9, [32, 32])),
            ("oblique", outside([40, 40])),
        ] {
            ordinary(&Scene {
                name: format!("flat {thickness:e} {name}"),
                volume: smooth(with_flat_layer(thickness)),
                look: overlapping(),
                camera,
            });
        }
    }
}

#[test]
fn scaled_and_far_away() {
    let base = cube([4, 4, 4], 0.2);
    for (scale, offset) in [
        (1e-20, DVec3::ZERO),
        (1e20, DVec3::ZERO),
        (1.0, DVec3::new(1e6, -1e6, 1e6)),
        (1e20, DVec3::new(1e26, 0.0, -1e26)),
    ] {
        let place = |p: DVec3| offset + scale * p;
        let mut far = (*smooth(base.clone())).clone();
        far.grid = Arc::new(moved(&base, place));
        for (name, view) in [
            ("outside", outside([40, 40])),
            ("inside", perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [40, 40])),
            ("ortho", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [40, 40])),
        ] {
            let mut camera = Camera { eye: place(view.eye), target: place(view.target), ..view };
            if let voltet_core::camera::Projection::Orthographic { height } = &mut camera.projection {
                *height *= scale;
            }
            let mut look = overlapping();
            look.unit_distance = scale;
            ordinary(&Scene {
                name: format!("scale {scale:e} offset {:e} {name}", offset.x),
                volume: Arc::new(far.clone()),
                look,
                camera,
            });
        }
    }
}

/// More than 1,024 segments in a pixel; more cells in a tile than a block of the sort.
#[test]
fn deep_pixels() {
    let base = moved(&cube([2, 700, 2], 0.0), |p| DVec3::new(p.x, 3.0 * p.y, p.z));
    let volume = volume(base, |p| 0.5 + 0.5 * (9.0 * p.y + 2.0 * p.x).sin(), |p| p.z);
    for (name, look) in [("ramp", ramp()), ("overlap", overlapping())] {
        ordinary(&Scene {
            name: format!("deep {name}"),
            volume: volume.clone(),
            look,
            camera: perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 18.0, [24, 20]),
        });
    }
}

/// The same with long cells among them: a dispatch that goes on meets cells of every former chunk again.
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

#[test]
fn huge_cell() {
    let corners = [[-50.0, 10.0, -50.0], [60.0, 11.0, -45.0], [1.0, 12.0, 70.0], [0.0, 30.0, 2.0]];
    let one = grid(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]]);
    let volume = volume(one, |p| 0.5 + 0.01 * p.x, |p| 0.8 + 0.01 * p.z);
    let mut look = overlapping();
    look.unit_distance = 10.0;
    for (name, eye) in [("outside", [0.0, 0.0, 0.0]), ("inside", [0.0, 14.0, 2.0])] {
        ordinary(&Scene {
            name: format!("huge cell {name}"),
            volume: volume.clone(),
            look: look.clone(),
            camera: perspective(eye, [0.0, 40.0, 1.0], 30.0, [56, 40]),
        });
    }
}

/// Thousands of cells in one pixel: far more segments between two depths than a pixel holds at a time.
#[test]
fn tiny_cells() {
    for (name, height) in [("one pixel", 40.0), ("some pixels", 4.0)] {
        ordinary(&Scene {
            name: format!("tiny cells {name}"),
            volume: smooth(cube([12, 12, 12], 0.2)),
            look: overlapping(),
            camera: orthographic([3.1, -2.0, 2.5], [0.51, 0.52, 0.53], height, [21, 21]),
        });
    }
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
