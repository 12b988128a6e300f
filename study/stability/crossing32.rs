//! A widget along one segment in 32-bit lanes, of any lane set, for the judge: all lanes hold the same.

use voltet_core::Result;
use voltet_core::optics::Segment;
use voltet_core::optics::clip::{Clip, Stretch};
use voltet_core::optics::piecewise_linear::{Piece, PiecewisePath};
use voltet_core::transfer::{ControlPoint, Profile, Wave, Widget};
use voltet_lanes::optics::clip::LaneStretch;
use voltet_lanes::optics::elementary::{exp, mean_transmittance};
use voltet_lanes::optics::gaussian::{self, LaneGaussianPath, LaneGaussianTrack};
use voltet_lanes::optics::linear;
use voltet_lanes::optics::overlap::{AnyLaneTrack, LaneMember, ordered};
use voltet_lanes::optics::piecewise_linear::{LanePiecewiseTrack, LanePoints};
use voltet_lanes::optics::triangular_gaussian::{self, LaneTriangularTrack};
use voltet_lanes::optics::wave::{LaneBell, LanePhase, LaneWaveTrack};
use voltet_lanes::{Float, Lanes};

/// Lanes of the widest set.
const WIDTH_MOST: usize = 16;

pub(super) fn splat<F: Float>(x: f64) -> F {
    F::splat(x as f32)
}

/// The first lane; the others hold the same.
pub(super) fn lane<F: Float>(x: F) -> f64 {
    let mut values = [f32::NAN; WIDTH_MOST];
    x.store(&mut values);
    f64::from(values[0])
}

/// A widget that the segment crosses.
pub(super) struct Crossing<'a, L: Lanes> {
    pub widget: &'a Widget,
    segment: &'a Segment<'a>,
    stretch: LaneStretch<L>,
    /// D/U.
    scale: f64,
    cutoff: Option<f64>,
    bell: Option<(LaneBell, &'a Wave)>,
    points: Option<LanePoints>,
}

impl<'a, L: Lanes> Crossing<'a, L> {
    /// `None` where the segment has no part inside the region.
    pub fn new(
        widget: &'a Widget,
        segment: &'a Segment<'a>,
        scale: f64,
        cutoff: Option<f64>,
    ) -> Result<Option<Self>> {
        let stretch = match &widget.region {
            None => LaneStretch::whole(),
            Some(region) => cut(&Clip::new(region)?, segment),
        };
        let bell = match &widget.profile {
            Profile::TriangleWave(wave) => Some((LaneBell::triangle(wave), wave)),
            Profile::SineWave(wave) => Some((LaneBell::sine(wave), wave)),
            _ => None,
        };
        let points = match &widget.profile {
            Profile::PiecewiseLinear { points } => Some(LanePoints::new(points, cutoff)),
            _ => None,
        };
        let crossing = Crossing { widget, segment, stretch, scale, cutoff, bell, points };
        Ok((lane(stretch.length) > 0.0).then_some(crossing))
    }

    fn ends(&self, front: L::F, back: L::F) -> [L::F; 2] {
        [self.stretch.at_start(front, back), self.stretch.at_end(front, back)]
    }

    /// ρ₀ D of the clipped stretch.
    fn peak(&self) -> L::F {
        splat::<L::F>(self.scale * self.widget.extinction) * self.stretch.length
    }

    /// q = K (v − v₀) at the segment's ends, for both kinds of Gaussians.
    fn gaussian(&self) -> Option<[[L::F; 8]; 2]> {
        let times = |row: &[f64], v: &[f64], centre: &[f64]| {
            let mut q: L::F = splat(0.0);
            for ((k, v), c) in row.iter().zip(v).zip(centre) {
                q = splat::<L::F>(*k).mul_add(splat(v - c), q);
            }
            q
        };
        let mut q = [[splat(0.0); 8]; 2];
        let s = self.segment;
        match &self.widget.profile {
            Profile::Gaussian { centre, matrix } => {
                for (q, v) in q.iter_mut().zip([s.front, s.back]) {
                    for (q, row) in q.iter_mut().zip(matrix) {
                        *q = times(row, &v, centre);
                    }
                }
            }
            Profile::GaussianNd { centre, matrix, .. } => {
                for (q, v) in q.iter_mut().zip([s.fields_front, s.fields_back]) {
                    for (q, row) in q.iter_mut().zip(matrix) {
                        *q = times(row, v, centre);
                    }
                }
            }
            _ => return None,
        }
        Some(q)
    }

    /// The same at the ends of the clipped stretch.
    fn clipped(&self, [front, back]: [[L::F; 8]; 2]) -> [[L::F; 8]; 2] {
        let mut ends = [front, back];
        for i in 0..8 {
            let [start, end] = self.ends(front[i], back[i]);
            (ends[0][i], ends[1][i]) = (start, end);
        }
        ends
    }

    /// δ and γ at the segment's ends.
    fn triangular(&self) -> Option<[[L::F; 2]; 2]> {
        let Profile::TriangularGaussian { centre, sigma } = &self.widget.profile else { return None };
        let s = self.segment;
        let offset = [splat(s.front[0] - centre), splat(s.back[0] - centre)];
        Some([offset, [splat(sigma * s.front[1]), splat(sigma * s.back[1])]])
    }

