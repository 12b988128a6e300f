//! Cases: exact values of segments, rays, chains and integrals, one JSON object a line; and those that the program carries.

use crate::{Conditions, PartialIntegrals};
use serde::Deserialize;
use serde_json::Value;
use std::sync::Arc;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_core::{Error, Result};
use voltet_optics::{Contribution, Segment};

#[derive(Debug, Clone)]
pub struct Case {
    pub id: String,
    /// The category: ordinary, stiff, narrow, …
    pub category: String,
    pub subject: String,
    pub kind: Kind,
}

#[derive(Debug, Clone)]
pub enum Kind {
    Segment(Box<SegmentCase>),
    /// Cells in front-to-back order.
    Ray {
        /// Each cell, without exact values of its own.
        segments: Vec<SegmentCase>,
        /// The whole: its exact values, length and transfer function.
        exact: Box<SegmentCase>,
    },
    Chain {
        /// Front to back; optical depths unused.
        segments: Vec<Contribution>,
        color: [f64; 3],
        opacity: f64,
        transparency: f64,
    },
    /// ψ, F, B, ζ of a stretch with linear extinction, whose ends times D are a and b.
    Table {
        a: f64,
        b: f64,
        exact: PartialIntegrals,
    },
}

impl Case {
    /// As the file writes it.
    pub(crate) fn kind_name(&self) -> &'static str {
        match self.kind {
            Kind::Segment(_) => "segment",
            Kind::Ray { .. } => "ray",
            Kind::Chain { .. } => "chain",
            Kind::Table { .. } => "table",
        }
    }

    /// The formula that it tries: a widget's by optical model, several widgets on a stretch, compositing, or the integrals
    /// of linear extinction.
    pub fn formula(&self) -> String {
        match &self.kind {
            Kind::Segment(case) => {
                let model = if case.density() { "density" } else { "constant" };
                match case.transfer_function.widgets.as_slice() {
                    [widget] => format!("{} ({model}-emitter)", widget.profile.name()),
                    _ => format!("widgets that overlap ({model}-emitter)"),
                }
            }
            Kind::Ray { .. } => "cells along a ray".into(),
            Kind::Chain { .. } => "compositing".into(),
            Kind::Table { .. } => "partial pre-integration".into(),
        }
    }

    pub fn inputs(&self) -> String {
        let list = |values: &[f64]| values.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
        match &self.kind {
            Kind::Segment(case) => {
                let per_peak = case.length / case.transfer_function.unit_distance;
                let peaks =
                    case.transfer_function.widgets.iter().map(|w| format!("{:.3e}", w.peak() * per_peak));
                let peaks = peaks.collect::<Vec<_>>().join(", ");
                format!("({}) to ({}), peak depth {peaks}", list(&case.front), list(&case.back))
            }
            Kind::Ray { segments, exact } => {
                format!("{} cells, depth {:.3e}", segments.len(), exact.exact.optical_depth)
            }
            Kind::Chain { segments, transparency, .. } => {
                format!("{} segments, transparency {transparency:.3e}", segments.len())
            }
            Kind::Table { a, b, .. } => format!("depths {a:?} and {b:?}"),
        }
    }
}

#[derive(Debug, Clone)]
pub struct SegmentCase {
    pub transfer_function: TransferFunction,
    pub length: f64,
    /// Values at the front: (s, g), or the fields of a gaussian-nd widget.
    pub front: Vec<f64>,
    pub back: Vec<f64>,
    pub exact: Contribution,
    pub conditions: Conditions,
}

impl SegmentCase {
    pub fn segment(&self) -> Segment<'_> {
        let pair = |v: &[f64]| [v.first().copied().unwrap_or(0.0), v.get(1).copied().unwrap_or(0.0)];
        Segment {
            length: self.length,
            front: pair(&self.front),
            back: pair(&self.back),
            fields_front: &self.front,
            fields_back: &self.back,
        }
    }

    /// True if the density-emitter is meant.
    pub fn density(&self) -> bool {
        self.transfer_function.model == OpticalModel::DensityEmitter
    }

    /// The largest colour component of all widgets.
    pub fn brightest(&self) -> f64 {
        self.transfer_function.widgets.iter().map(Widget::max_emission).fold(0.0, f64::max)
    }
}

