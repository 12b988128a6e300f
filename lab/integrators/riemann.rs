//! N point samples: the baseline of Kniss et al. 2003, Figure 1.
//!
//! Samples lie at the middles (i + ½)/N, and each stands for a homogeneous piece with its own absorption,
//! κ h E₁(ρ h): emission without it is wrong by ρl/2N (Roettger & Ertl 2002, Eq. 6).

use crate::settings::{PIECES, PIECES_PARAMETER, PreparedKernel, WGSL_PIECES, boxed, check_pieces, count};
use std::any::Any;
use voltet_core::Result;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::TransferFunction;
use voltet_cpu::integrator::{
    LaneExtension, LaneIntegratorKind, LaneKernel, LaneScene, SIDE_BY_SIDE, SampledSegments, Samples,
    SegmentBatch, SegmentResults, WidgetSampler,
};
use voltet_optics::integrators::{Extent, Integrator, IntegratorKind, SegmentIntegrator, can_serve};
use voltet_optics::special::{OPAQUE_DEPTH, mean_transmittance, opacity};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_shaders::{WgslCall, WgslExtension, WgslIntegrator, WgslPiece};
use voltet_simd::optics::elementary::{exp, transparencies};
use voltet_simd::{Float, Lanes, array};

/// Point samples: `count` ≥ 1 of a segment.
pub const fn riemann(count: usize) -> Integrator {
    Integrator::with_settings(&RiemannKind, [count as f64])
}

pub(crate) struct RiemannKind;

impl IntegratorKind for RiemannKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema { name: "riemann", summary: "point samples", parameters: &[PIECES_PARAMETER] }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_pieces(integrator)
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Riemann::new(transfer_function, count(integrator, PIECES))?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&RiemannKind), &WgslExtension(&RiemannKind)]
    }
}

impl LaneIntegratorKind for RiemannKind {
    fn prepare(&self, integrator: &Integrator, scene: &LaneScene<'_>) -> Result<PreparedKernel> {
        let count = count(integrator, PIECES);
        Ok(WidgetSampler::new(count, false, scene).map(|sampler| match count {
            1 => boxed(RiemannKernel::<1>(sampler)),
            2 => boxed(RiemannKernel::<2>(sampler)),
            _ => boxed(RiemannKernel::<0>(sampler)),
        }))
    }
}

impl WgslIntegrator for RiemannKind {
    fn pieces(&self) -> &'static [WgslPiece] {
        WGSL_PIECES
    }

    fn call(&self, _: bool) -> WgslCall {
        WgslCall::Samples { function: "riemann", pieces: &["sampled/riemann"], reads_numbers: false }
    }

    fn piece_count(&self, integrator: &Integrator) -> Option<usize> {
        integrator.count(PIECES)
    }
}

#[derive(Debug, Clone)]
pub struct Riemann {
    prepared: CompiledTransferFunction,
    count: usize,
}

impl Riemann {
    /// Serves every transfer function; `count` ≥ 1.
    pub fn new(transfer_function: &TransferFunction, count: usize) -> Result<Self> {
        can_serve(&riemann(count), transfer_function)?;
        Ok(Riemann { prepared: CompiledTransferFunction::new(transfer_function)?, count })
    }
}

impl SegmentIntegrator for Riemann {
    fn integrate(&self, segment: &Segment) -> Contribution {
        let step = 1.0 / self.count as f64;
        self.prepared.sampled(segment, |samples| {
            let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
            for i in 0..self.count {
                let sample = samples.at((i as f64 + 0.5) * step);
                let piece = sample.rate * step;
                if depth < OPAQUE_DEPTH {
                    let light = (-depth).exp() * step * mean_transmittance(piece);
                    for (sum, glow) in color.iter_mut().zip(sample.glow) {
                        *sum += light * glow;
                    }
                }
                depth += piece;
            }
            Contribution { optical_depth: depth, color, opacity: opacity(depth) }
        })
    }
}

/// Point samples in lanes: `N`, or any number if that is 0.
struct RiemannKernel<const N: usize>(WidgetSampler);

impl<const N: usize> LaneKernel for RiemannKernel<N> {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let count = self.0.count();
        self.0.integrate::<L>(
            batch,
            count,
            #[inline(always)]
            |crossed| {
                crossed.by_depth(
                    batch.depth_only(),
                    #[inline(always)]
                    |crossed, colors| match N {
                        0 => in_steps(count, crossed, colors),
                        _ => together::<L, N>(count, crossed, colors),
                    },
                )
            },
            results,
        );
    }
}

#[inline(always)]
fn middle(i: usize, count: usize) -> f32 {
    ((i as f64 + 0.5) / count as f64) as f32
}

#[inline(always)]
fn together<L: Lanes, const N: usize>(
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    colors: bool,
) -> ([L::F; 3], L::F) {
    let places = array!(|j| middle(j, count));
    let samples = crossed.at::<N>(places, colors);
    let mut sum = Front::<L>::new();
    let step = crossed.length() * L::F::splat(1.0 / count as f32);
    sum.add(&samples, [step; N], colors);
    (sum.color, sum.depth)
}

#[inline(always)]
fn in_steps<L: Lanes>(
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    colors: bool,
) -> ([L::F; 3], L::F) {
    let splat = L::F::splat;
    let mut sum = Front::<L>::new();
    let share = SIDE_BY_SIDE as f32 / count as f32;
    let step = crossed.length() * splat(1.0 / count as f32);
    for block in 0..count.div_ceil(SIDE_BY_SIDE) {
        let first = block * SIDE_BY_SIDE;
        // What lies behind the back counts for nothing.
        let t = array!(|j| middle((first + j).min(count - 1), count));
        let samples = crossed.in_step(block, share, [0.125, 0.375, 0.625, 0.875], t, colors);
        let lengths = array!(|j| if first + j < count { step } else { splat(0.0) });
        sum.add(&samples, lengths, colors);
        sum.through = exp::<L>(-sum.depth);
    }
    (sum.color, sum.depth)
}

/// Optical depth and emission in front of a position.
struct Front<L: Lanes> {
    color: [L::F; 3],
    depth: L::F,
    through: L::F,
}

impl<L: Lanes> Front<L> {
    #[inline(always)]
    fn new() -> Self {
        let zero = L::F::splat(0.0);
        Front { color: [zero; 3], depth: zero, through: L::F::splat(1.0) }
    }

    /// Homogeneous pieces of these lengths.
    #[inline(always)]
    fn add<const N: usize>(&mut self, samples: &Samples<L, N>, lengths: [L::F; N], colors: bool) {
        for j in 0..N {
            let piece = samples.rate[j] * lengths[j];
            if colors {
                let (mean, through) = transparencies::<L>(piece);
                let light = self.through * mean * lengths[j];
                for c in 0..3 {
                    self.color[c] = light.mul_add(samples.glow[j][c], self.color[c]);
                }
                if j + 1 < N {
                    self.through = self.through * through;
                }
            }
            self.depth = self.depth + piece;
        }
    }
}
