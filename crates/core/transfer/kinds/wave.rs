//! `triangle-wave` and `sine-wave`: bands across the (s, g) plane (Song et al. 2009, sections 4.3 and 4.4).

use super::properties::{
    BandSpacing, COLOR, EXTINCTION, NAME, PLACE, Properties, REGION, Wave, finite, positive,
};
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Parameters, Range, RelativeNumberType, StatisticKind,
    VariantSchema,
};
use crate::transfer::hull::{Corners, ROUNDING, range};
use crate::{Error, Result};
use std::f64::consts::PI;

/// The declaration of the bands with straight flanks.
pub(super) const TRIANGLE: VariantSchema =
    VariantSchema { name: "triangle-wave", summary: "Bands with straight flanks.", parameters: KEYS };

/// The declaration of the bands shaped like |sin|.
pub(super) const SINE: VariantSchema =
    VariantSchema { name: "sine-wave", summary: "Bands shaped like |sin|.", parameters: KEYS };

/// Axis across the bands: s and g, scaled, in the wave's direction. Its range has the length
/// |cos θ·w_s| (range of s) + |sin θ·w_g| (range of g), so that a period of 10 % makes ten bands.
pub(in crate::transfer) const ACROSS: &str = "s and g across the bands";

const KEYS: &[Parameter] = &[
    COLOR,
    EXTINCTION,
    Parameter {
        name: "origin",
        parameter_type: PLACE,
        unit: "(s, g)",
        default: DefaultValue::Numbers(&[0.0, 0.0]),
        help: "a point where the wave is 0",
    },
    Parameter {
        name: "angle",
        parameter_type: ParameterType::Number(Range::ANY),
        unit: "degrees",
        default: DefaultValue::Number(0.0),
        help: "direction across the bands in the (s, g) plane; 0 bands the scalar",
    },
    Parameter {
        name: "scale",
        parameter_type: ParameterType::Measured(&RelativeNumberType {
            plain: ParameterType::Numbers(Some(2), Range::ANY),
            statistic: StatisticKind::Factor,
            axis: AxisRef::Places(&["s", "g"]),
        }),
        unit: "",
        default: DefaultValue::Numbers(&[1.0, 1.0]),
        help: "factors on the two axes, [ws, wg]",
    },
    Parameter {
        name: "period",
        parameter_type: ParameterType::Measured(&RelativeNumberType {
            plain: ParameterType::Number(Range::above(0.0)),
            statistic: StatisticKind::Width,
            axis: AxisRef::Every(ACROSS),
        }),
        unit: "units of scaled s, g",
        default: DefaultValue::Required,
        help: "distance between two bands",
    },
    Parameter {
        name: "band_width",
        parameter_type: ParameterType::Number(Range { above_min: true, ..Range::within(0.0, 1.0) }),
        unit: "",
        default: DefaultValue::Number(1.0),
        help: "share of the profile that is kept around its peaks",
    },
    REGION,
    NAME,
];

pub(super) fn read(p: &Parameters) -> Result<Wave> {
    Ok(Wave {
        origin: p.vector("origin")?,
        angle: p.number("angle")?.to_radians(),
        scale: p.vector("scale")?,
        period: p.number("period")?,
        band_width: p.number("band_width")?,
    })
}

impl Wave {
    /// φ per unit of s and of g.
    pub fn step(&self) -> [f64; 2] {
        let (sin, cos) = self.angle.sin_cos();
        [cos * self.scale[0] / self.period, sin * self.scale[1] / self.period]
    }

    /// The profile at a place of the plane; `sine`: of the wave that is shaped so.
    pub(super) fn at(&self, v: [f64; 2], sine: bool) -> f64 {
        let step = self.step();
        let phase = (v[0] - self.origin[0]) * step[0] + (v[1] - self.origin[1]) * step[1];
        height(phase - phase.floor() - 0.5, self.band_width, sine)
    }

    /// Half of the width, in φ, of what is kept around a peak: at most ½.
    pub fn half_band(&self, sine: bool) -> f64 {
        match sine {
            true => 2.0 / PI * (0.5 * self.band_width).sqrt().asin(),
            false => 0.5 * self.band_width,
        }
    }

    /// The band width that keeps so much on both sides of a peak (φ, at most ½): the inverse of [`Wave::half_band`].
    pub fn band_width_of(half: f64, sine: bool) -> f64 {
        match sine {
            true => 2.0 * (0.5 * PI * half).sin().powi(2),
            false => 2.0 * half,
        }
    }
}

pub(super) fn properties(name: &'static str, wave: &Wave) -> Properties<'static> {
    Properties {
        name,
        depends_on_g: wave.angle.sin() * wave.scale[1] != 0.0,
        bands: Some(BandSpacing { origin: wave.origin, step: wave.step() }),
        // The feet of a band that is cut narrower are corners, but tell as jumps to pieces that are wider than a band.
        jumps: wave.band_width < 1.0,
        ..Properties::PLAIN
    }
}

pub(super) fn check(wave: &Wave) -> Result<()> {
    finite("the origin", &wave.origin)?;
    finite("the scale", &wave.scale)?;
    finite("the angle", &[wave.angle])?;
    positive("the period", wave.period)?;
    if wave.band_width > 0.0 && wave.band_width <= 1.0 {
        return Ok(());
    }
    Err(Error::usage("the band width is out of range").got(wave.band_width).expected("0 < band width ≤ 1"))
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct WaveBounds {
    origin: [f64; 2],
    step: [f64; 2],
    band_width: f64,
    sine: bool,
}

impl WaveBounds {
    pub fn new(wave: &Wave, sine: bool) -> Self {
        WaveBounds { origin: wave.origin, step: wave.step(), band_width: wave.band_width, sine }
    }

    pub fn bound(&self, corners: &Corners) -> f64 {
        let phases = std::array::from_fn(|i| {
            (corners.s[i] - self.origin[0]) * self.step[0] + (corners.g[i] - self.origin[1]) * self.step[1]
        });
        let (low, high) = range(&phases);
        let slack = ROUNDING * (1.0 + low.abs().max(high.abs()));
        self.between(low - slack, high + slack)
    }

    /// The most of the profile over the phases [low, high].
    fn between(&self, low: f64, high: f64) -> f64 {
        // Distance of the nearest peak, a half-integer.
        let peak_passed = (high - 0.5).floor() >= (low - 0.5).ceil();
        if peak_passed {
            return 1.0;
        }
        let off_peak = |phase: f64| (phase - (phase - 0.5).round() - 0.5).abs();
        let away = off_peak(low).min(off_peak(high)).min(0.5);
        height(away, self.band_width, self.sine)
    }
}

/// The profile so far from a peak, in φ, at most ½.
fn height(away: f64, band_width: f64, sine: bool) -> f64 {
    let full = if sine { (PI * away).cos() } else { 1.0 - 2.0 * away.abs() };
    (1.0 - (1.0 - full) / band_width).max(0.0)
}
