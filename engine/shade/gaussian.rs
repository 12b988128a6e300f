//! A Gaussian over s and g in lanes.

use crate::attribute::Attribute;
use crate::shade::along::Along;
use crate::shade::region::{Inside, LaneRegion};
use voltet_lanes::optics::elementary::exp;
use voltet_lanes::optics::gaussian;
use voltet_lanes::optics::smooth::Shape;
use voltet_lanes::{Float, Lanes, Mask, array};

/// Beyond so many widths the rounding of a segment's ends reaches the square of its distance from the centre:
/// 4e-3 of the depth at 1e6 widths.
pub(crate) const WIDTHS_MOST: f32 = 1e5;

/// exp(−|K (v − centre)|²), K and the centre scaled as the attributes are.
pub(crate) struct LaneGaussian {
    matrix: [[f32; 2]; 2],
    centre: [f32; 2],
    /// Whether a segment can span more than [`WIDTHS_MOST`] widths.
    narrow: bool,
    pub density: f32,
    pub color: [f32; 3],
    pub region: Option<LaneRegion>,
}

impl LaneGaussian {
    pub fn new(
        centre: &[f64; 2],
        matrix: &[[f64; 2]; 2],
        attributes: &[Attribute<'_>],
        density: f32,
        color: [f32; 3],
        region: Option<LaneRegion>,
    ) -> LaneGaussian {
        let axis = |a: usize| attributes.get(a).map_or([0.0, 1.0], |x| [x.offset, x.scale]);
        let scale = [axis(0)[1], axis(1)[1]];
        let steepest = matrix.iter().flat_map(|row| [row[0] * scale[0], row[1] * scale[1]]);
        LaneGaussian {
            narrow: steepest.map(f64::abs).sum::<f64>() > f64::from(WIDTHS_MOST),
            matrix: matrix.map(|row| [(row[0] * scale[0]) as f32, (row[1] * scale[1]) as f32]),
            centre: std::array::from_fn(|a| ((centre[a] - axis(a)[0]) / axis(a)[1]) as f32),
            density,
            color,
            region,
        }
    }

    #[inline(always)]
    pub fn point<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        let d = [v[0] - splat(self.centre[0]), v[1] - splat(self.centre[1])];
        array(
            #[inline(always)]
            |i| splat(self.matrix[i][0]).mul_add(d[0], splat(self.matrix[i][1]) * d[1]),
        )
    }

    /// Depth and shape; it jumps where a part of the segment is inside the region.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, along: &Along<L>) -> Shape<L> {
        let Inside { front, back, share, cut } = along.inside(self.region.as_ref());
        let peak = L::F::splat(self.density) * along.length * share;
        gaussian::shape::<L, 2>(self.point::<L>(&front), self.point::<L>(&back), peak).cut(cut)
    }

    /// Lanes (bits) on which the segment spans too many widths.
    #[inline(always)]
    pub fn unsure<L: Lanes>(&self, along: &Along<L>) -> u32 {
        if !self.narrow {
            return 0;
        }
        let (front, back) = (self.point::<L>(&along.front), self.point::<L>(&along.back));
        let step = [back[0] - front[0], back[1] - front[1]];
        let extent = step[0].mul_add(step[0], step[1] * step[1]).sqrt();
        L::F::splat(WIDTHS_MOST).lt(extent).bits()
    }

    #[inline(always)]
    pub fn density_at<L: Lanes>(&self, along: &Along<L>, t: L::F) -> L::F {
        let q = self.point::<L>(&along.at(t));
        let profile = exp::<L>(-(q[0].mul_add(q[0], q[1] * q[1])));
        L::F::splat(self.density) * profile
    }
}
