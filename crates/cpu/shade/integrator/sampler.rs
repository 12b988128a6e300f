//! Samples of the transfer function along segments: the widgets that a vector of segments meets, and their values at places of it. Twin
//! of `optics::overlap`.

use super::scene::{LaneScene, SegmentResults};
use crate::fragments::batch::meant;
use crate::shade::kernel::{SegmentBatch, overlaps, push};
use crate::shade::kinds::LaneWidget;
use crate::shade::region::ValueRange;
use crate::shade::segment_lanes::{FieldLanes, SegmentLanes};
use crate::shade::shaded_batch::FallbackReason;
use voltet_simd::limits::MAX_PIECES;
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::optics::gaussian::LaneGaussianSteps;
use voltet_simd::{Float, Lanes, Mask, array, inlined};

/// Samples that are taken side by side ([`SampledSegments::in_step`]).
pub const SIDE_BY_SIDE: usize = 4;

/// Steps of so many samples after which a Gaussian's are found anew.
const STEPS_ON_END: usize = 4;

/// Cutoffs that e^(−x²) in 32 bits tells from nothing.
const MIN_CUTOFF: f64 = 1e-30;

/// A sampler at equal distances.
pub struct WidgetSampler {
    /// Samples or pieces of a segment.
    count: usize,
    /// For each widget, the value of a sample above which it glows (constant-emitter).
    thresholds: Vec<f32>,
    /// The constant-emitter's glow per scene length; `None` for the density-emitter.
    glow: Option<f32>,
    reads_fields: bool,
    /// True if a widget is skipped only with all others.
    together: bool,
}

/// Widget whose support a vector of segments meets.
struct ActiveWidget<'a, L: Lanes> {
    widget: &'a LaneWidget,
    threshold: f32,
    /// Lanes in which it is.
    there: L::M,
    /// True if its region cuts some of them.
    is_cut: bool,
    /// True if values follow from step to step.
    follows: bool,
}

/// Numbers of an active widget, reused from batch to batch.
#[derive(Clone, Copy)]
struct Slot<L: Lanes> {
    /// The part of each segment inside its region.
    range: [L::F; 2],
    /// The sum of its rates so far.
    sum: L::F,
    /// Its values in the step in hand.
    steps: LaneGaussianSteps<L, SIDE_BY_SIDE>,
}

/// Absorption and emission at some places of each segment, per scene length.
pub struct Samples<L: Lanes, const N: usize> {
    /// Extinction.
    pub rate: [L::F; N],
    /// Emission by channel.
    pub glow: [[L::F; 3]; N],
}

/// A vector of segments with the widgets that it meets.
pub struct SampledSegments<'a, 'b, L: Lanes> {
    segments: &'b SegmentLanes<L>,
    fields: &'b FieldLanes<L>,
    active: &'b [ActiveWidget<'a, L>],
    slots: &'b mut [Slot<L>],
    /// The constant-emitter's glow per scene length.
    glow: Option<f32>,
}

impl WidgetSampler {
    /// A sampler of `count` samples or pieces of each segment. `together`: a widget may be left out only with all others, as where
    /// neighbouring samples share a colour.
    ///
    /// Errors: why lanes do not sample the scene.
    pub fn new(count: usize, together: bool, scene: &LaneScene<'_>) -> Result<WidgetSampler, FallbackReason> {
        let LaneScene { widgets, context, .. } = *scene;
        if MAX_PIECES < count.try_into().unwrap_or(u32::MAX) {
            return Err(FallbackReason::Samples);
        }
        if !widgets.iter().all(LaneWidget::has_samples) {
            return Err(FallbackReason::NoLanes);
        }
        let cutoff = context.model.cutoff();
        let glow = context.glow_scale()?;
        let is_lost =
            |cutoff: f64| cutoff < MIN_CUTOFF && widgets.iter().any(|widget| widget.traits().is_exponential);
        if cutoff.is_some_and(is_lost) {
            return Err(FallbackReason::Samples);
        }
        let threshold = |widget: &LaneWidget| match cutoff {
            // What does not absorb does not glow.
            Some(_) if widget.density() <= 0.0 => f32::INFINITY,
            Some(cutoff) => (cutoff * widget.peak_value(context.density_scale)) as f32,
            None => 0.0,
        };
        Ok(WidgetSampler {
            count,
            thresholds: widgets.iter().map(threshold).collect(),
            glow,
            reads_fields: !context.fields.is_empty(),
            together,
        })
    }

