//! A transfer function made ready for integrating many segments.

use super::clip::{Clip, Stretch};
use super::gaussian::GaussianPath;
use super::gaussian_nd::GaussianNd;
use super::overlap::{AnyTrack, Glow, Member, Ordered, Quadrature, ordered};
use super::piecewise_linear::{PiecewisePath, PiecewiseTrack};
use super::sample::Samples;
use super::special::{mean_transmittance, opacity};
use super::table::TablePath;
use super::track::Track;
use super::triangular_gaussian::TriangularPath;
use super::validate::validate;
use super::wave::{Bell, WavePath};
use super::{Contribution, Overlap, Segment};
use crate::Result;
use crate::transfer::{ControlPoint, Profile, Table, TransferFunction};
use std::sync::Arc;

/// A transfer function, checked, with what all its segments share worked out.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// −ln cutoff and cutoff, for the constant-emitter.
    cutoff: Option<Cutoff>,
    unit_distance: f64,
    widgets: Vec<PreparedWidget>,
}

#[derive(Debug, Clone, Copy)]
struct Cutoff {
    share: f64,
    /// −ln share: a Gaussian is lit where |q|² is less.
    level: f64,
}

#[derive(Debug, Clone)]
struct PreparedWidget {
    shape: Shape,
    color: [f64; 3],
    /// Peak extinction; 1 where the shape holds its own.
    extinction: f64,
    clip: Option<Clip>,
}

#[derive(Debug, Clone)]
enum Shape {
    Uniform,
    Gaussian { centre: [f64; 2], matrix: [[f64; 2]; 2] },
    GaussianNd(Box<GaussianNd>),
    Triangular { centre: f64, sigma: f64 },
    Wave(Bell),
    Piecewise { points: Vec<ControlPoint>, peak: f64 },
    Table { table: Arc<Table>, range: Clip },
}

/// One widget along one segment.
#[derive(Debug, Clone, Copy)]
enum Path<'a> {
    Uniform,
    Gaussian(GaussianPath),
    Triangular(TriangularPath),
    Wave(WavePath),
    Piecewise(PiecewisePath<'a>),
    Table(TablePath<'a>),
}

/// A widget that the segment crosses.
#[derive(Debug, Clone, Copy)]
struct Active<'a> {
    widget: &'a PreparedWidget,
    path: Path<'a>,
    stretch: Stretch,
    /// Rate of optical depth per t where the profile is 1.
    peak: f64,
    depth: f64,
}

/// Widgets kept without allocation; more than this many on one segment cost one allocation.
const INLINE: usize = 8;

