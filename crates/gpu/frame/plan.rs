//! How a scene is drawn: as asked, blended along the faces of its cells, or by tiles in place of that.

use crate::frame::checked;
use crate::frame::drawn::{AlongFaces, Drawn};
use crate::frame::inputs::{compositing, inputs};
use crate::frame::limits;
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
pub(crate) type Ordered = (Arc<FaceOrder>, Option<f64>);

/// How a scene is drawn.
pub(crate) enum Plan {
    AsAsked,
    AlongFaces(Ordered),
    /// By tiles, and why.
    Tiles(String),
}

/// Finds out how a scene is drawn. Errors: what no device has a shader for; a camera out of range.
pub(crate) fn plan(renderer: &Renderer, scene: &Scene, manner: &RenderOptions) -> Result<Plan> {
    // Exhaustive mode makes an order that is not needed by the cells' centroids.
    if compositing(manner) == Compositor::Tiles || scene.ordering(false) != Ordering::PerPixel {
        return Ok(Plan::AsAsked);
    }
    limits::can_serve(&scene.transfer_function, &scene.shading)?;
    let (found, seconds) = renderer.along_faces(scene)?;
    Ok(match found {
        Ok(order) => Plan::AlongFaces((order, seconds)),
        Err(why) => Plan::Tiles(format!("no order along the faces of the cells is exact: {why}")),
    })
}

/// Checks what was blended in an order, as the manner asks for; where it is wrong, tiles draw it.
pub(crate) fn check(
    renderer: &Renderer,
    scene: &Scene,
    manner: &RenderOptions,
    (order, seconds): Ordered,
    mut drawn: Drawn,
    progress: &dyn Progress,
) -> Result<Drawn> {
    let sort = |pass, seconds| StageTiming { stage: Stage::Sort, pass: Some(pass), seconds };
    drawn.passes.extend(seconds.map(|seconds| sort("faces (CPU)", seconds)));
    let begun = Instant::now();
    let checked = checked::check(renderer, scene, manner, &order, &drawn, progress)?;
    if let Some(why) = checked.as_ref().and_then(|checked| checked.is_wrong(manner, &drawn)) {
        return tiles_instead(renderer, scene, manner, why, progress);
    }
    if checked.is_some() {
        drawn.passes.push(sort("check of the order", begun.elapsed().as_secs_f64()));
    }
    drawn.counts.pixels_disordered = checked.as_ref().and_then(|checked| checked.disordered);
    drawn.along_faces = Some(AlongFaces { order, checked });
    Ok(drawn)
}

/// Draws by tiles what was to be blended. Errors: also an accumulation that tiles do not have.
pub(crate) fn tiles_instead(
    renderer: &Renderer,
    scene: &Scene,
    manner: &RenderOptions,
    why: String,
    progress: &dyn Progress,
) -> Result<Drawn> {
    let by_tiles = RenderOptions { compositing: Some(Compositor::Tiles), ..*manner };
    if manner.accumulation.check(Compositor::Tiles).is_err() {
        return Err(Error::run(format!("the hardware does not blend this scene in exact order: {why}"))
            .got(format!("accumulation = \"{}\", which tiles do not have", manner.accumulation.name()))
            .expected("accumulation = \"float\", which tiles draw; or order = \"centroid\""));
    }
    let drawn = inputs(renderer, scene, &by_tiles, None)?.draw(scene, &by_tiles, progress)?;
    Ok(Drawn { tiles_instead: Some(why), ..drawn })
}
