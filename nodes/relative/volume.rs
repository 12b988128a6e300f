//! Ranges and percentiles of quantities of one volume.

use super::found::Found;
use voltet_core::probing::{Volumes, value_range};
use voltet_core::progress::Progress;
use voltet_core::transfer::Wanted;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{Demand, Quantity};

/// What must be asked of a volume for these.
pub fn demand(wanted: &Wanted) -> Demand {
    let mut demand = Demand::default();
    for quantity in wanted.quantities() {
        match quantity {
            Quantity::Array(name) => demand.arrays.insert(name.clone()),
            Quantity::Named("g") => demand.gradient_magnitude = true,
            Quantity::Named(_) | Quantity::Per(..) => {}
        }
    }
    demand
}

/// The values of a quantity, one a point. Errors: there is no such array, or no gradient magnitude.
pub fn values<'a>(volume: &'a Volume, quantity: &Quantity) -> Result<&'a [f64]> {
    match quantity {
        Quantity::Array(name) => Ok(&volume.grid.point_array(name, 1)?.values),
        Quantity::Named("g") => volume.gradient_magnitude.as_ref().map(|g| g.as_slice()).ok_or_else(|| {
            Error::usage("numbers are relative to the gradient magnitude, and the volume has none")
                .accepted("a node of type \"gradient-magnitude\" before the input 'volume'")
        }),
        Quantity::Named(_) | Quantity::Per(..) => Ok(&volume.scalar),
    }
}

/// An error with the name of the quantity that it is about.
pub fn of(quantity: &Quantity, error: Error) -> Error {
    let what = format!("{}, of {quantity}", error.what);
    Error { what, ..error }
}

/// Those of one volume: nothing but what is wanted is computed.
pub fn measure(volume: &Volume, wanted: &Wanted, progress: &dyn Progress) -> Result<Found> {
    let mut found = Found::default();
    for quantity in &wanted.ranges {
        let range = value_range(values(volume, quantity)?).map_err(|error| of(quantity, error))?;
        found.ranges.insert(quantity.clone(), range);
    }
    for (quantity, percents) in &wanted.percentiles {
        let volumes = Volumes::new(&volume.grid, values(volume, quantity)?, progress);
        let volumes = volumes.map_err(|error| of(quantity, error))?;
        for &bits in percents {
            let value = volumes.percentile(f64::from_bits(bits), progress)?;
            found.percentiles.insert((quantity.clone(), bits), value);
        }
    }
    Ok(found)
}
