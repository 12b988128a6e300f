//! Row shader: a row's segments front to back, shaded and blended as far as they are visible (early ray termination).

use crate::cast::packet::PACKETS_IN_FLIGHT;
use crate::cast::ray_caster::BoundaryHits;
use crate::composite::accumulators::{TileAccumulator, TilePixels};
use crate::composite::deferred_shading::{DeferredFragments, DeferredShading};
use crate::composite::fragment_lists::{Arrange, Fill, FragmentLists};
use crate::composite::frame::{FrameContext, SegmentSource};
use crate::composite::illumination::illuminate;
use crate::composite::segment_parts::SegmentCutter;
use crate::composite::straight_pieces::straighten;
use crate::composite::stretches::{RowSegments, StretchRecorder, WAS_CUT};
use crate::counts::Counts;
use crate::fragments::batch::{BATCH, Batch, DepthLimits, MAX_LANES, clip_to_depth};
use crate::fragments::crossing::CellPacket;
use crate::fragments::spans::{Edges, Fragments};
use crate::shade::light::{Rays, rays};
use crate::shade::shaded_batch::ShadedBatch;
use crate::shade::shader::{finish, integrate_first};
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use std::ops::Range;
use voltet_simd::{LaneSet, dispatch};

pub(crate) struct ListedSlices<'a> {
    lists: &'a FragmentLists,
    row: usize,
    length_per_depth: &'a [f32; PIXELS],
    remaining: Range<usize>,
}

impl<'a> ListedSlices<'a> {
    /// All slices of a row that is sorted.
    pub fn new(
        lists: &'a FragmentLists,
        row: usize,
        length_per_depth: &'a [f32; PIXELS],
    ) -> ListedSlices<'a> {
        ListedSlices { lists, row, length_per_depth, remaining: 0..lists.max_length(row) }
    }

    /// Fills a batch, if `depths` with pixels, entries and exits; returns its fragments, none at the end.
    pub fn next(&mut self, lanes: LaneSet, depths: bool, batch: &mut Batch) -> usize {
        let ListedSlices { lists, row, length_per_depth, remaining } = self;
        let slices = remaining.start..(remaining.start + BATCH / TILE).min(remaining.end);
        if slices.is_empty() {
            return 0;
        }
        remaining.start = slices.end;
        let (row, count) = (*row, slices.len() * TILE);
        dispatch(lanes, Fill { lists, row, slices, length_per_depth, depths, batch });
        count
    }
}

pub(crate) struct RowShader {
    pub batch: Batch,
    pub shaded: ShadedBatch,
    pub deferred_shading: DeferredShading,
    pub deferred: DeferredFragments,
    /// Directions of the tile's rays, where light reads them.
    pub rays: Rays,
    pub depth_limits: DepthLimits,
    /// Cutter of segments: at surfaces and clips, and along curved axes.
    pub cutter: Option<Box<SegmentCutter>>,
    /// Segments with values along curved axes, while the batch has their pieces with positions.
    values: Option<Box<Batch>>,
    /// Recorder of the stretches that the cells fill, where they are recorded.
    pub recorder: Option<StretchRecorder>,
}

impl RowShader {
    pub fn new(frame: &FrameContext<'_>) -> RowShader {
        RowShader {
            batch: Batch::new(frame.attribute_count(), frame.scalar_count),
            shaded: ShadedBatch::new(),
            deferred_shading: DeferredShading::new(frame.scalar_count),
            deferred: DeferredFragments::default(),
            rays: [[0.0; PIXELS]; 3],
            depth_limits: [f32::INFINITY; PIXELS],
            cutter: (frame.events.is_some() || frame.axes.is_some())
                .then(|| Box::new(SegmentCutter::new(frame))),
            values: frame.axes.map(|_| Box::new(Batch::new(frame.attribute_count(), frame.scalar_count))),
            recorder: frame.records_stretches.then(|| {
                let is_cast = matches!(frame.source, SegmentSource::RayCast(_));
                StretchRecorder::new(frame.events.is_some(), is_cast)
            }),
        }
    }

    /// Blends a row's segments, or adds up their optical depths, until the row is opaque; some may be deferred to [`RowShader::end`].
    /// `next`: fills a batch with slices of the row, each the next segment of all pixels, and returns its fragments, none at the end.
    pub fn blend(
        &mut self,
        frame: &FrameContext<'_>,
        row: usize,
        next: &mut dyn FnMut(&mut Batch) -> usize,
        pixels: &mut TilePixels,
    ) {
        while !self.is_opaque(row, pixels) {
            let count = next(&mut self.batch);
            if count == 0 {
                break;
            }
            self.blend_batch(frame, row, count, pixels);
        }
        if self.deferred.is_large() {
            self.end(frame, pixels);
        }
    }

