//! One widget on one stretch: a smooth function of u ∈ [0, 1].
//!
//! Each is stated by numbers at the stretch's ends, none of which comes from a difference of doubles: an extinction
//! that begins at 0 is right to the last digits however near to there it is looked at.
//!
//! A segment laid out: the stretches between its cuts, and what each widget is on them.

use crate::features::NOTHING;
use crate::linear_on_segment::{Cuts, End, LinearOnSegment, Place, Wide};
use crate::term::{ReadyProfile, Term};
use std::cell::LazyCell;
use std::f64::consts::FRAC_PI_2;
use voltet_core::Result;
use voltet_core::transfer::ControlPoint;

/// A widget on a stretch; its numbers stand in a list of the workspace.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) term: u32,
    /// True if it is above the cutoff of the constant-emitter.
    pub(crate) glows: bool,
    kind: Kind,
    first: u32,
    last: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// The profile at both ends, linear between.
    Linear,
    /// Extinction and colour at both ends, linear between.
    LinearColors,
    /// Bernstein coefficients of alpha and colour.
    Quadratic,
    /// Each coordinate at both ends.
    Gaussian,
    /// Each coordinate at both ends, the width at both ends.
    Triangular,
    /// Distance from the foot, in φ, at both ends, and the band width.
    Sine,
}

impl Term {
    /// Part of the widget between two cuts, where its coordinates are `from` and `to`; `None` if it neither absorbs
    /// nor glows. `number`: of the term. `cutoff`: the constant-emitter's.
    pub(crate) fn on_stretch(
        &self,
        number: usize,
        [from, to]: [&[Wide]; 2],
        cutoff: Option<f64>,
        numbers: &mut Vec<f64>,
    ) -> Option<Part> {
        let first = numbers.len();
        let reach = cutoff.map_or(0.0, |cutoff| -cutoff.ln());
        let ends = |k: usize| [from[k].value(), to[k].value()];
        let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
        let above = |profile: f64| cutoff.is_some_and(|cutoff| profile > cutoff);
        let (kind, absorbs, glows) = match &self.shape {
            ReadyProfile::Uniform => {
                numbers.extend([1.0, 1.0]);
                (Kind::Linear, true, above(1.0))
            }
            ReadyProfile::Gaussian(_) => {
                numbers.extend((0..from.len()).flat_map(ends));
                let square = |at: &dyn Fn([f64; 2]) -> f64| -> f64 {
                    (0..from.len()).map(|k| at(ends(k)).powi(2)).sum()
                };
                // A cut lies at the nearest place, unless all of the path is within a width or two.
                let nearest = square(&|e| e[0]).min(square(&|e| e[1])).sqrt();
                (Kind::Gaussian, nearest < NOTHING + 2.0, square(&middle) < reach)
            }
            ReadyProfile::Triangular(..) => {
                let count = from.len() - 1;
                let width = ends(count);
                if middle(width) <= 0.0 {
                    return None;
                }
                numbers.extend((0..count).flat_map(ends));
                numbers.extend(width.map(|w| w.max(0.0)));
                let square =
                    |at: &dyn Fn([f64; 2]) -> f64| -> f64 { (0..count).map(|k| at(ends(k)).powi(2)).sum() };
                let at_middle = square(&middle);
                let beyond = |k: usize| square(&|e| e[k]).sqrt() >= NOTHING * width[k] && at_middle != 0.0;
                let glows = at_middle < reach * middle(width).powi(2);
                (Kind::Triangular, !(beyond(0) && beyond(1)), glows)
            }
            ReadyProfile::Bands(bands) => {
                let peak = (from[0] + to[0]).half().floor() + 0.5;
                let from_foot =
                    |phase: Wide| (Wide::from(bands.half) - (phase - Wide::from(peak)).abs()).value();
                let feet = [from_foot(from[0]).max(0.0), from_foot(to[0]).max(0.0)];
                if from_foot((from[0] + to[0]).half()) <= 0.0 {
                    return None;
                }
                let kind = if bands.sine {
                    numbers.extend(feet.into_iter().chain([bands.band_width]));
                    Kind::Sine
                } else {
                    numbers.extend(feet.map(|y| 2.0 * y / bands.band_width));
                    Kind::Linear
                };
                let lit = cutoff.map_or(0.0, |cutoff| bands.half_width(cutoff));
                (kind, true, bands.half - middle(feet) < lit)
            }
            ReadyProfile::Linear { points, peak } => {
                let ends = between_points(points, from[0], to[0]);
                numbers.extend(ends.as_flattened());
                let [front, back] = [ends[0][0], ends[1][0]];
                (Kind::LinearColors, front.max(back) > 0.0, above(middle([front, back]) / peak))
            }
            ReadyProfile::Table(texels) => {
                let patch = texels.patch([from[0], from[1]], [to[0], to[1]]);
                numbers.extend(patch.as_flattened());
                let [p, q, r] = patch.map(|channels| channels[0]);
                (Kind::Quadratic, p.max(q).max(r) > 0.0, above(0.25 * (p + 2.0 * q + r)))
            }
        };
        if !absorbs && !glows {
            numbers.truncate(first);
            return None;
        }
        Some(Part { term: number as u32, glows, kind, first: first as u32, last: numbers.len() as u32 })
    }
}

