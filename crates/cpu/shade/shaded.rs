//! What shading a batch of segments gives.

use crate::fragments::batch::{Column, LANES_MOST};
use crate::shade::stepped::{Met, STEPS};
use voltet_simd::{Float, Lanes};

/// Kinds of fragments that quick forms leave over.
pub(crate) const KINDS: usize = STEPS.len() + 3;

/// Results of a batch.
pub(crate) struct Shaded {
    /// Optical depth, or with silhouettes and light the opacity (filled when there is one colour).
    pub depth: Box<Column>,
    /// Premultiplied colour and opacity (filled otherwise).
    pub rgba: Colors,
    /// Fragments that take so many steps each as [`STEPS`] says.
    pub in_order: [Vec<usize>; STEPS.len()],
    /// Fragments of known opacity, of one piecewise-linear widget, with pieces deeper than its quick form takes.
    pub deep: Vec<usize>,
    /// Fragments of known opacity that are dense.
    pub dense: Vec<usize>,
    /// The other fragments that the quick forms did not serve, then those for the 64-bit path.
    pub rest: Vec<usize>,
    /// Why the latter go there, one by one.
    pub why: Vec<Left>,
    /// Scratch for the change from the one to the other; empty.
    pub spare: Vec<usize>,
    /// Scratch: the widgets that a vector of segments meets.
    pub met: Vec<Met>,
    /// Segments integrated in 64 bits.
    pub exact_count: u64,
    /// How often the transfer function was asked: see [`voltet_optics::engine::Counts::evaluations`].
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
            deep: Vec::new(),
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

    /// Nothing is left over.
    pub fn clear(&mut self) {
        let Shaded { in_order, deep, dense, rest, .. } = self;
        in_order.iter_mut().chain([deep, dense, rest]).for_each(Vec::clear);
    }

    /// Fragments that the quick forms left over, kind by kind; those of the last have an opacity that is not known.
    pub fn left_over(&self) -> [&Vec<usize>; KINDS] {
        let [few, some, many] = &self.in_order;
        [few, some, many, &self.deep, &self.dense, &self.rest]
    }

    /// The same, to change.
    pub fn left_over_mut(&mut self) -> [&mut Vec<usize>; KINDS] {
        let [few, some, many] = &mut self.in_order;
        [few, some, many, &mut self.deep, &mut self.dense, &mut self.rest]
    }

    /// Gives the fragments of a vector, one a lane, their colours, or colours and opacities.
    #[inline(always)]
    pub fn put<L: Lanes, const N: usize>(&mut self, group: &[usize], values: [L::F; N]) {
        for (column, value) in self.rgba.iter_mut().zip(values) {
            let mut row = [0f32; LANES_MOST];
            value.store(&mut row);
            for (&value, &k) in row.iter().zip(group) {
                column[k] = value;
            }
        }
    }

    /// Of the rest, what was too dense or too delicate joins the dense ones.
    pub fn set_dense_apart(&mut self) {
        let Shaded { rest, why, dense, .. } = self;
        let mut reasons = why.iter();
        rest.retain(|&k| {
            let dense_too = reasons.next().is_some_and(|why| why.is_for_dense_steps());
            if dense_too {
                dense.push(k);
            }
            !dense_too
        });
        why.retain(|why| !why.is_for_dense_steps());
    }
}

/// The reason why a segment falls back to the 64-bit forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Left {
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
    /// Whether steps that serve dense segments may serve it.
    pub(crate) fn is_for_dense_steps(self) -> bool {
        matches!(self, Left::Dense | Left::Delicate)
    }

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
            Left::Dense => {
                "a density of over 10,000,000, or of 200 under the constant-emitter, needs finer steps than 32 bits take"
            }
        }
    }
}

/// Depth from which on a segment whose order takes more than a few steps goes straight to the steps for dense ones.
pub(crate) const DENSE_LEAST: f32 = 8.0;

/// Overlaps whose pairwise product of optical depths is under this are mixed without regard to order: the
/// error is at most the product times the colour, 1e-8.
pub(crate) const MIX_PRODUCT: f32 = 1e-8;
