//! Scenes whose truth is a formula: slabs, ramps, subdivision, rays that lie in shared faces. Tests of all engines.

use super::Engine;
use super::compare::{NamedScene, SHADING, referee, within};
use super::grids::{cube, grid, smooth, subdivided, volume};
use super::looks::*;
use glam::DVec3;
use voltet_core::picture::Picture;

const COLOR: [f64; 3] = [1.0, 0.5, 0.25];

/// One colour over an opacity that is known.
fn known(width: usize, height: usize, opacity: f64) -> Picture {
    let [r, g, b] = COLOR.map(|c| (c * opacity) as f32);
    Picture { width, height, rgba: vec![[r, g, b, opacity as f32]; width * height] }
}

/// Rays along each axis through a cube cut so that many lie exactly in faces and edges of cells: 1 − e^(−ρ) in
/// every pixel, none covered twice or missed.
pub fn rays_in_shared_faces_and_edges(engine: &dyn Engine) {
    let views = [([0.5, -2.0, 0.5], [0.5, 0.0, 0.5]), ([-2.0, 0.5, 0.5], [0.0, 0.5, 0.5])];
    for counts in [[1, 1, 1], [2, 2, 2], [4, 4, 4], [5, 3, 7]] {
        for (k, (eye, target)) in views.into_iter().enumerate() {
            for pixels in [8, 9, 20, 35, 64] {
                let scene = NamedScene {
                    name: format!("faces {counts:?} view {k} {pixels}"),
                    volume: volume(cube(counts, 0.0), |_| 0.5, |_| 0.0),
                    look: look(vec![everywhere(2.0, COLOR)]),
                    camera: orthographic(eye, target, 1.0, [pixels, pixels]),
                };
                let exact = known(pixels as usize, pixels as usize, -(-2f64).exp_m1());
                within(&format!("referee {}", scene.name), &referee(&scene), &exact, 1e-6);
                engine.matches(&scene, &exact, engine.rounding());
            }
        }
    }
}

/// Perspective rays through the middle of a symmetric cube also meet edges and diagonals.
pub fn perspective_rays_in_shared_faces(engine: &dyn Engine) {
    for pixels in [9, 15, 33] {
        engine.ordinary(&NamedScene {
            name: format!("faces perspective {pixels}"),
            volume: volume(cube([4, 4, 4], 0.0), |_| 0.5, |_| 0.0),
            look: look(vec![everywhere(2.0, COLOR)]),
            camera: perspective([0.5, -2.0, 0.5], [0.5, 0.5, 0.5], 25.0, [pixels, pixels]),
        });
    }
}

/// s rises along the view from 0 to 1, extinction from 0 to 6: T = 3 in every pixel.
pub fn ramp_along_the_view(engine: &dyn Engine) {
    for counts in [[1, 1, 1], [3, 8, 3]] {
        let scene = NamedScene {
            name: format!("ramp along {counts:?}"),
            volume: volume(cube(counts, 0.0), |p| p.y, |_| 1.0),
            look: look(vec![points(&[[0.0, 1.0, 0.5, 0.25, 0.0], [1.0, 1.0, 0.5, 0.25, 6.0]])]),
            camera: orthographic([0.503, -2.0, 0.507], [0.503, 0.0, 0.507], 0.9, [30, 30]),
        };
        engine.matches(&scene, &known(30, 30, -(-3f64).exp_m1()), 2.0 * engine.rounding());
    }
}

/// s rises along the view, a Gaussian in its middle: T = ρ₀ σ √(2π) erf(½/√2σ), erf(2.5 √2) = 1 − 5.7e-7.
pub fn gaussian_along_the_view(engine: &dyn Engine) {
    let scene = NamedScene {
        name: "gaussian along".into(),
        volume: volume(cube([3, 5, 3], 0.0), |p| p.y, |_| 1.0),
        look: look(vec![gaussian([0.5, 1.0], [0.1, 0.5], 4.0, COLOR)]),
        camera: orthographic([0.503, -2.0, 0.507], [0.503, 0.0, 0.507], 0.9, [30, 30]),
    };
    let depth = 0.4 * std::f64::consts::TAU.sqrt() * (1.0 - 5.733e-7);
    engine.matches(&scene, &known(30, 30, -(-depth).exp_m1()), 2.0 * engine.rounding());
}

/// The field is linear in each cell, so cutting cells changes nothing; twice the ordinary bound would hide
/// nothing that the referee's own comparison does not show.
pub fn subdividing_cells_leaves_the_picture(engine: &dyn Engine) {
    let base = cube([3, 3, 3], 0.2);
    let s = |p: DVec3| 0.2 * p.x + 0.3 * p.y + 0.5 * p.z;
    let scene = |grid| NamedScene {
        name: "subdivided".into(),
        volume: volume(grid, s, |p| 1.0 + p.x),
        look: overlapping(),
        camera: outside([64, 64]),
    };
    let finer = subdivided(&base);
    let Some(expected) = engine.picture(&scene(base), &SHADING) else { return };
    engine.matches(&scene(finer.clone()), &expected, 1e-4);
    engine.ordinary(&NamedScene {
        name: "subdivided".into(),
        volume: smooth(subdivided(&finer)),
        look: overlapping(),
        camera: outside([64, 64]),
    });
}

/// A medium that only absorbs is free of the order of its cells: T adds up. Cells in reverse grid order draw the same.
pub fn cell_numbering_does_not_matter(engine: &dyn Engine) {
    let base = cube([4, 4, 4], 0.2);
    let mut cells = base.tetrahedra.to_vec();
    cells.reverse();
    let scene = |grid| {
        let (name, camera) = ("reversed".into(), outside([50, 50]));
        NamedScene { name, volume: smooth(grid), look: overlapping(), camera }
    };
    let reversed = scene(grid(base.points.to_vec(), cells));
    let Some(expected) = engine.picture(&scene(base), &SHADING) else { return };
    engine.matches(&reversed, &expected, 1e-5);
}
