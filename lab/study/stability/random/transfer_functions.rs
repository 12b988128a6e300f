//! RandomReport transfer functions over the values that a volume has, and random shading.

use super::rng::Rng;
use super::volumes::{FIELDS, MAGNITUDE};
use std::sync::Arc;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_core::volume::Volume;
use voltet_optics::WidgetBlend;
use voltet_optics::shading::{Integrator, Light, Shading};

/// A value that the data have, and how far they range; where they do not, the size of the value, or 1.
struct Axis {
    values: Vec<f64>,
    range: f64,
}

impl Axis {
    fn new(values: &[f64]) -> Axis {
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
        // A range of rounding errors is none.
        let range = if high - low > 1e-11 * high.abs().max(low.abs()) { high - low } else { high.abs() };
        Axis { values: values.to_vec(), range: if range > 0.0 { range } else { 1.0 } }
    }

    fn value(&self, rng: &mut Rng) -> f64 {
        self.values[rng.pick(self.values.len())] + self.range * rng.between(-0.1, 0.1)
    }

    /// Mostly what one would choose, at times down to a millionth of the range.
    fn width(&self, rng: &mut Rng) -> f64 {
        self.range * if rng.chance(0.75) { rng.power(-1.5, 0.3) } else { rng.power(-6.0, -1.5) }
    }

    fn interval(&self, rng: &mut Rng) -> [f64; 2] {
        let (a, b) = (self.value(rng), self.value(rng));
        [a.min(b), a.max(b) + 1e-3 * self.range]
    }
}

/// One to three widgets of any kind.
pub(super) fn look(rng: &mut Rng, volume: &Volume, size: f64) -> TransferFunction {
    let model = match rng.chance(0.25) {
        true => OpticalModel::ConstantEmitter { cutoff: rng.power(-3.0, -1.0) },
        false => OpticalModel::DensityEmitter,
    };
    let g = volume.gradient_magnitude.as_deref().map_or(&[][..], |g| g);
    let axes = [Axis::new(&volume.scalar), Axis::new(g)];
    let widgets = (0..1 + rng.pick(3)).map(|_| widget(rng, volume, &axes)).collect();
    TransferFunction { model, unit_distance: size * rng.power(-2.0, 0.3), widgets }
}

fn widget(rng: &mut Rng, volume: &Volume, axes: &[Axis; 2]) -> Widget {
    let [s, g] = axes;
    let extinction = if rng.chance(0.85) { rng.power(-1.0, 2.0) } else { rng.power(-9.0, 9.0) };
    let profile = profile(rng, volume, axes, extinction);
    let region = match rng.pick(4) {
        0 => Some(Region::rectangle(s.interval(rng), g.interval(rng))),
        // Three corners, counter-clockwise.
        1 => {
            let ([a, b], [c, d]) = (s.interval(rng), g.interval(rng));
            Some(Region { corners: vec![[a, c], [b, c + 0.3 * (d - c)], [a + 0.4 * (b - a), d]] })
        }
        _ if profile == Profile::Uniform => {
            Some(Region::rectangle(s.interval(rng), [f64::NEG_INFINITY, f64::INFINITY]))
        }
        _ => None,
    };
    Widget { profile, color: rng.color(), extinction, region }
}

fn profile(rng: &mut Rng, volume: &Volume, [s, g]: &[Axis; 2], extinction: f64) -> Profile {
    let root_half = std::f64::consts::FRAC_1_SQRT_2;
    match rng.pick(10) {
        0 => Profile::Uniform,
        1 | 2 => {
            let (a, b, tilt) = (root_half / s.width(rng), root_half / g.width(rng), rng.between(-1.0, 1.0));
            let tilt = if rng.chance(0.5) { tilt } else { 0.0 };
            Profile::Gaussian { centre: [s.value(rng), g.value(rng)], matrix: [[a, tilt * b], [0.0, b]] }
        }
        3 => Profile::TriangularGaussian {
            centre: s.value(rng),
            sigma: s.width(rng) / g.values.iter().fold(1e-3 * g.range, |a, &b| a.max(b)),
        },
        4 | 5 => {
            let wave = Wave {
                origin: [s.value(rng), g.value(rng)],
                angle: if rng.chance(0.5) { 0.0 } else { rng.between(0.0, 6.3) },
                scale: [1.0 / s.range, 1.0 / g.range],
                period: rng.power(-1.5, 0.5),
                band_width: if rng.chance(0.5) { 1.0 } else { rng.power(-2.0, 0.0) },
            };
            if rng.chance(0.5) { Profile::TriangleWave(wave) } else { Profile::SineWave(wave) }
        }
        6 | 7 => {
            let mut places: Vec<f64> = (0..1 + rng.pick(5)).map(|_| s.value(rng)).collect();
            places.sort_by(f64::total_cmp);
            let point = |rng: &mut Rng, s| ControlPoint {
                s,
                color: rng.color(),
                extinction: if rng.chance(0.3) { 0.0 } else { extinction * rng.between(0.0, 1.0) },
            };
            Profile::PiecewiseLinear { points: places.into_iter().map(|s| point(rng, s)).collect() }
        }
        8 => {
            let (width, height) = (2 + rng.pick(7), 1 + rng.pick(6));
            let texel = |rng: &mut Rng| {
                let [r, g, b] = rng.color().map(|x| x as f32);
                [r, g, b, if rng.chance(0.3) { 0.0 } else { rng.between(0.0, 1.0) as f32 }]
            };
            let texels = (0..width * height).map(|_| texel(rng)).collect();
            Profile::Table(Arc::new(Table { width, height, texels, s: s.interval(rng), g: g.interval(rng) }))
        }
        _ => {
            let fields = FIELDS.map(String::from).to_vec();
            let values = |name: &str| Axis::new(&volume.grid.point_arrays[name].values);
            let axes: Vec<Axis> = FIELDS.iter().map(|name| values(name)).collect();
            let centre = axes.iter().map(|axis| axis.value(rng)).collect();
            let mut matrix: Vec<Vec<f64>> = (0..2)
                .map(|k| (0..2).map(|i| if i == k { root_half / axes[k].width(rng) } else { 0.0 }).collect())
                .collect();
            matrix[0][1] = rng.between(-1.0, 1.0) * matrix[0][0];
            match rng.chance(0.5) {
                true => Profile::GaussianNd { fields, centre, matrix },
                false => {
                    Profile::TriangularGaussianNd { fields, magnitude: MAGNITUDE.into(), centre, matrix }
                }
            }
        }
    }
}

/// Closed forms; at times a mix where widgets overlap, light, a silhouette.
pub(super) fn shading(rng: &mut Rng) -> Shading {
    Shading {
        integrator: Integrator::ANALYTIC,
        overlap: if rng.chance(0.15) { WidgetBlend::Mix } else { WidgetBlend::Exact },
        silhouette: rng.chance(0.15).then(|| rng.between(0.5, 6.0)),
        light: rng.chance(0.15).then(|| Light { direction: rng.direction(), ambient: 0.3, diffuse: 0.7 }),
    }
}
