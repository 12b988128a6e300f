//! Scene that a kernel is prepared for, segments of a batch in lanes, and their results.

use crate::fragments::batch::{Column, meant};
use crate::shade::context::{ShaderContext, WidgetContext};
use crate::shade::kernel::{SegmentBatch, overlaps, push};
use crate::shade::kinds::LaneWidget;
use crate::shade::region::ValueRange;
use crate::shade::segment_lanes::{FieldLanes, SegmentLanes};
use crate::shade::shaded_batch::{FallbackReason, ShadedBatch};
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_optics::integrators::{Extent, SegmentIntegrator};
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::{Float, LaneSet, Lanes, inlined};

/// The scene that a kernel is prepared for.
pub struct LaneScene<'a> {
    pub(crate) widgets: &'a [LaneWidget],
    pub(crate) context: &'a WidgetContext<'a>,
    pub(crate) scene: &'a ShaderContext<'a>,
    /// The transfer function.
    pub transfer_function: &'a TransferFunction,
    /// The integrator in 64 bits, whose tables a kernel may share; `None` where the kernels integrate all segments.
    pub exact: Option<&'a dyn SegmentIntegrator>,
}

/// Storage of a field: value = offset + scale × stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldAxis {
    /// Place among the values at a segment's ends: 0 for s, 1 for g, then the further fields.
    pub place: usize,
    /// The value that 0 stands for.
    pub offset: f64,
    /// Value of a stored unit.
    pub scale: f64,
}

impl<'a> LaneScene<'a> {
    /// The widgets.
    pub fn widgets(&self) -> impl ExactSizeIterator<Item = &'a LaneWidget> + use<'a> {
        self.widgets.iter()
    }

    /// The optical model.
    pub fn model(&self) -> OpticalModel {
        self.context.model
    }

    /// World units in a scene length, in which segments are measured.
    pub fn length(&self) -> f64 {
        self.scene.length
    }

    /// The domain of a table over the data.
    pub fn extent(&self) -> &Extent {
        &self.scene.extent
    }

    /// The lane set, for filling tables.
    pub fn lanes(&self) -> LaneSet {
        self.scene.lanes
    }

    /// True if segments of negligible depth ([`super::NEGLIGIBLE_DEPTH`]) may be skipped.
    pub fn may_skip(&self) -> bool {
        self.context.left_out.is_some()
    }

    /// True if widgets read fields beside s and g.
    pub fn reads_fields(&self) -> bool {
        !self.context.fields.is_empty()
    }

    /// Storage of the scalar.
    pub fn scalar_axis(&self) -> FieldAxis {
        let axis = &self.context.attributes[0];
        FieldAxis { place: 0, offset: axis.offset, scale: axis.scale }
    }

    /// Storage of a further field.
    pub fn field(&self, name: &str) -> Option<FieldAxis> {
        let (place, axis) = self.context.field(name)?;
        Some(FieldAxis { place: 2 + place, offset: axis.offset, scale: axis.scale })
    }

    /// Factor that turns the constant-emitter's emission to that of a scene length; `None` for the density-emitter.
    ///
    /// Errors: 32 bits do not hold it.
    pub fn glow_scale(&self) -> Result<Option<f32>, FallbackReason> {
        self.context.glow_scale()
    }
}

/// Results of a batch.
pub struct SegmentResults<'a>(pub(crate) &'a mut ShadedBatch);

impl<'a> SegmentBatch<'a> {
    /// Segments of the batch.
    pub fn count(&self) -> usize {
        self.count
    }

    /// True if depths alone are needed, since there is one colour.
    pub fn depth_only(&self) -> bool {
        self.one_color
    }

    /// The widgets.
    #[inline(always)]
    pub fn widgets(&self) -> impl ExactSizeIterator<Item = &'a LaneWidget> + use<'a> {
        self.widgets.iter()
    }

    /// The vector of segments that begins at a place.
    #[inline(always)]
    pub fn segments<L: Lanes>(&self, at: usize) -> SegmentLanes<L> {
        SegmentLanes::load(self.batch, at)
    }

    /// Further fields of the vector of segments that begins at a place.
    #[inline(always)]
    pub fn fields<L: Lanes>(&self, at: usize) -> FieldLanes<L> {
        FieldLanes::load(self.batch, at)
    }

    /// Stored values of one field at the front and at the back of a vector of segments. `place`: [`super::FieldAxis::place`].
    #[inline(always)]
    pub fn ends<L: Lanes>(&self, place: usize, at: usize) -> [L::F; 2] {
        let value = inlined!(|columns: &[Column]| L::F::load(&columns[place][at..]));
        [value(&self.batch.front), value(&self.batch.back)]
    }

    /// Lanes (bits) of a mask, of the vector of segments at a place, that lie within the batch.
    #[inline(always)]
    pub fn within<L: Lanes>(&self, mask: L::M, at: usize) -> u32 {
        meant::<L>(mask, self.count - at)
    }
}

impl SegmentResults<'_> {
    /// Stores optical depths of a vector of segments.
    #[inline(always)]
    pub fn put_depth<L: Lanes>(&mut self, at: usize, depth: L::F) {
        depth.store(&mut self.0.depth[at..]);
    }

    /// Stores premultiplied colours and opacities of a vector of segments.
    #[inline(always)]
    pub fn put_color<L: Lanes>(&mut self, at: usize, [r, g, b]: [L::F; 3], opacity: L::F) {
        for (column, value) in self.0.rgba.iter_mut().zip([r, g, b, opacity]) {
            value.store(&mut column[at..]);
        }
    }

    /// Stores optical depths, premultiplied colours and the opacities of those depths.
    #[inline(always)]
    pub fn put<L: Lanes>(&mut self, at: usize, color: [L::F; 3], depth: L::F) {
        self.put_depth::<L>(at, depth);
        self.put_color::<L>(at, color, one_minus_exp::<L>(depth));
    }

    /// Stores nothing for a vector of segments: no depth, no colour.
    #[inline(always)]
    pub fn put_nothing<L: Lanes>(&mut self, at: usize) {
        let zero = L::F::splat(0.0);
        self.put_depth::<L>(at, zero);
        self.put_color::<L>(at, [zero; 3], zero);
    }

    /// Queues some segments (bits) of a vector for 64 bits.
    #[inline(always)]
    pub fn fall_back(&mut self, at: usize, lanes: u32) {
        push(&mut self.0.fallback_queue, lanes, at);
    }

    /// Adds to the number of evaluations of the transfer function.
    #[inline(always)]
    pub fn count_evaluations(&mut self, count: u64) {
        self.0.evaluation_count += count;
    }

    /// Adds to the number of segments on which widgets overlap. `product`: the pairwise product of the widgets' depths; `skipped`:
    /// lanes (bits) that do not count.
    #[inline(always)]
    pub fn count_overlaps<L: Lanes>(
        &mut self,
        product: L::F,
        segments: &SegmentLanes<L>,
        remaining: usize,
        skipped: u32,
    ) {
        let overlapping = overlaps::<L>(product, segments, remaining) & !skipped;
        self.0.overlap_count += u64::from(overlapping.count_ones());
    }
}

impl<L: Lanes> SegmentLanes<L> {
    /// Ranges of the values.
    #[inline(always)]
    pub fn range(&self) -> ValueRange<'_, L> {
        ValueRange::new(self)
    }
}
