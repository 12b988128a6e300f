//! A row's segments front to back: shaded and blended as far as they are seen.

use crate::composite::kernels::{Arrange, Fill, Illuminate};
use crate::composite::layers::Layers;
use crate::composite::lists::Lists;
use crate::composite::pool::Pool;
use crate::composite::rows::{RowSums, Rows};
use crate::fragments::batch::{BATCH, Batch};
use crate::fragments::ends::{Ends, cut};
use crate::kept::KeptSlices;
use crate::project::record::TILE;
use crate::sample::Frame;
use crate::shade::light::Rays;
use crate::shade::roads::{finish, quick};
use crate::shade::shaded::Shaded;
use std::ops::Range;
use voltet_simd::{LaneSet, dispatch};

/// A row's segments in order, slice by slice: each the next segment of all pixels.
pub(crate) enum Slices<'a> {
    /// From lists that are arranged.
    Lists(ListSlices<'a>),
    /// From what was kept of another picture.
    Kept(KeptSlices<'a>),
}

/// See [`Lists::fill`].
pub(crate) struct ListSlices<'a> {
    lists: &'a Lists,
    row: usize,
    stretch: &'a [f32; TILE * TILE],
    /// Slices that were not taken yet.
    left: Range<usize>,
}

impl<'a> ListSlices<'a> {
    /// Of a row that is arranged.
    pub fn new(lists: &'a Lists, row: usize, stretch: &'a [f32; TILE * TILE]) -> ListSlices<'a> {
        ListSlices { lists, row, stretch, left: 0..lists.deepest(row) }
    }

    /// Fills a batch, with `places` if they are wanted; its fragments, none at the end.
    pub fn next(&mut self, lanes: LaneSet, places: bool, batch: &mut Batch) -> usize {
        let ListSlices { lists, row, stretch, left } = self;
        let slices = left.start..(left.start + BATCH / TILE).min(left.end);
        if slices.is_empty() {
            return 0;
        }
        left.start = slices.end;
        let (row, count) = (*row, slices.len() * TILE);
        dispatch(lanes, Fill { lists, row, slices, stretch, places, batch });
        count
    }
}

impl Slices<'_> {
    /// Fills a batch; its fragments, none at the end.
    pub fn next(&mut self, frame: &Frame<'_>, batch: &mut Batch) -> usize {
        match self {
            Slices::Kept(kept) => kept.next(batch),
            Slices::Lists(listed) => {
                let places = frame.ends.is_some() || frame.shader.surface.is_some();
                listed.next(frame.lanes, places, batch)
            }
        }
    }

    /// Segments that were taken of what was kept: those in lists were counted before.
    pub fn segments(&self) -> u64 {
        match self {
            Slices::Kept(kept) => kept.segments,
            Slices::Lists(_) => 0,
        }
    }
}

/// What shades a row.
pub(crate) struct Shading {
    pub batch: Batch,
    pub shaded: Shaded,
    pub pool: Pool,
    pub layers: Layers,
    /// Directions of the tile's rays, where light looks at them.
    pub rays: Rays,
    /// Where they end.
    pub ends: Ends,
}

impl Shading {
    pub fn new(frame: &Frame<'_>) -> Shading {
        Shading {
            batch: Batch::new(frame.attribute_count, frame.scalar_count),
            shaded: Shaded::new(),
            pool: Pool::new(frame.scalar_count),
            layers: Layers::default(),
            rays: [[0.0; TILE * TILE]; 3],
            ends: [f32::INFINITY; TILE * TILE],
        }
    }

    /// Blends a row's segments until nothing of what follows is seen; some may wait for [`Shading::end`].
    pub fn blend(&mut self, frame: &Frame<'_>, row: usize, slices: &mut Slices<'_>, rows: &mut Rows) {
        while !self.hides(row, rows) {
            let count = slices.next(frame, &mut self.batch);
            if count == 0 {
                break;
            }
            self.blend_batch(frame, row, count, rows);
        }
        if self.layers.are_many() {
            self.end(frame, rows);
        }
    }

