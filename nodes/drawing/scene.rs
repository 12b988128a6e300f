//! Everything that a node which draws in one goes by, from its inputs and parameters.

use voltet_core::Result;
use voltet_graph::RunContext;
use voltet_optics::scene::Scene;

/// The scene at the inputs `volume`, `transfer_function` and `camera`.
pub fn scene(call: &mut RunContext) -> Result<Scene> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    let camera = *call.camera("camera")?;
    let shading = super::shading(call.parameters)?;
    let transfer_function = super::for_data(call, &look, &volume, call.revision("volume")?)?;
    super::note_bands(call, &volume, &transfer_function)?;
    let order = super::order(call.parameters)?;
    Ok(Scene { volume, transfer_function, camera, shading, order })
}
