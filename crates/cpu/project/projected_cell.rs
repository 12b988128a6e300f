//! Projected cell: its face planes in 64 bytes, and 24 bytes for each attribute.
//!
//! With z the depth of a point and z₀ the depth chosen for the cell, v = z₀/z − 1 (perspective) or v = z₀ − z
//! (parallel rays) is affine on every plane, in pixel coordinates: nearer points have the larger v, and v is
//! small in a small cell, so 32 bits keep the *thickness* of the cell to full relative precision however far
//! away it is. A ray enters the cell at the smallest v of its front faces and leaves at the largest v of its
//! back faces.
//!
//! An attribute s, linear in space, is `base + (p Δx + q Δy + r v) / (1 + v)` (without the quotient for
//! parallel rays), Δ being taken from the cell's pixel: the same affine argument applied to s/z.

/// Face planes of a projected cell.
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct ProjectedCell {
    /// ∂v/∂x of the four faces (opposite vertices 0 … 3).
    pub a: [f32; 4],
    /// ∂v/∂y of the four faces.
    pub b: [f32; 4],
    /// v of the four faces at the cell's pixel.
    pub c: [f32; 4],
    /// z₀ (perspective), or 1: scene lengths of depth per unit of v near v = 0.
    pub depth: f32,
    /// z₀ − the depth that distances are counted from, scene lengths.
    pub distance: f32,
    /// Bit i: face i looks towards the eye.
    pub front: u32,
    /// Reference pixel, x + (y << 16).
    pub pixel: u32,
}

/// One attribute of a projected cell.
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct AttributePlane {
    /// Coefficient of Δx.
    pub p: f32,
    /// Coefficient of Δy.
    pub q: f32,
    /// Coefficient of v.
    pub r: f32,
    /// Value at the cell's pixel and v = 0.
    pub base: f32,
    /// Smallest value of the cell: the linear form is clamped to it, since slivers extrapolate.
    pub low: f32,
    /// Largest value of the cell.
    pub high: f32,
}

/// Words of 32 bits in the planes of a cell.
pub(crate) const CELL_WORDS: usize = 16;
/// Coefficients beyond this stand for "no constraint": the face is seen edge-on.
pub(crate) const UNBOUNDED_SLOPE: f64 = 1e30;
