//! Pre-integrated tables. Twin of `{PreIntegrated, PreIntegratedCylindrical}`: C/(D E₁) from a table over
//! (s_f, s_b, D), or from tiles, and the mean extinction, filled in lanes and read by gathers. They serve every segment.

use super::slices::{LaneRamp, LaneVolume, fill_tiles, to_cylinder};
use super::square::LaneSquare;
use crate::{Material, Ramp, last_tile};
use rayon::prelude::*;
use voltet_core::Result;
use voltet_cpu::integrator::{LaneKernel, LaneScene, NEGLIGIBLE_DEPTH, SegmentBatch, SegmentResults};
use voltet_simd::optics::elementary::mean_transparency;
use voltet_simd::{Float, Kernel, Lanes, Mask, array, dispatch};

/// Depths of a segment beyond which it is opaque whatever they are.
const MAX_DEPTH: f32 = 1e30;

/// Nodes about a place that tiles read: the next in s and in t, four for the next plane, and the next of the table that filled
/// them; one over.
const TILES_REACH: f32 = 8.0;

/// A pre-integrated table.
pub(super) struct Table {
    side: usize,
    /// Stored position of the first node, and nodes a stored unit.
    start: f32,
    per_value: f32,
    /// Longest segments a scene length.
    per_length: f32,
    /// For each step from node to node the first at or behind it in which something is.
    filled: Vec<f32>,
    kind: Kind,
}

enum Kind {
    /// Over (s_f, s_b, D); the fourth number is ρ̄.
    Slices(LaneVolume),
    /// Over (α, s, t), and ρ̄ of (s_f, s_b).
    Tiles { tiles: LaneVolume, last: f32, means: LaneSquare },
}

impl Table {
    /// `size` entries a side, `oversampling` pieces from one to the next; `planes`: tiles by the side, `None` for no tiles. Errors:
    /// data without a domain for a table.
    pub fn new(
        size: usize,
        oversampling: usize,
        planes: Option<usize>,
        scene: &LaneScene<'_>,
    ) -> Result<Table> {
        let (extent, lanes) = (scene.extent(), scene.lanes());
        let ramp = Ramp::new(scene.transfer_function, size, oversampling, extent)?;
        let [low, high] = ramp.range;
        let axis = scene.scalar_axis();
        let narrow = LaneRamp::new(&ramp);
        let mut slices = LaneVolume::new(size, size);
        let (entries, length) = slices.groups();
        entries.par_chunks_mut(length).enumerate().for_each(|(group, out)| {
            dispatch(lanes, FillSlices { ramp: &narrow, group, planes: size, out });
        });
        let kind = if let Some(planes) = planes {
            let last = last_tile(size, planes);
            let mut tiles = LaneVolume::new(size, last + 1);
            let (entries, length) = tiles.groups();
            entries.par_chunks_mut(length).enumerate().for_each(|(group, out)| {
                dispatch(lanes, FillTiles { table: &slices, group, planes: last + 1, out });
            });
            Kind::Tiles { tiles, last: last as f32, means: LaneSquare::new(narrow.means(), size) }
        } else {
            Kind::Slices(slices)
        };
        Ok(Table {
            side: size,
            start: ((low - axis.offset) / axis.scale) as f32,
            per_value: ((size - 1) as f64 * axis.scale / (high - low)) as f32,
            per_length: (scene.length() / extent.longest) as f32,
            filled: filled(&ramp, scene.length() / extent.longest, scene.may_skip()),
            kind,
        })
    }
}

impl LaneKernel for Table {
    fn table_bytes(&self) -> usize {
        match &self.kind {
            Kind::Slices(slices) => slices.bytes(),
            Kind::Tiles { tiles, means, .. } => tiles.bytes() + means.bytes(),
        }
    }

    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let last = splat((self.side - 1) as f32);
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let segments = batch.segments::<L>(at);
            let (front_values, back_values) = (segments.front(), segments.back());
            let [front, back]: [L::F; 2] = array(
                #[inline(always)]
                |end| {
                    let s = if end == 0 { front_values[0] } else { back_values[0] };
                    ((s - splat(self.start)) * splat(self.per_value)).max(zero).min(last)
                },
            );
            // Values that are not numbers contribute nothing.
            let numbers = front_values[0].le(front_values[0]).and(back_values[0].le(back_values[0]));
            let reach = match self.kind {
                Kind::Slices(_) => zero,
                Kind::Tiles { .. } => splat(TILES_REACH),
            };
            let first = (front.min(back) - reach).floor().max(zero).min(last - one);
            let next = L::F::gather(&self.filled, first.to_unsigned());
            let behind = (front.max(back) + reach).floor() + one;
            let there = segments.crossing().and(numbers).and(next.lt(behind));
            if !there.any() {
                results.put_nothing::<L>(at);
                continue;
            }
            results.count_evaluations(u64::from(batch.within::<L>(there, at).count_ones()));
            let length = segments.length() * splat(self.per_length);
            let share = length.max(zero).min(one);
            let [r, g, b, mean] = match &self.kind {
                Kind::Slices(slices) => slices.read::<L>(front, back, share.sqrt() * last),
                Kind::Tiles { tiles, last: last_tile, means } => {
                    let [angle, s] = to_cylinder::<L>(front / last, back / last, share);
                    let [r, g, b, _] = tiles.read::<L>(s.min(one) * last, back, angle * splat(*last_tile));
                    [r, g, b, means.read(&means.place::<L>(front, back))]
                }
            };
            let depth = L::F::select(there, mean * length, zero);
            let through = mean_transparency::<L>(depth.min(splat(MAX_DEPTH)));
            let reach = L::F::select(there, length * through, zero);
            let opacity = (depth.min(splat(MAX_DEPTH)) * through).min(one);
            results.put_depth::<L>(at, depth.min(splat(f32::MAX)));
            results.put_color::<L>(at, [r * reach, g * reach, b * reach], opacity);
        }
    }
}

/// For each step between nodes the first at or behind it in which something is, or beyond all. What a ray of a scene's length may
/// lose by the others is what it may lose by the widgets that segments hardly meet; without leave to leave out, nothing.
/// `longest`: longest segments a scene length.
fn filled(ramp: &Ramp, longest: f64, leave_out: bool) -> Vec<f32> {
    let least = if leave_out { NEGLIGIBLE_DEPTH } else { 0.0 };
    let most = |matter: &Material| matter.glow.into_iter().fold(matter.extinction, f64::max) * longest;
    let (nodes, parts) = (ramp.nodes(), ramp.parts());
    let pieces = |k: usize| &ramp.pieces()[k * parts..(k + 1) * parts];
    let holds = |k: usize| nodes[k..=k + 1].iter().chain(pieces(k)).any(|matter| most(matter) > least);
    let mut next = nodes.len() as f32 + 1.0 + TILES_REACH;
    let mut filled = vec![next; nodes.len() - 1];
    for k in (0..filled.len()).rev() {
        if holds(k) {
            next = k as f32;
        }
        filled[k] = next;
    }
    filled
}

struct FillSlices<'a> {
    ramp: &'a LaneRamp,
    group: usize,
    planes: usize,
    out: &'a mut [[f32; 4]],
}

impl Kernel for FillSlices<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.ramp.fill::<L>(self.group, self.planes, self.out);
    }
}

struct FillTiles<'a> {
    table: &'a LaneVolume,
    group: usize,
    planes: usize,
    out: &'a mut [[f32; 4]],
}

impl Kernel for FillTiles<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        fill_tiles::<L>(self.table, self.group, self.planes, self.out);
    }
}
