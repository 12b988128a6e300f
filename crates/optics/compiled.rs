//! Compiled transfer functions, for integrating many segments.

use super::clip::ClippedSpan;
use super::curved_axes::{CurvedAxes, each_segment, integrate_values};
use super::kinds::{CompiledProfile, Cutoff, Path, WidgetLight, WidgetPart};
use super::overlap::{Glow, Member, Ordered, Quadrature, ordered};
use super::special::{mean_transmittance, opacity};
use super::{Contribution, Segment, WidgetBlend};
use crate::overlap::Samples;
use voltet_core::Result;
use voltet_core::transfer::{Convex, TransferFunction};

/// A transfer function, checked, with what all its segments share worked out.
#[derive(Debug, Clone)]
pub struct CompiledTransferFunction {
    /// −ln cutoff and cutoff, for the constant-emitter.
    cutoff: Option<Cutoff>,
    unit_distance: f64,
    widgets: Vec<PreparedWidget>,
    curved_axes: Option<CurvedAxes>,
}

#[derive(Debug, Clone)]
struct PreparedWidget {
    profile: CompiledProfile,
    color: [f64; 3],
    /// Peak extinction; 1 where the form holds extinctions of its own.
    extinction: f64,
    clip: Option<Convex>,
    /// The part of the plane outside which its profile is 0.
    range: Option<Convex>,
}

/// A widget that the segment crosses.
#[derive(Debug, Clone, Copy)]
struct Active<'a> {
    widget: &'a PreparedWidget,
    path: Path<'a>,
    extent: WidgetPart,
    depth: f64,
}

impl CompiledTransferFunction {
    /// Checks the transfer function and makes it ready.
    pub fn new(transfer_function: &TransferFunction) -> Result<CompiledTransferFunction> {
        transfer_function.check()?;
        let fields = transfer_function.fields();
        let mut widgets = Vec::with_capacity(transfer_function.widgets.len());
        for widget in &transfer_function.widgets {
            let properties = widget.profile.properties();
            widgets.push(PreparedWidget {
                profile: CompiledProfile::new(&widget.profile, &fields),
                color: widget.color,
                extinction: if properties.own_peak.is_some() { 1.0 } else { widget.extinction },
                clip: widget.region.as_ref().map(Convex::new).transpose()?,
                range: properties.range.as_ref().map(Convex::new).transpose()?,
            });
        }
        let cutoff = transfer_function.model.cutoff().map(|share| Cutoff { share, level: -share.ln() });
        let curved_axes = CurvedAxes::new(transfer_function);
        let unit_distance = transfer_function.unit_distance;
        Ok(CompiledTransferFunction { cutoff, unit_distance, widgets, curved_axes })
    }

    /// The contribution of a cell's crossing, whose values, not positions, vary linearly from front to back.
    pub fn integrate_values(&self, crossing: &Segment, overlap: WidgetBlend) -> Contribution {
        integrate_values(self.curved_axes.as_ref(), crossing, |segment| self.integrate(segment, overlap))
    }

    /// T of a cell's crossing, whose values, not positions, vary linearly from front to back.
    pub fn optical_depth_of_values(&self, crossing: &Segment) -> f64 {
        let mut sum = 0.0;
        each_segment(self.curved_axes.as_ref(), crossing, |segment| sum += self.optical_depth(segment));
        sum
    }

    /// T of the segment: the sum of the widgets' closed forms.
    pub fn optical_depth(&self, segment: &Segment) -> f64 {
        self.widgets.iter().filter_map(|widget| self.cross(widget, segment)).map(|active| active.depth).sum()
    }

    /// Σ Tᵢ Tⱼ over the pairs of widgets on the segment: how much their order can matter, at most.
    pub fn overlap(&self, segment: &Segment) -> f64 {
        let depths = self.widgets.iter().filter_map(|widget| self.cross(widget, segment)).map(|a| a.depth);
        let pairs = |(product, sum): (f64, f64), depth: f64| (depth.mul_add(sum, product), sum + depth);
        depths.fold((0.0, 0.0), pairs).0
    }

    /// The segment's contribution. Values that are not finite contribute nothing.
    pub fn integrate(&self, segment: &Segment, overlap: WidgetBlend) -> Contribution {
        self.integrate_by(segment, overlap, &Ordered)
    }

