//! A scene to draw.

use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_optics::WidgetBlend;
use voltet_optics::scene;
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};

/// Everything a picture is made from.
#[derive(Clone)]
pub struct NamedScene {
    /// As failures call it.
    pub name: String,
    pub volume: Arc<Volume>,
    pub look: TransferFunction,
    pub camera: Camera,
}

impl NamedScene {
    /// Scene as an engine takes it.
    pub fn drawn_by(&self, shading: &Shading, order: VisibilityOrder) -> scene::Scene {
        scene::Scene::new(self.volume.clone(), Arc::new(self.look.clone()), self.camera, *shading, order)
    }
}

/// Closed forms, exact overlap, no light.
pub const SHADING: Shading =
    Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette: None, light: None };
