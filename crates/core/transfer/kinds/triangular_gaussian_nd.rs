//! `triangular-gaussian-nd`: exp(−|K (v − centre)|²/m²) over a list of fields of its own, m another array, the magnitude of
//! all their gradients; 0 where m ≤ 0 (Kniss et al. 2003, section 3.2). Over one field with K = 1/σ and m = |∇v| it is
//! `triangular-gaussian`.

use super::gaussian_nd;
use super::properties::{
    AxisOrigin, CENTRE_OF_FIELDS, COLOR, EXTINCTION, FIELDS, FieldsOfWidget, MATRIX_OF_FIELDS, MAX_FIELDS,
    NAME, POSITIVE_OR_INFINITE, Properties, REGION, SIGMA_OF_FIELDS, fields_of,
};
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Parameters, RelativeNumberType, StatisticKind,
    VariantSchema,
};
use crate::transfer::hull::Corners;
use crate::{Error, Result};

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "triangular-gaussian-nd",
    summary: "A Gaussian over one to seven point arrays that widens with the magnitude of all their gradients.",
    parameters: &[
        COLOR,
        EXTINCTION,
        Parameter {
            help: "names of one to seven point arrays; \"NAME:0\" and \"NAME:magnitude\" for vectors",
            ..FIELDS
        },
        Parameter {
            name: "magnitude",
            parameter_type: ParameterType::ArrayName,
            unit: "",
            default: DefaultValue::Text("multi-gradient"),
            help: "the point array that the widths are shares of, such as the node multi-gradient computes",
        },
        CENTRE_OF_FIELDS,
        Parameter {
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Numbers(None, POSITIVE_OR_INFINITE),
                statistic: StatisticKind::Width,
                axis: AxisRef::NamesPer("fields", "magnitude"),
            }),
            unit: "units of the fields / units of the magnitude",
            help: "widths for each unit of the magnitude, one a field; inf ignores the field",
            ..SIGMA_OF_FIELDS
        },
        Parameter {
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Rows(None),
                statistic: StatisticKind::Factor,
                axis: AxisRef::NamesPer("fields", "magnitude"),
            }),
            unit: "units of the magnitude / units of the fields",
            default: DefaultValue::Unset("diag(1 / sigma)"),
            help: "K of exp(-|K (v - centre) / magnitude|²), rows first, in place of sigma",
            ..MATRIX_OF_FIELDS
        },
        REGION,
        NAME,
    ],
};

/// Most fields beside the magnitude.
const MAX_FURTHER_FIELDS: usize = MAX_FIELDS - 1;

/// Magnitude; and fields, centre and matrix.
pub(super) fn read(p: &Parameters) -> Result<(String, FieldsOfWidget)> {
    let own = fields_of(p, MAX_FURTHER_FIELDS, 1.0)?;
    let magnitude = p.text("magnitude")?.to_owned();
    if magnitude.is_empty() {
        return Err(p.error("magnitude", "the magnitude has no name").expected("the name of a point array"));
    }
    Ok((magnitude, own))
}

pub(super) fn properties<'a>(fields: &'a [String], magnitude: &'a str, centre: &[f64]) -> Properties<'a> {
    let centres = centre.iter().map(|&centre| AxisOrigin::Centre(centre));
    Properties {
        name: KIND.name,
        fields: fields.iter().map(String::as_str).chain([magnitude]).collect(),
        axes: [AxisOrigin::Any; 2].into_iter().chain(centres).chain([AxisOrigin::Zero]).collect(),
        has_elementary_mean: false,
        ..Properties::PLAIN
    }
}

pub(super) fn check(fields: &[String], magnitude: &str, centre: &[f64], matrix: &[Vec<f64>]) -> Result<()> {
    gaussian_nd::check(fields, centre, matrix)?;
    if fields.len() > MAX_FURTHER_FIELDS {
        return Err(Error::usage("a widget over fields and their magnitude has too many of them")
            .got(fields.len())
            .expected(format!("1 to {MAX_FURTHER_FIELDS}")));
    }
    match magnitude {
        "" => Err(Error::usage("the magnitude has no name").expected("the name of a point array")),
        _ => Ok(()),
    }
}

/// `v`: the fields, then the magnitude.
pub(super) fn at(centre: &[f64], matrix: &[Vec<f64>], v: &[f64]) -> f64 {
    match v.split_last() {
        Some((&m, v)) if m > 0.0 => (-gaussian_nd::distance_squared(centre, matrix, v) / (m * m)).exp(),
        _ => 0.0,
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct TriangularGaussianNdBounds {
    fields: gaussian_nd::GaussianNdBounds,
    /// Index of the magnitude among all fields; past the end where it is unknown.
    magnitude: usize,
}

impl TriangularGaussianNdBounds {
    /// `names`: all further fields in their order.
    pub fn new(fields: gaussian_nd::GaussianNdBounds, magnitude: &str, names: &[&str]) -> Self {
        let magnitude = names.iter().position(|name| *name == magnitude).unwrap_or(usize::MAX);
        TriangularGaussianNdBounds { fields, magnitude }
    }

    /// Along a direction e in which the whole hull lies on one side of the centre, |q|/m ≥ (q·e)/m, a ratio of linear
    /// functions, whose least value is at a vertex with m > 0.
    pub fn bound(&self, corners: &Corners) -> f64 {
        let Some(magnitude) = corners.fields.get(self.magnitude) else { return 1.0 };
        if magnitude.iter().all(|&m| m <= 0.0) {
            return 0.0;
        }
        self.fields.bound_of(corners, |along| {
            let ratio = |v: usize| if magnitude[v] > 0.0 { along[v] / magnitude[v] } else { f64::INFINITY };
            (0..4).map(ratio).fold(f64::INFINITY, f64::min)
        })
    }
}
