//! Ranges and percentiles of quantities of one volume.

use super::statistics::FoundStatistics;
use voltet_core::probing::{Volumes, value_range};
use voltet_core::progress::Progress;
use voltet_core::transfer::StatisticsRequest;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Demand};

/// Demand on a volume for these statistics.
pub fn demand(wanted: &StatisticsRequest) -> Demand {
    let mut demand = Demand::default();
    for quantity in wanted.quantities() {
        match quantity {
            ArrayRef::Array(name) => demand.arrays.insert(name.clone()),
            ArrayRef::Named("g") => demand.gradient_magnitude = true,
            ArrayRef::Named(_) | ArrayRef::Per(..) => {}
        }
    }
    demand
}

/// The values of a quantity, one a point. Errors: there is no such array, or no gradient magnitude.
pub fn values<'a>(volume: &'a Volume, quantity: &ArrayRef) -> Result<&'a [f64]> {
    match quantity {
        ArrayRef::Array(name) => Ok(&volume.grid.point_array(name, 1)?.values),
        ArrayRef::Named("g") => volume.gradient_magnitude.as_ref().map(|g| g.as_slice()).ok_or_else(|| {
            Error::usage("numbers are relative to the gradient magnitude, and the volume has none")
                .expected("a node of type \"gradient-magnitude\" before the input 'volume'")
        }),
        ArrayRef::Named(_) | ArrayRef::Per(..) => Ok(&volume.scalar),
    }
}

/// An error with the name of the quantity that it is about.
pub fn with_array_name(quantity: &ArrayRef, error: Error) -> Error {
    let what = format!("{}, of {quantity}", error.what);
    Error { what, ..error }
}

/// Statistics of one volume: only what is requested is computed.
pub fn measure(
    volume: &Volume,
    wanted: &StatisticsRequest,
    progress: &dyn Progress,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    for quantity in &wanted.ranges {
        let range =
            value_range(values(volume, quantity)?).map_err(|error| with_array_name(quantity, error))?;
        found.ranges.insert(quantity.clone(), range);
    }
    for (quantity, percents) in &wanted.percentiles {
        let volumes = Volumes::new(&volume.grid, values(volume, quantity)?, progress);
        let volumes = volumes.map_err(|error| with_array_name(quantity, error))?;
        for &bits in percents {
            let value = volumes.percentile(f64::from_bits(bits), progress)?;
            found.percentiles.insert((quantity.clone(), bits), value);
        }
    }
    Ok(found)
}
