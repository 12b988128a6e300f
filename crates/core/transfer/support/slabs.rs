//! Supports of widgets as slabs low ≤ a s + b g ≤ high: for a device that culls the cells that no slab meets.
//!
//! A cell may contribute to a widget only if, for one of the widget's lists, its corners reach every slab. That is less
//! sharp than the hulls of [`super::Support`], and as safe.

use crate::transfer::function::{OpticalModel, TransferFunction};
use crate::transfer::region::Region;
use crate::transfer::slab::{Slab, SupportRadius};
use crate::transfer::widget::Widget;

impl Widget {
    /// Lists of slabs, each a part of the support; no list where the widget draws nothing. `depth`: its peak times the
    /// longest way, `least`: the optical depth under which it counts as nothing.
    pub fn slabs(&self, depth: f64, least: f64, model: OpticalModel) -> Vec<Vec<Slab>> {
        let mut lists = self.profile.slabs(SupportRadius::new(depth / least, model.cutoff()));
        let range = self.profile.properties().range;
        for list in &mut lists {
            list.extend(self.region.iter().chain(&range).flat_map(of_region));
        }
        lists
    }
}

impl TransferFunction {
    /// Intervals of s, ascending and disjoint, outside of which all widgets together add less than `least` of optical depth, or of
    /// colour, over a length of so many world units, whatever g and further fields are.
    pub fn intervals_of_s(&self, length: f64, least: f64) -> Vec<[f64; 2]> {
        let least = least / self.widgets.len() as f64;
        let of = |widget: &Widget| {
            let depth = widget.peak() / self.unit_distance * length * widget.max_emission().max(1.0);
            widget.slabs(depth, least, self.model)
        };
        let mut found: Vec<[f64; 2]> =
            self.widgets.iter().flat_map(of).map(|list| interval_of_s(&list)).collect();
        found.retain(|[low, high]| low <= high);
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut disjoint: Vec<[f64; 2]> = Vec::new();
        for [low, high] in found {
            match disjoint.last_mut() {
                Some(last) if low <= last[1] => last[1] = last[1].max(high),
                _ => disjoint.push([low, high]),
            }
        }
        disjoint
    }
}

/// Limits of s over what slabs share.
fn interval_of_s(list: &[Slab]) -> [f64; 2] {
    let mut limits = [f64::NEG_INFINITY, f64::INFINITY];
    let mut narrow = |low: f64, high: f64| limits = [limits[0].max(low), limits[1].min(high)];
    let across = |slab: &&Slab| slab.normal[0] != 0.0 && slab.normal[1] == 0.0;
    for Slab { normal: [a, _], low, high } in list.iter().filter(across) {
        let ends = [low / a, high / a];
        narrow(ends[0].min(ends[1]), ends[0].max(ends[1]));
    }
    // Two that are tilted share a parallelogram.
    let tilted: Vec<&Slab> = list.iter().filter(|slab| slab.normal[1] != 0.0).collect();
    if let [one, other] = tilted[..] {
        let [[a, b], [c, d]] = [one.normal, other.normal];
        let corner = |x: f64, y: f64| (d * x - b * y) / (a * d - b * c);
        let corners = [one.low, one.high].map(|x| [other.low, other.high].map(|y| corner(x, y)));
        let corners = corners.as_flattened();
        if corners.iter().all(|s| s.is_finite()) {
            narrow(
                corners.iter().copied().fold(f64::INFINITY, f64::min),
                corners.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            );
        }
    }
    // Room for the rounding of all this, and of values that are stored in 32 bits.
    let room = 1e-6 * (limits[1] - limits[0]) + 1e-12 * (limits[0].abs() + limits[1].abs());
    if room.is_finite() { [limits[0] - room, limits[1] + room] } else { limits }
}

/// The box of a region; where it is no rectangle also its edges.
fn of_region(region: &Region) -> Vec<Slab> {
    let axis = |axis: usize, normal: [f64; 2]| {
        let [low, high] = region.limits(axis);
        Slab { normal, low, high }
    };
    let mut slabs = vec![axis(0, [1.0, 0.0])];
    if region.depends_on_g() {
        slabs.push(axis(1, [0.0, 1.0]));
    }
    if region.corners.iter().flatten().all(|x| x.is_finite()) {
        for plane in region.half_planes() {
            let normal = plane.normal;
            if normal.contains(&0.0) {
                // A side of the box.
                continue;
            }
            let at = |c: &[f64; 2]| normal[0] * c[0] + normal[1] * c[1];
            let wider = |[low, high]: [f64; 2], c: &[f64; 2]| [low.min(at(c)), high.max(at(c))];
            let [low, high] = region.corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider);
            slabs.push(Slab { normal, low, high });
        }
    }
    slabs
}
