//! Statistics found in the data.

use std::collections::{BTreeMap, BTreeSet};
use voltet_core::transfer::{DataStatistics, StatisticsRequest};
use voltet_core::{Error, Result};
use voltet_graph::ArrayRef;

/// Statistics found in the data.
#[derive(Debug, Clone, Default)]
pub struct FoundStatistics {
    /// The range of each quantity that was asked for.
    pub ranges: BTreeMap<ArrayRef, [f64; 2]>,
    /// Each percentile, by the bits of its percentage.
    pub percentiles: BTreeMap<(ArrayRef, u64), f64>,
}

impl DataStatistics for FoundStatistics {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        self.ranges.get(quantity).copied().ok_or_else(|| not_found(quantity))
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        let found = self.percentiles.get(&(quantity.clone(), percent.to_bits()));
        found.copied().ok_or_else(|| not_found(quantity))
    }
}

fn not_found(quantity: &ArrayRef) -> Error {
    Error::run(format!("nothing is known of the values of {quantity}"))
}

impl FoundStatistics {
    /// Part of `wanted` that is missing here.
    pub fn missing(&self, wanted: &StatisticsRequest) -> StatisticsRequest {
        let mut missing = StatisticsRequest::default();
        missing.ranges.extend(wanted.ranges.iter().filter(|q| !self.ranges.contains_key(q)).cloned());
        for (quantity, percents) in &wanted.percentiles {
            let open = percents.iter().filter(|&&p| !self.percentiles.contains_key(&(quantity.clone(), p)));
            let open: BTreeSet<u64> = open.copied().collect();
            if !open.is_empty() {
                missing.percentiles.insert(quantity.clone(), open);
            }
        }
        missing
    }

    /// Adds what else was found.
    pub fn add(&mut self, other: FoundStatistics) {
        self.ranges.extend(other.ranges);
        self.percentiles.extend(other.percentiles);
    }
}
