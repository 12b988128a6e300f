//! Renderer of a volume: its grid on a device, and the buffers that stay between its frames.

use crate::device::{Device, GrowingBuffer, locked};
use crate::grid::{DeviceGrid, GrowingSplitBuffer};
use crate::raster::RasterBuffers;
use crate::tables::Tables;
use std::sync::{Arc, Mutex, MutexGuard};
use voltet_core::Result;
use voltet_core::volume::Volume;

/// A volume on a device, ready to be drawn.
pub struct Renderer {
    pub(crate) grid: DeviceGrid,
    buffers: Mutex<FrameBuffers>,
}

impl Renderer {
    /// Uploads the grid. Errors: what has more parts than the device binds at a time; memory.
    pub fn new(device: Arc<Device>, volume: &Volume) -> Result<Renderer> {
        Ok(Renderer { grid: DeviceGrid::new(device, volume)?, buffers: Mutex::default() })
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

    pub(crate) fn buffers(&self) -> MutexGuard<'_, FrameBuffers> {
        locked(&self.buffers)
    }
}

/// Buffers that a frame is read back by.
#[derive(Default)]
pub(crate) struct ReadbackBuffers {
    pub picture: GrowingBuffer,
    pub counts: GrowingBuffer,
}

/// Buffers that stay between frames.
#[derive(Default)]
pub(crate) struct FrameBuffers {
    pub seen: GrowingSplitBuffer,
    pub attributes: GrowingSplitBuffer,
    pub bounds: GrowingSplitBuffer,
    pub entries: GrowingBuffer,
    pub picture: GrowingBuffer,
    pub counts: GrowingBuffer,
    /// Readback buffers of frames that are drawn one at a time.
    pub returned: ReadbackBuffers,
    /// Readback buffers for frames in flight that are not in use.
    pub idle_readbacks: Vec<ReadbackBuffers>,
    pub in_flight: usize,
    pub tables: Tables,
    pub raster: RasterBuffers,
    /// Work of a tile in one dispatch, as far as former frames of the grid have come.
    pub budget: Option<u32>,
    /// Entries of the lists that the last frame needed.
    pub capacity: u32,
    /// True if tiles have had more work than one dispatch does, so that their pixels' states are kept.
    pub keeps_states: bool,
}
