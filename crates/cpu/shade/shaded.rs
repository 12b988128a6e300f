//! Shaded batch: results of shading a batch of segments, and the segments that still need a slower kernel.

use crate::fragments::batch::{Column, MAX_LANES};
pub(crate) use crate::tolerances::MIX_PRODUCT;
use voltet_simd::optics::gaussian_steps::LaneGaussianSteps;
use voltet_simd::{Float, Lanes, inlined};

/// Steps of the fixed quadrature.
pub(crate) const STEPS: [usize; 3] = [2, 4, 8];

/// Kinds of fragments that the closed forms leave to slower kernels.
pub(crate) const KINDS: usize = STEPS.len() + 3;

/// Results of a batch.
pub(crate) struct Shaded {
    /// Optical depth, or with silhouettes and light the opacity (filled when there is one colour).
    pub depth: Box<Column>,
    /// Premultiplied colour and opacity (filled otherwise).
    pub rgba: Colors,
    /// Fragments queued for fixed quadrature, by their [`STEPS`].
    pub in_order: [Vec<usize>; STEPS.len()],
    /// Fragments of known opacity, of one piecewise-linear widget, with pieces deeper than its quick form takes.
    pub deep: Vec<usize>,
    /// Fragments of known opacity that are dense.
    pub dense: Vec<usize>,
    /// Other fragments that the closed forms did not integrate, then those for the 64-bit path.
    pub rest: Vec<usize>,
    /// Reason of each of the latter.
    pub why: Vec<Left>,
    /// Scratch for the change from the former to the latter; empty.
    pub spare: Vec<usize>,
    /// Scratch: widgets whose support a vector of segments meets.
    pub met: Vec<ActiveWidget>,
    /// Segments integrated in 64 bits.
    pub exact_count: u64,
    /// Evaluations of the transfer function: see [`voltet_optics::engine::RenderStats::evaluations`].
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
    /// True if widgets overlap by more than [`MIX_PRODUCT`].
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

    /// Empties the queues.
    pub fn clear(&mut self) {
        let Shaded { in_order, deep, dense, rest, .. } = self;
        in_order.iter_mut().chain([deep, dense, rest]).for_each(Vec::clear);
    }

    /// Fragments that need slower kernels, kind by kind; those of the last have an unknown opacity.
    pub fn left_over(&self) -> [&Vec<usize>; KINDS] {
        let [few, some, many] = &self.in_order;
        [few, some, many, &self.deep, &self.dense, &self.rest]
    }

    /// Mutable form of [`Shaded::left_over`].
    pub fn left_over_mut(&mut self) -> [&mut Vec<usize>; KINDS] {
        let [few, some, many] = &mut self.in_order;
        [few, some, many, &mut self.deep, &mut self.dense, &mut self.rest]
    }

    /// Stores colours, or colours and opacities, of the fragments of a vector, one a lane.
    #[inline(always)]
    pub fn put<L: Lanes, const N: usize>(&mut self, group: &[usize], values: [L::F; N]) {
        for (column, value) in self.rgba.iter_mut().zip(values) {
            let mut row = [0f32; MAX_LANES];
            value.store(&mut row);
            for (&value, &k) in row.iter().zip(group) {
                column[k] = value;
            }
        }
    }

    /// Moves segments of the rest that were too dense or too delicate to the dense ones.
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

/// Reason why a segment falls back to the 64-bit forms.
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
    /// True if the steps for dense segments may integrate it.
    pub(crate) fn is_for_dense_steps(self) -> bool {
        matches!(self, Left::Dense | Left::Delicate)
    }

    /// Text for users.
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

/// A widget whose support a vector of segments meets.
pub(crate) struct ActiveWidget {
    pub(super) number: usize,
    /// Lanes (bits) that meet it.
    pub(super) there: u32,
    /// Densities in the current step, if those of the next step follow from them.
    pub(super) rows: Option<StepLanes>,
}

/// A [`LaneGaussianSteps`] lane by lane.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct StepLanes([[f32; MAX_LANES]; 9]);

impl StepLanes {
    #[inline(always)]
    pub(super) fn new<L: Lanes>(
        LaneGaussianSteps { values, ratios, change }: &LaneGaussianSteps<L, 4>,
    ) -> StepLanes {
        let mut rows = [[0.0; MAX_LANES]; 9];
        for (row, value) in rows.iter_mut().zip(values.iter().chain(ratios).chain([change])) {
            value.store(row);
        }
        StepLanes(rows)
    }

    #[inline(always)]
    pub(super) fn steps<L: Lanes>(&self) -> LaneGaussianSteps<L, 4> {
        let row = inlined(
            #[inline(always)]
            |j: usize| L::F::load(&self.0[j]),
        );
        LaneGaussianSteps {
            values: [row(0), row(1), row(2), row(3)],
            ratios: [row(4), row(5), row(6), row(7)],
            change: row(8),
        }
    }
}
