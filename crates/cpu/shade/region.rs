//! Regions and support bounds in lanes: the interval of a segment inside a convex polygon of the (s, g) plane, and vectors of segments
//! that lie outside of a widget, which is not evaluated on them.

use crate::attribute::Attribute;
use crate::shade::context::WidgetContext;
use crate::shade::segment_lanes::SegmentLanes;
use crate::tolerances::REGION_MARGIN;
use voltet_core::transfer::{HalfPlane, Slab, Widget};
use voltet_simd::{Float, Lanes, Mask, inlined};

/// A convex region as half-planes: inside where n_s s + n_g g ≤ limit.
pub(crate) struct LaneRegion {
    half_planes: Vec<[f32; 3]>,
}

impl LaneRegion {
    /// `None` where all values lie inside.
    pub fn new(inside: &[HalfPlane], attributes: &[Attribute<'_>]) -> Option<LaneRegion> {
        let axis = |a: usize| attributes.get(a).map_or([0.0, 1.0], |x| [x.offset, x.scale]);
        let range = |a: usize| attributes.get(a).map_or([0.0; 2], |x| x.range);
        let ([s, g], mut half_planes) = ([axis(0), axis(1)], Vec::new());
        for HalfPlane { normal, corner } in inside {
            // Turned outwards, in scaled attributes; of about unit length, by a power of two, so that no digit is rounded
            // that the corners do not have.
            let outward = [-normal[0] * s[1], -normal[1] * g[1]];
            let unit = (-outward[0].hypot(outward[1]).log2().round()).min(1022.0).exp2();
            let outward = outward.map(|x| x * unit);
            let part = |a: usize, [offset, scale]: [f64; 2]| outward[a] * ((corner[a] - offset) / scale);
            // How far the value that lies furthest out lies inside, along each axis; 0 where the half-plane does not look.
            let inside = |a: usize, scale: f64| {
                let room = range(a).map(|v| outward[a] * ((corner[a] - v) / scale));
                if outward[a] == 0.0 { 0.0 } else { room[0].min(room[1]) }
            };
            if inside(0, s[1]) + inside(1, g[1]) > REGION_MARGIN {
                continue;
            }
            half_planes.push([outward[0] as f32, outward[1] as f32, (part(0, s) + part(1, g)) as f32]);
        }
        (!half_planes.is_empty()).then_some(LaneRegion { half_planes })
    }

    /// The interval [t₀, t₁] inside; t₁ ≤ t₀ where there is none. A segment along an edge is inside. Lanes that do not cross their cells have
    /// an interval, too, that means nothing.
    #[inline(always)]
    pub fn clip<L: Lanes>(&self, segments: &SegmentLanes<L>) -> [L::F; 2] {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let (mut t0, mut t1) = (zero, splat(1.0));
        for &[s, g, limit] in &self.half_planes {
            let margin = inlined!(|v: &[L::F; 2]| splat(limit) - splat(s).mul_add(v[0], splat(g) * v[1]));
            let (front, back) = (margin(&segments.front), margin(&segments.back));
            let (front_out, back_out) = (front.lt(zero), back.lt(zero));
            if !front_out.or(back_out).and(segments.crossing).any() {
                continue;
            }
            let crossing = front / (front - back);
            t0 = L::F::select(front_out, L::F::select(back_out, splat(2.0), crossing.max(t0)), t0);
            t1 = L::F::select(back_out.and(front_out.not()), crossing.min(t1), t1);
        }
        [t0, t1]
    }
}

impl<L: Lanes> SegmentLanes<L> {
    /// The part inside a region; all of the segment without one.
    #[inline(always)]
    pub(crate) fn inside(&self, region: Option<&LaneRegion>) -> Inside<L> {
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        match region {
            None => Inside { front: self.front, back: self.back, share: one, cut: one.lt(zero) },
            Some(region) => {
                let [t0, t1] = region.clip(self);
                let (cut, share) = (cuts::<L>(t0, t1), (t1 - t0).max(zero));
                let (mut front, mut back) = (self.front, self.back);
                if cut.any() {
                    let (first, last) = (self.at(t0), self.at(t1));
                    for a in 0..2 {
                        front[a] = L::F::select(cut, first[a], front[a]);
                        back[a] = L::F::select(cut, last[a], back[a]);
                    }
                }
                Inside { front, back, share, cut }
            }
        }
    }
}

/// The part of a segment inside a region.
pub(crate) struct Inside<L: Lanes> {
    /// (s, g) where it begins.
    pub front: [L::F; 2],
    /// (s, g) where it ends.
    pub back: [L::F; 2],
    /// Fraction of the length.
    pub share: L::F,
    /// True if it is a part only, neither all nor nothing.
    pub cut: L::M,
}

/// True if the interval [t₀, t₁] is a part of the segment, neither all nor nothing.
#[inline(always)]
fn cuts<L: Lanes>(t0: L::F, t1: L::F) -> L::M {
    let all = t0.le(L::F::splat(0.0)).and(L::F::splat(1.0).le(t1));
    t0.lt(t1).and(all.not())
}

/// The interval inside a region.
#[inline(always)]
pub(crate) fn range_of<L: Lanes>(region: Option<&LaneRegion>, segments: &SegmentLanes<L>) -> [L::F; 2] {
    match region {
        None => [L::F::splat(0.0), L::F::splat(1.0)],
        Some(region) => region.clip(segments),
    }
}

/// Support bounds of a widget: its slabs ([`Slab`]) in stored values, those of an axis as a box. A ray gains or loses less than
/// [`crate::NEGLIGIBLE_DEPTH`] of the widgets' greatest depths, or of 1 where they are denser, by all that is left out here.
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
        let within = inlined!(|axis: usize| {
            let [low, high] = self.limits[axis];
            splat(low).le(spread.high[axis]).and(spread.low[axis].le(splat(high)))
        });
        let mut meets = spread.segments.crossing.and(within(0)).and(within(1));
        for &[a, b, low, high] in &self.tilted {
            let place = inlined!(|v: &[L::F; 2]| splat(a).mul_add(v[0], splat(b) * v[1]));
            let (front, back) = (place(&spread.segments.front), place(&spread.segments.back));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragments::batch::MAX_LANES;
    use voltet_simd::{Kernel, LaneSet, dispatch};

    type Row = [f32; MAX_LANES];

    /// Front and back of the parts inside, their fractions, and which are cut (bits), of as many segments as a vector has lanes.
    struct Parts<'a> {
        region: &'a LaneRegion,
        length: Row,
        /// s and g.
        ends: [[Row; 2]; 2],
    }

