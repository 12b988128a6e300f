//! Statistics of the data's quantities: their ranges, and the volume below each value. They convert numbers relative to
//! data to absolute ones and back.

use std::borrow::Cow;
use std::collections::BTreeMap;
use voltet_core::grid::Grid;
use voltet_core::probing::Volumes;
use voltet_core::progress::Progress;
use voltet_core::transfer::DataStatistics;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::ArrayRef;
use voltet_nodes::relative;

/// Values that the volume below is found at: within the shown axis, and beyond it.
const KNOTS: [usize; 2] = [1024, 64];

/// The share of the volume below each value of a quantity; straight between the values that are known.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Spread {
    /// Rising.
    values: Vec<f64>,
    /// The volume below each: 0 to 1, rising, once it is finished.
    below: Vec<f64>,
    /// All of it, in the same measure.
    total: f64,
}

impl Spread {
    /// Nothing yet. `shown`: the axis on which it should be fine; the range is that of all values.
    pub(super) fn new([low, high]: [f64; 2], [least, most]: [f64; 2]) -> Spread {
        let even = |[from, to]: [f64; 2], count: usize| {
            (0..=count).map(move |i| {
                let share = i as f64 / count as f64;
                from * (1.0 - share) + to * share
            })
        };
        let beyond = even([least, low], KNOTS[1]).chain(even([high, most], KNOTS[1]));
        let mut values: Vec<f64> = even([low, high], KNOTS[0]).chain(beyond).collect();
        values.retain(|knot| (least..=most).contains(knot));
        values.sort_by(f64::total_cmp);
        values.dedup();
        Spread { below: vec![0.0; values.len()], total: 0.0, values }
    }

    /// Adds the values of a volume's points.
    pub(super) fn add(&mut self, grid: &Grid, values: &[f64], progress: &dyn Progress) -> Result<()> {
        let volumes = Volumes::new(grid, values, progress)?;
        let own = volumes.below_each(&self.values);
        self.below.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        self.total += volumes.total();
        Ok(())
    }

    /// As shares, once all is added.
    pub(super) fn finished(mut self) -> Spread {
        self.below.iter_mut().for_each(|below| *below = (*below / self.total).clamp(0.0, 1.0));
        if let Some(last) = self.below.last_mut() {
            *last = 1.0;
        }
        Spread { total: 1.0, ..self }
    }

    /// From what is known already, for tests.
    #[cfg(test)]
    pub(crate) fn from_knots(values: Vec<f64>, below: Vec<f64>) -> Spread {
        Spread { values, below, total: 1.0 }
    }

    /// The share of the volume below a value.
    pub fn below(&self, value: f64) -> f64 {
        between(&self.values, &self.below, value)
    }

    /// The value that so much of the volume lies below.
    pub fn value_at(&self, share: f64) -> f64 {
        between(&self.below, &self.values, share)
    }
}

/// On the straight line between the two places of `from` around `x`; the ends beyond them.
fn between(from: &[f64], to: &[f64], x: f64) -> f64 {
    let after = from.partition_point(|known| *known < x);
    match (after.checked_sub(1), from.get(after)) {
        (None, _) => to.first().copied().unwrap_or(x),
        (_, None) => to.last().copied().unwrap_or(x),
        (Some(before), Some(&high)) => {
            let low = from[before];
            let share = if high > low { (x - low) / (high - low) } else { 1.0 };
            to[before] * (1.0 - share) + to[after] * share
        }
    }
}

/// Statistics of the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct DataScales {
    /// Least and largest values.
    pub ranges: BTreeMap<ArrayRef, [f64; 2]>,
    /// Spreads of the plane's quantities.
    pub spreads: BTreeMap<ArrayRef, Spread>,
}

impl DataStatistics for DataScales {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        self.ranges.get(quantity).copied().ok_or_else(|| unknown(quantity))
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        let spread = self.spreads.get(quantity).ok_or_else(|| unknown(quantity))?;
        Ok(spread.value_at(percent / 100.0))
    }
}

fn unknown(quantity: &ArrayRef) -> Error {
    Error::run(format!("nothing is known yet of the values of {quantity}"))
}

/// The values of a quantity, one a point; where there is no gradient, *g* is 0.
pub(super) fn values_of<'a>(volume: &'a Volume, quantity: &ArrayRef) -> Result<Cow<'a, [f64]>> {
    match (quantity, &volume.gradient_magnitude) {
        (ArrayRef::Named("g"), None) => Ok(Cow::Owned(vec![0.0; volume.scalar.len()])),
        _ => relative::values(volume, quantity).map(Cow::Borrowed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_values_are_inverse_and_end_at_the_ends() {
        let spread =
            Spread { values: vec![0.0, 1.0, 3.0, 10.0], below: vec![0.0, 0.5, 0.9, 1.0], total: 1.0 };
        for value in [0.0, 0.25, 1.0, 2.0, 9.0, 10.0] {
            assert!((spread.value_at(spread.below(value)) - value).abs() < 1e-12, "{value}");
        }
        assert_eq!([spread.below(-5.0), spread.below(50.0)], [0.0, 1.0]);
        assert_eq!([spread.value_at(0.0), spread.value_at(1.0)], [0.0, 10.0]);
        assert!((spread.below(2.0) - 0.7).abs() < 1e-12);
    }
}
