//! Widgets' integrals from tables in place of closed forms, as printed.
//!
//! Density-emitter (Kniss et al. 2003, sections 4 and 5): the mean of e^(−x²) between both ends is
//! IGauss(x₁, x₂) (Eq. 16), a table of 16-bit numbers over [−10, 10]² whose ends hold on beyond; with K (v − v₀) in
//! several dimensions the path's distance h from the centre gives the factor e^(−h²) (Eq. 11). Triangular Gaussians
//! take the mean of both gradient magnitudes for all of the segment (section 5.2.1). Several widgets are averaged
//! without regard to their order (Eq. 15), whatever `overlap` says.
//!
//! Constant-emitter (Song et al. 2009, section 4.2): the light of a Gaussian from a table over P = ρ₀ D e^(−h²)
//! √π/(2d) and the place x on the path. The paper's ∫ e^(−P erf x) dx and its prefactor leave the range of numbers at
//! P > 709, so kept is J(P, x) = ∫ from x to the table's end of e^(−P (erf u − erf x)) du, which is the same product.
//! Its P ends at 40, where the entry holds on; the light of a stretch is kept between its length and that
//! times the transmittance of all of it.
//!
//! Uniform widgets are closed forms without a table. What waves would take is refused.

use super::{Integrator, SegmentIntegrator, can_serve};
use crate::Result;
use crate::optics::clip::Stretch;
use crate::optics::special::{HALF_SQRT_PI, gaussian_mean, mean_transmittance, opacity};
use crate::optics::{Contribution, Segment};
use crate::transfer::{Convex, OpticalModel, Profile, TransferFunction};

/// Half the side of IGauss's domain, by Kniss et al.
pub const REACH: f64 = 10.0;

/// The largest P of the table of light, and half the range of its places: erf is 1 beyond.
const P_MOST: f64 = 40.0;
const LIT_REACH: f64 = 3.6;

/// The tables, and the widgets made ready.
#[derive(Debug, Clone)]
pub struct Tabulated {
    size: usize,
    /// IGauss × 65535, by (x₁, x₂).
    means: Vec<u16>,
    /// J by (P, x); none for the density-emitter.
    light: Vec<f32>,
    /// −ln cutoff.
    level: f64,
    unit_distance: f64,
    widgets: Vec<Tabled>,
}

#[derive(Debug, Clone)]
struct Tabled {
    color: [f64; 3],
    /// Per world unit.
    extinction: f64,
    clip: Option<Convex>,
    profile: Profile,
    /// Where its own fields lie among the segments', and that of m.
    slots: Vec<usize>,
    magnitude: usize,
}

/// A widget's path in widths: the ends along it, their distance, and its distance from the centre squared.
#[derive(Debug, Clone, Copy)]
struct Path {
    front: f64,
    back: f64,
    offset_squared: f64,
}

impl Tabulated {
    /// Fills the tables. Serves uniform widgets and Gaussians of all kinds; `table_size` ≥ 2 entries a side.
    pub fn new(transfer_function: &TransferFunction, table_size: usize) -> Result<Self> {
        can_serve(&Integrator::Tabulated { table_size }, transfer_function)?;
        transfer_function.check()?;
        let fields = transfer_function.fields();
        let slot = |name: &str| fields.iter().position(|field| *field == name).unwrap_or(0);
        let mut widgets = Vec::new();
        for widget in &transfer_function.widgets {
            let (slots, magnitude) = match &widget.profile {
                Profile::GaussianNd { fields, .. } => (fields.iter().map(|name| slot(name)).collect(), 0),
                Profile::TriangularGaussianNd { fields, magnitude, .. } => {
                    (fields.iter().map(|name| slot(name)).collect(), slot(magnitude))
                }
                _ => (Vec::new(), 0),
            };
            widgets.push(Tabled {
                color: widget.color,
                extinction: widget.extinction / transfer_function.unit_distance,
                clip: widget.region.as_ref().map(Convex::new).transpose()?,
                profile: widget.profile.clone(),
                slots,
                magnitude,
            });
        }
        let cutoff = transfer_function.model.cutoff();
        let light = match transfer_function.model {
            OpticalModel::DensityEmitter => Vec::new(),
            OpticalModel::ConstantEmitter { .. } => light(table_size),
        };
        Ok(Tabulated {
            size: table_size,
            means: means(table_size),
            light,
            level: cutoff.map_or(0.0, |cutoff| -cutoff.ln()),
            unit_distance: transfer_function.unit_distance,
            widgets,
        })
    }