    impl Kernel<(usize, [[Row; 2]; 2], Row, u32)> for Parts<'_> {
        #[inline(always)]
        fn run<L: Lanes>(self) -> (usize, [[Row; 2]; 2], Row, u32) {
            let length = L::F::load(&self.length);
            let [front, back] = self.ends.map(|end| end.map(|row| L::F::load(&row)));
            let crossing = L::F::splat(0.0).lt(length);
            let inside = SegmentLanes::<L> { length, crossing, front, back }.inside(Some(self.region));
            let row = |values: L::F| {
                let mut row = [0.0; MAX_LANES];
                values.store(&mut row);
                row
            };
            let ends = [inside.front, inside.back].map(|end| end.map(row));
            (L::WIDTH, ends, row(inside.share), inside.cut.bits())
        }
    }

    /// Front and back of the part inside, one segment at a time; `None` where there is none.
    fn part(region: &LaneRegion, ends: [[f32; 2]; 2]) -> Option<[f32; 2]> {
        let (mut t0, mut t1) = (0.0f32, 1.0f32);
        for [s, g, limit] in &region.half_planes {
            let [front, back] = ends.map(|v| limit - (s * v[0] + g * v[1]));
            match (front < 0.0, back < 0.0) {
                (false, false) => {}
                (true, true) => return None,
                (true, false) => t0 = t0.max(front / (front - back)),
                (false, true) => t1 = t1.min(front / (front - back)),
            }
        }
        (t0 < t1).then_some([t0, t1])
    }

    /// Segments in lanes by turns: each of `ends`, then one of no length, at `nowhere`.
    fn parts_are_those_of_one_at_a_time(ends: &[[[f32; 2]; 2]], nowhere: f32) {
        // s ≤ ½ and −¼ ≤ g: all numbers are exact.
        let region = LaneRegion { half_planes: vec![[1.0, 0.0, 0.5], [0.0, -1.0, 0.25]] };
        let segment = |lane: usize| lane.is_multiple_of(2).then(|| ends[lane / 2 % ends.len()]);
        let row = |end: usize, axis: usize| -> Row {
            std::array::from_fn(|lane| segment(lane).map_or(nowhere, |ends| ends[end][axis]))
        };
        let length = std::array::from_fn(|lane| if segment(lane).is_some() { 2.0 } else { 0.0 });
        let rows = [0, 1].map(|end| [0, 1].map(|axis| row(end, axis)));
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            let (width, found, share, cut) = dispatch(lanes, Parts { region: &region, length, ends: rows });
            for lane in (0..width).step_by(2) {
                let ends = segment(lane).expect("every second lane has a segment");
                let [t0, t1] = part(&region, ends).unwrap_or([0.0; 2]);
                let name = format!("{}, lane {lane}, {ends:?}", lanes.name());
                assert_eq!(share[lane], t1 - t0, "{name}");
                assert_eq!(cut >> lane & 1 == 1, 0.0 < share[lane] && share[lane] < 1.0, "{name}");
                // All of a segment that lies outside counts for nothing.
                let [t0, t1] = if share[lane] > 0.0 { [t0, t1] } else { [0.0, 1.0] };
                for axis in 0..2 {
                    let at = |t: f32| ends[0][axis] + t * (ends[1][axis] - ends[0][axis]);
                    assert_eq!(found.map(|end| end[axis][lane]), [at(t0), at(t1)], "{name}, axis {axis}");
                }
            }
            if ends.iter().all(|ends| part(&region, *ends) == Some([0.0, 1.0])) {
                // Lanes without a segment cost no cut.
                assert_eq!((cut, &share[..width]), (0, &[1.0; MAX_LANES][..width]), "{}", lanes.name());
            }
        }
    }

    #[test]
    fn regions_cut_each_segment_as_if_it_were_alone() {
        let inside = [[0.25, 0.0], [0.5, 1.0]];
        let cut_once = [[0.25, 0.0], [0.75, 0.5]];
        let cut_twice = [[0.0, -0.5], [1.0, 0.5]];
        let ends_inside = [[1.0, 0.5], [0.0, 0.5]];
        let outside = [[0.75, 0.0], [1.0, 0.0]];
        for nowhere in [0.0, 9.0, f32::NAN] {
            parts_are_those_of_one_at_a_time(&[inside], nowhere);
            parts_are_those_of_one_at_a_time(&[inside, cut_once], nowhere);
            parts_are_those_of_one_at_a_time(&[cut_twice, outside, inside, ends_inside], nowhere);
        }
    }
}
