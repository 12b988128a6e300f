//! The kinds of widgets in lanes, one file each, and here what chooses among them: optical depths of a batch's segments,
//! densities and values at points of them, paths in widths, and members of an ordered integral ([`super::panels`]).

mod gaussian;
mod piecewise_linear;
mod table;
mod triangular_gaussian;
mod wave;

pub(crate) use piecewise_linear::LaneLinear;

use crate::shade::context::WidgetContext;
use crate::shade::region::{Inside, LaneRegion, SupportBounds, ValueRange, range_of};
use crate::shade::segment_lanes::{FieldLanes, SegmentLanes};
use gaussian::{LaneFields, LaneGaussian};
use table::LaneTable;
use triangular_gaussian::{LaneTriangular, LaneTriangularNd};
use voltet_core::transfer::{Profile, Widget};
use voltet_simd::optics::gaussian::{LaneGaussianPath, LaneGaussianSteps, LaneGaussianTrack};
use voltet_simd::optics::overlap::{AnyLaneTrack, LaneMember};
use voltet_simd::optics::piecewise_linear::LanePiecewiseTrack;
use voltet_simd::optics::smooth::DensityShape;
use voltet_simd::{Float, Lanes, Mask, array};
use wave::LaneWave;

/// Widths squared of a step over which a Gaussian follows from step to step.
const MAX_STEP_SQUARED: f32 = 0.26;

/// A widget compiled for vector lanes.
pub struct LaneWidget {
    profile: VectorProfile,
    /// Linear RGB; 0 for profiles with colours.
    pub color: [f32; 3],
    /// Peak optical depth per scene length; 1 for profiles with densities.
    density: f32,
    pub(super) region: Option<LaneRegion>,
    /// `None`: the support has no bounds.
    support: Option<SupportBounds>,
}

/// A profile compiled for vector lanes. Control points, colours, steps, densities along segments and paths are optional: a kind without
/// them is in the rest of their `match`es; the others have no rest.
enum VectorProfile {
    Uniform,
    Gaussian(LaneGaussian),
    Wave(LaneWave),
    PiecewiseLinear(Box<LaneLinear>),
    Table(Box<LaneTable>),
    TriangularGaussian(LaneTriangular),
    GaussianNd(Box<LaneFields>),
    TriangularGaussianNd(Box<LaneTriangularNd>),
    /// No vector form: 64 bits integrate it.
    None,
}

/// Path of segments inside a widget's region.
pub struct RegionPath<L: Lanes> {
    /// Ends of the path in widths of a Gaussian; `None` where the profile is 1 all along.
    pub path: Option<LaneGaussianPath<L>>,
    /// Fraction of each segment inside the region.
    pub fraction: L::F,
    /// Lanes in which there is a path.
    pub present: L::M,
}

/// Kernel tier that integrates a widget first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum KernelTier {
    /// Closed forms of [`super::shader`].
    ClosedForm,
    /// Panels of [`super::panels`].
    Panels,
    /// 64-bit forms.
    Bits64,
}

/// Requirement of a widget where it overlaps others, or where it glows without absorbing in step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OrderRequirement {
    /// Panels in 32 bits are exact.
    Panels,
    /// Panels in 32 bits, also where it is alone: its colour varies along the segment.
    Always,
    /// 64 bits: panels in 32 left 7e-4 of the colour.
    Bits64,
}

pub(crate) struct KindTraits {
    /// Kernel tier that integrates it first.
    pub tier: KernelTier,
    /// Requirement where order matters.
    pub order: OrderRequirement,
    /// True if its profile is e^(−x²) of something, which 32 bits round to 0 far out.
    pub is_exponential: bool,
    /// True if its colour varies.
    pub has_colors: bool,
}

