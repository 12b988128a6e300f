//! Statistics of one volume that numbers are relative to: ranges and percentiles of its quantities.

use serde_json::{Map, json};
use std::collections::BTreeMap;
use voltet_core::probing::{Volumes, value_range};
use voltet_core::progress::Progress;
use voltet_core::transfer::{AxisScale, DataStatistics, StatisticsRequest};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Diagnostics};

#[derive(Debug, Clone, Default)]
pub(super) struct FoundStatistics {
    pub ranges: BTreeMap<ArrayRef, [f64; 2]>,
    /// Each percentile, by the bits of its percentage.
    pub percentiles: BTreeMap<(ArrayRef, u64), f64>,
    /// Scales of s and g.
    pub axes: [AxisScale; 2],
}

impl DataStatistics for FoundStatistics {
    fn scale(&self, quantity: &ArrayRef) -> AxisScale {
        match quantity {
            ArrayRef::Named("s") => self.axes[0],
            ArrayRef::Named("g") => self.axes[1],
            _ => AxisScale::Linear,
        }
    }

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
    pub(super) fn missing(&self, wanted: &StatisticsRequest) -> StatisticsRequest {
        let mut missing = wanted.clone();
        missing.ranges.retain(|quantity| !self.ranges.contains_key(quantity));
        missing.percentiles.retain(|quantity, percents| {
            percents.retain(|&bits| !self.percentiles.contains_key(&(quantity.clone(), bits)));
            !percents.is_empty()
        });
        missing
    }

    /// Notes the ranges and percentiles that relative numbers were found from.
    pub(super) fn note(&self, notes: &mut Diagnostics, over: &str) {
        let mut said = Vec::new();
        let mut ranges = Map::new();
        for (quantity, [low, high]) in &self.ranges {
            said.push(format!("{quantity} from {low:?} to {high:?}"));
            ranges.insert(quantity.to_string(), json!([low, high]));
        }
        let mut percentiles = Vec::new();
        for ((quantity, bits), value) in &self.percentiles {
            let percent = f64::from_bits(*bits);
            said.push(format!("p{percent} of {quantity} = {value:?}"));
            percentiles.push(json!([quantity.to_string(), percent, value]));
        }
        let figures = json!({ "relative_to": { "over": over, "ranges": ranges, "percentiles": percentiles }});
        notes.find(format!("{} ({over})", said.join(", ")), figures);
    }
}

/// The values of a quantity, one a point. Errors: there is no such array, or no gradient magnitude.
pub fn values<'a>(volume: &'a Volume, quantity: &ArrayRef) -> Result<&'a [f64]> {
    match quantity {
        ArrayRef::Array(name) => Ok(&volume.grid.point_array(name, 1)?.values),
        ArrayRef::Named("g") => volume.gradient_magnitude.as_ref().map(|g| g.as_slice()).ok_or_else(|| {
            Error::usage("the gradient magnitude is looked at, and the volume has none")
                .expected("a node of type \"gradient-magnitude\" before the input 'volume'")
        }),
        ArrayRef::Named(_) | ArrayRef::Per(..) => Ok(&volume.scalar),
    }
}

/// The volume below each value of a quantity.
pub(crate) fn volumes(volume: &Volume, quantity: &ArrayRef, progress: &dyn Progress) -> Result<Volumes> {
    Volumes::new(&volume.grid, values(volume, quantity)?, progress)
        .map_err(|error| with_array_name(quantity, error))
}

/// An error with the name of the quantity that it is about.
pub(super) fn with_array_name(quantity: &ArrayRef, error: Error) -> Error {
    let what = format!("{}, of {quantity}", error.what);
    Error { what, ..error }
}

/// Statistics of one volume: only what is requested is computed.
pub(super) fn measure(
    volume: &Volume,
    wanted: &StatisticsRequest,
    progress: &dyn Progress,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    for quantity in &wanted.ranges {
        // At points of ghosts alone the gradient is not that of the grid.
        let values = values(volume, quantity)?;
        let drawn = &values[..volume.grid.drawn_points().min(values.len())];
        let range = value_range(drawn).map_err(|error| with_array_name(quantity, error))?;
        found.ranges.insert(quantity.clone(), range);
    }
    for (quantity, percents) in &wanted.percentiles {
        let volumes = volumes(volume, quantity, progress)?;
        for &bits in percents {
            let value = volumes.percentile(f64::from_bits(bits), progress)?;
            found.percentiles.insert((quantity.clone(), bits), value);
        }
    }
    Ok(found)
}
