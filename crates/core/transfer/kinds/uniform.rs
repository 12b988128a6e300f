//! `uniform`: 1 inside its region (Song et al. 2009, section 4.1).

use super::properties::{AxisOrigin, COLOR, ColorSource, EXTINCTION, Properties, REGION};
use crate::parameters::{DefaultValue, Parameter, VariantSchema};

/// The declaration.
pub(super) const KIND: VariantSchema = VariantSchema {
    name: "uniform",
    summary: "The same extinction everywhere in its region.",
    parameters: &[COLOR, EXTINCTION, Parameter { default: DefaultValue::Required, ..REGION }],
};

pub(super) fn properties() -> Properties<'static> {
    Properties {
        name: KIND.name,
        color: ColorSource::Widget,
        own_peak: None,
        fields: Vec::new(),
        depends_on_g: false,
        axes: vec![AxisOrigin::Any; 2],
        bands: None,
        jumps: true,
        range: None,
        needs_region: true,
        has_elementary_mean: true,
    }
}
