//! Layers of a picture that was drawn, where they are requested.

use std::collections::BTreeSet;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::picture_parts::{PictureLayer, PictureParts};
use voltet_cpu::VolumeCache;
use voltet_graph::{RunContext, Value};
use voltet_optics::scene::Scene;
use voltet_optics::trace;

/// The picture of a scene as a value, with the layers that are requested of the node. `cells`: numbers of the tetrahedra that can
/// contribute.
pub fn image(
    call: &mut RunContext,
    scene: &Scene,
    picture: Picture,
    cells: impl FnOnce(&RunContext) -> Result<Arc<Vec<u32>>>,
) -> Result<Value> {
    let requested: BTreeSet<PictureLayer> = call.demand.layers.clone();
    let picture = Arc::new(picture);
    if requested.is_empty() {
        return Ok(Value::Image(picture));
    }
    let cells = cells(call)?;
    let layers = call.stage("layers", |progress| trace::layers(scene, &requested, &cells, progress))?;
    Ok(Value::PictureParts(Arc::new(PictureParts { layers: Some(Arc::new(layers)), ..picture.into() })))
}

/// Cells of a scene that can contribute. The volume comes by the input `volume`.
pub fn contributing_cells(call: &RunContext, scene: &Scene) -> Result<Arc<Vec<u32>>> {
    let cache = call.keep(call.revision("volume")?, || VolumeCache::new(&scene.volume))?;
    Ok(cache.cull(&scene.transfer_function, &scene.camera, call.progress())?.ids.clone())
}
