//! Output of a frame: picture, counts, times.

use voltet_core::picture::Picture;
use voltet_optics::engine::{Compositor, RenderStats, StageTiming};

/// Indices of the numbers that the passes count.
pub(crate) mod counters {
    pub const ENTRIES: usize = 0;
    pub const BY_FUNCTION: usize = 1;
    pub const BY_FRUSTUM: usize = 2;
    pub const PROJECTED: usize = 3;
    pub const SEGMENTS: usize = 4;
    pub const DISORDERED: usize = 5;
    pub const SWEEPS: usize = 6;
    /// Tiles of the last dispatch that are to go on.
    pub const UNFINISHED: usize = 7;
    pub const LONGEST: usize = 8;
    /// Cells in view that cover no pixel's middle.
    pub const UNDER_A_PIXEL: usize = 9;
    /// Tiles that were opaque before all their cells had been looked at, and those cells.
    pub const TILES_STOPPED: usize = 10;
    pub const CELLS_HIDDEN: usize = 11;
    /// Cells whose tiles a driver did not go through, since it ended the loops: their lists are wrong.
    pub const CELLS_CUT_SHORT: usize = 12;
    /// Pixels likewise, whose colours are wrong.
    pub const PIXELS_CUT_SHORT: usize = 13;
    pub const ALL: usize = 14;
    /// Counts that are the same in every window.
    pub const OF_CELLS: [usize; 4] = [BY_FUNCTION, BY_FRUSTUM, PROJECTED, UNDER_A_PIXEL];
}

/// Output of a frame.
#[derive(Debug, Clone)]
pub struct FrameOutput {
    /// The picture.
    pub picture: Picture,
    /// Counts that every engine may have, over all samples. Blending hardware counts no segments, and knows no pixels in disorder
    /// unless no order is needed.
    pub counts: RenderStats,
    /// Cells in the lists of all tiles.
    pub tile_entries: u64,
    /// Times that a tile's list was gone through once more, because a pixel had more segments than fit at a time.
    pub sweeps_further: u64,
    /// The passes with their times, where the adapter has timestamps.
    pub passes: Vec<StageTiming>,
    /// Folders of shader pieces that the scene's shader does not contain.
    pub parts_left_out: Vec<&'static str>,
    /// Bytes of all pieces that are not in it.
    pub part_bytes_left_out: u64,
    /// True if pixels were blended in 16-bit floats, since the device blends none of 32 bits.
    pub blended_in_16_bits: bool,
    /// Compositor that drew it.
    pub compositing: Compositor,
}

/// Content read back from the device.
pub(crate) struct Readback {
    pub picture: Picture,
    pub counts: [u64; counters::ALL],
    pub passes: Vec<StageTiming>,
}

/// The output of a frame as far as it is known before readback.
pub(crate) struct PendingStats {
    pub compositing: Compositor,
    /// True if pixels in disorder are counted, or there can be none.
    pub is_order_known: bool,
    pub exhaustive: bool,
    pub parts_left_out: Vec<&'static str>,
    pub part_bytes_left_out: u64,
    pub blended_in_16_bits: bool,
}

impl PendingStats {
    /// Completes the output with the content read back. In exhaustive mode cells beside the picture count as those between its
    /// pixels: their place is found, and there is nothing more that could be done for them.
    pub fn with(self, Readback { picture, counts: counted, passes }: Readback) -> FrameOutput {
        let [by_frustum, under_a_pixel] = [counted[counters::BY_FRUSTUM], counted[counters::UNDER_A_PIXEL]];
        let [culled_by_frustum, under_a_pixel] = match self.exhaustive {
            false => [by_frustum, under_a_pixel],
            true => [0, by_frustum + under_a_pixel],
        };
        FrameOutput {
            picture,
            counts: RenderStats {
                culled_by_transfer_function: Some(counted[counters::BY_FUNCTION]),
                culled_by_frustum: Some(culled_by_frustum),
                under_a_pixel: Some(under_a_pixel),
                cells_projected: Some(counted[counters::PROJECTED]),
                segments: (self.compositing == Compositor::Tiles).then_some(counted[counters::SEGMENTS]),
                segments_exact: Some(0),
                evaluations: None,
                pixels_disordered: self.is_order_known.then_some(counted[counters::DISORDERED]),
                tiles_stopped: Some(counted[counters::TILES_STOPPED]),
                cells_hidden: Some(counted[counters::CELLS_HIDDEN]),
                tables_built: None,
            },
            tile_entries: counted[counters::ENTRIES],
            sweeps_further: counted[counters::SWEEPS],
            passes,
            parts_left_out: self.parts_left_out,
            part_bytes_left_out: self.part_bytes_left_out,
            blended_in_16_bits: self.blended_in_16_bits,
            compositing: self.compositing,
        }
    }
}
