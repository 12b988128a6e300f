//! The integrators of one segment behind one trait (optics specification, section 5).
//!
//! | integrator | what it does |
//! | --- | --- |
//! | [`Analytic`] | closed forms; overlaps in order or mixed |
//! | [`Riemann`] | N point samples, each with its own absorption |
//! | [`Segments`] | N pieces of linear colour and extinction |
//! | [`Clipped`] | a piecewise-linear function cut at its control points |

mod riemann;
mod segments;
#[cfg(test)]
mod tests;

pub use riemann::Riemann;
pub use segments::Segments;

use super::{Contribution, Overlap, Prepared, Segment};
use crate::transfer::{Profile, TransferFunction};
use crate::{Error, Result};

/// Computes (C, A) of one segment.
pub trait SegmentIntegrator: Sync {
    /// The segment's contribution.
    fn integrate(&self, segment: &Segment) -> Contribution;
}

/// The closed forms.
#[derive(Debug, Clone)]
pub struct Analytic {
    prepared: Prepared,
    overlap: Overlap,
}

impl Analytic {
    /// Serves every transfer function.
    pub fn new(transfer_function: &TransferFunction, overlap: Overlap) -> Result<Self> {
        Ok(Analytic { prepared: Prepared::new(transfer_function)?, overlap })
    }
}

impl SegmentIntegrator for Analytic {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.prepared.integrate(segment, self.overlap)
    }
}

/// A piecewise-linear function cut at its control points: each piece is linear, so nothing is sampled
/// (Moreland 2004).
#[derive(Debug, Clone)]
pub struct Clipped(Prepared);

impl Clipped {
    /// Serves one piecewise-linear widget, with or without a region.
    pub fn new(transfer_function: &TransferFunction) -> Result<Self> {
        match transfer_function.widgets.as_slice() {
            [widget] if matches!(widget.profile, Profile::PiecewiseLinear { .. }) => {
                Ok(Clipped(Prepared::new(transfer_function)?))
            }
            _ => Err(Error::usage("the integrator 'clipped' cannot serve this transfer function")
                .found("widgets other than one piecewise-linear")
                .accepted("one piecewise-linear widget, or the integrator 'analytic' or 'segments'")),
        }
    }
}

impl SegmentIntegrator for Clipped {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.0.integrate(segment, Overlap::Exact)
    }
}

fn at_least_one(count: usize) -> Result<usize> {
    if count >= 1 {
        return Ok(count);
    }
    Err(Error::usage("the number of segments is too small").found(count).accepted("at least 1"))
}
