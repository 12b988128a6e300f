//! Cost model of ray casting against projection.

use voltet_core::transfer::TransferFunction;

/// Cost model that decides if rays are cast. The gain over projecting cells is counted in the time to find the faces that they share,
/// both by cells; measured over grids of 0.2 to 16 million cells, 2 to 140 segments each (`lab/bench/frames.py`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct RayCastPolicy {
    /// Gain of each segment of a cell: negative where nothing has to be sorted.
    gain_of_segment: f64,
    /// Boundary faces by cells.
    max_boundary: f64,
}

/// Gain of a cell that is not projected; in proportion less where cells cover less than a pixel each: the projection soon drops those that
/// cover none.
const GAIN_OF_CELL: f64 = 0.8;

/// Gain from which on rays are cast. A picture could be drawn once, for which finding faces takes longer than is gained by less than 1;
/// or often. Neither is known beforehand, and a picture has the same bits whatever was drawn before: less than a frame is lost at most.
const MIN_RAYCAST_GAIN: f64 = 0.3;

/// Optical depth over the scene length, at the densest place, from which on rays soon end.
const OPAQUE_SCENE_DEPTH: f64 = 100.0;

impl RayCastPolicy {
    /// Policy for a scene whose optical depth over the scene length is `max_optical_depth` at the densest place.
    pub fn new(transfer_function: &TransferFunction, max_optical_depth: f64) -> RayCastPolicy {
        let (gain_of_segment, max_boundary) = match transfer_function.uniform_color() {
            None => (0.01, 1.0),
            Some(_) if OPAQUE_SCENE_DEPTH < max_optical_depth => (0.0, 0.2),
            Some(_) => (-0.01, 0.2),
        };
        RayCastPolicy { gain_of_segment, max_boundary }
    }

    /// True if casting rays is faster by enough. `segments`: of a cell on average.
    pub fn pays(&self, segments: f64) -> bool {
        MIN_RAYCAST_GAIN <= GAIN_OF_CELL * segments.min(1.0) + self.gain_of_segment * segments
    }

    /// True if the boundary is small enough.
    pub fn allows_boundary(&self, faces: usize, cells: usize) -> bool {
        faces as f64 <= self.max_boundary * (cells as f64)
    }
}
