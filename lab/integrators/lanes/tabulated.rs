//! Gaussians' integrals from tables. Twin of `Tabulated`: each widget by itself, all of them averaged without
//! their order.

use super::gaussian_table::LaneGaussianTables;
use crate::GaussianTables;
use voltet_cpu::integrator::{
    FallbackReason, FieldLanes, LaneKernel, LaneScene, RegionPath, SegmentBatch, SegmentLanes,
    SegmentResults, WidgetLanes,
};
use voltet_simd::limits::MAX_GAUSSIAN_WIDTHS;
use voltet_simd::optics::elementary::{exp, mean_transparency};
use voltet_simd::{Float, Lanes, Mask, array};

/// The tables, and what they are read for.
pub(super) struct Tabulated {
    tables: LaneGaussianTables,
    /// The constant-emitter's glow per scene length and −ln cutoff; `None` for the density-emitter.
    glow: Option<(f32, f32)>,
    /// True if widgets read further fields.
    reads_fields: bool,
}

impl Tabulated {
    /// Errors: the reason why the scene falls back to 64 bits.
    pub fn new(tables: &GaussianTables, scene: &LaneScene<'_>) -> Result<Tabulated, FallbackReason> {
        if !scene.widgets().all(|widget| widget.has_path()) {
            return Err(FallbackReason::NoLanes);
        }
        let glow = scene.glow_scale()?.zip(scene.model().cutoff());
        Ok(Tabulated {
            tables: LaneGaussianTables::new(tables),
            glow: glow.map(|(scale, cutoff)| (scale, -cutoff.ln() as f32)),
            reads_fields: scene.reads_fields(),
        })
    }

    /// Depth and light of one widget where it is met, the light over the mean transparency of that depth; and the lanes (bits) whose
    /// paths span more widths than 32 bits resolve.
    #[inline(always)]
    fn widget_light<L: Lanes>(
        &self,
        widget: WidgetLanes<'_>,
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
        depth_only: bool,
    ) -> (L::F, L::F, u32) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let RegionPath { path, fraction: share, present: there } = widget.path(segments, fields);
        let rate = splat(widget.density()) * segments.length() * share;
        // Where there is no stretch its ends are no numbers.
        let there = there.and(zero.lt(rate));
        let (mut mean, mut unsure) = (one, 0);
        if let Some(path) = &path {
            mean = self.tables.mean::<L>(path.front, path.back) * exp::<L>(-path.offset_squared);
            unsure = path.length.le(splat(MAX_GAUSSIAN_WIDTHS as f32)).not().bits() & there.bits();
        }
        let own = L::F::select(there, rate * mean, zero);
        let Some((scale, level)) = self.glow else { return (own, own, unsure) };
        if depth_only {
            return (own, own, unsure);
        }
        let seen = match &path {
            Some(path) => {
                self.tables.glow::<L>(path, level, [share, own, rate]) / mean_transparency::<L>(own)
            }
            None => share,
        };
        let light = L::F::select(there, splat(scale) * segments.length() * seen, zero);
        (own, light, unsure)
    }
}

impl LaneKernel for Tabulated {
    fn table_bytes(&self) -> usize {
        self.tables.bytes()
    }

    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let depth_only = batch.depth_only();
        let zero = L::F::splat(0.0);
        let mut fields = FieldLanes::<L>::none();
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let segments = batch.segments::<L>(at);
            if self.reads_fields {
                fields = batch.fields::<L>(at);
            }
            let spread = segments.range();
            let (mut depth, mut product, mut light) = (zero, zero, [zero; 3]);
            let (mut asked, mut unsure) = (0, 0);
            for widget in batch.widgets() {
                let meets = widget.path_meets::<L>(&spread);
                if !meets.any() {
                    continue;
                }
                asked |= meets.bits();
                let (own, glow, no) =
                    self.widget_light::<L>(widget, &segments.only(meets), &fields, depth_only);
                unsure |= no;
                product = own.mul_add(depth, product);
                depth = depth + own;
                if !depth_only {
                    for c in 0..3 {
                        light[c] = glow.mul_add(L::F::splat(widget.color()[c]), light[c]);
                    }
                }
            }
            results.put_depth::<L>(at, depth);
            let mut whole = depth;
            if !depth_only {
                let dimmed = mean_transparency::<L>(depth);
                let [r, g, b]: [L::F; 3] = array(
                    #[inline(always)]
                    |c| light[c] * dimmed,
                );
                // A number that is none, or has left 32 bits, makes the sum one.
                whole = depth + (r + (g + b));
                results.put::<L>(at, [r, g, b], depth);
            }
            unsure |= whole.le(L::F::splat(f32::MAX)).not().bits();
            let within = batch.within::<L>(segments.crossing(), at);
            unsure &= within;
            results.fall_back(at, unsure);
            results.count_evaluations(u64::from((asked & within).count_ones()));
            if batch.widgets().len() > 1 {
                results.count_overlaps::<L>(product, &segments, batch.count() - at, unsure);
            }
        }
    }
}
