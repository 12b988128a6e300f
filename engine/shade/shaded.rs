//! What shading a batch of segments gives.

use crate::fragments::batch::Column;
use crate::shade::stepped::{Met, STEPS};

/// Results of a batch.
pub(crate) struct Shaded {
    /// Optical depth, or with silhouettes and light the opacity (filled when there is one colour).
    pub depth: Box<Column>,
    /// Premultiplied colour and opacity (filled otherwise).
    pub rgba: Colors,
    /// Fragments that take so many steps each as [`STEPS`] says.
    pub in_order: [Vec<usize>; STEPS.len()],
    /// Fragments of known opacity whose order is worth finding only where they are seen.
    pub dense: Vec<usize>,
    /// The other fragments that the quick forms did not serve, then those for the 64-bit path.
    pub rest: Vec<usize>,
    /// Why the latter go there, one by one.
    pub why: Vec<Left>,
    /// Scratch for the change from the one to the other.
    pub spare: Vec<usize>,
    /// Scratch: the widgets that a vector of segments meets.
    pub met: Vec<Met>,
    /// Segments integrated in 64 bits.
    pub exact_count: u64,
    /// How often the transfer function was asked: see [`voltet_core::engine::Counts::evaluations`].
    pub evaluation_count: u64,
    /// Segments on which widgets overlap by more than [`MIX_PRODUCT`].
    pub overlap_count: u64,
}

/// Colour and opacity of a batch.
pub(crate) type Colors = [Box<Column>; 4];

/// One segment's integral, found in 64 bits.
pub(crate) struct Exact {
    pub depth: f32,
    pub rgba: [f32; 4],
    /// Whether widgets overlap by more than [`MIX_PRODUCT`].
    pub overlaps: bool,
}

impl Shaded {
    pub fn new() -> Self {
        Shaded {
            depth: Column::new(),
            rgba: std::array::from_fn(|_| Column::new()),
            in_order: Default::default(),
            dense: Vec::new(),
            rest: Vec::new(),
            why: Vec::new(),
            spare: Vec::new(),
            met: Vec::new(),
            exact_count: 0,
            evaluation_count: 0,
            overlap_count: 0,
        }
    }

    /// Fragments that the quick forms left over.
    pub fn left_over(&self) -> usize {
        let in_order: usize = self.in_order.iter().map(Vec::len).sum();
        in_order + self.dense.len() + self.rest.len()
    }

    /// All that is left over goes to the 64-bit forms, for one reason.
    pub fn leave_all(&mut self, why: Left) {
        self.why.clear();
        self.why.resize(self.rest.len(), why);
    }
}

/// Why a segment is left to the 64-bit forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Left {
    /// The integrator is another than the closed forms.
    Integrator,
    /// Samples that 32 bits do not tell apart, or that leave them.
    Samples,
    /// A widget has no lanes.
    NoLanes,
    /// Lengths per unit distance leave 32 bits.
    Lengths,
    /// Colours that vary along the segment are mixed.
    Mixed,
    /// More widths than 32 bits resolve.
    Narrow,
    /// A depth that is no number of 32 bits.
    Overflow,
    /// Bands or triangular Gaussians among others, or glowing by themselves.
    Delicate,
    /// Denser than panels resolve.
    Dense,
}

impl Left {
    /// For people.
    pub fn text(self) -> &'static str {
        match self {
            Left::Integrator => "the integrator is one of 64 bits",
            Left::Samples => "samples, their widths or their depths leave the range of 32 bits",
            Left::NoLanes => "a region cuts the pieces of a widget, or its numbers leave 32 bits",
            Left::Lengths => "lengths per unit distance leave the range of 32 bits",
            Left::Mixed => "colours that vary along the segment are mixed in 64 bits",
            Left::Narrow => "the segment spans over 100,000 widths of a Gaussian, or 50 of a triangular one",
            Left::Overflow => "an optical depth leaves the range of 32 bits",
            Left::Delicate => {
                "a wave or a triangular Gaussian stands among others, or glows without absorbing in step"
            }
            Left::Dense => "a density of over 200 on the segment needs finer steps than 32 bits take",
        }
    }
}

/// Depth from which on a segment whose order takes more than a few steps waits until it is known to be seen.
pub(crate) const DENSE_LEAST: f32 = 8.0;

/// Overlaps whose pairwise product of optical depths is under this are mixed without regard to order: the
/// error is at most the product times the colour, 1e-8.
pub(crate) const MIX_PRODUCT: f32 = 1e-8;
