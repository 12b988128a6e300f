//! Deferred shading: segments of many batches that need a slower kernel are queued until there are enough of a kind to fill vectors, for
//! they are few among their neighbours. Occluded ones are dropped.

use crate::composite::accumulators::TileAccumulator;
use crate::composite::frame::FrameContext;
use crate::composite::stretches::{RowSegments, StretchRecorder};
use crate::fragments::batch::{BATCH, Batch, Column};
use crate::shade::shaded_batch::{KINDS, ShadedBatch};
use crate::shade::shader::finish;
use crate::tile::TILE;
use crate::tolerances::{MIN_DEFERRED_VISIBILITY, MIN_TRANSMITTANCE_SAFE};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, dispatch};

/// Queues of segments that need a slower kernel: one for each kind of [`ShadedBatch::left_over`].
pub(crate) struct DeferredShading {
    queues: [Queue; KINDS],
    /// Opacities of a batch's segments, before and after light.
    opacity: Box<Column>,
    opacities: Box<Column>,
    /// Upper bound of the transmittance in front of a batch's segments.
    visibility: Box<Column>,
    /// Upper bound of the transmittance of the pixels of deferred rows.
    transmittance: Box<[[f32; TILE]; TILE]>,
    /// Results of the slower kernels.
    pub shaded: ShadedBatch,
}

/// Segments of one kind.
struct Queue {
    batch: Batch,
    /// Indices among the deferred fragments.
    index: Box<Column<u32>>,
    opacity: Box<Column>,
    /// Factors of light on colour and opacity.
    light: [Box<Column>; 2],
    count: usize,
}

/// Kind of segments whose opacities are unknown.
const UNKNOWN: usize = KINDS - 1;

/// Segments of unknown opacity that are queued at most: those behind them may be occluded.
const MAX_UNKNOWN: usize = 32;

impl DeferredShading {
    pub fn new(scalar_count: usize) -> DeferredShading {
        let queue = |_| Queue {
            batch: Batch::new(scalar_count, scalar_count),
            index: Column::new(),
            opacity: Column::new(),
            light: [Column::new(), Column::new()],
            count: 0,
        };
        DeferredShading {
            queues: std::array::from_fn(queue),
            opacity: Column::new(),
            opacities: Column::new(),
            visibility: Column::new(),
            transmittance: Box::new([[1.0; TILE]; TILE]),
            shaded: ShadedBatch::new(),
        }
    }

    /// Begins a row whose pixels have a transmittance.
    pub fn begin(&mut self, row: usize, transmittance: [f32; TILE]) {
        self.transmittance[row] = transmittance;
    }

    /// True if no further segment of a deferred row is visible.
    pub fn is_opaque(&self, row: usize) -> bool {
        self.transmittance[row].iter().all(|transmittance| *transmittance <= MIN_TRANSMITTANCE_SAFE)
    }

    /// Makes the segments of a batch that will be deferred white and opaque, so that the factors of light are kept.
    pub fn mark_deferred(&mut self, shaded: &mut ShadedBatch) {
        let ShadedBatch { quadrature_queues, thick_pieces, optically_thick, fallback_queue, rgba, .. } =
            shaded;
        let others = [&*thick_pieces, &*optically_thick, &*fallback_queue];
        for &k in quadrature_queues.iter().chain(others).flatten() {
            self.opacity[k] = rgba[3][k];
            rgba.iter_mut().for_each(|column| column[k] = 1.0);
        }
    }

    /// Puts the first `count` segments of a batch, slices of a row, among the deferred fragments, and those that may be visible and need a slower kernel in queues.
    pub fn take(
        &mut self,
        frame: &FrameContext<'_>,
        (row, batch): (usize, &Batch),
        shaded: &ShadedBatch,
        count: usize,
        deferred: &mut DeferredFragments,
    ) {
        self.find_visibility(frame.lanes, row, batch, shaded, count);
        let first = deferred.take(frame, (row, batch), shaded, count);
        let rgba = &shaded.rgba;
        for (number, which) in shaded.left_over().into_iter().enumerate() {
            for &k in which {
                let index = first + k;
                if self.visibility[k] <= MIN_DEFERRED_VISIBILITY {
                    // The white of a marked segment would show.
                    deferred.set(index, [0.0, 0.0, 0.0, self.opacities[k]]);
                    continue;
                }
                let queue = &mut self.queues[number];
                let to = queue.count;
                queue.batch.length[to] = batch.length[k];
                for a in 0..queue.batch.scalar_count {
                    queue.batch.front[a][to] = batch.front[a][k];
                    queue.batch.back[a][to] = batch.back[a][k];
                }
                queue.index[to] = index as u32;
                queue.opacity[to] = self.opacity[k];
                queue.light[0][to] = rgba[0][k];
                queue.light[1][to] = rgba[3][k];
                queue.count += 1;
                if queue.count == BATCH {
                    self.run_queue(number, frame, deferred);
                }
            }
        }
        if self.queues[UNKNOWN].count > MAX_UNKNOWN {
            self.run_queue(UNKNOWN, frame, deferred);
        }
    }

