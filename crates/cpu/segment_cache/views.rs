//! Views that are worth caching: those of which picture after picture is requested with other widgets.

use super::tile::SegmentCache;
use crate::tolerances::MIN_CACHED_WIDTH;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::camera::Camera;
use voltet_core::transfer::{AxisOrigin, Profile, TransferFunction, Widget};

/// Views in the cache: an editor draws a coarse and a fine one in turn.
const MAX_VIEWS: usize = 2;

/// Width of a widget, by the range of the values, from which on caching pays: where all are narrower, culling leaves so few cells that
/// these are drawn sooner than all segments.
const MIN_WIDE_WIDTH: f64 = 1.0 / 45.0;

/// Changes of widgets after which segments are cached: recording takes as long as drawing, and one change may be the last.
const MIN_CHANGES: usize = 2;

/// Factor on the optical depth that recorded segments are projected for, so that denser widgets can use them, too.
const DEPTH_MARGIN: f64 = 16.0;

/// Views that were drawn last, the last one last.
#[derive(Debug, Default)]
pub(crate) struct ViewCache(Mutex<Vec<RecentView>>);

#[derive(Debug)]
struct RecentView {
    camera: Camera,
    /// Transfer function of the last picture.
    transfer_function: TransferFunction,
    /// Changes of widgets so far.
    changes: usize,
    cache: Option<Arc<SegmentCache>>,
    /// True if its segments are too many.
    too_many: bool,
}

/// Plan of a picture.
#[derive(Debug, Clone)]
pub(crate) enum Plan {
    /// Draw from the cells.
    Cells,
    /// Record the segments of the cells, for an optical depth ([`SegmentCache::max_optical_depth`]), and draw from them.
    Record(f64),
    /// Draw from cached segments.
    Cached(Arc<SegmentCache>),
}

impl ViewCache {
    /// Plan of the next picture. `ranges`: of s and g over the grid; `max_optical_depth`: see [`SegmentCache::max_optical_depth`].
    pub fn plan(
        &self,
        camera: &Camera,
        transfer_function: &TransferFunction,
        ranges: [[f64; 2]; 2],
        max_optical_depth: f64,
    ) -> Plan {
        self.with(|views| {
            let Some(index) = views.iter().position(|view| view.camera == *camera) else {
                if views.len() == MAX_VIEWS {
                    views.remove(0);
                }
                views.push(RecentView {
                    camera: *camera,
                    transfer_function: transfer_function.clone(),
                    changes: 0,
                    cache: None,
                    too_many: false,
                });
                return Plan::Cells;
            };
            let mut view = views.remove(index);
            let changed = view.transfer_function != *transfer_function;
            view.changes += usize::from(changed);
            // Of other quantities, or denser than they were projected for.
            let other = view.transfer_function.uses_gradient_magnitude()
                != transfer_function.uses_gradient_magnitude();
            view.cache =
                view.cache.take().filter(|cache| !other && max_optical_depth <= cache.max_optical_depth);
            view.transfer_function = transfer_function.clone();
            let cacheable = is_cacheable(transfer_function, ranges) && !view.too_many;
            let plan = match &view.cache {
                Some(cache) if cacheable => Plan::Cached(cache.clone()),
                None if cacheable && changed && view.changes >= MIN_CHANGES => {
                    Plan::Record(DEPTH_MARGIN * max_optical_depth)
                }
                _ => Plan::Cells,
            };
            views.push(view);
            plan
        })
    }

    /// Stores the segments of a view; `None`: they are too many.
    pub fn store(&self, camera: &Camera, cache: Option<Arc<SegmentCache>>) {
        self.with(|views| {
            if let Some(view) = views.iter_mut().find(|view| view.camera == *camera) {
                view.too_many = cache.is_none();
                view.cache = cache;
            }
        });
    }

    fn with<T>(&self, act: impl FnOnce(&mut Vec<RecentView>) -> T) -> T {
        // The list of views is whole whatever panicked.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// True if values that are counted from the centres of their ranges are exact enough for a transfer function, and caching pays: its
/// widgets are not too narrow, or do not depend on where values are counted from. Values on the edge of a region are rounded as the
/// edge is.
fn is_cacheable(transfer_function: &TransferFunction, ranges: [[f64; 2]; 2]) -> bool {
    let widths: Option<Vec<f64>> =
        transfer_function.widgets.iter().map(|widget| width(widget, ranges)).collect();
    widths.is_some_and(|widths| {
        widths.iter().all(|width| *width >= MIN_CACHED_WIDTH)
            && widths.iter().any(|width| *width >= MIN_WIDE_WIDTH)
    })
}

/// Width of a widget and its region by the range of the values, at least; ∞ where it does not depend on where values are counted from;
/// `None` where it reads further fields, or has pieces that a region cuts, whose closed forms are of 64 bits.
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
            let min = within.fold(f64::INFINITY, f64::min);
            // No value lies there.
            if min < 0.0 { MIN_CACHED_WIDTH } else { min }
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
