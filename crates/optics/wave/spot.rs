//! A place within half a band.

/// A place on a flank, measured from both of its ends: each is exact where it is small.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    /// z, distance from the nearest foot.
    pub foot: f64,
    /// u, distance from the nearest peak.
    pub peak: f64,
}

impl Spot {
    pub const FOOT: Spot = Spot { foot: 0.0, peak: 0.5 };
    pub const PEAK: Spot = Spot { foot: 0.5, peak: 0.0 };

    #[inline]
    pub fn from_peak(distance: f64) -> Spot {
        Spot { foot: 0.5 - distance, peak: distance }
    }
}
