//! A Gaussian over further fields in lanes.

use crate::attribute::Attribute;
use crate::shade::along::{Along, FIELDS_MOST, Fields};
use crate::shade::gaussian::WIDTHS_MOST;
use crate::shade::region::{LaneRegion, range_of};
use voltet_lanes::optics::gaussian::mean_profile;
use voltet_lanes::{Float, Lanes, array, inlined};

/// exp(−|K (v − centre)|²) over further fields, K and the centre scaled as the fields are; unused rows are 0.
pub(crate) struct LaneGaussianNd {
    count: usize,
    slots: [usize; FIELDS_MOST],
    centre: [f32; FIELDS_MOST],
    matrix: [[f32; FIELDS_MOST]; FIELDS_MOST],
    /// Widths along each field's whole range, summed: whether a segment may span more than 32 bits resolve.
    narrow: bool,
    pub density: f32,
    pub color: [f32; 3],
    pub region: Option<LaneRegion>,
}

impl LaneGaussianNd {
    /// `slots`: the fields' places among the further fields. `None` where there are too many.
    pub fn new(
        slots: &[usize],
        centre: &[f64],
        matrix: &[Vec<f64>],
        attributes: &[Attribute<'_>],
        density: f32,
        color: [f32; 3],
        region: Option<LaneRegion>,
    ) -> Option<LaneGaussianNd> {
        if slots.iter().any(|&slot| slot >= FIELDS_MOST) || slots.len() > FIELDS_MOST {
            return None;
        }
        let axes: Vec<&Attribute<'_>> =
            slots.iter().map(|slot| attributes.get(2 + slot)).collect::<Option<_>>()?;
        let mut nd = LaneGaussianNd {
            count: slots.len(),
            slots: [0; FIELDS_MOST],
            centre: [0.0; FIELDS_MOST],
            matrix: [[0.0; FIELDS_MOST]; FIELDS_MOST],
            narrow: false,
            density,
            color,
            region,
        };
        let mut widths = 0.0;
        for (j, axis) in axes.iter().enumerate() {
            nd.slots[j] = slots[j];
            nd.centre[j] = ((centre[j] - axis.offset) / axis.scale) as f32;
            for (scaled, row) in nd.matrix.iter_mut().zip(matrix) {
                scaled[j] = (row[j] * axis.scale) as f32;
                widths += (row[j] * axis.span).abs();
            }
        }
        nd.narrow = widths > f64::from(WIDTHS_MOST);
        let held = nd.centre.iter().chain(nd.matrix.iter().flatten()).all(|x| x.is_finite());
        held.then_some(nd)
    }

    /// q = K (v − centre).
    #[inline(always)]
    fn point<L: Lanes>(&self, fields: &[L::F; FIELDS_MOST]) -> [L::F; FIELDS_MOST] {
        let splat = L::F::splat;
        let mut q = [splat(0.0); FIELDS_MOST];
        for j in 0..self.count {
            let d = fields[self.slots[j]] - splat(self.centre[j]);
            for (q, row) in q.iter_mut().zip(&self.matrix) {
                *q = splat(row[j]).mul_add(d, *q);
            }
        }
        q
    }

    #[inline(always)]
    pub fn ends<L: Lanes>(&self, fields: &Fields<L>) -> ([L::F; FIELDS_MOST], [L::F; FIELDS_MOST]) {
        (self.point::<L>(&fields.front), self.point::<L>(&fields.back))
    }

    #[inline(always)]
    pub fn depth<L: Lanes>(&self, along: &Along<L>, fields: &Fields<L>) -> (L::F, u32) {
        let splat = L::F::splat;
        let (front, back) = self.ends::<L>(fields);
        let range = range_of::<L>(self.region.as_ref(), along);
        let at = inlined(
            #[inline(always)]
            |t: L::F| -> [L::F; FIELDS_MOST] {
                array(
                    #[inline(always)]
                    |i| (back[i] - front[i]).mul_add(t, front[i]),
                )
            },
        );
        let (from, to) = if self.region.is_some() { (at(range[0]), at(range[1])) } else { (front, back) };
        let share = (range[1] - range[0]).max(splat(0.0));
        let unsure = if self.narrow { u32::MAX } else { 0 };
        let peak = splat(self.density) * along.length * share;
        (mean_profile::<L, FIELDS_MOST>(from, to) * peak, unsure)
    }
}
