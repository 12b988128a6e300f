//! Renderer of a volume: its grid on a device, and the buffers of its frames.

use crate::device::device_handle::Device;
use crate::frame::buffers::FrameBuffers;
use crate::frame::face_order::{FaceOrderCache, FaceOrderResult};
use crate::grid::device_grid::DeviceGrid;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use voltet_core::Result;
use voltet_core::volume::Volume;
use voltet_optics::scene::Scene;

/// A volume on a device, ready to be drawn.
pub struct Renderer {
    pub(crate) grid: DeviceGrid,
    buffers: Mutex<FrameBuffers>,
    orders: Mutex<FaceOrderCache>,
}

impl Renderer {
    /// Uploads the grid. Errors: what has more parts than the device binds at a time; memory.
    pub fn new(device: Arc<Device>, volume: &Volume) -> Result<Renderer> {
        Ok(Renderer {
            grid: DeviceGrid::new(device, volume)?,
            buffers: Mutex::default(),
            orders: Mutex::default(),
        })
    }

    /// Sets the initial work of a tile in one dispatch (cells tested).
    pub fn with_budget_of(self, work: u32) -> Renderer {
        self.buffers().budget = Some(work);
        self
    }

    /// Sets the number of cells in a draw of the raster compositor.
    pub fn with_runs_of(self, cells: u32) -> Renderer {
        self.buffers().raster.run_length = Some(cells.max(1));
        self
    }

    /// The device.
    pub fn device(&self) -> &Arc<Device> {
        &self.grid.device
    }

    /// The order of the cells along their faces for a scene's camera, and the seconds that finding it took; none where it was kept.
    ///
    /// Errors: a camera out of range.
    pub(crate) fn along_faces(&self, scene: &Scene) -> Result<(FaceOrderResult, Option<f64>)> {
        self.orders.lock().unwrap_or_else(PoisonError::into_inner).find(scene)
    }

    pub(crate) fn buffers(&self) -> MutexGuard<'_, FrameBuffers> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
