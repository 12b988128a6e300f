//! Surfaces: extinction up to 1e8, Gaussians of a millionth of the range.

use crate::drawing::Tested;
use voltet_core::transfer::Widget;
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::NamedScene;
use voltet_testing::pictures::grids::{cube, smooth, volume};
use voltet_testing::pictures::looks::*;

/// Isosurfaces of a smooth field: σ from 1e-3 to 1e-6 of the range, opaque.
#[test]
fn narrow_gaussians() {
    for sigma in [1e-3, 1e-4, 1e-5, 1e-6] {
        for extinction in [1e4, 1e8] {
            Tested.stiff(&NamedScene {
                name: format!("narrow {sigma:e} {extinction:e}"),
                volume: smooth(cube([5, 5, 5], 0.2)),
                look: look(vec![
                    gaussian([0.6, 0.8], [sigma, 2.0], extinction, [1.0, 0.5, 0.15]),
                    gaussian([0.35, 0.8], [sigma, 0.6], 0.5 * extinction, [0.2, 0.5, 1.0]),
                ]),
                camera: outside([96, 96]),
            });
        }
    }
}

/// Half-transparent sheets: σ × extinction is what counts.
#[test]
fn narrow_and_half_transparent() {
    for sigma in [1e-3, 1e-4, 1e-5, 1e-6] {
        Tested.stiff(&NamedScene {
            name: format!("sheet {sigma:e}"),
            volume: smooth(cube([5, 5, 5], 0.2)),
            look: look(vec![gaussian([0.6, 0.8], [sigma, 2.0], 0.5 / sigma, [1.0, 0.5, 0.15])]),
            camera: outside([96, 96]),
        });
    }
}

fn step(name: &str, widget: Widget) {
    Tested.stiff(&NamedScene {
        name: name.into(),
        volume: smooth(cube([5, 5, 5], 0.2)),
        look: look(vec![widget, everywhere(0.3, [0.1, 0.1, 0.2])]),
        camera: outside([96, 96]),
    });
}

/// A hard surface in a thin mist, by control points close together.
#[test]
fn step_between_control_points() {
    step("step points", points(&[[0.6, 0.9, 0.5, 0.2, 0.0], [0.6 + 1e-6, 0.9, 0.5, 0.2, 1e8]]));
}

/// Step at a region's edge: the contribution of the mist in front of the edge must not be lost.
#[test]
fn step_at_a_regions_edge() {
    let corners = [[0.2, 0.0], [0.3, 0.0], [0.31, 3.0], [0.2, 3.0]];
    step("step polygon", polygon(&corners, 1e8, [0.2, 0.9, 0.4]));
}

/// Extinction 1e8 all over a part of the volume, and a thin one in front.
#[test]
fn opaque_behind_thin() {
    Tested.stiff(&NamedScene {
        name: "opaque behind thin".into(),
        volume: volume(cube([4, 4, 4], 0.2), |p| p.y, |_| 1.0),
        look: look(vec![
            points(&[[0.0, 0.2, 0.4, 1.0, 0.5], [0.5, 0.2, 0.4, 1.0, 0.5], [0.500001, 1.0, 0.2, 0.1, 1e8]]),
            gaussian([0.25, 1.0], [1e-5, 1.0], 3e4, [0.9, 0.9, 0.1]),
        ]),
        camera: outside([96, 96]),
    });
}

/// The bands also in a field near 1e8, where a band is a thousandth of the last 32-bit digit.
#[test]
fn narrow_and_offset() {
    Tested.stiff(&NamedScene {
        name: "narrow offset".into(),
        volume: volume(cube([5, 5, 5], 0.2), |p| 1e8 + voltet_testing::pictures::grids::smooth_s(p), |_| 0.0),
        look: look(vec![gaussian([1e8 + 0.6, 0.0], [1e-4, f64::INFINITY], 1e6, [1.0, 0.5, 0.15])]),
        camera: outside([96, 96]),
    });
}
