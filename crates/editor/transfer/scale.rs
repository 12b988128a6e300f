//! Scale of the plane's axes.

use super::numbers::rounded;
use voltet_graph::ArrayRef;

/// Scale of the plane, for drawing and moving handles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Lengths along both axes that are equal on the screen.
    pub extent: [f64; 2],
    /// The shown part, low and high of each axis.
    pub shown: [[f64; 2]; 2],
    pub peak: f64,
}

impl Scale {
    /// The largest value shown along the second axis, where a curve reaches its peak.
    pub fn top(&self) -> f64 {
        self.shown[1][1]
    }
}

/// The plane of the scalar and its gradient magnitude.
pub(super) const S_AND_G: [ArrayRef; 2] = [ArrayRef::Named("s"), ArrayRef::Named("g")];

/// The height in the plot of an extinction, 0 to 1: its cube root, so that small ones are told apart.
pub(super) fn height_of(extinction: f64, peak: f64) -> f64 {
    (extinction / peak).max(0.0).cbrt()
}

/// The extinction at a height of the plot.
pub(super) fn extinction_at(height: f64, peak: f64) -> f64 {
    let height = height.clamp(0.0, 1.5);
    // At the foot it is none at all.
    if height < 0.01 { 0.0 } else { rounded(height.powi(3) * peak) }
}
