//! Regions in lanes: the interval of a segment inside a convex polygon of the (s, g) plane.

use crate::attribute::Attribute;
use crate::shade::segment_lanes::SegmentLanes;
use crate::tolerances::REGION_MARGIN;
use voltet_core::transfer::HalfPlane;
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

    /// The interval [t₀, t₁] inside; t₁ ≤ t₀ where there is none. A segment along an edge is inside.
    #[inline(always)]
    pub fn clip<L: Lanes>(&self, segments: &SegmentLanes<L>) -> [L::F; 2] {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let (mut t0, mut t1) = (zero, splat(1.0));
        for &[s, g, limit] in &self.half_planes {
            let margin = inlined!(|v: &[L::F; 2]| splat(limit) - splat(s).mul_add(v[0], splat(g) * v[1]));
            let (front, back) = (margin(&segments.front), margin(&segments.back));
            let (front_out, back_out) = (front.lt(zero), back.lt(zero));
            if !front_out.or(back_out).any() {
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
