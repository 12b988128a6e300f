//! A Gaussian over further fields in lanes.

use crate::shade::context::WidgetContext;
use crate::shade::segment_lanes::{FieldLanes, MAX_FIELD_LANES};
use voltet_simd::limits::MAX_GAUSSIAN_WIDTHS;
use voltet_simd::optics::elementary::{dot, exp};
use voltet_simd::optics::gaussian::{LaneGaussianPath, mean_profile};
use voltet_simd::{Float, Lanes, array, inlined};

/// q = K (v − centre) over further fields, K and the centre scaled as the fields are; unused rows are 0.
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

/// exp(−|K (v − centre)|²).
pub(crate) struct LaneGaussianNd {
    fields: LaneFields,
}

impl LaneGaussianNd {
    /// See [`LaneFields::new`].
    pub fn new(
        names: &[String],
        centre: &[f64],
        matrix: &[Vec<f64>],
        context: &WidgetContext,
    ) -> Option<LaneGaussianNd> {
        LaneFields::new(names, centre, matrix, context).map(|fields| LaneGaussianNd { fields })
    }

    /// Mean of the profile over the segment, or over a stretch of it.
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, fields: &FieldLanes<L>, range: Option<[L::F; 2]>) -> L::F {
        let [front, back] = between::<L, MAX_FIELD_LANES>(self.fields.ends::<L>(fields), range);
        mean_profile::<L, MAX_FIELD_LANES>(front, back)
    }

    /// The profile at a place of the segment.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, fields: &FieldLanes<L>, t: f32) -> L::F {
        let q = self.fields.point::<L>(&fields.at(t));
        exp::<L>(-dot::<L, MAX_FIELD_LANES>(&q, &q))
    }

    /// The path of the whole segment, or of a stretch of it.
    #[inline(always)]
    pub fn path<L: Lanes>(&self, fields: &FieldLanes<L>, range: Option<[L::F; 2]>) -> LaneGaussianPath<L> {
        let [front, back] = between::<L, MAX_FIELD_LANES>(self.fields.ends::<L>(fields), range);
        LaneGaussianPath::<L>::new(front, back)
    }

    /// All lanes (bits), where a segment may span more widths than 32 bits resolve.
    pub fn unsure(&self) -> u32 {
        if self.fields.widths > MAX_GAUSSIAN_WIDTHS { u32::MAX } else { 0 }
    }
}