    /// Finds the visibility of each segment of a batch, and opacities after light; 0 where they are unknown.
    fn find_visibility(
        &mut self,
        lanes: LaneSet,
        row: usize,
        batch: &Batch,
        shaded: &ShadedBatch,
        count: usize,
    ) {
        let opacities = &mut self.opacities;
        opacities.copy_from_slice(&**shaded.rgba[3]);
        for (number, which) in shaded.left_over().into_iter().enumerate() {
            for &k in which {
                opacities[k] *= if number == UNKNOWN { 0.0 } else { self.opacity[k] };
            }
        }
        let transmittance = &mut self.transmittance[row];
        let (lengths, visibility) = (&batch.length[..count], &mut **self.visibility);
        dispatch(lanes, Visibility { transmittance, lengths, opacities: &opacities[..], visibility });
    }

    /// Runs the slower kernels on all queues.
    pub fn finish(&mut self, frame: &FrameContext<'_>, deferred: &mut DeferredFragments) {
        for number in 0..self.queues.len() {
            self.run_queue(number, frame, deferred);
        }
    }

    fn run_queue(&mut self, number: usize, frame: &FrameContext<'_>, deferred: &mut DeferredFragments) {
        let DeferredShading { queues, shaded, transmittance, .. } = self;
        let queue = &mut queues[number];
        let count = std::mem::take(&mut queue.count);
        if count == 0 {
            return;
        }
        shaded.clear();
        shaded.left_over_mut()[number].extend(0..count);
        shaded.rgba[3].copy_from_slice(&**queue.opacity);
        finish(frame.shader, frame.lanes, &queue.batch, shaded);
        let [color, opacity] = &queue.light;
        for (column, light) in shaded.rgba.iter_mut().zip([color, color, color, opacity]) {
            column.iter_mut().zip(light.iter()).take(count).for_each(|(value, light)| *value *= light);
        }
        let [r, g, b, a] = &shaded.rgba;
        for (k, &index) in queue.index.iter().enumerate().take(count) {
            deferred.set(index as usize, [r[k], g[k], b[k], a[k]]);
            if number == UNKNOWN {
                transmittance[deferred.row_of(index as usize)][index as usize % TILE] *= 1.0 - a[k];
            }
        }
    }
}

/// Upper bound of the transmittance in front of the segments of a row's slices, all of them whole, and behind the last.
struct Visibility<'a> {
    transmittance: &'a mut [f32; TILE],
    /// Lengths of the segments: those of no length are none.
    lengths: &'a [f32],
    opacities: &'a [f32],
    visibility: &'a mut [f32],
}

impl Kernel for Visibility<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Visibility { transmittance, lengths, opacities, visibility } = self;
        debug_assert!(lengths.len().is_multiple_of(TILE), "whole slices");
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        for half in (0..TILE).step_by(L::WIDTH) {
            let mut through = L::F::load(&transmittance[half..]);
            for at in (half..lengths.len()).step_by(TILE) {
                through.store(&mut visibility[at..]);
                let is_one = zero.lt(L::F::load(&lengths[at..]));
                through = through * L::F::select(is_one, one - L::F::load(&opacities[at..]), one);
            }
            through.store(&mut transmittance[half..]);
        }
    }
}

/// Copies the values of segments to a column, whole slices of a row; `none` in place of those of no length.
struct PutSegments<'a> {
    column: &'a mut [f32],
    values: &'a [f32],
    lengths: &'a [f32],
    none: f32,
}

impl Kernel for PutSegments<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let PutSegments { column, values, lengths, none } = self;
        debug_assert!(lengths.len().is_multiple_of(TILE), "whole slices");
        for at in (0..lengths.len()).step_by(L::WIDTH) {
            let is_one = L::F::splat(0.0).lt(L::F::load(&lengths[at..]));
            L::F::select(is_one, L::F::load(&values[at..]), L::F::splat(none)).store(&mut column[at..]);
        }
    }
}

/// Colours and opacities of the segments of some rows, front to back, some of which are not shaded yet: row by row, slice by slice, the
/// pixels of the row side by side.
#[derive(Default)]
pub(crate) struct DeferredFragments {
    columns: [Vec<f32>; 4],
    /// Depths of entries, infinite of those that are none, and of exits, as the recorder takes them, where stretches of rays are recorded.
    depths: [Vec<f32>; 2],
    /// Deferred rows, each with the index of its first segment; a row may come again.
    rows: Vec<(usize, usize)>,
}

/// Deferred segments from which on they are blended before a further row begins: more leave the second-level cache.
const FLUSH_THRESHOLD: usize = 1 << 13;

impl DeferredFragments {
    pub fn holds(&self, row: usize) -> bool {
        self.rows.iter().any(|(deferred, _)| *deferred == row)
    }

