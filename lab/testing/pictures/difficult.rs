//! Grids and fields that are hard: non-convex, cyclic, flat, far away, deep, huge and tiny cells. Tests of all engines.

use super::Engine;
use super::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use super::grids::*;
use super::looks::*;
use glam::DVec3;
use voltet_core::camera::Camera;

pub fn two_arms_with_an_opening(engine: &dyn Engine) {
    for (name, eye) in [("front", [0.7, -2.0, 0.8]), ("side", [2.5, 0.3, 1.4]), ("end", [3.0, 0.5, 0.5])] {
        engine.ordinary(&NamedScene {
            name: format!("arms {name}"),
            volume: smooth(two_arms()),
            look: overlapping(),
            camera: perspective(eye, [0.5, 0.5, 0.5], 35.0, [72, 56]),
        });
    }
}

pub fn disconnected(engine: &dyn Engine) {
    let parts: Vec<_> = (0..4)
        .map(|k| moved(&cube([2, 2, 2], 0.2), |p| 0.22 * p + 0.26 * f64::from(k) * DVec3::ONE))
        .collect();
    engine.ordinary(&NamedScene {
        name: "disconnected".into(),
        volume: smooth(together(&parts)),
        look: ramp(),
        camera: outside([64, 64]),
    });
}

/// Each bar has its own colour, dense enough that the front one wins.
pub fn cyclic_order(engine: &dyn Engine) {
    let bars = cyclic_bars();
    let each = bars.points.len() / 3;
    let values = (0..bars.points.len()).map(|k| (k / each) as f64).collect::<Vec<_>>();
    let mut volume = (*volume(bars, |_| 0.0, |_| 0.0)).clone();
    volume.scalar = values.into();
    let volume = std::sync::Arc::new(volume);
    let colors = points(&[[0.0, 1.0, 0.0, 0.0, 9.0], [1.0, 0.0, 1.0, 0.0, 9.0], [2.0, 0.0, 0.0, 1.0, 9.0]]);
    for (name, camera, bound) in [
        ("above", orthographic([0.0, -0.01, 5.0], [0.0, 0.0, 0.0], 3.6, [90, 90]), engine.grazing()),
        ("below", perspective([0.1, -0.2, -5.0], [0.0, 0.0, 0.0], 40.0, [90, 90]), ORDINARY),
    ] {
        let scene = NamedScene {
            name: format!("cyclic {name}"),
            volume: volume.clone(),
            look: look(vec![colors.clone()]),
            camera,
        };
        engine.close(&scene, &SHADING, bound);
    }
}

pub fn flat_cells(engine: &dyn Engine) {
    for thickness in [1e-3, 1e-6, 1e-9, 1e-12, 0.0] {
        for (name, camera) in [
            ("across", orthographic([-2.0, 0.503, 0.507], [0.0, 0.503, 0.507], 0.9, [40, 40])),
            ("along", orthographic([0.503, -2.0, 0.507], [0.503, 0.0, 0.507], 0.9, [40, 40])),
            ("oblique", outside([48, 48])),
        ] {
            engine.ordinary(&NamedScene {
                name: format!("flat {thickness:e} {name}"),
                volume: smooth(with_flat_layer(thickness)),
                look: overlapping(),
                camera,
            });
        }
    }
}

/// Cells with four points in a plane, on a line, or in one place change nothing.
fn without_volume(engine: &dyn Engine, name: &str, cells: impl Fn(u32) -> Vec<[u32; 4]>) {
    let base = cube([3, 3, 3], 0.0);
    let mut points = base.points.to_vec();
    let first = points.len() as u32;
    points.extend([
        DVec3::new(0.1, 0.1, 0.1),
        DVec3::new(0.9, 0.2, 0.3),
        DVec3::new(0.2, 0.9, 0.6),
        // The mean of those three, to rounding: a cell as flat as numbers allow.
        DVec3::new(0.4, 0.4, 1.0 / 3.0),
        DVec3::new(0.1, 0.1, 0.1),
    ]);
    let mut all = base.tetrahedra.to_vec();
    all.extend(cells(first));
    let camera = outside([64, 64]);
    let scene = |grid| NamedScene { name: name.into(), volume: smooth(grid), look: overlapping(), camera };
    let with = scene(grid(points, all));
    let expected = referee(&scene(base));
    within(&format!("referee {name}"), &referee(&with), &expected, 1e-7);
    engine.matches(&with, &expected, ORDINARY);
}

