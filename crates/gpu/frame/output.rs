//! Output of a frame: picture, counts, times, and the check of its order.

use crate::frame::counters;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::visibility::FaceOrder;
use voltet_optics::engine::{Accumulation, Compositor, RenderOptions, StageTiming};

/// Output of a frame.
#[derive(Debug, Clone)]
pub struct FrameOutput {
    /// The picture.
    pub picture: Picture,
    /// Counts.
    pub counts: FrameCounts,
    /// The passes with their times, where the adapter has timestamps.
    pub passes: Vec<StageTiming>,
    /// Folders of shader pieces that the scene's shader does not contain.
    pub parts_left_out: Vec<&'static str>,
    /// Bytes of all pieces that are not in it.
    pub part_bytes_left_out: u64,
    /// True if pixels were blended in 16-bit floats, since the device blends none of 32 bits.
    pub blended_in_16_bits: bool,
    /// Report of the exact order, where cells were blended in one.
    pub along_faces: Option<FaceOrderReport>,
    /// Why tiles composited in place of what blends, where they did.
    pub tiles_instead: Option<String>,
}

/// The exact order of a picture that was blended.
#[derive(Debug, Clone)]
pub struct FaceOrderReport {
    /// The order.
    pub order: Arc<FaceOrder>,
    /// Report of the check, where one was requested.
    pub checked: Option<OrderCheckReport>,
}

/// Blended in 32 bits and composited by tiles, pixels in one order differ by a tenth of this after a thousand segments.
const ROUNDING: f32 = 1e-3;

/// Report of the check of a picture's order.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderCheckReport {
    /// Pixels that were compared with those of tiles.
    pub pixels: u64,
    /// The largest difference of a channel between the two. Other than for "raster" in 32 bits it is not the order's alone.
    pub largest: f32,
    /// Pixels, over all samples, at which cells come out of order, where these were counted.
    pub disordered: Option<u64>,
    /// Why tiles could not be drawn, where they could not.
    pub without_tiles: Option<String>,
}

impl OrderCheckReport {
    /// The reason why the order is wrong, if it is.
    pub(crate) fn is_wrong(&self, options: &RenderOptions, output: &FrameOutput) -> Option<String> {
        let is_exact = options.compositing == Some(Compositor::Raster)
            && options.accumulation == Accumulation::Float
            && !output.blended_in_16_bits;
        match self.disordered {
            Some(count @ 1..) => Some(format!("cells are out of order at {count} pixels")),
            _ if is_exact && self.largest > ROUNDING => {
                let OrderCheckReport { pixels, largest, .. } = self;
                Some(format!("of {pixels} pixels one differs by {largest:.1e} from that of tiles"))
            }
            _ => None,
        }
    }
}

/// Counts of a picture, over all samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FrameCounts {
    /// Cells left out because no widget touches their values.
    pub culled_by_transfer_function: u64,
    /// Cells left out because they are outside the view.
    pub culled_by_frustum: u64,
    /// Cells left out because they cover no pixel's middle, or have no volume.
    pub under_a_pixel: u64,
    /// Cells that may cover a pixel.
    pub cells_projected: u64,
    /// Cells in the lists of all tiles.
    pub tile_entries: u64,
    /// Ray segments integrated. Blending hardware does not count them.
    pub segments: Option<u64>,
    /// Pixels (samples, where a pixel has several) composited in an order that was not exact. Blending hardware does
    /// not know; where no order is needed, there are none.
    pub pixels_disordered: Option<u64>,
    /// Times that a tile's list was gone through once more, because a pixel had more segments than fit at a time.
    pub sweeps_further: u64,
    /// Tiles that were opaque before all their cells had been looked at.
    pub tiles_stopped: u64,
    /// Cells that such tiles did not look at; a cell counts in each of them.
    pub cells_hidden: u64,
}

/// Content read back from the device.
pub(crate) struct Readback {
    pub picture: Picture,
    pub counts: [u64; counters::ALL],
    pub passes: Vec<StageTiming>,
}

/// The output of a frame as far as it is known before readback.
pub(crate) struct PendingStats {
    /// True if segments are counted.
    pub is_counted: bool,
    /// True if pixels in disorder are counted, or there can be none.
    pub is_order_known: bool,
    pub parts_left_out: Vec<&'static str>,
    pub part_bytes_left_out: u64,
    pub blended_in_16_bits: bool,
}

impl PendingStats {
    /// Completes the output with the content read back.
    pub fn with(self, Readback { picture, counts: counted, passes }: Readback) -> FrameOutput {
        FrameOutput {
            picture,
            counts: FrameCounts {
                culled_by_transfer_function: counted[counters::BY_FUNCTION],
                culled_by_frustum: counted[counters::BY_FRUSTUM],
                under_a_pixel: counted[counters::UNDER_A_PIXEL],
                cells_projected: counted[counters::PROJECTED],
                tile_entries: counted[counters::ENTRIES],
                segments: self.is_counted.then_some(counted[counters::SEGMENTS]),
                pixels_disordered: self.is_order_known.then_some(counted[counters::DISORDERED]),
                sweeps_further: counted[counters::SWEEPS],
                tiles_stopped: counted[counters::TILES_STOPPED],
                cells_hidden: counted[counters::CELLS_HIDDEN],
            },
            passes,
            parts_left_out: self.parts_left_out,
            part_bytes_left_out: self.part_bytes_left_out,
            blended_in_16_bits: self.blended_in_16_bits,
            along_faces: None,
            tiles_instead: None,
        }
    }
}
