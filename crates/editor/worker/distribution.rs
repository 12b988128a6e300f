//! The distribution of the data over two quantities, weighted by volume, and statistics of the quantities (of this volume, or of all
//! steps of its series): ranges, and the volume below each value, by which numbers relative to data become absolute ones and back.

use super::query::{Query, QueryRun};
use super::request::VolumeSource;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::Grid;
use voltet_core::probing::{Axis, Histogram, Volumes, histogram, value_range};
use voltet_core::progress::{PartProgress, Progress};
use voltet_core::transfer::{AxisScale, DECADES, DataStatistics};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Demand, RunContext};
use voltet_nodes::relative::{self, DataScope};

const BINS: usize = 256;

/// Stage of a distribution that is being computed.
pub(crate) const HISTOGRAM: &str = "histogram";

/// Shares of the time of a distribution that pass with the volumes by *g* alone, and with those by both quantities.
const SHARES: [f64; 2] = [0.2, 0.5];

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DistributionQuery {
    pub source: VolumeSource,
    /// Along which quantities: "s", "g", or arrays.
    pub axes: [ArrayRef; 2],
    /// Scales of s and g.
    pub scales: [AxisScale; 2],
    pub fields: Vec<String>,
    /// Data that relative numbers refer to.
    pub scope: DataScope,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Distribution {
    /// Along positions on the axes.
    pub histogram: Histogram,
    /// Ranges, and the volume below each value of the axes: of this volume, or of all steps of its series.
    pub known: DataScales,
    /// Name of the array that is s.
    pub scalar: String,
}

impl DistributionQuery {
    fn quantities(&self) -> Vec<ArrayRef> {
        let mut all = self.axes.to_vec();
        let arrays = self.fields.iter().map(|name| ArrayRef::Array(name.clone()));
        for quantity in arrays.chain(["s", "g"].map(ArrayRef::Named)) {
            if !all.contains(&quantity) {
                all.push(quantity);
            }
        }
        all
    }

    /// Exact within every cell. Along *g* it reaches as far as nearly all of the volume does: a few slivers have gradients of
    /// many times that. Where there is no gradient, *g* is 0.
    fn find(&self, call: &RunContext) -> Result<Distribution> {
        let (volume, whole) = (call.volume("volume")?, call.progress());
        let part = |range| PartProgress { whole, stage: HISTOGRAM, range };
        let scales = self.axes.each_ref().map(|quantity| scale_of(&self.scales, quantity));
        let placed = |axis: usize| -> Result<Cow<'_, [f64]>> {
            let (values, scale) = (values_of(&volume, &self.axes[axis])?, scales[axis]);
            Ok(match scale.is_curved() {
                true => values.iter().map(|value| scale.position(*value)).collect(),
                false => values,
            })
        };
        let [x, y] = [placed(0)?, placed(1)?];
        let grid = &volume.grid;
        let mut axes = [Axis::over(&x, BINS), Axis::over(&y, BINS)];
        for (axis, positions) in [&x, &y].into_iter().enumerate() {
            if scales[axis].is_curved() {
                axes[axis].low = axes[axis].low.max(axes[axis].high - DECADES);
            } else if self.axes[axis] == ArrayRef::Named("g") {
                axes[axis] = of_nearly_all(grid, positions, &part([0.0, SHARES[0]]))?;
            }
        }
        let histogram = histogram(grid, [&x, &y], axes, &part(SHARES))?;
        let shown = [0, 1].map(|k| [axes[k].low, axes[k].high].map(|position| scales[k].value(position)));
        let (quantities, scales) = (self.quantities(), self.scales);
        let steps = self.scope.steps(call.step_count("volume")?);
        let known = match &steps {
            Some(steps) => {
                let has_gradient = volume.gradient_magnitude.is_some();
                series_scales(call, (quantities, steps), (shown, scales), has_gradient)?
            }
            None => DataScales::find(&quantities, (shown, scales), (whole, 1), |look| look(Some(&volume)))?,
        };
        Ok(Distribution { histogram, known, scalar: grid.scalar_name.clone() })
    }
}

