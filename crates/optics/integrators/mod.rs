//! The integrators of one segment behind one trait (docs/src/explanation/optics.md, section 10).
//!
//! [`Analytic`] and [`Adaptive`] ship. Others are registered from outside: each implements [`IntegratorKind`].

mod adaptive;
mod integrator;

pub use adaptive::Adaptive;
pub use integrator::{
    Analytic, Extent, INTEGRATOR, Integrator, IntegratorKind, MAX_SETTINGS, Obstacle, PreparedScene,
    ScenePreparation, SegmentIntegrator, TableDomain, can_serve, kinds, stated, variant,
};

use super::WidgetBlend;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// The kinds that ship.
pub static KINDS: [&dyn IntegratorKind; 2] = [&integrator::AnalyticKind, &adaptive::AdaptiveKind];

/// The 64-bit integral of a segment by an integrator. `blend`: the blending of widgets that overlap, for kinds that can mix them; the
/// others take widgets together in their order.
///
/// Errors: [`can_serve`]'s, and a transfer function with a number out of range.
pub fn new(
    integrator: &Integrator,
    blend: WidgetBlend,
    transfer_function: &TransferFunction,
    extent: &Extent,
) -> Result<Box<dyn SegmentIntegrator>> {
    can_serve(integrator, transfer_function)?;
    integrator.kind().compile(integrator, blend, transfer_function, extent)
}