/// Calls for each widget whose support some segments of a vector may meet, with its number and these lanes; returns the lanes (bits) that
/// meet any.
#[inline(always)]
pub(crate) fn for_each_active_widget<'a, L: Lanes>(
    widgets: &'a [LaneWidget],
    segments: &SegmentLanes<L>,
    mut take: impl FnMut(usize, &'a LaneWidget, L::M),
) -> u32 {
    let (spread, mut asked) = (ValueRange::new(segments), 0);
    for (number, widget) in widgets.iter().enumerate() {
        let meets = widget.meets::<L>(&spread);
        if meets.any() {
            asked |= meets.bits();
            take(number, widget, meets);
        }
    }
    asked
}

impl VectorProfile {
    /// `None` where 32 bits do not hold the numbers.
    fn new(profile: &Profile, context: &WidgetContext) -> Option<VectorProfile> {
        let WidgetContext { attributes, density_scale, model, .. } = *context;
        Some(match profile {
            Profile::Uniform => VectorProfile::Uniform,
            Profile::Gaussian { centre, matrix } => {
                VectorProfile::Gaussian(LaneGaussian::new(centre, matrix, attributes)?)
            }
            Profile::GaussianNd { fields, centre, matrix } => {
                VectorProfile::GaussianNd(LaneFields::new(fields, centre, matrix, context)?.into())
            }
            Profile::TriangularGaussian { centre, sigma } => {
                VectorProfile::TriangularGaussian(LaneTriangular::new(*centre, *sigma, attributes)?)
            }
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                let nd = LaneTriangularNd::new(fields, magnitude, centre, matrix, context)?;
                VectorProfile::TriangularGaussianNd(nd.into())
            }
            Profile::TriangleWave(wave) => VectorProfile::Wave(LaneWave::new(wave, false, attributes)?),
            Profile::SineWave(wave) => VectorProfile::Wave(LaneWave::new(wave, true, attributes)?),
            Profile::PiecewiseLinear { points } => {
                let linear = LaneLinear::new(points, &attributes[0], density_scale, model.cutoff())?;
                VectorProfile::PiecewiseLinear(linear.into())
            }
            Profile::Table(table) => VectorProfile::Table(LaneTable::new(table, attributes)?.into()),
        })
    }
}

impl LaneWidget {
    pub(super) fn new(widget: &Widget, context: &WidgetContext) -> LaneWidget {
        let own = widget.has_colors_of_its_own();
        let density = (widget.extinction * context.density_scale) as f32;
        let profile = VectorProfile::new(&widget.profile, context);
        LaneWidget {
            profile: profile.filter(|_| density.is_finite()).unwrap_or(VectorProfile::None),
            color: if own { [0.0; 3] } else { widget.color.map(|c| c as f32) },
            density: if widget.profile.properties().own_peak.is_some() { 1.0 } else { density },
            region: LaneRegion::new(&widget.half_planes(), context.attributes),
            support: context.left_out.and_then(|min| SupportBounds::new(widget, context, min)),
        }
    }

    /// Placeholder of a widget that only 64 bits integrate.
    pub(super) fn none() -> LaneWidget {
        LaneWidget {
            profile: VectorProfile::None,
            color: [0.0; 3],
            density: 0.0,
            region: None,
            support: None,
        }
    }

    /// Lanes whose segments may meet its support.
    #[inline(always)]
    pub(super) fn meets<L: Lanes>(&self, spread: &ValueRange<L>) -> L::M {
        match &self.support {
            Some(support) => support.meets::<L>(spread),
            None => spread.segments.crossing,
        }
    }

