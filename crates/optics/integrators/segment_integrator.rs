//! Integral of a segment, and the domain of tables over the data.

use crate::{Contribution, Segment};
use std::any::Any;
use voltet_core::Error;

/// Computes (C, A) of one segment.
pub trait SegmentIntegrator: Send + Sync {
    /// The segment's contribution.
    fn integrate(&self, segment: &Segment) -> Contribution;

    /// Bytes of its tables.
    fn table_bytes(&self) -> usize {
        0
    }

    /// The table that the integrator looks up, for kernels that share it.
    fn table(&self) -> Option<&dyn Any> {
        None
    }

    /// Reason why a segment could not be integrated so far: a picture drawn with it is invalid.
    fn failure(&self) -> Option<&Error> {
        None
    }
}

/// Ranges of the segments of a data set: the domain of a table over them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Smallest and largest scalar.
    pub scalar: [f64; 2],
    /// Length of the longest segment, world units.
    pub longest: f64,
}