/// Reads a case from its line.
pub fn parse(line: &str) -> Result<Case> {
    let line: Line = serde_json::from_str(line)
        .map_err(|e| Error::usage("a case cannot be read").got(e).expected("one JSON object a line"))?;
    let kind = line.kind.read().map_err(|e| e.at_item(&line.id))?;
    Ok(Case { id: line.id, category: line.cat, subject: line.sub, kind })
}

#[derive(Deserialize)]
struct Line {
    id: String,
    cat: String,
    #[serde(default)]
    sub: String,
    #[serde(flatten)]
    kind: KindLine,
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum KindLine {
    Segment {
        #[serde(flatten)]
        medium: Medium,
        #[serde(rename = "D")]
        length: f64,
        v_f: Vec<f64>,
        v_b: Vec<f64>,
        #[serde(flatten)]
        exact: ExactContribution,
        #[serde(flatten)]
        conditions: Conditions,
    },
    Ray {
        #[serde(flatten)]
        medium: Medium,
        /// (l, s, g) each.
        knots: Vec<[f64; 3]>,
        #[serde(flatten)]
        exact: ExactContribution,
    },
    Chain {
        segments: Vec<[f64; 4]>,
        #[serde(rename = "C")]
        color: [Exact; 3],
        #[serde(rename = "A")]
        opacity: Exact,
        transparency: Exact,
    },
    Table {
        tau_f: f64,
        tau_b: f64,
        psi: Exact,
        #[serde(rename = "F")]
        front: Exact,
        #[serde(rename = "B")]
        back: Exact,
        zeta: Exact,
    },
}

/// A decimal string (or a number), ≥ 0, which may be too small for doubles.
#[derive(Deserialize, Clone, Copy)]
#[serde(try_from = "Value")]
struct Exact(f64);

impl TryFrom<Value> for Exact {
    type Error = String;
    fn try_from(value: Value) -> std::result::Result<Exact, String> {
        let number: Option<f64> = value.as_str().map_or_else(|| value.as_f64(), |text| text.parse().ok());
        let number = number.filter(|number| *number >= 0.0 && number.is_finite());
        number
            .map(Exact)
            .ok_or_else(|| format!("{value} is no exact value: a decimal string of a number ≥ 0"))
    }
}

#[derive(Deserialize)]
struct ExactContribution {
    #[serde(rename = "T")]
    optical_depth: Exact,
    #[serde(rename = "C")]
    color: [Exact; 3],
    #[serde(rename = "A")]
    opacity: Exact,
}

impl KindLine {
    fn read(self) -> Result<Kind> {
        let exact = |exact: ExactContribution| Contribution {
            optical_depth: exact.optical_depth.0,
            color: exact.color.map(|c| c.0),
            opacity: exact.opacity.0,
        };
        Ok(match self {
            KindLine::Segment { medium, length, v_f, v_b, exact: values, conditions } => {
                Kind::Segment(Box::new(SegmentCase {
                    transfer_function: medium.read()?,
                    length,
                    front: v_f,
                    back: v_b,
                    exact: exact(values),
                    conditions,
                }))
            }
            KindLine::Ray { medium, knots, exact: values } => {
                let transfer_function = medium.read()?;
                let part = |from: &[f64; 3], to: &[f64; 3], exact: Contribution| SegmentCase {
                    transfer_function: transfer_function.clone(),
                    length: to[0] - from[0],
                    front: from[1..].to_vec(),
                    back: to[1..].to_vec(),
                    exact,
                    conditions: Conditions::default(),
                };
                let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
                    return Err(Error::usage("a ray has no knots").expected("[[l, s, g], …]"));
                };
                let segments =
                    knots.windows(2).map(|k| part(&k[0], &k[1], Contribution::default())).collect();
                Kind::Ray { segments, exact: Box::new(part(first, last, exact(values))) }
            }
            KindLine::Chain { segments, color, opacity, transparency } => Kind::Chain {
                segments: segments
                    .into_iter()
                    .map(|[r, g, b, opacity]| Contribution { optical_depth: 0.0, color: [r, g, b], opacity })
                    .collect(),
                color: color.map(|c| c.0),
                opacity: opacity.0,
                transparency: transparency.0,
            },
            KindLine::Table { tau_f, tau_b, psi, front, back, zeta } => Kind::Table {
                a: tau_f,
                b: tau_b,
                exact: PartialIntegrals { psi: psi.0, front: front.0, back: back.0, zeta: zeta.0 },
            },
        })
    }
}

