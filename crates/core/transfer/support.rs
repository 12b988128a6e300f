//! Upper bound of a cell's contribution: the culling test.
//!
//! The papers look at the four vertices only, which drops a cell whose vertices straddle a narrow widget.
//! Here every bound is one over the convex hull of the four (s, g) points, within which the cell's values
//! lie, so a cell that is left out could not have changed a pixel by more than the bound times its length.
//! The bounds of each kind stand with the kind. A device that culls cells asks for slabs low ≤ a s + b g ≤ high instead: a cell may contribute
//! to a widget only if, for one of the widget's lists, its corners reach every slab. That is less sharp than the hulls, and as safe.

use super::function::{OpticalModel, TransferFunction, Widget};
use super::hull::{Corners, ROUNDING, distance_squared_from_origin, meets, range};
use super::kinds::ProfileBounds;
use super::region::{Convex, Region, Slab, SupportRadius};
use crate::Result;

/// Bounds of all widgets of a transfer function over cells. Equal ones give the same answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    widgets: Vec<WidgetSupport>,
}

#[derive(Debug, Clone, PartialEq)]
struct WidgetSupport {
    bounds: ProfileBounds,
    clip: Option<Convex>,
    /// The most that a profile of 1 absorbs or emits per world unit.
    strength: f64,
    /// Constant-emitter: where the profile can exceed the cutoff, the widget emits this per world unit.
    glow: Option<EmissionBound>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct EmissionBound {
    cutoff: f64,
    brightest: f64,
}

impl Support {
    /// Checks the transfer function and makes its bounds ready.
    pub fn new(transfer_function: &TransferFunction) -> Result<Support> {
        transfer_function.check()?;
        let fields = transfer_function.fields();
        let widgets = transfer_function
            .widgets
            .iter()
            .map(|widget| WidgetSupport::new(widget, transfer_function, &fields))
            .collect::<Result<_>>()?;
        Ok(Support { widgets })
    }

    /// Widgets.
    pub fn widget_count(&self) -> usize {
        self.widgets.len()
    }

    /// Support with each widget's contribution rounded up to `least` times a power of two, which is as safe: results for `least`
    /// stay equal while an extinction or a brightness moves between two of these. A contribution under the widget's fraction of `least` counts
    /// as zero.
    pub fn in_steps(mut self, least: f64) -> Support {
        let share = self.relative_extinction(least);
        let raised = |x: f64| if x > share { share * (x / share).log2().ceil().exp2() } else { 0.0 };
        for widget in &mut self.widgets {
            widget.strength = raised(widget.strength);
            if let Some(glow) = &mut widget.glow {
                glow.brightest = raised(glow.brightest);
            }
        }
        self
    }

    /// If all widgets together exceed `least`, some widget exceeds its share of it.
    fn relative_extinction(&self, least: f64) -> f64 {
        least / self.widgets.len() as f64
    }

    /// The most that a ray can lose or gain per world unit inside a cell: an upper bound, over the convex
    /// hull of the vertices' values, of ρ, of Σ cᵢ ρᵢ and of Σ κᵢ.
    pub fn bound(&self, corners: &Corners) -> f64 {
        self.widgets.iter().map(|widget| widget.bound(corners)).sum()
    }

    /// The widget by which the cell can contribute more than `least` per world unit, `first` asked before the others: cells side by
    /// side are often touched by the same. With `least` = 1e-6 divided by the grid's diameter no pixel changes by more than 1e-6 when
    /// the cells without such a widget are left out.
    #[inline]
    pub fn first_overlapping_widget(&self, first: usize, corners: &Corners, least: f64) -> Option<usize> {
        let share = self.relative_extinction(least);
        let touches = |&number: &usize| self.widgets[number].touches(corners, share);
        let others = (0..self.widgets.len()).filter(|&number| number != first);
        (first..self.widgets.len()).take(1).chain(others).find(touches)
    }

    /// True if the cell can contribute by this widget ([`Support::first_overlapping_widget`]).
    pub fn widget_touches(&self, widget: usize, corners: &Corners, least: f64) -> bool {
        self.widgets[widget].touches(corners, self.relative_extinction(least))
    }

    /// A widget that contributes as much ([`Support::first_overlapping_widget`]) all over a box of s and g, so that it touches every cell of values
    /// in there; `None` also where that is not known.
    pub fn cover(&self, ranges: &[[f64; 2]; 2], least: f64) -> Option<usize> {
        let share = self.relative_extinction(least);
        self.widgets.iter().position(|widget| widget.covers(ranges, share))
    }
}

impl WidgetSupport {
    fn new(widget: &Widget, transfer_function: &TransferFunction, fields: &[&str]) -> Result<Self> {
        let (peak, brightest) = (widget.peak(), widget.max_emission());
        let per_length = peak / transfer_function.unit_distance;
        let (strength, glow) = match transfer_function.model {
            OpticalModel::DensityEmitter => (per_length * brightest.max(1.0), None),
            OpticalModel::ConstantEmitter { cutoff } => {
                let glow = EmissionBound { cutoff, brightest: brightest / transfer_function.unit_distance };
                (per_length, (peak > 0.0).then_some(glow))
            }
        };
        Ok(WidgetSupport {
            bounds: widget.profile.bounds(fields),
            clip: widget.region.as_ref().map(Convex::new).transpose()?,
            strength,
            glow,
        })
    }

