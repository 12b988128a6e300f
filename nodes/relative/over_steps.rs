//! Ranges and percentiles of all steps of a time series together.
//!
//! Each step's own percentile is exact, and that of all steps together lies between the least and the largest of these. In that
//! interval the volumes below [`EDGES`] values are summed over all steps (which reads them a second time), and the percentile
//! is found between two of them by a straight line: off by a 4,096th of the interval at most.

use super::statistics::FoundStatistics;
use super::volume::{measure as measure_one, values, with_array_name};
use std::collections::BTreeMap;
use voltet_core::Result;
use voltet_core::probing::Volumes;
use voltet_core::transfer::StatisticsRequest;
use voltet_core::volume::Volume;
use voltet_graph::{ArrayRef, Demand, RunContext, Value};

/// Pieces that the interval of a percentile is cut into.
const EDGES: usize = 4096;

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

/// `read` counts the steps that were read.
pub fn measure(
    call: &RunContext,
    wanted: &StatisticsRequest,
    demand: &Demand,
    read: &mut u64,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    let mut intervals: BTreeMap<(ArrayRef, u64), [f64; 2]> = BTreeMap::new();
    let wider = |[low, high]: [f64; 2], [a, b]: [f64; 2]| [low.min(a), high.max(b)];
    each(call, demand, read, &mut |volume| {
        let own = measure_one(volume, wanted, call.progress())?;
        for (quantity, range) in own.ranges {
            let known = found.ranges.entry(quantity).or_insert(range);
            *known = wider(*known, range);
        }
        for (key, value) in own.percentiles {
            let known = intervals.entry(key).or_insert([value; 2]);
            *known = wider(*known, [value; 2]);
        }
        Ok(())
    })?;
    let mut sums: BTreeMap<(ArrayRef, u64), Sums> = BTreeMap::new();
    for (key, interval) in intervals {
        let percent = f64::from_bits(key.1);
        if interval[0] == interval[1] || percent <= 0.0 || percent >= 100.0 {
            // Of 0 % the least of all steps, of 100 % the largest.
            found.percentiles.insert(key, interval[usize::from(percent > 0.0)]);
        } else {
            sums.insert(key, Sums { interval, below: vec![0.0; EDGES + 1], total: 0.0 });
        }
    }
    if !sums.is_empty() {
        each(call, demand, read, &mut |volume| {
            for quantity in wanted.percentiles.keys() {
                let mut own = sums.iter_mut().filter(|((array, _), _)| array == quantity).peekable();
                if own.peek().is_none() {
                    continue;
                }
                let volumes = Volumes::new(&volume.grid, values(volume, quantity)?, call.progress());
                let volumes = volumes.map_err(|error| with_array_name(quantity, error))?;
                for (_, sums) in own {
                    let edges: Vec<f64> = (0..=EDGES).map(|i| sums.edge(i)).collect();
                    sums.below.iter_mut().zip(volumes.below_each(&edges)).for_each(|(sum, own)| *sum += own);
                    sums.total += volumes.total();
                }
            }
            Ok(())
        })?;
    }
    for (key, sums) in sums {
        let value = sums.percentile(f64::from_bits(key.1));
        found.percentiles.insert(key, value);
    }
    Ok(found)
}

fn each(
    call: &RunContext,
    demand: &Demand,
    read: &mut u64,
    of_step: &mut dyn FnMut(&Volume) -> Result<()>,
) -> Result<()> {
    call.each_step("volume", demand, &mut |_, value: Value| {
        *read += 1;
        match value.volume() {
            Some(volume) => of_step(&*volume?),
            None => Ok(()),
        }
    })
}
