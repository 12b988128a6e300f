//! Reads one case: a JSON object on one line.

use super::json::{array, fixed, member, number, numbers, text};
use super::transfer_function::transfer_function;
use crate::{Conditions, PartialIntegrals};
use serde_json::Value;
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::{Contribution, Segment};

/// One case with its exact results.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its name.
    pub id: String,
    /// The category: ordinary, stiff, narrow, …
    pub category: String,
    /// Subject within the category.
    pub subject: String,
    /// Computed quantity.
    pub kind: Kind,
}

/// The kinds of cases.
#[derive(Debug, Clone)]
pub enum Kind {
    /// One segment.
    Segment(Box<SegmentCase>),
    /// Cells in front-to-back order.
    Ray {
        /// Each cell, without exact values of its own.
        segments: Vec<SegmentCase>,
        /// The whole: its exact values, length and transfer function.
        exact: Box<SegmentCase>,
    },
    /// Contributions to composite.
    Chain {
        /// Front to back; optical depths unused.
        segments: Vec<Contribution>,
        /// C.
        color: [f64; 3],
        /// A.
        opacity: f64,
        /// 1 − A.
        transparency: f64,
    },
    /// ψ, F, B, ζ of a stretch with linear extinction.
    Table {
        /// α_f D.
        a: f64,
        /// α_b D.
        b: f64,
        /// The exact values.
        exact: PartialIntegrals,
    },
}

impl Kind {
    /// As the file writes it.
    pub fn name(&self) -> &'static str {
        match self {
            Kind::Segment(_) => "segment",
            Kind::Ray { .. } => "ray",
            Kind::Chain { .. } => "chain",
            Kind::Table { .. } => "table",
        }
    }
}

impl Case {
    /// The formula that it tries: a widget's by optical model, several widgets on a stretch, compositing, or the integrals
    /// of linear extinction.
    pub fn formula(&self) -> String {
        let of = |case: &SegmentCase| {
            let model = if case.density() { "density" } else { "constant" };
            match case.transfer_function.widgets.as_slice() {
                [widget] => format!("{} ({model}-emitter)", widget.profile.name()),
                _ => format!("widgets that overlap ({model}-emitter)"),
            }
        };
        match &self.kind {
            Kind::Segment(case) => of(case),
            Kind::Ray { .. } => "cells along a ray".into(),
            Kind::Chain { .. } => "compositing".into(),
            Kind::Table { .. } => "partial pre-integration".into(),
        }
    }

