//! Results of shading a batch of segments, and the segments that still need a slower kernel.

use crate::fragments::batch::{Column, MAX_LANES};

pub(crate) use crate::tolerances::MIX_PRODUCT;
use voltet_simd::optics::gaussian::LaneGaussianSteps;
use voltet_simd::{Float, Lanes, inlined};

/// Steps of the fixed quadrature.
pub(crate) const STEPS: [usize; 3] = [2, 4, 8];

/// Kinds of fragments that the closed forms leave to slower kernels.
pub(crate) const KINDS: usize = STEPS.len() + 3;

pub(crate) struct ShadedBatch {
    /// Optical depth, or with silhouettes and light the opacity (filled when there is one colour).
    pub depth: Box<Column>,
    /// Premultiplied colour and opacity (filled otherwise).
    pub rgba: Colors,
    /// Fragments queued for fixed quadrature, by their [`STEPS`].
    pub quadrature_queues: [Vec<usize>; STEPS.len()],
    /// Fragments of known opacity, of one piecewise-linear widget, with pieces deeper than its quick form takes.
    pub thick_pieces: Vec<usize>,
    /// Fragments of known opacity that are dense.
    pub optically_thick: Vec<usize>,
    /// Other fragments that the closed forms did not integrate, then those for the 64-bit path.
    pub fallback_queue: Vec<usize>,
    /// Reason of each of the latter.
    pub reasons: Vec<FallbackReason>,
    /// Scratch for the change from the former to the latter; empty.
    pub scratch: Vec<usize>,
    /// Scratch: widgets whose support a vector of segments meets.
    pub active_widgets: Vec<SteppedWidget>,
    /// Segments integrated in 64 bits.
    pub exact_count: u64,
    /// Evaluations of the transfer function: see [`voltet_optics::engine::RenderStats::evaluations`].
    pub evaluation_count: u64,
    /// Segments on which widgets overlap by more than [`MIX_PRODUCT`].
    pub overlap_count: u64,
}

/// Colour and opacity of a batch.
pub(crate) type Colors = [Box<Column>; 4];

impl ShadedBatch {
    pub fn new() -> Self {
        ShadedBatch {
            depth: Column::new(),
            rgba: std::array::from_fn(|_| Column::new()),
            quadrature_queues: Default::default(),
            thick_pieces: Vec::new(),
            optically_thick: Vec::new(),
            fallback_queue: Vec::new(),
            reasons: Vec::new(),
            scratch: Vec::new(),
            active_widgets: Vec::new(),
            exact_count: 0,
            evaluation_count: 0,
            overlap_count: 0,
        }
    }

    pub fn clear(&mut self) {
        let ShadedBatch { quadrature_queues, thick_pieces, optically_thick, fallback_queue, .. } = self;
        quadrature_queues
            .iter_mut()
            .chain([thick_pieces, optically_thick, fallback_queue])
            .for_each(Vec::clear);
    }

    /// Fragments that need slower kernels, kind by kind; those of the last have an unknown opacity.
    pub fn left_over(&self) -> [&Vec<usize>; KINDS] {
        let [few, some, many] = &self.quadrature_queues;
        [few, some, many, &self.thick_pieces, &self.optically_thick, &self.fallback_queue]
    }

    /// Mutable form of [`ShadedBatch::left_over`].
    pub fn left_over_mut(&mut self) -> [&mut Vec<usize>; KINDS] {
        let [few, some, many] = &mut self.quadrature_queues;
        [few, some, many, &mut self.thick_pieces, &mut self.optically_thick, &mut self.fallback_queue]
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

    /// Moves queued segments that were too thick or too delicate for panels to the optically thick ones.
    pub fn move_optically_thick(&mut self) {
        let ShadedBatch { fallback_queue, reasons, optically_thick, .. } = self;
        let mut each = reasons.iter();
        fallback_queue.retain(|&k| {
            let moves = each.next().is_some_and(|reason| reason.is_for_thick_panels());
            if moves {
                optically_thick.push(k);
            }
            !moves
        });
        reasons.retain(|reason| !reason.is_for_thick_panels());
    }
}

/// Reason why a segment falls back to the 64-bit forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FallbackReason {
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

impl FallbackReason {
    /// True if panels for optically thick segments may integrate it.
    pub(crate) fn is_for_thick_panels(self) -> bool {
        matches!(self, FallbackReason::Dense | FallbackReason::Delicate)
    }

    /// Text for users.
    pub fn text(self) -> &'static str {
        match self {
            FallbackReason::Integrator => "the integrator is one of 64 bits",
            FallbackReason::Samples => "samples, their widths or their depths leave the range of 32 bits",
            FallbackReason::NoLanes => "a region cuts the pieces of a widget, or its numbers leave 32 bits",
            FallbackReason::Lengths => "lengths per unit distance leave the range of 32 bits",
            FallbackReason::Mixed => "colours that vary along the segment are mixed in 64 bits",
            FallbackReason::Narrow => {
                "the segment spans over 100,000 widths of a Gaussian, or 50 of a triangular one"
            }
            FallbackReason::Overflow => "an optical depth leaves the range of 32 bits",
            FallbackReason::Delicate => {
                "a wave or a triangular Gaussian stands among others, or glows without absorbing in step"
            }
            FallbackReason::Dense => {
                "a density of over 10,000,000, or of 200 under the constant-emitter, needs finer steps than 32 bits take"
            }
        }
    }
}

/// Depth from which on a segment whose order takes more than a few steps goes straight to the steps for dense ones.
pub(crate) const MIN_THICK_DEPTH: f32 = 8.0;

/// A widget whose support a vector of segments meets.
pub(crate) struct SteppedWidget {
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
        let row = inlined!(|j: usize| L::F::load(&self.0[j]));
        LaneGaussianSteps {
            values: [row(0), row(1), row(2), row(3)],
            ratios: [row(4), row(5), row(6), row(7)],
            change: row(8),
        }
    }
}