pub fn cells_in_a_plane(engine: &dyn Engine) {
    without_volume(engine, "coplanar", |first| {
        vec![[first, first + 1, first + 2, first + 3], [first, first + 1, first + 2, first + 4]]
    });
}

pub fn cells_with_equal_points(engine: &dyn Engine) {
    without_volume(engine, "equal points", |_| vec![[5, 5, 9, 11], [7, 7, 7, 7], [3, 3, 3, 30]]);
}

/// Points 0 to 3 lie on an edge of the cube, points 0, 21, 42, 63 on its diagonal.
pub fn cells_on_a_line(engine: &dyn Engine) {
    without_volume(engine, "collinear", |_| vec![[0, 1, 2, 3], [0, 21, 42, 63]]);
}

pub fn scaled_and_far_away(engine: &dyn Engine) {
    let base = cube([4, 4, 4], 0.2);
    for (scale, offset) in [
        (1e-20, DVec3::ZERO),
        (1e20, DVec3::ZERO),
        (1.0, DVec3::new(1e6, -1e6, 1e6)),
        (1e-3, DVec3::new(1e3, 1e3, -1e3)),
        (1e20, DVec3::new(1e26, 0.0, -1e26)),
    ] {
        let place = |p: DVec3| offset + scale * p;
        // The field is that of the cube, whatever digits the place has left.
        let mut far = (*smooth(base.clone())).clone();
        far.grid = std::sync::Arc::new(moved(&base, place));
        for (name, view) in [
            ("outside", outside([56, 56])),
            ("inside", perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [56, 56])),
            ("ortho", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [56, 56])),
        ] {
            let mut camera = Camera { eye: place(view.eye), target: place(view.target), ..view };
            if let voltet_core::camera::Projection::Orthographic { height } = &mut camera.projection {
                *height *= scale;
            }
            let mut look = overlapping();
            look.unit_distance = scale;
            engine.ordinary(&NamedScene {
                name: format!("scale {scale:e} offset {:e} {name}", offset.x),
                volume: std::sync::Arc::new(far.clone()),
                look,
                camera,
            });
        }
    }
}

pub fn constant_field(engine: &dyn Engine) {
    engine.ordinary(&NamedScene {
        name: "constant".into(),
        volume: volume(cube([4, 4, 4], 0.2), |_| 0.55, |_| 0.0),
        look: look(vec![
            gaussian([0.5, 0.0], [0.1, 0.5], 2.0, [1.0, 0.5, 0.2]),
            points(&[[0.0, 0.1, 0.2, 0.3, 0.0], [1.0, 0.9, 0.8, 0.7, 1.0]]),
        ]),
        camera: outside([64, 64]),
    });
}

/// s near 1e8 varies by 1e-2: its 64-bit digits are enough, 32-bit ones are not.
pub fn large_values_that_hardly_vary(engine: &dyn Engine) {
    let (base, span) = (1e8, 1e-2);
    let volume = volume(cube([5, 5, 5], 0.2), |p| base + span * smooth_s(p), |p| span * smooth_g(p));
    for (name, widgets) in [
        (
            "gaussian",
            vec![gaussian([base + 0.6 * span, 0.8 * span], [0.1 * span, 0.5 * span], 4.0, [1.0, 0.5, 0.2])],
        ),
        (
            "ramp",
            vec![points(&[
                [base, 0.1, 0.2, 0.9, 0.0],
                [base + 0.5 * span, 0.9, 0.7, 0.1, 2.0],
                [base + span, 1.0, 0.1, 0.1, 0.5],
            ])],
        ),
        (
            "polygon",
            vec![polygon(
                &[
                    [base, 0.0],
                    [base + 0.6 * span, 0.0],
                    [base + 0.5 * span, 2.0 * span],
                    [base + 0.2 * span, span],
                ],
                3.0,
                [0.3, 0.9, 0.4],
            )],
        ),
    ] {
        engine.ordinary(&NamedScene {
            name: format!("offset values {name}"),
            volume: volume.clone(),
            look: look(widgets),
            camera: outside([64, 64]),
        });
    }
}

