//! The graphics device that a study or the stability of formulas is measured on.

use voltet_core::{Error, Result};

#[cfg(feature = "gpu")]
pub(crate) use voltet_gpu::Device;

/// In builds without the device engine there is none.
#[cfg(not(feature = "gpu"))]
pub(crate) enum Device {}

/// Opens the adapter that is named, by its kind or a part of its name, or the fastest that is hardware.
///
/// Errors: there is none; `--adapter` is named where it helps.
#[cfg(feature = "gpu")]
pub(crate) fn open(adapter: Option<&str>) -> Result<Device> {
    let hint = |error: Error| match adapter {
        None if voltet_gpu::Adapters::find().described().is_empty() => error,
        // What there is, is software.
        None => error.accepted("one, or --adapter software, which measures what was found"),
        Some(_) => error,
    };
    Device::open(adapter, true).map_err(hint)
}

#[cfg(not(feature = "gpu"))]
pub(crate) fn open(_adapter: Option<&str>) -> Result<Device> {
    Err(Error::run("this build has no device engine").accepted("one with the feature \"gpu\""))
}
