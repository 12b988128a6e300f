//! The 64-bit referee: adaptive quadrature of every segment and a per-pixel sort, slow and simple, sharing no
//! formula with the engine or with `optics`.
//!
//! What a picture means stands in `docs/optics.md`; this module follows it as directly as it can, so that the engines
//! can be held against it. [`draw`] makes a picture, [`Tracer`] answers for single rays, and
//! [`integrate`] for single segments. The integrator that a scene asks for is not looked at: it is always
//! quadrature, to 1e-11 of each segment.
//!
//! Order of reading: [`crossing`](Crossing) (ray against cell), `term` (a widget at a point, and where it
//! changes), `segment` (the integral), `tracer` (shading and compositing), `tiles` (the picture), `walk` (one ray
//! cell by cell).

mod along;
mod crossing;
mod cuts;
mod features;
mod layout;
mod part;
mod quadrature;
mod referee;
mod segment;
mod side;
mod term;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_stiff;
#[cfg(test)]
mod tests_walk;
mod texels;
mod tiles;
mod tracer;
mod walk;
mod wide;

pub use crossing::{Crossing, Ray};
pub use referee::ENGINE;
pub use segment::{Integrand, Tolerance, Workspace};
pub use tiles::{TILE_PIXELS, Tiles};
pub use tracer::{Seen, Tracer};
pub use walk::{Step, Walk};

use crate::scene::Scene;
use crate::{Contribution, Segment, WidgetBlend};
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;

/// Draws the scene in 64 bits. Errors: arrays that are missing, numbers out of range, a stopped run.
pub fn draw(scene: &Scene, progress: &dyn Progress) -> Result<Picture> {
    Tracer::new(scene)?.draw(progress)
}

/// [`draw`] from the tiles that are there already; where it ends early, `tiles` holds those that are drawn.
pub fn draw_further(scene: &Scene, tiles: &mut Tiles, progress: &dyn Progress) -> Result<Picture> {
    Tracer::new(scene)?.draw_further(tiles, progress)
}

/// The integral of one segment, to a relative 1e-11 of each of its stretches.
pub fn integrate(
    segment: &Segment,
    transfer_function: &TransferFunction,
    overlap: WidgetBlend,
) -> Result<Contribution> {
    let integrand = Integrand::new(transfer_function, overlap, Tolerance::SEGMENT)?;
    let value = |ends: [f64; 2], fields: &[f64]| -> Vec<f64> {
        ends.into_iter().chain(fields.iter().copied()).collect()
    };
    let front = value(segment.front, segment.fields_front);
    let back = value(segment.back, segment.fields_back);
    integrand.integrate(segment.length, &front, &back, &mut Workspace::default())
}