/// Scale of a quantity's axis, of those of s and g.
fn scale_of(scales: &[AxisScale; 2], quantity: &ArrayRef) -> AxisScale {
    match quantity {
        ArrayRef::Named("s") => scales[0],
        ArrayRef::Named("g") => scales[1],
        _ => AxisScale::Linear,
    }
}

fn arrays(quantities: &[ArrayRef]) -> BTreeSet<String> {
    let name = |quantity: &ArrayRef| match quantity {
        ArrayRef::Array(name) => Some(name.clone()),
        ArrayRef::Named(_) | ArrayRef::Per(..) => None,
    };
    quantities.iter().filter_map(name).collect()
}

/// The axis from 0 to what nearly all of the volume lies below.
fn of_nearly_all(grid: &Grid, g: &[f64], progress: &dyn Progress) -> Result<Axis> {
    let [low, high] = value_range(g)?;
    let whole = Axis { low: low.min(0.0), high: if high > 0.0 { high } else { 1.0 }, bins: 16 * BINS };
    if low == high {
        return Ok(Axis { bins: BINS, ..whole });
    }
    let (flat, nothing) = (Axis { low: 0.0, high: 1.0, bins: 1 }, vec![0.5; g.len()]);
    let coarse = histogram(grid, [&nothing, g], [flat, whole], progress)?;
    Ok(Axis { high: coarse.nearly_all(), bins: BINS, ..whole })
}

impl Query for DistributionQuery {
    type Reply = Arc<Distribution>;
    const WAITS: bool = true;
    const STAGE: Option<&'static str> = Some(HISTOGRAM);

    fn answer(&self, run: &mut QueryRun) -> Result<Arc<Distribution>> {
        self.source.feed(run, &arrays(&self.quantities()), &[], |call| self.find(call)).map(Arc::new)
    }
}

/// Values that the volume below is found at: within the shown axis, and beyond it.
const KNOTS: [usize; 2] = [1024, 64];

/// The share of the volume below each value of a quantity; straight between the values that are known.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Spread {
    /// Rising.
    pub values: Vec<f64>,
    /// The volume below each: 0 to 1, rising, once it is finished.
    pub below: Vec<f64>,
    /// All of it, in the same measure.
    pub total: f64,
}

impl Spread {
    /// Nothing yet. `shown`: the axis on which it should be fine; the range is that of all values.
    fn new([low, high]: [f64; 2], [least, most]: [f64; 2], scale: AxisScale) -> Spread {
        let even = |range: [f64; 2], count: usize| {
            let [from, to] = scale.positions(range);
            let inner = (1..count).map(move |i| {
                let share = i as f64 / count as f64;
                scale.value(from * (1.0 - share) + to * share)
            });
            inner.chain(range)
        };
        let beyond = even([least, low], KNOTS[1]).chain(even([high, most], KNOTS[1]));
        let mut values: Vec<f64> = even([low, high], KNOTS[0]).chain(beyond).collect();
        values.retain(|knot| (least..=most).contains(knot));
        values.sort_by(f64::total_cmp);
        values.dedup();
        Spread { below: vec![0.0; values.len()], total: 0.0, values }
    }

    fn add(&mut self, grid: &Grid, values: &[f64], progress: &dyn Progress) -> Result<()> {
        let volumes = Volumes::new(grid, values, progress)?;
        let own = volumes.below_each(&self.values, progress)?;
        self.below.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        self.total += volumes.total();
        Ok(())
    }

    /// As shares, once all is added.
    fn finished(mut self) -> Spread {
        self.below.iter_mut().for_each(|below| *below = (*below / self.total).clamp(0.0, 1.0));
        if let Some(last) = self.below.last_mut() {
            *last = 1.0;
        }
        Spread { total: 1.0, ..self }
    }

