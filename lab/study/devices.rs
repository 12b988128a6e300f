//! The engines that a study or the stability of formulas is measured on.

use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_introspect::open_variants;
use voltet_optics::engine::{AdapterRequest, Engine, EngineInfo};

/// Opens an engine on the adapter that is named, by its kind or a part of its name, or on the fastest that is hardware.
///
/// Errors: there is none; `--adapter` is named where it helps.
pub(crate) fn open(engine: &EngineInfo, adapter: Option<&str>) -> Result<Arc<dyn Engine>> {
    engine.open(&AdapterRequest::hardware(adapter)).map_err(|error| helped(engine, adapter, error))
}

/// Opens the variants of an engine that are judged one by one. Errors: like [`open`].
pub(crate) fn open_variants_of(engine: &EngineInfo, adapter: Option<&str>) -> Result<Vec<Arc<dyn Engine>>> {
    open_variants(engine, &AdapterRequest::hardware(adapter)).map_err(|error| helped(engine, adapter, error))
}

fn helped(engine: &EngineInfo, adapter: Option<&str>, error: Error) -> Error {
    match adapter {
        _ if engine.unavailable_reason.is_some() => {
            error.expected(format!("one with the feature \"{}\"", engine.name))
        }
        // What there is, is software.
        None if !(engine.adapters)().is_empty() => {
            error.expected("one, or --adapter software, which measures what was found")
        }
        _ => error,
    }
}
