//! What draws a volume: its grid on a device, and the buffers of its frames.

use crate::device::open::Device;
use crate::frame::buffers::FrameBuffers;
use crate::frame::faces::Orders;
use crate::grid::uploaded::DeviceGrid;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use voltet_core::Result;
use voltet_core::volume::Volume;

/// A volume on a device, ready to be drawn.
pub struct Renderer {
    pub(crate) grid: DeviceGrid,
    buffers: Mutex<FrameBuffers>,
    orders: Mutex<Orders>,
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

    /// The same with so much work of a tile in one dispatch at first, in cells tested.
    pub fn with_budget_of(self, work: u32) -> Renderer {
        self.buffers().budget = Some(work);
        self
    }

    /// The same with so many cells in a draw of the raster compositor.
    pub fn with_runs_of(self, cells: u32) -> Renderer {
        self.buffers().raster.run_length = Some(cells.max(1));
        self
    }

    /// The device.
    pub fn device(&self) -> &Arc<Device> {
        &self.grid.device
    }

    pub(crate) fn orders(&self) -> MutexGuard<'_, Orders> {
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn buffers(&self) -> MutexGuard<'_, FrameBuffers> {
        self.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
