//! Draws a volume on a device.

use crate::frame::inputs::inputs;
use crate::frame::output::FrameOutput;
use crate::frame::plan::{Plan, check, plan, tiles_instead};
use crate::frame::renderer::Renderer;
use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_optics::engine::RenderOptions;
use voltet_optics::scene::Scene;

/// Draws a scene of the volume that `renderer` was made from. What blends draws an exact order where the cells have one along
/// their faces, and where the check that is asked for bears it out; else tiles do.
///
/// Errors: what the device has no shader for, cannot hold in 32 bits, or has more parts than it binds; memory; a lost device; a
/// stopped run.
pub fn draw(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    match plan(renderer, scene, options)? {
        Plan::Direct => inputs(renderer, scene, options, None)?.draw(scene, options, progress),
        Plan::FaceOrder(order) => {
            let output = inputs(renderer, scene, options, Some(&order.0))?.draw(scene, options, progress)?;
            check(renderer, scene, options, order, output, progress)
        }
        Plan::Tiles(why) => tiles_instead(renderer, scene, options, why, progress),
    }
}
