//! Widgets on the slow road: optical depths of the profiles that the quick forms lack, and widgets as members of an
//! ordered integral.

use crate::project::Attribute;
use crate::shade::panels::{FIELDS_MOST, Fields};
use crate::shade::region::LaneRegion;
use crate::shade::widget::{Along, Inside, LaneWidget};
use voltet_lanes::optics::gaussian::{LaneGaussianPath, LaneGaussianTrack, mean_profile};
use voltet_lanes::optics::overlap::{AnyLaneTrack, LaneMember};
use voltet_lanes::optics::piecewise_linear::LanePiecewiseTrack;
use voltet_lanes::optics::triangular_gaussian;
use voltet_lanes::{Float, Lanes, Mask, array, inlined};

/// Widths of a triangular Gaussian, at its wider end, that a segment may span in lanes.
const TRIANGULAR_WIDTHS_MOST: f32 = 50.0;

/// exp(−((s − centre)/(σ g))²); lengths along s are scaled as s is.
pub(crate) struct LaneTriangular {
    centre: f32,
    /// σ g = slope × stored g + base.
    slope: f32,
    base: f32,
    density: f32,
    pub color: [f32; 3],
    region: Option<LaneRegion>,
}

impl LaneTriangular {
    /// `None` where g is not at hand or the numbers leave 32 bits.
    pub fn new(
        centre: f64,
        sigma: f64,
        attributes: &[Attribute<'_>],
        density: f32,
        color: [f32; 3],
        region: Option<LaneRegion>,
    ) -> Option<LaneTriangular> {
        let [s, g, ..] = attributes else { return None };
        let triangular = LaneTriangular {
            centre: ((centre - s.offset) / s.scale) as f32,
            slope: (sigma * g.scale / s.scale) as f32,
            base: (sigma * g.offset / s.scale) as f32,
            density,
            color,
            region,
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

    #[inline(always)]
    fn depth<L: Lanes>(&self, along: &Along<L>) -> (L::F, u32) {
        let Inside { front, back, share, .. } = along.inside(self.region.as_ref());
        let (front, back) = (self.point::<L>(&front), self.point::<L>(&back));
        let widths = L::F::splat(TRIANGULAR_WIDTHS_MOST) * front[1].abs().max(back[1].abs());
        let unsure = widths.lt((back[0] - front[0]).abs()).bits();
        let mean = triangular_gaussian::mean_profile::<L>([front[0], back[0]], [front[1], back[1]]);
        (mean * (L::F::splat(self.density) * along.length * share), unsure)
    }
}

/// exp(−|K (v − centre)|²) over further fields, K and the centre scaled as the fields are; unused rows are 0.
pub(crate) struct LaneGaussianNd {
    count: usize,
    slots: [usize; FIELDS_MOST],
    centre: [f32; FIELDS_MOST],
    matrix: [[f32; FIELDS_MOST]; FIELDS_MOST],
    /// Widths along each field's whole range, summed: whether a segment may span more than 32 bits resolve.
    narrow: bool,
    density: f32,
    pub color: [f32; 3],
    region: Option<LaneRegion>,
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
                widths += (row[j] * axis.scale).abs();
            }
        }
        nd.narrow = widths > f64::from(crate::shade::widget::WIDTHS_MOST);
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
    fn ends<L: Lanes>(&self, fields: &Fields<L>) -> ([L::F; FIELDS_MOST], [L::F; FIELDS_MOST]) {
        (self.point::<L>(&fields.front), self.point::<L>(&fields.back))
    }

    #[inline(always)]
    fn depth<L: Lanes>(&self, along: &Along<L>, fields: &Fields<L>) -> (L::F, u32) {
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

/// The stretch inside a region.
#[inline(always)]
fn range_of<L: Lanes>(region: Option<&LaneRegion>, along: &Along<L>) -> [L::F; 2] {
    match region {
        None => [L::F::splat(0.0), L::F::splat(1.0)],
        Some(region) => {
            let (t0, t1) = region.clip(along);
            [t0, t1]
        }
    }
}

/// A member that is nowhere.
#[inline(always)]
pub(crate) fn nothing<'a, L: Lanes>() -> LaneMember<'a, L> {
    let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
    LaneMember {
        track: AnyLaneTrack::Uniform(zero),
        range: [one, zero],
        window: [zero, one],
        color: [0.0; 3],
        threshold: 0.0,
        unit_rate: zero,
    }
}

impl LaneWidget {
    /// Optical depth of any widget with lanes, and the lanes (bits) that only the 64-bit path can serve.
    #[inline(always)]
    pub fn any_depth<L: Lanes>(&self, along: &Along<L>, fields: &Fields<L>) -> (L::F, u32) {
        match self {
            LaneWidget::Triangular(triangular) => triangular.depth::<L>(along),
            LaneWidget::GaussianNd(nd) => nd.depth::<L>(along, fields),
            quick => quick.depth::<L>(along),
        }
    }

    /// Largest density, optical depth per scene length; `scale`: 1/U per scene length.
    pub fn peak(&self, scale: f32) -> f32 {
        match self {
            LaneWidget::Uniform { density, .. } | LaneWidget::Wave { density, .. } => *density,
            LaneWidget::Gaussian(gaussian) => gaussian.density,
            LaneWidget::Triangular(triangular) => triangular.density,
            LaneWidget::GaussianNd(nd) => nd.density,
            LaneWidget::Linear(linear) => linear.peak * scale,
            LaneWidget::Exact => 0.0,
        }
    }

    /// As a member of an ordered integral; `scale`: D/U.
    #[inline(always)]
    pub fn member<'a, L: Lanes>(
        &'a self,
        along: &Along<L>,
        fields: &Fields<L>,
        scale: L::F,
        cutoff: Option<f64>,
    ) -> LaneMember<'a, L> {
        let splat = L::F::splat;
        let mut member = nothing::<L>();
        member.color = self.color();
        member.threshold = cutoff.unwrap_or(0.0) as f32;
        member.window = [splat(-1.0), splat(2.0)];
        let level = cutoff.map(|cutoff| -cutoff.ln() as f32);
        let rate = inlined(
            #[inline(always)]
            |density: f32| splat(density) * along.length,
        );
        let gaussian = inlined(
            #[inline(always)]
            |member: &mut LaneMember<'a, L>, path: &LaneGaussianPath<L>, rate: L::F| {
                if let Some(level) = level {
                    member.window = path.window_ends(level);
                }
                // Within its window it glows, whatever the rounding of the rate.
                member.threshold = 0.0;
                member.unit_rate = rate;
                member.track = AnyLaneTrack::Gaussian(LaneGaussianTrack::new(path, rate));
            },
        );
        let region = match self {
            LaneWidget::Uniform { density, region, .. } => {
                member.unit_rate = rate(*density);
                member.track = AnyLaneTrack::Uniform(member.unit_rate);
                Some(region)
            }
            LaneWidget::Gaussian(widget) => {
                let (front, back) = (widget.point::<L>(&along.front), widget.point::<L>(&along.back));
                gaussian(&mut member, &LaneGaussianPath::<L>::new(front, back), rate(widget.density));
                widget.region.as_ref()
            }
            LaneWidget::GaussianNd(nd) => {
                let (front, back) = nd.ends::<L>(fields);
                gaussian(&mut member, &LaneGaussianPath::<L>::new(front, back), rate(nd.density));
                nd.region.as_ref()
            }
            LaneWidget::Linear(linear) => {
                let first = splat(linear.first);
                member.threshold *= linear.peak;
                member.unit_rate = scale;
                member.track = AnyLaneTrack::Piecewise(LanePiecewiseTrack {
                    points: &linear.points_from_first,
                    front: along.front[0] - first,
                    back: along.back[0] - first,
                    scale,
                });
                None
            }
            // See `PanelWalk::integrate`: those are not walked.
            LaneWidget::Wave { .. } | LaneWidget::Triangular(_) | LaneWidget::Exact => return nothing::<L>(),
        };
        member.range = range_of::<L>(region, along);
        member
    }
}
