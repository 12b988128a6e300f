//! Every integrator on the scenes that it can serve, each within the error that its sampling or table leaves. Tests
//! of all engines; the native one has the reference too.

use super::Engine;
use super::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use super::grids::{cube, smooth};
use super::looks::*;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments};
use voltet_optics::shading::{Integrator, Shading};
use voltet_reference::REFERENCE;

/// Each integrator with the error that it may leave in a picture of [`scene`]. Those that sample are of second order
/// where the function is smooth (1e-5 here), but misplace the edge of a region or of a glow by up to half a piece:
/// 0.35/128 of length, which at a rate of 6.5 is a depth of 0.018, and half of that on the mean.
const BOUNDS: [(Integrator, f64); 7] = [
    (Integrator::ANALYTIC, ORDINARY),
    // A ray crosses under 40 cells: at most 4e-4, and in truth a small part of it.
    (Integrator::adaptive(1e-5), ORDINARY),
    (segments(64, 256), 1e-2),
    (riemann(64), 1e-2),
    // Corners of the function between nodes.
    (pre_integrated(128, 2), 2e-3),
    (pre_integrated_cylindrical(128, 2, 1), 4e-3),
    (REFERENCE, ORDINARY),
];

fn scene(name: &str, look: TransferFunction) -> NamedScene {
    NamedScene { name: name.into(), volume: smooth(cube([5, 5, 5], 0.2)), look, camera: outside([64, 48]) }
}

fn compare(engine: &dyn Engine, name: &str, look: TransferFunction, wanted: &[&str]) {
    let expected = referee(&scene(name, look.clone()));
    assert!(expected.rgba.iter().any(|p| p[3] > 0.1), "{name}: the scene shows nothing");
    let mut served = Vec::new();
    for (integrator, bound) in BOUNDS {
        if !engine.serves(&integrator, &look) {
            continue;
        }
        let scene = scene(&format!("{name} by {}", integrator.name()), look.clone());
        let Some(actual) = engine.picture(&scene, &Shading { integrator, ..SHADING }) else { return };
        within(&scene.name, &actual, &expected, bound);
        served.push(integrator.name());
    }
    let mut wanted = wanted.to_vec();
    wanted.extend(engine.serves(&REFERENCE, &look).then_some("reference"));
    assert_eq!(served, wanted, "{name}");
}

/// The names of all integrators but the referee's, those first that serve any widget.
pub const NAMES: [&str; 6] =
    ["analytic", "adaptive", "segments", "riemann", "pre-integrated", "pre-integrated-cylindrical"];

/// Integrators that support any widget.
const ALWAYS: &[&str] = NAMES.split_at(4).0;

pub fn a_function_of_the_scalar_is_served_by_all(engine: &dyn Engine) {
    compare(engine, "ramp", ramp(), &NAMES);
    let model = OpticalModel::ConstantEmitter { cutoff: 0.0 };
    compare(engine, "glowing ramp", TransferFunction { model, ..ramp() }, &NAMES);
}

pub fn bivariate_widgets_are_served_by_all_but_tables_of_the_scalar(engine: &dyn Engine) {
    compare(engine, "gaussian", one_gaussian(), ALWAYS);
    compare(engine, "overlap", overlapping(), ALWAYS);
    let model = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };
    compare(engine, "glowing overlap", TransferFunction { model, ..overlapping() }, ALWAYS);
}
