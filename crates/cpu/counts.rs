//! Counts of a composited picture.

use std::ops::AddAssign;

/// Counts of a composited picture, or of a worker's part of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Counts {
    /// Ray segments integrated.
    pub segments: u64,
    /// Pixels (samples, where a pixel has several) whose segments were composited in an order that was not exact.
    pub pixels_disordered: u64,
    /// Cells that were projected: selected, and covering a pixel centre.
    pub cells_projected: u64,
    /// Segments integrated in 64 bits because 32 do not hold them.
    pub segments_exact: u64,
    /// Evaluations of the transfer function: see [`voltet_optics::engine::RenderStats::evaluations`].
    pub evaluations: u64,
    /// Segments on which widgets overlap: the optical depths of some two multiply to more than 1e-8.
    pub segments_overlapping: u64,
    /// Tiles with more than 1,024 segments on a pixel.
    pub tiles_deep: u64,
    /// Tiles that ended early because every pixel was opaque.
    pub tiles_stopped: u64,
    /// Cells of such tiles that were not processed any more; a cell counts in each tile. Those that no ray came to are not counted.
    pub cells_hidden: u64,
    /// Tiles in which the ray caster mistracked a ray, and that were drawn from projected cells.
    pub tiles_lost: u64,
    /// Tiles whose pixels' segments were sorted.
    pub tiles_sorted: u64,
    /// Bytes of the integrator's tables.
    pub table_bytes: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        let sums: &mut [u64] = bytemuck::cast_slice_mut(std::slice::from_mut(self));
        let more: &[u64] = bytemuck::cast_slice(std::slice::from_ref(&other));
        sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    }
}
