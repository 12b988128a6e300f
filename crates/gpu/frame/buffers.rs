//! Buffers of a grid's frames, which stay between them.

use crate::device::buffers::Growing;
use crate::grid::parts::GrowingParts;
use crate::pass::tables::Tables;
use crate::raster::blended::RasterBuffers;

/// What a frame comes back by.
#[derive(Default)]
pub(crate) struct Returning {
    pub picture: Growing,
    pub counts: Growing,
}

/// Buffers that stay between frames.
#[derive(Default)]
pub(crate) struct FrameBuffers {
    pub seen: GrowingParts,
    pub attributes: GrowingParts,
    pub bounds: GrowingParts,
    pub entries: Growing,
    pub picture: Growing,
    pub counts: Growing,
    /// What frames come back by that are drawn one at a time.
    pub returned: Returning,
    /// The same for frames in flight; those that none flies by.
    pub landed: Vec<Returning>,
    /// Frames in flight.
    pub in_flight: usize,
    pub tables: Tables,
    pub raster: RasterBuffers,
    /// Work of a tile in one dispatch, as far as former frames of the grid have come.
    pub budget: Option<u32>,
    /// Entries of the lists that the last frame needed.
    pub capacity: u32,
    /// Whether tiles have had more work than one dispatch does, so that their pixels' states are kept.
    pub keeps_states: bool,
}
