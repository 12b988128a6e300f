//! Scene that a shader and its widgets are compiled for.

use crate::attribute::Attribute;
use crate::shade::shaded_batch::FallbackReason;
use voltet_core::transfer::OpticalModel;
use voltet_optics::integrators::Extent;
use voltet_simd::LaneSet;
use voltet_simd::limits::MIN_WALKED_LENGTH;

/// Scene that a shader is compiled for.
#[derive(Clone, Copy)]
pub(crate) struct ShaderContext<'a> {
    pub attributes: &'a [Attribute<'a>],
    /// World units in a scene length.
    pub length: f64,
    /// True if segments are ordered also where one colour needs no order.
    pub ordered: bool,
    /// True if widgets are skipped on segments outside their support.
    pub leave_out: bool,
    /// Domain of tables over the data.
    pub extent: Extent,
    /// Lane set that fills tables.
    pub lanes: LaneSet,
}

/// Scene that widgets are compiled for.
#[derive(Clone, Copy)]
pub(crate) struct WidgetContext<'a> {
    /// s, then g where there is one, then the further fields.
    pub attributes: &'a [Attribute<'a>],
    /// Names of the further fields.
    pub fields: &'a [&'a str],
    /// Turns extinction into optical depth per scene length.
    pub density_scale: f64,
    /// Optical model: emission in proportion to absorption, or constant.
    pub model: OpticalModel,
    /// Optical depth along the longest ray that each may lose outside its support bounds; `None`: it has none.
    pub left_out: Option<f64>,
}

impl<'a> WidgetContext<'a> {
    /// A further field: its index among them, and its attribute.
    pub fn field(&self, name: &str) -> Option<(usize, &'a Attribute<'a>)> {
        let place = self.fields.iter().position(|field| *field == name)?;
        self.attributes.get(2 + place).map(|attribute| (place, attribute))
    }

    /// Factor that turns the constant-emitter's glow to that of a scene length; `None` for the density-emitter. Errors: 32 bits do not hold
    /// it.
    pub fn glow_scale(&self) -> Result<Option<f32>, FallbackReason> {
        let scale = self.density_scale as f32;
        match self.model.cutoff() {
            None => Ok(None),
            Some(_) if MIN_WALKED_LENGTH < scale && scale.is_finite() => Ok(Some(scale)),
            Some(_) => Err(FallbackReason::Lengths),
        }
    }
}
