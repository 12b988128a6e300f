//! The kinds of widgets in lanes, one file each: optical depths of a batch's segments, densities at points of them, and
//! widgets as members of an ordered integral ([`super::panels`]).

mod gaussian;
mod gaussian_nd;
mod in_order;
pub(crate) mod making;
mod path;
mod piecewise_linear;
mod sample;
mod table;
mod triangular_gaussian;
mod triangular_gaussian_nd;
mod wave;

pub(crate) use making::Making;
pub(crate) use path::Through;
pub(crate) use piecewise_linear::LaneLinear;

use crate::shade::along::{Along, Fields};
use crate::shade::reach::{LaneReach, Spread};
use crate::shade::region::{Inside, LaneRegion, range_of};
use gaussian::LaneGaussian;
use gaussian_nd::LaneGaussianNd;
use table::LaneTable;
use triangular_gaussian::LaneTriangular;
use triangular_gaussian_nd::LaneTriangularNd;
use voltet_core::transfer::{Profile, Widget};
use voltet_simd::optics::gaussian::LaneGaussianTrack;
use voltet_simd::optics::overlap::{AnyLaneTrack, LaneMember};
use voltet_simd::optics::piecewise_linear::LanePiecewiseTrack;
use voltet_simd::{Float, Lanes, Mask};
use wave::LaneWave;

/// A widget compiled for vector lanes.
pub(crate) struct LaneWidget {
    form: LaneForm,
    /// Linear RGB; 0 for profiles with colours.
    pub color: [f32; 3],
    /// Peak optical depth per scene length; 1 for profiles with densities.
    density: f32,
    region: Option<LaneRegion>,
    /// `None`: everywhere.
    reach: Option<LaneReach>,
}

/// A profile compiled for vector lanes.
enum LaneForm {
    Uniform,
    Gaussian(LaneGaussian),
    Wave(LaneWave),
    PiecewiseLinear(Box<LaneLinear>),
    Table(Box<LaneTable>),
    TriangularGaussian(LaneTriangular),
    GaussianNd(Box<LaneGaussianNd>),
    TriangularGaussianNd(Box<LaneTriangularNd>),
    /// No vector form: 64 bits integrate it.
    None,
}

/// Kernel tier that integrates a widget first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Road {
    /// Closed forms of [`super::shader`].
    Quick,
    /// Panels of [`super::panels`].
    Panels,
    /// 64-bit forms.
    Bits64,
}

/// Requirement of a widget where it overlaps others, or where it glows without absorbing in step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InOrder {
    /// Panels in 32 bits are exact.
    Panels,
    /// Panels in 32 bits, also where it is alone: its colour varies along the segment.
    Always,
    /// 64 bits: panels in 32 left 7e-4 of the colour.
    Bits64,
}

/// Calls for each widget whose support some segments of a vector may meet, with its number and these lanes; returns the lanes (bits) that
/// meet any.
#[inline(always)]
pub(crate) fn each_met<'a, L: Lanes>(
    widgets: &'a [LaneWidget],
    along: &Along<L>,
    mut take: impl FnMut(usize, &'a LaneWidget, L::M),
) -> u32 {
    let (spread, mut asked) = (Spread::new(along), 0);
    for (number, widget) in widgets.iter().enumerate() {
        let meets = widget.meets::<L>(&spread);
        if meets.any() {
            asked |= meets.bits();
            take(number, widget, meets);
        }
    }
    asked
}

impl LaneForm {
    /// `None` where 32 bits do not hold the numbers.
    fn new(profile: &Profile, making: &Making) -> Option<LaneForm> {
        match profile {
            Profile::Uniform => Some(LaneForm::Uniform),
            Profile::Gaussian { centre, matrix } => {
                LaneGaussian::new(centre, matrix, making.attributes).map(LaneForm::Gaussian)
            }
            Profile::GaussianNd { fields, centre, matrix } => {
                LaneGaussianNd::new(fields, centre, matrix, making).map(Box::new).map(LaneForm::GaussianNd)
            }
            Profile::TriangularGaussian { centre, sigma } => {
                LaneTriangular::new(*centre, *sigma, making.attributes).map(LaneForm::TriangularGaussian)
            }
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                let nd = LaneTriangularNd::new(fields, magnitude, centre, matrix, making);
                nd.map(Box::new).map(LaneForm::TriangularGaussianNd)
            }
            Profile::TriangleWave(wave) => LaneWave::new(wave, false, making.attributes).map(LaneForm::Wave),
            Profile::SineWave(wave) => LaneWave::new(wave, true, making.attributes).map(LaneForm::Wave),
            Profile::PiecewiseLinear { points } => {
                let linear = LaneLinear::new(
                    points,
                    &making.attributes[0],
                    making.density_scale,
                    making.model.cutoff(),
                );
                linear.map(Box::new).map(LaneForm::PiecewiseLinear)
            }
            Profile::Table(table) => {
                LaneTable::new(table, making.attributes).map(Box::new).map(LaneForm::Table)
            }
        }
    }
}

