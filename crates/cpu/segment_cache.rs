//! Segment cache of a view: while only widgets change, a picture is shaded and blended anew, and nothing is culled, projected, intersected
//! or sorted.
//!
//! Each segment is cached with its length and its values at both ends: those of every cell in view, front to back, the pixels of a row side
//! by side. Pictures from the cache differ from others by what culling leaves out, 1e-6 at most, and by the rounding of values that are
//! counted from the centre of their range.
//!
//! While a widget is dragged, a picture from the cells takes 1.2 to 3.0 times as long as one from the cache, in the median 2.0 times: heat
//! sink and blunt fin, each with a piecewise-linear function and a wide Gaussian, the blunt fin with four Gaussians, too, at 512 × 512 and
//! 1024 × 768; a virtual machine with two cores and AVX-512. Narrow widgets, of which culling leaves few cells, are drawn from these
//! ([`MIN_WIDE_WIDTH`]). `lab/bench/frames.py` times steady frames from the cells, by `voltet time`.

use crate::fragments::batch::{BATCH, Batch};
use crate::tile::TILE;
use crate::tolerances::MIN_CACHED_WIDTH;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::camera::Camera;
use voltet_core::transfer::{AxisOrigin, Profile, TransferFunction, Widget};

#[derive(Debug)]
pub(crate) struct SegmentCache {
    tiles: Vec<Option<CachedTile>>,
    /// Numbers of the tiles that have segments, fullest first.
    pub queue: Vec<u32>,
    /// Optical depth that they were projected for: see [`crate::project::cells::Input::max_optical_depth`].
    pub max_optical_depth: f64,
}

/// Cached segments of a tile, slice by slice: the lengths of 16 pixels, each attribute at their entries, each at their exits.
#[derive(Debug, Default)]
pub(crate) struct CachedTile {
    /// The first slice of each row; then the end of the last.
    pub(super) begins: [u32; TILE + 1],
    pub(super) numbers: Vec<f32>,
}

impl SegmentCache {
    /// Cache of tiles with their numbers. `count`: tiles of the picture.
    pub fn new(tiles: Vec<(u32, CachedTile)>, count: usize, max_optical_depth: f64) -> SegmentCache {
        let mut queue: Vec<(usize, u32)> =
            tiles.iter().map(|(tile, cached)| (cached.numbers.len(), *tile)).collect();
        queue.sort_unstable_by(|a, b| b.cmp(a));
        let mut by_number: Vec<Option<CachedTile>> = (0..count).map(|_| None).collect();
        for (tile, cached) in tiles {
            by_number[tile as usize] = Some(cached);
        }
        SegmentCache {
            tiles: by_number,
            queue: queue.into_iter().map(|(_, tile)| tile).collect(),
            max_optical_depth,
        }
    }

    pub fn tile(&self, tile: usize) -> Option<&CachedTile> {
        self.tiles.get(tile)?.as_ref()
    }
}

/// Memory budget of a segment cache, shared by the workers that record.
#[derive(Debug)]
pub(crate) struct CacheBudget {
    remaining: AtomicU64,
    /// True if the segments were too many, or those of a pixel.
    exhausted: AtomicBool,
}

impl CacheBudget {
    /// `limit`: bytes.
    pub fn new(limit: u64) -> CacheBudget {
        CacheBudget { remaining: AtomicU64::new(limit), exhausted: AtomicBool::new(false) }
    }

    pub fn is_exhausted(&self) -> bool {
        self.exhausted.load(Ordering::Relaxed)
    }

    pub fn exhaust(&self) {
        self.exhausted.store(true, Ordering::Relaxed);
    }

    /// Takes a recorded tile's bytes of the budget. Returns `None`, and exhausts it, where they are too many.
    pub fn take(&self, mut tile: CachedTile) -> Option<CachedTile> {
        tile.numbers.shrink_to_fit();
        let bytes = size_of_val(tile.numbers.as_slice()) as u64;
        let less = |remaining: u64| remaining.checked_sub(bytes);
        let taken = self.remaining.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).is_ok();
        if !taken {
            self.exhaust();
        }
        taken.then_some(tile)
    }
}

const SLICES_PER_BATCH: usize = BATCH / TILE;

/// Slices of a row of a tile, as many at a time as a batch takes.
pub(crate) struct CachedSlices<'a> {
    numbers: &'a [f32],
    columns: usize,
    /// Segments that were taken so far.
    pub segments: u64,
}

impl CachedTile {
    /// Records the first `count` segments of a batch, slices of a row, behind those of the rows before.
    pub fn record(&mut self, row: usize, batch: &Batch, count: usize) {
        let ends = [&batch.front, &batch.back].map(|columns| &columns[..batch.scalar_count]);
        for at in (0..count).step_by(TILE) {
            for column in std::iter::once(&*batch.length).chain(ends.into_iter().flatten()) {
                self.numbers.extend_from_slice(&column[at..][..TILE]);
            }
        }
        let slices = (count / TILE) as u32;
        self.begins[row + 1..].iter_mut().for_each(|begin| *begin += slices);
    }

    pub fn slices(&self, row: usize, scalar_count: usize) -> CachedSlices<'_> {
        let columns = 1 + 2 * scalar_count;
        let [from, to] = [row, row + 1].map(|row| self.begins[row] as usize * columns * TILE);
        CachedSlices { numbers: &self.numbers[from..to], columns, segments: 0 }
    }
}

impl CachedSlices<'_> {
    /// Fills a batch; returns its fragments, none at the end.
    pub fn next(&mut self, batch: &mut Batch) -> usize {
        let of_slice = self.columns * TILE;
        let some = self.numbers.len().min(SLICES_PER_BATCH * of_slice);
        let (now, later) = self.numbers.split_at(some);
        self.numbers = later;
        let scalar_count = batch.scalar_count;
        let columns = std::iter::once(&mut *batch.length)
            .chain(&mut batch.front[..scalar_count])
            .chain(&mut batch.back[..scalar_count]);
        for (number, column) in columns.enumerate() {
            for (to, slice) in column.chunks_exact_mut(TILE).zip(now.chunks_exact(of_slice)) {
                to.copy_from_slice(&slice[number * TILE..][..TILE]);
            }
        }
        let count = some / self.columns;
        self.segments += batch.length[..count].iter().filter(|length| **length > 0.0).count() as u64;
        count
    }
}

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
    too_many: bool,
}

#[derive(Debug, Clone)]
pub(crate) enum Plan {
    Cells,
    /// Record the segments of the cells, for an optical depth ([`SegmentCache::max_optical_depth`]), and draw from them.
    Record(f64),
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
