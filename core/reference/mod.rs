//! The 64-bit referee: adaptive quadrature of every segment and a per-pixel sort, slow and simple, sharing no
//! formula with the engine or with `optics`.

use crate::Result;
use crate::camera::Camera;
use crate::engine::{Order, Shading};
use crate::picture::Picture;
use crate::progress::Progress;
use crate::transfer::TransferFunction;
use crate::volume::Volume;

/// Draws the volume in 64 bits.
pub fn draw(
    _volume: &Volume,
    _transfer_function: &TransferFunction,
    _camera: &Camera,
    _shading: &Shading,
    _order: Order,
    _progress: &dyn Progress,
) -> Result<Picture> {
    Err(crate::Error::run("the reference renderer is in work"))
}
