//! A triangular Gaussian in lanes.

use crate::attribute::Attribute;
use crate::shade::segment_lanes::SegmentLanes;
use voltet_simd::limits::MAX_TRIANGULAR_WIDTHS;
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::optics::triangular_gaussian;
use voltet_simd::{Float, Lanes, Mask};

/// exp(−((s − centre)/(σ g))²); lengths along s are scaled as s is.
pub(crate) struct LaneTriangular {
    centre: f32,
    /// σ g = slope × stored g + base.
    slope: f32,
    base: f32,
}

impl LaneTriangular {
    /// `None` where g is not at hand or the numbers leave 32 bits.
    pub fn new(centre: f64, sigma: f64, attributes: &[Attribute<'_>]) -> Option<LaneTriangular> {
        let [s, g, ..] = attributes else { return None };
        let triangular = LaneTriangular {
            centre: ((centre - s.offset) / s.scale) as f32,
            slope: (sigma * g.scale / s.scale) as f32,
            base: (sigma * g.offset / s.scale) as f32,
        };
        let held =
            triangular.centre.is_finite() && triangular.slope.is_finite() && triangular.base.is_finite();
        held.then_some(triangular)
    }

    /// δ and γ at a point.
    #[inline(always)]
    fn point<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        [v[0] - splat(self.centre), splat(self.slope).mul_add(v[1], splat(self.base))]
    }

    /// The profile at a point.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, at: &[L::F; 2]) -> L::F {
        let [offset, width] = self.point::<L>(at);
        triangular_gaussian::profile::<L>(offset, width)
    }

    /// Mean of the profile between two points, and the lanes (bits) on which they are too far apart.
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, front: &[L::F; 2], back: &[L::F; 2]) -> (L::F, u32) {
        let (front, back) = (self.point::<L>(front), self.point::<L>(back));
        let widths = L::F::splat(MAX_TRIANGULAR_WIDTHS as f32) * front[1].abs().max(back[1].abs());
        let unsure = widths.lt((back[0] - front[0]).abs()).bits();
        (triangular_gaussian::mean_profile::<L>([front[0], back[0]], [front[1], back[1]]), unsure)
    }

    /// The path between two points of a segment, in the mean of its widths; lanes that have one.
    #[inline(always)]
    pub fn path<L: Lanes>(
        &self,
        segments: &SegmentLanes<L>,
        front: &[L::F; 2],
        back: &[L::F; 2],
    ) -> (LaneGaussianPath<L>, L::M) {
        let splat = L::F::splat;
        let width = (self.point::<L>(&segments.front)[1] + self.point::<L>(&segments.back)[1]) * splat(0.5);
        let there = splat(0.0).lt(width);
        let inverse = splat(1.0) / L::F::select(there, width, splat(1.0));
        let [front, back] = [self.point::<L>(front)[0] * inverse, self.point::<L>(back)[0] * inverse];
        (LaneGaussianPath::<L>::new([front], [back]), there)
    }
}
