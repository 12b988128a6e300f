//! The distribution of the data over two quantities, weighted by volume, with what numbers relative to data are found by.

use super::query::Query;
use super::request::VolumeSource;
use super::scales::{DataScales, Spread, values_of};
use super::series;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::Grid;
use voltet_core::probing::{Axis, Histogram, histogram, value_range};
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_graph::{ArrayRef, NodeProgress, Observer, Registry, Session};

/// Bins along each axis.
const BINS: usize = 256;

/// The distribution of the data that is wanted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DistributionQuery {
    pub source: VolumeSource,
    /// Along which quantities: "s", "g", or arrays.
    pub axes: [ArrayRef; 2],
    /// Further arrays whose ranges are wanted.
    pub fields: Vec<String>,
    /// True if numbers are relative to all steps of a time series together.
    pub of_series: bool,
}

/// Distribution of the data.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Distribution {
    /// The volume in each bin.
    pub histogram: Histogram,
    /// Ranges, and the volume below each value of the axes: of this volume, or of all steps of its series.
    pub known: DataScales,
}

impl DistributionQuery {
    /// The arrays of the axes, and the further ones.
    fn arrays(&self) -> Vec<&String> {
        let of_axes = self.axes.iter().filter_map(|axis| match axis {
            ArrayRef::Array(name) => Some(name),
            ArrayRef::Named(_) | ArrayRef::Per(..) => None,
        });
        let mut arrays: Vec<&String> = of_axes.chain(&self.fields).collect();
        arrays.sort_unstable();
        arrays.dedup();
        arrays
    }

    /// The quantities that something is asked of: the axes first.
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
    fn find(&self, volume: &Volume, progress: &dyn Progress) -> Result<Distribution> {
        let [x, y] = [values_of(volume, &self.axes[0])?, values_of(volume, &self.axes[1])?];
        let grid = &volume.grid;
        let mut axes = [Axis::over(&x, BINS), Axis::over(&y, BINS)];
        for axis in (0..2).filter(|axis| self.axes[*axis] == ArrayRef::Named("g")) {
            axes[axis] = of_nearly_all(grid, if axis == 0 { &x } else { &y }, progress)?;
        }
        let found = histogram(grid, [&x, &y], axes, progress)?;
        let mut known = DataScales::default();
        if self.of_series {
            return Ok(Distribution { histogram: found, known });
        }
        for quantity in self.quantities() {
            known.ranges.insert(quantity.clone(), value_range(&values_of(volume, &quantity)?)?);
        }
        for (k, (values, quantity)) in [x, y].iter().zip(&self.axes).enumerate() {
            let mut spread = Spread::new([axes[k].low, axes[k].high], known.ranges[quantity]);
            spread.add(grid, values, progress)?;
            known.spreads.insert(quantity.clone(), spread.finished());
        }
        Ok(Distribution { histogram: found, known })
    }
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

    fn answer(
        &self,
        session: &mut Session,
        registry: &Registry,
        observer: &dyn Observer,
    ) -> Result<Arc<Distribution>> {
        let volume = self.source.volume(session, registry, &self.arrays(), observer)?;
        let mut found = self.find(&volume, &NodeProgress { observer, node: "" })?;
        if self.of_series {
            let has_gradient = volume.gradient_magnitude.is_some();
            let settings = series::settings(&self.quantities(), found.histogram.axes, has_gradient);
            found.known = series::known(session, registry, &self.source, settings, observer)?;
        }
        Ok(Arc::new(found))
    }
}
