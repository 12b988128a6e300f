//! Gaussians in lanes: over s and g, and over further fields.

use crate::attribute::Attribute;
use crate::shade::context::WidgetContext;
use crate::shade::segment_lanes::{FieldLanes, MAX_FIELD_LANES, SegmentLanes};
use voltet_simd::limits::MAX_GAUSSIAN_WIDTHS;
use voltet_simd::optics::elementary::{dot, exp};
use voltet_simd::optics::gaussian::{self, LaneGaussianPath, LaneGaussianSteps, Near, mean_profile};
use voltet_simd::optics::smooth::DensityShape;
use voltet_simd::{Float, Lanes, Mask, array, inlined};

/// exp(−|K (v − centre)|²), K and the centre scaled as the attributes are.
pub(crate) struct LaneGaussian {
    matrix: [[f32; 2]; 2],
    centre: [f32; 2],
    /// −K centre where K is diagonal.
    at_zero: Option<[f32; 2]>,
    /// True if a segment can span more than [`MAX_GAUSSIAN_WIDTHS`] widths.
    narrow: bool,
}

impl LaneGaussian {
    /// `None` where the numbers leave 32 bits.
    pub fn new(
        centre: &[f64; 2],
        matrix: &[[f64; 2]; 2],
        attributes: &[Attribute<'_>],
    ) -> Option<LaneGaussian> {
        // What is not looked at is 0 everywhere.
        let axis = |a: usize| attributes.get(a).map_or([0.0, 1.0, 0.0], |x| [x.offset, x.scale, x.span()]);
        let axes = [axis(0), axis(1)];
        let widths = matrix.iter().flat_map(|row| [row[0] * axes[0][2], row[1] * axes[1][2]]);
        let scaled: [f64; 2] = std::array::from_fn(|a| (centre[a] - axes[a][0]) / axes[a][1]);
        let is_diagonal = matrix[0][1] == 0.0 && matrix[1][0] == 0.0;
        let gaussian = LaneGaussian {
            narrow: widths.map(f64::abs).sum::<f64>() > MAX_GAUSSIAN_WIDTHS,
            matrix: matrix.map(|row| [(row[0] * axes[0][1]) as f32, (row[1] * axes[1][1]) as f32]),
            centre: scaled.map(|x| x as f32),
            at_zero: is_diagonal
                .then(|| std::array::from_fn(|a| (-matrix[a][a] * axes[a][1] * scaled[a]) as f32)),
        };
        let numbers = gaussian.centre.iter().chain(gaussian.matrix.as_flattened());
        let held = numbers.chain(gaussian.at_zero.iter().flatten()).all(|x| x.is_finite());
        held.then_some(gaussian)
    }

    #[inline(always)]
    fn point<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        if let Some(at_zero) = self.at_zero {
            return array!(|i| splat(self.matrix[i][i]).mul_add(v[i], splat(at_zero[i])));
        }
        let d = [v[0] - splat(self.centre[0]), v[1] - splat(self.centre[1])];
        array!(|i| splat(self.matrix[i][0]).mul_add(d[0], splat(self.matrix[i][1]) * d[1]))
    }

    /// Depth and shape between two points, for a rate of `peak` at the centre, on the lanes that are `wanted`.
    #[inline(always)]
    pub fn shape<L: Lanes>(
        &self,
        front: &[L::F; 2],
        back: &[L::F; 2],
        peak: L::F,
        wanted: L::M,
    ) -> DensityShape<L> {
        gaussian::shape::<L, 2>(self.point::<L>(front), self.point::<L>(back), peak, wanted)
    }

    /// Input of the mean between two points.
    #[inline(always)]
    pub fn near<L: Lanes>(&self, front: &[L::F; 2], back: &[L::F; 2]) -> Near<L> {
        Near::new(&self.point::<L>(front), &self.point::<L>(back))
    }

    /// The profile at a point.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, at: &[L::F; 2]) -> L::F {
        let q = self.point::<L>(at);
        exp::<L>(-dot::<L, 2>(&q, &q))
    }

    /// The square of the widths that the whole segment spans.
    #[inline(always)]
    pub fn extent_squared<L: Lanes>(&self, segments: &SegmentLanes<L>) -> L::F {
        let (front, back) = (self.point::<L>(&segments.front), self.point::<L>(&segments.back));
        let step = [back[0] - front[0], back[1] - front[1]];
        dot::<L, 2>(&step, &step)
    }

    /// The roughness of the whole segment's shape.
    #[inline(always)]
    pub fn roughness<L: Lanes>(&self, segments: &SegmentLanes<L>) -> L::F {
        gaussian::roughness::<L, 2>(self.point::<L>(&segments.front), self.point::<L>(&segments.back))
    }

    /// The path between two points.
    #[inline(always)]
    pub fn path<L: Lanes>(&self, front: &[L::F; 2], back: &[L::F; 2]) -> LaneGaussianPath<L> {
        LaneGaussianPath::<L>::new(self.point::<L>(front), self.point::<L>(back))
    }

    /// Lanes (bits) on which the segment spans too many widths.
    #[inline(always)]
    pub fn unsure<L: Lanes>(&self, segments: &SegmentLanes<L>) -> u32 {
        if !self.narrow {
            return 0;
        }
        let extent = self.extent_squared::<L>(segments).sqrt();
        L::F::splat(MAX_GAUSSIAN_WIDTHS as f32).lt(extent).bits()
    }

    /// In equal steps, each a `share` of the segment, from t = `first` × `share` on; `peak`: the value at the centre.
    #[inline(always)]
    pub fn steps<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        first: usize,
        share: f32,
        places: [f32; N],
        peak: L::F,
    ) -> LaneGaussianSteps<L, N> {
        let splat = L::F::splat;
        let (front, back) = (self.point::<L>(&segments.front), self.point::<L>(&segments.back));
        let step: [L::F; 2] = array!(|i| (back[i] - front[i]) * splat(share));
        let start = array!(|i| step[i].mul_add(splat(first as f32), front[i]));
        LaneGaussianSteps::new(start, step, places, peak)
    }
}