    #[inline]
    pub(super) fn traits(&self) -> KindTraits {
        use KernelTier as Tier;
        use OrderRequirement as Order;
        let (tier, order, is_exponential, has_colors) = match self.profile {
            VectorProfile::Uniform => (Tier::ClosedForm, Order::Panels, false, false),
            VectorProfile::Gaussian(_) => (Tier::ClosedForm, Order::Panels, true, false),
            VectorProfile::Wave(_) => (Tier::ClosedForm, Order::Bits64, false, false),
            // Pieces that a region cuts have closed forms in 64 bits only.
            VectorProfile::PiecewiseLinear(_) if self.region.is_some() => {
                (Tier::Bits64, Order::Always, false, true)
            }
            VectorProfile::PiecewiseLinear(_) => (Tier::ClosedForm, Order::Always, false, true),
            VectorProfile::Table(_) => (Tier::Panels, Order::Always, false, true),
            VectorProfile::TriangularGaussian(_) => (Tier::Panels, Order::Bits64, true, false),
            VectorProfile::GaussianNd(_) => (Tier::Panels, Order::Panels, true, false),
            VectorProfile::TriangularGaussianNd(_) => (Tier::Panels, Order::Bits64, true, false),
            VectorProfile::None => (Tier::Bits64, Order::Bits64, false, false),
        };
        KindTraits { tier, order, is_exponential, has_colors }
    }

    /// Control points of a piecewise-linear profile.
    pub(super) fn points(&self) -> Option<&LaneLinear> {
        match &self.profile {
            VectorProfile::PiecewiseLinear(linear) => Some(linear),
            _ => None,
        }
    }

    /// The depth of a stretch of the segment where the profile is 1 all along.
    #[inline(always)]
    fn peak_depth<L: Lanes>(&self, segments: &SegmentLanes<L>, share: L::F) -> L::F {
        L::F::splat(self.density) * segments.length * share
    }

    /// The interval of the segments inside the region, where there is one, and its fraction of each.
    #[inline(always)]
    fn stretch<L: Lanes>(&self, segments: &SegmentLanes<L>) -> (Option<[L::F; 2]>, L::F) {
        let range = range_of::<L>(self.region.as_ref(), segments);
        let share = (range[1] - range[0]).max(L::F::splat(0.0));
        (self.region.is_some().then_some(range), share)
    }

    /// Optical depths, and the lanes (bits) that the closed forms do not integrate.
    #[inline(always)]
    pub(super) fn depth<L: Lanes>(&self, segments: &SegmentLanes<L>) -> (L::F, u32) {
        let (shape, unsure) = self.shape(segments);
        (shape.depth, unsure)
    }

    /// Optical depth of any widget with lanes, and the lanes (bits) that only 64 bits integrate.
    #[inline(always)]
    pub(super) fn any_depth<L: Lanes>(
        &self,
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
    ) -> (L::F, u32) {
        match &self.profile {
            VectorProfile::TriangularGaussian(triangular) => {
                let Inside { front, back, share, .. } = segments.inside(self.region.as_ref());
                let (mean, unsure) = triangular.mean::<L>(&front, &back);
                (mean * self.peak_depth(segments, share), unsure)
            }
            VectorProfile::GaussianNd(nd) => {
                let (range, share) = self.stretch(segments);
                (nd.mean::<L>(fields, range) * self.peak_depth(segments, share), nd.unsure())
            }
            VectorProfile::TriangularGaussianNd(nd) => {
                let (range, share) = self.stretch(segments);
                let (mean, unsure) = nd.mean::<L>(fields, range);
                (mean * self.peak_depth(segments, share), unsure)
            }
            VectorProfile::Table(table) => {
                let Inside { front, back, share, .. } = segments.inside(self.region.as_ref());
                let peak = self.peak_depth(segments, share);
                let there = L::F::splat(0.0).lt(share).and(segments.crossing);
                (table.track::<L>(&front, &back, peak, None).mean(there) * peak, 0)
            }
            VectorProfile::Uniform
            | VectorProfile::Gaussian(_)
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::None => self.depth::<L>(segments),
        }
    }

    /// Largest density, optical depth per scene length; `scale`: 1/U per scene length.
    pub(super) fn peak(&self, scale: f32) -> f32 {
        match &self.profile {
            VectorProfile::PiecewiseLinear(linear) => linear.peak * scale,
            VectorProfile::None => 0.0,
            _ => self.density,
        }
    }