    pub fn below(&self, value: f64) -> f64 {
        between(&self.values, &self.below, value)
    }

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

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct DataScales {
    /// Scales of s and g.
    pub axes: [AxisScale; 2],
    pub ranges: BTreeMap<ArrayRef, [f64; 2]>,
    pub spreads: BTreeMap<ArrayRef, Spread>,
}

impl DataScales {
    /// Scales of all volumes that `each` calls a function with; none stands for a step without one. It is called twice: for the ranges, and
    /// for the volumes below values within them. `quantities`: those of the plane's axes first; `shown`: the values at the ends of
    /// these axes; `step_count`: how often it calls.
    fn find(
        quantities: &[ArrayRef],
        (shown, axes): ([[f64; 2]; 2], [AxisScale; 2]),
        (whole, step_count): (&dyn Progress, usize),
        each: impl Fn(&mut dyn FnMut(Option<&Volume>) -> Result<()>) -> Result<()>,
    ) -> Result<DataScales> {
        // Ranges of one volume take no time; of several each is read for them.
        let round_count = if step_count > 1 { 2.0 } else { 1.0 };
        let share = |steps: f64| {
            SHARES[1] + (1.0 - SHARES[1]) * (steps / (round_count * step_count.max(1) as f64)).min(1.0)
        };
        let mut steps = 0.0;
        let mut known = DataScales { axes, ..DataScales::default() };
        each(&mut |volume| {
            for (quantity, volume) in quantities.iter().flat_map(|own| volume.map(|volume| (own, volume))) {
                let [low, high] = value_range(&values_of(volume, quantity)?)?;
                let range = known.ranges.entry(quantity.clone()).or_insert([low, high]);
                *range = [range[0].min(low), range[1].max(high)];
            }
            if round_count > 1.0 {
                steps += 1.0;
                whole.report(HISTOGRAM, share(steps));
            }
            Ok(())
        })?;
        for (quantity, shown) in quantities.iter().zip(shown) {
            let spread = Spread::new(shown, known.ranges[quantity], scale_of(&axes, quantity));
            known.spreads.insert(quantity.clone(), spread);
        }
        let part = 1.0 / known.spreads.len().max(1) as f64;
        each(&mut |volume| {
            let Some(volume) = volume else {
                steps += 1.0;
                whole.report(HISTOGRAM, share(steps));
                return Ok(());
            };
            for (quantity, spread) in &mut known.spreads {
                let range = [share(steps), share(steps + part)];
                let progress = PartProgress { whole, stage: HISTOGRAM, range };
                spread.add(&volume.grid, &values_of(volume, quantity)?, &progress)?;
                steps += part;
            }
            Ok(())
        })?;
        known.spreads.values_mut().for_each(|spread| *spread = std::mem::take(spread).finished());
        Ok(known)
    }
}

impl DataStatistics for DataScales {
    fn scale(&self, quantity: &ArrayRef) -> AxisScale {
        scale_of(&self.axes, quantity)
    }

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
fn values_of<'a>(volume: &'a Volume, quantity: &ArrayRef) -> Result<Cow<'a, [f64]>> {
    match (quantity, &volume.gradient_magnitude) {
        (ArrayRef::Named("g"), None) => Ok(Cow::Owned(vec![0.0; volume.scalar.len()])),
        _ => relative::values(volume, quantity).map(Cow::Borrowed),
    }
}

/// Statistics of steps of the series, by the quantities, the bits of the ends of the axes, and the steps that they are of.
type SeriesCache = Mutex<Vec<((Vec<ArrayRef>, [[u64; 2]; 2], Vec<usize>), DataScales)>>;