    /// IGauss: the mean of e^(−x²) between two places.
    fn mean(&self, front: f64, back: f64) -> f64 {
        let place = |x: f64| (x + REACH) / (2.0 * REACH);
        bilinear(self.size, place(front), place(back), |k| f64::from(self.means[k])) / f64::from(u16::MAX)
    }

    /// J(P, x).
    fn lit(&self, p: f64, x: f64) -> f64 {
        let place = (x + LIT_REACH) / (2.0 * LIT_REACH);
        bilinear(self.size, p / P_MOST, place, |k| f64::from(self.light[k]))
    }

    /// ∫ e^(−T) dt over the part of a path where it glows; T counts from its start, through `depth` in all.
    fn glow(&self, path: Option<Path>, length: f64, depth: f64, rate: f64) -> f64 {
        let Some(Path { front, back, offset_squared }) = path else {
            return length * mean_transmittance(depth);
        };
        let room = self.level - offset_squared;
        let (span, half) = (back - front, room.max(0.0).sqrt());
        if room <= 0.0 {
            return 0.0;
        }
        if span <= 0.0 {
            return if front.abs() < half { length * mean_transmittance(depth) } else { 0.0 };
        }
        let (start, end) = (front.max(-half), back.min(half));
        if start >= end {
            return 0.0;
        }
        let scale = rate * (-offset_squared).exp();
        let depth_of = |from: f64, to: f64| scale * (to - from) / span * self.mean(from, to);
        let before = depth_of(front, start);
        let within = depth_of(start, end);
        let p = scale * HALF_SQRT_PI / span;
        let found = self.lit(p, start) - (-within).exp() * self.lit(p, end);
        let lit = end - start;
        length * (-before).exp() * found.clamp(lit * (-within).exp(), lit) / span
    }
}

impl SegmentIntegrator for Tabulated {
    fn table_bytes(&self) -> usize {
        size_of_val(self.means.as_slice()) + size_of_val(self.light.as_slice())
    }

    fn integrate(&self, segment: &Segment) -> Contribution {
        let (mut depth, mut color) = (0.0, [0.0; 3]);
        for widget in &self.widgets {
            let stretch = match &widget.clip {
                None => Stretch::WHOLE,
                Some(clip) => match Stretch::within(clip, segment.front, segment.back) {
                    Some(stretch) => stretch,
                    None => continue,
                },
            };
            let Some(path) = widget.path(segment, &stretch) else { continue };
            let rate = widget.extinction * segment.length * stretch.length;
            let mean =
                path.map_or(1.0, |path| self.mean(path.front, path.back) * (-path.offset_squared).exp());
            let own = rate * mean;
            if !(own >= 0.0 && rate > 0.0) {
                continue;
            }
            // Light over E₁ of the widget's own depth, for Eq. 15.
            let light = match self.light.is_empty() {
                true => own,
                false => {
                    let scale = segment.length / self.unit_distance;
                    scale * self.glow(path, stretch.length, own, rate) / mean_transmittance(own)
                }
            };
            depth += own;
            for (sum, c) in color.iter_mut().zip(widget.color) {
                *sum += c * light;
            }
        }
        let dimmed = mean_transmittance(depth);
        Contribution { optical_depth: depth, color: color.map(|c| c * dimmed), opacity: opacity(depth) }
    }
}

impl Tabled {
    /// The widget's path over a stretch; `Some(None)` where its profile is 1, `None` where it is nothing.
    fn path(&self, segment: &Segment, stretch: &Stretch) -> Option<Option<Path>> {
        let of = |values: &[f64]| -> Vec<f64> { self.slots.iter().map(|&slot| values[slot]).collect() };
        let ends = || (of(segment.fields_front), of(segment.fields_back));
        let moved = |matrix: &[Vec<f64>], centre: &[f64], value: &[f64]| -> Vec<f64> {
            let row = |row: &Vec<f64>| row.iter().zip(value).zip(centre).map(|((k, v), c)| k * (v - c)).sum();
            matrix.iter().map(row).collect()
        };
        let (front, back): (Vec<f64>, Vec<f64>) = match &self.profile {
            Profile::Uniform => return Some(None),
            Profile::Gaussian { centre, matrix } => {
                let matrix = matrix.map(|row| row.to_vec());
                (moved(&matrix, centre, &segment.front), moved(&matrix, centre, &segment.back))
            }
            Profile::GaussianNd { centre, matrix, .. } => {
                let (front, back) = ends();
                (moved(matrix, centre, &front), moved(matrix, centre, &back))
            }
            Profile::TriangularGaussian { centre, sigma } => {
                let width = sigma * 0.5 * (segment.front[1] + segment.back[1]);
                let place = |s: f64| vec![(s - centre) / width];
                if width <= 0.0 || width.is_nan() {
                    return None;
                }
                (place(segment.front[0]), place(segment.back[0]))
            }
            Profile::TriangularGaussianNd { centre, matrix, .. } => {
                let (front, back) = ends();
                let m = |values: &[f64]| values[self.magnitude];
                let width = 0.5 * (m(segment.fields_front) + m(segment.fields_back));
                if width <= 0.0 || width.is_nan() {
                    return None;
                }
                let place = |v: &[f64]| moved(matrix, centre, v).into_iter().map(|x| x / width).collect();
                (place(&front), place(&back))
            }
            Profile::TriangleWave(_)
            | Profile::SineWave(_)
            | Profile::PiecewiseLinear { .. }
            | Profile::Table(_) => return None,
        };
        let at = |cut: fn(&Stretch, f64, f64) -> f64| -> Vec<f64> {
            front.iter().zip(&back).map(|(f, b)| cut(stretch, *f, *b)).collect()
        };
        let path = Path::between(&at(Stretch::at_start), &at(Stretch::at_end));
        (path.front + path.back + path.offset_squared).is_finite().then_some(Some(path))
    }
}

