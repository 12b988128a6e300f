//! The 32-bit twins as a set of forms: differences from a widget's own origin are formed in 64 bits, rounded,
//! and everything after that runs in 32-bit lanes.

use super::bounds::Precision;
use super::forms::{Chain, Forms, PartialIntegrals};
use crate::Result;
use crate::lanes::{Float, Lanes, Portable};
use crate::optics::clip::{Clip, Stretch};
use crate::optics::lanes::clip::LaneStretch;
use crate::optics::lanes::elementary::{exp, mean_transmittance, one_minus_exp};
use crate::optics::lanes::gaussian::mean_profile;
use crate::optics::lanes::linear;
use crate::optics::lanes::wave::{LaneBell, LanePhase};
use crate::optics::piecewise_linear::{Piece, PiecewisePath};
use crate::optics::{Contribution, Overlap, Prepared, Segment};
use crate::transfer::{OpticalModel, Profile, TransferFunction, Wave, Widget};

/// Widths that a segment may span. Beyond it the rounding of the ends (6e-8 of the span) moves the path by a
/// share of a width, which enters h² squared: 1e-5 at this limit. As in the engine, the 64-bit form takes over.
const WIDTHS_MOST: f64 = 1e5;

/// The 32-bit twins. They serve one widget at a time: the density-emitter with every widget that has a twin, the
/// constant-emitter with uniform and piecewise-linear widgets.
#[derive(Debug, Clone, Copy, Default)]
pub struct Native32;

type P = Portable;
type F = <P as Lanes>::F;

fn splat(x: f64) -> F {
    F::splat(x as f32)
}

/// The first lane; the others hold the same.
fn lane(x: F) -> f64 {
    let mut values = [f32::NAN; P::WIDTH];
    x.store(&mut values);
    f64::from(values[0])
}

impl Forms for Native32 {
    fn name(&self) -> &str {
        "32-bit"
    }

    fn precision(&self) -> Precision {
        Precision::F32
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: Overlap,
    ) -> Result<Option<Contribution>> {
        Prepared::new(transfer_function)?;
        let [widget] = transfer_function.widgets.as_slice() else { return Ok(None) };
        let scale = segment.length / transfer_function.unit_distance;
        let range = f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX) / 4.0;
        if !range.contains(&(scale * widget.extinction.max(1.0))) || !range.contains(&scale) {
            return Ok(None);
        }
        let clipped = match &widget.region {
            None => LaneStretch::<P>::whole(),
            Some(region) => cut(&Clip::new(region)?, segment),
        };
        if lane(clipped.length) <= 0.0 {
            return Ok(Some(Contribution::default()));
        }
        if widths(widget, segment) > WIDTHS_MOST && transfer_function.model == OpticalModel::DensityEmitter {
            let found = Prepared::new(transfer_function)?.integrate(segment, overlap);
            let round = |x: f64| f64::from(x as f32);
            return Ok(Some(Contribution {
                optical_depth: round(found.optical_depth),
                color: found.color.map(round),
                opacity: round(found.opacity),
            }));
        }
        let color = widget.color.map(splat);
        let constant = transfer_function.model != OpticalModel::DensityEmitter;
        if let Profile::PiecewiseLinear { points } = &widget.profile {
            let peak = points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak));
            let threshold = match transfer_function.model {
                OpticalModel::ConstantEmitter { cutoff } => Some(cutoff * peak),
                OpticalModel::DensityEmitter => None,
            };
            let path = PiecewisePath::new(points, segment.front[0], segment.back[0]);
            return Ok(Some(piecewise(&path, &stretch64(&clipped), scale, threshold)));
        }
        let Some(mean) = mean(widget, segment, &clipped) else { return Ok(None) };
        let peak = splat(scale * widget.extinction) * clipped.length;
        let depth = peak * mean;
        let opacity = one_minus_exp::<P>(depth);
        let glow = if !constant {
            opacity
        } else if widget.profile == Profile::Uniform {
            splat(scale) * clipped.length * mean_transmittance::<P>(depth)
        } else {
            return Ok(None);
        };
        Ok(Some(Contribution {
            optical_depth: lane(depth),
            color: color.map(|c| lane(c * glow)),
            opacity: lane(opacity),
        }))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let (mut color, mut opacity, mut transparency) = ([splat(0.0); 3], splat(0.0), splat(1.0));
        for segment in segments {
            for (sum, c) in color.iter_mut().zip(segment.color) {
                *sum = transparency.mul_add(splat(c), *sum);
            }
            opacity = transparency.mul_add(splat(segment.opacity), opacity);
            transparency = transparency * (splat(1.0) - splat(segment.opacity));
        }
        let transparency = lane(transparency);
        let opacity = lane(opacity);
        let opacity = if opacity < 0.5 { opacity } else { 1.0 - transparency };
        Chain { color: color.map(lane), opacity, transparency }
    }

    fn partial(&self, a: f64, b: f64) -> PartialIntegrals {
        let (fa, fb) = (splat(a), splat(b));
        let (front, back) = linear::front_back::<P>(fa, fb);
        let zeta = exp::<P>(splat(-0.5 * (a + b)));
        PartialIntegrals {
            psi: lane(linear::psi::<P>(fa, fb)),
            front: lane(front),
            back: lane(back),
            zeta: lane(zeta),
        }
    }
}

