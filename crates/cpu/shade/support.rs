//! Support bounds of a widget, in lanes: it is not evaluated on a vector of segments that all lie outside.
//!
//! They are the widget's slabs ([`Slab`]) in stored values, those of an axis as a box. A ray gains or loses less than [`crate::NEGLIGIBLE_DEPTH`] of the
//! widgets' greatest depths, or of 1 where they are denser, by all that is left out here.

use crate::shade::context::WidgetContext;
use crate::shade::segment_lanes::SegmentLanes;
use voltet_core::transfer::{Slab, Widget};
use voltet_simd::{Float, Lanes, Mask};

/// Support bounds of a widget.
pub(crate) struct SupportBounds {
    /// Limits of stored s and g, each [low, high].
    limits: [[f32; 2]; 2],
    /// Slabs across both axes: low ≤ a s + b g ≤ high.
    tilted: Vec<[f32; 4]>,
}

impl SupportBounds {
    /// Bounds of a widget; `None` where the support has none. `min`: the optical depth along the longest ray that counts.
    pub fn new(widget: &Widget, context: &WidgetContext, min: f64) -> Option<SupportBounds> {
        // What is thin is held against itself: its picture may be seen magnified.
        let depth = (widget.peak() * context.density_scale).max(1.0) * widget.max_emission().max(1.0);
        let lists = widget.slabs(depth, min, context.model);
        let axis = |k: usize| context.attributes.get(k).map_or([0.0, 1.0], |a| [a.offset, a.scale]);
        let axes = [axis(0), axis(1)];
        let stored = |list: &Vec<Slab>| list.iter().map(|slab| slab.stored(axes)).collect::<Vec<_>>();
        let lists: Vec<Vec<[f32; 4]>> = lists.iter().map(stored).collect();
        // One box round all parts.
        let mut limits = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
        for list in &lists {
            for (k, [min, max]) in limits.iter_mut().enumerate() {
                let [low, high] = box_of(list, k);
                (*min, *max) = (min.min(low), max.max(high));
            }
        }
        let is_tilted = |slab: &&[f32; 4]| slab[0] != 0.0 && slab[1] != 0.0;
        let tilted = match lists.as_slice() {
            [list] => list.iter().filter(is_tilted).copied().collect(),
            _ => Vec::new(),
        };
        let everywhere = limits.iter().all(|limits| *limits == [f32::NEG_INFINITY, f32::INFINITY]);
        (!everywhere || !tilted.is_empty()).then_some(SupportBounds { limits, tilted })
    }

    /// Lanes whose segments may meet the support.
    #[inline(always)]
    pub fn meets<L: Lanes>(&self, spread: &ValueRange<L>) -> L::M {
        let splat = L::F::splat;
        let within = |axis: usize| {
            let [low, high] = self.limits[axis];
            splat(low).le(spread.high[axis]).and(spread.low[axis].le(splat(high)))
        };
        let mut meets = spread.segments.crossing.and(within(0)).and(within(1));
        for &[a, b, low, high] in &self.tilted {
            let [front, back] = [&spread.segments.front, &spread.segments.back]
                .map(|v| splat(a).mul_add(v[0], splat(b) * v[1]));
            meets = meets.and(splat(low).le(front.max(back))).and(front.min(back).le(splat(high)));
        }
        meets
    }
}

/// Limits along an axis of the intersection of slabs.
fn box_of(list: &[[f32; 4]], axis: usize) -> [f32; 2] {
    let whole = [f32::NEG_INFINITY, f32::INFINITY];
    list.iter().filter(|slab| slab[axis] != 0.0 && slab[1 - axis] == 0.0).fold(whole, |[min, max], slab| {
        // The normal is 1 or −1.
        let [low, high] = if slab[axis] < 0.0 { [-slab[3], -slab[2]] } else { [slab[2], slab[3]] };
        [min.max(low), max.min(high)]
    })
}

/// Value range of a vector of segments.
pub struct ValueRange<'a, L: Lanes> {
    pub(crate) segments: &'a SegmentLanes<L>,
    low: [L::F; 2],
    high: [L::F; 2],
}

impl<'a, L: Lanes> ValueRange<'a, L> {
    #[inline(always)]
    pub(crate) fn new(segments: &'a SegmentLanes<L>) -> Self {
        let (front, back) = (segments.front, segments.back);
        ValueRange {
            segments,
            low: [front[0].min(back[0]), front[1].min(back[1])],
            high: [front[0].max(back[0]), front[1].max(back[1])],
        }
    }
}