    #[inline]
    fn bound(&self, corners: &Corners) -> f64 {
        let profile = self.profile_bound(corners);
        let absorbed = self.strength * profile;
        match self.glow {
            Some(glow) if profile > glow.cutoff => absorbed.max(glow.brightest),
            _ => absorbed,
        }
    }

    /// True if the bound exceeds `least`; true also for values that are not numbers, which are not this test's
    /// business.
    #[inline]
    fn touches(&self, corners: &Corners, least: f64) -> bool {
        if self.strength == 0.0 && self.glow.is_none_or(|glow| glow.brightest <= least) {
            return false;
        }
        let ProfileBounds::GaussianPlane(plane) = &self.bounds else {
            let bound = self.bound(corners);
            return bound > least || bound.is_nan();
        };
        // The same for the most frequent kind, compared by squared distance, without an exponential.
        let mut level = (self.strength / least).ln();
        if let Some(glow) = self.glow.filter(|glow| glow.brightest > least) {
            level = level.max(-glow.cutoff.ln());
        }
        let level = level + ROUNDING * (1.0 + level.abs());
        let points = plane.scaled(corners);
        let axis = |i: usize| {
            let (low, high) = range(&points.map(|p| p[i]));
            low.max(-high).max(0.0)
        };
        let (x, y) = (axis(0), axis(1));
        if x * x + y * y > level {
            return false;
        }
        let vertex = points.iter().any(|p| p[0] * p[0] + p[1] * p[1] <= level);
        let far = !vertex && distance_squared_from_origin(&points) * (1.0 - ROUNDING) > level;
        !far && self.clip.as_ref().is_none_or(|clip| meets(clip, corners.s, corners.g))
    }

    fn covers(&self, ranges: &[[f64; 2]; 2], least: f64) -> bool {
        let inside = self.clip.as_ref().is_none_or(|clip| clip.holds(ranges));
        inside && self.strength * self.bounds.min_in_box(ranges) > least
    }

    #[inline]
    fn profile_bound(&self, corners: &Corners) -> f64 {
        if let Some(clip) = &self.clip
            && !meets(clip, corners.s, corners.g)
        {
            return 0.0;
        }
        self.bounds.bound(corners)
    }
}

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
    /// Positions on an axis between which one of some widgets adds at least `least` of its peak's optical depth, or colour, to a segment.
    pub fn positions_drawn(&self, axis: usize, least: f64, counts: impl Fn(&Widget) -> bool) -> [f64; 2] {
        let widgets = self.widgets.iter().filter(|widget| counts(widget));
        let lists = widgets.flat_map(|widget| widget.slabs(1.0, least, self.model));
        let intervals = lists.map(|list| interval(&list, axis)).filter(|[low, high]| low <= high);
        intervals
            .fold([f64::INFINITY, f64::NEG_INFINITY], |all, own| [all[0].min(own[0]), all[1].max(own[1])])
    }

    /// Intervals of s, ascending and disjoint, outside of which all widgets together add less than `least` of optical depth, or of
    /// colour, over a length of so many world units, whatever g and further fields are.
    pub fn intervals_of_s(&self, length: f64, least: f64) -> Vec<[f64; 2]> {
        let least = least / self.widgets.len() as f64;
        let of = |widget: &Widget| {
            let depth = widget.peak() / self.unit_distance * length * widget.max_emission().max(1.0);
            widget.slabs(depth, least, self.model)
        };
        let mut found: Vec<[f64; 2]> =
            self.widgets.iter().flat_map(of).map(|list| interval(&list, 0)).collect();
        found.retain(|[low, high]| low <= high);
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut disjoint: Vec<[f64; 2]> = Vec::new();
        for [low, high] in found {
            match disjoint.last_mut() {
                Some(last) if low <= last[1] => last[1] = last[1].max(high),
                _ => disjoint.push([low, high]),
            }
        }
        disjoint.into_iter().map(|interval| interval.map(|u| self.axes[0].value(u))).collect()
    }
}

/// Limits of positions on an axis over what slabs share.
fn interval(list: &[Slab], axis: usize) -> [f64; 2] {
    let mut limits = [f64::NEG_INFINITY, f64::INFINITY];
    let mut narrow = |low: f64, high: f64| limits = [limits[0].max(low), limits[1].min(high)];
    let across = |slab: &&Slab| slab.normal[axis] != 0.0 && slab.normal[1 - axis] == 0.0;
    for Slab { normal, low, high } in list.iter().filter(across) {
        let ends = [low / normal[axis], high / normal[axis]];
        narrow(ends[0].min(ends[1]), ends[0].max(ends[1]));
    }
    // Two that are tilted share a parallelogram.
    let tilted: Vec<&Slab> = list.iter().filter(|slab| slab.normal[1 - axis] != 0.0).collect();
    if let [one, other] = tilted[..] {
        let [[a, b], [c, d]] = [one, other].map(|slab| [slab.normal[axis], slab.normal[1 - axis]]);
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