    /// True if no further segment is visible in a row.
    pub fn is_opaque(&self, row: usize, pixels: &TilePixels) -> bool {
        pixels.is_opaque(row) || (self.deferred.holds(row) && self.deferred_shading.is_opaque(row))
    }

    /// Blends the first `count` segments of the batch, slices of a row, or adds up their optical depths.
    pub fn blend_batch(
        &mut self,
        frame: &FrameContext<'_>,
        row: usize,
        count: usize,
        pixels: &mut TilePixels,
    ) {
        if frame.depth_limit.is_some() {
            clip_to_depth(&mut self.batch, count, frame.attribute_count(), &self.depth_limits);
        }
        let Some(mut cutter) = self.cutter.take() else {
            return self.blend_slices(frame, row, count, &[], pixels);
        };
        if let (Some(axes), Some(mut source)) = (frame.axes, self.values.take()) {
            std::mem::swap(&mut self.batch, &mut source);
            let mut next = 0;
            while next < count {
                let slots = (&*source, next..count);
                let (rest, count, cut) =
                    straighten(&mut cutter, frame, axes, slots, &mut self.batch, &self.rays);
                if count > 0 {
                    self.blend_slices(frame, row, count, cut, pixels);
                }
                next = rest;
            }
            self.values = Some(source);
        } else {
            let (count, cut) = cutter.cut_row(frame, &mut self.batch, count, &self.rays);
            if count > 0 {
                self.blend_slices(frame, row, count, cut, pixels);
            }
        }
        if let Some(recorder) = &mut self.recorder {
            cutter.hand_on(recorder);
        }
        self.cutter = Some(cutter);
    }

    /// Blends the first `count` segments of the batch; `cut`: slots and colours of those that were cut.
    fn blend_slices(
        &mut self,
        frame: &FrameContext<'_>,
        row: usize,
        count: usize,
        cut: &[(usize, [f32; 4])],
        pixels: &mut TilePixels,
    ) {
        let RowShader { batch, shaded, deferred_shading, deferred, .. } = self;
        integrate_first(frame.shader, frame.lanes, batch, count, shaded);
        let pixels = match pixels {
            TilePixels::Colors(pixels) => pixels,
            TilePixels::OneColor(_, depths) => {
                finish(frame.shader, frame.lanes, batch, shaded);
                self.light(frame, count);
                for (k, [.., depth]) in cut {
                    self.shaded.depth[*k] = *depth;
                }
                return depths.take_row(frame.lanes, row, &self.shaded, count);
            }
        };
        let is_deferred = deferred.holds(row);
        if !frame.shader.pools() {
            finish(frame.shader, frame.lanes, batch, shaded);
        } else if is_deferred || shaded.left_over().iter().any(|which| !which.is_empty()) {
            if !is_deferred {
                deferred_shading.begin(row, pixels.transmittance(row));
            }
            deferred_shading.mark_deferred(shaded);
            self.light(frame, count);
            self.put_colors(row, cut, pixels);
            let RowShader { batch, shaded, deferred_shading, deferred, .. } = self;
            return deferred_shading.take(frame, (row, batch), shaded, count, deferred);
        }
        self.light(frame, count);
        self.put_colors(row, cut, pixels);
        let RowShader { batch, shaded, recorder, .. } = self;
        let lengths = Some(&batch.length[..count]);
        let columns = shaded.rgba.each_ref().map(|column| &column[..count]);
        match recorder {
            None => pixels.blend(frame.lanes, row, lengths, columns),
            Some(recorder) => {
                let depths = [&batch.entry[..count], &batch.exit[..count]];
                recorder.blend(frame.lanes, row, RowSegments { lengths, columns, depths }, pixels);
            }
        }
    }

    /// Puts the colours of segments that were cut into their slots, which have no length; where stretches are recorded, they stay without: the
    /// parts of these segments are by themselves, end the run before them, and hide what is behind.
    fn put_colors(&mut self, row: usize, cut: &[(usize, [f32; 4])], pixels: &mut TileAccumulator) {
        for (k, rgba) in cut {
            if self.recorder.is_some() {
                self.batch.exit[*k] = WAS_CUT;
                pixels.hide(row * TILE + k % TILE, rgba[3]);
                continue;
            }
            self.batch.length[*k] = 1.0;
            self.shaded.rgba.iter_mut().zip(rgba).for_each(|(column, value)| column[*k] = *value);
        }
    }

