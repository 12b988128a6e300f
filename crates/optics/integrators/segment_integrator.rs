//! What every integrator gives, and what a table of one spans.

use crate::{Contribution, Segment};
use std::any::Any;
use voltet_core::Error;

/// Computes (C, A) of one segment.
pub trait SegmentIntegrator: Send + Sync {
    /// The segment's contribution.
    fn integrate(&self, segment: &Segment) -> Contribution;

    /// Bytes of the tables that were built for it.
    fn table_bytes(&self) -> usize {
        0
    }

    /// The table that the integrator looks up, for kernels that share it.
    fn table(&self) -> Option<&dyn Any> {
        None
    }

    /// Why it could not integrate a segment since it was made: what was drawn with it is not to be shown.
    fn failure(&self) -> Option<&Error> {
        None
    }
}

/// What the segments of a data set span: the domain of a pre-integrated table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Least and largest scalar.
    pub scalar: [f64; 2],
    /// Length of the longest segment, world units.
    pub longest: f64,
}
