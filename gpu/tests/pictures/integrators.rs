//! Every integrator on the scenes that it can serve, each within the error that its sampling or table leaves: the bounds of
//! the native engine's own test.

use crate::compare::{ORDINARY, SHADING, Scene, draw, referee, within};
use crate::grids::{cube, smooth};
use crate::looks::*;
use voltet_core::optics::integrators::can_serve;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::{OpticalModel, TransferFunction};

const BOUNDS: [(Integrator, f64); 7] = [
    (Integrator::Analytic, ORDINARY),
    (Integrator::Adaptive { tolerance: 1e-5 }, ORDINARY),
    // An edge of a region or of a glow is misplaced by up to half a piece.
    (Integrator::Segments { count: 64, table_size: 256 }, 1e-2),
    (Integrator::Riemann { count: 64 }, 1e-2),
    // Corners of the function between nodes.
    (Integrator::PreIntegrated { table_size: 64 }, 4e-3),
    (Integrator::PreIntegratedCylindrical { table_size: 64 }, 8e-3),
    (Integrator::Clipped, ORDINARY),
];

fn compare(name: &str, look: TransferFunction, count: usize) {
    let scene = |name: String| Scene {
        name,
        volume: smooth(cube([5, 5, 5], 0.2)),
        look: look.clone(),
        camera: outside([40, 32]),
    };
    let expected = referee(&scene(name.into()), &SHADING);
    assert!(expected.rgba.iter().any(|p| p[3] > 0.1), "{name}: the scene shows nothing");
    let mut served = 0;
    for (integrator, bound) in BOUNDS {
        if can_serve(&integrator, &look).is_err() {
            continue;
        }
        let scene = scene(format!("{name} by {}", integrator.name()));
        let Some(drawn) = draw(&scene, &Shading { integrator, ..SHADING }, Order::Exact) else { return };
        within(&scene.name, &drawn.picture, &expected, bound);
        served += 1;
    }
    assert_eq!(served, count, "{name}");
}

#[test]
fn a_function_of_the_scalar_is_served_by_all() {
    compare("ramp", ramp(), 7);
    let model = OpticalModel::ConstantEmitter { cutoff: 0.0 };
    compare("glowing ramp", TransferFunction { model, ..ramp() }, 7);
}

#[test]
fn bivariate_widgets_are_served_by_all_but_tables_of_the_scalar() {
    compare("gaussian", one_gaussian(), 4);
    compare("overlap", overlapping(), 4);
    let model = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };
    compare("glowing overlap", TransferFunction { model, ..overlapping() }, 4);
}