    /// Short description of the inputs.
    pub fn inputs(&self) -> String {
        let list = |values: &[f64]| values.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
        match &self.kind {
            Kind::Segment(case) => {
                let peaks: Vec<f64> = case.transfer_function.widgets.iter().map(Widget::peak).collect();
                let peaks = peaks.iter().map(|x| x / case.transfer_function.unit_distance * case.length);
                format!(
                    "({}) to ({}), peak depth {}",
                    list(&case.front),
                    list(&case.back),
                    peaks.map(|x| format!("{x:.3e}")).collect::<Vec<_>>().join(", ")
                )
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

/// A segment with its transfer function and exact values.
#[derive(Debug, Clone)]
pub struct SegmentCase {
    /// The transfer function.
    pub transfer_function: TransferFunction,
    /// D.
    pub length: f64,
    /// Values at the front: (s, g), or the fields of a gaussian-nd widget.
    pub front: Vec<f64>,
    /// Values at the back.
    pub back: Vec<f64>,
    /// Exact values.
    pub exact: Contribution,
    /// Condition numbers of T, C, A; `None` where the result is discontinuous.
    pub condition: [Option<f64>; 3],
    /// Condition numbers for rounding of the raw numbers, the values at both ends.
    pub raw_condition: [Option<f64>; 3],
}

impl SegmentCase {
    /// The segment.
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

    /// Its condition numbers.
    pub fn conditions(&self) -> Conditions {
        Conditions { differences: self.condition, values: self.raw_condition }
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

/// Reads one line.
pub fn parse(line: &str) -> Result<Case> {
    let value: Value = serde_json::from_str(line)
        .map_err(|e| Error::usage("a case is not valid JSON").got(e).expected("one JSON object a line"))?;
    let id = text(&value, "id")?.to_owned();
    read(&value).map_err(|e| e.at_item(id))
}

fn read(value: &Value) -> Result<Case> {
    let kind = match text(value, "kind")? {
        "segment" => Kind::Segment(Box::new(SegmentCase {
            transfer_function: transfer_function(value)?,
            length: number(value, "D")?,
            front: numbers(member(value, "v_f")?)?,
            back: numbers(member(value, "v_b")?)?,
            exact: contribution(value)?,
            condition: condition(value, "k"),
            raw_condition: condition(value, "k_in"),
        })),
        "ray" => ray(value)?,
        "chain" => {
            let segments = array(value, "segments")?
                .iter()
                .map(|row| {
                    let [r, g, b, a] = fixed(row)?;
                    Ok(Contribution { optical_depth: 0.0, color: [r, g, b], opacity: a })
                })
                .collect::<Result<_>>()?;
            Kind::Chain {
                segments,
                color: exact_color(value)?,
                opacity: exact(value, "A")?,
                transparency: exact(value, "transparency")?,
            }
        }
        "table" => Kind::Table {
            a: number(value, "tau_f")?,
            b: number(value, "tau_b")?,
            exact: PartialIntegrals {
                psi: exact(value, "psi")?,
                front: exact(value, "F")?,
                back: exact(value, "B")?,
                zeta: exact(value, "zeta")?,
            },
        },
        other => {
            return Err(Error::usage("a case is of an unknown kind")
                .got(other)
                .expected("segment, ray, chain or table"));
        }
    };
    let optional = |key: &str| value.get(key).and_then(Value::as_str).unwrap_or("").to_owned();
    Ok(Case {
        id: text(value, "id")?.to_owned(),
        category: text(value, "cat")?.to_owned(),
        subject: optional("sub"),
        kind,
    })
}

fn ray(value: &Value) -> Result<Kind> {
    let transfer_function = transfer_function(value)?;
    let knots = array(value, "knots")?.iter().map(fixed::<3>).collect::<Result<Vec<_>>>()?;
    let part = |from: &[f64; 3], to: &[f64; 3], exact: Contribution| SegmentCase {
        transfer_function: transfer_function.clone(),
        length: to[0] - from[0],
        front: from[1..].to_vec(),
        back: to[1..].to_vec(),
        exact,
        condition: [None; 3],
        raw_condition: [None; 3],
    };
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
        return Err(Error::usage("a ray has no knots").expected("[[l, s, g], …]"));
    };
    let whole = part(first, last, contribution(value)?);
    let segments = knots.windows(2).map(|k| part(&k[0], &k[1], Contribution::default())).collect();
    Ok(Kind::Ray { segments, exact: Box::new(whole) })
}

fn contribution(value: &Value) -> Result<Contribution> {
    Ok(Contribution {
        optical_depth: exact(value, "T")?,
        color: exact_color(value)?,
        opacity: exact(value, "A")?,
    })
}

fn condition(value: &Value, key: &str) -> [Option<f64>; 3] {
    let Some(list) = value.get(key).and_then(Value::as_array) else { return [None; 3] };
    std::array::from_fn(|i| list.get(i).and_then(Value::as_f64))
}

/// An exact value: a decimal string (or a number), ≥ 0, which may be too small for doubles.
fn exact(value: &Value, key: &str) -> Result<f64> {
    decimal(member(value, key)?).ok_or_else(|| not_exact(key, &value[key]))
}

fn exact_color(value: &Value) -> Result<[f64; 3]> {
    let parsed: Option<Vec<f64>> = array(value, "C")?.iter().map(decimal).collect();
    parsed.and_then(|list| list.try_into().ok()).ok_or_else(|| not_exact("C", &value["C"]))
}

fn decimal(value: &Value) -> Option<f64> {
    let number: f64 = value.as_str().map_or_else(|| value.as_f64(), |text| text.parse().ok())?;
    (number >= 0.0 && number.is_finite()).then_some(number)
}

fn not_exact(key: &str, found: &Value) -> Error {
    Error::usage(format!("'{key}' of a case is no exact value"))
        .got(found)
        .expected("decimal strings of finite numbers ≥ 0")
}
