//! Cull: keep each tetrahedron that could contribute.
//!
//! Conservative in truth: a cell is left out only if no point of the convex hull of its four (s, g) pairs comes
//! near enough to any widget to matter, or if it lies outside one plane of the view. The papers test the four
//! vertices only (Song et al. 2009), which drops a cell whose vertices straddle a narrow widget.
//!
//! Which cells widgets touch depends on the volume and on what the widgets' bounds say, and nothing else. It is found apart from
//! the view and kept until the bounds change, as the points on the screen are until the camera does: see [`Known`].
//!
//! | file | what |
//! | --- | --- |
//! | `known` | what is kept of a volume between pictures |
//! | `touched` | the cells that the widgets touch, or that asking every cell would not pay |
//! | `blocks` | ranges of s and g over runs of cells: what is touched all over or nowhere is not asked cell by cell |
//! | `asked` | one cell or block held against the widgets |

mod asked;
mod blocks;
mod known;
mod touched;

pub use known::Known;
pub use touched::Sample;

use crate::cells::Cells;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;

/// Keeps each tetrahedron that could contribute to the picture: [`Known::cull`] of a volume of which nothing is known yet.
///
/// Errors: those of [`Known::new`] and [`Known::cull`].
pub fn cull(
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
    progress: &dyn Progress,
) -> Result<Cells> {
    Known::new(volume)?.cull(transfer_function, camera, progress)
}

/// Keeps every tetrahedron and every widget, for comparison with [`cull`]: [`Known::keep_all`].
///
/// Errors: those of [`Known::new`] and [`Known::keep_all`].
pub fn keep_all(
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
) -> Result<Cells> {
    Known::new(volume)?.keep_all(transfer_function, camera)
}