    /// Blends what is deferred, and stores the pixels of a tile.
    pub fn store(&mut self, frame: &FrameContext<'_>, mut pixels: TilePixels, picture: &mut TilePicture) {
        self.end(frame, &mut pixels);
        if let (TilePixels::Colors(pixels), Some(recorder)) = (&mut pixels, &mut self.recorder) {
            recorder.close_all(pixels);
        }
        pixels.store(picture);
    }

    /// Composites the surfaces behind the last segments of a tile's pixels.
    pub fn end_events(&mut self, frame: &FrameContext<'_>, picture: &mut TilePicture) {
        if let (Some(events), Some(cutter)) = (frame.events, &mut self.cutter) {
            cutter.end(events, picture);
        }
    }

    /// Blends the deferred segments.
    pub fn end(&mut self, frame: &FrameContext<'_>, pixels: &mut TilePixels) {
        if let TilePixels::Colors(pixels) = pixels {
            self.deferred_shading.finish(frame, &mut self.deferred);
            self.deferred.end(frame.lanes, pixels, self.recorder.as_mut());
        }
    }

    fn light(&mut self, frame: &FrameContext<'_>, count: usize) {
        illuminate(frame, &self.batch, count, &self.rays, &mut self.shaded);
    }
}

/// Blends the segments of lists by known colours: `rgba` of the number whose bits each has in place of an attribute. Returns the pixels
/// whose segments are not in order.
pub(crate) fn blend_by_numbers(
    lanes: LaneSet,
    lists: &mut FragmentLists,
    sorted: bool,
    rgba: &[[f32; 4]],
    pixels: &mut TileAccumulator,
) -> u64 {
    let (mut batch, mut shaded, mut disordered) = (Batch::new(1, 1), ShadedBatch::new(), 0);
    for row in 0..TILE {
        disordered += dispatch(lanes, Arrange { lists, row, sorted });
        let mut slices = ListedSlices::new(lists, row, &[1.0; PIXELS]);
        while !pixels.is_opaque(row) {
            let count = slices.next(lanes, false, &mut batch);
            if count == 0 {
                break;
            }
            for k in 0..count {
                let of_segment = rgba.get(batch.front[0][k].to_bits() as usize).copied().unwrap_or_default();
                shaded.rgba.iter_mut().zip(of_segment).for_each(|(column, value)| column[k] = value);
            }
            let lengths = Some(&batch.length[..count]);
            pixels.blend(lanes, row, lengths, shaded.rgba.each_ref().map(|column| &column[..count]));
        }
    }
    disordered
}

pub(crate) struct Scratch {
    pub fragments: Fragments,
    pub edges: Edges,
    pub packet: CellPacket,
    pub length_per_depth: [f32; PIXELS],
    pub row_shader: RowShader,
    /// Boundary faces that rays enter by, and batches of packets beside the first, where rays are cast.
    pub hits: BoundaryHits,
    pub further: [Batch; PACKETS_IN_FLIGHT - 1],
    pub counts: Counts,
}

impl Scratch {
    pub fn new(frame: &FrameContext<'_>) -> Scratch {
        let attribute_count = frame.attribute_count();
        Scratch {
            fragments: Fragments::new(MAX_LANES),
            edges: Edges::new(),
            packet: CellPacket::new(attribute_count),
            length_per_depth: [1.0; PIXELS],
            row_shader: RowShader::new(frame),
            hits: BoundaryHits::default(),
            further: std::array::from_fn(|_| Batch::new(attribute_count, frame.scalar_count)),
            counts: Counts::default(),
        }
    }

    /// Finds lengths, directions and depth limits of a tile's rays. Returns its rectangle.
    pub fn begin(&mut self, frame: &FrameContext<'_>, tile: usize) -> TileRect {
        let rect = TileRect::new(tile, frame.view.size);
        frame.lengths_per_depth(rect, &mut self.length_per_depth);
        let RowShader { rays: of_tile, depth_limits, .. } = &mut self.row_shader;
        if frame.shader.surface.is_some_and(|surface| surface.silhouette.is_some()) {
            rays(frame.view, rect.left, rect.top, of_tile);
        }
        frame.depth_limits_of(rect, depth_limits);
        if let Some(cutter) = &mut self.row_shader.cutter {
            cutter.begin(frame, rect);
        }
        rect
    }
}
