//! The device, as the shared scenes ask for it.

use std::sync::{Arc, OnceLock};
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_gpu::{Device, FrameOutput, Renderer};
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, SHADING};

/// The device, where there is one.
pub struct Tested;

impl Engine for Tested {
    fn picture(&self, scene: &NamedScene, shading: &Shading) -> Option<Picture> {
        picture(scene, shading)
    }

    fn serves(&self, integrator: &Integrator, look: &TransferFunction) -> bool {
        voltet_gpu::can_serve(look, &Shading { integrator: *integrator, ..SHADING }).is_ok()
    }

    /// The depth's ends round like the grid's diagonal.
    fn rounding(&self) -> f64 {
        5e-6
    }

    /// A plane of 32-bit corners lies right to 2e-7 of the view's extent, so the depth behind it to 2e-7 / 0.002 × 9.
    fn grazing(&self) -> f64 {
        9e-4
    }
}

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
            voltet_testing::skipped_without_device(why);
            None
        }
    };
    DEVICE.get_or_init(open).clone()
}

/// Draws by tiles.
pub fn draw_tiles(
    renderer: &Renderer,
    scene: &NamedScene,
    shading: &Shading,
    order: VisibilityOrder,
) -> Result<FrameOutput> {
    voltet_gpu::draw(
        renderer,
        &scene.drawn_by(shading, order),
        &RenderOptions { compositing: Some(Compositor::Tiles), ..RenderOptions::default() },
        &NoProgress,
    )
}

/// Draws on the device; `None` without one.
pub fn try_draw(
    scene: &NamedScene,
    shading: &Shading,
    order: VisibilityOrder,
) -> Option<Result<FrameOutput>> {
    let device = device()?;
    let renderer = Renderer::new(device, &scene.volume);
    Some(renderer.and_then(|renderer| draw_tiles(&renderer, scene, shading, order)))
}

/// The device's picture.
pub fn draw(scene: &NamedScene, shading: &Shading, order: VisibilityOrder) -> Option<FrameOutput> {
    Some(try_draw(scene, shading, order)?.unwrap_or_else(|e| panic!("{}: {e}", scene.name)))
}

/// The device's picture in the exact order; `None` without a device.
pub fn picture(scene: &NamedScene, shading: &Shading) -> Option<Picture> {
    let drawn = draw(scene, shading, VisibilityOrder::Exact)?;
    assert_eq!(drawn.counts.pixels_disordered, Some(0), "{}", scene.name);
    Some(drawn.picture)
}

/// Compositor and order.
pub type How = (Compositor, VisibilityOrder);

/// Blended by the hardware, in an order.
pub fn raster(order: VisibilityOrder) -> How {
    (Compositor::Raster, order)
}

/// By tiles, in an order.
pub fn tiles(order: VisibilityOrder) -> How {
    (Compositor::Tiles, order)
}

/// Draws on a device.
pub fn draw_on(device: Arc<Device>, scene: &NamedScene, shading: &Shading, how: How) -> Result<FrameOutput> {
    let (compositing, order) = how;
    let renderer = Renderer::new(device, &scene.volume)?;
    voltet_gpu::draw(
        &renderer,
        &scene.drawn_by(shading, order),
        &RenderOptions { compositing: Some(compositing), ..RenderOptions::default() },
        &NoProgress,
    )
}

/// Another device like that of all tests.
pub fn further_device() -> Device {
    let wish = std::env::var("VOLTET_ADAPTER").ok();
    Device::open(wish.as_deref(), false).expect("opened before")
}
