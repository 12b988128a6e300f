//! Widgets as members of an ordered integral ([`super::panels`]).

use crate::shade::along::{Along, Fields};
use crate::shade::region::range_of;
use crate::shade::widget::LaneWidget;
use voltet_lanes::optics::gaussian::{LaneGaussianPath, LaneGaussianTrack};
use voltet_lanes::optics::overlap::{AnyLaneTrack, LaneMember};
use voltet_lanes::optics::piecewise_linear::LanePiecewiseTrack;
use voltet_lanes::{Float, Lanes, inlined};

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