    /// Member of an ordered integral; `scale`: D/U.
    #[inline(always)]
    pub(super) fn member<'a, L: Lanes>(
        &'a self,
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
        scale: L::F,
        cutoff: Option<f64>,
    ) -> LaneMember<'a, L> {
        let splat = L::F::splat;
        let rate = splat(self.density) * segments.length;
        let mut member = LaneMember {
            color: self.color,
            threshold: cutoff.unwrap_or(0.0) as f32,
            window: [splat(-1.0), splat(2.0)],
            range: range_of::<L>(self.region.as_ref(), segments),
            unit_rate: rate,
            ..nothing::<L>()
        };
        let gaussian = match &self.profile {
            VectorProfile::Uniform => {
                member.track = AnyLaneTrack::Uniform(rate);
                return member;
            }
            VectorProfile::PiecewiseLinear(linear) => {
                let first = splat(linear.first);
                member.threshold *= linear.peak;
                member.unit_rate = scale;
                member.track = AnyLaneTrack::Piecewise(LanePiecewiseTrack {
                    points: &linear.points_from_first,
                    front: segments.front[0] - first,
                    back: segments.back[0] - first,
                    scale,
                });
                return member;
            }
            VectorProfile::Table(table) => {
                member.track =
                    AnyLaneTrack::Table(table.track(&segments.front, &segments.back, rate, cutoff));
                return member;
            }
            VectorProfile::Gaussian(gaussian) => gaussian.path::<L>(&segments.front, &segments.back),
            VectorProfile::GaussianNd(nd) => nd.path::<L>(fields, None),
            // See `OrderRequirement::Bits64`: those are not walked.
            VectorProfile::Wave(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::None => return nothing::<L>(),
        };
        // Within its window it glows, whatever the rounding of the rate.
        member.threshold = 0.0;
        if let Some(cutoff) = cutoff {
            member.window = gaussian.window_ends(-cutoff.ln() as f32);
        }
        member.track = AnyLaneTrack::Gaussian(LaneGaussianTrack::new(&gaussian, rate));
        member
    }
}

// Densities along segments, for ordered integrals.
impl LaneWidget {
    /// Optical depths with their shape along the segment, and the lanes (bits) that the closed forms do not integrate. The
    /// change is infinite where a region cuts the segment, and for profiles that have no shape.
    #[inline(always)]
    pub(super) fn shape<L: Lanes>(&self, segments: &SegmentLanes<L>) -> (DensityShape<L>, u32) {
        match &self.profile {
            VectorProfile::Uniform => {
                let Inside { share, cut, .. } = segments.inside(self.region.as_ref());
                (DensityShape::even(share * L::F::splat(self.density) * segments.length).cut(cut), 0)
            }
            VectorProfile::Gaussian(gaussian) => {
                let Inside { front, back, share, cut } = segments.inside(self.region.as_ref());
                let shape =
                    gaussian.shape::<L>(&front, &back, self.peak_depth(segments, share), segments.crossing);
                (shape.cut(cut), gaussian.unsure(segments))
            }
            VectorProfile::Wave(wave) => {
                let Inside { front, back, share, cut } = segments.inside(self.region.as_ref());
                (wave.shape::<L>(&front, &back, self.peak_depth(segments, share)).cut(cut), 0)
            }
            VectorProfile::PiecewiseLinear(linear) => {
                let depth = linear.depth(segments);
                (DensityShape::even(depth).cut(L::F::splat(0.0).lt(depth)), 0)
            }
            VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => (DensityShape::even(L::F::splat(0.0)), u32::MAX),
        }
    }

    /// The Gaussian that it is, everywhere or in its region.
    #[inline(always)]
    pub(super) fn gaussian(&self) -> Option<&LaneGaussian> {
        match &self.profile {
            VectorProfile::Gaussian(gaussian) => Some(gaussian),
            _ => None,
        }
    }