/// Extinction and colour at both ends of a stretch that lies between two control points.
fn between_points(points: &[ControlPoint], from: Wide, to: Wide) -> [[f64; 4]; 2] {
    let of = |p: &ControlPoint| [p.extinction, p.color[0], p.color[1], p.color[2]];
    let middle = (from + to).half();
    let after = points.partition_point(|p| Wide::from(p.s).order(middle).is_le());
    if after == 0 {
        return [of(&points[0]); 2];
    }
    let before = &points[after - 1];
    let Some(behind) = points.get(after) else { return [of(before); 2] };
    let apart = Wide::difference(behind.s, before.s).value();
    [from, to].map(|s| {
        // Each from its own point: what is 0 at one of them keeps its digits there.
        let weight = |distance: Wide| (distance.value() / apart).clamp(0.0, 1.0);
        let [low, high] = [weight(Wide::from(behind.s) - s), weight(s - Wide::from(before.s))];
        let (before, behind) = (of(before), of(behind));
        std::array::from_fn(|c| low * before[c] + high * behind[c])
    })
}

impl Part {
    /// ρ (1/L) at each u.
    pub(crate) fn extinction(&self, term: &Term, numbers: &[f64], places: &[f64], out: &mut [f64]) {
        let numbers = self.numbers(numbers);
        let mut each = |profile: &dyn Fn(f64, f64) -> f64| {
            for (out, u) in out.iter_mut().zip(places) {
                *out = term.peak * profile(*u, 1.0 - u);
            }
        };
        match (self.kind, numbers) {
            (Kind::Linear, [front, back]) => each(&|u, v| front * v + back * u),
            (Kind::Gaussian, [front, back]) => each(&|u, v| (-(front * v + back * u).powi(2)).exp()),
            (Kind::Gaussian, [a, b, c, d]) => {
                each(&|u, v| (-((a * v + b * u).powi(2) + (c * v + d * u).powi(2))).exp());
            }
            (Kind::Gaussian, _) => each(&|u, v| {
                let square: f64 = numbers.chunks_exact(2).map(|q| (q[0] * v + q[1] * u).powi(2)).sum();
                (-square).exp()
            }),
            (Kind::Triangular, [a, b, c, d]) => each(&|u, v| {
                let width = c * v + d * u;
                if width > 0.0 { (-((a * v + b * u) / width).powi(2)).exp() } else { 0.0 }
            }),
            (Kind::Triangular, [offsets @ .., c, d]) => each(&|u, v| {
                let width = c * v + d * u;
                let square: f64 =
                    offsets.chunks_exact(2).map(|q| ((q[0] * v + q[1] * u) / width).powi(2)).sum();
                if width > 0.0 { (-square).exp() } else { 0.0 }
            }),
            // With y the distance from the foot and h that of the peak: (cos π(h − y) − cos πh)/w, cos πh = 1 − w.
            (Kind::Sine, [front, back, width]) => {
                let sin_half = (width * (2.0 - width)).sqrt();
                each(&|u, v| {
                    let sin = (FRAC_PI_2 * (front * v + back * u)).sin();
                    2.0 / width * sin * (sin_half * (1.0 - sin * sin).sqrt() - (1.0 - width) * sin)
                });
            }
            _ => each(&|u, v| self.channel(numbers, 0, u, v)),
        }
    }

    pub(crate) fn has_colors(&self) -> bool {
        matches!(self.kind, Kind::LinearColors | Kind::Quadratic)
    }

