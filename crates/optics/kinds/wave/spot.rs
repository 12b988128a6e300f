//! Position on the flank of a wave, within half a band.

/// A place on a flank, measured from both of its ends: each is exact where it is small.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlankPosition {
    /// z, distance from the nearest foot.
    pub foot: f64,
    /// u, distance from the nearest peak.
    pub peak: f64,
}

impl FlankPosition {
    pub const FOOT: FlankPosition = FlankPosition { foot: 0.0, peak: 0.5 };
    pub const PEAK: FlankPosition = FlankPosition { foot: 0.5, peak: 0.0 };

    #[inline]
    pub fn from_peak(distance: f64) -> FlankPosition {
        FlankPosition { foot: 0.5 - distance, peak: distance }
    }
}
