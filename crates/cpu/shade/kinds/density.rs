//! Densities of a widget along segments, for ordered integrals.

use super::{LaneGaussian, LaneWidget, VectorProfile};
use crate::shade::region::Inside;
use crate::shade::segment_lanes::SegmentLanes;
use voltet_simd::optics::gaussian_steps::LaneGaussianSteps;
use voltet_simd::optics::smooth::DensityShape;
use voltet_simd::{Float, Lanes, array};

impl LaneWidget {
    /// Optical depths with their shape along the segment, and the lanes (bits) that the closed forms do not integrate. The
    /// change is infinite where a region cuts the segment, and for profiles that have no shape.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, segments: &SegmentLanes<L>) -> (DensityShape<L>, u32) {
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
            VectorProfile::PiecewiseLinear(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => {
                let (depth, unsure) = self.depth::<L>(segments);
                (DensityShape::even(depth).cut(L::F::splat(0.0).lt(depth)), unsure)
            }
        }
    }

    /// The Gaussian that it is everywhere, if it is one.
    pub fn whole_gaussian(&self) -> Option<&LaneGaussian> {
        match (&self.profile, &self.region) {
            (VectorProfile::Gaussian(gaussian), None) => Some(gaussian),
            _ => None,
        }
    }

    /// Square of the steps that quadrature takes for it alone ([`crate::shade::fixed_quadrature`]); ∞ where a part of the segment or all lies
    /// outside its region.
    #[inline(always)]
    pub fn roughness<L: Lanes>(&self, segments: &SegmentLanes<L>) -> L::F {
        let (splat, whole) = (L::F::splat, segments.inside(self.region.as_ref()).share);
        let rough = match &self.profile {
            VectorProfile::Gaussian(gaussian) => gaussian.roughness(segments),
            VectorProfile::Uniform
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => self.shape::<L>(segments).0.roughness(),
        };
        L::F::select(whole.lt(splat(1.0)), splat(f32::INFINITY), rough)
    }

    /// Densities at places of equal steps, each a `share` of the segment, from step `first` on, where those of a step follow from
    /// those of the step before. Regions are ignored: see [`LaneWidget::roughness`].
    #[inline(always)]
    pub fn steps<L: Lanes, const N: usize>(
        &self,
        segments: &SegmentLanes<L>,
        first: usize,
        share: f32,
        places: [f32; N],
    ) -> Option<LaneGaussianSteps<L, N>> {
        match &self.profile {
            VectorProfile::Gaussian(gaussian) => {
                Some(gaussian.steps(segments, first, share, places, L::F::splat(self.density)))
            }
            VectorProfile::Uniform
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => None,
        }
    }

    /// Densities at points of the segment, for other profiles with a shape. Regions are ignored.
    #[inline(always)]
    pub fn densities<L: Lanes, const N: usize>(&self, segments: &SegmentLanes<L>, t: [f32; N]) -> [L::F; N] {
        let density = L::F::splat(self.density);
        match &self.profile {
            VectorProfile::Uniform => [density; N],
            VectorProfile::Wave(wave) => array(
                #[inline(always)]
                |j| wave.value::<L>(&segments.at(L::F::splat(t[j]))) * density,
            ),
            VectorProfile::Gaussian(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => [L::F::splat(0.0); N],
        }
    }
}
