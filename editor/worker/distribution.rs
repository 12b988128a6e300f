//! The distribution of the data over two quantities, weighted by volume, with what numbers relative to data are found by.

use super::asked::{Distributed, Distribution};
use super::following::Following;
use super::look_on::volume_with;
use super::scales::{Known, Spread};
use super::shared::lock;
use super::work::Work;
use std::borrow::Cow;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::graph::Quantity;
use voltet_core::grid::Grid;
use voltet_core::probing::{Axis, histogram, value_range};
use voltet_core::progress::Progress;
use voltet_core::volume::Volume;

/// Bins along each axis.
const BINS: usize = 256;

impl Distribution {
    /// The arrays of the axes, and the further ones.
    fn arrays(&self) -> Vec<&String> {
        let of_axes = self.axes.iter().filter_map(|axis| match axis {
            Quantity::Array(name) => Some(name),
            Quantity::Named(_) | Quantity::Per(..) => None,
        });
        let mut arrays: Vec<&String> = of_axes.chain(&self.fields).collect();
        arrays.sort_unstable();
        arrays.dedup();
        arrays
    }

    /// Exact within every cell. Along *g* it reaches as far as nearly all of the volume does: a few slivers have gradients of
    /// many times that. Where there is no gradient, *g* is 0.
    fn find(&self, volume: &Volume, progress: &dyn Progress) -> Result<Distributed> {
        let [x, y] = [values(volume, &self.axes[0])?, values(volume, &self.axes[1])?];
        let grid = &volume.grid;
        let mut axes = [Axis::over(&x, BINS), Axis::over(&y, BINS)];
        for axis in (0..2).filter(|axis| self.axes[*axis] == Quantity::Named("g")) {
            axes[axis] = of_nearly_all(grid, if axis == 0 { &x } else { &y }, progress)?;
        }
        let found = histogram(grid, [&x, &y], axes, progress)?;
        let mut known = Known::default();
        for (k, (values, quantity)) in [x, y].iter().zip(&self.axes).enumerate() {
            let shown = [axes[k].low, axes[k].high];
            known.ranges.insert(quantity.clone(), value_range(values)?);
            known.spreads.insert(quantity.clone(), Spread::of(grid, values, shown, progress)?);
        }
        let arrays = self.fields.iter().map(|name| Quantity::Array(name.clone()));
        for quantity in arrays.chain(["s", "g"].map(Quantity::Named)) {
            if !known.ranges.contains_key(&quantity) {
                known.ranges.insert(quantity.clone(), value_range(&values(volume, &quantity)?)?);
            }
        }
        Ok(Distributed { histogram: found, known })
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

/// The values of a quantity, one a point.
fn values<'a>(volume: &'a Volume, quantity: &Quantity) -> Result<Cow<'a, [f64]>> {
    match quantity {
        Quantity::Array(name) => Ok(Cow::Borrowed(&volume.grid.point_array(name, 1)?.values)),
        Quantity::Named("g") => Ok(match &volume.gradient_magnitude {
            Some(g) => Cow::Borrowed(g),
            None => Cow::Owned(vec![0.0; volume.scalar.len()]),
        }),
        Quantity::Named(_) | Quantity::Per(..) => Ok(Cow::Borrowed(&volume.scalar)),
    }
}

impl Work<'_> {
    /// The distribution; given up for a picture, and begun again after it.
    pub(super) fn distribution(&mut self, wanted: Distribution) {
        let registry = self.registry;
        let found = self.aside(|session, following: &Following| {
            let of = (wanted.nodes.as_slice(), wanted.folder.as_path());
            let volume = volume_with(session, registry, of, &wanted.node, &wanted.arrays(), following)?;
            wanted.find(&volume, following).map(Arc::new)
        });
        match found {
            Some(found) => self.shared.show(|shown| shown.distribution = Some((wanted.key, found))),
            None => drop(lock(&self.shared.wanted).distribution.get_or_insert(wanted)),
        }
    }
}
