//! `piecewise-linear`: colour and extinction linear between control points in s (Roettger & Ertl 2002; Moreland 2004).

use super::properties::{ColorSource, ControlPoint, NAME, Properties, REGION, finite, not_negative};
use crate::parameters::{
    AxisRef, DefaultValue, Parameter, ParameterType, Parameters, RelativeNumberType, StatisticKind,
    VariantSchema,
};
use crate::transfer::hull::Corners;
use crate::transfer::region::Slab;
use crate::{Error, Result};

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "piecewise-linear",
    summary: "Colour and extinction linear between control points in s, constant beyond the ends.",
    parameters: &[
        Parameter {
            name: "points",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Rows(Some(5)),
                statistic: StatisticKind::Value,
                axis: AxisRef::Places(&["s"]),
            }),
            unit: "(s, linear RGB, per unit_distance)",
            default: DefaultValue::Required,
            help: "control points [s, r, g, b, extinction], s rising",
        },
        REGION,
        NAME,
    ],
};

pub(super) fn read(p: &Parameters) -> Result<Vec<ControlPoint>> {
    let rows = p.rows("points")?;
    if rows.is_empty() {
        return Err(p
            .error("points", "there is no control point")
            .expected("at least one [s, r, g, b, extinction]"));
    }
    if let Some(pair) = rows.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let found = format!("{} after {}", pair[1][0], pair[0][0]);
        return Err(p.error("points", "the control points do not rise in s").got(found).expected("s rising"));
    }
    if let Some(row) = rows.iter().find(|row| row[1..].iter().any(|&x| x < 0.0)) {
        let error = p.error("points", "a control point has a negative colour or extinction");
        return Err(error.got(format!("{row:?}")).expected("0 or more"));
    }
    let point =
        |row: &Vec<f64>| ControlPoint { s: row[0], color: [row[1], row[2], row[3]], extinction: row[4] };
    Ok(rows.iter().map(point).collect())
}

fn peak(points: &[ControlPoint]) -> f64 {
    points.iter().map(|p| p.extinction).fold(0.0, f64::max)
}

pub(super) fn properties(points: &[ControlPoint]) -> Properties<'_> {
    Properties {
        name: KIND.name,
        color: ColorSource::Points(points),
        own_peak: Some(peak(points)),
        jumps: points.windows(2).any(|pair| pair[1].s <= pair[0].s),
        ..Properties::PLAIN
    }
}

pub(super) fn check(points: &[ControlPoint]) -> Result<()> {
    if points.is_empty() {
        return Err(Error::usage("a piecewise-linear widget has no control points").expected("at least one"));
    }
    for (i, point) in points.iter().enumerate() {
        let place = |e: Error| e.at_item(format!("points[{i}]"));
        finite("the scalar of a control point", &[point.s]).map_err(place)?;
        not_negative("the extinction of a control point", point.extinction).map_err(place)?;
        for c in point.color {
            not_negative("a colour component", c).map_err(place)?;
        }
    }
    match points.windows(2).find(|pair| pair[1].s < pair[0].s) {
        None => Ok(()),
        Some(pair) => Err(Error::usage("control points are not in rising order of the scalar")
            .got(format!("{} after {}", pair[1].s, pair[0].s))),
    }
}

/// From the first control point to the last; everywhere for one that is the same everywhere.
pub(super) fn scalar_range(points: &[ControlPoint]) -> [f64; 2] {
    let is_same = |pair: &[ControlPoint]| pair[0] == ControlPoint { s: pair[0].s, ..pair[1] };
    match points {
        [first, .., last] if !points.windows(2).all(is_same) => [first.s, last.s],
        _ => [f64::NEG_INFINITY, f64::INFINITY],
    }
}

/// The ranges of s in which the function absorbs, a list of one slab each.
pub(super) fn slabs(points: &[ControlPoint]) -> Vec<Vec<Slab>> {
    let lit = |k: usize| points.get(k).is_some_and(|point| point.extinction > 0.0);
    let mut runs = Vec::new();
    let mut k = 0;
    while k < points.len() {
        if !lit(k) {
            k += 1;
            continue;
        }
        let first = k;
        while lit(k) {
            k += 1;
        }
        // Extinction falls to 0 at the neighbour, or stays beyond the ends.
        let low = if first == 0 { f64::NEG_INFINITY } else { points[first - 1].s };
        let high = points.get(k).map_or(f64::INFINITY, |point| point.s);
        runs.push(vec![Slab { normal: [1.0, 0.0], low, high }]);
    }
    runs
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::transfer) struct PiecewiseLinearBounds {
    /// Without colours, extinctions by their peak.
    points: Vec<ControlPoint>,
}

impl PiecewiseLinearBounds {
    pub fn new(points: &[ControlPoint]) -> Self {
        let peak = peak(points);
        let share = |extinction: f64| if peak > 0.0 { extinction / peak } else { 0.0 };
        let shape =
            |p: &ControlPoint| ControlPoint { s: p.s, color: [0.0; 3], extinction: share(p.extinction) };
        PiecewiseLinearBounds { points: points.iter().map(shape).collect() }
    }

    pub fn bound(&self, corners: &Corners) -> f64 {
        let (low, high) = corners.s_range();
        self.points_in_range([low, high]).fold(0.0, f64::max)
    }

    /// The least between two scalars.
    pub fn min_in_range(&self, range: [f64; 2]) -> f64 {
        self.points_in_range(range).fold(f64::INFINITY, f64::min)
    }

    /// Values at both ends and at the control points between.
    fn points_in_range(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
        let points = &self.points;
        let first = points.partition_point(|p| p.s < low);
        let last = points.partition_point(|p| p.s <= high).max(first);
        let inside = points[first..last].iter().map(|p| p.extinction);
        inside.chain([low, high].map(|s| extinction_at(points, s)))
    }
}

/// The share of the peak at s.
pub(super) fn at(points: &[ControlPoint], s: f64) -> f64 {
    let peak = peak(points);
    if peak > 0.0 { extinction_at(points, s) / peak } else { 0.0 }
}

fn extinction_at(points: &[ControlPoint], s: f64) -> f64 {
    ControlPoint::between(points, s).map_or(0.0, |point| point.extinction)
}

impl ControlPoint {
    /// Interpolated control point at s (points in rising s): linear, constant beyond the ends; `None` of no points.
    pub fn between(points: &[ControlPoint], s: f64) -> Option<ControlPoint> {
        let after = points.partition_point(|p| p.s <= s);
        match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
            (Some(low), Some(high)) => {
                let x = (s - low.s) / (high.s - low.s);
                let mixed = |low: f64, high: f64| low + (high - low) * x;
                let color = [0, 1, 2].map(|k| mixed(low.color[k], high.color[k]));
                Some(ControlPoint { s, color, extinction: mixed(low.extinction, high.extinction) })
            }
            (Some(only), None) => Some(ControlPoint { s, ..only }),
            (None, Some(only)) => Some(ControlPoint { s, ..*only }),
            (None, None) => None,
        }
    }
}
