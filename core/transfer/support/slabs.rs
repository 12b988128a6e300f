//! Where widgets lie, as slabs low ≤ a s + b g ≤ high: for a device that leaves out the cells that none touches.
//!
//! A cell may contribute to a widget only if, for one of the widget's lists, its corners reach every slab. That is less
//! sharp than the hulls of [`super::Support`], and as safe.

use crate::transfer::function::OpticalModel;
use crate::transfer::region::Region;
use crate::transfer::slab::{Reach, Slab};
use crate::transfer::widget::Widget;

impl Widget {
    /// Lists of slabs, each a part of the support; no list where the widget draws nothing. `depth`: its peak times the
    /// longest way, `least`: the optical depth under which it counts as nothing.
    pub fn slabs(&self, depth: f64, least: f64, model: OpticalModel) -> Vec<Vec<Slab>> {
        let mut lists = self.profile.slabs(Reach::new(depth / least, model.cutoff()));
        let range = self.profile.properties().range;
        for list in &mut lists {
            list.extend(self.region.iter().chain(&range).flat_map(of_region));
        }
        lists
    }
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
