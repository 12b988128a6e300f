//! Door for the integrator `reference`, which a crate outside implements.

use super::SegmentIntegrator;
use crate::WidgetBlend;
use std::sync::OnceLock;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};

/// Constructor of the integrator.
pub type ReferenceConstructor = fn(&TransferFunction, WidgetBlend) -> Result<Box<dyn SegmentIntegrator>>;

static CONSTRUCTOR: OnceLock<ReferenceConstructor> = OnceLock::new();

/// Registers the integrator `reference`; the first one stays.
pub fn register_reference(constructor: ReferenceConstructor) {
    CONSTRUCTOR.get_or_init(|| constructor);
}

/// Registered integrator for a transfer function. Errors: a program without one; the constructor's.
pub(super) fn reference(
    transfer_function: &TransferFunction,
    blend: WidgetBlend,
) -> Result<Box<dyn SegmentIntegrator>> {
    let missing = || Error::run("this program is without the integrator").got("reference");
    CONSTRUCTOR.get().ok_or_else(missing)?(transfer_function, blend)
}
