//! Plan of a frame: drawn as requested, blended along the faces of its cells, or by tiles in place of that.

use crate::frame::inputs::{compositing, inputs};
use crate::frame::limits;
use crate::frame::order_check;
use crate::frame::output::{FaceOrderReport, FrameOutput};
use crate::frame::renderer::Renderer;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::progress::Progress;
use voltet_core::visibility::FaceOrder;
use voltet_core::{Error, Result};
use voltet_optics::engine::{Compositor, RenderOptions, Stage, StageTiming};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Ordering;

/// An order, and the seconds that it took to find where it was not there.
pub(crate) type TimedFaceOrder = (Arc<FaceOrder>, Option<f64>);

/// Plan of a frame.
pub(crate) enum Plan {
    Direct,
    FaceOrder(TimedFaceOrder),
    /// By tiles, and why.
    Tiles(String),
}

/// Plans a frame. Errors: what no device has a shader for; a camera out of range.
pub(crate) fn plan(renderer: &Renderer, scene: &Scene, options: &RenderOptions) -> Result<Plan> {
    // Exhaustive mode makes an order that is not needed by the cells' centroids.
    if compositing(options) == Compositor::Tiles || scene.ordering(false) != Ordering::PerPixel {
        return Ok(Plan::Direct);
    }
    limits::can_serve(&scene.transfer_function, &scene.shading)?;
    let (found, seconds) = renderer.along_faces(scene)?;
    Ok(match found {
        Ok(order) => Plan::FaceOrder((order, seconds)),
        Err(why) => Plan::Tiles(format!("no order along the faces of the cells is exact: {why}")),
    })
}

/// Checks what was blended in an order, as the options asks for; where it is wrong, tiles draw it.
pub(crate) fn check(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    (order, seconds): TimedFaceOrder,
    mut output: FrameOutput,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    let sort = |pass, seconds| StageTiming { stage: Stage::Sort, pass: Some(pass), seconds };
    output.passes.extend(seconds.map(|seconds| sort("faces (CPU)", seconds)));
    let begun = Instant::now();
    let checked = order_check::check(renderer, scene, options, &order, &output, progress)?;
    if let Some(why) = checked.as_ref().and_then(|checked| checked.is_wrong(options, &output)) {
        return tiles_instead(renderer, scene, options, why, progress);
    }
    if checked.is_some() {
        output.passes.push(sort("check of the order", begun.elapsed().as_secs_f64()));
    }
    output.counts.pixels_disordered = checked.as_ref().and_then(|checked| checked.disordered);
    output.along_faces = Some(FaceOrderReport { order, checked });
    Ok(output)
}

/// Draws by tiles what was to be blended. Errors: also an accumulation that tiles do not have.
pub(crate) fn tiles_instead(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    why: String,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    let by_tiles = RenderOptions { compositing: Some(Compositor::Tiles), ..*options };
    if options.accumulation.check(Compositor::Tiles).is_err() {
        return Err(Error::run(format!("the hardware does not blend this scene in exact order: {why}"))
            .got(format!("accumulation = \"{}\", which tiles do not have", options.accumulation.name()))
            .expected("accumulation = \"float\", which tiles draw; or order = \"centroid\""));
    }
    let output = inputs(renderer, scene, &by_tiles, None)?.draw(scene, &by_tiles, progress)?;
    Ok(FrameOutput { tiles_instead: Some(why), ..output })
}