/// Scales of steps of a series, one at a time, as the transfer function looks at them. `quantities`: those of the plane's axes first;
/// `shown`: the values at the ends of these axes.
fn series_scales(
    call: &RunContext,
    (quantities, steps): (Vec<ArrayRef>, &[usize]),
    (shown, axes): ([[f64; 2]; 2], [AxisScale; 2]),
    gradient_magnitude: bool,
) -> Result<DataScales> {
    let mut demand = Demand { gradient_magnitude, ..Demand::default() };
    demand.arrays.named.extend(arrays(&quantities));
    let kept: Arc<SeriesCache> = call.keep_over_steps("volume", &demand, || Ok(SeriesCache::default()))?;
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    let key = (quantities, shown.map(|ends| ends.map(f64::to_bits)), steps.to_vec());
    if let Some((_, known)) = kept.iter().find(|(of, known)| *of == key && known.axes == axes) {
        return Ok(known.clone());
    }
    let known = DataScales::find(&key.0, (shown, axes), (call.progress(), steps.len()), |look| {
        call.each_step("volume", &demand, Some(steps), &mut |_, value| match value.volume() {
            Some(volume) => look(Some(&*volume?)),
            None => look(None),
        })
    })?;
    kept.push((key, known.clone()));
    Ok(known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use voltet_core::SharedSlice;
    use voltet_core::grid::generate::box_of_tetrahedra;

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

    struct Shares(Mutex<Vec<f64>>);

    impl Progress for Shares {
        fn report(&self, stage: &str, fraction: f64) {
            assert_eq!(stage, HISTOGRAM);
            self.0.lock().unwrap().push(fraction);
        }
    }

    #[test]
    fn shares_of_a_series_rise_over_both_rounds_to_all_of_it() {
        let grid = Arc::new(box_of_tetrahedra([12; 3], [DVec3::ZERO, DVec3::ONE], 0.1));
        let scalar = SharedSlice::from(grid.points.iter().map(|point| point.x).collect::<Vec<_>>());
        let volume = Volume { grid, scalar, gradient: None, gradient_magnitude: None };
        // One more quantity than has a spread.
        let quantities = ["s", "g", "s"].map(ArrayRef::Named);
        for (steps, first) in
            [(vec![Some(&volume)], None), (vec![Some(&volume), None, Some(&volume)], Some(3))]
        {
            let shares = Shares(Mutex::default());
            let axes = ([[0.0, 1.0]; 2], [AxisScale::Linear; 2]);
            let each = |look: &mut dyn FnMut(Option<&Volume>) -> Result<()>| {
                steps.iter().try_for_each(|volume| look(*volume))
            };
            DataScales::find(&quantities, axes, (&shares, steps.len()), each).unwrap();
            let shares = shares.0.into_inner().unwrap();
            assert!((shares.iter().copied().fold(0.0, f64::max) - 1.0).abs() < 1e-12, "{shares:?}");
            if let Some(first) = first {
                let half = SHARES[1] + 0.5 * (1.0 - SHARES[1]);
                assert!(
                    shares[..first].is_sorted() && (shares[first - 1] - half).abs() < 1e-12,
                    "{shares:?}"
                );
                assert!(shares[first..].iter().all(|share| *share > half), "{shares:?}");
            }
        }
    }

    #[test]
    fn stages_of_nodes_are_shown_before_the_first_share_alone() {
        let mut exchange = super::super::query::Exchange::<DistributionQuery>::default();
        let told = [("reading", 0.5), (HISTOGRAM, 0.1), ("gradient", 0.7), (HISTOGRAM, 0.2)].map(
            |(stage, share)| {
                exchange.advance(0, stage, share);
                exchange.progress().map(|(stage, share)| (stage.to_string(), share)).unwrap()
            },
        );
        let wanted = [("reading", 0.5), (HISTOGRAM, 0.1), (HISTOGRAM, 0.1), (HISTOGRAM, 0.2)];
        assert_eq!(told, wanted.map(|(stage, share)| (stage.to_string(), share)));
    }
}
