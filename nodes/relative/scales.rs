//! What the volume at a node's input says, or all steps of its time series; found once and kept.

use super::found::Found;
use super::over_steps;
use super::volume::{demand, measure};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::transfer::StatisticsRequest;
use voltet_graph::RunContext;

/// What was found so far, of one volume or one series.
#[derive(Default)]
struct Kept(Mutex<Found>);

impl Kept {
    /// What is wanted, found now as far as it was not before. Gives how many percentiles were computed.
    fn with(
        &self,
        wanted: &StatisticsRequest,
        find: impl FnOnce(&StatisticsRequest) -> Result<Found>,
    ) -> Result<(Found, u64)> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let missing = known.missing(wanted);
        if !missing.is_empty() {
            known.add(find(&missing)?);
        }
        let count = missing.percentiles.values().map(BTreeSet::len).sum::<usize>();
        Ok((known.clone(), count as u64))
    }
}

/// What the volume at the input `volume` says.
pub fn of_volume(call: &mut RunContext, wanted: &StatisticsRequest) -> Result<Found> {
    let volume = call.volume("volume")?;
    let kept: Arc<Kept> = call.keep(call.revision("volume")?, || Ok(Kept::default()))?;
    let (found, computed) =
        call.stage("range", |progress| kept.with(wanted, |missing| measure(&volume, missing, progress)))?;
    call.notes.counts.insert("percentiles_computed", computed);
    Ok(found)
}

/// What all steps of the time series that feeds the input `volume` say together; one step is read at a time.
pub fn of_series(call: &mut RunContext, wanted: &StatisticsRequest) -> Result<Found> {
    let demand = demand(wanted);
    let kept: Arc<Kept> = call.keep_over_steps("volume", &demand, || Ok(Kept::default()))?;
    let mut read = 0;
    let (found, computed) =
        kept.with(wanted, |missing| over_steps::measure(call, missing, &demand, &mut read))?;
    call.notes.counts.insert("percentiles_computed", computed);
    call.notes.counts.insert("steps_read", read);
    Ok(found)
}
