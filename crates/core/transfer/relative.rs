//! Widgets whose numbers are relative to data: their values once the data are known, and placeholders before.

use super::axis::AxisScale;
use super::kinds::ACROSS;
use crate::parameters::{
    ArrayRef, LocatedValue, ParameterType, ParameterValue, Parameters, Relative, RelativeNumber,
    RelativeNumberType, StatisticKind,
};
use crate::{Error, Result};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Statistics required of the data: ranges, and percentiles (as the bits of a percentage) of arrays.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StatisticsRequest {
    /// Quantities whose range is wanted.
    pub ranges: BTreeSet<ArrayRef>,
    /// Percentiles of each quantity, as the bits of the percentage from 0 to 100.
    pub percentiles: BTreeMap<ArrayRef, BTreeSet<u64>>,
}

impl StatisticsRequest {
    /// True if nothing is.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty() && self.percentiles.is_empty()
    }

    /// Every quantity, once.
    pub fn quantities(&self) -> BTreeSet<&ArrayRef> {
        self.ranges.iter().chain(self.percentiles.keys()).collect()
    }
}

/// Provider of data statistics.
pub trait DataStatistics {
    /// The least and the largest value of a quantity, both finite.
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]>;
    /// The value that a quantity has or falls below in so many percent of the volume.
    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64>;
    /// Scale of the quantity's axis, on which shares are counted and widths are lengths.
    fn scale(&self, _quantity: &ArrayRef) -> AxisScale {
        AxisScale::Linear
    }
}

/// The parameters of a widget with every relative number replaced by what it is on these scales.
///
/// Errors, at the number's place: a width that is a share of a range of length 0; those of the scales.
pub fn resolved(p: &Parameters, scales: &dyn DataStatistics) -> Result<Parameters> {
    let across = |number: &RelativeNumber| number.quantity == ArrayRef::Named(ACROSS);
    let one = |number: &RelativeNumber, length: &dyn Fn() -> Result<f64>| -> Result<f64> {
        let found = value(number, scales, length).map_err(|error| number.locate(error))?;
        match found.is_finite() {
            true => Ok(found),
            false => Err(number.locate(Error::run("a number relative to data is not finite").got(found))),
        }
    };
    // The length across the bands follows from the other numbers.
    let others = p.with_numbers(&mut |number| match across(number) {
        true => Ok(1.0),
        false => one(number, &|| length(&number.quantity, scales)),
    })?;
    let numbers = p.relative_numbers();
    if !numbers.iter().any(across) {
        return Ok(others);
    }
    p.with_numbers(&mut |number| match across(number) {
        true => one(number, &|| length_across(&others, scales)),
        false => one(number, &|| length(&number.quantity, scales)),
    })
}

/// Statistics that [`resolved`] will require.
pub fn statistics_request(p: &Parameters) -> StatisticsRequest {
    let recorder = Recorder::default();
    // Its answers make no errors that those of the data would not.
    let _ = resolved(p, &recorder);
    recorder.0.into_inner()
}

fn value(
    number: &RelativeNumber,
    scales: &dyn DataStatistics,
    length: &dyn Fn() -> Result<f64>,
) -> Result<f64> {
    match (number.relative, number.is) {
        (Relative::Percentile(percent), _) => scales.percentile(&number.quantity, percent),
        (Relative::Share(share), StatisticKind::Value | StatisticKind::Place) => {
            let scale = scales.scale(&number.quantity);
            Ok(scale.value(Relative::at_share(share, scale.positions(scales.range(&number.quantity)?))))
        }
        (Relative::Share(share), StatisticKind::Width) => Ok(share * length()?),
        (Relative::Share(share), StatisticKind::Factor) => Ok(1.0 / (share * length()?)),
    }
}

/// The length of a quantity's range, above 0.
pub(super) fn length(quantity: &ArrayRef, scales: &dyn DataStatistics) -> Result<f64> {
    if let ArrayRef::Per(one, other) = quantity {
        return Ok(length(one, scales)? / length(other, scales)?);
    }
    let [low, high] = scales.scale(quantity).positions(scales.range(quantity)?);
    match high - low {
        length if length > 0.0 => Ok(length),
        _ => {
            Err(Error::run(format!("{quantity} is the same everywhere, so a share of its range is no width"))
                .got(format!("{quantity} = {low:?}"))
                .expected("a number"))
        }
    }
}