    /// Samples or pieces of a segment.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Integrates a batch: `integrate` returns colours and optical depths of a vector of segments from so many `places` of each.
    #[inline(always)]
    pub fn integrate<L: Lanes>(
        &self,
        batch: SegmentBatch<'_>,
        places: usize,
        mut integrate: impl FnMut(&mut SampledSegments<'_, '_, L>) -> ([L::F; 3], L::F),
        results: &mut SegmentResults<'_>,
    ) {
        let SegmentBatch { widgets, one_color, batch, count } = batch;
        let out = &mut *results.0;
        let zero = L::F::splat(0.0);
        let steps = LaneGaussianSteps { values: [zero; 4], ratios: [zero; 4], change: zero };
        let mut slots = vec![Slot::<L> { range: [zero; 2], sum: zero, steps }; widgets.len()];
        let mut active: Vec<ActiveWidget<L>> = Vec::with_capacity(widgets.len());
        let mut fields = FieldLanes::<L>::none();
        for at in (0..count).step_by(L::WIDTH) {
            let segments = SegmentLanes::<L>::load(batch, at);
            let mut unsure = self.meet::<L>(widgets, &segments, &mut active, &mut slots);
            if active.is_empty() {
                zero.store(&mut out.depth[at..]);
                out.rgba.iter_mut().for_each(|column| zero.store(&mut column[at..]));
                continue;
            }
            if self.reads_fields {
                fields = FieldLanes::<L>::load(batch, at);
            }
            let (segments, fields) = (&segments, &fields);
            let mut crossed =
                SampledSegments { segments, fields, active: &active, slots: &mut slots, glow: self.glow };
            let (color, depth) = integrate(&mut crossed);
            depth.store(&mut out.depth[at..]);
            if one_color {
                unsure |= depth.le(L::F::splat(f32::MAX)).not().bits();
            } else {
                let opacity = one_minus_exp::<L>(depth);
                // A number that is none, or has left 32 bits, makes the sum one.
                let whole = depth + (color[0] + (color[1] + color[2]));
                unsure |= whole.le(L::F::splat(f32::MAX)).not().bits();
                let [r, g, b] = color;
                for (column, value) in out.rgba.iter_mut().zip([r, g, b, opacity]) {
                    value.store(&mut column[at..]);
                }
            }
            let meant = meant::<L>(segments.crossing, count - at);
            unsure &= meant;
            push(&mut out.fallback_queue, unsure, at);
            let there = active.iter().fold(0, |all, active| all | active.there.bits()) & meant;
            out.evaluation_count += u64::from(there.count_ones()) * places as u64;
            if active.len() > 1 {
                let share = segments.length * L::F::splat(1.0 / self.count as f32);
                let (mut product, mut total) = (zero, zero);
                for slot in &slots[..active.len()] {
                    let depth = slot.sum * share;
                    product = depth.mul_add(total, product);
                    total = total + depth;
                }
                let overlapping = overlaps::<L>(product, segments, count - at) & !unsure;
                out.overlap_count += u64::from(overlapping.count_ones());
            }
        }
    }

    /// Finds the widgets that a vector of segments meets; the lanes (bits) that are not served.
    #[inline(always)]
    fn meet<'a, L: Lanes>(
        &self,
        widgets: &'a [LaneWidget],
        segments: &SegmentLanes<L>,
        active: &mut Vec<ActiveWidget<'a, L>>,
        slots: &mut [Slot<L>],
    ) -> u32 {
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        active.clear();
        let spread = ValueRange::new(segments);
        let mut unsure = 0;
        // The colour of a piece's end is that of what little is there, which has a share in the light of the whole piece: a widget
        // may be left out only with all others.
        if self.together
            && !widgets.iter().any(inlined!(|widget: &LaneWidget| widget.meets::<L>(&spread).any()))
        {
            return 0;
        }
        for (widget, &threshold) in widgets.iter().zip(&self.thresholds) {
            let mut there = if self.together { segments.crossing } else { widget.meets::<L>(&spread) };
            if !there.any() {
                continue;
            }
            let slot = &mut slots[active.len()];
            let mut is_cut = false;
            if widget.region.is_some() {
                let [start, end] = widget.range(segments);
                there = there.and(start.lt(end));
                if !there.any() {
                    continue;
                }
                is_cut = there.and(zero.lt(start).or(end.lt(one))).any();
                slot.range = [start, end];
            }
            slot.sum = zero;
            unsure |= widget.too_wide(segments) & there.bits();
            let share = SIDE_BY_SIDE as f32 / self.count as f32;
            let follows = SIDE_BY_SIDE < self.count && widget.has_steps(segments, share);
            active.push(ActiveWidget { widget, threshold, there, is_cut, follows });
        }
        unsure
    }
}

impl<L: Lanes> SampledSegments<'_, '_, L> {
    /// Lengths of the segments.
    #[inline(always)]
    pub fn length(&self) -> L::F {
        self.segments.length
    }

    /// True under the density-emitter, where emission is colour times extinction.
    #[inline(always)]
    pub fn is_density_emitter(&self) -> bool {
        self.glow.is_none()
    }

