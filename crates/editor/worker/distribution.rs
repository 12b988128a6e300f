//! The distribution of the data over two quantities, weighted by volume, with what numbers relative to data are found by.

use super::following::Following;
use super::preview_observer::volume_with;
use super::queries::{Distribution, DistributionQuery};
use super::scales::{DataScales, Spread, values};
use super::series;
use super::shared::lock;
use super::work::WorkerState;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::Grid;
use voltet_core::probing::{Axis, histogram, value_range};
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;
use voltet_graph::{ArrayRef, Observer, Registry, Session};

/// Bins along each axis.
const BINS: usize = 256;

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
        let [x, y] = [values(volume, &self.axes[0])?, values(volume, &self.axes[1])?];
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
            known.ranges.insert(quantity.clone(), value_range(&values(volume, &quantity)?)?);
        }
        for (k, (values, quantity)) in [x, y].iter().zip(&self.axes).enumerate() {
            let mut spread = Spread::new([axes[k].low, axes[k].high], known.ranges[quantity]);
            spread.add(grid, values, progress)?;
            known.spreads.insert(quantity.clone(), spread.finished());
        }
        Ok(Distribution { histogram: found, known })
    }

    /// Scales of numbers relative to all steps. `shown`: axes of the shown step.
    fn of_series(
        &self,
        session: &mut Session,
        registry: &Registry,
        shown: [Axis; 2],
        observer: &dyn Observer,
    ) -> Result<DataScales> {
        let of = (self.nodes.as_slice(), self.folder.as_path());
        let shown = shown.map(|axis| [axis.low, axis.high]);
        series::known(session, registry, of, &self.node, &self.quantities(), shown, observer)
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

impl WorkerState<'_> {
    /// The distribution; given up for a picture, and begun again after it.
    pub(super) fn distribution(&mut self, wanted: DistributionQuery) {
        let registry = self.registry;
        let found = self.aside(|session, following: &Following| {
            let of = (wanted.nodes.as_slice(), wanted.folder.as_path());
            let volume = volume_with(session, registry, of, &wanted.node, &wanted.arrays(), following)?;
            let mut found = wanted.find(&volume, following)?;
            if wanted.of_series {
                found.known = wanted.of_series(session, registry, found.histogram.axes, following)?;
            }
            Ok(Arc::new(found))
        });
        match found {
            Some(found) => self.shared.show(|shown| shown.distribution = Some((wanted.key, found))),
            None => drop(lock(&self.shared.wanted).distribution.get_or_insert(wanted)),
        }
    }
}