    /// The segment's contribution with another quadrature where closed forms end.
    pub(super) fn integrate_by<Q: Quadrature>(
        &self,
        segment: &Segment,
        overlap: WidgetBlend,
        quadrature: &Q,
    ) -> Contribution {
        let crossed = self.widgets.iter().filter_map(|widget| self.cross(widget, segment));
        let active: Vec<Active> = crossed.filter(|one| one.depth != 0.0 || self.cutoff.is_some()).collect();
        let optical_depth = active.iter().map(|one| one.depth).fold(0.0, |sum, depth| sum + depth);
        let opacity = opacity(optical_depth);
        let color = match &active[..] {
            [] => [0.0; 3],
            [single] if Q::ALONE && single.path.is_integrated(self.cutoff.is_some()) => {
                quadrature.color(&[self.member(single)], self.glow(segment.length))
            }
            [single] => self.color_alone(single, segment.length),
            several => self.color_together(several, segment.length, optical_depth, overlap, quadrature),
        };
        Contribution { optical_depth, color, opacity }
    }

    /// The widget along the segment, if the segment has a part inside its region.
    fn cross<'a>(&'a self, widget: &'a PreparedWidget, segment: &Segment) -> Option<Active<'a>> {
        let stretch = match &widget.clip {
            None => ClippedSpan::WHOLE,
            Some(clip) => ClippedSpan::within(clip, segment.front, segment.back)?,
        };
        let stretch = match &widget.range {
            None => stretch,
            Some(range) => stretch.intersection(&ClippedSpan::within(range, segment.front, segment.back)?)?,
        };
        let scale = segment.length / self.unit_distance;
        let extent =
            WidgetPart { stretch, peak: segment.length * widget.extinction / self.unit_distance, scale };
        let path = widget.profile.path(segment, extent.peak, self.cutoff)?;
        let depth = path.depth(&extent);
        // False also where the values are not numbers.
        (depth >= 0.0 && extent.peak > 0.0).then_some(Active { widget, path, extent, depth })
    }

    /// C of a widget that is alone on the segment.
    fn color_alone(&self, active: &Active, length: f64) -> [f64; 3] {
        let Active { widget, path, extent, depth } = active;
        let light = match self.cutoff {
            None => path.density_light(extent, *depth),
            Some(cutoff) => path.constant_light(extent, *depth, cutoff, threshold(widget, cutoff)),
        };
        match light {
            WidgetLight::OfWidget(light) => widget.color.map(|c| c * light),
            WidgetLight::OwnColors(color) => color,
            WidgetLight::Integrated => ordered(&[self.member(active)], self.glow(length)),
        }
    }

    /// C of several widgets.
    fn color_together(
        &self,
        active: &[Active],
        length: f64,
        optical_depth: f64,
        overlap: WidgetBlend,
        quadrature: &impl Quadrature,
    ) -> [f64; 3] {
        if self.cutoff.is_none() {
            let first = active[0].widget.color;
            if active.iter().all(|a| a.path.has_one_color() && a.widget.color == first) {
                return first.map(|c| c * opacity(optical_depth));
            }
        }
        if overlap == WidgetBlend::Mix || optical_depth < 1e-14 {
            // Kniss et al. 2003, Eq. 15: each widget's own light, dimmed by what all of them absorb on the
            // mean. For one colour and the density-emitter this is c Tᵢ/T (1 − e^(−T)).
            let dimmed = mean_transmittance(optical_depth);
            return active.iter().fold([0.0; 3], |sum, a| {
                let share = dimmed / mean_transmittance(a.depth);
                let alone = self.color_alone(a, length);
                std::array::from_fn(|i| sum[i] + share * alone[i])
            });
        }
        quadrature.color(&self.members(active), self.glow(length))
    }

    fn members<'a>(&self, active: &[Active<'a>]) -> Vec<Member<'a>> {
        active.iter().map(|active| self.member(active)).collect()
    }

    /// Calls `f` with point samples along the segment.
    pub fn sampled<R>(&self, segment: &Segment, f: impl FnOnce(Samples) -> R) -> R {
        let active: Vec<Active> =
            self.widgets.iter().filter_map(|widget| self.cross(widget, segment)).collect();
        f(Samples::new(&self.members(&active), self.glow(segment.length)))
    }

    fn glow(&self, length: f64) -> Glow {
        if self.cutoff.is_some() { Glow::Constant(length / self.unit_distance) } else { Glow::Density }
    }

    fn member<'a>(&self, active: &Active<'a>) -> Member<'a> {
        let Active { widget, path, extent, .. } = active;
        let threshold = self.cutoff.map(|cutoff| threshold(widget, cutoff));
        let window = self.cutoff.and_then(|cutoff| path.window(cutoff));
        Member {
            track: path.track(extent, self.cutoff, threshold),
            range: [extent.stretch.start, extent.stretch.end],
            window: window.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
            color: widget.color,
            threshold: threshold.unwrap_or(0.0),
            unit_rate: extent.peak,
        }
    }
}

/// Extinction or profile above which a widget glows.
fn threshold(widget: &PreparedWidget, cutoff: Cutoff) -> f64 {
    widget.profile.peak() * cutoff.share
}