impl Path {
    /// Kniss et al. 2003, Eq. 11: A and B along the path, and |v₁'|² − A², here without its cancellation.
    fn between(front: &[f64], back: &[f64]) -> Path {
        let dot = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(x, y)| x * y).sum::<f64>();
        let along: Vec<f64> = front.iter().zip(back).map(|(f, b)| b - f).collect();
        let length = dot(&along, &along).sqrt();
        if length == 0.0 {
            return Path { front: 0.0, back: 0.0, offset_squared: dot(front, front) };
        }
        let unit: Vec<f64> = along.iter().map(|x| x / length).collect();
        let (a, b) = (dot(front, &unit), dot(back, &unit));
        let (near, x) = if a.abs() <= b.abs() { (front, a) } else { (back, b) };
        let offset_squared = near.iter().zip(&unit).map(|(q, e)| (q - x * e).powi(2)).sum();
        Path { front: a, back: b, offset_squared }
    }
}

/// IGauss in 16 bits.
fn means(size: usize) -> Vec<u16> {
    let place = |k: usize| REACH * (2.0 * k as f64 / (size - 1) as f64 - 1.0);
    let entry = |k: usize| {
        let (a, b) = (place(k / size), place(k % size));
        let (mean, exponent) = gaussian_mean(a.min(b), a.max(b), (b - a).abs());
        (mean * (-exponent).exp() * f64::from(u16::MAX)).round() as u16
    };
    (0..size * size).map(entry).collect()
}

/// J, from its end backward: each step adds ∫ e^(−P (erf u − erf x)) du over it to what is behind, dimmed.
fn light(size: usize) -> Vec<f32> {
    /// Parts of a step that Simpson's rule is taken over.
    const PARTS: usize = 4;
    let step = 2.0 * LIT_REACH / (size - 1) as f64;
    let place = |k: usize| k as f64 * step - LIT_REACH;
    let mut entries = vec![0.0; size * size];
    for (row, entries) in entries.chunks_exact_mut(size).enumerate() {
        let p = P_MOST * row as f64 / (size - 1) as f64;
        let mut behind = 0.0;
        for k in (0..size - 1).rev() {
            let x = place(k);
            let seen = |u: f64| (-p * (libm::erf(u) - libm::erf(x))).exp();
            let h = step / PARTS as f64;
            let simpson = |i: usize| {
                let u = x + i as f64 * h;
                h / 6.0 * (seen(u) + 4.0 * seen(u + 0.5 * h) + seen(u + h))
            };
            behind = seen(x + step) * behind + (0..PARTS).map(simpson).sum::<f64>();
            entries[k] = behind as f32;
        }
    }
    entries
}

/// A square table read at places from 0 to 1, which hold on beyond.
fn bilinear(size: usize, row: f64, column: f64, entry: impl Fn(usize) -> f64) -> f64 {
    let last = (size - 1) as f64;
    let split = |place: f64| {
        let place = (place * last).clamp(0.0, last);
        let low = (place as usize).min(size - 2);
        (low, place - low as f64)
    };
    let ((i, u), (j, v)) = (split(row), split(column));
    let at = |di: usize, dj: usize| entry((i + di) * size + j + dj);
    let (low, high) = (at(0, 0) + v * (at(0, 1) - at(0, 0)), at(1, 0) + v * (at(1, 1) - at(1, 0)));
    low + u * (high - low)
}
