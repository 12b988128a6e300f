//! Statistics of the volume at a node's input, or of all steps of its time series; computed once and cached.

use super::over_steps;
use super::statistics::FoundStatistics;
use super::volume::{demand, measure};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::transfer::StatisticsRequest;
use voltet_graph::RunContext;

/// Statistics found so far, of one volume or one series.
#[derive(Default)]
struct StatisticsCache(Mutex<FoundStatistics>);

impl StatisticsCache {
    /// Statistics requested, computed as far as they are missing. Returns the count of percentiles computed.
    fn with(
        &self,
        wanted: &StatisticsRequest,
        find: impl FnOnce(&StatisticsRequest) -> Result<FoundStatistics>,
    ) -> Result<(FoundStatistics, u64)> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let missing = known.missing(wanted);
        if !missing.is_empty() {
            known.add(find(&missing)?);
        }
        let count = missing.percentiles.values().map(BTreeSet::len).sum::<usize>();
        Ok((known.clone(), count as u64))
    }
}

/// Statistics of the volume at the input `volume`.
pub fn of_volume(call: &mut RunContext, wanted: &StatisticsRequest) -> Result<FoundStatistics> {
    let volume = call.volume("volume")?;
    let kept: Arc<StatisticsCache> =
        call.keep(call.revision("volume")?, || Ok(StatisticsCache::default()))?;
    let (found, computed) =
        call.stage("range", |progress| kept.with(wanted, |missing| measure(&volume, missing, progress)))?;
    call.notes.counts.insert("percentiles_computed", computed);
    Ok(found)
}

/// Statistics of all steps of the time series that feeds the input `volume`; one step is read at a time.
pub fn of_series(call: &mut RunContext, wanted: &StatisticsRequest) -> Result<FoundStatistics> {
    let demand = demand(wanted);
    let kept: Arc<StatisticsCache> =
        call.keep_over_steps("volume", &demand, || Ok(StatisticsCache::default()))?;
    let mut read = 0;
    let (found, computed) =
        kept.with(wanted, |missing| over_steps::measure(call, missing, &demand, &mut read))?;
    call.notes.counts.insert("percentiles_computed", computed);
    call.notes.counts.insert("steps_read", read);
    Ok(found)
}
