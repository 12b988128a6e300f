//! `gaussian-nd`: exp(−|K (v − centre)|²) over a list of fields of its own (Kniss et al. 2003, Eq. 11 and 12).

use super::properties::{
    AxisOrigin, CENTRE_OF_FIELDS, COLOR, EXTINCTION, FIELDS, MATRIX_OF_FIELDS, MAX_FIELDS, NAME, Properties,
    REGION, SIGMA_OF_FIELDS, finite,
};
use crate::parameters::VariantSchema;
use crate::transfer::hull::{Corners, gaussian};
use crate::{Error, Result, counted};

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "gaussian-nd",
    summary: "A Gaussian over one to eight point arrays.",
    parameters: &[
        COLOR,
        EXTINCTION,
        FIELDS,
        CENTRE_OF_FIELDS,
        SIGMA_OF_FIELDS,
        MATRIX_OF_FIELDS,
        REGION,
        NAME,
    ],
};

pub(super) fn properties<'a>(fields: &'a [String], centre: &[f64]) -> Properties<'a> {
    let centres = centre.iter().map(|&centre| AxisOrigin::Centre(centre));
    Properties {
        name: KIND.name,
        fields: fields.iter().map(String::as_str).collect(),
        axes: [AxisOrigin::Any; 2].into_iter().chain(centres).collect(),
        ..Properties::PLAIN
    }
}

pub(super) fn check(fields: &[String], centre: &[f64], matrix: &[Vec<f64>]) -> Result<()> {
    let n = fields.len();
    if !(1..=MAX_FIELDS).contains(&n) {
        return Err(Error::usage("a widget over fields has a wrong number of them")
            .got(n)
            .expected(format!("1 to {MAX_FIELDS}")));
    }
    if centre.len() != n {
        return Err(Error::usage("the centre does not fit the fields")
            .got(centre.len())
            .expected(format!("{}, one a field", counted(n, "number"))));
    }
    if matrix.len() != n || matrix.iter().any(|row| row.len() != n) {
        return Err(Error::usage("the matrix does not fit the fields")
            .got(counted(matrix.len(), "row"))
            .expected(format!("{n} × {n} matrix")));
    }
    finite("the centre", centre)?;
    matrix.iter().try_for_each(|row| finite("the matrix", row))
}

/// |K (v − centre)|².
pub(super) fn distance_squared(centre: &[f64], matrix: &[Vec<f64>], v: &[f64]) -> f64 {
    let along = |row: &Vec<f64>| row.iter().zip(v).zip(centre).map(|((k, v), c)| k * (v - c)).sum::<f64>();
    matrix.iter().map(|row| along(row).powi(2)).sum()
}

pub(super) fn at(centre: &[f64], matrix: &[Vec<f64>], v: &[f64]) -> f64 {
    (-distance_squared(centre, matrix, v)).exp()
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct GaussianNdBounds {
    /// Indices of its fields among all fields; past the end where one is unknown.
    slots: Vec<usize>,
    centre: Vec<f64>,
    matrix: Vec<Vec<f64>>,
}

impl GaussianNdBounds {
    /// `names`: all further fields in their order.
    pub fn new(fields: &[String], centre: &[f64], matrix: &[Vec<f64>], names: &[&str]) -> Self {
        let slot = |field: &String| names.iter().position(|name| name == field).unwrap_or(usize::MAX);
        GaussianNdBounds {
            slots: fields.iter().map(slot).collect(),
            centre: centre.to_vec(),
            matrix: matrix.to_vec(),
        }
    }

    pub fn bound(&self, corners: &Corners) -> f64 {
        self.bound_of(corners, |along| along.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// A direction that separates the four points from the centre bounds the distance from below: by what is made of the
    /// points' places along it, all of which are positive.
    pub fn bound_of(&self, corners: &Corners, distance: impl Fn(&[f64; 4]) -> f64) -> f64 {
        let GaussianNdBounds { slots, centre, matrix } = self;
        let fields = corners.fields;
        if slots.iter().any(|&slot| slot >= fields.len()) {
            return 1.0;
        }
        let n = slots.len();
        let mut q = [[0.0; 4]; MAX_FIELDS];
        for i in 0..n {
            for j in 0..n {
                for v in 0..4 {
                    q[i][v] += matrix[i][j] * (fields[slots[j]][v] - centre[j]);
                }
            }
        }
        let mean: [f64; MAX_FIELDS] = std::array::from_fn(|i| q[i].iter().sum::<f64>());
        let length = mean.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 || length.is_nan() {
            return 1.0;
        }
        let along: [f64; 4] =
            std::array::from_fn(|v| (0..n).map(|i| q[i][v] * mean[i]).sum::<f64>() / length);
        if along.iter().all(|&x| x > 0.0) {
            let distance = distance(&along);
            gaussian(distance * distance)
        } else {
            1.0
        }
    }
}