    /// True if so many segments are deferred that they are best blended.
    pub fn is_large(&self) -> bool {
        self.columns[0].len() >= FLUSH_THRESHOLD
    }

    pub fn row_of(&self, index: usize) -> usize {
        let behind = self.rows.partition_point(|(_, first)| *first <= index);
        self.rows[behind - 1].0
    }

    /// Takes the first `count` segments of a batch, whole slices of a row; those of no length are clear. Returns the index of the first.
    pub fn take(
        &mut self,
        frame: &FrameContext<'_>,
        (row, batch): (usize, &Batch),
        shaded: &ShadedBatch,
        count: usize,
    ) -> usize {
        let first = self.columns[0].len();
        if self.rows.last().is_none_or(|(last, _)| *last != row) {
            self.rows.push((row, first));
        }
        let lengths = &batch.length[..count];
        let put = |column: &mut Vec<f32>, values: &[f32], none: f32| {
            column.resize(first + count, none);
            dispatch(frame.lanes, PutSegments { column: &mut column[first..], values, lengths, none });
        };
        for (column, values) in self.columns.iter_mut().zip(&shaded.rgba) {
            put(column, &values[..], 0.0);
        }
        if frame.records_stretches {
            let [entries, exits] = &mut self.depths;
            put(entries, &batch.entry[..], f32::INFINITY);
            exits.extend_from_slice(&batch.exit[..count]);
        }
        first
    }

    /// Sets colour and opacity of the segment with an index.
    pub fn set(&mut self, index: usize, rgba: [f32; 4]) {
        self.columns.iter_mut().zip(rgba).for_each(|(column, value)| column[index] = value);
    }

    /// Blends all segments into their rows; none remains. `recorder`: that of stretches of rays, where they are recorded.
    pub fn end(
        &mut self,
        lanes: LaneSet,
        pixels: &mut TileAccumulator,
        mut recorder: Option<&mut StretchRecorder>,
    ) {
        debug_assert!(self.columns[0].len().is_multiple_of(TILE), "whole slices");
        let last = self.columns[0].len();
        for (k, &(row, first)) in self.rows.iter().enumerate() {
            let end = self.rows.get(k + 1).map_or(last, |(_, next)| *next);
            let columns = self.columns.each_ref().map(|column| &column[first..end]);
            match &mut recorder {
                None => pixels.blend(lanes, row, None, columns),
                Some(recorder) => {
                    let depths = self.depths.each_ref().map(|column| &column[first..end]);
                    recorder.blend(lanes, row, RowSegments { lengths: None, columns, depths }, pixels);
                }
            }
        }
        self.rows.clear();
        self.columns.iter_mut().chain(&mut self.depths).for_each(Vec::clear);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two slices: lengths, values (not a number where a slot has no segment), and the transmittance before them.
    fn slices() -> ([f32; 2 * TILE], [f32; 2 * TILE], [f32; TILE]) {
        let lengths: [f32; 2 * TILE] =
            std::array::from_fn(|k| if k * 5 % 3 == 0 { 0.0 } else { 0.5 + k as f32 });
        let value = |k: usize| if lengths[k] > 0.0 { k as f32 / 64.0 } else { f32::NAN };
        (lengths, std::array::from_fn(value), std::array::from_fn(|x| 1.0 - x as f32 / 32.0))
    }

    fn each_lane_set(check: impl Fn(LaneSet)) {
        LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()).for_each(check);
    }

    #[test]
    fn segments_dim_those_behind_them_in_their_pixel() {
        let (lengths, opacities, before) = slices();
        let (mut through, mut expected) = (before, [0.0; 2 * TILE]);
        for k in 0..2 * TILE {
            expected[k] = through[k % TILE];
            if lengths[k] > 0.0 {
                through[k % TILE] *= 1.0 - opacities[k];
            }
        }
        each_lane_set(|lanes| {
            let (mut transmittance, mut visibility) = (before, [9.0; 3 * TILE]);
            dispatch(
                lanes,
                Visibility {
                    transmittance: &mut transmittance,
                    lengths: &lengths,
                    opacities: &opacities,
                    visibility: &mut visibility,
                },
            );
            assert_eq!(
                (transmittance, &visibility[..2 * TILE]),
                (through, &expected[..]),
                "{}",
                lanes.name()
            );
            assert_eq!(visibility[2 * TILE..], [9.0; TILE], "{}: nothing behind the slices", lanes.name());
        });
    }

    #[test]
    fn slots_of_no_length_are_put_aside_as_none() {
        let (lengths, values, _) = slices();
        let expected: [f32; 2 * TILE] =
            std::array::from_fn(|k| if lengths[k] > 0.0 { values[k] } else { f32::INFINITY });
        each_lane_set(|lanes| {
            let mut column = [9.0; 2 * TILE];
            dispatch(
                lanes,
                PutSegments { column: &mut column, values: &values, lengths: &lengths, none: f32::INFINITY },
            );
            assert_eq!(column, expected, "{}", lanes.name());
        });
    }
}
