//! Values that the stage nodes pass to each other.

use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_cpu::{Cells, Projection};

/// Cells that were culled, and for which transfer function: no other one may be drawn from them.
#[derive(Debug)]
pub struct Culled {
    /// The cells that are left.
    pub cells: Cells,
    /// Transfer function that they were culled for.
    pub transfer_function: Arc<TransferFunction>,
}

/// Projected cells, and for which transfer function.
#[derive(Debug)]
pub struct Projected {
    /// The projection.
    pub projection: Projection,
    /// Transfer function that the cells were culled and projected for.
    pub transfer_function: Arc<TransferFunction>,
}
