//! The path of each segment through a Gaussian, in widths, for the method that looks its integral up.

use super::{LaneForm, LaneWidget};
use crate::shade::along::{Along, Fields};
use crate::shade::reach::Spread;
use crate::shade::region::{Inside, range_of};
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::{Float, Lanes, Mask};

/// Path of segments inside a widget's region.
pub(crate) struct Through<L: Lanes> {
    /// `None`: the profile is 1 all along.
    pub path: Option<LaneGaussianPath<L>>,
    /// Fraction of the segment.
    pub share: L::F,
    /// Lanes in which there is a path.
    pub there: L::M,
}

impl LaneWidget {
    /// True if it is uniform or a Gaussian of any kind.
    pub fn has_path(&self) -> bool {
        match self.form {
            LaneForm::Uniform
            | LaneForm::Gaussian(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_) => true,
            LaneForm::Wave(_) | LaneForm::PiecewiseLinear(_) | LaneForm::Table(_) | LaneForm::None => false,
        }
    }

    /// Lanes whose paths may meet it.
    #[inline(always)]
    pub fn path_meets<L: Lanes>(&self, spread: &Spread<L>) -> L::M {
        match self.form {
            // With one width for all of a segment it reaches where it does not with those at its ends.
            LaneForm::TriangularGaussian(_) | LaneForm::TriangularGaussianNd(_) => spread.along.crossing,
            _ => self.meets::<L>(spread),
        }
    }

    /// The path; triangular Gaussians take the mean of the widths at the segment's ends.
    #[inline(always)]
    pub fn through<L: Lanes>(&self, along: &Along<L>, fields: &Fields<L>) -> Through<L> {
        let region = self.region.as_ref();
        match &self.form {
            LaneForm::GaussianNd(nd) => {
                let range = range_of::<L>(region, along);
                let path = nd.path::<L>(fields, region.is_some().then_some(range));
                Through::new(Some(path), range[1] - range[0], along.crossing)
            }
            LaneForm::TriangularGaussianNd(nd) => {
                let range = range_of::<L>(region, along);
                let (path, there) = nd.path::<L>(fields, region.is_some().then_some(range));
                Through::new(Some(path), range[1] - range[0], along.crossing.and(there))
            }
            LaneForm::Gaussian(gaussian) => {
                let Inside { front, back, share, .. } = along.inside(region);
                Through::new(Some(gaussian.path::<L>(&front, &back)), share, along.crossing)
            }
            LaneForm::TriangularGaussian(triangular) => {
                let Inside { front, back, share, .. } = along.inside(region);
                let (path, there) = triangular.path::<L>(along, &front, &back);
                Through::new(Some(path), share, along.crossing.and(there))
            }
            LaneForm::Uniform
            | LaneForm::Wave(_)
            | LaneForm::PiecewiseLinear(_)
            | LaneForm::Table(_)
            | LaneForm::None => {
                let Inside { share, .. } = along.inside(region);
                Through::new(None, share, along.crossing)
            }
        }
    }
}

impl<L: Lanes> Through<L> {
    #[inline(always)]
    fn new(path: Option<LaneGaussianPath<L>>, share: L::F, there: L::M) -> Self {
        Through { path, share: share.max(L::F::splat(0.0)), there }
    }
}
