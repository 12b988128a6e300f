//! Widgets in lanes: optical depth of a batch's segments, and densities at points of them.

use crate::attribute::Attribute;
use crate::shade::along::Along;
use crate::shade::gaussian::LaneGaussian;
use crate::shade::gaussian_nd::LaneGaussianNd;
use crate::shade::piecewise::LaneLinear;
use crate::shade::region::{Inside, LaneRegion};
use crate::shade::triangular::LaneTriangular;
use crate::shade::wave::LaneWave;
use voltet_core::transfer::{Profile, Widget};
use voltet_lanes::optics::smooth::Shape;
use voltet_lanes::{Float, Lanes};

/// A widget made ready for lanes.
pub(crate) enum LaneWidget {
    Uniform {
        density: f32,
        color: [f32; 3],
        region: LaneRegion,
    },
    Gaussian(LaneGaussian),
    Wave {
        wave: LaneWave,
        density: f32,
        color: [f32; 3],
        region: Option<LaneRegion>,
    },
    Linear(Box<LaneLinear>),
    /// Only on the slow road ([`super::panels`]), as the next.
    Triangular(LaneTriangular),
    GaussianNd(Box<LaneGaussianNd>),
    /// No twin: the 64-bit path serves it.
    Exact,
}

impl LaneWidget {
    /// `density_scale` turns extinction into optical depth per scene length; `fields`: names of the further fields,
    /// `cutoff`: the constant-emitter's.
    pub fn new(
        widget: &Widget,
        attributes: &[Attribute<'_>],
        fields: &[&str],
        density_scale: f64,
        cutoff: Option<f64>,
    ) -> LaneWidget {
        let color = widget.color.map(|c| c as f32);
        let density = (widget.extinction * density_scale) as f32;
        if !density.is_finite() {
            return LaneWidget::Exact;
        }
        let region = widget.region.as_ref().map(|region| LaneRegion::new(region, attributes));
        match (&widget.profile, region) {
            (Profile::Uniform, Some(region)) => LaneWidget::Uniform { density, color, region },
            (Profile::Gaussian { centre, matrix }, region) => {
                LaneGaussian::new(centre, matrix, attributes, density, color, region)
                    .map_or(LaneWidget::Exact, LaneWidget::Gaussian)
            }
            (Profile::TriangleWave(wave) | Profile::SineWave(wave), region) => {
                let sine = matches!(&widget.profile, Profile::SineWave(_));
                match LaneWave::new(wave, sine, attributes) {
                    Some(wave) => LaneWidget::Wave { wave, density, color, region },
                    None => LaneWidget::Exact,
                }
            }
            (Profile::PiecewiseLinear { points }, None) => {
                LaneLinear::new(points, &attributes[0], density_scale, cutoff)
                    .map_or(LaneWidget::Exact, |linear| LaneWidget::Linear(Box::new(linear)))
            }
            (Profile::TriangularGaussian { centre, sigma }, region) => {
                LaneTriangular::new(*centre, *sigma, attributes, density, color, region)
                    .map_or(LaneWidget::Exact, LaneWidget::Triangular)
            }
            (Profile::GaussianNd { fields: names, centre, matrix }, region) => {
                let slot = |name: &String| fields.iter().position(|field| field == name);
                let slots: Option<Vec<usize>> = names.iter().map(slot).collect();
                slots
                    .and_then(|slots| {
                        LaneGaussianNd::new(&slots, centre, matrix, attributes, density, color, region)
                    })
                    .map_or(LaneWidget::Exact, |nd| LaneWidget::GaussianNd(Box::new(nd)))
            }
            _ => LaneWidget::Exact,
        }
    }

    pub fn color(&self) -> [f32; 3] {
        match self {
            LaneWidget::Uniform { color, .. }
            | LaneWidget::Gaussian(LaneGaussian { color, .. })
            | LaneWidget::Wave { color, .. } => *color,
            LaneWidget::Triangular(triangular) => triangular.color,
            LaneWidget::GaussianNd(nd) => nd.color,
            LaneWidget::Linear(_) | LaneWidget::Exact => [0.0; 3],
        }
    }

    /// Optical depths, and the lanes (bits) that only the 64-bit path can serve.
    #[inline(always)]
    pub fn depth<L: Lanes>(&self, along: &Along<L>) -> (L::F, u32) {
        let zero = L::F::splat(0.0);
        match self {
            LaneWidget::Uniform { density, region, .. } => {
                let share = along.inside(Some(region)).share;
                (share * L::F::splat(*density) * along.length, 0)
            }
            LaneWidget::Gaussian(gaussian) => (gaussian.shape(along).depth, gaussian.unsure(along)),
            LaneWidget::Wave { wave, density, region, .. } => {
                let Inside { front, back, share, .. } = along.inside(region.as_ref());
                (wave.mean::<L>(&front, &back) * (L::F::splat(*density) * along.length * share), 0)
            }
            LaneWidget::Linear(linear) => (linear.depth(along), 0),
            LaneWidget::Triangular(_) | LaneWidget::GaussianNd(_) | LaneWidget::Exact => (zero, u32::MAX),
        }
    }

    /// Optical depths with their shape along the segment, and the lanes (bits) that only the 64-bit path can serve. The
    /// change is infinite where a region cuts the segment, and for profiles that have no shape.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, along: &Along<L>) -> (Shape<L>, u32) {
        match self {
            LaneWidget::Gaussian(gaussian) => (gaussian.shape(along), gaussian.unsure(along)),
            LaneWidget::Uniform { density, region, .. } => {
                let Inside { share, cut, .. } = along.inside(Some(region));
                (Shape::even(share * L::F::splat(*density) * along.length).cut(cut), 0)
            }
            LaneWidget::Wave { wave, density, region, .. } => {
                let Inside { front, back, share, cut } = along.inside(region.as_ref());
                let peak = L::F::splat(*density) * along.length * share;
                (wave.shape::<L>(&front, &back, peak).cut(cut), 0)
            }
            _ => {
                let (depth, unsure) = self.depth::<L>(along);
                (Shape::even(depth).cut(L::F::splat(0.0).lt(depth)), unsure)
            }
        }
    }

    /// Density at a point of the segment. Regions are not looked at: a widget whose region cuts the segment has
    /// no shape, and one whose region misses it has no depth.
    #[inline(always)]
    pub fn density<L: Lanes>(&self, along: &Along<L>, t: L::F) -> L::F {
        match self {
            LaneWidget::Uniform { density, .. } => L::F::splat(*density),
            LaneWidget::Gaussian(gaussian) => gaussian.density_at::<L>(along, t),
            LaneWidget::Wave { wave, density, .. } => wave.value::<L>(&along.at(t)) * L::F::splat(*density),
            _ => L::F::splat(0.0),
        }
    }
}
