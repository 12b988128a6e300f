//! Which views are worth keeping: those of which picture after picture is asked for with other widgets.

use super::Kept;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::camera::Camera;
use voltet_core::transfer::{AxisOrigin, Profile, TransferFunction, Widget};

/// Views that are remembered: an editor draws a coarse and a fine one in turn.
const VIEWS: usize = 2;

/// Widgets at least so wide, by the range of the values: 32 bits that are counted from the middle of the range hold a 20,000th of their
/// width.
const NARROWEST: f64 = 1.0 / 2000.0;

/// One at least so wide: where all are narrower, culling leaves so few cells that these are drawn sooner than all segments.
const WIDE: f64 = 1.0 / 45.0;

/// Changes after which segments are kept: to keep them takes as long as to draw them, and one change may be the last.
const CHANGES: usize = 2;

/// Keeping is for so many times the density at hand, so that denser widgets are served, too.
const DENSER: f64 = 16.0;

/// The views that were drawn last, the last one last.
#[derive(Debug, Default)]
pub(crate) struct Views(Mutex<Vec<View>>);

#[derive(Debug)]
struct View {
    camera: Camera,
    /// The widgets of the last picture.
    look: TransferFunction,
    /// How often they changed.
    changes: usize,
    kept: Option<Arc<Kept>>,
    /// Its segments are too many.
    too_many: bool,
}

/// How to draw a picture.
#[derive(Debug, Clone)]
pub(crate) enum Plan {
    /// From the cells.
    Cells,
    /// From the cells, and keep their segments, for this density ([`Kept::densest`]).
    Keep(f64),
    /// From these.
    Kept(Arc<Kept>),
}

impl Views {
    /// How to draw the next picture. `ranges`: of s and g over the grid; `densest`: see [`Kept::densest`].
    pub fn plan(
        &self,
        camera: &Camera,
        look: &TransferFunction,
        ranges: [[f64; 2]; 2],
        densest: f64,
    ) -> Plan {
        self.with(|views| {
            let Some(place) = views.iter().position(|view| view.camera == *camera) else {
                if views.len() == VIEWS {
                    views.remove(0);
                }
                views.push(View {
                    camera: *camera,
                    look: look.clone(),
                    changes: 0,
                    kept: None,
                    too_many: false,
                });
                return Plan::Cells;
            };
            let mut view = views.remove(place);
            let changed = view.look != *look;
            view.changes += usize::from(changed);
            // Of other quantities, or denser than they were projected for.
            let other = view.look.uses_gradient_magnitude() != look.uses_gradient_magnitude();
            view.kept = view.kept.take().filter(|kept| !other && densest <= kept.densest);
            view.look = look.clone();
            let served = serves(look, ranges) && !view.too_many;
            let plan = match &view.kept {
                Some(kept) if served => Plan::Kept(kept.clone()),
                None if served && changed && view.changes >= CHANGES => Plan::Keep(DENSER * densest),
                _ => Plan::Cells,
            };
            views.push(view);
            plan
        })
    }

    /// Keeps what was found of a view, or that it is too much.
    pub fn keep(&self, camera: &Camera, kept: Option<Arc<Kept>>) {
        self.with(|views| {
            if let Some(view) = views.iter_mut().find(|view| view.camera == *camera) {
                view.too_many = kept.is_none();
                view.kept = kept;
            }
        });
    }

    fn with<T>(&self, act: impl FnOnce(&mut Vec<View>) -> T) -> T {
        // What a panic left is views, whole.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Whether values that are counted from the middles of their ranges serve a transfer function, and sooner than the cells do: its
/// widgets are not too narrow, or look at values wherever they are counted from. What lies on the edge of a region is rounded as the
/// edge is.
fn serves(look: &TransferFunction, ranges: [[f64; 2]; 2]) -> bool {
    let widths: Option<Vec<f64>> = look.widgets.iter().map(|widget| width(widget, ranges)).collect();
    widths.is_some_and(|widths| {
        widths.iter().all(|width| *width >= NARROWEST) && widths.iter().any(|width| *width >= WIDE)
    })
}

/// How wide a widget and its region are, by the range of the values, at least; ∞ where that does not depend on where they are counted
/// from, `None` where it looks at further fields, or has pieces that a region cuts, whose closed forms are of 64 bits.
fn width(widget: &Widget, ranges: [[f64; 2]; 2]) -> Option<f64> {
    let properties = widget.profile.properties();
    if !properties.fields.is_empty() {
        return None;
    }
    let of_region = match &widget.region {
        None => f64::INFINITY,
        Some(_) if matches!(widget.profile, Profile::PiecewiseLinear { .. }) => return None,
        Some(region) => {
            let within = ranges.into_iter().enumerate().map(|(axis, [low, high])| {
                let limits = region.limits(axis);
                let part = (limits[1].min(high) - limits[0].max(low)) / (high - low);
                if high > low { part } else { f64::INFINITY }
            });
            let least = within.fold(f64::INFINITY, f64::min);
            // No value lies there.
            if least < 0.0 { NARROWEST } else { least }
        }
    };
    let of_profile = match &widget.profile {
        // exp(−|K v|²): a step along an axis is as long as K's column.
        Profile::Gaussian { matrix, .. } => {
            let inverses = ranges.iter().enumerate().map(|(axis, [low, high])| {
                (high - low) * f64::hypot(matrix[0][axis], matrix[1][axis]) * f64::sqrt(2.0)
            });
            1.0 / inverses.fold(0.0, f64::max)
        }
        _ if properties.axes.iter().all(|origin| *origin == AxisOrigin::Any) => f64::INFINITY,
        _ => return None,
    };
    Some(of_profile.min(of_region))
}