impl LaneWidget {
    pub fn new(widget: &Widget, making: &Making) -> LaneWidget {
        let own = widget.has_colors_of_its_own();
        let density = (widget.extinction * making.density_scale) as f32;
        let form = LaneForm::new(&widget.profile, making);
        LaneWidget {
            form: form.filter(|_| density.is_finite()).unwrap_or(LaneForm::None),
            color: if own { [0.0; 3] } else { widget.color.map(|c| c as f32) },
            density: if widget.profile.properties().own_peak.is_some() { 1.0 } else { density },
            region: LaneRegion::new(&widget.half_planes(), making.attributes),
            reach: making.left_out.and_then(|min| LaneReach::new(widget, making, min)),
        }
    }

    /// A widget that only 64 bits serve.
    pub fn none() -> LaneWidget {
        LaneWidget { form: LaneForm::None, color: [0.0; 3], density: 0.0, region: None, reach: None }
    }

    /// Lanes whose segments may meet it.
    #[inline(always)]
    pub fn meets<L: Lanes>(&self, spread: &Spread<L>) -> L::M {
        match &self.reach {
            Some(reach) => reach.meets::<L>(spread),
            None => spread.along.crossing,
        }
    }

    /// Kernel tier that integrates it first.
    pub fn road(&self) -> Road {
        match self.form {
            LaneForm::Uniform | LaneForm::Gaussian(_) | LaneForm::Wave(_) => Road::Quick,
            // Pieces that a region cuts have closed forms in 64 bits only.
            LaneForm::PiecewiseLinear(_) if self.region.is_some() => Road::Bits64,
            LaneForm::PiecewiseLinear(_) => Road::Quick,
            LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_) => Road::Panels,
            LaneForm::None => Road::Bits64,
        }
    }

    /// Requirement where order matters.
    pub fn in_order(&self) -> InOrder {
        match self.form {
            LaneForm::Uniform | LaneForm::Gaussian(_) | LaneForm::GaussianNd(_) => InOrder::Panels,
            LaneForm::PiecewiseLinear(_) | LaneForm::Table(_) => InOrder::Always,
            LaneForm::Wave(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::None => InOrder::Bits64,
        }
    }

    /// Control points of a piecewise-linear profile.
    pub fn points(&self) -> Option<&LaneLinear> {
        match &self.form {
            LaneForm::PiecewiseLinear(linear) => Some(linear),
            LaneForm::Uniform
            | LaneForm::Gaussian(_)
            | LaneForm::Wave(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_)
            | LaneForm::None => None,
        }
    }

    /// The depth of a stretch of the segment where the profile is 1 all along.
    #[inline(always)]
    fn peak_depth<L: Lanes>(&self, along: &Along<L>, share: L::F) -> L::F {
        L::F::splat(self.density) * along.length * share
    }

    /// Optical depths, and the lanes (bits) that the quick forms do not serve.
    #[inline(always)]
    pub fn depth<L: Lanes>(&self, along: &Along<L>) -> (L::F, u32) {
        match &self.form {
            LaneForm::Uniform => {
                let share = along.inside(self.region.as_ref()).share;
                (share * L::F::splat(self.density) * along.length, 0)
            }
            LaneForm::Gaussian(gaussian) => {
                let Inside { front, back, share, .. } = along.inside(self.region.as_ref());
                let shape = gaussian.shape::<L>(&front, &back, self.peak_depth(along, share), along.crossing);
                (shape.depth, gaussian.unsure(along))
            }
            LaneForm::Wave(wave) => {
                let Inside { front, back, share, .. } = along.inside(self.region.as_ref());
                (wave.mean::<L>(&front, &back) * self.peak_depth(along, share), 0)
            }
            LaneForm::PiecewiseLinear(linear) => (linear.depth(along), 0),
            LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::Table(_)
            | LaneForm::None => (L::F::splat(0.0), u32::MAX),
        }
    }

    /// Optical depth of any widget with lanes, and the lanes (bits) that only 64 bits serve.
    #[inline(always)]
    pub fn any_depth<L: Lanes>(&self, along: &Along<L>, fields: &Fields<L>) -> (L::F, u32) {
        match &self.form {
            LaneForm::TriangularGaussian(triangular) => {
                let Inside { front, back, share, .. } = along.inside(self.region.as_ref());
                let (mean, unsure) = triangular.mean::<L>(&front, &back);
                (mean * self.peak_depth(along, share), unsure)
            }
            LaneForm::GaussianNd(nd) => {
                let range = range_of::<L>(self.region.as_ref(), along);
                let share = (range[1] - range[0]).max(L::F::splat(0.0));
                let mean = nd.mean::<L>(fields, self.region.is_some().then_some(range));
                (mean * self.peak_depth(along, share), nd.unsure())
            }
            LaneForm::TriangularGaussianNd(nd) => {
                let range = range_of::<L>(self.region.as_ref(), along);
                let share = (range[1] - range[0]).max(L::F::splat(0.0));
                let (mean, unsure) = nd.mean::<L>(fields, self.region.is_some().then_some(range));
                (mean * self.peak_depth(along, share), unsure)
            }
            LaneForm::Table(table) => {
                let Inside { front, back, share, .. } = along.inside(self.region.as_ref());
                let peak = self.peak_depth(along, share);
                let there = L::F::splat(0.0).lt(share).and(along.crossing);
                (table.track::<L>(&front, &back, peak, None).mean(there) * peak, 0)
            }
            LaneForm::Uniform
            | LaneForm::Gaussian(_)
            | LaneForm::Wave(_)
            | LaneForm::PiecewiseLinear(_)
            | LaneForm::None => self.depth::<L>(along),
        }
    }

    /// Largest density, optical depth per scene length; `scale`: 1/U per scene length.
    pub fn peak(&self, scale: f32) -> f32 {
        match &self.form {
            LaneForm::PiecewiseLinear(linear) => linear.peak * scale,
            LaneForm::Uniform
            | LaneForm::Gaussian(_)
            | LaneForm::Wave(_)
            | LaneForm::Table(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::GaussianNd(_)
            | LaneForm::TriangularGaussianNd(_) => self.density,
            LaneForm::None => 0.0,
        }
    }

    /// Member of an ordered integral; `scale`: D/U.
    #[inline(always)]
    pub fn member<'a, L: Lanes>(
        &'a self,
        along: &Along<L>,
        fields: &Fields<L>,
        scale: L::F,
        cutoff: Option<f64>,
    ) -> LaneMember<'a, L> {
        let splat = L::F::splat;
        let rate = splat(self.density) * along.length;
        let mut member = LaneMember {
            color: self.color,
            threshold: cutoff.unwrap_or(0.0) as f32,
            window: [splat(-1.0), splat(2.0)],
            range: range_of::<L>(self.region.as_ref(), along),
            unit_rate: rate,
            ..nothing::<L>()
        };
        let gaussian = match &self.form {
            LaneForm::Uniform => {
                member.track = AnyLaneTrack::Uniform(rate);
                return member;
            }
            LaneForm::PiecewiseLinear(linear) => {
                let first = splat(linear.first);
                member.threshold *= linear.peak;
                member.unit_rate = scale;
                member.track = AnyLaneTrack::Piecewise(LanePiecewiseTrack {
                    points: &linear.points_from_first,
                    front: along.front[0] - first,
                    back: along.back[0] - first,
                    scale,
                });
                return member;
            }
            LaneForm::Table(table) => {
                member.track = AnyLaneTrack::Table(table.track(&along.front, &along.back, rate, cutoff));
                return member;
            }
            LaneForm::Gaussian(gaussian) => gaussian.path::<L>(&along.front, &along.back),
            LaneForm::GaussianNd(nd) => nd.path::<L>(fields, None),
            // See `InOrder::Bits64`: those are not walked.
            LaneForm::Wave(_)
            | LaneForm::TriangularGaussian(_)
            | LaneForm::TriangularGaussianNd(_)
            | LaneForm::None => return nothing::<L>(),
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
