//! Scene: volume, transfer function, camera, shading, surfaces and clips, as every engine takes them.

use crate::ray_events::RayEventSource;
use crate::shading::{Ordering, Shading, VisibilityOrder};
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::clip::Clip;
use voltet_core::surface::Surface;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

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
    /// Surfaces in the volume, in their places along each ray.
    pub surfaces: Vec<Arc<Surface>>,
    /// The volume is drawn where all of them keep it; surfaces are drawn everywhere.
    pub clips: Vec<Clip>,
}

impl Scene {
    /// A scene without surfaces and clips.
    pub fn new(
        volume: Arc<Volume>,
        transfer_function: Arc<TransferFunction>,
        camera: Camera,
        shading: Shading,
        order: VisibilityOrder,
    ) -> Scene {
        let (surfaces, clips) = (Vec::new(), Vec::new());
        Scene { volume, transfer_function, camera, shading, order, surfaces, clips }
    }

    /// The order of a pixel's segments that an engine makes for the scene. In exhaustive mode an exact order is made also where
    /// the picture does not depend on it.
    pub fn ordering(&self, exhaustive: bool) -> Ordering {
        Ordering::new(self.order, exhaustive || self.needs_order())
    }

    /// True if the picture depends on the order of a pixel's segments.
    pub fn needs_order(&self) -> bool {
        self.has_events() || needs_order(&self.transfer_function, &self.shading)
    }

    /// True if rays meet more than cells.
    pub fn has_events(&self) -> bool {
        !(self.surfaces.is_empty() && self.clips.is_empty())
    }

    /// Source of the rays' events; none where rays meet nothing but cells. Errors: those of [`RayEventSource::new`]; another order than
    /// the exact one, in which nothing has its place.
    pub fn ray_event_source(&self) -> Result<Option<RayEventSource<'_>>> {
        if self.has_events() && self.order != VisibilityOrder::Exact {
            return Err(Error::usage("surfaces and clips have their places in the exact order alone")
                .got(format!("order = \"{}\"", self.order))
                .expected("order = \"exact\""));
        }
        RayEventSource::new(&self.surfaces, &self.clips, &self.camera)
    }
}

/// True if the picture depends on the order of a pixel's segments. With one colour in the density-emitter model and
/// no light, C = c·A, and A does not depend on the order.
pub fn needs_order(transfer_function: &TransferFunction, shading: &Shading) -> bool {
    shading.one_color(transfer_function).is_none()
}
