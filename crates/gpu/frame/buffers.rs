//! Buffers of a grid's frames, which stay between them.

use crate::device::buffers::GrowingBuffer;
use crate::grid::split_buffer::GrowingSplitBuffer;
use crate::pass::tables::Tables;
use crate::raster::blending::RasterBuffers;

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
    /// Frames in flight.
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