fn cut(clip: &Clip, segment: &Segment) -> LaneStretch<P> {
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

fn stretch64(stretch: &LaneStretch<P>) -> Stretch {
    Stretch {
        start: lane(stretch.start),
        start_to_back: lane(stretch.start_to_back),
        end: lane(stretch.end),
        end_to_back: lane(stretch.end_to_back),
        length: lane(stretch.length),
    }
}

/// |K (v_b − v_f)|, the widths of a Gaussian that the segment spans; 0 for other widgets.
fn widths(widget: &Widget, segment: &Segment) -> f64 {
    let norm = |rows: &mut dyn Iterator<Item = f64>| rows.map(|x| x * x).sum::<f64>().sqrt();
    match &widget.profile {
        Profile::Gaussian { matrix, .. } => {
            let delta = [segment.back[0] - segment.front[0], segment.back[1] - segment.front[1]];
            norm(&mut matrix.iter().map(|row| row[0] * delta[0] + row[1] * delta[1]))
        }
        Profile::GaussianNd { matrix, .. } => {
            let delta = |j: usize| segment.fields_back[j] - segment.fields_front[j];
            norm(&mut matrix.iter().map(|row| row.iter().enumerate().map(|(j, k)| k * delta(j)).sum()))
        }
        _ => 0.0,
    }
}

/// Mean of the profile over the stretch; `None` where there is no twin.
fn mean(widget: &Widget, segment: &Segment, stretch: &LaneStretch<P>) -> Option<F> {
    let ends = |front: F, back: F| (stretch.at_start(front, back), stretch.at_end(front, back));
    match &widget.profile {
        Profile::Uniform => Some(splat(1.0)),
        Profile::Gaussian { centre, matrix } => {
            let q = |v: [f64; 2]| {
                let delta = [splat(v[0] - centre[0]), splat(v[1] - centre[1])];
                matrix.map(|row| splat(row[0]).mul_add(delta[0], splat(row[1]) * delta[1]))
            };
            let (front, back) = (q(segment.front), q(segment.back));
            let pairs = [ends(front[0], back[0]), ends(front[1], back[1])];
            Some(mean_profile::<P, 2>(pairs.map(|p| p.0), pairs.map(|p| p.1)))
        }
        Profile::GaussianNd { centre, matrix, .. } => {
            let q = |v: &[f64]| {
                let mut q = [splat(0.0); 8];
                for (q, row) in q.iter_mut().zip(matrix) {
                    for ((k, v), c) in row.iter().zip(v).zip(centre) {
                        *q = splat(*k).mul_add(splat(v - c), *q);
                    }
                }
                q
            };
            Some(mean_profile::<P, 8>(q(segment.fields_front), q(segment.fields_back)))
        }
        Profile::TriangleWave(wave) => Some(wave_mean(&LaneBell::triangle(wave), wave, segment, stretch)),
        Profile::SineWave(wave) => Some(wave_mean(&LaneBell::sine(wave), wave, segment, stretch)),
        _ => None,
    }
}

fn wave_mean(bell: &LaneBell, wave: &Wave, segment: &Segment, stretch: &LaneStretch<P>) -> F {
    let phase = |v: [f64; 2]| {
        ((v[0] - wave.origin[0]) * wave.angle.cos() * wave.scale[0]
            + (v[1] - wave.origin[1]) * wave.angle.sin() * wave.scale[1])
            / wave.period
    };
    let (front, back) = (phase(segment.front), phase(segment.back));
    let s = stretch64(stretch);
    let place =
        |phase: f64| LanePhase::<P> { nearest: splat(phase.round()), offset: splat(phase - phase.round()) };
    bell.mean::<P>(place(s.at_start(front, back)), place(s.at_end(front, back)))
}

/// Pieces with linear extinction; `threshold` for the constant-emitter.
fn piecewise(path: &PiecewisePath, stretch: &Stretch, scale: f64, threshold: Option<f64>) -> Contribution {
    let (mut color, mut depth) = ([splat(0.0); 3], splat(0.0));
    let unit = splat(scale);
    path.pieces(stretch, |piece: &Piece| {
        let seen = exp::<P>(-depth);
        let length = unit * splat(piece.share);
        let [a, b] = piece.extinction.map(|e| length * splat(e));
        let (front, back, colors) = match threshold {
            None => {
                let (front, back) = linear::emission_weights::<P>(a, b);
                (front, back, piece.color)
            }
            Some(threshold) => {
                let lit = piece.lit(threshold);
                let share = splat(lit.length);
                let [a, b] = lit.extinction.map(|e| length * share * splat(e));
                let (front, back) = linear::front_back::<P>(a, b);
                let before = exp::<P>(-(length * splat(lit.depth_before)));
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
    let opacity = one_minus_exp::<P>(depth);
    Contribution { optical_depth: lane(depth), color: color.map(lane), opacity: lane(opacity) }
}
