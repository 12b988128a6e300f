//! Bands of a wave widget crossed by each cell: shows where a picture is finer than the grid.
//!
//! A wave's phase φ is linear in s and g (docs/src/explanation/optics.md, section 5), so within a cell it runs from its smallest
//! to its largest corner value; the difference is the number of bands, each one period of φ. Song et al. 2009, section
//! 6.3, allow one peak in a cell. The closed forms here hold for any number, but what lies between two vertices is
//! interpolation: where cells cross many bands, the bands show the grid's resolution and not the data.

use crate::Result;
use crate::transfer::{Convex, TransferFunction, Widget, meets};
use crate::volume::Volume;
use rayon::prelude::*;

/// The bands of one widget over the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct BandCounts {
    /// The widget's place in the transfer function, from 0.
    pub widget: usize,
    /// Its kind, as pipeline files name it.
    pub kind: &'static str,
    /// Cells that lie, in part at least, in its region.
    pub cell_count: u64,
    /// Half of these cross at most as many bands.
    pub median: f64,
    /// 99 % of them cross at most as many.
    pub percent_99: f64,
    /// None of them crosses more.
    pub max: f64,
    /// Share of them that cross more than one.
    pub share_above_one: f64,
}

/// The bands of every widget whose profile is periodic that some cell's values reach into. Where the volume has no
/// gradient magnitude, that counts as 0.
pub fn bands(volume: &Volume, transfer_function: &TransferFunction) -> Result<Vec<BandCounts>> {
    let all = crossed_by_widget(volume, transfer_function)?;
    let summaries = all.into_iter().filter_map(|(widget, mut crossed)| {
        crossed.retain(|bands| !bands.is_nan());
        let kind = transfer_function.widgets[widget].profile.name();
        Some(BandCounts { widget, kind, ..summary(&mut crossed)? })
    });
    Ok(summaries.collect())
}

/// For every widget whose profile is periodic, its place in the transfer function and the bands that each tetrahedron crosses:
/// 0 outside its region.
pub fn bands_of_cells(
    volume: &Volume,
    transfer_function: &TransferFunction,
) -> Result<Vec<(usize, Vec<f32>)>> {
    let mut found = crossed_by_widget(volume, transfer_function)?;
    let outside = |bands: &&mut f32| bands.is_nan();
    found
        .iter_mut()
        .for_each(|(_, crossed)| crossed.iter_mut().filter(outside).for_each(|bands| *bands = 0.0));
    Ok(found)
}

/// Places of the widgets whose profiles are periodic, and the bands that each cell crosses, NaN outside the region.
fn crossed_by_widget(
    volume: &Volume,
    transfer_function: &TransferFunction,
) -> Result<Vec<(usize, Vec<f32>)>> {
    let periodic = transfer_function.widgets.iter().enumerate().filter_map(|(place, widget)| {
        let bands = widget.profile.properties().bands?;
        Some(crossed(volume, widget, bands.step).map(|crossed| (place, crossed)))
    });
    periodic.collect()
}

/// Bands crossed by each cell, NaN outside the widget's region; `step`: φ per unit of s and of g.
fn crossed(volume: &Volume, widget: &Widget, step: [f64; 2]) -> Result<Vec<f32>> {
    let region = widget.region.as_ref().map(Convex::new).transpose()?;
    let (s, g) =
        (&volume.scalar, volume.gradient_magnitude.as_ref().filter(|_| widget.uses_gradient_magnitude()));
    let of_cell = |corners: &[u32; 4]| {
        let at = corners.map(|p| p as usize);
        let s = at.map(|p| s[p]);
        let g = g.map_or([0.0; 4], |g| at.map(|p| g[p]));
        if region.as_ref().is_some_and(|region| !meets(region, &s, &g)) {
            return f32::NAN;
        }
        // From the first corner, since φ itself may be large.
        let phase =
            |i: usize| (s[i] - s[0]) * step[0] + if step[1] == 0.0 { 0.0 } else { (g[i] - g[0]) * step[1] };
        let phases = [0.0, phase(1), phase(2), phase(3)];
        let [low, high] = phases.iter().fold([0.0_f64; 2], |[low, high], &p| [low.min(p), high.max(p)]);
        if phases.iter().all(|p| p.is_finite()) { (high - low) as f32 } else { f32::NAN }
    };
    Ok(volume.grid.tetrahedra.par_iter().with_min_len(1 << 13).map(of_cell).collect())
}

/// Quantiles by nearest rank; the widget is not named yet. `None` without cells.
fn summary(crossed: &mut [f32]) -> Option<BandCounts> {
    let count = crossed.len();
    let above_one = crossed.iter().filter(|&&bands| bands > 1.0).count();
    let mut quantile = |share: f64| {
        let rank = ((share * count as f64).ceil() as usize).clamp(1, count.max(1)) - 1;
        (count > 0).then(|| f64::from(*crossed.select_nth_unstable_by(rank, f32::total_cmp).1))
    };
    Some(BandCounts {
        widget: 0,
        kind: "",
        cell_count: count as u64,
        median: quantile(0.5)?,
        percent_99: quantile(0.99)?,
        max: quantile(1.0)?,
        share_above_one: above_one as f64 / count as f64,
    })
}
