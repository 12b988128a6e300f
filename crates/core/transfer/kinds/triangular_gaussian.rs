//! `triangular-gaussian`: exp(−((s − centre)/(sigma g))²), 0 where g = 0 (Kniss et al. 2003, section 3.2).

use super::properties::{AxisOrigin, COLOR, EXTINCTION, NAME, Properties, REGION, finite, positive};
use crate::Result;
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Range, RelativeNumberType, StatisticKind, VariantSchema,
};
use crate::transfer::hull::{Corners, gaussian};
use crate::transfer::region::Slab;

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "triangular-gaussian",
    summary: "exp(-((s - centre) / (sigma g))²): a Gaussian in s that widens with the gradient magnitude.",
    parameters: &[
        COLOR,
        EXTINCTION,
        Parameter {
            name: "centre",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Number(Range::ANY),
                statistic: StatisticKind::Value,
                axis: AxisRef::Every("s"),
            }),
            unit: "units of s",
            default: DefaultValue::Required,
            help: "the scalar in the middle",
        },
        Parameter {
            name: "sigma",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Number(Range::above(0.0)),
                statistic: StatisticKind::Width,
                axis: AxisRef::EveryPer("s", "g"),
            }),
            unit: "units of s / units of g",
            default: DefaultValue::Required,
            help: "width in s for each unit of g",
        },
        REGION,
        NAME,
    ],
};

pub(super) fn properties(centre: f64) -> Properties<'static> {
    Properties {
        name: KIND.name,
        depends_on_g: true,
        axes: vec![AxisOrigin::Centre(centre), AxisOrigin::Zero],
        has_elementary_mean: false,
        ..Properties::PLAIN
    }
}

pub(super) fn check(centre: f64, sigma: f64) -> Result<()> {
    finite("the centre", &[centre])?;
    positive("sigma", sigma)
}

pub(super) fn at(centre: f64, sigma: f64, [s, g]: [f64; 2]) -> f64 {
    if g > 0.0 { (-((s - centre) / (sigma * g)).powi(2)).exp() } else { 0.0 }
}

/// |s − centre| ≤ distance σ g is the part between two lines.
pub(super) fn slabs(centre: f64, sigma: f64, distance: f64) -> Vec<Slab> {
    let width = distance * sigma;
    vec![
        Slab { normal: [1.0, -width], low: f64::NEG_INFINITY, high: centre },
        Slab { normal: [1.0, width], low: centre, high: f64::INFINITY },
    ]
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct TriangularGaussianBounds {
    pub centre: f64,
    pub sigma: f64,
}

impl TriangularGaussianBounds {
    /// |s − s₀|/(σ g) is a ratio of linear functions: its least value over the hull is at a vertex unless s − s₀ changes
    /// sign.
    pub fn bound(&self, corners: &Corners) -> f64 {
        let (low, high) = corners.s_range();
        if corners.g_range().1 <= 0.0 {
            return 0.0;
        }
        if low <= self.centre && self.centre <= high {
            return 1.0;
        }
        let nearest = (0..4)
            .filter(|&i| corners.g[i] > 0.0)
            .map(|i| (corners.s[i] - self.centre).abs() / (self.sigma * corners.g[i]))
            .fold(f64::INFINITY, f64::min);
        gaussian(nearest * nearest)
    }
}
