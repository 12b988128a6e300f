//! A widget at one point of each segment: density and colour, for the integrators that sample.

use super::{LaneWidget, VectorProfile};
use crate::shade::region::range_of;
use crate::shade::segment_lanes::{FieldLanes, SegmentLanes};
use voltet_simd::optics::gaussian_steps::LaneGaussianSteps;
use voltet_simd::{Float, Lanes, Mask, array};

/// Widths squared of a step over which a Gaussian follows from step to step.
const MAX_STEP_SQUARED: f32 = 0.26;

impl LaneWidget {
    /// True if it can be sampled in lanes.
    pub fn has_samples(&self) -> bool {
        !matches!(self.profile, VectorProfile::None)
    }

    /// Optical depth per scene length where its value is 1.
    pub fn density(&self) -> f32 {
        self.density
    }

    /// True if its colour varies.
    pub fn has_colors(&self) -> bool {
        matches!(self.profile, VectorProfile::PiecewiseLinear(_) | VectorProfile::Table(_))
    }

    /// True if its profile is e^(−x²) of something, which 32 bits round to 0 far out.
    pub fn is_exponential(&self) -> bool {
        match self.profile {
            VectorProfile::Gaussian(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_) => true,
            VectorProfile::Uniform
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => false,
        }
    }

    /// Value at its peak; `density_scale`: as in [`super::WidgetContext`].
    pub fn peak_value(&self, density_scale: f64) -> f64 {
        match &self.profile {
            VectorProfile::PiecewiseLinear(linear) => f64::from(linear.peak) * density_scale,
            VectorProfile::Uniform
            | VectorProfile::Gaussian(_)
            | VectorProfile::Wave(_)
            | VectorProfile::Table(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::None => 1.0,
        }
    }

    /// Lanes (bits) whose segments span more widths than 32 bits resolve.
    #[inline(always)]
    pub fn too_wide<L: Lanes>(&self, segments: &SegmentLanes<L>) -> u32 {
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

    /// True if a region or ranges limit it.
    pub fn has_region(&self) -> bool {
        self.region.is_some()
    }

    /// The part of each segment inside its region and its ranges.
    #[inline(always)]
    pub fn range<L: Lanes>(&self, segments: &SegmentLanes<L>) -> [L::F; 2] {
        range_of::<L>(self.region.as_ref(), segments)
    }

    /// The profile of a widget of one colour at the same places of each segment; regions are not looked at.
    #[inline(always)]
    pub fn values<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
        t: &[f32; N],
    ) -> [L::F; N] {
        match &self.profile {
            VectorProfile::Uniform => [L::F::splat(1.0); N],
            VectorProfile::Gaussian(gaussian) => array(
                #[inline(always)]
                |j| gaussian.value::<L>(&segments.at_share(t[j])),
            ),
            VectorProfile::Wave(wave) => array(
                #[inline(always)]
                |j| wave.value::<L>(&segments.at_share(t[j])),
            ),
            VectorProfile::TriangularGaussian(triangular) => array(
                #[inline(always)]
                |j| triangular.value::<L>(&segments.at_share(t[j])),
            ),
            VectorProfile::GaussianNd(nd) => array(
                #[inline(always)]
                |j| nd.value::<L>(fields, t[j]),
            ),
            VectorProfile::TriangularGaussianNd(nd) => array(
                #[inline(always)]
                |j| nd.value::<L>(fields, t[j]),
            ),
            VectorProfile::PiecewiseLinear(_) | VectorProfile::Table(_) | VectorProfile::None => {
                [L::F::splat(0.0); N]
            }
        }
    }

    /// At one place of each segment the extinction, as an optical depth per scene length, or alpha of a widget that has colours of
    /// its own, then its colour.
    #[inline(always)]
    pub fn colored_value<L: Lanes>(&self, segments: &SegmentLanes<L>, t: f32) -> [L::F; 4] {
        match &self.profile {
            VectorProfile::PiecewiseLinear(linear) => linear.sample::<L>(segments.at_share(t)[0]),
            VectorProfile::Table(table) => {
                let [r, g, b, alpha] = table.texel::<L>(&segments.at_share(t));
                [alpha, r, g, b]
            }
            VectorProfile::Uniform
            | VectorProfile::Gaussian(_)
            | VectorProfile::Wave(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::None => [L::F::splat(0.0); 4],
        }
    }

    /// True if its values follow from step to step, on every lane, where each step is a fraction of the segment.
    #[inline(always)]
    pub fn has_steps<L: Lanes>(&self, segments: &SegmentLanes<L>, share: f32) -> bool {
        match &self.profile {
            VectorProfile::Gaussian(gaussian) => {
                let step = gaussian.extent_squared::<L>(segments) * L::F::splat(share * share);
                // Also where it is not a number.
                step.le(L::F::splat(MAX_STEP_SQUARED)).bits() == u32::MAX >> (32 - L::WIDTH)
            }
            VectorProfile::Uniform
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::Table(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::None => false,
        }
    }

    /// Values in step `first`; see [`LaneWidget::has_steps`].
    #[inline(always)]
    pub fn value_steps<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        first: usize,
        share: f32,
        places: [f32; N],
        out: &mut LaneGaussianSteps<L, N>,
    ) {
        if let VectorProfile::Gaussian(gaussian) = &self.profile {
            *out = gaussian.steps(segments, first, share, places, L::F::splat(1.0));
        }
    }
}