impl Prepared {
    /// Checks the transfer function and makes it ready.
    pub fn new(transfer_function: &TransferFunction) -> Result<Prepared> {
        validate(transfer_function)?;
        let fields = transfer_function.fields();
        let mut widgets = Vec::with_capacity(transfer_function.widgets.len());
        for widget in &transfer_function.widgets {
            let (shape, extinction) = match &widget.profile {
                Profile::PiecewiseLinear { points } => (
                    Shape::Piecewise {
                        points: points.clone(),
                        peak: points.iter().fold(0.0, |peak, p| p.extinction.max(peak)),
                    },
                    1.0,
                ),
                Profile::Uniform => (Shape::Uniform, widget.extinction),
                Profile::Gaussian { centre, matrix } => {
                    (Shape::Gaussian { centre: *centre, matrix: *matrix }, widget.extinction)
                }
                Profile::GaussianNd { fields: names, centre, matrix } => {
                    let nd = GaussianNd::new(names, centre, matrix, &fields);
                    (Shape::GaussianNd(Box::new(nd)), widget.extinction)
                }
                Profile::TriangularGaussian { centre, sigma } => {
                    (Shape::Triangular { centre: *centre, sigma: *sigma }, widget.extinction)
                }
                Profile::TriangleWave(wave) => (Shape::Wave(Bell::triangle(wave)), widget.extinction),
                Profile::SineWave(wave) => (Shape::Wave(Bell::sine(wave)), widget.extinction),
                Profile::Table(table) => {
                    let range =
                        Clip::Rectangle { low: [table.s[0], table.g[0]], high: [table.s[1], table.g[1]] };
                    (Shape::Table { table: Arc::clone(table), range }, widget.extinction)
                }
            };
            let clip = widget.region.as_ref().map(Clip::new).transpose()?;
            widgets.push(PreparedWidget { shape, color: widget.color, extinction, clip });
        }
        let cutoff = transfer_function.model.cutoff().map(|share| Cutoff { share, level: -share.ln() });
        Ok(Prepared { cutoff, unit_distance: transfer_function.unit_distance, widgets })
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
    pub fn integrate(&self, segment: &Segment, overlap: Overlap) -> Contribution {
        self.integrate_by(segment, overlap, &Ordered)
    }

    /// The segment's contribution with another quadrature where closed forms end.
    pub(super) fn integrate_by<Q: Quadrature>(
        &self,
        segment: &Segment,
        overlap: Overlap,
        quadrature: &Q,
    ) -> Contribution {
        let mut inline: [Option<Active>; INLINE] = [None; INLINE];
        let mut spilled: Vec<Active> = Vec::new();
        let (mut count, mut optical_depth) = (0, 0.0);
        for widget in &self.widgets {
            let Some(active) = self.cross(widget, segment) else { continue };
            if active.depth == 0.0 && self.cutoff.is_none() {
                continue;
            }
            optical_depth += active.depth;
            match inline.get_mut(count) {
                Some(slot) => *slot = Some(active),
                None => spilled.push(active),
            }
            count += 1;
        }
        let active = || inline.iter().flatten().chain(&spilled);
        let opacity = opacity(optical_depth);
        let color = match count {
            0 => [0.0; 3],
            1 => active().next().map_or([0.0; 3], |single| {
                if Q::ALONE && self.is_integrated(single) {
                    quadrature.color(&[self.member(single, segment.length)], self.glow(segment.length))
                } else {
                    self.color_alone(single, segment.length)
                }
            }),
            _ => self.color_together(&active, segment.length, optical_depth, overlap, quadrature),
        };
        Contribution { optical_depth, color, opacity }
    }

    /// The widget along the segment, if the segment has a part inside its region.
    fn cross<'a>(&'a self, widget: &'a PreparedWidget, segment: &Segment) -> Option<Active<'a>> {
        let stretch = match &widget.clip {
            None => Stretch::WHOLE,
            Some(clip) => clip.stretch(segment.front, segment.back)?,
        };
        let (front, back) = (segment.front, segment.back);
        let stretch = match &widget.shape {
            Shape::Table { range, .. } => stretch.intersection(&range.stretch(front, back)?)?,
            _ => stretch,
        };
        let peak = segment.length * widget.extinction / self.unit_distance;
        let path = match &widget.shape {
            Shape::Uniform => Path::Uniform,
            Shape::Gaussian { centre, matrix } => {
                let times = |v: [f64; 2]| {
                    [matrix[0][0] * v[0] + matrix[0][1] * v[1], matrix[1][0] * v[0] + matrix[1][1] * v[1]]
                };
                let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
                Path::Gaussian(GaussianPath::new(
                    times(minus(front, *centre)),
                    times(minus(back, *centre)),
                    times(minus(back, front)),
                ))
            }
            Shape::GaussianNd(nd) => Path::Gaussian(nd.path(segment)),
            // Comparisons with a control point do not tell what is no number.
            Shape::Piecewise { .. } if (back[0] - front[0]).is_nan() => return None,
            Shape::Piecewise { points, .. } => Path::Piecewise(PiecewisePath::new(points, front[0], back[0])),
            Shape::Triangular { centre, sigma } => Path::Triangular(TriangularPath::new(
                [front[0] - centre, back[0] - centre],
                [sigma * front[1], sigma * back[1]],
                peak,
            )),
            Shape::Wave(bell) => Path::Wave(bell.path(front, back)),
            Shape::Table { table, .. } => {
                Path::Table(TablePath::new(table, front, back, peak, self.cutoff.map(|cutoff| cutoff.share)))
            }
        };
        let depth = match &path {
            Path::Uniform => peak * stretch.length,
            Path::Gaussian(path) => path.optical_depth(peak, &stretch),
            Path::Piecewise(path) => peak * path.integral(&stretch),
            Path::Triangular(path) => path.optical_depth(&stretch),
            Path::Wave(path) => peak * path.integral(&stretch),
            Path::Table(path) => path.depth(stretch.start, stretch.length),
        };
        // False also where the values are not numbers.
        (depth >= 0.0 && peak > 0.0).then_some(Active { widget, path, stretch, peak, depth })
    }

    /// C of a widget that is alone on the segment.
    fn color_alone(&self, active: &Active, length: f64) -> [f64; 3] {
        let scale = length / self.unit_distance;
        let Active { widget, stretch, peak, depth, .. } = active;
        if matches!(active.path, Path::Table(_)) {
            return ordered(&[self.member(active, length)], self.glow(length));
        }
        let Some(cutoff) = self.cutoff else {
            return match &active.path {
                Path::Piecewise(path) => path.emission(scale, stretch),
                _ => widget.color.map(|c| c * opacity(*depth)),
            };
        };
        let lit = match &active.path {
            Path::Uniform => stretch.length * mean_transmittance(*depth),
            Path::Gaussian(path) => path.glow(*peak, stretch, cutoff.level),
            Path::Triangular(path) => path.glow(stretch, cutoff.level),
            Path::Wave(path) => path.glow(*peak, stretch, cutoff.share),
            // Drawn above.
            Path::Table(_) => 0.0,
            Path::Piecewise(path) => {
                return path.glow(scale, stretch, self.threshold(widget, cutoff)).map(|c| c * scale);
            }
        };
        widget.color.map(|c| c * scale * lit)
    }

    /// Whether a widget that is alone takes quadrature.
    fn is_integrated(&self, active: &Active) -> bool {
        match active.path {
            Path::Table(_) => true,
            Path::Gaussian(_) | Path::Triangular(_) => self.cutoff.is_some(),
            _ => false,
        }
    }

    /// Extinction or profile above which a widget glows.
    fn threshold(&self, widget: &PreparedWidget, cutoff: Cutoff) -> f64 {
        match &widget.shape {
            Shape::Piecewise { peak, .. } => peak * cutoff.share,
            _ => cutoff.share,
        }
    }

    /// C of several widgets.
    fn color_together<'a, I: Iterator<Item = &'a Active<'a>>>(
        &self,
        active: &impl Fn() -> I,
        length: f64,
        optical_depth: f64,
        overlap: Overlap,
        quadrature: &impl Quadrature,
    ) -> [f64; 3] {
        if self.cutoff.is_none() {
            let first = active().next().map_or([0.0; 3], |a| a.widget.color);
            if active().all(|a| a.has_one_color() && a.widget.color == first) {
                return first.map(|c| c * opacity(optical_depth));
            }
        }
        if overlap == Overlap::Mix || optical_depth < 1e-14 {
            // Kniss et al. 2003, Eq. 15: each widget's own light, dimmed by what all of them absorb on the
            // mean. For one colour and the density-emitter this is c Tᵢ/T (1 − e^(−T)).
            let dimmed = mean_transmittance(optical_depth);
            return active().fold([0.0; 3], |sum, a| {
                let share = dimmed / mean_transmittance(a.depth);
                let alone = self.color_alone(a, length);
                std::array::from_fn(|i| sum[i] + share * alone[i])
            });
        }
        self.with_members(active(), length, |members| quadrature.color(members, self.glow(length)))
    }

