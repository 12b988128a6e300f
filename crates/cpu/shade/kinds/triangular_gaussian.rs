//! Triangular Gaussians in lanes: over s and g, and over further fields.

use crate::attribute::Attribute;
use crate::shade::context::WidgetContext;
use crate::shade::kinds::gaussian::{LaneFields, between};
use crate::shade::segment_lanes::{FieldLanes, MAX_FIELD_LANES, SegmentLanes};
use voltet_simd::limits::MAX_TRIANGULAR_WIDTHS;
use voltet_simd::optics::elementary::dot;
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::optics::triangular_gaussian::{self, LaneTriangularPath};
use voltet_simd::{Float, Lanes, Mask, array, inlined};

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

/// exp(−|K (v − centre)|²/m²); m is scaled as its array is, and K with it.
pub(crate) struct LaneTriangularNd {
    fields: LaneFields,
    /// The place of m among the further fields.
    slot: usize,
    /// m = stored m + base.
    base: f32,
}

impl LaneTriangularNd {
    /// See [`LaneFields::new`].
    pub fn new(
        names: &[String],
        magnitude: &str,
        centre: &[f64],
        matrix: &[Vec<f64>],
        context: &WidgetContext,
    ) -> Option<LaneTriangularNd> {
        let (slot, axis) = context.field(magnitude).filter(|(slot, _)| *slot < MAX_FIELD_LANES)?;
        let matrix: Vec<Vec<f64>> =
            matrix.iter().map(|row| row.iter().map(|k| k / axis.scale).collect()).collect();
        let fields = LaneFields::new(names, centre, &matrix, context)?;
        let base = (axis.offset / axis.scale) as f32;
        base.is_finite().then_some(LaneTriangularNd { fields, slot, base })
    }

    /// The profile at a place of the segment.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, fields: &FieldLanes<L>, t: f32) -> L::F {
        let fields = fields.at(t);
        let q = self.fields.point::<L>(&fields);
        let width = fields[self.slot] + L::F::splat(self.base);
        triangular_gaussian::profile::<L>(dot::<L, MAX_FIELD_LANES>(&q, &q).sqrt(), width)
    }

    /// Mean of the profile over the segment or a stretch of it, and the lanes (bits) on which its ends are too far apart.
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, fields: &FieldLanes<L>, range: Option<[L::F; 2]>) -> (L::F, u32) {
        let splat = L::F::splat;
        let [front, back] = between::<L, MAX_FIELD_LANES>(self.fields.ends::<L>(fields), range);
        let width = |fields: &[L::F; MAX_FIELD_LANES]| [fields[self.slot] + splat(self.base)];
        let [near, far] = between::<L, 1>([width(&fields.front), width(&fields.back)], range);
        let mut squared = splat(0.0);
        for (f, b) in front.into_iter().zip(back) {
            squared = (b - f).mul_add(b - f, squared);
        }
        let max = splat(MAX_TRIANGULAR_WIDTHS as f32) * near[0].abs().max(far[0].abs());
        let unsure = (max * max).lt(squared).bits();
        let path = LaneTriangularPath::<L>::over_fields::<MAX_FIELD_LANES>(front, back, [near[0], far[0]]);
        (path.mean(), unsure)
    }

    /// The path of the segment or of a stretch of it, in the mean of the segment's widths; lanes that have one.
    #[inline(always)]
    pub fn path<L: Lanes>(
        &self,
        fields: &FieldLanes<L>,
        range: Option<[L::F; 2]>,
    ) -> (LaneGaussianPath<L>, L::M) {
        let splat = L::F::splat;
        let [front, back] = between::<L, MAX_FIELD_LANES>(self.fields.ends::<L>(fields), range);
        let ends = fields.front[self.slot] + fields.back[self.slot];
        let width = ends.mul_add(splat(0.5), splat(self.base));
        let there = splat(0.0).lt(width);
        let inverse = splat(1.0) / L::F::select(there, width, splat(1.0));
        let scaled =
            inlined!(|q: [L::F; MAX_FIELD_LANES]| -> [L::F; MAX_FIELD_LANES] { array!(|i| q[i] * inverse) });
        (LaneGaussianPath::<L>::new(scaled(front), scaled(back)), there)
    }
}
