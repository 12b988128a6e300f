//! Cases: exact values of segments, rays, chains and integrals, one JSON object a line; and those that the program carries.

use crate::evaluator::{Read, exact, number};
use crate::{Conditions, PartialIntegrals};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::sync::Arc;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_core::{Error, Result};
use voltet_optics::{Contribution, Segment};

#[derive(Debug, Clone, Deserialize)]
pub struct Case {
    pub id: String,
    /// The category: ordinary, stiff, narrow, …
    #[serde(rename = "cat")]
    pub category: String,
    #[serde(rename = "sub", default)]
    pub subject: String,
    #[serde(flatten)]
    pub kind: Kind,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Kind {
    Segment(Box<SegmentCase>),
    /// Cells in front-to-back order.
    #[serde(deserialize_with = "ray")]
    Ray {
        /// Each cell, without exact values of its own.
        segments: Vec<SegmentCase>,
        /// The whole: its exact values, length and transfer function.
        exact: Box<SegmentCase>,
    },
    Chain {
        /// Front to back; optical depths unused.
        #[serde(deserialize_with = "contributions")]
        segments: Vec<Contribution>,
        #[serde(rename = "C", deserialize_with = "exact_color")]
        color: [f64; 3],
        #[serde(rename = "A", deserialize_with = "exact")]
        opacity: f64,
        #[serde(deserialize_with = "exact")]
        transparency: f64,
    },
    /// ψ, F, B, ζ of a stretch with linear extinction, whose ends times D are a and b.
    Table {
        #[serde(rename = "tau_f")]
        a: f64,
        #[serde(rename = "tau_b")]
        b: f64,
        #[serde(flatten)]
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

#[derive(Debug, Clone, Deserialize)]
pub struct SegmentCase {
    #[serde(flatten, deserialize_with = "transfer_function")]
    pub transfer_function: TransferFunction,
    #[serde(rename = "D")]
    pub length: f64,
    /// Values at the front: (s, g), or the fields of a gaussian-nd widget.
    #[serde(rename = "v_f")]
    pub front: Vec<f64>,
    #[serde(rename = "v_b")]
    pub back: Vec<f64>,
    #[serde(flatten, with = "ExactContribution")]
    pub exact: Contribution,
    #[serde(flatten)]
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
    serde_json::from_str(line)
        .map_err(|e| Error::usage("a case cannot be read").got(e).expected("one JSON object a line"))
}

fn exact_color<'de, D: Deserializer<'de>>(input: D) -> Read<'de, [f64; 3], D> {
    let [r, g, b] = &<[Value; 3]>::deserialize(input)?;
    Ok([number(r)?, number(g)?, number(b)?])
}

#[derive(Deserialize)]
#[serde(remote = "Contribution")]
struct ExactContribution {
    #[serde(rename = "T", deserialize_with = "exact")]
    optical_depth: f64,
    #[serde(rename = "C", deserialize_with = "exact_color")]
    color: [f64; 3],
    #[serde(rename = "A", deserialize_with = "exact")]
    opacity: f64,
}

/// Segments, each as (r, g, b, opacity).
fn contributions<'de, D: Deserializer<'de>>(input: D) -> Read<'de, Vec<Contribution>, D> {
    let part = |[r, g, b, opacity]: [f64; 4]| Contribution { optical_depth: 0.0, color: [r, g, b], opacity };
    Ok(Vec::deserialize(input)?.into_iter().map(part).collect())
}

#[derive(Deserialize)]
struct RayLine {
    #[serde(flatten, deserialize_with = "transfer_function")]
    transfer_function: TransferFunction,
    /// (l, s, g) each.
    knots: Vec<[f64; 3]>,
    #[serde(flatten, with = "ExactContribution")]
    exact: Contribution,
}

/// The segments of a ray, and the whole.
type Ray = (Vec<SegmentCase>, Box<SegmentCase>);

fn ray<'de, D: Deserializer<'de>>(input: D) -> Read<'de, Ray, D> {
    let RayLine { transfer_function, knots, exact } = RayLine::deserialize(input)?;
    let part = |from: &[f64; 3], to: &[f64; 3], exact: Contribution| SegmentCase {
        transfer_function: transfer_function.clone(),
        length: to[0] - from[0],
        front: from[1..].to_vec(),
        back: to[1..].to_vec(),
        exact,
        conditions: Conditions::default(),
    };
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
        return Err(D::Error::custom("a ray has no knots [l, s, g]"));
    };
    let segments = knots.windows(2).map(|k| part(&k[0], &k[1], Contribution::default())).collect();
    Ok((segments, Box::new(part(first, last, exact))))
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

#[derive(Deserialize)]
struct WidgetLine {
    /// Without one: control points and images hold extinctions and colours of their own.
    color: Option<[f64; 3]>,
    extinction: Option<f64>,
    region: Option<Vec<[f64; 2]>>,
    #[serde(flatten, with = "ProfileLine")]
    profile: Profile,
}

