//! Cull: keep each tetrahedron that could contribute.
//!
//! Conservative: a cell is left out only if no point of the convex hull of its four (s, g) pairs comes
//! near enough to any widget to matter, or if it lies outside one plane of the view. The papers test the four
//! vertices only (Song et al. 2009), which drops a cell whose vertices straddle a narrow widget.
//!
//! The cells in widgets' supports depend on the volume and the supports alone. They are found apart from the view and cached until the
//! supports change, as the points on the screen are until the camera does: see [`VolumeCache`].

mod contributing;
mod volume_cache;

pub use volume_cache::VolumeCache;

use crate::cells::Cells;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;

/// Keeps each tetrahedron that could contribute to the picture: [`VolumeCache::cull`] with an empty cache.
///
/// Errors: those of [`VolumeCache::new`] and [`VolumeCache::cull`].
pub fn cull(
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
    progress: &dyn Progress,
) -> Result<Cells> {
    VolumeCache::new(volume)?.cull(transfer_function, camera, progress)
}