    /// Calls `f` with the widgets as tracks, without allocation for up to [`INLINE`] of them.
    fn with_members<'a, R>(
        &self,
        active: impl Iterator<Item = &'a Active<'a>>,
        length: f64,
        f: impl FnOnce(&[Member]) -> R,
    ) -> R {
        let mut inline = [Member::NOTHING; INLINE];
        let mut spilled = Vec::new();
        let mut count = 0;
        for a in active {
            let member = self.member(a, length);
            match inline.get_mut(count) {
                Some(slot) => *slot = member,
                None => {
                    if spilled.is_empty() {
                        spilled.extend_from_slice(&inline);
                    }
                    spilled.push(member);
                }
            }
            count += 1;
        }
        f(if spilled.is_empty() { &inline[..count] } else { &spilled[..] })
    }

    /// Calls `f` with point samples along the segment.
    pub fn sampled<R>(&self, segment: &Segment, f: impl FnOnce(Samples) -> R) -> R {
        let active: Vec<Active> =
            self.widgets.iter().filter_map(|widget| self.cross(widget, segment)).collect();
        let glow = self.glow(segment.length);
        self.with_members(active.iter(), segment.length, |members| f(Samples::new(members, glow)))
    }

    fn glow(&self, length: f64) -> Glow {
        if self.cutoff.is_some() { Glow::Constant(length / self.unit_distance) } else { Glow::Density }
    }

    fn member<'a>(&self, active: &Active<'a>, length: f64) -> Member<'a> {
        let threshold = self.cutoff.map(|cutoff| self.threshold(active.widget, cutoff));
        let mut window = [f64::NEG_INFINITY, f64::INFINITY];
        let track = match active.path {
            Path::Uniform => AnyTrack::Uniform(active.peak),
            Path::Gaussian(path) => {
                if let Some(ends) = self.cutoff.and_then(|cutoff| path.window_ends(cutoff.level)) {
                    window = ends;
                }
                AnyTrack::Gaussian(path.track(active.peak))
            }
            Path::Triangular(path) => {
                if let Some(ends) = self.cutoff.and_then(|cutoff| path.window_ends(cutoff.level)) {
                    window = ends;
                }
                AnyTrack::Triangular(path)
            }
            Path::Wave(path) => AnyTrack::Wave(path.track(active.peak, self.cutoff.map(|c| c.share))),
            Path::Table(path) => AnyTrack::Table(path),
            Path::Piecewise(path) => {
                AnyTrack::Piecewise(PiecewiseTrack { path, scale: length / self.unit_distance, threshold })
            }
        };
        Member {
            track,
            range: [active.stretch.start, active.stretch.end],
            window,
            color: active.widget.color,
            threshold: threshold.unwrap_or(0.0),
            unit_rate: active.peak,
        }
    }
}

impl Active<'_> {
    fn has_one_color(&self) -> bool {
        !matches!(self.path, Path::Piecewise(_) | Path::Table(_))
    }
}
