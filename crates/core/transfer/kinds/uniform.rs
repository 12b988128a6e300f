//! `uniform`: 1 inside its region (Song et al. 2009, section 4.1).

use super::properties::{COLOR, EXTINCTION, NAME, Properties, REGION};
use crate::parameters::{DefaultValue, Parameter, VariantSchema};

pub(super) const KIND: VariantSchema = VariantSchema {
    name: "uniform",
    summary: "The same extinction everywhere in its region.",
    parameters: &[COLOR, EXTINCTION, Parameter { default: DefaultValue::Required, ..REGION }, NAME],
};

pub(super) fn properties() -> Properties<'static> {
    Properties { name: KIND.name, jumps: true, needs_region: true, ..Properties::PLAIN }
}
