//! What widgets are made ready for.

use crate::attribute::Attribute;
use voltet_core::transfer::OpticalModel;

/// The scene that widgets are made ready for.
#[derive(Clone, Copy)]
pub(crate) struct Making<'a> {
    /// s, then g where it is at hand, then the further fields.
    pub attributes: &'a [Attribute<'a>],
    /// Names of the further fields.
    pub fields: &'a [&'a str],
    /// Turns extinction into optical depth per scene length.
    pub density_scale: f64,
    /// Whether they glow in step with what they absorb.
    pub model: OpticalModel,
    /// How many there are.
    pub widget_count: usize,
    /// Whether segments that a widget hardly meets are not asked of it.
    pub leave_out: bool,
}

impl<'a> Making<'a> {
    /// A further field: its place among them, and its attribute.
    pub(super) fn field(&self, name: &str) -> Option<(usize, &'a Attribute<'a>)> {
        let place = self.fields.iter().position(|field| *field == name)?;
        self.attributes.get(2 + place).map(|attribute| (place, attribute))
    }
}
