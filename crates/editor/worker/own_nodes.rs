//! The nodes that the worker adds to those that files may name.

use super::{preview_observer, series};
use voltet_core::Result;
use voltet_graph::Registry;

/// The registry with the worker's own nodes.
pub(super) fn with_own(registry: &Registry) -> Result<Registry> {
    let mut own = registry.clone();
    own.add(&preview_observer::NODE)?;
    own.add(&preview_observer::ASKS_FOR_ARRAYS)?;
    own.add(&preview_observer::PROBES)?;
    own.add(&series::NODE)?;
    Ok(own)
}
