//! Scene: volume, transfer function, camera and shading, as every engine takes them.

use crate::shading::{Ordering, Shading, VisibilityOrder};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;

/// A volume, how it is looked at, and from where.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The cells and their values.
    pub volume: Arc<Volume>,
    /// Transfer function.
    pub transfer_function: Arc<TransferFunction>,
    /// Camera.
    pub camera: Camera,
    /// Integrator and light.
    pub shading: Shading,
    /// The requested order of a pixel's segments.
    pub order: VisibilityOrder,
}

impl Scene {
    /// The order of a pixel's segments that an engine makes for the scene. In exhaustive mode an exact order is made also where
    /// the picture does not depend on it.
    pub fn ordering(&self, exhaustive: bool) -> Ordering {
        Ordering::new(self.order, exhaustive || self.needs_order())
    }

    /// True if the picture depends on the order of a pixel's segments.
    pub fn needs_order(&self) -> bool {
        needs_order(&self.transfer_function, &self.shading)
    }
}

/// True if the picture depends on the order of a pixel's segments. With one colour in the density-emitter model and
/// no light, C = c·A, and A does not depend on the order.
pub fn needs_order(transfer_function: &TransferFunction, shading: &Shading) -> bool {
    shading.one_color(transfer_function).is_none()
}
