//! A triangular Gaussian over further fields in lanes.

use crate::shade::context::WidgetContext;
use crate::shade::kinds::gaussian_nd::{LaneFields, between};
use crate::shade::segment_lanes::{FieldLanes, MAX_FIELD_LANES};
use voltet_simd::limits::MAX_TRIANGULAR_WIDTHS;
use voltet_simd::optics::elementary::dot;
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::optics::triangular_gaussian::{self, LaneTriangularPath};
use voltet_simd::{Float, Lanes, Mask, array, inlined};

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
