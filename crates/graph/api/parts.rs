//! Parts of a grid, which are read and drawn one after the other.

use glam::DVec3;

/// Name of the count of times that a piece of a file was read, by all processes together.
pub const PIECES_READ: &str = "pieces_read";

/// Some pieces of the file of a grid, with what surrounds them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridPart {
    /// Numbers of the pieces in the file.
    pub pieces: Vec<usize>,
    /// Rings of cells of other pieces around them that filters of nodes may look at.
    pub layers: usize,
}

/// Findings about the grids of all parts of a process, once all were gone through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweptParts {
    /// Box around their points; `None` where no part has any.
    pub bounds: Option<[DVec3; 2]>,
}

/// Further rings of cells around a part, where values on cells become means at points.
pub const MEAN_LAYERS: usize = 1;

/// Further rings that the filter of each node with gradients may look at: those of the neighbours of neighbours.
pub const GRADIENT_LAYERS: usize = 2;
