//! Statistics of several volumes together: steps of a series, or parts of a grid, also of other processes.
//!
//! The percentile of each volume is exact, and that of all together lies between the least and the largest of these. In
//! that interval the volumes below [`EDGES`] values are summed over all (which reads them a second time), and the percentile
//! is found between two of them by a straight line: off by a 4,096th of the interval at most, or as often narrowed down again.

use super::statistics::{FoundStatistics, measure, values, volumes, with_array_name};
use std::collections::BTreeMap;
use voltet_core::progress::Progress;
use voltet_core::transfer::StatisticsRequest;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Demand, RunContext};

/// The volume whose points have the values that are measured, in place of one that is read; `None`: that itself.
pub(crate) type VolumeView<'a> = dyn Fn(&Volume) -> Result<Option<Volume>> + 'a;

/// Pieces that the interval of a percentile is cut into.
const EDGES: usize = 4096;

/// Rounds in which the percentiles of a series are narrowed down: to a 4,096th of what its steps differ by.
pub(super) const SERIES_ROUNDS: usize = 1;

/// Rounds in which the percentiles of a grid in parts are narrowed down: to 6e-8 of what its parts differ by.
pub(super) const PART_ROUNDS: usize = 2;

/// The volume below the edges of an interval, over all steps.
struct Sums {
    /// From the least percentile of a step to the largest.
    interval: [f64; 2],
    below: Vec<f64>,
    total: f64,
}

impl Sums {
    fn edge(&self, i: usize) -> f64 {
        let share = i as f64 / EDGES as f64;
        self.interval[0] * (1.0 - share) + self.interval[1] * share
    }

    /// Before any volume is looked at.
    fn new(interval: [f64; 2]) -> Sums {
        Sums { interval, below: vec![0.0; EDGES + 1], total: 0.0 }
    }

    /// The edges between which a percentile lies.
    fn narrowed(&self, percent: f64) -> [f64; 2] {
        let wanted = percent / 100.0 * self.total;
        match self.below.partition_point(|&volume| volume < wanted) {
            0 => [self.interval[0]; 2],
            above if above > EDGES => [self.interval[1]; 2],
            above => [self.edge(above - 1), self.edge(above)],
        }
    }

    /// Value below which so many percent of the volume lie.
    fn percentile(&self, percent: f64) -> f64 {
        let wanted = percent / 100.0 * self.total;
        let above = self.below.partition_point(|&volume| volume < wanted);
        if above == 0 || above > EDGES {
            return self.interval[usize::from(above > 0)];
        }
        let [low, high] = [self.below[above - 1], self.below[above]];
        let share = (wanted - low) / (high - low);
        let [a, b] = [self.edge(above - 1), self.edge(above)];
        (a * (1.0 - share) + b * share).clamp(a, b)
    }
}

/// Work on one of several volumes.
type VolumeCallback<'a> = dyn FnMut(&Volume, &dyn Progress) -> Result<()> + 'a;

/// Volumes that are measured together.
pub(super) trait SeveralVolumes {
    /// Hands on all of them, one after the other.
    fn each(&mut self, of_volume: &mut VolumeCallback) -> Result<()>;

    /// Numbers that each process found in its volumes.
    fn gather(&self, own: Vec<f64>) -> Result<Vec<Vec<f64>>> {
        Ok(vec![own])
    }
}

pub(super) struct SeriesSteps<'a, 'c> {
    pub call: &'a RunContext<'c>,
    pub demand: &'a Demand,
    pub steps: &'a [usize],
    pub view: &'a VolumeView<'a>,
    pub read: u64,
}

impl SeveralVolumes for SeriesSteps<'_, '_> {
    fn each(&mut self, of_volume: &mut VolumeCallback) -> Result<()> {
        let SeriesSteps { call, demand, steps, view, read } = self;
        call.each_step("volume", demand, Some(steps), &mut |_, value: voltet_graph::Value| {
            *read += 1;
            let Some(volume) = value.volume().transpose()? else { return Ok(()) };
            match view(&volume)? {
                Some(other) => of_volume(&other, call.progress()),
                None => of_volume(&volume, call.progress()),
            }
        })
    }
}

/// Parts of a grid, of this process and of others.
pub(super) struct GridParts<'a, 'c>(pub &'a mut RunContext<'c>);

impl SeveralVolumes for GridParts<'_, '_> {
    fn each(&mut self, of_volume: &mut VolumeCallback) -> Result<()> {
        self.0.each_part(&mut |call| of_volume(&*call.volume("volume")?, call.progress()))
    }

    fn gather(&self, own: Vec<f64>) -> Result<Vec<Vec<f64>>> {
        self.0.gather(&own)
    }
}