    /// The parts of segments inside its region.
    #[inline(always)]
    pub(super) fn inside<L: Lanes>(&self, segments: &SegmentLanes<L>) -> Inside<L> {
        segments.inside(self.region.as_ref())
    }

    /// Square of the steps that quadrature takes for it alone ([`crate::shade::fixed_quadrature`]); ∞ where a part of the segment or all lies
    /// outside its region.
    #[inline(always)]
    pub(super) fn roughness<L: Lanes>(&self, segments: &SegmentLanes<L>) -> L::F {
        let (splat, whole) = (L::F::splat, segments.inside(self.region.as_ref()).share);
        let rough = match &self.profile {
            VectorProfile::Gaussian(gaussian) => gaussian.roughness(segments),
            _ => self.shape::<L>(segments).0.roughness(),
        };
        L::F::select(whole.lt(splat(1.0)), splat(f32::INFINITY), rough)
    }

    /// Values at places of equal steps, each a `share` of the segment, from step `first` on, where those of a step follow from
    /// those of the step before; `peak`: the value at the centre. Regions are ignored: see [`LaneWidget::roughness`].
    #[inline(always)]
    pub(super) fn steps<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        first: usize,
        share: f32,
        places: [f32; N],
        peak: f32,
    ) -> Option<LaneGaussianSteps<L, N>> {
        match &self.profile {
            VectorProfile::Gaussian(gaussian) => {
                Some(gaussian.steps(segments, first, share, places, L::F::splat(peak)))
            }
            _ => None,
        }
    }

    /// Densities at points of the segment, for other profiles with a shape. Regions are ignored.
    #[inline(always)]
    pub(super) fn densities<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        t: [f32; N],
    ) -> [L::F; N] {
        let density = L::F::splat(self.density);
        match &self.profile {
            VectorProfile::Uniform => [density; N],
            VectorProfile::Wave(wave) => {
                array!(|j| wave.value::<L>(&segments.at(L::F::splat(t[j]))) * density)
            }
            _ => [L::F::splat(0.0); N],
        }
    }
}

// The path through a Gaussian, in widths.
impl LaneWidget {
    /// True if it is uniform or a Gaussian of any kind, so that segments have a [`RegionPath`] through it.
    pub fn has_path(&self) -> bool {
        matches!(self.profile, VectorProfile::Uniform) || self.traits().is_exponential
    }

    /// Lanes whose paths may meet it.
    #[inline(always)]
    pub fn path_meets<L: Lanes>(&self, spread: &ValueRange<L>) -> L::M {
        match self.profile {
            // With one width for all of a segment it reaches where it does not with those at its ends.
            VectorProfile::TriangularGaussian(_) | VectorProfile::TriangularGaussianNd(_) => {
                spread.segments.crossing
            }
            _ => self.meets::<L>(spread),
        }
    }

    /// The path; triangular Gaussians take the mean of the widths at the segment's ends.
    #[inline(always)]
    pub fn path<L: Lanes>(&self, segments: &SegmentLanes<L>, fields: &FieldLanes<L>) -> RegionPath<L> {
        let region = self.region.as_ref();
        let mut present = segments.crossing;
        let (path, fraction) = match &self.profile {
            VectorProfile::GaussianNd(nd) => {
                let (range, share) = self.stretch(segments);
                (Some(nd.path::<L>(fields, range)), share)
            }
            VectorProfile::TriangularGaussianNd(nd) => {
                let (range, share) = self.stretch(segments);
                let (path, there) = nd.path::<L>(fields, range);
                present = present.and(there);
                (Some(path), share)
            }
            VectorProfile::Gaussian(gaussian) => {
                let Inside { front, back, share, .. } = segments.inside(region);
                (Some(gaussian.path::<L>(&front, &back)), share)
            }
            VectorProfile::TriangularGaussian(triangular) => {
                let Inside { front, back, share, .. } = segments.inside(region);
                let (path, there) = triangular.path::<L>(segments, &front, &back);
                present = present.and(there);
                (Some(path), share)
            }
            _ => (None, segments.inside(region).share),
        };
        RegionPath { path, fraction, present }
    }
}

