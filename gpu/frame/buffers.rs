//! Buffers of a grid's frames, which stay between them.

use crate::device::buffers::Growing;
use crate::grid::parts::GrowingParts;
use crate::pass::tables::Tables;
use crate::raster::blended::RasterBuffers;

/// Buffers that stay between frames.
#[derive(Default)]
pub(crate) struct FrameBuffers {
    pub seen: GrowingParts,
    pub attributes: GrowingParts,
    pub bounds: GrowingParts,
    pub entries: Growing,
    pub picture: Growing,
    pub counts: Growing,
    pub returned: Growing,
    pub returned_counts: Growing,
    pub tables: Tables,
    pub raster: RasterBuffers,
    /// Work of a tile in one dispatch, as far as former frames of the grid have come.
    pub budget: Option<u32>,
    /// Entries of the lists that the last frame needed.
    pub capacity: u32,
    /// Whether tiles have had more work than one dispatch does, so that their pixels' states are kept.
    pub keeps_states: bool,
}
