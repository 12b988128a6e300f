//! `gaussian`: exp(−|K (v − centre)|²) over the (s, g) plane (Song et al. 2009, section 4.2; Kniss et al. 2003, Eq. 12).

use super::properties::{
    AxisOrigin, CENTRE, COLOR, EXTINCTION, MATRIX, NAME, POSITIVE_OR_INFINITE, Properties, REGION, SIGMA,
    finite, kernel,
};
use crate::Result;
use crate::parameters::{
    AxisRef, Parameter, ParameterType, Parameters, RelativeNumberType, StatisticKind, VariantSchema,
};
use crate::transfer::hull::{Corners, distance_squared_from_origin, gaussian, range};
use crate::transfer::region::Slab;

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "gaussian",
    summary: "A Gaussian over the scalar and its gradient magnitude.",
    parameters: &[
        COLOR,
        EXTINCTION,
        CENTRE,
        Parameter {
            parameter_type: WIDTHS,
            unit: "(s, g)",
            help: "standard deviations along s and g; inf ignores the axis",
            ..SIGMA
        },
        Parameter { parameter_type: FACTORS, unit: "1 / units of s, g", ..MATRIX },
        REGION,
        NAME,
    ],
};

const WIDTHS: ParameterType = ParameterType::Measured(&RelativeNumberType {
    plain: ParameterType::Numbers(Some(2), POSITIVE_OR_INFINITE),
    statistic: StatisticKind::Width,
    axis: AxisRef::Places(&["s", "g"]),
});

/// Columns belong to s and g.
const FACTORS: ParameterType = ParameterType::Measured(&RelativeNumberType {
    plain: ParameterType::Rows(Some(2)),
    statistic: StatisticKind::Factor,
    axis: AxisRef::Places(&["s", "g"]),
});

/// Centre and matrix.
pub(super) fn read(p: &Parameters) -> Result<([f64; 2], [[f64; 2]; 2])> {
    let rows = kernel(p, 2, std::f64::consts::SQRT_2)?;
    let matrix = [[rows[0][0], rows[0][1]], [rows[1][0], rows[1][1]]];
    Ok((p.vector("centre")?, matrix))
}

pub(super) fn properties(centre: &[f64; 2], matrix: &[[f64; 2]; 2]) -> Properties<'static> {
    Properties {
        name: KIND.name,
        depends_on_g: matrix[0][1] != 0.0 || matrix[1][1] != 0.0,
        axes: centre.map(AxisOrigin::Centre).to_vec(),
        ..Properties::PLAIN
    }
}

pub(super) fn check(centre: &[f64; 2], matrix: &[[f64; 2]; 2]) -> Result<()> {
    finite("the centre", centre)?;
    finite("the matrix", matrix.as_flattened())
}

pub(super) fn at(centre: &[f64; 2], matrix: &[[f64; 2]; 2], v: [f64; 2]) -> f64 {
    let d = [v[0] - centre[0], v[1] - centre[1]];
    (-matrix.iter().map(|row| (row[0] * d[0] + row[1] * d[1]).powi(2)).sum::<f64>()).exp()
}

/// Values of s beyond which exp(−|K (v − centre)|²) is below a millionth at every g: the extent of an ellipse, or of a strip.
pub(super) fn scalar_range(centre: &[f64; 2], matrix: &[[f64; 2]; 2]) -> [f64; 2] {
    // |K (v − centre)|² = ln 10⁶.
    let distance = (6.0 * std::f64::consts::LN_10).sqrt();
    let norm = |axis: usize| matrix[0][axis].hypot(matrix[1][axis]);
    let determinant = (matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]).abs();
    let half = match norm(1) {
        0.0 => distance / norm(0),
        across => distance * across / determinant,
    };
    [centre[0] - half, centre[0] + half]
}

/// Two slabs, one a row of K: |K (v − centre)| ≤ distance lies within both.
pub(super) fn slabs(centre: &[f64; 2], matrix: &[[f64; 2]; 2], distance: f64) -> Vec<Slab> {
    let row = |row: &[f64; 2]| {
        let middle = row[0] * centre[0] + row[1] * centre[1];
        Slab { normal: *row, low: middle - distance, high: middle + distance }
    };
    matrix.iter().filter(|row| **row != [0.0; 2]).map(row).collect()
}

/// A Gaussian of one axis: the distance is that of an interval.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct Line {
    axis: usize,
    centre: f64,
    /// Widths per unit.
    width: f64,
}

impl Line {
    /// `None` where K looks at both axes.
    pub fn new(centre: &[f64; 2], matrix: &[[f64; 2]; 2]) -> Option<Line> {
        let norm = |axis: usize| matrix[0][axis].hypot(matrix[1][axis]);
        let ignored = [1, 0].into_iter().find(|&axis| norm(axis) == 0.0)?;
        let axis = 1 - ignored;
        Some(Line { axis, centre: centre[axis], width: norm(axis) })
    }

    #[inline]
    pub fn bound(&self, corners: &Corners) -> f64 {
        let (low, high) = range(if self.axis == 0 { corners.s } else { corners.g });
        let distance = (low - self.centre).max(self.centre - high).max(0.0) * self.width;
        gaussian(distance * distance)
    }

    /// At the farther end.
    pub fn min_in_box(&self, ranges: &[[f64; 2]; 2]) -> f64 {
        let [low, high] = ranges[self.axis];
        let distance = (self.centre - low).max(high - self.centre) * self.width;
        (-distance * distance).exp()
    }
}

/// A Gaussian of both axes.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct GaussianPlane {
    pub centre: [f64; 2],
    pub matrix: [[f64; 2]; 2],
}

impl GaussianPlane {
    /// K (v − centre) of a cell's corners.
    #[inline]
    pub fn scaled(&self, corners: &Corners) -> [[f64; 2]; 4] {
        std::array::from_fn(|i| {
            let (ds, dg) = (corners.s[i] - self.centre[0], corners.g[i] - self.centre[1]);
            self.matrix.map(|row| row[0] * ds + row[1] * dg)
        })
    }

    #[inline]
    pub fn bound(&self, corners: &Corners) -> f64 {
        gaussian(distance_squared_from_origin(&self.scaled(corners)))
    }

    /// At the farthest corner: distances are convex.
    pub fn min_in_box(&self, [s, g]: &[[f64; 2]; 2]) -> f64 {
        let corners = Corners { s: &[s[0], s[1], s[0], s[1]], g: &[g[0], g[0], g[1], g[1]], fields: &[] };
        let farthest = self.scaled(&corners).iter().map(|p| p[0] * p[0] + p[1] * p[1]).fold(0.0, f64::max);
        (-farthest).exp()
    }
}