    /// Phases at the ends of a stretch, reduced in 64 bits.
    fn phases(&self, wave: &Wave, stretch: &Stretch) -> [LanePhase<L>; 2] {
        let phase = |v: [f64; 2]| {
            ((v[0] - wave.origin[0]) * wave.angle.cos() * wave.scale[0]
                + (v[1] - wave.origin[1]) * wave.angle.sin() * wave.scale[1])
                / wave.period
        };
        let (front, back) = (phase(self.segment.front), phase(self.segment.back));
        [stretch.at_start(front, back), stretch.at_end(front, back)]
            .map(|phase| LanePhase { nearest: splat(phase.round()), offset: splat(phase - phase.round()) })
    }

    /// Bands that the segment crosses, by band width; 0 for other widgets.
    pub fn bands(&self) -> f64 {
        let Some((_, wave)) = &self.bell else { return 0.0 };
        let [front, back] = self.phases(wave, &Stretch::WHOLE);
        (lane(back.nearest) - lane(front.nearest)).abs() / wave.band_width
    }

    /// Whether all that is seen of a wave of the constant-emitter is where its band begins to glow, and that place
    /// is within rounding of where the band begins: the rate there, `cutoff` of its peak, then has few digits. Under
    /// this limit the colour errs by less than 1e-4.
    pub fn sudden(&self, depth: f64) -> bool {
        depth > 30.0 && self.cutoff.is_some_and(|cutoff| self.bands() > 2e4 * cutoff)
    }

    /// T.
    #[inline(never)]
    pub fn depth(&self) -> L::F {
        if let Some(q) = self.gaussian() {
            let [front, back] = self.clipped(q);
            return self.peak() * gaussian::mean_profile::<L, 8>(front, back);
        }
        if let Some([offset, width]) = self.triangular() {
            let (offset, width) = (self.ends(offset[0], offset[1]), self.ends(width[0], width[1]));
            return self.peak() * triangular_gaussian::mean_profile::<L>(offset, width);
        }
        if let Some((bell, wave)) = &self.bell {
            let [front, back] = self.phases(wave, &stretch64(&self.stretch));
            return self.peak() * bell.mean::<L>(front, back);
        }
        if let Profile::PiecewiseLinear { points } = &self.widget.profile {
            return self.piecewise(points).0;
        }
        self.peak()
    }

    /// C of the widget alone on the segment, from its depth and opacity.
    #[inline(never)]
    pub fn color(&self, depth: L::F, opacity: L::F) -> [L::F; 3] {
        if let Profile::PiecewiseLinear { points } = &self.widget.profile {
            return self.piecewise(points).1;
        }
        let lit = match (self.cutoff, self.gaussian(), &self.bell) {
            (None, _, _) => opacity,
            (Some(cutoff), Some(q), _) => {
                let [front, back] = self.clipped(q);
                let light = gaussian::glow::<L, 8>(front, back, self.peak(), -cutoff.ln() as f32);
                splat::<L::F>(self.scale) * self.stretch.length * light
            }
            (Some(cutoff), None, Some((bell, wave))) => {
                let [front, back] = self.phases(wave, &stretch64(&self.stretch));
                splat::<L::F>(self.scale)
                    * self.stretch.length
                    * bell.glow::<L>(front, back, self.peak(), cutoff)
            }
            (Some(_), None, None) if self.triangular().is_some() => {
                return in_order::<L>(&[self.member()], Some(splat(self.scale)));
            }
            (Some(_), None, None) => {
                splat::<L::F>(self.scale) * self.stretch.length * mean_transmittance::<L>(depth)
            }
        };
        self.widget.color.map(|c| splat::<L::F>(c) * lit)
    }

