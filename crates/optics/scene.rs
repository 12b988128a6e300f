//! A scene: what is drawn, from where, and how. The one description that every engine is given.

use crate::integrators::{self, CLASSIFIED};
use crate::shading::{Ordering, Shading, VisibilityOrder};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::grid::{Array, Grid};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;

/// A volume, how it is looked at, and from where.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The cells and their values.
    pub volume: Arc<Volume>,
    /// What is drawn.
    pub transfer_function: Arc<TransferFunction>,
    /// Where it is seen from.
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

    /// The scene for the integrator `vertex-sampled`: what the transfer function is at the grid's points as point arrays
    /// ([`CLASSIFIED`]), and a transfer function that says that they are looked at.
    ///
    /// Errors: a field that the volume does not have; extinctions that leave the range of numbers.
    pub fn classified(&self) -> Result<Scene> {
        let Scene { volume, transfer_function, .. } = self;
        let names = transfer_function.fields();
        let arrays = names.iter().map(|name| volume.grid.point_array(name, 1)).collect::<Result<Vec<_>>>()?;
        let count = volume.grid.points.len();
        let fields: Vec<f64> =
            (0..count).flat_map(|p| arrays.iter().map(move |array| array.values[p])).collect();
        let g = |p: usize| volume.gradient_magnitude.as_ref().map_or(0.0, |g| g[p]);
        let values =
            (0..count).map(|p| ([volume.scalar[p], g(p)], &fields[p * names.len()..(p + 1) * names.len()]));
        let found = integrators::classified(transfer_function, values)?;
        let mut grid = Grid::clone(&volume.grid);
        for (name, values) in CLASSIFIED.into_iter().zip(found.arrays) {
            let array = Array { component_count: 1, values: values.into() };
            grid.point_arrays.insert(name.into(), Arc::new(array));
        }
        let volume = Volume { grid: Arc::new(grid), ..Volume::clone(volume) };
        Ok(Scene { volume: Arc::new(volume), transfer_function: Arc::new(found.bound), ..self.clone() })
    }
}

/// True if the picture depends on the order of a pixel's segments. With one colour in the density-emitter model and
/// no light, C = c·A, and A does not depend on the order.
pub fn needs_order(transfer_function: &TransferFunction, shading: &Shading) -> bool {
    shading.one_color(transfer_function).is_none()
}
