//! The integrators that sample or look up, in lanes: the same batches, the same reach of widgets and the same 32 bits as the
//! closed forms, so that their times compare methods.
//!
//! | file | integrator |
//! | --- | --- |
//! | `sampled` | what those that sample share: the widgets that a vector of segments meets, at places of it |
//! | `riemann` | `riemann` |
//! | `pieces` | `segments` |

mod pieces;
mod riemann;
mod sampled;

use crate::fragments::batch::Batch;
use crate::shade::kinds::{LaneWidget, Making};
use crate::shade::shaded::{Left, Shaded};
use sampled::Sampled;
use voltet_core::optics::integrators::SegmentIntegrator;
use voltet_core::shading::Integrator;
use voltet_lanes::Lanes;

/// An integrator of its own roads.
pub(crate) enum LaneMethod {
    /// `riemann` and `segments`.
    Sampled(Sampled),
}

impl LaneMethod {
    /// `None` for the integrators that are closed forms. `exact`: the same integrator in 64 bits.
    ///
    /// Errors: why lanes do not serve it.
    pub fn new(
        integrator: &Integrator,
        exact: &dyn SegmentIntegrator,
        widgets: &[LaneWidget],
        making: &Making,
    ) -> Option<Result<LaneMethod, Left>> {
        match *integrator {
            Integrator::Analytic | Integrator::Clipped => None,
            Integrator::Riemann { count } => {
                Some(Sampled::new(count, None, widgets, making).map(LaneMethod::Sampled))
            }
            Integrator::Segments { count, .. } => {
                Some(Sampled::new(count, exact.partial_table(), widgets, making).map(LaneMethod::Sampled))
            }
            Integrator::Adaptive { .. }
            | Integrator::PreIntegrated { .. }
            | Integrator::PreIntegratedCylindrical { .. }
            | Integrator::Reference => Some(Err(Left::Integrator)),
        }
    }

    /// Integrates the first `count` fragments of a batch. `one_color`: their depths alone.
    #[inline(always)]
    pub fn shade<L: Lanes>(
        &self,
        widgets: &[LaneWidget],
        one_color: bool,
        batch: &Batch,
        count: usize,
        out: &mut Shaded,
    ) {
        match self {
            LaneMethod::Sampled(sampled) => sampled.shade::<L>(widgets, one_color, batch, count, out),
        }
    }
}
