//! What shading a batch of segments gives.

use crate::fragments::batch::BATCH;

/// Results of a batch.
pub(crate) struct Shaded {
    /// Optical depth, or with silhouettes and light the opacity (filled when there is one colour).
    pub depth: Vec<f32>,
    /// Premultiplied colour and opacity (filled otherwise).
    pub rgba: [Vec<f32>; 4],
    /// Fragments that the quick forms did not serve, then those for the 64-bit path.
    pub rest: Vec<usize>,
    /// Scratch for the change from the one to the other.
    pub spare: Vec<usize>,
    /// Segments integrated in 64 bits.
    pub exact_count: u64,
    /// Segments on which widgets overlap by more than [`MIX_PRODUCT`].
    pub overlap_count: u64,
}

/// One segment's integral, found in 64 bits.
pub(crate) struct Exact {
    pub depth: f32,
    pub rgba: [f32; 4],
    /// Whether widgets overlap by more than [`MIX_PRODUCT`].
    pub overlaps: bool,
}

impl Shaded {
    pub fn new() -> Self {
        let column = || vec![0f32; BATCH];
        Shaded {
            depth: column(),
            rgba: std::array::from_fn(|_| column()),
            rest: Vec::new(),
            spare: Vec::new(),
            exact_count: 0,
            overlap_count: 0,
        }
    }
}

/// Overlaps whose pairwise product of optical depths is under this are mixed without regard to order: the
/// error is at most the product times the colour, 1e-8.
pub(crate) const MIX_PRODUCT: f32 = 1e-8;