    /// As a member of an ordered integral.
    #[inline(never)]
    pub fn member(&self) -> LaneMember<'_, L> {
        let rate = splat(self.scale * self.widget.extinction);
        let mut window = [splat(-1.0), splat(2.0)];
        let level = self.cutoff.map(|cutoff| -cutoff.ln() as f32);
        let (mut threshold, mut unit_rate) = (self.cutoff.unwrap_or(0.0) as f32, rate);
        let track = if let Some([front, back]) = self.gaussian() {
            let path = LaneGaussianPath::<L>::new(front, back);
            window = level.map_or(window, |level| path.window_ends(level));
            // Within its window it glows, whatever the rounding of the rate.
            threshold = 0.0;
            AnyLaneTrack::Gaussian(LaneGaussianTrack::new(&path, rate))
        } else if let Some([offset, width]) = self.triangular() {
            let track = LaneTriangularTrack { offset, width, peak: rate };
            window = level.map_or(window, |level| track.window_ends(level));
            threshold = 0.0;
            AnyLaneTrack::Triangular(track)
        } else if let Some((bell, wave)) = &self.bell {
            let [front, back] = self.phases(wave, &Stretch::WHOLE);
            AnyLaneTrack::Wave(LaneWaveTrack::new(bell, front, back, rate, self.cutoff))
        } else if let (Some(ready), Profile::PiecewiseLinear { points }) =
            (&self.points, &self.widget.profile)
        {
            let peak = points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak));
            (threshold, unit_rate) = (threshold * peak as f32, splat(self.scale));
            AnyLaneTrack::Piecewise(LanePiecewiseTrack {
                points: ready,
                front: splat(self.segment.front[0] - points[0].s),
                back: splat(self.segment.back[0] - points[0].s),
                scale: splat(self.scale),
            })
        } else {
            AnyLaneTrack::Uniform(rate)
        };
        let color = self.widget.color.map(|c| c as f32);
        let range = [self.stretch.start, self.stretch.end];
        LaneMember { track, range, window, color, threshold, unit_rate }
    }

    /// (T, C) of pieces with linear extinction.
    #[inline(never)]
    fn piecewise(&self, points: &[ControlPoint]) -> (L::F, [L::F; 3]) {
        // From the first control point, so that the rounding of the stretch is one of the span.
        let origin = points[0].s;
        let moved: Vec<ControlPoint> =
            points.iter().map(|p| ControlPoint { s: p.s - origin, ..*p }).collect();
        let (front, back) = (self.segment.front[0] - origin, self.segment.back[0] - origin);
        let path = PiecewisePath::new(&moved, front, back);
        let peak = points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak));
        piecewise::<L>(&path, &stretch64(&self.stretch), self.scale, self.cutoff.map(|cutoff| cutoff * peak))
    }

    /// |K (v_b − v_f)|, the widths of a Gaussian that the segment spans; 0 for other widgets.
    pub fn widths(&self) -> f64 {
        let norm = |rows: &mut dyn Iterator<Item = f64>| rows.map(|x| x * x).sum::<f64>().sqrt();
        let segment = self.segment;
        match &self.widget.profile {
            Profile::Gaussian { matrix, .. } => {
                let delta = [segment.back[0] - segment.front[0], segment.back[1] - segment.front[1]];
                norm(&mut matrix.iter().map(|row| row[0] * delta[0] + row[1] * delta[1]))
            }
            Profile::GaussianNd { matrix, .. } => {
                let delta = |j: usize| segment.fields_back[j] - segment.fields_front[j];
                let along = |row: &Vec<f64>| row.iter().enumerate().map(|(j, k)| k * delta(j)).sum();
                norm(&mut matrix.iter().map(along))
            }
            _ => 0.0,
        }
    }
}

/// [`ordered`], compiled once a lane set: it is the largest kernel of all.
#[inline(never)]
pub(super) fn in_order<L: Lanes>(members: &[LaneMember<L>], unit: Option<L::F>) -> [L::F; 3] {
    ordered::<L>(members, unit)
}

fn cut<L: Lanes>(clip: &Clip, segment: &Segment) -> LaneStretch<L> {
    let mut stretch = LaneStretch::whole();
    clip.distances(segment.front, segment.back, |front, back, _, _| {
        // Only the ratio of the two distances matters: they are brought into the range of 32 bits.
        let size = front.abs().max(back.abs());
        if size > 0.0 {
            stretch = stretch.cut(splat(front / size), splat(back / size));
        }
        true
    });
    stretch
}

fn stretch64<L: Lanes>(stretch: &LaneStretch<L>) -> Stretch {
    Stretch {
        start: lane(stretch.start),
        start_to_back: lane(stretch.start_to_back),
        end: lane(stretch.end),
        end_to_back: lane(stretch.end_to_back),
        length: lane(stretch.length),
    }
}

/// Pieces with linear extinction; `threshold` for the constant-emitter.
fn piecewise<L: Lanes>(
    path: &PiecewisePath,
    stretch: &Stretch,
    scale: f64,
    threshold: Option<f64>,
) -> (L::F, [L::F; 3]) {
    let (mut color, mut depth): ([L::F; 3], L::F) = ([splat(0.0); 3], splat(0.0));
    let unit: L::F = splat(scale);
    path.pieces(stretch, |piece: &Piece| {
        let seen = exp::<L>(-depth);
        let length = unit * splat(piece.share);
        let [a, b] = piece.extinction.map(|e| length * splat(e));
        let (front, back, colors) = match threshold {
            None => {
                let (front, back) = linear::emission_weights::<L>(a, b);
                (front, back, piece.color)
            }
            Some(threshold) => {
                let lit = piece.lit(threshold);
                let share = splat(lit.length);
                let [a, b] = lit.extinction.map(|e| length * share * splat(e));
                let (front, back) = linear::front_back::<L>(a, b);
                let before = exp::<L>(-(length * splat(lit.depth_before)));
                (front * length * share * before, back * length * share * before, lit.color)
            }
        };
        for (i, c) in color.iter_mut().enumerate() {
            let glow = front.mul_add(splat(colors[0][i]), back * splat(colors[1][i]));
            *c = seen.mul_add(glow, *c);
        }
        depth = (a + b).mul_add(splat(0.5), depth);
        true
    });
    (depth, color)
}