/// More than 1,024 segments in a pixel.
pub fn deep_pixels(engine: &dyn Engine) {
    let base = moved(&cube([2, 700, 2], 0.0), |p| DVec3::new(p.x, 3.0 * p.y, p.z));
    let volume = volume(base, |p| 0.5 + 0.5 * (9.0 * p.y + 2.0 * p.x).sin(), |p| p.z);
    for (name, look) in [("ramp", ramp()), ("overlap", overlapping())] {
        engine.ordinary(&NamedScene {
            name: format!("deep {name}"),
            volume: volume.clone(),
            look,
            camera: perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 18.0, [24, 20]),
        });
    }
}

/// One cell over the whole picture, from outside and from inside.
pub fn huge_cell(engine: &dyn Engine) {
    let corners = [[-50.0, 10.0, -50.0], [60.0, 11.0, -45.0], [1.0, 12.0, 70.0], [0.0, 30.0, 2.0]];
    let one = grid(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]]);
    let volume = volume(one, |p| 0.5 + 0.01 * p.x, |p| 0.8 + 0.01 * p.z);
    let mut look = overlapping();
    look.unit_distance = 10.0;
    for (name, eye) in [("outside", [0.0, 0.0, 0.0]), ("inside", [0.0, 14.0, 2.0])] {
        engine.ordinary(&NamedScene {
            name: format!("huge cell {name}"),
            volume: volume.clone(),
            look: look.clone(),
            camera: perspective(eye, [0.0, 40.0, 1.0], 30.0, [70, 50]),
        });
    }
}

/// Thousands of cells in one pixel.
pub fn tiny_cells(engine: &dyn Engine) {
    for (name, height) in [("one pixel", 40.0), ("some pixels", 4.0)] {
        engine.ordinary(&NamedScene {
            name: format!("tiny cells {name}"),
            volume: smooth(cube([12, 12, 12], 0.2)),
            look: overlapping(),
            camera: orthographic([3.1, -2.0, 2.5], [0.51, 0.52, 0.53], height, [21, 21]),
        });
    }
}

/// Two cells on the same side of a face that they share: both begin there, and the one that ends first comes first.
pub fn cells_that_overlap_behind_a_shared_face(engine: &dyn Engine) {
    let mut points = Vec::new();
    let mut cells = Vec::new();
    for k in 0..12u32 {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, f64::from(k), 0.3 * f64::from(k), 0.0);
        let at = 2.0 * DVec3::new(f64::from(k % 4), f64::from(k / 4), 0.0);
        let corners = [[0.0, 0.0, 0.0], [0.8, 0.1, 0.0], [0.2, 0.9, 0.1], [0.3, 0.3, 0.4], [0.4, 0.3, 0.9]];
        points.extend(corners.map(|p| at + turn * DVec3::from(p)));
        cells.extend([[0, 1, 2, 3], [0, 1, 2, 4]].map(|cell| cell.map(|p| p + 5 * k)));
    }
    let s = |p: DVec3| (37.0 * (p.x + 2.0 * p.y - 3.0 * p.z)).sin().abs();
    engine.ordinary(&NamedScene {
        name: "overlap behind a face".into(),
        volume: volume(grid(points, cells), s, |p| 2.0 * p.y.sin().abs()),
        look: overlapping(),
        camera: orthographic([3.0, -4.0, 9.0], [3.0, 2.0, 0.0], 8.0, [90, 80]),
    });
}
