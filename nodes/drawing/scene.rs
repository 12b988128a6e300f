//! Everything that a node which draws in one goes by, from its inputs and parameters.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::graph::Call;
use voltet_core::shading::{Order, Shading};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;

/// A volume, how it is looked at, and from where.
pub struct Scene {
    /// The cells and their values.
    pub volume: Arc<Volume>,
    /// What is drawn.
    pub transfer_function: Arc<TransferFunction>,
    /// Where it is seen from.
    pub camera: Arc<Camera>,
    /// Integrator and light.
    pub shading: Shading,
    /// The order of a pixel's segments.
    pub order: Order,
}

/// The scene at the inputs `volume`, `transfer_function` and `camera`.
pub fn scene(call: &mut Call) -> Result<Scene> {
    let volume = call.volume("volume")?;
    let look = call.look("transfer_function")?;
    let camera = call.camera("camera")?;
    let shading = super::shading(call.parameters)?;
    let transfer_function = super::for_data(call, &look, &volume, call.revision("volume")?)?;
    super::note_bands(call, &volume, &transfer_function)?;
    let needed = call.thorough || super::needs_order(&transfer_function, &shading);
    let order = super::order(call.parameters, needed)?;
    Ok(Scene { volume, transfer_function, camera, shading, order })
}
