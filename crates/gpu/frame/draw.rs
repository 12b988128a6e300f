//! Draws a volume on a device.

use crate::frame::drawn::Drawn;
use crate::frame::inputs::inputs;
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
    manner: &RenderOptions,
    progress: &dyn Progress,
) -> Result<Drawn> {
    match plan(renderer, scene, manner)? {
        Plan::AsAsked => inputs(renderer, scene, manner, None)?.draw(scene, manner, progress),
        Plan::AlongFaces(order) => {
            let drawn = inputs(renderer, scene, manner, Some(&order.0))?.draw(scene, manner, progress)?;
            check(renderer, scene, manner, order, drawn, progress)
        }
        Plan::Tiles(why) => tiles_instead(renderer, scene, manner, why, progress),
    }
}
