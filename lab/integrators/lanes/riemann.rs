//! N point samples. Twin of `Riemann`: each stands for a homogeneous piece with its own absorption,
//! κ h E₁(ρ h).

use voltet_cpu::integrator::{
    LaneKernel, SIDE_BY_SIDE, SampledSegments, Samples, SegmentBatch, SegmentResults, WidgetSampler,
};
use voltet_simd::optics::elementary::{exp, transparencies};
use voltet_simd::{Float, Lanes, array};

/// Such samples: `N`, or any number if that is 0.
pub(super) struct Riemann<const N: usize>(pub WidgetSampler);

impl<const N: usize> LaneKernel for Riemann<N> {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let count = self.0.count();
        self.0.integrate::<L>(
            batch,
            count,
            #[inline(always)]
            |crossed| riemann::<L, N>(count, crossed, batch.depth_only()),
            results,
        );
    }
}

/// Colour and optical depth. `depth_only`: no colour.
#[inline(always)]
fn riemann<L: Lanes, const N: usize>(
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    depth_only: bool,
) -> ([L::F; 3], L::F) {
    crossed.by_depth(
        depth_only,
        #[inline(always)]
        |crossed, colors| match N {
            0 => in_steps(count, crossed, colors),
            _ => together::<L, N>(count, crossed, colors),
        },
    )
}

/// The middle of piece i.
#[inline(always)]
fn middle(i: usize, count: usize) -> f32 {
    ((i as f64 + 0.5) / count as f64) as f32
}

/// All samples at once.
#[inline(always)]
fn together<L: Lanes, const N: usize>(
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    colors: bool,
) -> ([L::F; 3], L::F) {
    let places = array(
        #[inline(always)]
        |j| middle(j, count),
    );
    let samples = crossed.at::<N>(places, colors);
    let mut sum = Front::<L>::new();
    let step = crossed.length() * L::F::splat(1.0 / count as f32);
    sum.add(&samples, [step; N], colors);
    (sum.color, sum.depth)
}

/// Some samples after the other.
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
        let t = array(
            #[inline(always)]
            |j| middle((first + j).min(count - 1), count),
        );
        let samples = crossed.in_step(block, share, [0.125, 0.375, 0.625, 0.875], t, colors);
        let lengths = array(
            #[inline(always)]
            |j| if first + j < count { step } else { splat(0.0) },
        );
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