    /// Colour and optical depth by `integrate`, which computes colours if its flag is set. The depth is enough if no colour is needed
    /// (`depth_only`), or if the vector meets one widget of one colour that emits in proportion to its extinction: then its light is its
    /// opacity, in however many pieces.
    #[inline(always)]
    pub fn by_depth(
        &mut self,
        depth_only: bool,
        integrate: impl FnOnce(&mut Self, bool) -> ([L::F; 3], L::F),
    ) -> ([L::F; 3], L::F) {
        let one_color = match self.active {
            [active] if self.glow.is_none() && !active.widget.traits().has_colors => {
                Some(active.widget.color)
            }
            _ => None,
        };
        // A flag, not a constant: a second copy of all widgets' values would double what is compiled.
        let (color, depth) = integrate(self, !depth_only && one_color.is_none());
        let Some(one_color) = one_color.filter(|_| !depth_only) else {
            return (color, depth);
        };
        let opacity = one_minus_exp::<L>(depth);
        let light = array!(|c| opacity * L::F::splat(one_color[c]));
        (light, depth)
    }

    /// At `N` places of each segment. `colors`: glow is asked for.
    #[inline(always)]
    pub fn at<const N: usize>(&mut self, t: [f32; N], colors: bool) -> Samples<L, N> {
        let zero = L::F::splat(0.0);
        let mut sum = Samples { rate: [zero; N], glow: [[zero; 3]; N] };
        for number in 0..self.active.len() {
            if self.active[number].widget.traits().has_colors {
                self.add_colored(number, &t, colors, &mut sum);
            } else {
                let values = self.active[number].widget.values(self.segments, self.fields, &t);
                self.add(number, &t, &values, colors, &mut sum);
            }
        }
        sum
    }

    /// At the places of one step after the other, each step such a `share` of the segment; `places`: shares of a step.
    #[inline(always)]
    pub fn in_step(
        &mut self,
        step: usize,
        share: f32,
        places: [f32; SIDE_BY_SIDE],
        t: [f32; SIDE_BY_SIDE],
        colors: bool,
    ) -> Samples<L, SIDE_BY_SIDE> {
        let zero = L::F::splat(0.0);
        let mut sum = Samples { rate: [zero; SIDE_BY_SIDE], glow: [[zero; 3]; SIDE_BY_SIDE] };
        for number in 0..self.active.len() {
            let ActiveWidget { widget, follows, .. } = &self.active[number];
            if widget.traits().has_colors {
                self.add_colored(number, &t, colors, &mut sum);
            } else if !follows {
                let values = widget.values(self.segments, self.fields, &t);
                self.add(number, &t, &values, colors, &mut sum);
            } else {
                let steps = &mut self.slots[number].steps;
                *steps = if step.is_multiple_of(STEPS_ON_END) {
                    widget.steps(self.segments, step, share, places, 1.0).unwrap_or(*steps)
                } else {
                    steps.next()
                };
                let values = steps.values;
                self.add(number, &t, &values, colors, &mut sum);
            }
        }
        sum
    }

    /// Adds a widget of one colour with these values.
    #[inline(always)]
    fn add<const N: usize>(
        &mut self,
        number: usize,
        t: &[f32; N],
        values: &[L::F; N],
        colors: bool,
        sum: &mut Samples<L, N>,
    ) {
        let color = self.active[number].widget.color;
        for j in 0..N {
            let strength = self.add_rate(number, t[j], values[j], &mut sum.rate[j]);
            if colors {
                for (glow, color) in sum.glow[j].iter_mut().zip(color) {
                    *glow = strength.mul_add(L::F::splat(color), *glow);
                }
            }
        }
    }

    /// Adds a widget that has colours of its own.
    #[inline(always)]
    fn add_colored<const N: usize>(
        &mut self,
        number: usize,
        t: &[f32; N],
        colors: bool,
        sum: &mut Samples<L, N>,
    ) {
        for (j, &t) in t.iter().enumerate() {
            let [value, color @ ..] = self.active[number].widget.colored_value(self.segments, t);
            let strength = self.add_rate(number, t, value, &mut sum.rate[j]);
            if colors {
                for (glow, color) in sum.glow[j].iter_mut().zip(color) {
                    *glow = strength.mul_add(color, *glow);
                }
            }
        }
    }

    /// Adds what a widget absorbs at one place; what it glows there.
    #[inline(always)]
    fn add_rate(&mut self, number: usize, t: f32, value: L::F, rate: &mut L::F) -> L::F {
        let splat = L::F::splat;
        let (active, slot) = (&self.active[number], &mut self.slots[number]);
        let mut inside = active.there;
        if active.is_cut {
            let [start, end] = slot.range;
            inside = inside.and(start.le(splat(t))).and(splat(t).le(end));
        }
        let value = L::F::select(inside, value, splat(0.0));
        let own = value * splat(active.widget.density());
        *rate = *rate + own;
        slot.sum = slot.sum + own;
        match self.glow {
            None => own,
            Some(glow) => L::F::select(splat(active.threshold).lt(value), splat(glow), splat(0.0)),
        }
    }
}