    /// Whether nothing that may come is seen of a row.
    pub fn hides(&self, row: usize, rows: &Rows) -> bool {
        rows.is_full(row) || (self.layers.holds(row) && self.pool.hides(row))
    }

    /// Blends the first `count` segments of the batch, slices of a row.
    pub fn blend_batch(&mut self, frame: &Frame<'_>, row: usize, count: usize, rows: &mut Rows) {
        let Shading { batch, shaded, pool, layers, ends, .. } = self;
        if frame.ends.is_some() {
            cut(batch, count, frame.attribute_count, ends);
        }
        quick(frame.shader, frame.lanes, batch, count, shaded);
        let waits = layers.holds(row);
        if !frame.shader.pools() {
            finish(frame.shader, frame.lanes, batch, shaded);
        } else if waits || shaded.left_over().iter().any(|which| !which.is_empty()) {
            if !waits {
                pool.begin(row, rows.through(row));
            }
            pool.lend(shaded);
            self.light(frame, count);
            let Shading { batch, shaded, pool, layers, .. } = self;
            return pool.take(frame, (row, batch), shaded, count, layers);
        }
        self.light(frame, count);
        rows.take(frame.lanes, row, &self.batch, &self.shaded, count);
    }

    /// Blends what waits.
    pub fn end(&mut self, frame: &Frame<'_>, rows: &mut Rows) {
        self.pool.finish(frame, &mut self.layers);
        self.layers.end(frame.lanes, rows);
    }

    fn light(&mut self, frame: &Frame<'_>, count: usize) {
        if frame.shader.surface.is_some() {
            let Shading { batch, shaded, rays, .. } = self;
            dispatch(frame.lanes, Illuminate { frame, batch, count, rays, shaded });
        }
    }

    /// Adds up a row's optical depths until the sums are opaque.
    pub fn sum(&mut self, frame: &Frame<'_>, row: usize, slices: &mut Slices<'_>, sums: &mut RowSums<'_>) {
        while !sums.is_full(row) {
            let count = slices.next(frame, &mut self.batch);
            if count == 0 {
                return;
            }
            self.sum_batch(frame, row, count, sums);
        }
    }

    /// Adds up the optical depths of the first `count` segments of the batch, slices of a row.
    pub fn sum_batch(&mut self, frame: &Frame<'_>, row: usize, count: usize, sums: &mut RowSums<'_>) {
        let Shading { batch, shaded, ends, .. } = self;
        if frame.ends.is_some() {
            cut(batch, count, frame.attribute_count, ends);
        }
        quick(frame.shader, frame.lanes, batch, count, shaded);
        finish(frame.shader, frame.lanes, batch, shaded);
        self.light(frame, count);
        sums.take(frame.lanes, row, &self.shaded, count);
    }
}

/// Blends the segments of lists by colours that are known: `rgba` of the number that each has, by its bits, in place of an attribute.
/// Returns the pixels whose segments are not in order.
pub(crate) fn blend_by_numbers(
    lanes: LaneSet,
    lists: &mut Lists,
    sorted: bool,
    rgba: &[[f32; 4]],
    rows: &mut Rows,
) -> u64 {
    let (mut batch, mut shaded, mut disordered) = (Batch::new(1, 1), Shaded::new(), 0);
    for row in 0..TILE {
        disordered += dispatch(lanes, Arrange { lists, row, sorted });
        let mut slices = ListSlices::new(lists, row, &[1.0; TILE * TILE]);
        while !rows.is_full(row) {
            let count = slices.next(lanes, false, &mut batch);
            if count == 0 {
                break;
            }
            for k in 0..count {
                let of_segment = rgba.get(batch.front[0][k].to_bits() as usize).copied().unwrap_or_default();
                shaded.rgba.iter_mut().zip(of_segment).for_each(|(column, value)| column[k] = value);
            }
            rows.take(lanes, row, &batch, &shaded, count);
        }
    }
    disordered
}