#[derive(Deserialize)]
struct Medium {
    model: Model,
    cutoff: Option<f64>,
    unit_distance: f64,
    widgets: Vec<WidgetLine>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Model {
    Density,
    Constant,
}

impl Medium {
    fn read(self) -> Result<TransferFunction> {
        let model = match self.model {
            Model::Density => OpticalModel::DensityEmitter,
            Model::Constant => OpticalModel::ConstantEmitter { cutoff: self.cutoff.unwrap_or(1.0 / 255.0) },
        };
        let widgets = self.widgets.into_iter().map(WidgetLine::read).collect::<Result<_>>()?;
        Ok(TransferFunction { model, unit_distance: self.unit_distance, widgets })
    }
}

#[derive(Deserialize)]
struct WidgetLine {
    /// Without one: control points and images hold extinctions and colours of their own.
    color: Option<[f64; 3]>,
    extinction: Option<f64>,
    region: Option<Vec<[f64; 2]>>,
    #[serde(flatten)]
    profile: ProfileLine,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case")]
enum ProfileLine {
    Uniform,
    Gaussian {
        center: [f64; 2],
        #[serde(rename = "K")]
        matrix: [[f64; 2]; 2],
    },
    GaussianNd(OverFields),
    TriangularGaussian {
        center: f64,
        sigma: f64,
    },
    TriangularGaussianNd(OverFields),
    TriangleWave(WaveLine),
    SineWave(WaveLine),
    /// (s, extinction, r, g, b) each.
    PiecewiseLinear {
        points: Vec<[f64; 5]>,
    },
    Table {
        width: usize,
        height: usize,
        texels: Vec<[f32; 4]>,
        s: [f64; 2],
        g: [f64; 2],
    },
}

/// A widget over fields, whose order is that of the case's values.
#[derive(Deserialize)]
struct OverFields {
    center: Vec<f64>,
    #[serde(rename = "K")]
    matrix: Matrix,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Matrix {
    Diagonal(Vec<f64>),
    Full(Vec<Vec<f64>>),
}

#[derive(Deserialize)]
#[serde(default)]
struct WaveLine {
    s0: f64,
    g0: f64,
    theta: f64,
    w_s: f64,
    w_g: f64,
    period: f64,
    band_width: f64,
}

impl Default for WaveLine {
    fn default() -> WaveLine {
        WaveLine { s0: 0.0, g0: 0.0, theta: 0.0, w_s: 1.0, w_g: 1.0, period: 1.0, band_width: 1.0 }
    }
}

impl WidgetLine {
    fn read(self) -> Result<Widget> {
        let wave = |wave: WaveLine| Wave {
            origin: [wave.s0, wave.g0],
            angle: wave.theta,
            scale: [wave.w_s, wave.w_g],
            period: wave.period,
            band_width: wave.band_width,
        };
        let over = |OverFields { center, matrix }| {
            let matrix = match matrix {
                Matrix::Full(rows) => rows,
                Matrix::Diagonal(d) => {
                    let row = |i: usize| (0..d.len()).map(|j| if i == j { d[i] } else { 0.0 }).collect();
                    (0..d.len()).map(row).collect()
                }
            };
            let fields: Vec<String> = (0..center.len()).map(|i| format!("field{i}")).collect();
            (fields, center, matrix)
        };
        let profile = match self.profile {
            ProfileLine::Uniform => Profile::Uniform,
            ProfileLine::Gaussian { center: centre, matrix } => Profile::Gaussian { centre, matrix },
            ProfileLine::GaussianNd(line) => {
                let (fields, centre, matrix) = over(line);
                Profile::GaussianNd { fields, centre, matrix }
            }
            ProfileLine::TriangularGaussian { center: centre, sigma } => {
                Profile::TriangularGaussian { centre, sigma }
            }
            ProfileLine::TriangularGaussianNd(line) => {
                let (fields, centre, matrix) = over(line);
                // Behind the fields in the case's values, as in the order of names.
                Profile::TriangularGaussianNd { fields, magnitude: "magnitude".into(), centre, matrix }
            }
            ProfileLine::TriangleWave(line) => Profile::TriangleWave(wave(line)),
            ProfileLine::SineWave(line) => Profile::SineWave(wave(line)),
            ProfileLine::PiecewiseLinear { points } => {
                let point =
                    |[s, extinction, r, g, b]: [f64; 5]| ControlPoint { s, color: [r, g, b], extinction };
                Profile::PiecewiseLinear { points: points.into_iter().map(point).collect() }
            }
            ProfileLine::Table { width, height, texels, s, g } => {
                Profile::Table(Arc::new(Table { width, height, texels, s, g }))
            }
        };
        let missing = |key| move || Error::usage("a widget of a case lacks a key").expected(key);
        let own = profile.properties().own_peak.is_some();
        Ok(Widget {
            color: if own { [0.0; 3] } else { self.color.ok_or_else(missing("color"))? },
            extinction: if own { 0.0 } else { self.extinction.ok_or_else(missing("extinction"))? },
            region: self.region.map(|corners| Region { corners }),
            profile,
        })
    }
}

/// 1,519 cases, computed with 90 digits and checked by a second route.
const SEGMENTS: &str = include_str!("fixtures/segments.jsonl");

/// Random variations of the same kinds, computed apart with 77 digits by quadrature alone.
const VARIATIONS: &str = include_str!("fixtures/variations.jsonl");

/// Triangular Gaussians over fields, computed with 60 digits by `fixtures/triangular_gaussian_nd.py`.
const TRIANGULAR_ND: &str = include_str!("fixtures/triangular_gaussian_nd.jsonl");

/// Stiff, steep and narrow segments of up to 1e30 of depth, summed with 60 digits (`stiff.py` beside them).
const STIFF: &str = include_str!("fixtures/stiff.jsonl");

/// Length of the chains beyond those in the files.
const CHAIN_LENGTH: i32 = 100_000;

/// Opacities of their segments, 2 to these powers: exact in 32 bits.
const CHAIN_OPACITIES: [i32; 3] = [-8, -14, -20];

pub fn shipped() -> Result<Vec<Case>> {
    let lines = [SEGMENTS, VARIATIONS, TRIANGULAR_ND].into_iter().flat_map(str::lines);
    let lines = lines.filter(|line| !line.trim().is_empty());
    let mut cases = lines.map(parse).collect::<Result<Vec<Case>>>()?;
    cases.extend(CHAIN_OPACITIES.map(|power| chain(CHAIN_LENGTH, power)));
    Ok(cases)
}

/// The segments of the first of these files, each with its name and category.
pub fn segment_cases() -> Result<Vec<(String, String, SegmentCase)>> {
    let cases = SEGMENTS.lines().map(parse).collect::<Result<Vec<Case>>>()?;
    let segments = cases.into_iter().filter_map(|case| match case.kind {
        Kind::Segment(segment) => Some((case.id, case.category, *segment)),
        Kind::Ray { .. } | Kind::Chain { .. } | Kind::Table { .. } => None,
    });
    Ok(segments.collect())
}

/// Segments for a quadrature of 64 bits alone: closed forms lose digits on the narrowest of them, as rounding their values
/// does.
pub fn stiff() -> Result<Vec<Case>> {
    STIFF.lines().map(parse).collect()
}

/// n equal segments of opacity a = 2^power: 1 − A = (1 − a)^n, and C = c A of the colour c·a of each.
fn chain(length: i32, power: i32) -> Case {
    let opacity = 2f64.powi(power);
    // ln (1 − A); its rounding is 1e-16 of a number under 4,000, far under the bound of so many steps.
    let log = f64::from(length) * (-opacity).ln_1p();
    let whole = -log.exp_m1();
    let color = [1.0, 0.5, 0.25];
    let segment = Contribution { optical_depth: 0.0, color: color.map(|c| c * opacity), opacity };
    let (segments, color) = (vec![segment; length as usize], color.map(|c| c * whole));
    Case {
        id: format!("chain-{length}-equal{power}"),
        category: "chain".into(),
        subject: length.to_string(),
        kind: Kind::Chain { segments, color, opacity: whole, transparency: log.exp() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_generated_chain_has_the_values_of_its_steps() {
        let case = chain(100_000, -14);
        let Kind::Chain { segments, color, opacity, transparency } = case.kind else { panic!("no chain") };
        // Kahan's sum of logarithms: another route to ln (1 − A).
        let (mut sum, mut rest) = (0.0, 0.0);
        for segment in &segments {
            let term = f64::ln_1p(-segment.opacity) - rest;
            let next: f64 = sum + term;
            rest = (next - sum) - term;
            sum = next;
        }
        assert!((transparency / f64::exp(sum) - 1.0).abs() < 1e-14);
        assert!((opacity + transparency - 1.0).abs() < 1e-15);
        assert_eq!(color[1], 0.5 * opacity);
    }
}
