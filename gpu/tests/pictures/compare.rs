//! Draws a scene on the device and with the referee, and compares.

use std::sync::{Arc, OnceLock};
use voltet_core::camera::Camera;
use voltet_core::optics::Overlap;
use voltet_core::picture::Picture;
use voltet_core::progress::Silent;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Result, reference};
use voltet_gpu::{Device, DeviceGrid, Drawn};

/// What 32-bit segments may leave on an ordinary scene.
pub const ORDINARY: f64 = 2e-4;

/// Everything a picture is made from.
#[derive(Clone)]
pub struct Scene {
    pub name: String,
    pub volume: Arc<Volume>,
    pub look: TransferFunction,
    pub camera: Camera,
}

/// Closed forms, exact overlap, no light.
pub const SHADING: Shading =
    Shading { integrator: Integrator::Analytic, overlap: Overlap::Exact, silhouette: None, light: None };

/// The device of all tests, opened once. `None` where there is no adapter, said loudly; a failure if the environment
/// variable `VOLTET_REQUIRE_GPU` is 1.
pub fn device() -> Option<Arc<Device>> {
    static DEVICE: OnceLock<Option<Arc<Device>>> = OnceLock::new();
    let open = || match Device::open(std::env::var("VOLTET_ADAPTER").ok().as_deref(), false) {
        Ok(device) => {
            println!("adapter: {}", device.name);
            Some(Arc::new(device))
        }
        Err(why) => {
            let required = std::env::var("VOLTET_REQUIRE_GPU").is_ok_and(|value| value == "1");
            assert!(!required, "VOLTET_REQUIRE_GPU is 1, but no device opens: {why}");
            eprintln!("\n*** SKIPPED: {why}; scripts/install-software-vulkan.sh ***\n");
            None
        }
    };
    DEVICE.get_or_init(open).clone()
}

/// Draws on the device; `None` without one.
pub fn try_draw(scene: &Scene, shading: &Shading, order: Order) -> Option<Result<Drawn>> {
    let device = device()?;
    let draw = || {
        let grid = DeviceGrid::new(device, &scene.volume)?;
        voltet_gpu::draw(&grid, &scene.volume, &scene.look, &scene.camera, shading, order, &Silent)
    };
    Some(draw())
}

/// The device's picture.
pub fn draw(scene: &Scene, shading: &Shading, order: Order) -> Option<Drawn> {
    Some(try_draw(scene, shading, order)?.unwrap_or_else(|e| panic!("{}: {e}", scene.name)))
}

/// The referee's picture.
pub fn referee(scene: &Scene, shading: &Shading) -> Picture {
    reference::draw(&scene.volume, &scene.look, &scene.camera, shading, Order::Exact, &Silent)
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Asserts the bound of ordinary scenes, and that there is something to see.
pub fn ordinary(scene: &Scene) {
    ordinary_shaded(scene, &SHADING);
}

/// The same with another shading.
pub fn ordinary_shaded(scene: &Scene, shading: &Shading) {
    let Some(drawn) = draw(scene, shading, Order::Exact) else { return };
    let expected = referee(scene, shading);
    let covered = expected.rgba.iter().filter(|p| p[3] > 0.01).count();
    assert!(covered > 0, "{}: the scene shows nothing, so it proves nothing", scene.name);
    assert_eq!(drawn.counts.pixels_disordered, 0, "{}", scene.name);
    within(&scene.name, &drawn.picture, &expected, ORDINARY);
}

/// Asserts that no pixel differs by more than `bound` and none is not finite.
pub fn within(name: &str, actual: &Picture, expected: &Picture, bound: f64) {
    let errors = errors(actual, expected);
    let (worst, at) = worst(&errors);
    let beyond = errors.iter().filter(|e| **e > bound).count();
    let (i, j) = (at % actual.width, at / actual.width);
    assert!(
        beyond == 0,
        "{name}: {beyond} of {} pixels differ by more than {bound:e}, at most {worst:e} at ({i}, {j}): {:?} for {:?}",
        errors.len(),
        actual.rgba[at],
        expected.rgba[at],
    );
    println!("{name}: at most {worst:.2e}");
}

/// Asserts the bound of stiff scenes: 99.9 % of the pixels within 1/255, all finite.
pub fn stiff(scene: &Scene) {
    let Some(drawn) = draw(scene, &SHADING, Order::Exact) else { return };
    let expected = referee(scene, &SHADING);
    let errors = errors(&drawn.picture, &expected);
    let beyond = errors.iter().filter(|e| **e > 1.0 / 255.0).count();
    let broken = errors.iter().filter(|e| !e.is_finite()).count();
    println!("{}: {beyond} of {} beyond 1/255, at most {:.2e}", scene.name, errors.len(), worst(&errors).0);
    assert!(expected.rgba.iter().any(|p| p[3] > 0.01), "{}: nothing to see", scene.name);
    assert!(
        broken == 0 && beyond as f64 <= 0.001 * errors.len() as f64,
        "{}: {beyond} of {} pixels differ by more than 1/255 ({broken} not finite)",
        scene.name,
        errors.len()
    );
}

/// The largest difference of each pixel's channels; infinite where a value is not finite.
pub fn errors(actual: &Picture, expected: &Picture) -> Vec<f64> {
    assert_eq!((actual.width, actual.height), (expected.width, expected.height), "the pictures' sizes");
    let pixel = |(a, b): (&[f32; 4], &[f32; 4])| {
        let channel = |(x, y): (&f32, &f32)| (f64::from(*x) - f64::from(*y)).abs();
        let finite = a.iter().chain(b).all(|x| x.is_finite());
        if finite { a.iter().zip(b).map(channel).fold(0.0, f64::max) } else { f64::INFINITY }
    };
    actual.rgba.iter().zip(&expected.rgba).map(pixel).collect()
}

fn worst(errors: &[f64]) -> (f64, usize) {
    let at = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
    (errors[at], at)
}
