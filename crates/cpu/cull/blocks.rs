//! Ranges of s and g over blocks of consecutive cells. Neighbours in a grid's order are most often neighbours in space, of values
//! close together.

use rayon::prelude::*;
use voltet_core::volume::Volume;

/// Cells of a block.
pub(super) const BLOCK: usize = 32;

/// Blocks that one thread takes at a time: enough that handing them out costs nothing.
pub(super) const BLOCKS_AT_ONCE: usize = 256;

/// Values of a block's cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// Minimum and maximum of s, and of g (0 where the volume has none).
    pub ranges: [[f64; 2]; 2],
}

impl Block {
    /// Blocks of a volume: block b has the cells from b times [`BLOCK`] on.
    pub fn every(volume: &Volume) -> Vec<Block> {
        let (s, g) = (volume.scalar.as_ref(), volume.gradient_magnitude.as_deref());
        let of =
            |cells: &[[u32; 4]]| Block { ranges: [range(s, cells), g.map_or([0.0; 2], |g| range(g, cells))] };
        let mut blocks = Vec::new();
        let tetrahedra = volume.grid.tetrahedra.par_chunks(BLOCK).with_min_len(BLOCKS_AT_ONCE);
        tetrahedra.map(of).collect_into_vec(&mut blocks);
        blocks
    }
}

fn range(values: &[f64], cells: &[[u32; 4]]) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for corners in cells {
        for value in corners.map(|p| values[p as usize]) {
            (low, high) = (low.min(value), high.max(value));
        }
    }
    [low, high]
}
