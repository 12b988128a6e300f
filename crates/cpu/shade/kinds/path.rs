//! Path of each segment through a Gaussian, in widths.

use super::{LaneWidget, VectorProfile};
use crate::shade::region::{Inside, range_of};
use crate::shade::segment_lanes::{FieldLanes, SegmentLanes};
use crate::shade::support::ValueRange;
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::{Float, Lanes, Mask};

/// Path of segments inside a widget's region.
pub struct RegionPath<L: Lanes> {
    /// Ends of the path in widths of a Gaussian; `None` where the profile is 1 all along.
    pub path: Option<LaneGaussianPath<L>>,
    /// Fraction of each segment inside the region.
    pub fraction: L::F,
    /// Lanes in which there is a path.
    pub present: L::M,
}

impl LaneWidget {
    /// True if it is uniform or a Gaussian of any kind.
    pub fn has_path(&self) -> bool {
        match self.profile {
            VectorProfile::Uniform
            | VectorProfile::Gaussian(_)
            | VectorProfile::TriangularGaussian(_)
            | VectorProfile::GaussianNd(_)
            | VectorProfile::TriangularGaussianNd(_) => true,
            VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => false,
        }
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
    pub fn region_path<L: Lanes>(&self, segments: &SegmentLanes<L>, fields: &FieldLanes<L>) -> RegionPath<L> {
        let region = self.region.as_ref();
        match &self.profile {
            VectorProfile::GaussianNd(nd) => {
                let range = range_of::<L>(region, segments);
                let path = nd.path::<L>(fields, region.is_some().then_some(range));
                RegionPath::new(Some(path), range[1] - range[0], segments.crossing)
            }
            VectorProfile::TriangularGaussianNd(nd) => {
                let range = range_of::<L>(region, segments);
                let (path, there) = nd.path::<L>(fields, region.is_some().then_some(range));
                RegionPath::new(Some(path), range[1] - range[0], segments.crossing.and(there))
            }
            VectorProfile::Gaussian(gaussian) => {
                let Inside { front, back, share, .. } = segments.inside(region);
                RegionPath::new(Some(gaussian.path::<L>(&front, &back)), share, segments.crossing)
            }
            VectorProfile::TriangularGaussian(triangular) => {
                let Inside { front, back, share, .. } = segments.inside(region);
                let (path, there) = triangular.path::<L>(segments, &front, &back);
                RegionPath::new(Some(path), share, segments.crossing.and(there))
            }
            VectorProfile::Uniform
            | VectorProfile::Wave(_)
            | VectorProfile::PiecewiseLinear(_)
            | VectorProfile::Table(_)
            | VectorProfile::None => {
                let Inside { share, .. } = segments.inside(region);
                RegionPath::new(None, share, segments.crossing)
            }
        }
    }
}

impl<L: Lanes> RegionPath<L> {
    #[inline(always)]
    fn new(path: Option<LaneGaussianPath<L>>, fraction: L::F, present: L::M) -> Self {
        RegionPath { path, fraction: fraction.max(L::F::splat(0.0)), present }
    }
}