// Values at one point of each segment, for the integrators that sample.
impl LaneWidget {
    /// True if it can be sampled in lanes.
    pub(super) fn has_samples(&self) -> bool {
        !matches!(self.profile, VectorProfile::None)
    }

    /// Optical depth per scene length where its value is 1: at the peak; 1 for widgets with densities of their own.
    pub fn density(&self) -> f32 {
        self.density
    }

    /// Value at its peak; `density_scale`: as in [`WidgetContext`].
    pub(super) fn peak_value(&self, density_scale: f64) -> f64 {
        match &self.profile {
            VectorProfile::PiecewiseLinear(linear) => f64::from(linear.peak) * density_scale,
            _ => 1.0,
        }
    }

    /// Lanes (bits) whose segments span more widths than 32 bits resolve.
    #[inline(always)]
    pub(super) fn too_wide<L: Lanes>(&self, segments: &SegmentLanes<L>) -> u32 {
        match &self.profile {
            VectorProfile::Gaussian(gaussian) => gaussian.unsure(segments),
            VectorProfile::GaussianNd(nd) => nd.unsure(),
            VectorProfile::Uniform
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::Table(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::None => 0,
        }
    }

    /// The part of each segment inside its region and its ranges.
    #[inline(always)]
    pub(super) fn range<L: Lanes>(&self, segments: &SegmentLanes<L>) -> [L::F; 2] {
        range_of::<L>(self.region.as_ref(), segments)
    }

    /// The profile of a widget of one colour at the same places of each segment; regions are not looked at.
    #[inline(always)]
    pub(super) fn values<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
        t: &[f32; N],
    ) -> [L::F; N] {
        match &self.profile {
            VectorProfile::Uniform => [L::F::splat(1.0); N],
            VectorProfile::Gaussian(gaussian) => array!(|j| gaussian.value::<L>(&segments.at_share(t[j]))),
            VectorProfile::Wave(wave) => array!(|j| wave.value::<L>(&segments.at_share(t[j]))),
            VectorProfile::TriangularGaussian(triangular) => {
                array!(|j| triangular.value::<L>(&segments.at_share(t[j])))
            }
            VectorProfile::GaussianNd(nd) => array!(|j| nd.value::<L>(fields, t[j])),
            VectorProfile::TriangularGaussianNd(nd) => array!(|j| nd.value::<L>(fields, t[j])),
            VectorProfile::PiecewiseLinear(_) | VectorProfile::Table(_) | VectorProfile::None => {
                [L::F::splat(0.0); N]
            }
        }
    }

    /// At one place of each segment the extinction, as an optical depth per scene length, or alpha of a widget that has colours of
    /// its own, then its colour.
    #[inline(always)]
    pub(super) fn colored_value<L: Lanes>(&self, segments: &SegmentLanes<L>, t: f32) -> [L::F; 4] {
        match &self.profile {
            VectorProfile::PiecewiseLinear(linear) => linear.sample::<L>(segments.at_share(t)[0]),
            VectorProfile::Table(table) => {
                let [r, g, b, alpha] = table.texel::<L>(&segments.at_share(t));
                [alpha, r, g, b]
            }
            _ => [L::F::splat(0.0); 4],
        }
    }

    /// True if its values follow from step to step, on every lane, where each step is a fraction of the segment.
    #[inline(always)]
    pub(super) fn has_steps<L: Lanes>(&self, segments: &SegmentLanes<L>, share: f32) -> bool {
        match &self.profile {
            VectorProfile::Gaussian(gaussian) => {
                let step = gaussian.extent_squared::<L>(segments) * L::F::splat(share * share);
                // Also where it is not a number.
                step.le(L::F::splat(MAX_STEP_SQUARED)).bits() == u32::MAX >> (32 - L::WIDTH)
            }
            _ => false,
        }
    }
}

/// Member with empty support.
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