/// The least and the largest of several intervals; NaN of none.
fn widest(intervals: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    // The minimum with NaN is the other number.
    intervals.fold([f64::NAN; 2], |[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// Statistics that a volume has: those of quantities with finite values.
fn wanted_of_finite(volume: &Volume, wanted: &StatisticsRequest) -> Result<StatisticsRequest> {
    let mut own = wanted.clone();
    for quantity in wanted.quantities() {
        if values(volume, quantity)?.iter().all(|value| !value.is_finite()) {
            own.ranges.retain(|other| other != quantity);
            own.percentiles.retain(|other, _| other != quantity);
        }
    }
    Ok(own)
}

/// Statistics of several volumes together. They are looked at again for each round in which percentiles are narrowed down.
pub(super) fn measure_several(
    wanted: &StatisticsRequest,
    rounds: usize,
    volumes_of: &mut dyn SeveralVolumes,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    if wanted.is_empty() {
        return Ok(found);
    }
    let percents =
        wanted.percentiles.iter().flat_map(|(array, all)| all.iter().map(move |bits| (array.clone(), *bits)));
    let percents: Vec<(ArrayRef, u64)> = percents.collect();
    // Of each range and percentile the interval over all volumes.
    let mut intervals = vec![[f64::NAN; 2]; wanted.ranges.len() + percents.len()];
    volumes_of.each(&mut |volume, progress| {
        let own = measure(volume, &wanted_of_finite(volume, wanted)?, progress)?;
        let ranges = wanted.ranges.iter().map(|quantity| own.ranges.get(quantity).copied());
        let values = percents.iter().map(|key| own.percentiles.get(key).map(|value| [*value; 2]));
        for (known, own) in intervals.iter_mut().zip(ranges.chain(values)) {
            *known = widest([*known].into_iter().chain(own));
        }
        Ok(())
    })?;
    let of_all = volumes_of.gather(intervals.concat())?;
    let interval =
        |k: usize| widest(of_all.iter().filter_map(|own| Some([*own.get(2 * k)?, *own.get(2 * k + 1)?])));
    let quantities = wanted.ranges.iter().chain(percents.iter().map(|(quantity, _)| quantity));
    if let Some((_, quantity)) = quantities.enumerate().find(|(k, _)| interval(*k)[0].is_nan()) {
        let error = Error::run("a field has no finite values, so nothing can be relative to them");
        return Err(with_array_name(quantity, error));
    }
    for (k, quantity) in wanted.ranges.iter().enumerate() {
        found.ranges.insert(quantity.clone(), interval(k));
    }
    let mut sums: BTreeMap<(ArrayRef, u64), Sums> = BTreeMap::new();
    for (k, key) in percents.into_iter().enumerate() {
        let interval = interval(wanted.ranges.len() + k);
        let percent = f64::from_bits(key.1);
        if interval[0] == interval[1] || percent <= 0.0 || percent >= 100.0 {
            // Of 0 % the least of all, of 100 % the largest.
            found.percentiles.insert(key, interval[usize::from(percent > 0.0)]);
        } else {
            sums.insert(key, Sums::new(interval));
        }
    }
    for _ in 0..if sums.is_empty() { 0 } else { rounds } {
        for ((_, bits), own) in &mut sums {
            if own.total > 0.0 {
                *own = Sums::new(own.narrowed(f64::from_bits(*bits)));
            }
        }
        volumes_of.each(&mut |volume, progress| {
            for quantity in wanted.percentiles.keys() {
                let mut own = sums.iter_mut().filter(|((array, _), _)| array == quantity).peekable();
                if own.peek().is_none() {
                    continue;
                }
                if values(volume, quantity)?.iter().all(|value| !value.is_finite()) {
                    continue;
                }
                let volumes = volumes(volume, quantity, progress)?;
                for (_, sums) in own {
                    let edges: Vec<f64> = (0..=EDGES).map(|i| sums.edge(i)).collect();
                    let own = volumes.below_each(&edges, progress)?;
                    sums.below.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                    sums.total += volumes.total();
                }
            }
            Ok(())
        })?;
        let own: Vec<f64> =
            sums.values().flat_map(|own| own.below.iter().copied().chain([own.total])).collect();
        let of_all = volumes_of.gather(own)?;
        for (own, first) in sums.values_mut().zip((0..).step_by(EDGES + 2)) {
            let sum = |at: usize| of_all.iter().filter_map(|numbers| numbers.get(first + at)).sum::<f64>();
            own.below = (0..=EDGES).map(sum).collect();
            own.total = sum(EDGES + 1);
        }
    }
    for (key, sums) in sums {
        let value = sums.percentile(f64::from_bits(key.1));
        found.percentiles.insert(key, value);
    }
    Ok(found)
}