/// See [`ACROSS`]; `p`: the wave's parameters, its scale known.
fn length_across(p: &Parameters, scales: &dyn DataStatistics) -> Result<f64> {
    let (sin, cos) = p.number("angle")?.to_radians().sin_cos();
    let [ws, wg]: [f64; 2] = p.vector("scale")?;
    // A right angle in degrees leaves a cosine of 6e-17, which means 0.
    let of = |factor: f64, name: &'static str| -> Result<f64> {
        match factor.abs() > 1e-15 * (ws.abs() + wg.abs()) {
            true => Ok(factor.abs() * length(&ArrayRef::Named(name), scales)?),
            false => Ok(0.0),
        }
    };
    match of(cos * ws, "s")? + of(sin * wg, "g")? {
        length if length > 0.0 => Ok(length),
        _ => Err(Error::usage("the wave has no bands: its scale is 0 in the direction of its angle")),
    }
}

/// Notes what is asked of it.
#[derive(Default)]
struct Recorder(RefCell<StatisticsRequest>);

impl DataStatistics for Recorder {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        self.0.borrow_mut().ranges.insert(quantity.clone());
        Ok([0.0, 1.0])
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        let percentiles = &mut self.0.borrow_mut().percentiles;
        percentiles.entry(quantity.clone()).or_default().insert(percent.to_bits());
        Ok(percent)
    }
}

/// The parameters of a widget as far as they can be judged before any data are known: lists of shares alone, and of percentiles
/// alone, are judged as these; where numbers of several sorts stand in one list, their order is that of the list.
pub fn with_placeholders(p: &Parameters) -> Result<Parameters> {
    p.with_settings(&mut |measured, name, setting, _| {
        let mut sorts = Vec::new();
        let plain = measured.replaced(name, setting, 0, &mut |_, _, relative| {
            sorts.push(relative);
            Ok(match relative {
                Relative::Share(share) => share,
                Relative::Percentile(percent) => percent / 100.0,
            })
        })?;
        if sorts.is_empty() || matches!(measured.statistic, StatisticKind::Width | StatisticKind::Factor) {
            return Ok(plain);
        }
        let all_shares = sorts.iter().all(|sort| matches!(sort, Relative::Share(_)));
        let alike = all_shares || sorts.iter().all(|sort| matches!(sort, Relative::Percentile(_)));
        let rows = setting.list().is_some_and(|list| list.iter().any(|row| row.list().is_some()));
        match (rows, measured.plain) {
            (_, _) if alike && sorts.len() == measured.number_count(setting) && (all_shares || !rows) => {
                Ok(plain)
            }
            (true, ParameterType::Rows(Some(2))) => Ok(triangle(setting)),
            _ => Ok(ascending(&plain, rows, measured)),
        }
    })
}

/// The numbers that may be relative by their place in the list, or that of their row.
fn ascending(plain: &LocatedValue, rows: bool, measured: &RelativeNumberType) -> LocatedValue {
    let number = |place: usize| LocatedValue {
        datum: ParameterValue::Number(place as f64),
        origin: plain.origin.clone(),
    };
    let Some(list) = plain.list() else { return plain.clone() };
    let parts = list.iter().enumerate().map(|(place, part)| match part.list().filter(|_| rows) {
        Some(row) => {
            let cells = row.iter().enumerate();
            let cells =
                cells.map(|(k, cell)| if measured.may_be_relative(k) { number(place) } else { cell.clone() });
            LocatedValue { datum: ParameterValue::List(cells.collect()), origin: part.origin.clone() }
        }
        None => number(place),
    });
    LocatedValue { datum: ParameterValue::List(parts.collect()), origin: plain.origin.clone() }
}

/// A polygon in the place of one whose corners are not known.
fn triangle(setting: &LocatedValue) -> LocatedValue {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(ParameterValue::from_iter);
    LocatedValue { datum: corners.into_iter().collect(), origin: setting.origin.clone() }
}
