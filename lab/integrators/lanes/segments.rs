//! N pieces of linear colour and extinction. Twin of `Segments`: the ends are classified, and the
//! two-dimensional table gives the weights of both colours.

use super::partial_table::LanePartialTable;
use voltet_cpu::integrator::{
    LaneKernel, SIDE_BY_SIDE, SampledSegments, Samples, SegmentBatch, SegmentResults, WidgetSampler,
};
use voltet_simd::optics::elementary::{exp, transparencies};
use voltet_simd::{Float, Lanes, array};

/// Such pieces.
pub(super) struct Pieces {
    pub ends: WidgetSampler,
    /// Weights of a piece's ends.
    pub table: LanePartialTable,
}

impl LaneKernel for Pieces {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let Pieces { ends, table } = self;
        let count = ends.count();
        ends.integrate::<L>(
            batch,
            count + 1,
            #[inline(always)]
            |crossed| pieces::<L>(table, count, crossed, batch.depth_only()),
            results,
        );
    }
}

/// Colour and optical depth. `depth_only`: no colour.
#[inline(always)]
fn pieces<L: Lanes>(
    table: &LanePartialTable,
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    depth_only: bool,
) -> ([L::F; 3], L::F) {
    crossed.by_depth(
        depth_only,
        #[inline(always)]
        |crossed, colors| walk(table, count, crossed, colors),
    )
}

/// An end of a piece, by its rate in the length of a piece.
#[derive(Clone, Copy)]
struct End<L: Lanes> {
    rate: L::F,
    /// Its colour under the density-emitter, its glow in the length of a piece under the constant-emitter.
    light: [L::F; 3],
}

/// Piece after piece.
#[inline(always)]
fn walk<L: Lanes>(
    table: &LanePartialTable,
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    colors: bool,
) -> ([L::F; 3], L::F) {
    let splat = L::F::splat;
    let (zero, half) = (splat(0.0), splat(0.5));
    let step = crossed.length() * splat(1.0 / count as f32);
    let density = crossed.is_density_emitter();
    let (mut color, mut depth, mut through) = ([zero; 3], zero, splat(1.0));
    let mut front = ends::<L, 1>(&crossed.at([0.0], colors), step, density)[0];
    let share = SIDE_BY_SIDE as f32 / count as f32;
    for block in 0..count.div_ceil(SIDE_BY_SIDE) {
        let first = block * SIDE_BY_SIDE;
        let t = array(
            #[inline(always)]
            |j| ((first + j + 1).min(count) as f64 / count as f64) as f32,
        );
        let samples = if count == 1 {
            let one = crossed.at::<1>([1.0], colors);
            Samples { rate: [one.rate[0]; SIDE_BY_SIDE], glow: [one.glow[0]; SIDE_BY_SIDE] }
        } else {
            crossed.in_step(block, share, [0.25, 0.5, 0.75, 1.0], t, colors)
        };
        let ends = ends::<L, SIDE_BY_SIDE>(&samples, step, density);
        for j in 0..SIDE_BY_SIDE {
            if first + j == count {
                break;
            }
            let back = ends[j];
            let piece = half * (front.rate + back.rate);
            if colors {
                let (mean, behind) = transparencies::<L>(piece);
                if density {
                    let toward = table.front_share::<L>(front.rate, back.rate);
                    let light = through * (piece * mean);
                    // An end without stuff takes the other's colour.
                    let (bare, bare_back) = (front.rate.lt(least::<L>()), back.rate.lt(least::<L>()));
                    for c in 0..3 {
                        let near = L::F::select(bare, back.light[c], front.light[c]);
                        let far = L::F::select(bare_back, front.light[c], back.light[c]);
                        color[c] = light.mul_add(toward.mul_add(near - far, far), color[c]);
                    }
                } else {
                    let (near, far) = table.front_back::<L>(front.rate, back.rate);
                    for c in 0..3 {
                        let light = near.mul_add(front.light[c], far * back.light[c]);
                        color[c] = through.mul_add(light, color[c]);
                    }
                }
                through = through * behind;
            }
            depth = depth + piece;
            front = back;
        }
        through = exp::<L>(-depth);
    }
    (color, depth)
}

/// The least rate by which a glow is divided.
#[inline(always)]
fn least<L: Lanes>() -> L::F {
    L::F::splat(f32::MIN_POSITIVE)
}

#[inline(always)]
fn ends<L: Lanes, const N: usize>(samples: &Samples<L, N>, step: L::F, density: bool) -> [End<L>; N] {
    array(
        #[inline(always)]
        |j| {
            let rate = samples.rate[j];
            let scale = if density { L::F::splat(1.0) / rate.max(least::<L>()) } else { step };
            let light = array(
                #[inline(always)]
                |c| samples.glow[j][c] * scale,
            );
            End { rate: rate * step, light }
        },
    )
}