    /// Linear RGB at u.
    pub(crate) fn color(&self, term: &Term, numbers: &[f64], u: f64) -> [f64; 3] {
        if !self.has_colors() {
            return term.color;
        }
        let numbers = self.numbers(numbers);
        std::array::from_fn(|c| self.channel(numbers, c + 1, u, 1.0 - u))
    }

    fn numbers<'a>(&self, numbers: &'a [f64]) -> &'a [f64] {
        &numbers[self.first as usize..self.last as usize]
    }

    /// Extinction or alpha (0) or a colour's component at u = 1 − v.
    fn channel(&self, numbers: &[f64], channel: usize, u: f64, v: f64) -> f64 {
        let at = |k: usize| numbers[4 * k + channel];
        match self.kind {
            Kind::LinearColors => at(0) * v + at(1) * u,
            _ => at(0) * v * v + at(1) * (2.0 * u * v) + at(2) * u * u,
        }
    }
}

/// A part of the segment on which every widget is smooth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    /// Share of the segment's length.
    pub(crate) share: f64,
    /// Its begin, as a share of the length: for messages.
    pub(crate) begin: f64,
    /// It lies between two features that are too near to each other for its length to be known.
    pub(crate) blurred: bool,
    first: u32,
    last: u32,
}

/// The widgets that a segment meets, stretch by stretch. Buffers that are kept from segment to segment.
#[derive(Default)]
pub(crate) struct Layout {
    pub(crate) stretches: Vec<Interval>,
    parts: Vec<Part>,
    numbers: Vec<f64>,
    /// Coordinates of the widgets that the segment meets.
    along: Vec<LinearOnSegment>,
    met: Vec<ActiveWidget>,
    cuts: Cuts,
    ends: Vec<End>,
    from: Vec<Wide>,
    to: Vec<Wide>,
}

/// A widget that the segment meets.
struct ActiveWidget {
    term: usize,
    window: [Place; 2],
    /// True if the window is all of the segment.
    everywhere: bool,
    end: usize,
}

impl Layout {
    /// Lays out the segment from `front` to `back` (each [s, g, fields …]); stretches without a widget are left out.
    pub(crate) fn lay_out(
        &mut self,
        terms: &[Term],
        front: &[f64],
        back: &[f64],
        cutoff: Option<f64>,
    ) -> Result<()> {
        self.along.clear();
        self.met.clear();
        self.cuts.clear();
        for (number, term) in terms.iter().enumerate() {
            let Some(window) = term.window(front, back) else { continue };
            let start = self.along.len();
            term.coordinates(front, back, &mut self.along);
            self.cuts.begin(window);
            term.features(&self.along[start..], cutoff, &mut self.cuts)?;
            let everywhere = window == [Place::FRONT, Place::BACK];
            self.met.push(ActiveWidget { term: number, window, everywhere, end: self.along.len() });
        }
        self.cuts.ends(&mut self.ends);
        self.stretches.clear();
        self.parts.clear();
        self.numbers.clear();
        values(&self.along, Place::FRONT, &mut self.to);
        for pair in self.ends.windows(2) {
            let [from, to] = [pair[0].place, pair[1].place];
            std::mem::swap(&mut self.from, &mut self.to);
            values(&self.along, to, &mut self.to);
            let middle = LazyCell::new(|| from.middle(to));
            let parts = self.parts.len();
            let mut start = 0;
            for met in &self.met {
                let range = std::mem::replace(&mut start, met.end)..met.end;
                // Between two cuts no edge is passed, so the middle speaks for the whole stretch.
                if met.everywhere || met.window[0].is_before(*middle) && middle.is_before(met.window[1]) {
                    let ends = [&self.from[range.clone()], &self.to[range]];
                    self.parts.extend(terms[met.term].on_stretch(met.term, ends, cutoff, &mut self.numbers));
                }
            }
            if self.parts.len() > parts {
                self.stretches.push(Interval {
                    share: from.distance_to(to).value(),
                    begin: from.share(),
                    blurred: pair[1].blurred,
                    first: parts as u32,
                    last: self.parts.len() as u32,
                });
            }
        }
        Ok(())
    }

    pub(crate) fn parts(&self, stretch: &Interval) -> &[Part] {
        &self.parts[stretch.first as usize..stretch.last as usize]
    }

    /// The numbers that parts are stated by.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.numbers
    }
}

fn values(along: &[LinearOnSegment], place: Place, out: &mut Vec<Wide>) {
    out.clear();
    out.extend(along.iter().map(|a| a.at(place)));
}
