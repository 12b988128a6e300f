//! The scene that a kernel is prepared for.

use super::batch::WidgetLanes;
use crate::shade::context::{ShaderContext, WidgetContext};
use crate::shade::kinds::LaneWidget;
use crate::shade::shaded_batch::FallbackReason;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_optics::integrators::{Extent, SegmentIntegrator};
use voltet_simd::LaneSet;

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
    pub fn widgets(&self) -> impl ExactSizeIterator<Item = WidgetLanes<'a>> + use<'a> {
        self.widgets.iter().map(WidgetLanes)
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
