//! A widget among others, in their order along a segment: its shape there, and its densities at places of steps.

use super::{LaneForm, LaneGaussian, LaneWidget};
use crate::shade::along::Along;
use crate::shade::region::Inside;
use voltet_simd::optics::gaussian_steps::LaneGaussianSteps;
use voltet_simd::optics::smooth::DensityShape;
use voltet_simd::{Float, Lanes, array};

impl LaneWidget {
    /// Optical depths with their shape along the segment, and the lanes (bits) that the quick forms do not serve. The
    /// change is infinite where a region cuts the segment, and for profiles that have no shape.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, along: &Along<L>) -> (DensityShape<L>, u32) {
        match &self.form {
            LaneForm::Uniform => {
                let Inside { share, cut, .. } = along.inside(self.region.as_ref());
                (DensityShape::even(share * L::F::splat(self.density) * along.length).cut(cut), 0)
            }
            LaneForm::Gaussian(gaussian) => {
                let Inside { front, back, share, cut } = along.inside(self.region.as_ref());
                let shape = gaussian.shape::<L>(&front, &back, self.peak_depth(along, share), along.crossing);
                (shape.cut(cut), gaussian.unsure(along))
            }
            LaneForm::Wave(wave) => {
                let Inside { front, back, share, cut } = along.inside(self.region.as_ref());
                (wave.shape::<L>(&front, &back, self.peak_depth(along, share)).cut(cut), 0)
            }
            LaneForm::PiecewiseLinear(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_)
            | LaneForm::None => {
                let (depth, unsure) = self.depth::<L>(along);
                (DensityShape::even(depth).cut(L::F::splat(0.0).lt(depth)), unsure)
            }
        }
    }

    /// The Gaussian that it is everywhere, if it is one.
    pub fn whole_gaussian(&self) -> Option<&LaneGaussian> {
        match (&self.form, &self.region) {
            (LaneForm::Gaussian(gaussian), None) => Some(gaussian),
            _ => None,
        }
    }

    /// The square of the steps that quadrature of what has a shape wants for it alone ([`super::stepped`]); ∞ where its region
    /// leaves out a part of the segment or all.
    #[inline(always)]
    pub fn roughness<L: Lanes>(&self, along: &Along<L>) -> L::F {
        let (splat, whole) = (L::F::splat, along.inside(self.region.as_ref()).share);
        let rough = match &self.form {
            LaneForm::Gaussian(gaussian) => gaussian.roughness(along),
            LaneForm::Uniform
            | LaneForm::Wave(_)
            | LaneForm::PiecewiseLinear(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_)
            | LaneForm::None => self.shape::<L>(along).0.roughness(),
        };
        L::F::select(whole.lt(splat(1.0)), splat(f32::INFINITY), rough)
    }

    /// Densities at places of equal steps, each a `share` of the segment, from step `first` on, where those of a step follow from
    /// those of the step before. Regions are not looked at: see [`LaneWidget::roughness`].
    #[inline(always)]
    pub fn steps<L: Lanes, const N: usize>(
        &self,
        along: &Along<L>,
        first: usize,
        share: f32,
        places: [f32; N],
    ) -> Option<LaneGaussianSteps<L, N>> {
        match &self.form {
            LaneForm::Gaussian(gaussian) => {
                Some(gaussian.steps(along, first, share, places, L::F::splat(self.density)))
            }
            LaneForm::Uniform
            | LaneForm::Wave(_)
            | LaneForm::PiecewiseLinear(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_)
            | LaneForm::None => None,
        }
    }

    /// Densities at points of the segment, of what else has a shape; regions as above.
    #[inline(always)]
    pub fn densities<L: Lanes, const N: usize>(&self, along: &Along<L>, t: [f32; N]) -> [L::F; N] {
        let density = L::F::splat(self.density);
        match &self.form {
            LaneForm::Uniform => [density; N],
            LaneForm::Wave(wave) => array(
                #[inline(always)]
                |j| wave.value::<L>(&along.at(L::F::splat(t[j]))) * density,
            ),
            LaneForm::Gaussian(_)
            | LaneForm::PiecewiseLinear(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_)
            | LaneForm::None => [L::F::splat(0.0); N],
        }
    }
}
