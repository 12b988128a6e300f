//! What a frame computes in vector lanes, as a share of what the machine could in its time. Counted in builds with the feature
//! `counting` alone; arithmetic outside of lanes is not.

use voltet::core::Result;
use voltet::core::camera::Camera;
use voltet::core::transfer::TransferFunction;
use voltet::engine::VolumeCache;

/// Columns of the shares.
pub const COLUMNS: usize = if cfg!(feature = "counting") { 4 } else { 0 };

/// What stands over them.
pub const HEAD: &str = if cfg!(feature = "counting") {
    "share of the multiply-adds: cull | project | composite | frame |"
} else {
    ""
};

/// Additions, products, quotients, roots and multiply-adds of culling, projecting and compositing, one a lane.
#[cfg(feature = "counting")]
pub fn operations(known: &VolumeCache, look: &TransferFunction, camera: &Camera) -> Result<Option<[u64; 3]>> {
    use voltet::core::progress::NoProgress;
    use voltet::engine::{composite, project};
    use voltet::lanes::counting::count;
    let (cells, cull) = count(|| known.cull(look, camera, &NoProgress));
    let cells = cells?;
    let (projection, projected) = count(|| project(&cells, look, camera, false, &NoProgress));
    let projection = projection?;
    let (drawn, composited) = count(|| composite(&projection, look, &crate::SHADING, &NoProgress));
    drawn?;
    Ok(Some([cull, projected, composited]))
}

/// Nothing is counted.
#[cfg(not(feature = "counting"))]
pub fn operations(_: &VolumeCache, _: &TransferFunction, _: &Camera) -> Result<Option<[u64; 3]>> {
    Ok(None)
}

/// Cells of a table: shares of `peak` multiply-adds a second, in the milliseconds of the three stages and of the frame.
pub fn shares([cull, project, composite]: [u64; 3], ms: [f64; 4], peak: f64) -> String {
    let counts = [cull, project, composite, cull + project + composite];
    let shares = counts.iter().zip(ms).map(|(count, ms)| 100.0 * *count as f64 / (peak * ms * 1e-3).max(1.0));
    shares.map(|share| format!("{share:.1} % |")).collect::<Vec<_>>().join(" ")
}