/// exp(−|q|²), q = K (v − centre) over further fields, K and the centre scaled as the fields are; unused rows are 0.
pub(super) struct LaneFields {
    count: usize,
    slots: [usize; MAX_FIELD_LANES],
    centre: [f32; MAX_FIELD_LANES],
    matrix: [[f32; MAX_FIELD_LANES]; MAX_FIELD_LANES],
    /// Widths along each field's whole range, summed.
    widths: f64,
}

impl LaneFields {
    /// `None` where a field is not at hand, where there are too many, and where the numbers leave 32 bits.
    pub fn new(
        names: &[String],
        centre: &[f64],
        matrix: &[Vec<f64>],
        context: &WidgetContext,
    ) -> Option<LaneFields> {
        if names.len() > MAX_FIELD_LANES {
            return None;
        }
        let mut fields = LaneFields {
            count: names.len(),
            slots: [0; MAX_FIELD_LANES],
            centre: [0.0; MAX_FIELD_LANES],
            matrix: [[0.0; MAX_FIELD_LANES]; MAX_FIELD_LANES],
            widths: 0.0,
        };
        for (j, name) in names.iter().enumerate() {
            let (slot, axis) = context.field(name).filter(|(slot, _)| *slot < MAX_FIELD_LANES)?;
            fields.slots[j] = slot;
            fields.centre[j] = ((centre[j] - axis.offset) / axis.scale) as f32;
            for (scaled, row) in fields.matrix.iter_mut().zip(matrix) {
                scaled[j] = (row[j] * axis.scale) as f32;
                fields.widths += (row[j] * axis.span()).abs();
            }
        }
        let held = fields.centre.iter().chain(fields.matrix.iter().flatten()).all(|x| x.is_finite());
        held.then_some(fields)
    }

    #[inline(always)]
    pub fn point<L: Lanes>(&self, fields: &[L::F; MAX_FIELD_LANES]) -> [L::F; MAX_FIELD_LANES] {
        let splat = L::F::splat;
        let mut q = [splat(0.0); MAX_FIELD_LANES];
        for j in 0..self.count {
            let d = fields[self.slots[j]] - splat(self.centre[j]);
            for (q, row) in q.iter_mut().zip(&self.matrix) {
                *q = splat(row[j]).mul_add(d, *q);
            }
        }
        q
    }

    /// q at the front and at the back.
    #[inline(always)]
    pub fn ends<L: Lanes>(&self, fields: &FieldLanes<L>) -> [[L::F; MAX_FIELD_LANES]; 2] {
        [self.point::<L>(&fields.front), self.point::<L>(&fields.back)]
    }

    /// Mean of the profile over the segment, or over a stretch of it.
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, fields: &FieldLanes<L>, range: Option<[L::F; 2]>) -> L::F {
        let [front, back] = between::<L, MAX_FIELD_LANES>(self.ends::<L>(fields), range);
        mean_profile::<L, MAX_FIELD_LANES>(front, back)
    }

    /// The profile at a place of the segment.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, fields: &FieldLanes<L>, t: f32) -> L::F {
        let q = self.point::<L>(&fields.at(t));
        exp::<L>(-dot::<L, MAX_FIELD_LANES>(&q, &q))
    }

    /// The path of the whole segment, or of a stretch of it.
    #[inline(always)]
    pub fn path<L: Lanes>(&self, fields: &FieldLanes<L>, range: Option<[L::F; 2]>) -> LaneGaussianPath<L> {
        let [front, back] = between::<L, MAX_FIELD_LANES>(self.ends::<L>(fields), range);
        LaneGaussianPath::<L>::new(front, back)
    }

    /// All lanes (bits), where a segment may span more widths than 32 bits resolve.
    pub fn unsure(&self) -> u32 {
        if self.widths > MAX_GAUSSIAN_WIDTHS { u32::MAX } else { 0 }
    }
}

/// Values at both ends of an interval of a segment, from those at the segment's `front` and `back`.
#[inline(always)]
pub(super) fn between<L: Lanes, const N: usize>(
    [front, back]: [[L::F; N]; 2],
    range: Option<[L::F; 2]>,
) -> [[L::F; N]; 2] {
    let Some(range) = range else { return [front, back] };
    range.map(inlined!(|t| array!(|i| (back[i] - front[i]).mul_add(t, front[i]))))
}