#[derive(Deserialize)]
#[serde(remote = "Profile", tag = "type", rename_all = "kebab-case")]
enum ProfileLine {
    Uniform,
    Gaussian {
        #[serde(rename = "center")]
        centre: [f64; 2],
        #[serde(rename = "K")]
        matrix: [[f64; 2]; 2],
    },
    GaussianNd {
        /// Named by [`transfer_function`].
        #[serde(skip)]
        fields: Vec<String>,
        #[serde(rename = "center")]
        centre: Vec<f64>,
        #[serde(rename = "K", deserialize_with = "rows")]
        matrix: Vec<Vec<f64>>,
    },
    TriangularGaussian {
        #[serde(rename = "center")]
        centre: f64,
        sigma: f64,
    },
    TriangularGaussianNd {
        #[serde(skip)]
        fields: Vec<String>,
        #[serde(skip)]
        magnitude: String,
        #[serde(rename = "center")]
        centre: Vec<f64>,
        #[serde(rename = "K", deserialize_with = "rows")]
        matrix: Vec<Vec<f64>>,
    },
    TriangleWave(#[serde(deserialize_with = "wave")] Wave),
    SineWave(#[serde(deserialize_with = "wave")] Wave),
    PiecewiseLinear {
        #[serde(deserialize_with = "control_points")]
        points: Vec<ControlPoint>,
    },
    Table(#[serde(deserialize_with = "table")] Arc<Table>),
}

/// Rows of a matrix, or its diagonal.
fn rows<'de, D: Deserializer<'de>>(input: D) -> Read<'de, Vec<Vec<f64>>, D> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Matrix {
        Diagonal(Vec<f64>),
        Full(Vec<Vec<f64>>),
    }
    Ok(match Matrix::deserialize(input)? {
        Matrix::Full(rows) => rows,
        Matrix::Diagonal(d) => {
            let row = |i: usize| (0..d.len()).map(|j| if i == j { d[i] } else { 0.0 }).collect();
            (0..d.len()).map(row).collect()
        }
    })
}

fn wave<'de, D: Deserializer<'de>>(input: D) -> Read<'de, Wave, D> {
    #[derive(Deserialize)]
    struct Line {
        s0: Option<f64>,
        g0: Option<f64>,
        theta: Option<f64>,
        w_s: Option<f64>,
        w_g: Option<f64>,
        period: Option<f64>,
        band_width: Option<f64>,
    }
    let Line { s0, g0, theta, w_s, w_g, period, band_width } = Line::deserialize(input)?;
    let [origin, scale] = [[s0, g0].map(Option::unwrap_or_default), [w_s, w_g].map(|w| w.unwrap_or(1.0))];
    let [period, band_width] = [period, band_width].map(|number| number.unwrap_or(1.0));
    Ok(Wave { origin, angle: theta.unwrap_or_default(), scale, period, band_width })
}

/// Control points, each as (s, extinction, r, g, b).
fn control_points<'de, D: Deserializer<'de>>(input: D) -> Read<'de, Vec<ControlPoint>, D> {
    let point = |[s, extinction, r, g, b]: [f64; 5]| ControlPoint { s, color: [r, g, b], extinction };
    Ok(Vec::deserialize(input)?.into_iter().map(point).collect())
}

fn table<'de, D: Deserializer<'de>>(input: D) -> Read<'de, Arc<Table>, D> {
    #[derive(Deserialize)]
    #[serde(remote = "Table")]
    struct Line {
        width: usize,
        height: usize,
        texels: Vec<[f32; 4]>,
        s: [f64; 2],
        g: [f64; 2],
    }
    Line::deserialize(input).map(Arc::new)
}

/// Fields are named in the order of the case's values.
fn transfer_function<'de, D: Deserializer<'de>>(input: D) -> Read<'de, TransferFunction, D> {
    let Medium { model, cutoff, unit_distance, widgets } = Medium::deserialize(input)?;
    let names = |centre: &[f64]| (0..centre.len()).map(|i| format!("field{i}")).collect();
    let widget = |WidgetLine { color, extinction, region, mut profile }| {
        match &mut profile {
            Profile::GaussianNd { fields, centre, .. } => *fields = names(centre),
            Profile::TriangularGaussianNd { fields, magnitude, centre, .. } => {
                // Behind the fields in the case's values, as in the order of names.
                (*fields, *magnitude) = (names(centre), "magnitude".into());
            }
            _ => {}
        }
        let (color, extinction) = match profile.properties().own_peak {
            Some(_) => ([0.0; 3], 0.0),
            None => (
                color.ok_or_else(|| D::Error::missing_field("color"))?,
                extinction.ok_or_else(|| D::Error::missing_field("extinction"))?,
            ),
        };
        Ok(Widget { color, extinction, region: region.map(|corners| Region { corners }), profile })
    };
    let model = match model {
        Model::Density => OpticalModel::DensityEmitter,
        Model::Constant => OpticalModel::ConstantEmitter { cutoff: cutoff.unwrap_or(1.0 / 255.0) },
    };
    let widgets = widgets.into_iter().map(widget).collect::<Read<'de, _, D>>()?;
    Ok(TransferFunction { model, unit_distance, widgets, axes: Default::default() })
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
