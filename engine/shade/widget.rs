//! Widgets in lanes: optical depth of a batch's segments, and densities at points of them.

use crate::composite::crossing::Batch;
use crate::project::Attribute;
use crate::shade::member::{LaneGaussianNd, LaneTriangular};
use crate::shade::piecewise::LaneLinear;
use crate::shade::region::LaneRegion;
use crate::shade::wave::LaneWave;
use voltet_core::transfer::{Profile, Widget};
use voltet_lanes::optics::gaussian;
use voltet_lanes::optics::smooth::Shape;
use voltet_lanes::{Float, Lanes, Mask, Unsigned, array, inlined};

/// One vector of segments of a batch. Lengths in scene lengths, attributes scaled.
pub(crate) struct Along<L: Lanes> {
    /// D.
    pub length: L::F,
    /// Lanes that cross their cell over a positive length.
    pub crossing: L::M,
    /// (s, g) at the entry; g is 0 where it is not asked for.
    pub front: [L::F; 2],
    /// (s, g) at the exit.
    pub back: [L::F; 2],
}

impl<L: Lanes> Along<L> {
    #[inline(always)]
    pub fn load(batch: &Batch, at: usize) -> Self {
        let column = inlined(
            #[inline(always)]
            |columns: &[Vec<f32>], a: usize| match columns[..batch.scalar_count].get(a) {
                Some(column) => L::F::load(&column[at..]),
                None => L::F::splat(0.0),
            },
        );
        let length = L::F::load(&batch.length[at..]);
        Along {
            length,
            crossing: L::F::splat(0.0).lt(length),
            front: [column(&batch.front, 0), column(&batch.front, 1)],
            back: [column(&batch.back, 0), column(&batch.back, 1)],
        }
    }

    #[inline(always)]
    pub fn at(&self, t: L::F) -> [L::F; 2] {
        array(
            #[inline(always)]
            |i| (self.back[i] - self.front[i]).mul_add(t, self.front[i]),
        )
    }
}

impl<L: Lanes> Along<L> {
    /// The part inside a region; all of the segment without one.
    #[inline(always)]
    pub fn inside(&self, region: Option<&LaneRegion>) -> Inside<L> {
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        match region {
            None => Inside { front: self.front, back: self.back, share: one, cut: one.lt(zero) },
            Some(region) => {
                let (t0, t1) = region.clip(self);
                Inside {
                    front: self.at(t0),
                    back: self.at(t1),
                    share: (t1 - t0).max(zero),
                    cut: cuts::<L>(t0, t1),
                }
            }
        }
    }
}

/// The part of a segment inside a region.
pub(crate) struct Inside<L: Lanes> {
    /// (s, g) where it begins.
    pub front: [L::F; 2],
    /// (s, g) where it ends.
    pub back: [L::F; 2],
    /// Its share of the length.
    pub share: L::F,
    /// Whether it is a part only, neither all nor nothing.
    pub cut: L::M,
}

/// Whether the stretch [t₀, t₁] is a part of the segment, neither all nor nothing.
#[inline(always)]
fn cuts<L: Lanes>(t0: L::F, t1: L::F) -> L::M {
    let all = t0.le(L::F::splat(0.0)).and(L::F::splat(1.0).le(t1));
    t0.lt(t1).and(all.not())
}

/// A mask from its bits.
#[inline(always)]
pub(crate) fn lanes_of<L: Lanes>(bits: u32) -> L::M {
    // 2^lane by its float bits, so that no variable shift is needed.
    let power = L::F::from_bits((L::U::iota() + L::U::splat(127)).shl::<23>()).to_unsigned();
    power.test(L::U::splat(bits))
}

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

/// Beyond so many widths the rounding of a segment's ends reaches the square of its distance from the centre:
/// 4e-3 of the depth at 1e6 widths.
pub(crate) const WIDTHS_MOST: f32 = 1e5;

/// exp(−|K (v − centre)|²), K and the centre scaled as the attributes are.
pub(crate) struct LaneGaussian {
    matrix: [[f32; 2]; 2],
    centre: [f32; 2],
    /// Whether a segment can span more than [`WIDTHS_MOST`] widths.
    narrow: bool,
    pub density: f32,
    pub color: [f32; 3],
    pub region: Option<LaneRegion>,
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
                let axis = |a: usize| attributes.get(a).map_or([0.0, 1.0], |x| [x.offset, x.scale]);
                let scale = [axis(0)[1], axis(1)[1]];
                let steepest = matrix.iter().flat_map(|row| [row[0] * scale[0], row[1] * scale[1]]);
                LaneWidget::Gaussian(LaneGaussian {
                    narrow: steepest.map(f64::abs).sum::<f64>() > f64::from(WIDTHS_MOST),
                    matrix: matrix.map(|row| [(row[0] * scale[0]) as f32, (row[1] * scale[1]) as f32]),
                    centre: std::array::from_fn(|a| ((centre[a] - axis(a)[0]) / axis(a)[1]) as f32),
                    density,
                    color,
                    region,
                })
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
            LaneWidget::Wave { wave, density, region, .. } if L::NATIVE => {
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
            LaneWidget::Wave { wave, density, .. } if L::NATIVE => {
                wave.value::<L>(&along.at(t)) * L::F::splat(*density)
            }
            _ => L::F::splat(0.0),
        }
    }
}

impl LaneGaussian {
    #[inline(always)]
    pub fn point<L: Lanes>(&self, v: &[L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        let d = [v[0] - splat(self.centre[0]), v[1] - splat(self.centre[1])];
        array(
            #[inline(always)]
            |i| splat(self.matrix[i][0]).mul_add(d[0], splat(self.matrix[i][1]) * d[1]),
        )
    }

    /// Depth and shape; it jumps where a part of the segment is inside the region.
    #[inline(always)]
    fn shape<L: Lanes>(&self, along: &Along<L>) -> Shape<L> {
        let Inside { front, back, share, cut } = along.inside(self.region.as_ref());
        let peak = L::F::splat(self.density) * along.length * share;
        gaussian::shape::<L, 2>(self.point::<L>(&front), self.point::<L>(&back), peak).cut(cut)
    }

    /// Lanes (bits) on which the segment spans too many widths.
    #[inline(always)]
    fn unsure<L: Lanes>(&self, along: &Along<L>) -> u32 {
        if !self.narrow {
            return 0;
        }
        let (front, back) = (self.point::<L>(&along.front), self.point::<L>(&along.back));
        let step = [back[0] - front[0], back[1] - front[1]];
        let extent = step[0].mul_add(step[0], step[1] * step[1]).sqrt();
        L::F::splat(WIDTHS_MOST).lt(extent).bits()
    }

    #[inline(always)]
    fn density_at<L: Lanes>(&self, along: &Along<L>, t: L::F) -> L::F {
        let q = self.point::<L>(&along.at(t));
        let profile = voltet_lanes::optics::elementary::exp::<L>(-(q[0].mul_add(q[0], q[1] * q[1])));
        L::F::splat(self.density) * profile
    }
}
